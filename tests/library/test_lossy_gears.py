"""Gears and screws that lose part of the power, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import instants, trials

import hybond as hb


def inertia(J: float, w: float = 0.0) -> hb.Submodel:
    return hb.Submodel("rotational.inertia", J=J, w=w)


def torque(newton_metres: str) -> hb.Submodel:
    return hb.Submodel("rotational.torque", inputs={"torque": newton_metres})


def gear(forward: object = 0.8, backward: object = 0.7, **given: object) -> hb.Submodel:
    return hb.Submodel(
        "rotational.lossy_gear", inputs={"forward": forward, "backward": backward}, **given
    )


TRAIN = "a.shaft - g.input, g.output - b.shaft, t.shaft -> a.shaft, q.shaft -> b.shaft"


@pytest.mark.parametrize("ratio", [3.0, -0.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("driven_by", ["input", "output"])
def test_two_flywheels_move_as_the_efficiency_of_the_power_direction_says(
    ratio: float, sign: float, driven_by: str
) -> None:
    J_a, J_b, drag, oil = 0.2, 0.5, 0.3, 0.05
    drive, brake = (40.0, -2.0) if driven_by == "input" else (-2.0, 40.0)
    parts = {
        "a": inertia(J_a),
        "g": gear(ratio=ratio, drag=drag, d=oil),
        "b": inertia(J_b),
        "t": torque(str(sign * drive)),
        "q": torque(str(sign * brake * (1 if ratio > 0 else -1))),
    }
    # at the input: J_a*a = drive - drag - oil*w - T, and T is what the teeth hand on, or get, as
    # their loss has it: mesh/0.8 forward, 0.7*mesh backward, mesh = (J_b*a/ratio - brake)/ratio
    part = 1 / 0.8 if driven_by == "input" else 0.7
    mass = J_a + part * J_b / ratio**2
    push = drive + part * brake / abs(ratio) - drag
    t = np.array([0.05, 0.5, 1.0])
    speed = sign * push / oil * (1 - np.exp(-oil * t / mass))
    for run in trials(TRAIN, 1.0, **parts):
        assert run["a.speed"].at(t) == pytest.approx(speed, rel=1e-8)
        assert run["b.speed"].at(t) == pytest.approx(speed / ratio, rel=1e-8)
        given = run["g.torque_input"].at(t) * run["a.speed"].at(t)
        taken = run["g.torque_output"].at(t) * run["b.speed"].at(t)
        rest = (drag + oil * abs(speed)) * abs(speed)
        lossy = (given - rest) * 0.8 if driven_by == "input" else given - rest - 0.7 * taken
        assert lossy == pytest.approx(taken if driven_by == "input" else 0 * t, abs=1e-6)
        assert run["g.power"].at(t) == pytest.approx(given - taken, rel=1e-9)
        assert (run["g.power"].at(t) > 0).all()


@pytest.mark.parametrize("backward", [0.7, -0.2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_rest_it_holds_between_what_lifts_and_what_lowers_the_load(
    backward: float, sign: float
) -> None:
    """A load of 6 N*m behind 3 to 1; locking itself, it has to be driven down, too."""
    mesh, drag = 2.0, 0.1
    lifts, lowers = mesh / 0.8 + drag, backward * mesh - drag
    for rate, limit in ((1.0, lifts), (-1.0, lowers)):
        parts = {
            "a": inertia(0.2),
            "g": gear(backward=backward, ratio=3.0, drag=drag),
            "b": inertia(0.5),
            "t": torque(f"{sign}*(2 [N*m] + {rate} [N*m/s]*time)"),
            "q": torque(str(-3 * mesh * sign)),
        }
        moves = (limit - 2.0) / rate
        for run in trials(TRAIN, moves + 0.2, **parts):
            assert instants(run) == pytest.approx([moves], rel=1e-9)
            assert run["a.speed"].at(moves) == 0
            assert run["g.sticks"].at(moves / 2) == 1
            assert run["g.torque_output"].at(moves / 2) == pytest.approx(3 * mesh * sign)
            # from there the torque grows further, on the mass as that direction feels it
            part = 1 / 0.8 if rate > 0 else backward
            speed = sign * rate * 0.2**2 / 2 / (0.2 + part * 0.5 / 9)
            assert run["a.speed"].at(moves + 0.2) == pytest.approx(speed, rel=1e-7)


def test_a_gear_that_locks_itself_stops_a_load_and_cannot_be_turned_by_it() -> None:
    parts = {
        "a": inertia(0.2, w=6.0),
        "g": gear(0.4, -0.5, ratio=3.0),
        "b": inertia(0.5, w=2.0),
        "t": torque("0"),
        "q": torque("if time < 0.5 then 1 else 1e5"),
    }
    # driven on by the load: T = -0.5*mesh, mesh = (J_b*a/3 - q)/3 < 0
    slows = -0.5 / 3 / (0.2 - 0.5 * 0.5 / 9)
    for run in trials(TRAIN, 1.0, **parts):
        assert run["a.speed"].at(0.4) == pytest.approx(6 + slows * 0.4, rel=1e-8)
    parts["a"], parts["b"] = inertia(0.2), inertia(0.5)
    for run in trials(TRAIN, 1.0, **parts):
        assert not instants(run)[1:]
        assert (run["a.speed"].at(1), run["g.sticks"].at(1)) == (0, 1)
        assert run["g.torque_input"].at(1) == pytest.approx(0, abs=1e-9)


def test_a_heavy_load_on_a_gear_that_locks_itself_jams_at_speed() -> None:
    """There 0.5*J_b is more than J_a*9: no torque of the teeth goes with any acceleration."""
    m = hb.Model("jam", domain="rotational")
    m.add(a=inertia(0.2, w=6.0), g=gear(0.4, -0.5, ratio=3.0), b=inertia(5.0, w=2.0), q=torque("1"))
    m.bond("a.shaft -> g.input", "g.output -> b.shaft", "q.shaft -> b.shaft")
    with pytest.raises(hb.NumericsError) as refused:
        hb.simulate(m, until=0.1)
    assert refused.value.code == "HB-N301"


def test_without_losses_it_is_a_gear() -> None:
    """The limit of efficiency 1; the power turns round many times."""
    for kind, given in (("lossy_gear", {"eta": 1}), ("gear", {})):
        parts = {
            "a": inertia(0.2),
            "g": hb.Submodel(f"rotational.{kind}", ratio=-3.0, **given),
            "b": inertia(0.5),
            "t": torque("3*cos(9 [1/s]*time)"),
            "q": torque("0"),
        }
        for run in trials(TRAIN, 1.0, **parts):
            t = np.linspace(0.1, 1, 9)
            speed = 3 / 9 * np.sin(9 * t) / (0.2 + 0.5 / 9)
            assert run["a.speed"].at(t) == pytest.approx(speed, abs=1e-8)


def test_efficiency_may_follow_speed_and_torque() -> None:
    parts = {
        "a": inertia(0.2),
        "g": gear("0.95 - 0.002 [s/rad]*a.speed - 0.1/(1 + abs(s.torque)/(1 [N*m]))"),
        "s": hb.Submodel("rotational.torsion_spring", k=50),
        "b": inertia(0.5),
        "t": torque("20"),
    }
    joints = "t.shaft -> a.shaft, a.shaft - g.input, g.output -> s.left, s.right -> b.shaft"
    for run in trials(joints, 0.1, **parts):
        t = np.linspace(0.02, 0.1, 5)
        eta = 0.95 - 0.002 * run["a.speed"].at(t) - 0.1 / (1 + abs(run["s.torque"].at(t)))
        given, taken = run["g.torque_input"].at(t), run["g.torque_output"].at(t)
        assert taken == pytest.approx(2 * eta * given, rel=1e-9)
        assert abs(run["s.torque"].at(t)) == pytest.approx(taken, rel=1e-9)


@pytest.mark.parametrize(("twist", "part"), [(6.0, 1 / 0.9), (1.0, 0.8)])
@pytest.mark.parametrize("elastic", [False, True])
def test_a_ball_screw_lifts_and_lowers_a_mass(twist: float, part: float, elastic: bool) -> None:
    """``"rotational.ball_screw"``: up by 0.9, down by 0.8; a spring that is stretched for it stays
    so.
    """
    pitch, m, J = 0.01 / (2 * math.pi), 200.0, 0.01
    a = (twist - part * pitch * m * 9.81) / (J + part * pitch**2 * m)
    force = m * (9.81 + pitch * a)
    parts = {
        "motor": torque(str(twist)),
        "J": inertia(J),
        "s": hb.Submodel(
            "rotational.ball_screw", inputs={"forward": 0.9, "backward": 0.8}, lead="10 mm/rev"
        ),
        "m": hb.Submodel("translational.mass", m=m),
        "g": hb.Submodel("translational.weight", m=m),
    }
    joints = "motor.shaft -> J.shaft, J.shaft - s.shaft, g.flange -> m.flange, s.nut - "
    if elastic:
        parts["k"] = hb.Submodel("translational.spring", k=1e6, stretch=-force / 1e6)
        joints += "k.left, k.right -> m.flange"
    else:
        joints += "m.flange"
    for run in trials(joints, 0.4, **parts):
        assert run["J.speed"].at(0.4) == pytest.approx(a * 0.4, rel=1e-8)
        assert run["s.position"].at(0.4) == pytest.approx(pitch * a * 0.4**2 / 2, rel=1e-8)
        assert run["s.force"].at(0.3) == pytest.approx(force, rel=1e-8)
        assert run["s.torque"].at(0.3) == pytest.approx(twist - J * a, rel=1e-8)
        lost = (twist - J * a) * a * 0.3 - force * pitch * a * 0.3
        assert run["s.power"].at(0.3) == pytest.approx(lost, rel=1e-6)


def test_a_trapezoidal_thread_holds_what_a_ball_screw_lets_down() -> None:
    for backward, moves in ((-0.3, False), (0.0, False), (0.1, True)):
        parts = {
            "J": inertia(0.01),
            "s": hb.Submodel(
                "rotational.ball_screw", inputs={"forward": 0.4, "backward": backward}
            ),
            "m": hb.Submodel("translational.mass", m=200),
            "g": hb.Submodel("translational.weight", m=200),
        }
        joints = "J.shaft - s.shaft, s.nut - m.flange, g.flange -> m.flange"
        for run in trials(joints, 0.1, **parts):
            assert (run["m.speed"].at(0.1) < 0) == moves
            assert run["s.sticks"].at(0.1) == (not moves)


@pytest.mark.parametrize("ratio", [2.0, -0.5])
@pytest.mark.parametrize(("forward", "backward"), [(1.0, 1.0), (0.8, 0.6), (1.0, -0.5), (0.5, 0.9)])
def test_teeth_give_no_energy_in_an_impact(ratio: float, forward: float, backward: float) -> None:
    """A dog clutch behind the gear: momentum seen from the input is kept, 0.9 J and more are lost.

    Friction is a finite force: it has no part in an impact, whatever the efficiencies.
    """
    m = hb.Model("dog", domain="rotational")
    m.add(A=inertia(1, w="3 rad/s"), C=inertia(1), dog=hb.Zero())
    m.add(
        g=hb.Submodel(
            "rotational.lossy_gear", ratio=ratio, inputs={"forward": forward, "backward": backward}
        )
    )
    m.bond("A.shaft -> g.input", "g.output -> dog -> C.shaft")
    shut = ["open -> shut when time >= 1e-6 s"]
    m.machine("D", states={"open": [], "shut": ["dog"]}, start="open", rules=shut)
    run = hb.simulate(m, "1.1e-6 s")
    step = run.events[-1].steps[-1]
    w = 3 / (1 + ratio**-2)
    assert run["A.speed"].at(1.1e-6) == pytest.approx(w, rel=1e-9)
    assert run["C.speed"].at(1.1e-6) == pytest.approx(w / ratio, rel=1e-9)
    assert step.energy is not None and step.energy.lost == pytest.approx(4.5 - 1.5 * w, rel=1e-9)
