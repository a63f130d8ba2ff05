"""Belts that stretch and slip, differentials that lock, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import instants, trials

import hybond as hb


def inertia(J: float, w: float = 0.0) -> hb.Submodel:
    return hb.Submodel("rotational.inertia", J=J, w=w)


def torque(newton_metres: object) -> hb.Submodel:
    return hb.Submodel("rotational.torque", inputs={"torque": newton_metres})


@pytest.mark.parametrize("crossed", [1, -1])
def test_two_pulleys_swing_on_a_belt_that_stretches(crossed: int) -> None:
    J_a, J_b, r_1, r_2, k = 0.02, 0.3, 0.05, 0.1, 2e4
    parts = {
        "a": inertia(J_a, w=2.0),
        "b": hb.Submodel("rotational.belt", r_1=r_1, r_2=crossed * r_2, k=k, tension="1 kN"),
        "c": inertia(J_b),
    }
    # two masses J/r^2 on a spring, one of which moves with r_1*2 rad/s
    m_a, m_b = J_a / r_1**2, J_b / r_2**2
    swing = math.sqrt(k * (m_a + m_b) / (m_a * m_b))
    t = np.linspace(0, 0.1, 7)
    joints = "a.shaft - b.input, b.output - c.shaft"
    for run in trials(joints, 0.1, **parts):
        mean = m_a * r_1 * 2 / (m_a + m_b)
        rest = mean * (1 - np.cos(swing * t))
        assert run["c.speed"].at(t) == pytest.approx(crossed * rest / r_2, abs=1e-8)
        force = k * r_1 * 2 / swing * np.sin(swing * t)
        assert run["b.force"].at(t) == pytest.approx(force, abs=1e-6)
        assert run["b.torque_input"].at(t) == pytest.approx(r_1 * force, abs=1e-6)
        assert run["b.torque_output"].at(t) == pytest.approx(crossed * r_2 * force, abs=1e-6)
        assert run["b.sticks"].at(0.05) == 1


@pytest.mark.parametrize("d", [0.0, 200.0])
def test_a_belt_slips_at_the_force_of_euler_and_eytelwein(d: float) -> None:
    """The output is held; what the input winds up is stretch, then slip; wound back it holds."""
    k, mu, wrap, speed, r = 1e4, 0.4, 2.8, 3.0, 0.05
    limit = 2 * 300 * (math.exp(mu * wrap) - 1) / (math.exp(mu * wrap) + 1)
    parts = {
        "a": hb.Submodel(
            "rotational.speed", inputs={"speed": f"if time < 1 then {speed} else {-speed}"}
        ),
        "b": hb.Submodel(
            "rotational.belt", r_1=r, k=k, d=d, mu=mu, wrap=wrap, tension="300 N", mu_rest=0.4
        ),
        "wall": hb.Submodel("rotational.frame"),
    }
    slips = (limit - d * r * speed) / (k * r * speed)
    for run in trials("a.shaft -> b.input, b.output - wall.shaft", 1.02, **parts):
        assert run["b.force"].at(slips / 2) == pytest.approx(k * r * speed * slips / 2 + d * 0.15)
        assert run["b.force"].at([0.5, 0.99]) == pytest.approx(limit)
        assert run["b.sticks"].at([slips / 2, 0.9]) == pytest.approx([1, 0])
        if d == 0:
            assert instants(run)[0] == pytest.approx(slips, rel=1e-9)
            assert run["b.slip"].at(0.7) == pytest.approx(r * speed)
            assert run["b.force"].at(1.02) == pytest.approx(limit - k * r * speed * 0.02)
        assert run["wall.torque"].at(0.9) == pytest.approx(-0.1 * limit)


def test_an_open_differential_gives_both_wheels_the_same_torque() -> None:
    J_in, J_l, J_r, i = 0.1, 1.0, 4.0, 3.5
    parts = {
        "m": torque(50),
        "a": inertia(J_in, w=i),
        "d": hb.Submodel("rotational.differential", ratio=i),
        "l": inertia(J_l, w=2.0),
        "r": inertia(J_r),
    }
    # half*(1/J_l + 1/J_r)*i/2 is the input's acceleration; T = 50 - J_in*a passes, half = i/2*T
    T = 50 / (1 + J_in * i**2 / 4 * (1 / J_l + 1 / J_r))
    joints = "m.shaft -> a.shaft, a.shaft - d.input, d.left - l.shaft, d.right - r.shaft"
    for run in trials(joints, 0.5, **parts):
        assert run["d.torque_input"].at(0.2) == pytest.approx(T)
        for side, J, start in (("left", J_l, 2.0), ("right", J_r, 0.0)):
            assert run[f"d.torque_{side}"].at(0.2) == pytest.approx(i / 2 * T)
            speed = run[f"{side[0]}.speed"].at(0.5)
            assert speed == pytest.approx(start + i / 2 * T / J * 0.5)
        assert run["d.slip"].at(0.5) == pytest.approx(run["l.speed"].at(0.5) - speed)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("grip", [5.0, 40.0])
def test_a_limited_slip_differential_shifts_torque_to_the_wheel_that_holds(
    grip: float, sign: float
) -> None:
    """Left on ice, with the drag ``grip``; right heavy. Plates hold 8 N*m and 0.2 of the cage's."""
    i, preload, lock, J_l, J_r = 3.0, 8.0, 0.2, 0.5, 5.0
    parts = {
        "m": torque(sign * 20),
        "d": hb.Submodel(
            "rotational.limited_slip_differential", ratio=i, preload=preload, lock=lock
        ),
        "l": inertia(J_l),
        "r": inertia(J_r),
        "ice": torque(-sign * (grip - 5)),
    }
    joints = "m.shaft -> d.input, d.left - l.shaft, d.right - r.shaft, ice.shaft -> l.shaft"
    cage, drag = sign * 60.0, sign * (grip - 5)
    together = (cage - drag) / (J_l + J_r)
    plates = cage / 2 - drag - J_l * together  # that lock the left wheel to the right one
    most = preload + lock * 60
    locked = abs(plates) <= most
    speeds = [together / 2] * 2
    if not locked:
        plates = math.copysign(most, plates)
        speeds = [(cage / 2 - drag - plates) / J_l / 2, (cage / 2 + plates) / J_r / 2]
    for run in trials(joints, 0.5, **parts):
        assert run["d.locked"].at(0.3) == locked
        found = [run["l.speed"].at(0.5), run["r.speed"].at(0.5)]
        assert found == pytest.approx(speeds, rel=1e-8)
        assert run["d.torque_left"].at(0.3) == pytest.approx(cage / 2 - plates)
        assert run["d.torque_right"].at(0.3) == pytest.approx(cage / 2 + plates)
        assert run["d.heat"].at(0.5) == pytest.approx(plates * (speeds[0] - speeds[1]) / 4)
