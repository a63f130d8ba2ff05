"""What laws make zero is zero, however large the unknowns are that are solved with it."""

from __future__ import annotations

import pytest

import hybond as hb


def shorted(far: float, near: float, source: str) -> hb.Model:
    """Capacitors that an open end holds at 0 V, bent ones among them, fed through 1 ohm."""
    m = hb.Model("shorted")
    m.add(n=hb.Zero(), o=hb.Zero(), short=hb.One(), at=hb.One(), r=hb.R(1.0), s=hb.Se(source))
    m.add(a=hb.C({"e": f"0.1*((q/{far}) + (q/{far})^3)"}, q=0.1 * far))
    m.add(b=hb.C({"e": f"0.02*sinh(q/{near})"}), c=hb.C(1.3e-4), leak=hb.R(0.4))
    m.bond("n -> b", "short -> o", "n -> a", "o -> leak", "c -> n", "n -> o")
    m.bond("s -> at -> n", "at -> r")
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau", "auto"])
@pytest.mark.parametrize(("far", "near"), [(252.0, 5e-3), (3.0, 7e-3), (1e4, 1e-5)])
@pytest.mark.parametrize("source", ["-0.3*sin(2900*time)", "20*cos(400*time) + 7*time"])
def test_charges_of_shorted_capacitors_stay_zero(
    far: float, near: float, source: str, solver: str
) -> None:
    run = hb.simulate(shorted(far, near, source), 0.05, solver=solver, max_steps=200)
    for name in ("a.q", "b.q", "c.q"):
        assert [run[name].at(t) for t in (0.01, 0.0317, 0.05)] == [0.0, 0.0, 0.0], name
    # a sine turns by 3 rad in a step at the most
    assert run.stats["steps"] < 30 + 2900 * 0.05 / 3.0
