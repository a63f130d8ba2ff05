"""Transformers and motors against closed forms, with the bonds at their ports both ways."""

import cmath
import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.linalg import expm

import hybond as hb

SIDES = (
    "hot - t.primary_plus",
    "t.primary_minus - cold",
    "t.secondary_plus - out",
    "t.secondary_minus - cold",
)


def two_sides(volts: str, part: object, ohms: float) -> hb.Model:
    """A source on the primary side, a resistor on the secondary, one ground for both."""
    m = hb.Model("bench", domain="electrical")
    m.add(V=hb.Se(volts), zero=hb.Se(0), hot=hb.Zero(), cold=hb.Zero(), out=hb.Zero(), t=part)
    m.add(load=hb.Submodel("electrical.resistor", R=ohms))
    m.bond("V -> hot", "zero -> cold", "out -> load.plus", "load.minus -> cold")
    return m


@pytest.mark.parametrize("ratio", [4.0, 0.5])
def test_an_ideal_transformer_passes_its_power_on(ratio: float) -> None:
    part = hb.Submodel("electrical.transformer", ratio=ratio)
    for way in every_way(two_sides("12 V", part, 3), *SIDES):
        run = hb.simulate(way, until=1)
        volts = 12 / ratio
        found = [
            run[f"t.{side}_{what}"].at(0.5)
            for side in ("secondary", "primary")
            for what in ("voltage", "current")
        ]
        expected = [volts, volts / 3, 12, volts / 3 / ratio]
        assert found == pytest.approx(expected, rel=1e-13), way.name


def test_a_transformer_isolates() -> None:
    m = two_sides("12 V", hb.Submodel("electrical.transformer", ratio=2), 3)
    m.add(lift=hb.Se("100 V"), high=hb.Zero())
    m.bonds = [b for b in m.bonds if "load.minus" not in b]
    m.bond("lift -> high", "load.minus -> high")
    for way in every_way(m, *SIDES[:3], "t.secondary_minus - high"):
        run = hb.simulate(way, until=1)
        assert run["load.current"].at(0.5) == pytest.approx(2, rel=1e-12), way.name
        assert run["t.primary_current"].at(0.5) == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("values", [{}, {"ratio": 3, "R_core": 200, "L_core": 0.1, "R_primary": 2}])
def test_a_power_transformer_has_the_phasors_of_its_equivalent_circuit(
    values: dict[str, float],
) -> None:
    own = {"ratio": 1, "R_primary": 1, "L_primary": 1e-3, "L_core": 1, "R_core": 1e4}
    own |= {"R_secondary": 1, "L_secondary": 1e-3} | values
    ohms, w = 20.0, 100 * math.pi
    z2 = own["ratio"] ** 2 * (own["R_secondary"] + 1j * w * own["L_secondary"] + ohms)
    core = 1 / (1 / (1j * w * own["L_core"]) + 1 / own["R_core"] + 1 / z2)
    total = own["R_primary"] + 1j * w * own["L_primary"] + core
    primary = 100 / total
    induced = primary * core
    phasors = {
        "t.primary_current": primary,
        "t.secondary_current": induced / z2 * own["ratio"],
        "t.magnetising_current": induced / (1j * w * own["L_core"]),
    }
    # started on the periodic solution it stays there: flows of the coils at time zero
    start = {
        "primary_leakage": primary.imag,
        "magnetising": phasors["t.magnetising_current"].imag,
        "secondary_leakage": phasors["t.secondary_current"].imag,
    }
    part = hb.library.part("electrical.power_transformer")
    for name, amperes in start.items():
        old = part.elements[name]
        part.elements[name] = hb.I(old.value, f=amperes)
    m = two_sides("100*sin(100*pi*time)", hb.Submodel(part, **values), ohms)
    for way in every_way(m, *SIDES)[::5]:
        run = hb.simulate(way, until="5 ms", rtol=1e-8, solver="radau")
        for name, phasor in phasors.items():
            for t in (0.003, 0.005):
                now = (phasor * cmath.exp(1j * w * t)).imag
                assert run[name].at(t) == pytest.approx(now, abs=1e-5), (name, way.name)


def test_every_direction_at_a_power_transformer_is_the_same_transformer() -> None:
    part = hb.Submodel("electrical.power_transformer", R_core="500 ohm")
    m = two_sides("10 V", part, 20)
    found = []
    for way in every_way(m, *SIDES):
        run = hb.simulate(way, until="5 ms", rtol=1e-9)
        found.append([run[f"t.{n}_current"].at(0.005) for n in ("primary", "secondary")])
    assert np.ptp(found, axis=0) == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("k", [0.9, -0.5, 0.0])
def test_coupled_coils_follow_their_linear_equations(k: float) -> None:
    l1, l2, ohms = 2e-3, 5e-3, 3.0
    part = hb.Submodel("electrical.coupled_coils", L1=l1, L2=l2, k=k)
    m = two_sides("12 V", part, ohms)
    m.add(ri=hb.Submodel("electrical.resistor", R=1.5), top=hb.Zero())
    m.bond("hot -> ri.plus", "ri.minus -> top")
    mutual = k * math.sqrt(l1 * l2)
    inverse = np.linalg.inv([[l1, mutual], [mutual, l2]])
    a = -inverse @ np.diag([1.5, ohms])
    rest = np.array([12 / 1.5, 0])
    for way in every_way(m, "top - t.primary_plus", *SIDES[1:]):
        run = hb.simulate(way, until="3 ms", rtol=1e-10)
        now = rest - expm(a * 0.002) @ rest
        found = [run["t.primary_current"].at(0.002), run["t.secondary_current"].at(0.002)]
        assert found == pytest.approx(now, abs=1e-7), way.name
        flux = np.linalg.inv(inverse) @ now
        assert run["t.energy"].at(0.002) == pytest.approx(flux @ now / 2, rel=1e-6)
    assert run["t.energy"].unit == "J"


def on_a_shaft(part: object, *joints: str) -> hb.Model:
    m = hb.Model("drive", domain="electrical")
    m.add(V=hb.Se("24 V"), zero=hb.Se(0), hot=hb.Zero(), cold=hb.Zero(), m=part)
    m.add(w=hb.One(domain="rotational"), brake=hb.Se("-0.02 N*m", domain="rotational"))
    m.bond("V -> hot", "zero -> cold", "brake -> w", *joints)
    return m


@pytest.mark.parametrize("drag", [0.0, 1e-4])
def test_a_dc_motor_follows_its_two_equations(drag: float) -> None:
    k, r, l, j = 0.05, 1.0, 1e-3, 1e-4
    m = on_a_shaft(hb.Submodel("electrical.dc_motor", drag=drag))
    a = np.array([[-r / l, -k / l], [k / j, -drag / j]])
    force = np.array([24 / l, -0.02 / j])
    rest = -np.linalg.solve(a, force)
    for way in every_way(m, "hot - m.plus", "m.minus - cold", "m.shaft - w"):
        run = hb.simulate(way, until="0.1 s", rtol=1e-10)
        for t in (0.005, 0.1):
            now = rest - expm(a * t) @ rest
            found = [run["m.current"].at(t), run["m.speed"].at(t)]
            assert found == pytest.approx(now, rel=1e-6), way.name
            assert run["m.torque"].at(t) == pytest.approx(k * now[0], rel=1e-6)
    assert [run[f"m.{n}"].unit for n in ("current", "speed", "torque")] == ["A", "rad/s", "N*m"]


def test_a_driven_dc_motor_is_a_generator() -> None:
    m = hb.Model("generator", domain="electrical")
    m.add(m=hb.Submodel("electrical.dc_motor", k=0.1, R=2), n=hb.Zero(), zero=hb.Se(0))
    m.add(drive=hb.Sf("100 rad/s", domain="rotational"), w=hb.One(domain="rotational"))
    m.add(load=hb.Submodel("electrical.resistor", R=3), c=hb.Zero())
    m.bond("drive -> w", "zero -> c", "n -> load.plus", "load.minus -> c")
    for way in every_way(m, "m.plus - n", "m.minus - c", "w - m.shaft"):
        run = hb.simulate(way, until="0.1 s")
        assert run["load.current"].at(0.1) == pytest.approx(10 / 5, rel=1e-6), way.name
        assert run["m.torque"].at(0.1) == pytest.approx(-0.1 * 2, rel=1e-6)


def test_a_series_machine_at_rest_makes_the_square_of_its_current() -> None:
    m = on_a_shaft(hb.Submodel("electrical.dc_machine", K=0.02, R=0.5, R_f=1.5, L_f=0.01))
    m.elements["brake"] = hb.Sf(0, domain="rotational")
    joints = ("hot - m.plus", "m.minus - m.field_plus", "m.field_minus - cold", "w - m.shaft")
    for way in every_way(m, *joints)[::5]:
        run = hb.simulate(way, until="20 ms", rtol=1e-9)
        amperes = 12 * (1 - math.exp(-0.02 * 2 / 0.015))
        assert run["m.current"].at(0.02) == pytest.approx(amperes, rel=1e-7), way.name
        assert run["m.torque"].at(0.02) == pytest.approx(0.02 * amperes**2, rel=1e-7)


@pytest.mark.slow
def test_a_separately_excited_machine_runs_up_to_the_speed_of_its_field() -> None:
    m = on_a_shaft(hb.Submodel("electrical.dc_machine", drag=0, R_f=12, L_f=1))
    m.elements["brake"] = hb.Se(0, domain="rotational")
    joints = ["hot - m.plus", "m.minus - cold", "hot - m.field_plus", "m.field_minus - cold"]
    for way in every_way(m, *joints, "w - m.shaft"):
        run = hb.simulate(way, until="5 s")
        assert run["m.field_current"].at(5) == pytest.approx(2, rel=1e-6), way.name
        assert run["m.speed"].at(5) == pytest.approx(24 / (0.5 * 2), rel=1e-5)


THREE = tuple(f"{phase} - m.{phase}" for phase in "abc")


def synchronous(volts: tuple[str, str, str], **values: float) -> hb.Model:
    m = hb.Model("drive", domain="electrical")
    m.add(m=hb.Submodel("electrical.synchronous_motor", **values))
    for phase, text in zip("abc", volts):
        m.add(**{f"V_{phase}": hb.Se(text), phase: hb.Zero()})
        m.bond(f"V_{phase} -> {phase}")
    return m


def dq(speed: float, v_d: float, v_q: float) -> tuple[np.ndarray, np.ndarray]:
    """The equations of Park at constant electrical speed: rates a @ i + force."""
    r, l, psi = 0.5, 2e-3, 0.1
    a = np.array([[-r / l, speed], [-speed, -r / l]])
    return a, np.array([v_d, v_q - speed * psi]) / l


@pytest.mark.sampled(1)
@pytest.mark.parametrize("start", [0.0, 0.3])
def test_a_driven_synchronous_motor_has_parks_currents(start: float) -> None:
    # driven at 100 rad/s from angle `start`, on voltages that are v_d = -3 V, v_q = 30 V
    speed = 400.0
    angle = f"({4 * start} + {speed}*time)"
    volts = tuple(
        f"-3*cos({angle} - {lag}*2*pi/3) - 30*sin({angle} - {lag}*2*pi/3)" for lag in (0, 1, 2)
    )
    m = synchronous(volts, angle0=start)
    m.add(drive=hb.Sf("100 rad/s", domain="rotational"), w=hb.One(domain="rotational"))
    m.bond("drive -> w")
    a, force = dq(speed, -3, 30)
    rest = -np.linalg.solve(a, force)
    for way in every_way(m, *THREE, "w - m.shaft")[::5]:
        run = hb.simulate(way, until="10 ms", rtol=1e-10)
        for t in (0.002, 0.01):
            i_d, i_q = rest - expm(a * t) @ rest
            found = [run["m.i_d"].at(t), run["m.i_q"].at(t)]
            assert found == pytest.approx([i_d, i_q], abs=1e-6), way.name
            assert run["m.torque"].at(t) == pytest.approx(1.5 * 4 * 0.1 * i_q, abs=1e-6)
            theta = 4 * start + speed * t
            phase_a = i_d * math.cos(theta) - i_q * math.sin(theta)
            assert run["m.current_a"].at(t) == pytest.approx(phase_a, abs=1e-6)
            total = sum(run[f"m.current_{p}"].at(t) for p in "abc")
            assert total == pytest.approx(0, abs=1e-9)


@pytest.mark.slow
def test_a_synchronous_motor_that_runs_down_in_a_short_circuit_keeps_energy() -> None:
    m = synchronous(("0", "0", "0"))
    m.elements["m"] = hb.Submodel(spinning(200.0))
    for way in every_way(m, *THREE)[::7]:
        run = hb.simulate(way, until="20 ms", rtol=1e-9)
        assert run["m.speed"].at(0.02) < 190, way.name
        assert run.audit().energy < 1e-7
        assert run.audit().power < 1e-11


def spinning(speed: float) -> hb.Model:
    part = hb.library.part("electrical.synchronous_motor")
    part.elements["rotor"] = hb.I("J", f=speed, domain="rotational")
    return part
