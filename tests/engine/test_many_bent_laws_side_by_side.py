"""Laws that do not know of each other: what one of them determines hangs on none of the others.

Oracle: two tanks of capacity 1 level out by ``d' = -2 f(d)``, in closed form.
"""

from __future__ import annotations

import pytest

import hybond as hb

HEADS = (9.0, 0.0, 1e-4, -4.0, 0.0)
LAWS = {
    "0.5*f*abs(f)": lambda d, t: max(d**0.5 - 2.0**0.5 * t, 0.0) ** 2,
    "f^3": lambda d, t: max(d ** (2 / 3) - 4 / 3 * t, 0.0) ** 1.5,
}


def pairs(law: str, *, turned: bool, valves: bool) -> hb.Model:
    """Tanks in pairs, each pair with a pipe, and with a check valve in it."""
    m = hb.Model("pairs")
    for k, head in enumerate(HEADS):
        m.add(**{f"a{k}": hb.C(1.0, q=5.0 + head), f"b{k}": hb.C(1.0, q=5.0)})
        m.add(**{f"x{k}": hb.Zero(), f"y{k}": hb.Zero(), f"r{k}": hb.R({"e": law})})
        m.add(**{f"v{k}": hb.One(law="diode") if valves else hb.One()})
        m.bond(f"x{k} -> a{k}", f"y{k} -> b{k}", f"x{k} -> v{k} -> y{k}")
        m.bond(f"r{k} -> v{k}" if turned else f"v{k} -> r{k}")
    return m


@pytest.mark.parametrize("valves", [False, True])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("law", list(LAWS))
def test_pipes_at_rest_beside_others_are_determined(law, turned, valves):
    """A pipe between level tanks carries nothing: its flow is not open, whatever flows beside."""
    run = hb.simulate(pairs(law, turned=turned, valves=valves), 0.5, rtol=1e-7)
    assert not run.warnings
    for k, head in enumerate(HEADS):
        left = LAWS[law](abs(head), 0.5)
        if valves and head < 0.0:
            left = abs(head)
        found = run[f"a{k}.q"].at(0.5) - run[f"b{k}.q"].at(0.5)
        assert found == pytest.approx(left if head > 0.0 else -left, abs=2e-6)
