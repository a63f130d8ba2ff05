"""Pulses by a phase that is not written in the expression: none of them is passed over in silence.

A phase turns by 20 rad from 0.5 on, and each time it is a multiple of pi something is not nothing
for ``WIDTH`` of its turn. Six pulses, each of the area ``sqrt(pi)*WIDTH/speed`` to the square of
the width.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import hybond as hb

WIDTH = 1e-4
PULSE = f"exp(-(sin(phase)/{WIDTH!r})^2)"
MET = [k * math.pi - 0.5 for k in range(1, 7)]
"""What the phase has turned by at each of them."""
EVEN = sum(math.sqrt(math.pi) * WIDTH / 20.0 for _ in MET)


def of_signals(**rates: str) -> Callable[[hb.Model, bool], None]:
    def add(m: hb.Model, back: bool) -> None:
        start = {"phase": 0.5, **({"speed": 20.0} if rates.get("speed") == "0*time" else {})}
        m.signal(**{n: hb.Integral(r, start=start.get(n, 0.0)) for n, r in rates.items()})

    return add


def of_a_bond(
    source: hb.Element, element: hb.Element, rate: str
) -> Callable[[hb.Model, bool], None]:
    """Return what adds a source on an element, and a phase that is the integral of what it says."""

    def add(m: hb.Model, back: bool) -> None:
        m.add(q=source, r=element, w=hb.One() if "f" in rate else hb.Zero())
        m.bond("q -> w", "w -> r")
        m.signal(phase=hb.Integral(rate, start=0.5))

    return add


def of_a_flywheel(m: hb.Model, back: bool) -> None:
    m.add(J=hb.I(2.0, f=-20.0 if back else 20.0), w=hb.One(), bearing=hb.R(0.0))
    m.bond("w -> J", "bearing -> w" if back else "w -> bearing")
    m.signal(phase=hb.Integral("-w.f" if back else "w.f", start=0.5))


def of_a_driven_flywheel(m: hb.Model, back: bool) -> None:
    """From rest, by a torque that is constant: the phase is ``0.5 + 20 t^2``."""
    m.add(J=hb.I(2.0), w=hb.One(), T=hb.Se(-80.0 if back else 80.0))
    m.bond("w -> T" if back else "T -> w", "w -> J")
    m.signal(phase=hb.Integral("w.f", start=0.5))


def evenly(turned: float) -> float:
    return 20.0


PHASES: dict[str, tuple[Callable[[hb.Model, bool], None], Callable[[float], float]]] = {
    "integral of a constant": (of_signals(phase="20"), evenly),
    "integral of an integral": (of_signals(speed="0*time", phase="speed"), evenly),
    "of a speed that grows": (of_signals(speed="40", phase="speed"), lambda s: math.sqrt(80.0 * s)),
    "of three integrals": (
        of_signals(a="120", speed="a", phase="speed"),
        lambda s: 60.0 * (s / 20.0) ** (2.0 / 3.0),
    ),
    "flow of a source": (of_a_bond(hb.Sf(20.0), hb.R(1.0), "q.f"), evenly),
    "flow of a resistor": (of_a_bond(hb.Se(40.0), hb.R(2.0), "r.f"), evenly),
    "effort of a resistor": (of_a_bond(hb.Sf(40.0), hb.R(0.5), "r.e"), evenly),
    "flywheel": (of_a_flywheel, evenly),
    "driven flywheel": (of_a_driven_flywheel, lambda s: math.sqrt(80.0 * s)),
}


def into_c(m: hb.Model, back: bool) -> str:
    m.add(s=hb.Sf(f"-{PULSE}" if back else PULSE), c=hb.C(1.0))
    m.bond("c -> s" if back else "s -> c")
    m.signal(charge=hb.Integral("-s.f" if back else "s.f"))
    return "charge"


def through_g(m: hb.Model, back: bool) -> str:
    m.add(s=hb.Se(1.0), g=hb.G(PULSE), n=hb.Zero())
    m.bond("s -> n", "g -> n" if back else "n -> g")
    m.signal(charge=hb.Integral("-g.f" if back else "g.f"))
    return "charge"


def through_tf(m: hb.Model, back: bool) -> str:
    m.add(s=hb.Sf(-1.0 if back else 1.0), t=hb.TF(PULSE), c=hb.C(1.0))
    m.bond("s -> t -> c")
    m.signal(charge=hb.Integral("-c.f" if back else "c.f"))
    return "charge"


PULSED = {"source": into_c, "conductance": through_g, "transformer": through_tf}


def made(phase: str, pulsed: str, *, back: bool) -> tuple[hb.Model, str, float]:
    m = hb.Model("pulses")
    add, speed = PHASES[phase]
    add(m, back)
    charge = sum(math.sqrt(math.pi) * WIDTH / speed(s) for s in MET)
    return m, PULSED[pulsed](m, back), charge


@pytest.mark.sampled(3)
@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("phase", PHASES)
def test_the_charge_of_each_pulse_of_a_phase_arrives(phase: str, *, back: bool) -> None:
    m, q, charge = made(phase, "source", back=back)
    assert hb.simulate(m, 1.0).final[q] == pytest.approx(charge, rel=2e-5)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("solver", ["rk45", "radau", "exact", "auto"])
@pytest.mark.parametrize("pulsed", PULSED)
def test_wherever_the_pulse_acts_and_whatever_solves(
    pulsed: str, solver: str, *, back: bool
) -> None:
    m, q, charge = made("flywheel", pulsed, back=back)
    assert hb.simulate(m, 1.0, solver=solver).final[q] == pytest.approx(charge, rel=2e-5)


@pytest.mark.parametrize("solver", ["euler", "rk4"])
@pytest.mark.parametrize("phase", ["integral of an integral", "flow of a source", "flywheel"])
def test_fixed_steps_that_pass_over_pulses_of_a_phase_say_so(phase: str, solver: str) -> None:
    run = hb.simulate(made(phase, "source", back=False)[0], 1.0, solver=solver, step=1e-3)
    assert any("fixed steps are too long for what time does in s" in w for w in run.warnings)


@pytest.mark.parametrize("phase", PHASES)
def test_a_guard_sees_each_pulse_of_a_phase(phase: str) -> None:
    m = hb.Model("seen")
    add, _ = PHASES[phase]
    add(m, False)
    m.machine(
        "g",
        states={"low": [], "high": []},
        start="low",
        rules=[f"low -> high when {PULSE} > 0.5", f"high -> low when {PULSE} < 0.5"],
    )
    assert len(hb.simulate(m, 1.0).events) == 1 + 2 * len(MET)


@pytest.mark.parametrize("width", [1e-7, 1e-2])
def test_a_cam_turns_by_itself(width: float) -> None:
    """What pushes is the phase of what it pushes: each pulse does the work of its area."""
    m = hb.Model("cam")
    m.add(J=hb.I(2.0, f=20.0), w=hb.One(), T=hb.Se(f"exp(-(sin(phase)/{width!r})^2)"))
    m.bond("T -> w -> J")
    m.signal(phase=hb.Integral("w.f", start=0.5), work=hb.Integral("T.e*w.f"))
    area = math.sqrt(math.pi) * width * (1.0 + width**2 / 4.0)
    assert hb.simulate(m, 1.0).final["work"] == pytest.approx(len(MET) * area, rel=1e-4)


def test_what_only_turns_evenly_bounds_no_step() -> None:
    """A sine of an angle is seen by any step that its error allows."""
    m = hb.Model("even")
    m.add(J=hb.I(2.0, f=1.0), w=hb.One(), T=hb.Se("0.1*sin(phase)"))
    m.bond("T -> w -> J")
    m.signal(phase=hb.Integral("w.f", start=0.5))
    run = hb.simulate(m, 1.0)
    assert run.stats["steps"] < 12
    assert not run.warnings


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("pulse", "area"),
    [
        ("tanh((phase-3)/w) - tanh((phase-3-w)/w)", 2.0),
        ("(1+tanh((phase-3)/w))*(1-tanh((phase-3)/w))", 2.0),
        ("2*exp((phase-3)/w)/(1+exp((phase-3)/w))^2", 2.0),
        ("2*exp((3-phase)/w)/(1+exp((3-phase)/w))^2", 2.0),
        ("4/(exp((phase-3)/w)+exp((3-phase)/w))^2", 2.0),
        ("1/cosh((phase-3)/w)^2", 2.0),
        ("1/(1+exp((3-phase)/w)) - 1/(1+exp((3+w-phase)/w))", 1.0),
    ],
    ids=[
        "difference",
        "product",
        "quotient",
        "turned round",
        "sum below",
        "hyperbolic",
        "sigmoids",
    ],
)
@pytest.mark.parametrize("phase", ["flywheel", "time", "voltage", "speed"])
def test_what_rises_and_falls_again_is_seen(pulse: str, area: float, phase: str) -> None:
    m = hb.Model("bell")
    if phase == "flywheel":
        of_a_flywheel(m, False)
    elif phase == "time":
        m.signal(phase="0.5 + 20*time")
    else:
        # what is filled evenly from 0.5 on: no expression reads what it holds
        filled = hb.C(1.0, e=0.5) if phase == "voltage" else hb.I(1.0, f=0.5)
        m.add(u=hb.Sf(20.0) if phase == "voltage" else hb.Se(20.0), filled=filled)
        m.bond("u -> filled")
        m.signal(phase="filled.e" if phase == "voltage" else "filled.f")
    m.parameter(w=WIDTH)
    m.add(s=hb.Sf(pulse), c=hb.C(1.0))
    m.bond("s -> c")
    m.signal(charge=hb.Integral("s.f"))
    assert hb.simulate(m, 1.0).final["charge"] == pytest.approx(area * WIDTH / 20.0, rel=2e-5)


@pytest.mark.parametrize(
    ("rise", "charge"),
    [
        ("tanh((phase-3)/w)", 0.75),
        ("0.5*phase - tanh((phase-3)/w)", 4.5),
        ("1 - tanh(sinh((3-phase)/w)/4)", 1.75),
        ("2/(1+exp((3-phase)/w)) - 1", 0.75),
    ],
    ids=["alone", "in a sum", "within another", "sigmoid"],
)
def test_what_only_rises_is_as_exact_without_a_look_ahead(rise: str, charge: float) -> None:
    """From 0.5 to 20.5 it passes 3: 2.5 rad of one sign, 17.5 rad of the other."""
    m = hb.Model("rise")
    of_a_flywheel(m, False)
    m.parameter(w=WIDTH)
    m.add(s=hb.Sf(rise), c=hb.C(1.0))
    m.bond("s -> c")
    m.signal(charge=hb.Integral("s.f"))
    run = hb.simulate(m, 1.0)
    assert run.final["charge"] == pytest.approx(charge, rel=1e-6)
    assert run.stats["steps"] < 200


@pytest.mark.parametrize("solver", ["auto", "rk45", "exact"])
@pytest.mark.parametrize(("width", "cut"), [(1e-3, 0.4), (1e-3, 3.3), (1e-5, 0.55), (1e-5, 0.61)])
def test_a_run_that_goes_on_foresees_phases_as_one_that_was_not_interrupted(
    width: float, cut: float, solver: str
) -> None:
    m = hb.Model("cam", domain="rotational")
    m.add(J=hb.I("1 kg*m^2", f="5 rad/s"), B=hb.R("0.01 N*m*s/rad"), w=hb.One())
    m.add(T=hb.Se(f"exp(-((mod(a, 2*pi) - 3)/{width})^2)*1 [N*m]"))
    m.bond("T -> w -> J", "w -> B")
    m.signal(a=hb.Integral("w.f/(1 [rad])"))
    m.experiment["until"] = "4 s"
    whole = hb.simulate(m, solver=solver)
    parts = hb.simulate(m, start=hb.simulate(m, until=cut, solver=solver), solver=solver)
    assert parts["w.f"].at(4.0) == whole["w.f"].at(4.0)
    assert parts["a"].at(4.0) == whole["a"].at(4.0)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(
    ("speed", "pull", "car"), [(60.0, 400.0, 11.0), (40.0, 100.0, 12.0), (20.0, 10.0, 12.0)]
)
def test_the_foot_of_a_pulse_that_is_no_number_any_more_makes_no_steps_short(
    speed: float, pull: float, car: float, back: bool
) -> None:
    """A spinning rim slows down beside a car: what damps it at rest is 1e-320 N and less here."""
    m = hb.Model("tread", domain="translational")
    m.add(
        F=hb.Se(pull if back else -pull), r=hb.One(), rim=hb.I("1 kg", f=-speed if back else speed)
    )
    m.add(c=hb.One(), car=hb.I("900 kg", f=car), patch=hb.Zero(), w=hb.One())
    fades = "exp(-(max(abs(c.f), abs(r.f))/(0.5 [m/s]))^2 - (10*u)^2)"
    m.add(damp=hb.R({"e": f"2000*{fades}*f"}))
    m.bond("r -> F" if back else "F -> r", "rim -> r" if back else "r -> rim")
    m.bond("r -> patch -> c -> car", "patch -> w -> damp")
    m.signal(u=hb.Integral("(w.f - 10*u)*5", start=0))
    run = hb.simulate(m, 3.0)
    assert run["r.f"].at(3.0) == pytest.approx(speed - 3.0 * pull, rel=1e-12)
    assert run["c.f"].at(3.0) == pytest.approx(car, rel=1e-12)
    assert run.stats["steps"] < 200


def test_a_wheel_with_a_damped_tread_slows_down_in_few_steps() -> None:
    """As one of the library: its exact end is known where the road holds it, it rolls."""
    m = hb.Model("wheel", domain="rotational")
    m.add(t=hb.Submodel("rotational.torque", inputs={"torque": "-150"}))
    m.add(J=hb.Submodel("rotational.inertia", J="1 kg*m^2", w=120.0))
    m.add(tire=hb.Submodel("rotational.road_wheel", mu=0.2, damping="2 kN*s/m"))
    m.add(car=hb.Submodel("translational.mass", m="900 kg", v=11.5))
    m.bond("t.shaft -> J.shaft -> tire.shaft", "tire.hub -> car.flange")
    run = hb.simulate(m, 3.0)
    # momentum about the contact: the rim's over the radius, and the car's
    kept = run.final["J.speed"] / 0.3 + 900.0 * run.final["car.speed"]
    assert kept == pytest.approx(120.0 / 0.3 + 900.0 * 11.5 - 3.0 * 150.0 / 0.3, rel=1e-9)
    assert run.stats["steps"] < 3000
