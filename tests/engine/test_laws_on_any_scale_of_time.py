"""Laws of junctions decide alike in models of nanoseconds and of years."""

from __future__ import annotations

import math

import pytest

import hybond as hb


def held(scale: float, *, law: bool, turned: bool) -> hb.Model:
    """A capacitor on 1.4 V behind what holds 0.59 V, beside a diode, a resistor and a coil."""
    m = hb.Model("held")
    m.add(j0=hb.Zero(law="diode"), j1=hb.One(law="relay", limit=0.59))
    m.add(i=hb.I(0.725 * scale, p=0.0615 * scale), c=hb.C(0.53 * scale, q=-0.33 * scale))
    m.add(r=hb.R({"e": "1.39*f*abs(f)"} if law else 1.0), s=hb.Se(1.4))
    m.bond("j1 -> c" if turned else "c -> j1", "j0 -> r", "j1 -> j0", "j1 -> s", "i -> j0")
    return m


@pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e3, 1e6, 1e9, 1e12])
@pytest.mark.parametrize("law", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_what_holds_its_limit_does_so_however_slow_all_is(
    scale: float, law: bool, turned: bool
) -> None:
    """Beside storages of 1e9 it was refused (HB-J110): no step was longer than a second."""
    run = hb.simulate(held(scale, law=law, turned=turned), 0.6 * scale)
    assert run["c.e"].at(0.6 * scale) == pytest.approx(-0.81 if turned else 0.81, rel=1e-9)
    assert run["i.p"].at(0.6 * scale) == pytest.approx(0.0615 * scale, rel=1e-12)


@pytest.mark.parametrize("tau", [1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_friction_stops_a_fast_part_late_in_a_run(tau: float, dual: bool, turned: bool) -> None:
    """A pulse of a microsecond at 0.3 s: a last place of the time is more than rounding of it."""
    pulse = f"if time > 0.3 and time < 0.3 + {tau} then 3 else 0"
    m = hb.Model("late")
    if dual:
        m.add(rub=hb.One(law="coulomb", limit=0.5), x=hb.I(tau), r=hb.R(2.0), s=hb.Se(pulse))
    else:
        m.add(rub=hb.Zero(law="coulomb", limit=0.5), x=hb.C(tau), r=hb.G(2.0), s=hb.Sf(pulse))
    m.bond("s -> rub", "x -> rub" if turned else "rub -> x", "rub -> r")
    run = hb.simulate(m, 1.0)
    _, begun, rests = run.events
    assert begun.t == 0.3
    most = 1.25 * -math.expm1(-2.0)  # tau y' = 2.5 - 2 y, then -0.5 - 2 y
    expected = tau * (1.0 + 0.5 * math.log1p(4.0 * most))
    assert rests.t - 0.3 == pytest.approx(expected, rel=1e-9, abs=4e-16)
    (fired,) = rests.steps[-1].fired
    assert fired.target == "sticks"
