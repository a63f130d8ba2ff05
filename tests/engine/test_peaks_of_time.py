"""What a source of time does between two steps: peaks while nothing moves, pulses, fast sines.

Oracles are closed forms: integrals of pulses, what a peak charges, times at which it crosses.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb

SOLVERS = ("auto", "rk45", "radau", "exact")
WIDTHS = (1e-9, 1e-6, 1e-3, 1e-1)
ROOT = math.sqrt(math.pi)
"""The area of ``exp(-x^2)``."""


def gauss(width: float, at: float = 0.5) -> str:
    return f"exp(-((time/(1 s) - {at})/{width!r})^2)"


def clipped(source: str, level: float, *, back: bool = False) -> hb.Model:
    """A source that drives a current through a diode against a battery: ``i = V - level``."""
    m = hb.Model("clipped", domain="electrical")
    m.add(V=hb.Se(source), d=hb.One(law="diode"), r=hb.R("1 ohm"), E=hb.Se(f"{level} V"))
    m.bond("V -> d -> E", "r -> d" if back else "d -> r")
    m.signal(q=hb.Integral("d.f"))
    return m


def swing(source: str, *, back: bool = False) -> hb.Model:
    """A force on a mass of 2 kg that hangs at a spring of 1 N/m."""
    m = hb.Model("swing", domain="translational")
    m.add(F=hb.Se(source), v=hb.One(), M=hb.I("2 kg"), n=hb.Zero(), K=hb.C("1 m/N"))
    m.bond("F -> v", "n -> v" if back else "v -> n", "v -> M", "n -> K")
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("width", [1e-7, 1e-3, 0.05])
def test_a_diode_that_blocks_lets_the_peak_of_a_pulse_through(solver: str, width: float) -> None:
    """Of ``100 exp(-x^2)`` over 50: from ``-x0`` to ``x0``, the root of ``log 2``."""
    run = hb.simulate(clipped(f"100 V*{gauss(width)}", 50.0), "1 s", solver=solver)
    x = math.sqrt(math.log(2.0))
    begin, end = (event.t for event in run.events[1:3])
    assert begin == pytest.approx(0.5 - x * width, abs=1e-9 * width + 1e-12)
    assert end == pytest.approx(0.5 + x * width, abs=1e-9 * width + 1e-12)
    charge = 100.0 * ROOT * math.erf(x) * width - 100.0 * x * width
    assert run["q"].at(1.0) == pytest.approx(charge, rel=1e-6 if width > 1e-6 else 1e-4)
    assert not run.warnings


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("solver", SOLVERS)
def test_each_of_the_peaks_of_two_sines_passes_the_diode(solver: str, *, back: bool) -> None:
    """Over 99.9 V of ``50 sin(10 t) + 50 sin(2000 t)``, each found by bisection by itself."""
    source = "50 V*sin(10*time/(1 s)) + 50 V*sin(2e3*time/(1 s))"

    def over(t: float) -> float:
        return 50.0 * math.sin(10.0 * t) + 50.0 * math.sin(2e3 * t) - 99.9

    def area(t: float) -> float:
        return -5.0 * math.cos(10.0 * t) - 0.025 * math.cos(2e3 * t) - 99.9 * t

    def root(low: float, high: float) -> float:
        sign = over(low)
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if over(middle) * sign > 0.0 else (low, middle)
        return low

    tops = [(0.5 + 2.0 * k) * math.pi / 2e3 for k in range(320)]
    tops = [t for t in tops if t < 1.0 and over(t) > 0.0]
    crossed = [(root(t - 1e-3, t), root(t, t + 1e-3)) for t in tops]
    run = hb.simulate(clipped(source, 99.9, back=back), "1 s", solver=solver)
    assert len(crossed) == 8
    assert [e.t for e in run.events[1:]] == pytest.approx(np.ravel(crossed).tolist(), abs=1e-10)
    charge = sum(area(b) - area(a) for a, b in crossed)
    assert run["q"].at(1.0) == pytest.approx(charge, rel=1e-5)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("width", WIDTHS)
def test_a_pulse_is_not_stepped_over_by_a_spring_and_a_mass(
    solver: str, width: float, *, back: bool
) -> None:
    """Convolution with ``sin(w t)/(m w)``; all of a pulse of ``0.1`` is within the second too."""
    run = hb.simulate(swing(f"1 N*{gauss(width)}", back=back), "1 s", solver=solver)
    w = math.sqrt(0.5)
    momentum = ROOT * width * math.exp(-0.25 * (w * width) ** 2)
    near = 2e-6 if width < 1e-8 else 1e-8  # what the places of time leave of its width
    assert run["M.p"].at(1.0) == pytest.approx(momentum * math.cos(0.5 * w), rel=near)
    way = momentum * math.sin(0.5 * w) / (2.0 * w)
    assert abs(run["K.q"].at(1.0)) == pytest.approx(way, rel=near)


def test_a_pulse_as_wide_as_the_run_is_what_quadrature_makes_of_it() -> None:
    """Gauss's formula with 40 points is right to rounding of what is so smooth."""
    w = math.sqrt(0.5)
    x, weight = np.polynomial.legendre.leggauss(40)
    t = 0.5 + 0.5 * x
    momentum = 0.5 * float(np.sum(weight * np.exp(-((t - 0.5) ** 2)) * np.cos(w * (1.0 - t))))
    run = hb.simulate(swing(f"1 N*{gauss(1.0)}"), "1 s")
    assert run["M.p"].at(1.0) == pytest.approx(momentum, rel=1e-8)


def of_flow_into_c(pulse: str) -> tuple[hb.Model, str]:
    m = hb.Model(domain="electrical")
    m.add(s=hb.Sf(f"1 A*{pulse}"), c=hb.C("1 F"))
    m.bond("s -> c")
    return m, "c.q"


def of_effort_on_i(pulse: str) -> tuple[hb.Model, str]:
    m = hb.Model(domain="electrical")
    m.add(s=hb.Se(f"1 V*{pulse}"), i=hb.I("1 H"))
    m.bond("s -> i")
    return m, "i.p"


def of_a_resistor(pulse: str) -> tuple[hb.Model, str]:
    m = hb.Model(domain="electrical")
    m.add(s=hb.Se("1 V"), r=hb.G(f"1 S*{pulse}"))
    m.bond("s -> r")
    m.signal(q=hb.Integral("r.f"))
    return m, "q"


def of_a_gyrator(pulse: str) -> tuple[hb.Model, str]:
    m = hb.Model(domain="electrical")
    m.add(s=hb.Sf("1 A"), g=hb.GY(f"1 ohm*{pulse}"), i=hb.I("1 H"))
    m.bond("s -> g -> i")
    return m, "i.p"


def of_a_transformer(pulse: str) -> tuple[hb.Model, str]:
    m = hb.Model(domain="electrical")
    m.add(s=hb.Sf("1 A"), t=hb.TF(f"{pulse}"), c=hb.C("1 F"))
    m.bond("s -> t -> c")
    return m, "c.q"


def of_a_signal(pulse: str) -> tuple[hb.Model, str]:
    m = hb.Model()
    m.signal(x=hb.Integral(pulse))
    return m, "x"


PLACES = (
    *(of_flow_into_c, of_effort_on_i, of_a_resistor),
    *(of_a_gyrator, of_a_transformer, of_a_signal),
)


@pytest.mark.parametrize("place", PLACES, ids=lambda f: f.__name__)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_pulse_is_seen_wherever_it_is_said(solver: str, place: Callable[..., Any]) -> None:
    """Two pulses, the second a thousand times narrower and as high: the sum of both areas."""
    m, name = place(f"({gauss(1e-3, 0.3)} + {gauss(1e-6, 0.7)})")
    run = hb.simulate(m, "1 s", solver=solver)
    assert run[name].at(1.0) == pytest.approx(ROOT * (1e-3 + 1e-6), rel=1e-7)
    assert run[name].at(0.6) == pytest.approx(ROOT * 1e-3, rel=1e-7)


PULSES = {
    gauss(1e-6): ROOT * 1e-6,
    "1/(1 + ((time/(1 s) - 0.5)/1e-6)^2)": 2e-6 * math.atan(0.5e6),
    "1/cosh((time/(1 s) - 0.5)/1e-4)^2": 2e-4,
    "max(0, 1 - abs(time/(1 s) - 0.5)/1e-6)": 1e-6,
    "(if abs(time/(1 s) - 0.3) < 1e-7 then 1 else 0)": 2e-7,
    "(if sin(500*time/(1 s)) > 0.9 and time < 0.01 s then 1 else 0)": (
        (math.pi - 2.0 * math.asin(0.9)) / 500.0
    ),
    "exp(-1e4*abs(time/(1 s) - 0.5))": 2e-4 * -math.expm1(-5e3),
    "exp(-abs((time/(1 s) - 0.5)/1e-5)^3)": 2e-5 * math.gamma(4.0 / 3.0),
    "0.5*(tanh((time/(1 s) - 0.4)/1e-7) - tanh((time/(1 s) - 0.4001)/1e-7))": 1e-4,
    f"hypot({gauss(1e-4)}, 0)": ROOT * 1e-4,
}


@pytest.mark.parametrize("pulse", PULSES)
def test_pulses_of_any_form_have_their_areas(pulse: str) -> None:
    m, name = of_flow_into_c(pulse)
    run = hb.simulate(m, "1 s")
    assert run[name].at(1.0) == pytest.approx(PULSES[pulse], rel=1e-6)


GUARDS = {
    "sin(1e4*now) > 0.999999": math.asin(0.999999) / 1e4,
    f"{gauss(1e-7, 0.3)} > 0.5": 0.3 - 1e-7 * math.sqrt(math.log(2.0)),
    "1/(1 + ((now - 0.7)/1e-8)^2) > 0.5": 0.7 - 1e-8,
    "tanh((now - 0.4)/1e-8) > 0.5": 0.4 + 1e-8 * math.atanh(0.5),
    "exp(50*sin(200*now) - 50) > 0.5": math.asin(1.0 - math.log(2.0) / 50.0) / 200.0,
    "cos(3e3*now + sin(now)) < -0.9999999": None,
    "abs(now - 0.6) < 1e-9": 0.6 - 1e-9,
    "atan((now - 0.25)/1e-9) > 1": 0.25 + 1e-9 * math.tan(1.0),
    "sin(phase) > 0.99999": math.asin(0.99999) / 2e4,
    f"exp(-((now - 0.5)/1e-6)^2)*sin(1e3*now + {math.pi / 2.0 - 500.0!r}) > 0.9": None,
}


@pytest.mark.parametrize("guard", GUARDS)
def test_guards_of_time_fire_where_nothing_moves(guard: str) -> None:
    """At their closed forms, or where halving finds the root of what is compared."""
    m = hb.Model(domain="electrical")
    m.add(c=hb.C("1 F"), r=hb.R("1 ohm"))
    m.bond("c -> r")
    m.signal(phase=hb.Integral("2e4"), now="time/(1 s)")
    m.machine(
        "S",
        states={"a": [], "b": []},
        start="a",
        rules=[f"a -> b when {guard}"],
    )
    run = hb.simulate(m, "1 s")
    at = GUARDS[guard]
    if at is None and guard.startswith("cos"):
        low, high = 9e-4, math.pi / 3001.0
        for _ in range(60):
            at = 0.5 * (low + high)
            over = math.cos(3e3 * at + math.sin(at)) > -0.9999999
            low, high = (at, high) if over else (low, at)
    elif at is None:
        at = 0.5 - 1e-6 * math.sqrt(-math.log(0.9))
    assert len(run.events) == 2
    assert run.events[1].t == pytest.approx(at, abs=2e-12)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_fast_sine_onto_a_slow_capacitor_is_resolved(solver: str) -> None:
    """``q' = 10 sin(w t) - q``; its ripple is 2e-3."""
    m = hb.Model(domain="electrical")
    m.add(V=hb.Se("10 V*sin(5e3*time/(1 s))"), s=hb.One(), r=hb.R("1 ohm"), c=hb.C("1 F"))
    m.bond("V -> s -> r", "s -> c")
    run = hb.simulate(m, "1 s", solver=solver, rtol=1e-6)
    w = 5e3
    exact = 10.0 * (w * math.exp(-1.0) + math.sin(w) - w * math.cos(w)) / (1.0 + w * w)
    assert run["c.q"].at(1.0) == pytest.approx(exact, abs=2e-3 * 1e-4)


def test_what_is_far_off_or_flat_costs_next_to_no_steps() -> None:
    """A pulse after the run, one before it, and one too small to matter beside what was seen."""
    for at in (5.0, -5.0):
        m, _ = of_flow_into_c(gauss(1e-4, at))
        assert hb.simulate(m, "1 s").stats["steps"] <= 12
    narrow, _ = of_flow_into_c(gauss(1e-9))
    assert hb.simulate(narrow, "1 s").stats["steps"] < 300


def test_a_pole_is_passed_and_told_of() -> None:
    m, _ = of_flow_into_c("1e-3/(time/(1 s) - 0.5)")
    run = hb.simulate(m, "1 s", on_error="return")
    assert any("what time does in s has no bound at t = 0.5 s" in w for w in run.warnings)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("at", [0.25, 0.3, 0.5, 0.625, 0.7])
@pytest.mark.parametrize("pole", ["1/(time - {})", "2/(4*time - 4*{})^3", "1/(x - {})"])
def test_a_pole_is_told_of_wherever_halving_ends(pole: str, at: float, solver: str) -> None:
    """Where an interval ends just at the pole, all that is looked at lies before or behind it."""
    m = hb.Model()
    m.add(V=hb.Se(pole.format(at)), i=hb.One(), R=hb.R(1), L=hb.I(1))
    m.bond("V -> i -> R", "i -> L")
    if "x" in pole:
        m.signal(x=hb.Integral("1"))
    run = hb.simulate(m, 1.0, solver=solver, on_error="return")
    passed = run.t_end > at
    assert not passed or any(f"has no bound at t = {at} s" in w for w in run.warnings)


def test_a_root_at_the_start_is_no_pole() -> None:
    m, name = of_flow_into_c("sqrt(time/(1 s))")
    run = hb.simulate(m, "1 s")
    assert run[name].at(1.0) == pytest.approx(2.0 / 3.0, rel=1e-8)
    assert not run.warnings


@pytest.mark.parametrize("source", [gauss(1e-4), "sin(1e4*time/(1 s))"])
def test_fixed_steps_that_are_too_long_are_told_of(source: str) -> None:
    m, _ = of_flow_into_c(source)
    run = hb.simulate(m, "1 s", solver="rk4", step="10 ms")
    assert ["fixed steps are too long for what time does in s" in w for w in run.warnings] == [True]
    slow, _ = of_flow_into_c("sin(10*time/(1 s))")
    assert not hb.simulate(slow, "1 s", solver="rk4", step="10 ms").warnings


def test_functions_in_python_are_told_of_unless_steps_are_bounded() -> None:
    m = hb.Model(domain="electrical")
    m.add(s=hb.Sf("u"), c=hb.C("1 F"))
    m.bond("s -> c")
    m.input(u=hb.Input(function=lambda t: math.exp(-(((t - 0.5) / 1e-2) ** 2))))
    assert ["given by functions" in w for w in hb.simulate(m, "1 s").warnings] == [True]
    run = hb.simulate(m, "1 s", max_step="5 ms")
    assert not run.warnings
    assert run["c.q"].at(1.0) == pytest.approx(ROOT * 1e-2, rel=1e-6)


@pytest.mark.c
@pytest.mark.slow
def test_an_exported_program_sees_the_same_peak(tmp_path: Path) -> None:
    from export.programs import ask, compile_quickly, read_events

    from hybond.export.c import to_c

    m = clipped(f"100 V*{gauss(1e-5)}", 50.0)
    program = compile_quickly(to_c(m, until="1 s"), tmp_path, "peak")
    said = read_events(ask(program, "--events"))
    x = math.sqrt(math.log(2.0))
    assert said.times[1:] == pytest.approx([0.5 - x * 1e-5, 0.5 + x * 1e-5], abs=1e-12)
    charge = 100.0 * ROOT * math.erf(x) * 1e-5 - 100.0 * x * 1e-5
    assert said.states["q"] == pytest.approx(charge, rel=1e-6)


CANCELS = {
    "hypot": "hypot({0}, {1})",
    "root": "sqrt(({0})^2 + ({1})^2)",
    "tanh": "3*tanh((({0})/325)^2 + (({1})/325)^2)",
    "quotient": "325/((({0})/325)^2 + (({1})/325)^2)",
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("form", CANCELS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_what_cancels_does_not_make_steps_short(form: str, solver: str) -> None:
    """The amplitude of three balanced phases, by Clarke's transform: constant, onto an RC."""
    phase = [f"325*sin(314*x - {k}*2.0943951023931953)" for k in range(3)]
    alpha = f"(2*{phase[0]} - {phase[1]} - {phase[2]})/3"
    beta = f"({phase[1]} - {phase[2]})/sqrt(3)"
    source = CANCELS[form].format(alpha, beta).replace("x -", "(time/(1 s)) -")
    m = hb.Model("amplitude", domain="electrical")
    m.add(s=hb.Se(f"1 V*({source})"), r=hb.R("1 ohm"), c=hb.C("0.05 F"), i=hb.One())
    m.bond("s -> i -> r", "i -> c")
    run = hb.simulate(m, "1 s", solver=solver, max_steps=20000)
    height = 3.0 * math.tanh(1.0) if form == "tanh" else 325.0
    assert run["c.e"].at(1.0) == pytest.approx(height * (1.0 - math.exp(-20.0)), rel=1e-7)
    assert not run.warnings


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_sine_of_what_is_still_next_to_nothing_is_that(solver: str) -> None:
    """``tanh(t) sin(exp(-((t - 0.8)/0.05)^2))`` onto a capacitor, against Simpson's rule."""
    source = f"tanh(time/(1 s))*sin({gauss(0.05, 0.8)})"
    m = hb.Model("bell", domain="electrical")
    m.add(s=hb.Sf(f"1 A*{source}"), c=hb.C("1 F"), n=hb.Zero(), r=hb.R("1 Mohm"))
    m.bond("s -> n -> c", "n -> r")
    m.signal(q=hb.Integral(f"1 A*{source}"))
    run = hb.simulate(m, "1 s", solver=solver, max_steps=20000)
    t = np.linspace(0.0, 1.0, 20001)
    f = np.tanh(t) * np.sin(np.exp(-(((t - 0.8) / 0.05) ** 2)))
    area = (f[0] + f[-1] + 4.0 * f[1::2].sum() + 2.0 * f[2:-1:2].sum()) / 60000.0
    assert run["q"].at(1.0) == pytest.approx(area, rel=1e-7)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_pulse_that_only_heats_a_resistor_counts(solver: str) -> None:
    """10 V in the form of a bell onto 1 ohm, beside a circuit that it has nothing to do with."""
    m = hb.Model("heated", domain="electrical")
    m.add(V=hb.Se(f"10 V*{gauss(1e-4)}"), r=hb.R("1 ohm"), i=hb.One())
    m.add(c=hb.C("1 F", e="1 V"), o=hb.R("1 ohm"), n=hb.Zero())
    m.bond("V -> i -> r", "c -> n -> o")
    run = hb.simulate(m, "1 s", solver=solver)
    assert run["V.e"].integral() == pytest.approx(10.0 * ROOT * 1e-4, rel=1e-8)
    assert run["V.e"].max() == pytest.approx(10.0, rel=1e-9)
    heat = 100.0 * ROOT * 1e-4 / math.sqrt(2.0)
    assert run.losses()["r"].dissipated == pytest.approx(heat, rel=1e-8)
