"""Dead zones in series and valves without flow: what they leave open, at their corners too.

Newton often ends exactly at a corner, `max(e - 0.5, 0)` at 0.5. There its slope is that of one
side, and nothing seemed to be free: how parts in series shared what they block hung on the order in
which they were declared, and a guard on such a share fired without a word.
"""

from __future__ import annotations

import random

import numpy as np
import pytest

import hybond as hb
from tests.in_orders import in_orders

LIMITS = {"a": 1.0, "b": 0.5, "c": 0.8}
WRITTEN = {
    "larger first": "max(e - {0}, 0) + min(e + {0}, 0)",
    "zero first": "max(0, e - {0}) + min(0, e + {0})",
    "if": "if e >= {0} then e - {0} else if e <= -{0} then e + {0} else 0",
    "abs": "0.5*(2*e - abs(e + {0}) + abs(e - {0}))",
}


def zone(limit: float, how: str) -> hb.R:
    """Return a resistor that lets nothing pass up to a limit."""
    if how == "table":
        at = [-limit - 3, -limit, limit, limit + 3]
        return hb.R({"f": {"table": [at, [-3, 0, 0, 3]], "extrapolate": "linear"}})
    return hb.R({"f": WRITTEN[how].format(limit)})


def shares(total: float, names: str) -> dict[str, float]:
    """Return the shares with the least sum of squares, none beyond its limit."""
    left = dict.fromkeys(names, 0.0)
    rest = abs(total)
    for k, name in enumerate(sorted(names, key=lambda n: LIMITS[n])):
        left[name] = min(LIMITS[name], rest / (len(names) - k))
        rest -= left[name]
    return {name: share if total > 0 else -share for name, share in left.items()}


@pytest.mark.parametrize(
    ("names", "how"),
    [(n, h) for n in ("ab", "abc") for h in (*WRITTEN, "table") if (n, h) != ("abc", "abs")],
)
def test_dead_zones_in_series_share_alike_in_any_order(names: str, how: str) -> None:
    reach = sum(LIMITS[n] for n in names)
    parts = {n: zone(LIMITS[n], how) for n in names}
    parts |= {"S": hb.Se("3*sin(2*time)"), "i": hb.One()}
    bonds = ["S -> i", "i -> a", *(f"{n} -> i" if n == "b" else f"i -> {n}" for n in names[1:])]
    times = np.array([0.05, 0.1, 0.2, 0.22, 0.25, 0.29])
    for m in in_orders(parts, bonds, many=3 if names == "abc" else 5):
        run = hb.simulate(m, until=0.3)
        for t in times[np.abs(3 * np.sin(2 * times)) < reach]:
            right = shares(3 * np.sin(2 * t), names)
            for n in names:
                sign = -1.0 if n == "b" else 1.0  # its bond is turned
                assert sign * run[f"{n}.e"].at(t) == pytest.approx(right[n], abs=1e-9), (n, t)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("guard", ["b.e < 0.3", "a.e < 0.7"])
def test_guards_on_a_share_at_a_corner_are_refused_in_any_order(guard: str, seed: int) -> None:
    names = random.Random(seed).sample("ab", 2)
    m = hb.Model("guarded")
    m.add(S=hb.Se("3*cos(2*time)"), i=hb.One())
    for n in names:
        m.add({n: zone(LIMITS[n], "larger first")})
    m.bond(*(f"i -> {n}" for n in names), "S -> i")
    m.machine(
        "m", states={"x": [], "y": []}, start="x", rules=[f"x -> y when {guard} and time > 0.55"]
    )
    with pytest.raises(hb.HybondError) as refused:
        hb.simulate(m, until=1)
    assert refused.value.code == "HB-J102"


@pytest.mark.parametrize("arrow", ["n -> valve", "valve -> n"])
@pytest.mark.parametrize("law", ["max(e - 1, 0)", "max(0, e - 1)", "if e > 1 then e - 1 else 0"])
def test_valve_without_flow_decides_guards_beyond_where_it_opens(law: str, arrow: str) -> None:
    # nothing flows at first: the pressure is open up to 1, then it is 1 + time
    def guarded(rule: str) -> hb.Model:
        m = hb.Model("relief valve on a pump")
        m.add(pump=hb.Sf("1*time"), n=hb.Zero(), valve=hb.R({"f": law}))
        m.bond("pump -> n", arrow)
        m.machine("m", states={"x": [], "y": []}, start="x", rules=[f"x -> y when {rule}"])
        return m

    run = hb.simulate(guarded("n.e > 1.5"), until=2)
    assert run.events.t[1] == pytest.approx(0.5, abs=1e-9)
    with pytest.raises(hb.HybondError) as refused:
        hb.simulate(guarded("n.e > 0.5"), until=2)
    assert refused.value.code == "HB-J102"
