"""What moves slowly past a threshold is not taken for resting there by what is fast beside it.

Guards whose thresholds are where a motion comes to rest do not fire; but beside a motion that is by
far faster, a slow one seems to stand. Each against a closed form, or an integration by SciPy.
"""

from __future__ import annotations

import pytest

import hybond as hb

SOLVERS = ["auto", "radau"]


def kinetics(per_second: float) -> hb.Model:
    """Return Robertson's reactions, in a unit of time that makes them so many times as fast."""
    m = hb.Model("kinetics", parameters={"k": per_second})
    m.signal(
        a=hb.Integral("k*(-0.04*a + 1e4*b*c)", start=1.0),
        b=hb.Integral("k*(0.04*a - 1e4*b*c - 3e7*b^2)", start=0.0),
        c=hb.Integral("k*3e7*b^2", start=0.0),
    )
    m.machine(
        "seen",
        states={"much": [], "less": [], "little": []},
        start="much",
        rules=["much -> less when c >= 0.01", "less -> little when a <= 1e-4"],
    )
    return m


@pytest.mark.parametrize("per_second", [1.0, 1e9])
@pytest.mark.parametrize("solver", SOLVERS)
def test_robertson_reaches_a_ten_thousandth_when_it_does(solver: str, per_second: float) -> None:
    """The roots of the example of IDA, by Radau of SciPy with a tolerance of 1e-12."""
    run = hb.simulate(kinetics(per_second), until=4e7 / per_second, solver=solver)
    assert run.events.t[1] * per_second == pytest.approx(0.264019078188, rel=1e-8)
    assert run.events.t[2] * per_second == pytest.approx(20795496.883, rel=1e-8)
    assert run.warnings == ()


def supply(sign: float, volts: float, load: str = "0.1 [A/V^2]*e*abs(e)") -> hb.Model:
    """Return what a load like ``g e |e|`` empties, seen behind a filter of a nanosecond."""
    m = hb.Model("supply", domain="electrical", parameters={"V": sign * 2.0})
    m.add(store=hb.C("1 kF", e="V"), load=hb.R({"f": load}), n=hb.Zero())
    m.add(i=hb.One(), r=hb.R("1 ohm"), seen=hb.C("1 nF", e="V"))
    m.bond("n -> store", "n -> load", "n -> i -> seen", "i -> r")
    side = "<" if sign > 0.0 else ">"
    m.machine(
        "low",
        states={"no": [], "yes": []},
        start="no",
        rules=[f"no -> yes when seen.e {side} {sign * volts} [V]"],
    )
    return m


@pytest.mark.parametrize("rtol", [1e-8, 1e-6])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_slow_discharge_passes_what_a_fast_filter_shows(
    solver: str, sign: float, rtol: float
) -> None:
    """1/e grows evenly, by 1e-4 /(V s)."""
    at = 1e4 * (1.0 / 0.01 - 1.0 / 2.0)
    run = hb.simulate(supply(sign, 0.01), until=2.0 * at, solver=solver, rtol=rtol)
    assert run.events.t[1] == pytest.approx(at, rel=max(5e-9, 0.2 * rtol))
    assert run.warnings == ()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("solver", SOLVERS)
def test_what_rests_on_it_beside_what_is_fast_fires_nothing(solver: str, sign: float) -> None:
    """A load that takes nothing at 0.01 V: the store comes as near as one likes, and no lower."""
    m = supply(sign, 0.01, f"0.1 [A/V]*(e - {sign * 0.01} [V])")
    run = hb.simulate(m, until=1e6, solver=solver)
    assert len(run.events) == 1
