"""Fixed steps with which grows what dies out: a warning, and a step with which it does not.

Oracle: a step multiplies an eigenvalue's motion by 1 + z, or by the Taylor polynomial of degree
four; z = -h/(RC) of a resistor at a capacitor, complex of a resonant circuit.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import hybond as hb


def decay() -> hb.Model:
    m = hb.Model("decay", domain="electrical")
    m.add(c=hb.C("1 uF", e="10 V"), r=hb.R("1 ohm"), j=hb.Zero())
    m.bond("c -> j -> r")
    return m


def resonance() -> hb.Model:
    m = hb.Model("resonance", domain="electrical")
    m.add(v=hb.Se("5 V"), c=hb.C("1 uF"), l=hb.I("1 mH"), r=hb.R("1 ohm"), j=hb.One())
    m.bond("v -> j -> c", "j -> l", "j -> r")
    return m


@pytest.mark.parametrize(
    ("method", "step", "factor"),
    [
        (hb.Euler, 2.1e-6, 1.1),
        (hb.Euler, 10e-6, 9.0),
        (hb.RK4, 3e-6, 1 - 3 + 9 / 2 - 27 / 6 + 81 / 24),
    ],
)
def test_growth_of_what_dies_out_is_said(
    method: type[hb.Euler | hb.RK4], step: float, factor: float
) -> None:
    run = hb.simulate(decay(), "60 us", method=method(step=step))
    (said,) = run.warnings
    assert "time constant of 1 µs" in said and f"grows by {100 * (factor - 1):.3g} %" in said
    # what it advises does not grow
    advised = said.partition("take step = ")[2].partition(",")[0]
    again = hb.simulate(decay(), "60 us", method=method(step=advised))
    assert not again.warnings and abs(float(again["c.e"].at(60e-6))) < 1e-6


def test_a_swing_that_euler_lets_grow() -> None:
    run = hb.simulate(resonance(), "1 ms", method=hb.Euler(step="10 us"))
    (said,) = run.warnings
    rate, turn = -500.0, math.sqrt(1e9 - 500.0**2)
    grows = abs(1 + 1e-5 * complex(rate, turn)) - 1
    assert f"grows by {100 * grows:.3g} %" in said
    assert abs(float(run["c.e"].at(1e-3))) > 100.0  # what it warns of


@pytest.mark.parametrize(
    ("made", "method"),
    [(decay, hb.Euler(step="0.5 us")), (decay, hb.RK4(step="2 us")), (resonance, hb.RK4("5 us"))],
)
def test_steps_that_are_short_enough_are_not_warned_of(
    made: Callable[[], hb.Model], method: hb.Euler | hb.RK4
) -> None:
    assert not hb.simulate(made(), "60 us", method=method).warnings


def test_what_grows_in_the_model_may_grow() -> None:
    m = hb.Model("growth")
    m.signal(x=hb.Integral("x", start=1))
    run = hb.simulate(m, 5, method=hb.Euler(step="1 ms"))
    assert not run.warnings


@pytest.mark.parametrize("method", [hb.RK4(step="20 ms"), hb.Euler(step="20 ms")])
def test_what_becomes_stiff_on_the_way_is_told_as_well(method: hb.RK4 | hb.Euler) -> None:
    """A conductance that grows by 400 S/s drains 1 A out of 1 F: at the end 2.5 mV are left."""
    m = hb.Model("drained", domain="electrical")
    m.add(s=hb.Sf("1 A"), c=hb.C("1 F"), g=hb.G("1 S*(1 + 400*time/(1 s))"), n=hb.Zero())
    m.bond("s -> n -> c", "n -> g")
    run = hb.simulate(m, "1 s", method=method)
    (said,) = run.warnings
    assert "the values are wrong" in said
    assert float(run["c.e"].at(1.0)) != pytest.approx(2.5e-3, rel=0.1)


def test_nothing_is_said_of_what_is_stiff_for_a_step_only_or_of_what_is_empty() -> None:
    """A body that drag brakes from 10 m/s, ``v' = -v^3``, and a stiff circuit without charge."""
    m = hb.Model("braked")
    m.add(v=hb.One(), i=hb.I(1.0, f=10.0), d=hb.R({"e": "f^3"}))
    m.add(n=hb.Zero(), c=hb.C(1e-6), r=hb.R(1.0))
    m.bond("v -> i", "v -> d", "c -> n -> r")
    run = hb.simulate(m, 50.0, method=hb.Euler(step=7e-3))
    assert not run.warnings
    # 1/v^2 grows by 2 in a second
    assert float(run["i.f"].at(50.0)) == pytest.approx(1 / math.sqrt(0.01 + 100.0), rel=1e-3)


def test_a_step_that_cannot_be_longer_is_warned_of() -> None:
    # what falls over with a time constant of 0.1 s is 7000 times as far after 3 s as it should be,
    # and with 1.6 times the step it is refused: nothing was said of the step
    m = hb.Model("falls over", domain="electrical")
    m.add(C=hb.C(1.0, e=1e-6), R=hb.R(-0.1), n=hb.Zero())
    m.bond("n -> C", "n -> R")
    run = hb.simulate(m, 3.0, solver="moreau-jean", step=0.15)
    assert "step_error" not in run.stats
    assert any("cannot be estimated: steps 1.6 times as long" in w for w in run.warnings)
    run = hb.simulate(m, 3.0, solver="moreau-jean", step=0.001)
    assert not any("cannot be estimated" in w for w in run.warnings)
    assert float(run["C.e"].at(3.0)) == pytest.approx(1e-6 * math.exp(30.0), rel=1e-2)
