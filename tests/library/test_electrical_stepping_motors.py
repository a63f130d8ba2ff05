"""Brushless and stepper motors against their phase equations and closed forms."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.integrate import solve_ivp

import hybond as hb

K, R, L = 0.05, 0.5, 0.5e-3


def trapezoid(angle: np.ndarray) -> np.ndarray:
    """The back-EMF of a winding: corners at 30, 150, 210, 330 degrees."""
    corners = np.radians([0, 30, 150, 210, 330, 360])
    return np.interp(np.mod(angle, 2 * np.pi), corners, [0, 1, 1, -1, -1, 0])


def turning(part: str, speed: float, **values: float) -> hb.Model:
    m = hb.Model("drive", domain="electrical")
    m.add(m=hb.Submodel(f"electrical.{part}", **values))
    m.add(drive=hb.Sf(speed, domain="rotational"), w=hb.One(domain="rotational"))
    m.bond("drive -> w")
    return m


@pytest.mark.parametrize("amperes", [3.0, -2.0])
def test_two_flat_phases_make_twice_the_torque_of_one(amperes: float) -> None:
    # a and b are flat from 30 to 90 degrees: begin at 35, end at 85
    m = turning("brushless_motor", 100.0, angle0=math.radians(35) / 4)
    m.add(I=hb.Sf(amperes), i=hb.One(), a=hb.Zero(), b=hb.Zero(), zero=hb.Se(0))
    m.bond("b -> i -> a", "I -> i", "zero -> b")
    until = math.radians(50) / 4 / 100
    for way in every_way(m, "a - m.a", "m.b - b", "w - m.shaft")[::7]:
        run = hb.simulate(way, until=until)
        for t in (0.1 * until, 0.9 * until):
            assert run["m.torque"].at(t) == pytest.approx(2 * K * amperes, rel=1e-9), way.name
            volts = 2 * K * 100 + 2 * R * amperes
            assert run["a.e"].at(t) == pytest.approx(volts, rel=1e-7)
        assert run["m.heat"].at(until) == pytest.approx(2 * R * amperes**2)


@pytest.mark.slow
def test_a_driven_brushless_motor_follows_its_three_phase_equations() -> None:
    size, speed, w = 3.0, 60.0, 240.0
    m = turning("brushless_motor", speed, angle0=0.05)
    for k, phase in enumerate("abc"):
        m.add(**{f"V_{phase}": hb.Se(f"{size}*sin({w}*time - {k}*2*pi/3)"), phase: hb.Zero()})
        m.bond(f"V_{phase} -> {phase}")
    lags = np.array([0, 1, 2]) * 2 * np.pi / 3

    def rates(t: float, i: np.ndarray) -> np.ndarray:
        behind = size * np.sin(w * t - lags) - R * i - K * speed * trapezoid(w * t + 0.2 - lags)
        return (behind - behind.mean()) / L

    at = [0.004, 0.0151, 0.03]
    told = solve_ivp(rates, (0, 0.03), [0, 0, 0], rtol=1e-8, atol=1e-10, t_eval=at, max_step=2e-4)
    for way in every_way(m, "a - m.a", "b - m.b", "c - m.c", "w - m.shaft")[::5]:
        run = hb.simulate(way, until="30 ms", rtol=1e-9, atol=1e-11)
        for k, phase in enumerate("abc"):
            assert run[f"m.current_{phase}"].at(at) == pytest.approx(told.y[k], abs=2e-5), way.name
        torque = K * (told.y.T * trapezoid(w * np.array(at)[:, None] + 0.2 - lags)).sum(axis=1)
        assert run["m.torque"].at(at) == pytest.approx(torque, abs=3e-6)


def test_halls_change_where_the_flat_parts_begin_and_end() -> None:
    run = hb.simulate(turning_alone(), until=1)
    t = (np.arange(72) * 5 + 2.5) / 360
    degrees = t * 360
    for phase, first in zip("abc", (30, 150, 270)):
        expected = np.mod(degrees - first, 360) < 180
        assert (run[f"m.hall_{phase}"].at(t) == expected).all(), phase
        shape = trapezoid(np.radians(degrees - first + 30))
        assert run[f"m.shape_{phase}"].at(t) == pytest.approx(shape, abs=1e-9)


def turning_alone() -> hb.Model:
    """One electrical turn in a second, without currents."""
    m = turning("brushless_motor", 2 * math.pi / 4)
    m.bond("w -> m.shaft")
    return m


@pytest.mark.slow
def test_commutated_by_its_halls_a_motor_runs_up_to_half_the_voltage_per_phase() -> None:
    m = hb.Model("drive", domain="electrical")
    m.add(m=hb.Submodel("electrical.brushless_motor", drag=0), top=hb.Zero(), bottom=hb.Zero())
    m.add(V=hb.Se("24 V"), zero=hb.Se(0))
    halls = {f"hall_{p}": f"m.hall_{p}" for p in "abc"}
    m.add(gates=hb.Submodel("control.six_step", inputs=halls))
    for phase, upper, lower in (("a", 1, 4), ("b", 3, 6), ("c", 5, 2)):
        wires = {"upper": f"gates.gate_{upper}", "lower": f"gates.gate_{lower}"}
        m.add(**{f"leg_{phase}": hb.Submodel("electrical.half_bridge", inputs=wires)})
        m.bond(f"top -> leg_{phase}.plus", f"leg_{phase}.minus -> bottom")
        m.bond(f"leg_{phase}.out -> m.{phase}")
    m.bond("V -> top", "zero -> bottom")
    run = hb.simulate(m, until="0.15 s")
    assert run["m.speed"].at(0.15) == pytest.approx(24 / (2 * K), rel=2e-3)
    assert run["m.torque"].at(0.003) == pytest.approx(
        2 * K * run["m.current_c"].at(0.003), rel=1e-6
    )


SIDES = ("a - m.a_plus", "m.a_minus - zero", "b - m.b_plus", "m.b_minus - zero")


def stepper(a: str, b: str, kind: type = hb.Se, **values: object) -> hb.Model:
    m = hb.Model("drive", domain="electrical")
    m.add(m=hb.Submodel("electrical.stepper_motor", **values), G=hb.Se(0), zero=hb.Zero())
    m.add(A=kind(a), a=hb.Zero(), B=kind(b), b=hb.Zero())
    m.bond("A -> a", "B -> b", "G -> zero")
    return m


def test_a_stepper_rests_where_its_currents_point() -> None:
    for volts_a, volts_b, steps in (
        (3, 0, 0),
        (2, 2, 0.5),
        (0, 3, 1),
        (-1.5, 1.5 * math.sqrt(3), 4 / 3),
    ):
        start = (steps - 0.3) * math.pi / 100
        m = stepper(str(volts_a), str(volts_b), detent=1e-9, angle0=start, drag=5e-3)
        for way in every_way(m, *SIDES)[:: 5 if steps == 0.5 else 15]:
            run = hb.simulate(way, until="0.3 s")
            assert run["m.steps"].at(0.3) == pytest.approx(steps, abs=1e-4), way.name
            assert run["m.current_a"].at(0.3) == pytest.approx(volts_a / 1.5, abs=1e-3)


def test_a_stepper_swings_about_its_step_and_keeps_energy() -> None:
    # currents held: (k*I + 4*detent)*teeth is the stiffness of a small swing
    j, detent, amperes, small = 3e-5, 0.04, 1.2, 1e-5
    m = stepper(str(amperes), "0", hb.Sf, detent=detent, drag=0, angle0=small)
    w = math.sqrt(50 * (0.5 * amperes + 4 * detent) / j)
    run = hb.simulate(every_way(m, *SIDES)[3], until="10 ms", rtol=1e-9, atol=1e-15)
    t = np.array([0.002, 0.0055, 0.01])
    assert run["m.angle"].at(t) == pytest.approx(small * np.cos(w * t), abs=1e-6 * small * w * 0.01)
    assert run.audit().energy < 1e-8


def test_a_step_of_a_stepper_is_a_quarter_of_a_tooth() -> None:
    m = stepper("3*u.a", "3*u.b", drag=3e-3)
    m.add(u=hb.Submodel("control.microstep", inputs={"steps": "15*time"}))
    run = hb.simulate(every_way(m, *SIDES)[0], until="0.2 s")
    assert run["m.steps"].at([0.064, 0.13, 0.199]) == pytest.approx([0, 1, 2], abs=2e-3)
    assert run["m.angle"].at(0.199) == pytest.approx(math.radians(3.6), rel=2e-3)


def reluctance(kind: type, **values: object) -> hb.Model:
    """A motor with one winding fed, the others shorted."""
    m = hb.Model("drive", domain="electrical")
    m.add(m=hb.Submodel("electrical.reluctance_motor", **values), G=hb.Se(0), zero=hb.Zero())
    m.add(A=kind("feed"), a=hb.Zero())
    m.bond("A -> a", "G -> zero")
    for phase in "bc":
        m.bond(f"m.{phase}_plus -> zero", f"zero -> m.{phase}_minus")
    return m


@pytest.mark.parametrize("amperes", [5.0, -5.0])
def test_a_current_pulls_a_tooth_to_its_winding(amperes: float) -> None:
    m = reluctance(hb.Sf, angle0=0.1)
    m.input(feed=hb.Input(constant=amperes))
    m.add(drive=hb.Sf(20, domain="rotational"), w=hb.One(domain="rotational"))
    m.bond("drive -> w")
    for way in every_way(m, "a - m.a_plus", "m.a_minus - zero", "w - m.shaft")[::7]:
        run = hb.simulate(way, until="20 ms", rtol=1e-9)
        for t in (0.004, 0.02):
            angle = 4 * (0.1 + 20 * t)
            torque = -0.5 * amperes**2 * 4 * 0.022 * math.sin(angle)
            assert run["m.torque"].at(t) == pytest.approx(torque, rel=1e-7), way.name
            flux = amperes * (0.03 + 0.022 * math.cos(angle))
            assert run["m.flux_a"].at(t) == pytest.approx(flux, rel=1e-8)
            volts = amperes * (1 - 20 * 4 * 0.022 * math.sin(angle))
            assert run["a.e"].at(t) == pytest.approx(volts, rel=1e-6)


def test_a_reluctance_motor_starts_as_its_equations_do_and_keeps_energy() -> None:
    m = reluctance(hb.Se, angle0=-0.5)
    m.input(feed=hb.Input(constant=40))

    def rates(_: float, x: np.ndarray) -> list[float]:
        flux, speed, angle = x
        coil = 0.03 + 0.022 * math.cos(4 * angle)
        torque = -0.5 * (flux / coil) ** 2 * 4 * 0.022 * math.sin(4 * angle)
        return [40 - flux / coil, (torque - 1e-3 * speed) / 1e-3, speed]

    told = solve_ivp(rates, (0, 0.1), [0, 0, -0.5], rtol=1e-9, atol=1e-11).y[:, -1]
    ways = every_way(m, "a - m.a_plus", "m.a_minus - zero")
    run = hb.simulate(ways[1], until="0.1 s", rtol=1e-9, atol=1e-11)
    found = [run[f"m.{n}"].at(0.1) for n in ("flux_a", "speed", "angle")]
    assert found == pytest.approx(told, rel=1e-6)
    assert run.audit().energy < 1e-8
