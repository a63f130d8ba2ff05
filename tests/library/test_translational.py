"""Parts of translational mechanics that do not switch, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import trials
from scipy.special import ellipj, gamma

import hybond as hb

FRAME = hb.Submodel("translational.frame")


def mass(m: float = 1.0, **start: object) -> hb.Submodel:
    return hb.Submodel("translational.mass", m=m, **start)


def push(newtons: str) -> hb.Submodel:
    return hb.Submodel("translational.force", inputs={"force": newtons})


T = np.linspace(0.0, 2.0, 9)


@pytest.mark.parametrize(("m", "k"), [(1.0, 1.0), (0.2, 50.0)])
def test_a_mass_on_a_spring_swings_with_its_natural_frequency(m: float, k: float) -> None:
    parts = {
        "wall": FRAME,
        "s": hb.Submodel("translational.spring", k=k, stretch="0.1 m"),
        "m": mass(m, x="0.4 m"),
    }
    swing = 0.1 * np.cos(math.sqrt(k / m) * T)
    for run in trials("wall.flange - s.left, s.right - m.flange", 2, **parts):
        assert run["s.elongation"].at(T) == pytest.approx(swing, abs=1e-8)
        assert run["m.position"].at(T) == pytest.approx(0.3 + swing, abs=1e-8)
        assert run["s.force"].at(T) == pytest.approx(k * swing, abs=1e-7 * k)
        # the wall holds against the pull of the spring
        assert run["wall.force"].at(T) == pytest.approx(-k * swing, abs=1e-7 * k)
    for run in trials("m.flange - s.left, s.right - wall.flange", 2, **parts):
        assert run["m.position"].at(T) == pytest.approx(0.5 - swing, abs=1e-8)


@pytest.mark.parametrize(("m", "d"), [(1.0, 1.0), (0.5, 4.0), (2.0, 0.0)])
def test_a_damper_takes_speed_exponentially(m: float, d: float) -> None:
    parts = {
        "wall": FRAME,
        "d": hb.Submodel("translational.damper", d=d),
        "m": mass(m, v="3 m/s"),
    }
    speed = 3 * np.exp(-d / m * T)
    for run in trials("wall.flange - d.left, d.right - m.flange", 2, **parts):
        assert run["m.speed"].at(T) == pytest.approx(speed, rel=1e-8, abs=1e-9)
        assert run["d.force"].at(T) == pytest.approx(d * speed, rel=1e-8, abs=1e-9)
        assert run["d.power"].at(T) == pytest.approx(d * speed**2, rel=1e-8, abs=1e-9)
    for run in trials("m.flange - d.left, d.right - wall.flange", 2, **parts):
        assert run["m.speed"].at(T) == pytest.approx(speed, rel=1e-8, abs=1e-9)
        assert run["d.speed"].at(T) == pytest.approx(-speed, rel=1e-8, abs=1e-9)


def duffing(k: float, k3: float) -> dict[str, hb.Submodel]:
    return {
        "wall": FRAME,
        "s": hb.Submodel("translational.nonlinear_spring", k=k, k3=k3, stretch="0.5 m"),
        "m": mass(2.0),
    }


def test_a_cubic_spring_has_the_period_of_the_quartic_oscillator() -> None:
    quarter = gamma(0.25) ** 2 / (4 * math.sqrt(2 * math.pi))
    period = 4 * math.sqrt(2 * 2.0 / 300.0) / 0.5 * quarter
    for run in trials("wall.flange - s.left, s.right - m.flange", period, **duffing(0.0, 300.0)):
        assert run["s.elongation"].at(period) == pytest.approx(0.5, abs=1e-8)
        assert run["s.elongation"].at(period / 4) == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize(("k", "k3"), [(20.0, 100.0), (5.0, 400.0)])
def test_a_hardening_spring_follows_jacobis_cosine(k: float, k3: float) -> None:
    w = math.sqrt((k + k3 * 0.25) / 2.0)
    swing = 0.5 * ellipj(w * T, k3 * 0.25 / (2 * (k + k3 * 0.25)))[1]
    for run in trials("wall.flange - s.left, s.right - m.flange", 2, **duffing(k, k3)):
        assert run["s.elongation"].at(T) == pytest.approx(swing, abs=1e-7)
        assert run["s.force"].at(T) == pytest.approx(k * swing + k3 * swing**3, abs=1e-4)


@pytest.mark.parametrize("newtons", ["3", "-2", "4 [N/s]*time"])
def test_a_force_accelerates_a_mass(newtons: str) -> None:
    speed = 2 * T**2 / 2.5 if "time" in newtons else float(newtons) * T / 2.5
    for run in trials("f.flange - m.flange", 2, f=push(newtons), m=mass(2.5)):
        assert run["m.speed"].at(T) == pytest.approx(speed, abs=1e-9)
        assert run["m.momentum"].at(T) == pytest.approx(2.5 * speed, abs=1e-9)
        assert run["f.power"].at(2) == pytest.approx(
            run["f.speed"].at(2) * (8 if "time" in newtons else float(newtons))
        )


def test_a_speed_needs_the_force_of_a_damper_and_gives_an_impulse_at_a_step() -> None:
    parts = {
        "u": hb.Submodel("translational.speed", inputs={"speed": "if time < 1 then 2 else 5"}),
        "d": hb.Submodel("translational.damper", d=3.0),
        "m": mass(0.5, v="2 m/s"),
        "wall": FRAME,
    }
    joints = "u.flange - d.right, d.left - wall.flange, u.flange - m.flange"
    for run in trials(joints, 2, **parts):
        assert run["u.force"].at(0.5) == pytest.approx(6.0)
        assert run["u.power"].at(1.5) == pytest.approx(75.0)
        (step,) = [e for e in run.events if e.t == 1.0]
        areas = [abs(area) for s in step.steps for area in s.impulses.values()]
        assert areas == pytest.approx([1.5] * len(areas)) and areas


@pytest.mark.parametrize("slope", [90, 30, 0])
def test_a_weight_falls_along_its_slope(slope: float) -> None:
    weight = hb.Submodel("translational.weight", m=3.0, slope=f"{slope} deg")
    sine, cosine = math.sin(math.radians(slope)), math.cos(math.radians(slope))
    for run in trials("w.flange - m.flange", 2, w=weight, m=mass(3.0, v="1 m/s")):
        assert run["m.speed"].at(T) == pytest.approx(1 - 9.81 * sine * T, abs=1e-9)
        assert run["m.position"].at(2) == pytest.approx(2 - 9.81 * sine * 2, abs=1e-8)
        assert run["w.force"].at(1) == pytest.approx(-3 * 9.81 * sine, abs=1e-12)
        assert run["w.normal"].at(1) == pytest.approx(3 * 9.81 * cosine, abs=1e-12)


@pytest.mark.parametrize(("a", "b"), [(1.0, 3.0), (4.0, 0.5)])
def test_a_rod_tells_the_force_between_two_masses(a: float, b: float) -> None:
    parts = {
        "f": push("6"),
        "a": mass(a),
        "r": hb.Submodel("translational.rod"),
        "b": mass(b),
    }
    joints = "a.flange - r.left, r.right - b.flange, {}.flange -> f.flange"
    for run in trials(joints.format("b"), 1, **parts):
        assert run["r.force"].at(0.5) == pytest.approx(6 * a / (a + b)), "drawn"
        assert run["r.speed"].at(1) == pytest.approx(6 / (a + b))
    for run in trials(joints.format("a"), 1, **parts):
        assert run["r.force"].at(0.5) == pytest.approx(-6 * b / (a + b)), "pressed"


def accelerations(
    masses: list[float], forces: list[float], ties: list[list[float]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return accelerations and multipliers of masses whose velocities are tied: G a = 0."""
    M, G = np.diag(masses), np.array(ties)
    zero = np.zeros((len(G), len(G)))
    found = np.linalg.solve(np.block([[M, G.T], [G, zero]]), [*forces, *np.zeros(len(G))])
    return found[: len(masses)], found[len(masses) :]


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (0.3, 1.2)])
def test_a_lever_on_a_frame_moves_its_ends_in_proportion(a: float, b: float) -> None:
    parts = {
        "f": push("6"),
        "l": hb.Submodel("translational.lever", a=a, b=b),
        "m": mass(2.0),
        "wall": FRAME,
    }
    end = 6 * a / b / 2.0
    for run in trials("f.flange -> l.left, l.pivot - wall.flange, l.right - m.flange", 1, **parts):
        assert run["m.speed"].at(1) == pytest.approx(-end)
        assert run["f.speed"].at(1) == pytest.approx(end * a / b)
        assert run["l.speed"].at(1) == pytest.approx(end / b)
        assert run["l.force_left"].at(0.5) == pytest.approx(-6.0)
        assert run["l.force_right"].at(0.5) == pytest.approx(-6 * a / b)
        assert run["l.force_pivot"].at(0.5) == pytest.approx(6 + 6 * a / b)
        assert run["wall.force"].at(0.5) == pytest.approx(-6 - 6 * a / b)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("a", "b", "J"), [(1.0, 2.0, 0.0), (0.5, 0.7, 0.6)])
def test_a_lever_in_space_moves_like_three_masses_on_a_line(a: float, b: float, J: float) -> None:
    parts = {
        "f": push("6"),
        "l": hb.Submodel("translational.lever", a=a, b=b),
        "m1": mass(1.0),
        "m2": mass(2.0),
        "m3": mass(3.0),
    }
    joints = "l.left - m1.flange, l.pivot - m2.flange, l.right - m3.flange, f.flange -> l.left"
    if J:
        parts["J"] = hb.Submodel("rotational.inertia", J=J)
        joints += ", l.turn - J.shaft"
    # turning with w: left = pivot + a w, right = pivot - b w; the inertia weighs J w^2/2
    ties = [[1, -1, 0, -a], [0, -1, 1, b]]
    found, _ = accelerations([1, 2, 3, max(J, 1e-12)], [6, 0, 0, 0], ties)
    for run in trials(joints, 1, **parts):
        speeds = [run[f"m{k}.speed"].at(1) for k in (1, 2, 3)]
        assert speeds == pytest.approx(found[:3], rel=1e-8)
        assert run["l.speed"].at(1) == pytest.approx(found[3], rel=1e-8)
        assert speeds @ np.array([1, 2, 3]) == pytest.approx(6.0)


def hanging(m: float) -> dict[str, hb.Submodel]:
    return {"m": mass(m), "w": hb.Submodel("translational.weight", m=m)}


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("m1", "m2", "J"), [(2.0, 1.0, 0.0), (1.0, 3.0, 0.02), (1.0, 1.5, 0.1)])
def test_atwoods_machine(m1: float, m2: float, J: float) -> None:
    parts = {
        "p": hb.Submodel("translational.pulley", r="0.2 m"),
        "wall": FRAME,
        **{f"{k}1": part for k, part in hanging(m1).items()},
        **{f"{k}2": part for k, part in hanging(m2).items()},
    }
    joints = "p.left - m1.flange, p.right - m2.flange, m1.flange -> w1.flange, "
    joints += "m2.flange -> w2.flange, p.axle - wall.flange"
    if J:
        parts["J"] = hb.Submodel("rotational.inertia", J=J)
        joints += ", p.wheel - J.shaft"
    up = (m2 - m1) * 9.81 / (m1 + m2 + J / 0.04)
    for run in trials(joints, 1, **parts):
        assert run["m1.speed"].at(1) == pytest.approx(up, abs=1e-9)
        assert run["m2.speed"].at(1) == pytest.approx(-up, abs=1e-9)
        assert run["p.speed"].at(1) == pytest.approx(up / 0.2, abs=1e-9)
        tensions = m1 * (9.81 + up), m2 * (9.81 - up)
        assert run["p.tension_left"].at(0.5) == pytest.approx(tensions[0])
        assert run["p.tension_right"].at(0.5) == pytest.approx(tensions[1])
        assert run["wall.force"].at(0.5) == pytest.approx(sum(tensions))


def test_a_pulley_on_a_moving_axle() -> None:
    parts = {
        "p": hb.Submodel("translational.pulley"),
        "f": push("40"),
        "m": mass(0.7),
        **{f"{k}1": part for k, part in hanging(1.0).items()},
        **{f"{k}2": part for k, part in hanging(2.0).items()},
    }
    joints = "p.left - m1.flange, p.right - m2.flange, m1.flange -> w1.flange, "
    joints += "m2.flange -> w2.flange, p.axle - m.flange, m.flange -> f.flange"
    found, (tension,) = accelerations([1, 2, 0.7], [-9.81, -19.62, 40], [[-1, -1, 2]])
    for run in trials(joints, 1, **parts):
        speeds = [run[f"{k}.speed"].at(1) for k in ("m1", "m2", "m")]
        assert speeds == pytest.approx(found)
        assert run["p.tension_left"].at(0.5) == pytest.approx(tension)
        assert run["p.tension_right"].at(0.5) == pytest.approx(tension)
