"""Parts of rotational mechanics that do not switch, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import trials
from scipy.integrate import quad
from scipy.special import ellipk

import hybond as hb

FRAME = hb.Submodel("rotational.frame")
T = np.linspace(0.0, 2.0, 9)


def inertia(J: float = 1.0, **start: object) -> hb.Submodel:
    return hb.Submodel("rotational.inertia", J=J, **start)


def torque(newton_metres: str) -> hb.Submodel:
    return hb.Submodel("rotational.torque", inputs={"torque": newton_metres})


@pytest.mark.parametrize(("J", "k"), [(1.0, 1.0), (0.02, 5.0)])
def test_an_inertia_on_a_torsion_spring_swings_with_its_natural_frequency(
    J: float, k: float
) -> None:
    parts = {
        "wall": FRAME,
        "s": hb.Submodel("rotational.torsion_spring", k=k, twist0="0.1 rad"),
        "J": inertia(J, angle0="30 deg"),
    }
    swing = 0.1 * np.cos(math.sqrt(k / J) * T)
    for run in trials("wall.shaft - s.left, s.right - J.shaft", 2, **parts):
        assert run["s.twist"].at(T) == pytest.approx(swing, abs=1e-8)
        assert run["J.angle"].at(T) == pytest.approx(math.pi / 6 - 0.1 + swing, abs=1e-8)
        assert run["s.torque"].at(T) == pytest.approx(k * swing, abs=1e-7)
        assert run["wall.torque"].at(T) == pytest.approx(-k * swing, abs=1e-7)
    for run in trials("J.shaft - s.left, s.right - wall.shaft", 2, **parts):
        assert run["J.angle"].at(T) == pytest.approx(math.pi / 6 + 0.1 - swing, abs=1e-8)


@pytest.mark.parametrize(("J", "d"), [(1.0, 1.0), (0.5, 3.0), (2.0, 0.0)])
def test_a_damper_takes_speed_exponentially(J: float, d: float) -> None:
    parts = {
        "wall": FRAME,
        "d": hb.Submodel("rotational.damper", d=d),
        "J": inertia(J, w="3 rad/s"),
    }
    speed = 3 * np.exp(-d / J * T)
    for run in trials("wall.shaft - d.left, d.right - J.shaft", 2, **parts):
        assert run["J.speed"].at(T) == pytest.approx(speed, rel=1e-8, abs=1e-9)
        assert run["d.torque"].at(T) == pytest.approx(d * speed, rel=1e-8, abs=1e-9)
        assert run["d.power"].at(T) == pytest.approx(d * speed**2, rel=1e-8, abs=1e-9)
    for run in trials("J.shaft - d.left, d.right - wall.shaft", 2, **parts):
        assert run["d.speed"].at(T) == pytest.approx(-speed, rel=1e-8, abs=1e-9)


def test_sources_of_torque_and_speed() -> None:
    for run in trials("t.shaft - J.shaft", 2, t=torque("3*time/(1 [s])"), J=inertia(2.0)):
        assert run["J.speed"].at(T) == pytest.approx(0.75 * T**2, abs=1e-9)
        assert run["J.momentum"].at(2) == pytest.approx(6.0)
        assert run["t.power"].at(2) == pytest.approx(6 * run["t.speed"].at(2))
    parts = {
        "u": hb.Submodel("rotational.speed", inputs={"speed": "3 [rad/s^2]*time"}),
        "d": hb.Submodel("rotational.damper", d=0.5),
        "J": inertia(0.2),
        "wall": FRAME,
    }
    for run in trials("u.shaft - d.left, d.right - wall.shaft, u.shaft - J.shaft", 2, **parts):
        assert run["u.torque"].at(T) == pytest.approx(1.5 * T + 0.6)
        assert run["u.power"].at(2) == pytest.approx(3.6 * 6)


@pytest.mark.parametrize("ratio", [2.0, -3.0, 0.1])
def test_a_gear_keeps_power_and_changes_inertia(ratio: float) -> None:
    parts = {
        "t": torque("4"),
        "a": inertia(0.5),
        "g": hb.Submodel("rotational.gear", ratio=ratio),
        "b": inertia(3.0),
    }
    for run in trials("t.shaft -> a.shaft, a.shaft - g.input, g.output - b.shaft", 2, **parts):
        gain = 4 / (0.5 + 3.0 / ratio**2)
        assert run["a.speed"].at(2) == pytest.approx(2 * gain)
        assert run["b.speed"].at(2) == pytest.approx(2 * gain / ratio)
        assert run["g.torque_input"].at(1) == pytest.approx(3 * gain / ratio**2)
        assert run["g.torque_output"].at(1) == pytest.approx(3 * gain / ratio)
        given = run["g.torque_output"].at(2) * run["b.speed"].at(2)
        assert run["g.power"].at(2) == pytest.approx(given)


PLANETS = ("p.sun - a.shaft, p.ring - b.shaft, p.carrier - c.shaft", ["sun", "ring", "carrier"])


@pytest.mark.parametrize("ratio", [2.0, 3.7])
def test_a_planetary_gear_between_three_inertias(ratio: float) -> None:
    joints, shafts = PLANETS
    parts = {
        "p": hb.Submodel("rotational.planetary_gear", ratio=ratio),
        "a": inertia(0.1),
        "b": inertia(0.5, w=1.0),
        "c": inertia(2.0, w=ratio / (1 + ratio)),
        "t": torque("3"),
    }
    tie = np.array([1, ratio, -(1 + ratio)])
    J = np.diag([0.1, 0.5, 2.0])
    matrix = np.block([[J, tie[:, None]], [tie[None, :], np.zeros((1, 1))]])
    *gain, mesh = np.linalg.solve(matrix, [3, 0, 0, 0])
    start = np.array([0, 1, ratio / (1 + ratio)])
    for run in trials(f"{joints}, t.shaft -> a.shaft", 2, **parts):
        speeds = np.array([run[f"{k}.speed"].at(2) for k in "abc"])
        assert speeds == pytest.approx(start + 2 * np.array(gain))
        taken = np.array([run[f"p.torque_{shaft}"].at(1) for shaft in shafts])
        assert taken == pytest.approx(mesh * tie)
        now = np.array([run[f"{k}.speed"].at(1) for k in "abc"])
        assert taken @ now == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(("fixed", "out"), [("ring", "carrier"), ("carrier", "ring")])
def test_a_planetary_gear_with_a_fixed_shaft_is_a_gear(fixed: str, out: str) -> None:
    parts = {
        "p": hb.Submodel("rotational.planetary_gear", ratio=2.5),
        "u": hb.Submodel("rotational.speed", inputs={"speed": "7"}),
        "d": hb.Submodel("rotational.damper", d=2.0),
        "wall": FRAME,
    }
    joints = f"u.shaft - p.sun, p.{fixed} - wall.shaft, p.{out} - d.right, d.left - wall.shaft"
    speed = 2.0 if fixed == "ring" else -2.8
    for run in trials(joints, 1, **parts):
        assert run["d.speed"].at(1) == pytest.approx(speed)
        assert run["p.torque_sun"].at(1) == pytest.approx(2 * speed**2 / 7)


def test_a_planetary_gear_with_a_free_shaft_passes_no_torque() -> None:
    parts = {
        "p": hb.Submodel("rotational.planetary_gear", ratio=2.0),
        "a": inertia(1.0, w="6 rad/s"),
        "b": inertia(1.0),
    }
    for run in trials("p.sun - a.shaft, p.carrier - b.shaft", 1, **parts):
        assert (run["a.speed"].at(1), run["b.speed"].at(1)) == (6, 0)
        assert run["p.torque_sun"].at(1) == 0
        assert run["p.ring.f"].at(1) == pytest.approx(-3.0)


@pytest.mark.parametrize("r", [0.05, 2.0])
def test_a_rack_and_pinion_moves_a_mass(r: float) -> None:
    parts = {
        "t": torque("3"),
        "J": inertia(0.4),
        "g": hb.Submodel("rotational.rack_and_pinion", r=r),
        "m": hb.Submodel("translational.mass", m="6 kg"),
    }
    gain = 3 / (0.4 + 6 * r**2)
    for run in trials("t.shaft -> J.shaft, J.shaft - g.shaft, g.rack - m.flange", 1, **parts):
        assert run["J.speed"].at(1) == pytest.approx(gain)
        assert run["m.position"].at(1) == pytest.approx(gain * r / 2)
        assert run["g.torque"].at(0.5) == pytest.approx(6 * r**2 * gain)
        assert run["g.force"].at(0.5) == pytest.approx(6 * r * gain)
        assert run["g.force"].unit == "N"


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("J", "start"), [(2.25, 60.0), (3.0, 150.0), (0.75, 5.0)])
def test_a_pendulum_has_the_period_of_the_elliptic_integral(J: float, start: float) -> None:
    # m = 1 kg, l = 1.5 m: J = 2.25 kg m^2 is a point mass
    parts = {
        "p": hb.Submodel("rotational.pendulum", l="1.5 m", J=J, angle0=f"{start} deg"),
        "d": hb.Submodel("rotational.damper", d=0.0),
        "wall": FRAME,
    }
    period = 4 * math.sqrt(J / (1.5 * 9.81)) * ellipk(math.sin(math.radians(start) / 2) ** 2)
    for run in trials("p.shaft - d.right, d.left - wall.shaft", period, **parts):
        assert run["p.angle"].at(period) == pytest.approx(math.radians(start), rel=1e-8)
        assert run["p.angle"].at(period / 4) == pytest.approx(0, abs=1e-7)
        t = np.linspace(0, period, 9)
        energy = J * run["p.speed"].at(t) ** 2 / 2 + 9.81 * run["p.height"].at(t)
        top = 9.81 * 1.5 * (1 - math.cos(math.radians(start)))
        assert energy == pytest.approx(top, rel=1e-8)


def test_a_motor_holds_a_pendulum_level() -> None:
    parts = {
        "p": hb.Submodel("rotational.pendulum", m=2.0, l=0.5, angle0="90 deg"),
        "u": hb.Submodel("rotational.speed"),
    }
    for run in trials("p.shaft - u.shaft", 1, **parts):
        assert run["u.torque"].at(0.5) == pytest.approx(9.81)
        assert run["p.height"].at(1) == pytest.approx(0.5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("r", "l"), [(0.1, 0.3), (0.2, 0.25)])
def test_a_crank_moves_its_slider_as_its_geometry_says(r: float, l: float) -> None:
    parts = {
        "u": hb.Submodel("rotational.speed", inputs={"speed": "10"}),
        "c": hb.Submodel("rotational.crank_slider", r=r, l=l, angle0="0.3 rad"),
        "m": hb.Submodel("translational.mass", x=0),
    }
    t = np.linspace(0, 0.7, 15)
    angle = 0.3 + 10 * t
    place = r * np.cos(angle) + np.sqrt(l**2 - (r * np.sin(angle)) ** 2)
    for run in trials("u.shaft - c.crank, c.slider - m.flange", 0.7, rtol=1e-8, **parts):
        assert run["c.angle"].at(t) == pytest.approx(angle)
        assert run["c.position"].at(t) == pytest.approx(place, rel=1e-7)
        assert run["m.position"].at(t) == pytest.approx(place - place[0], abs=1e-7)


@pytest.mark.slow
def test_a_crank_keeps_energy_through_its_dead_centres() -> None:
    parts = {
        "J": inertia(0.02, w="20 rad/s"),
        "c": hb.Submodel("rotational.crank_slider"),
        "m": hb.Submodel("translational.mass", m="3 kg"),
    }

    def turned(a: float) -> float:
        arm = (
            -0.1
            * math.sin(a)
            * (1 + 0.1 * math.cos(a) / math.sqrt(0.09 - (0.1 * math.sin(a)) ** 2))
        )
        return math.sqrt((0.02 + 3 * arm**2) / (0.02 * 400))

    round_trip = quad(turned, 0, 2 * math.pi)[0]
    for run in trials("J.shaft - c.crank, c.slider - m.flange", round_trip, rtol=1e-8, **parts):
        assert run["J.angle"].at(round_trip) == pytest.approx(2 * math.pi, rel=1e-6)
        t = np.linspace(0, round_trip, 20)
        energy = 0.01 * run["J.speed"].at(t) ** 2 + 1.5 * run["m.speed"].at(t) ** 2
        assert energy == pytest.approx(4.0, rel=1e-6)
        # what the gear takes from the crank it gives to the slider
        taken = run["c.torque"].at(t) * run["J.speed"].at(t)
        assert taken == pytest.approx(run["c.force"].at(t) * run["m.speed"].at(t), abs=1e-9)
        assert run["c.torque"].at(0) == pytest.approx(0, abs=1e-9)
