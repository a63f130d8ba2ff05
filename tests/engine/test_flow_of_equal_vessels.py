"""Vessels that a rough pipe has made equal empty as one; a laminar part of it holds the flow."""

import numpy as np
import pytest

import hybond as hb

C = 2.5e-4
LEAK = 2.2e-3


def tanks(turned: bool) -> hb.Model:
    m = hb.Model("two tanks")
    m.add(a=hb.C(C, q=1e-3), r=hb.R({"e": "1.6e-3*f*abs(f) + 1e-3*f"}), b=hb.C(C), g=hb.R(1 / LEAK))
    m.add(j=hb.Zero(), k=hb.One(), l=hb.Zero())
    between = ("l -> k", "k -> j") if turned else ("j -> k", "k -> l")
    m.bond("a -> j", *between, "l -> b", "k -> r", "l -> g")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_laminar_part_holds_the_flow_between_equal_vessels(solver: str, turned: bool) -> None:
    """Equal vessels each lose half of what the leak draws, `S exp(-LEAK t / 2 C)` being stored."""
    found = hb.simulate(tanks(turned), 0.85, solver=solver)
    sign = -1.0 if turned else 1.0
    # equal after less than a millisecond; the leak draws of the second alone until then
    begin = 0.01
    stored = found["a.q"].at(begin) + found["b.q"].at(begin)
    for t in (0.3, 0.6, 0.85):
        left = stored * np.exp(-LEAK * (t - begin) / (2 * C))
        assert found["a.q"].at(t) + found["b.q"].at(t) == pytest.approx(left, rel=1e-5)
        assert sign * found["r.f"].at(t) == pytest.approx(LEAK * left / (4 * C), rel=3e-3)
