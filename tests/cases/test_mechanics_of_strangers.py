"""Mechanisms with impacts, ropes, friction and dwells, each against what it comes to by hand.

Oracles are closed forms, conserved quantities, or an integration by SciPy between events that are
written out here.
"""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

G = 9.81
BOTH = pytest.mark.parametrize("solver", ["auto", "radau"])


def guards(run: hb.Result) -> list[float]:
    """Return the times of what happened after the start."""
    return [event.t for event in run.events[1:]]


@BOTH
def test_a_hoist_takes_up_its_slack_and_sets_its_load_down(solver: str) -> None:
    """0.5 m/s up to 2 s, then 0.4 m/s down: the load flies on, and is caught."""
    m = hb.Model("hoist", domain="translational", parameters={"m": "200 kg"})
    m.add(winch=hb.Sf("reel"), top=hb.One(), load=hb.I("m"), v=hb.One())
    m.add(weight=hb.Se("-m*9.81 [m/s^2]"), ground=hb.Zero(law="unilateral", gap="h"))
    m.add(rope=hb.Submodel("translational.rope", reserve="0.2 m"))
    m.bond("winch -> top -> rope.right", "rope.left -> v -> load", "weight -> v", "ground -> v")
    m.signal(h=hb.Integral("v.f"))
    m.input(reel=hb.Input(table=[[0, "0.5 m/s"], ["2 s", "-0.4 m/s"]]))
    run = hb.simulate(m, 6.0, solver=solver)
    assert guards(run) == pytest.approx([0.4, 2.0, 2.0 + 1.8 / G, 4.0], rel=1e-9)
    assert run["h"].at([1.9, 3.0, 5.0]) == pytest.approx([0.75, 0.4, 0.0], abs=1e-9)


@BOTH
def test_a_ball_on_a_ball_is_thrown_up(solver: str) -> None:
    """Two elastic impacts, a millimetre apart: on the floor, then of the small on the large one."""
    large, small, height, gap = 0.5, 0.05, 1.0, 1e-3
    m = hb.Model("stack", domain="translational")
    m.add(A=hb.I(large), B=hb.I(small), WA=hb.Se(-large * G), WB=hb.Se(-small * G))
    m.add(a=hb.One(), b=hb.One(), floor=hb.Zero(law="unilateral", gap="y", restitution=1))
    m.add(between=hb.Zero(law="unilateral", gap="z - y", restitution=1))
    m.bond("WA -> a -> A", "b -> B", "WB -> b", "floor -> a -> between -> b")
    m.signal(y=hb.Integral("a.f", height), z=hb.Integral("b.f", height + gap))
    speed = math.sqrt(2 * G * height)
    later = gap / (2 * speed)
    up, down = speed - G * later, -speed - G * later
    mass = large + small
    after = ((large - small) * up + 2 * small * down) / mass
    thrown = (2 * large * up - (large - small) * down) / mass
    met = speed / G + later
    run = hb.simulate(m, met + 0.1, solver=solver)
    assert guards(run) == pytest.approx([speed / G, met], rel=1e-10)
    assert run["a.f"].at(met + 0.1) == pytest.approx(after - 0.1 * G, rel=1e-9)
    assert run["b.f"].at(met + 0.1) == pytest.approx(thrown - 0.1 * G, rel=1e-9)


@pytest.mark.parametrize("impact", ["newton_simultaneous", "poisson"])
def test_a_cue_ball_meets_two_at_once(impact: str) -> None:
    """At 30 degrees on either side: it comes back at a fifth of its speed (a textbook's answer)."""
    c = math.sqrt(3) / 2
    m = hb.Model("break", domain="translational", parameters={"c": c})
    m.add(cue=hb.I(0.2, f=2.0), v=hb.One(), b1=hb.I(0.2), v1=hb.One(), b2=hb.I(0.2), v2=hb.One())
    m.add(g1=hb.TF("1/c"), g2=hb.TF("c"))
    m.add({f"c{k}": hb.Zero(law="unilateral", gap=f"gap{k}", restitution=1) for k in (1, 2)})
    m.bond(
        "v -> cue", "v -> g1.2", "g1.1 -> c1 -> v1 -> b1", "v2 -> b2", "c2 -> v2", "v -> g2 -> c2"
    )
    m.signal({f"gap{k}": hb.Integral(f"v{k}.f - v.f*c", "0.1 m") for k in (1, 2)})
    run = hb.simulate(m, 1.0, impact=impact)
    away = 2 * math.sqrt(3) / 5 * 2.0
    found = [run[f"{name}.f"].at(1.0) for name in ("v", "v1", "v2")]
    assert found == pytest.approx([-0.4, away, away], rel=1e-12)


@BOTH
def test_a_train_starts_car_after_car(solver: str) -> None:
    """Each coupling of 5 cm becomes taut plastically: momentum is kept, energy is not."""
    pull, mass, slack = 1000.0, 500.0, 0.05
    m = hb.Model("train", domain="translational", parameters={"n": 3})
    m.add({"pull": hb.Se(pull), "car[0..n]": hb.I(mass), "v[0..n]": hb.One()})
    m.add({"rope[1..n]": hb.Submodel("translational.rope", reserve=slack)})
    m.bond("pull -> v[0]", "v[0..n] -> car[0..n]")
    m.bond("rope[1..n].right -> v[0..n-1]", "v[1..n] -> rope[1..n].left")
    v, times = 0.0, [0.0]
    for cars in (1, 2, 3):
        a = pull / (cars * mass)
        faster = math.sqrt(v * v + 2 * a * slack)
        times.append(times[-1] + (faster - v) / a)
        v = faster * cars / (cars + 1)
    end = times[-1] + 1.0
    run = hb.simulate(m, end, solver=solver)
    assert guards(run) == pytest.approx(times[1:], rel=1e-9)
    assert run["v[3].f"].at(end) == pytest.approx(v + pull / (4 * mass), rel=1e-9)
    assert run["rope[1].tension"].at(end) == pytest.approx(pull * 3 / 4, rel=1e-9)


@BOTH
def test_a_ladder_leaves_the_wall_at_two_thirds_of_its_height(solver: str) -> None:
    """Frictionless wall and floor: a classic, whatever the angle it starts at."""
    length, begun = 2.0, math.radians(70)
    m = hb.Model("ladder", domain="translational")
    at = {"x0": length / 2 * math.cos(begun), "y0": length / 2 * math.sin(begun)}
    m.add(rod=hb.Submodel("planar.rod", m=3.0, l=length, angle0=math.pi - begun, g=G, **at))
    m.add(wall=hb.Zero(law="unilateral", gap="rod.x_b"))
    m.add(floor=hb.Zero(law="unilateral", gap="rod.y_a"))
    m.bond("wall -> rod.bx", "floor -> rod.ay")
    run = hb.simulate(m, 0.9, solver=solver)
    (left,) = [t for t in guards(run) if t > 0.0]
    assert run["rod.y_b"].at(left) == pytest.approx(2 / 3 * length * math.sin(begun), rel=1e-7)


@BOTH
def test_a_drill_string_sticks_and_slips(solver: str) -> None:
    J, k, speed, drag = 300.0, 400.0, 6.0, 30.0
    m = hb.Model("drill", domain="rotational", parameters={"low": 3000, "high": 5000, "w0": 0.8})
    m.add(table=hb.Sf(speed), n=hb.Zero(), pipe=hb.C(1 / k), bit=hb.I(J), w=hb.One())
    m.add(mud=hb.R(drag))
    m.add(rock=hb.One(law="coulomb", limit="low + (high - low)*exp(-(rock.f/w0)^2)"))
    m.bond("table -> n -> w -> bit", "n -> pipe", "w -> mud", "w -> rock")

    def slips(_: float, y: np.ndarray) -> list[float]:
        rubs = 3000 + 2000 * math.exp(-((y[1] / 0.8) ** 2))
        return [speed - y[1], (k * y[0] - drag * y[1] - rubs) / J]

    t, twist, events = 0.0, 0.0, []
    while True:
        t += (5000 / k - twist) / speed
        if t > 20.0:
            break
        events.append(t)
        # off the rest by a hair, at which the integration would stay
        ends = lambda s, y, t=t: y[1] if s > t + 0.05 else 1.0  # noqa: E731
        ends.terminal, ends.direction = True, -1
        s = solve_ivp(slips, (t, 30.0), [5000 / k, 0.0], events=ends, rtol=1e-11, atol=1e-12)
        t, twist = s.t[-1], s.y[0, -1]
        events.append(t)
    run = hb.simulate(m, 20.0, solver=solver)
    assert guards(run) == pytest.approx([t for t in events if t < 20.0], rel=1e-5)


@BOTH
def test_a_cone_synchronises_before_the_dog_locks(solver: str) -> None:
    one, two, cone, torque = 0.02, 0.15, 12.0, 50.0
    m = hb.Model("shift", domain="rotational")
    m.add(J1=hb.I(one, f=300.0), J2=hb.I(two, f=200.0), a=hb.One(), b=hb.One(), dog=hb.Zero())
    m.add(drive=hb.Se(f'if gear.state == "engaged" then {torque} else 0'))
    pressed = f"if time >= 0.1 then {cone} else 0"
    m.add(cone=hb.Submodel("rotational.clutch", inputs={"capacity": pressed}))
    m.bond("a -> J1", "b -> J2", "a -> cone.left", "cone.right -> b", "a -> dog -> b", "drive -> a")
    rules = ["neutral -> engaged when cone.locked > 0.5 and time > 0.2"]
    m.machine("gear", states={"neutral": [], "engaged": ["dog"]}, start="neutral", rules=rules)
    even = 0.1 + 100 * one * two / (one + two) / cone
    run = hb.simulate(m, 0.6, solver=solver)
    assert guards(run) == pytest.approx([even], rel=1e-9)
    speed = (one * 300 + two * 200 + torque * (0.6 - even)) / (one + two)
    assert run["b.f"].at(0.6) == pytest.approx(speed, rel=1e-9)


@functools.cache
def braked_by_hand() -> tuple[float, float, int]:
    """Return when the car is down to 5 m/s, how far it has come, and how often the valve turned."""

    def slip(y: np.ndarray) -> float:
        return (y[0] - 0.3 * y[1]) / y[0]

    t, y, applied, switched = 0.0, np.array([25.0, 25 / 0.3, 0.0]), True, 0
    while y[0] > 5.0 + 1e-9:

        def rates(_: float, y: np.ndarray, on: bool = applied) -> list[float]:
            force = 2943 * 2 * slip(y) / 0.12 / (1 + (slip(y) / 0.12) ** 2)
            return [-force / 300, (-1500 if on else -200) + 0.3 * force, y[0]]

        turns = lambda _, y, on=applied: slip(y) - (0.2 if on else 0.08)  # noqa: E731
        slow = lambda _, y: y[0] - 5.0  # noqa: E731
        turns.terminal = slow.terminal = True
        turns.direction = 1 if applied else -1
        s = solve_ivp(rates, (t, 20), y, events=[turns, slow], rtol=1e-10, atol=1e-11)
        t, y, applied = s.t[-1], s.y[:, -1], not applied
        switched += len(s.t_events[0])
    return float(t), float(y[2]), switched


@pytest.mark.sampled(1)
@BOTH
@pytest.mark.slow
def test_brakes_of_slip_hold_a_wheel_from_locking(solver: str) -> None:
    """A valve between two slips; the curve of the tyre falls behind a slip of 0.12."""
    m = hb.Model("abs", domain="translational", parameters={"load": "2943 N"})
    m.add(body=hb.I("300 kg", f="25 m/s"), v=hb.One(), r=hb.TF(0.3), patch=hb.Zero())
    m.add(J=hb.I(1.0, f=25 / 0.3, domain="rotational"), w=hb.One(domain="rotational"))
    m.add(tyre=hb.R({"e": "load*2*s/0.12/(1 + (s/0.12)^2)"}))
    m.add(brake=hb.Se('if valve.state == "apply" then -1500 else -200', domain="rotational"))
    m.signal(s="(v.f - 0.3*w.f)/v.f", x=hb.Integral("v.f"))
    m.bond("v -> body", "w -> J", "brake -> w", "v -> patch -> r.2", "r.1 -> w", "patch -> tyre")
    rules = ["apply -> release when s > 0.2 and v.f > 2", "release -> apply when s < 0.08"]
    m.machine("valve", states={"apply": [], "release": []}, start="apply", rules=rules)

    t, way, switched = braked_by_hand()
    run = hb.simulate(m, [20.0, "v.f < 5"], solver=solver)
    assert run.t_end == pytest.approx(t, rel=1e-7)
    assert run["x"].at(run.t_end) == pytest.approx(way, rel=1e-7)
    assert sum(event.cause == "guard" for event in run.events) == switched > 10
