"""Dry friction in two directions, against closed forms and against friction in one direction."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import hybond as hb


def along(angle: float) -> tuple[float, float]:
    return math.cos(angle), math.sin(angle)


def block(
    force: tuple[Any, Any] = (0, 0),
    velocity: tuple[float, float] = (0.0, 0.0),
    mass: tuple[float, float] = (1.0, 1.0),
    **law: Any,
) -> hb.Model:
    """Return a block on a table."""
    m = hb.Model("block", domain="translational")
    m.add(sx=hb.One(law="coulomb", **law), sy=hb.One(law="coulomb", pair="sx"))
    m.add(mx=hb.I(mass[0], f=velocity[0]), my=hb.I(mass[1], f=velocity[1]))
    m.add(Fx=hb.Se(force[0]), Fy=hb.Se(force[1]))
    m.bond("Fx -> sx -> mx", "Fy -> sy -> my")
    m.signal(x=hb.Integral("sx.f"), y=hb.Integral("sy.f"))
    return m


def states(run: hb.Result, machine: int = 0) -> list[str]:
    own = run.graph.machines[machine]
    return [own.states[e.steps[-1].mode[machine]] for e in run.events]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("angle", [0.0, 0.3, 1.6, 2.5, -2.0])
def test_a_block_stops_on_a_straight_line(angle: float) -> None:
    c, s = along(angle)
    run = hb.simulate(block(velocity=(6.0 * c, 6.0 * s), limit=2.5), until=5)
    assert states(run) == ["slips", "sticks"]
    assert run.events[-1].t == pytest.approx(6.0 / 2.5, rel=1e-10)
    assert run["x"].at(5.0) == pytest.approx(36.0 / 5.0 * c, abs=1e-8)
    assert run["y"].at(5.0) == pytest.approx(36.0 / 5.0 * s, abs=1e-8)
    assert run["mx.p"].at(5.0) == run["my.p"].at(5.0) == 0.0


@pytest.mark.slow
def test_the_limit_is_a_disk_and_no_box() -> None:
    for size, state in ((2.99, "sticks"), (3.2, "slips")):
        for angle in np.linspace(0.0, 2.0 * math.pi, 9):
            c, s = along(float(angle))
            run = hb.simulate(block((size * c, size * s), limit=3.0), until=1e-3)
            assert states(run) == [state]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("rtol", "close"), [(1e-8, 1e-7), (1e-11, 1e-9)])
@pytest.mark.parametrize("turned", [0.0, 2.2])
def test_the_hodograph_of_a_block_with_a_steady_side_force(
    rtol: float, close: float, turned: float
) -> None:
    # r' = F cos a - m, r a' = -F sin a: r = C tan(a/2)^(m/F) / sin a, a being the angle between
    # the velocity and the force
    m, force, speed, start = 3.0, 2.0, 5.0, 1.9
    scale = speed * math.sin(start) / math.tan(start / 2.0) ** (m / force)

    def r(a: float) -> float:
        return scale * math.tan(a / 2.0) ** (m / force) / math.sin(a)

    def over(f: Any) -> float:
        return float(quad(lambda a: f(a) / (force * math.sin(a)), 0.0, start, epsabs=1e-13)[0])

    c, s = along(turned)
    at = along(start + turned)
    run = hb.simulate(
        block((force * c, force * s), (speed * at[0], speed * at[1]), limit=m), until=4, rtol=rtol
    )
    assert states(run) == ["slips", "sticks"]
    assert run.events[-1].t == pytest.approx(over(r), abs=close)
    x, y = run["x"].at(4.0), run["y"].at(4.0)
    assert x * c + y * s == pytest.approx(over(lambda a: r(a) ** 2 * math.cos(a)), abs=close)
    assert y * c - x * s == pytest.approx(over(lambda a: r(a) ** 2 * math.sin(a)), abs=close)


@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.3, math.pi / 2.0])
def test_the_friction_oscillator_in_any_direction(angle: float) -> None:
    # m = k = 1, friction 1, x(0) = 12, v(0) = 6: each half period turns round 1 nearer
    c, s = along(angle)
    m = hb.Model("oscillator", domain="translational")
    m.add(sx=hb.One(law="coulomb", limit=1), sy=hb.One(law="coulomb", pair="sx"))
    m.add(mx=hb.I(1, f=6.0 * c), my=hb.I(1, f=6.0 * s))
    m.add(kx=hb.C(1, q=12.0 * c), ky=hb.C(1, q=12.0 * s))
    m.bond("sx -> mx", "sx -> kx", "sy -> my", "sy -> ky")
    run = hb.simulate(m, until=25, rtol=1e-10)
    first = math.atan(6.0 / 13.0)
    turns = [math.hypot(13.0, 6.0) - 1.0 - 2.0 * k for k in range(7)]
    for k, size in enumerate(turns):
        t = first + k * math.pi
        x, y = run["kx.q"].at(t), run["ky.q"].at(t)
        assert x * c + y * s == pytest.approx((-1) ** k * size, abs=1e-6)
        assert y * c - x * s == pytest.approx(0.0, abs=1e-6)
    assert states(run)[-1] == "sticks"
    assert run.events[-1].t == pytest.approx(first + 7 * math.pi, abs=1e-6)
    rest = (math.hypot(13.0, 6.0) - 1.0 - 14.0) * -1.0
    assert run["kx.q"].at(25.0) * c + run["ky.q"].at(25.0) * s == pytest.approx(rest, abs=1e-7)


def test_a_growing_push_breaks_loose_at_the_breakaway_force() -> None:
    run = hb.simulate(block(("3*time*1[N/s]", "4*time*1[N/s]"), limit=3, breakaway=4), until=2)
    assert states(run) == ["sticks", "slips"]
    assert run.events[-1].t == pytest.approx(0.8, abs=1e-11)
    v = 2.5 * (4.0 - 0.64) - 3.0 * 1.2
    assert run["mx.p"].at(2.0) == pytest.approx(0.6 * v, abs=1e-8)
    assert run["my.p"].at(2.0) == pytest.approx(0.8 * v, abs=1e-8)


@pytest.mark.slow
def test_a_growing_push_breaks_loose_at_the_limit_itself() -> None:
    # nothing is left to move with at first: 5 t - 4 from t = 0.8 on
    for solver in ("rk45", "radau"):
        run = hb.simulate(
            block(("3*time*1[N/s]", "4*time*1[N/s]"), limit=4), until=2, solver=solver
        )
        v = 2.5 * (4.0 - 0.64) - 4.0 * 1.2
        assert run["mx.p"].at(2.0) == pytest.approx(0.6 * v, abs=1e-7)
        assert run["my.p"].at(2.0) == pytest.approx(0.8 * v, abs=1e-7)


@pytest.mark.slow
def test_at_the_limit_the_slip_follows_a_push_that_turns() -> None:
    m = block(("3*time*1[N/s]", "4*time^2*1[N/s^2]"), limit=4)
    onset = brentq(lambda t: math.hypot(3.0 * t, 4.0 * t * t) - 4.0, 0.5, 1.0, xtol=1e-15)
    run = hb.simulate(m, until=2, rtol=1e-9)
    assert run.events[-1].t == pytest.approx(onset, abs=1e-9)

    # a second derivation: the same motion from a little later on, with an implicit method; what
    # it starts with is forgotten at the rate limit / speed
    def field(t: float, v: np.ndarray) -> np.ndarray:
        return np.array([3.0 * t, 4.0 * t * t]) - 4.0 * v / np.linalg.norm(v)

    t0 = onset + 1e-3
    push = np.array([3.0 * onset, 4.0 * onset**2]) / 4.0
    grows = push @ np.array([3.0, 8.0 * onset])
    found = solve_ivp(
        field, (t0, 2.0), 0.5e-6 * grows * push, method="Radau", rtol=1e-9, atol=1e-13
    )
    assert run["mx.p"].at(2.0) == pytest.approx(found.y[0, -1], abs=2e-6)
    assert run["my.p"].at(2.0) == pytest.approx(found.y[1, -1], abs=2e-6)


def test_slip_begins_where_friction_and_acceleration_agree() -> None:
    # inertia 1 and 4: the acceleration is not along the push; from rest it keeps its direction
    run = hb.simulate(block((3.0, 2.5), mass=(1.0, 4.0), limit=3.0), until=3)

    def across(a: float) -> float:
        c, s = along(a)
        return c * (2.5 - 3.0 * s) / 4.0 - s * (3.0 - 3.0 * c)

    want = brentq(across, 0.1, 1.2, xtol=1e-15)
    assert run["sx.heading"].at(1.0) == pytest.approx(want, abs=1e-12)
    angle = math.atan2(run["sy.f"].at(3.0), run["sx.f"].at(3.0))
    assert angle == pytest.approx(want, abs=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("start", [2.0, -2.0])
def test_one_direction_alone_is_friction_in_one_direction(start: float) -> None:
    push = "5*cos(2*time/1[s])*1[N]"
    plane = hb.simulate(
        block((push, 0), (start, 0.0), limit=3, breakaway=3.5), until=10, rtol=1e-10
    )
    m = hb.Model("line", domain="translational")
    m.add(s=hb.One(law="coulomb", limit=3, breakaway=3.5), m=hb.I(1, f=start), F=hb.Se(push))
    m.bond("F -> s -> m")
    line = hb.simulate(m, until=10, rtol=1e-10)
    assert len(plane.events) == len(line.events) > 10
    for a, b in zip(plane.events, line.events, strict=True):
        assert a.t == pytest.approx(b.t, abs=1e-8)
    for t in np.linspace(0.0, 10.0, 41):
        assert plane["mx.p"].at(t) == pytest.approx(line["m.p"].at(t), abs=1e-8)
        assert abs(plane["my.p"].at(t)) < 1e-15


@pytest.mark.slow
def test_a_near_miss_of_rest_is_no_rest() -> None:
    # at the turning point the velocity across is small: friction turns quickly, and slip goes on
    m = block(("-4[N]", 0), (3.0, 1e-5), limit=1.0)
    run = hb.simulate(m, until=2, rtol=1e-11)

    def field(t: float, v: np.ndarray) -> np.ndarray:
        return np.array([-4.0, 0.0]) - v / np.linalg.norm(v)

    found = solve_ivp(field, (0.0, 2.0), [3.0, 1e-5], method="LSODA", rtol=1e-12, atol=1e-15)
    assert run["mx.p"].at(2.0) == pytest.approx(found.y[0, -1], abs=1e-8)
    assert run["my.p"].at(2.0) == pytest.approx(found.y[1, -1], abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("theta", [0.5, 1.0])
def test_time_stepping_comes_closer_with_its_step(theta: float) -> None:
    model = block((2.0, 0.0), (-1.6, 4.7), limit=3.0)
    exact = hb.simulate(model, until=4, rtol=1e-11)
    off = []
    for step in (0.02, 0.01, 0.005):
        run = hb.simulate(model, until=4, solver="moreau-jean", step=step, theta=theta)
        assert run.events[-1].t == pytest.approx(exact.events[-1].t, abs=step)
        assert run["mx.p"].at(4.0) == run["my.p"].at(4.0) == 0.0
        ends = [run[k].at(4.0) - exact[k].at(4.0) for k in "xy"]
        off.append(math.hypot(*ends))
    assert 1.9 < off[0] / off[1] < 2.1 and 1.9 < off[1] / off[2] < 2.1


@pytest.mark.slow
def test_time_stepping_has_the_same_disk_along_every_direction() -> None:
    for angle in (0.0, 0.4, 2.0, -1.1):
        c, s = along(angle)
        run = hb.simulate(
            block((3.3 * c, 3.3 * s), limit=3.0), until=1, solver="moreau-jean", step=0.05
        )
        assert run["mx.p"].at(1.0) == pytest.approx(0.3 * c, rel=1e-9, abs=1e-12)
        assert run["my.p"].at(1.0) == pytest.approx(0.3 * s, rel=1e-9, abs=1e-12)
        run = hb.simulate(
            block((2.9 * c, 2.9 * s), limit=3.0), until=1, solver="moreau-jean", step=0.05
        )
        assert abs(run["mx.p"].at(1.0)) < 1e-14 and abs(run["my.p"].at(1.0)) < 1e-14


@pytest.mark.sampled(1)
@pytest.mark.parametrize("quarter", [1, 2, 3])
def test_time_stepping_along_an_axis_but_for_rounding(quarter: int) -> None:
    """Directions by cosines: across the way is 1e-16 of the speed (HB-J121 in one of twelve)."""
    c, s = along(0.5 * math.pi * quarter)
    for speed in (0.9162611604917494, 2.0, 3.610752111878013, 6.403467668806948):
        m = block(velocity=(speed * c, speed * s), mass=(0.17, 0.17), limit=0.25 * 0.17 * 9.81)
        run = hb.simulate(m, until=0.3, method=hb.MoreauJean(step=1e-3))
        left = speed - 0.25 * 9.81 * 0.3
        assert math.hypot(run["sx.f"].at(0.3), run["sy.f"].at(0.3)) == pytest.approx(
            max(left, 0.0), abs=1e-9
        )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "moreau-jean"])
def test_a_contact_bears_on_the_disk(solver: str) -> None:
    # a block on the ground: the limit is half of what the ground carries, 20 N from 0.2 s on
    m = block(velocity=(3.0, 4.0), limit="-0.5*ground.e")
    m.add(ground=hb.One(law="unilateral"), mz=hb.I(1))
    m.add(weight=hb.Se("if time < 0.2[s] then -10[N] else -20[N]"))
    m.bond("weight -> ground -> mz")
    options = {"step": 0.001} if solver == "moreau-jean" else {}
    run = hb.simulate(m, until=1, solver=solver, **options)
    assert run["mx.p"].at(0.2) == pytest.approx(2.4, abs=1e-8)
    assert run.events[-1].t == pytest.approx(0.6, abs=1e-10 if solver == "rk45" else 0.001)
    assert states(run)[-1] == "sticks"


@pytest.mark.sampled(2)
@pytest.mark.parametrize("pair", [False, True])
@pytest.mark.parametrize("solver", ["rk45", "moreau-jean"])
def test_a_limit_below_zero_is_refused(pair: bool, solver: str) -> None:
    m = hb.Model("pushes", domain="translational")
    m.add(sx=hb.One(law="coulomb", limit="1[N] - time*1[N/s]"), mx=hb.I(1, f=9))
    m.bond("sx -> mx")
    if pair:
        m.add(sy=hb.One(law="coulomb", pair="sx"), my=hb.I(1, f=9))
        m.bond("sy -> my")
    options = {"step": 0.01} if solver == "moreau-jean" else {}
    assert hb.simulate(m, until=1, solver=solver, **options).status == "ok"
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, until=1.5, solver=solver, **options)
    assert caught.value.code == "HB-N407" and caught.value.partial is not None


@pytest.mark.sampled(1)
@pytest.mark.parametrize("force", [0.5, 0.9, 0.95, 0.99])
def test_slip_that_a_force_hardly_slows_stops_when_it_must(force: float) -> None:
    # limit 1: d/dt (|v| L + F . v) = -(L^2 - F^2), whatever the direction
    run = hb.simulate(block((0.0, force), (1.0, 0.3), limit=1.0), until=80)
    want = (math.hypot(1.0, 0.3) + force * 0.3) / (1.0 - force**2)
    assert states(run) == ["slips", "sticks"]
    assert run.events[-1].t == pytest.approx(want, rel=1e-7)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("force", "at"), [(0.5, 1.5919), (0.9, 6.9155)])
def test_nothing_is_missed_while_slip_comes_to_its_end(force: float, at: float) -> None:
    m = block((0.0, force), (1.0, 0.3), limit=1.0)
    m.add(F=hb.Se('if k.state == "a" then 1 else -1000'), o=hb.One(), b=hb.I(1))
    m.bond("F -> o -> b")
    rules = [f"a -> z when b.p > {at}", "z -> a when b.p < 0"]
    m.machine("k", states={"a": [], "z": []}, start="a", rules=rules)
    run = hb.simulate(m, until=at + 1e-3)
    fired = [(e.t, f.machine) for e in run.events for s in e.steps for f in s.fired]
    # less than 1e-3 s before slip ends
    assert fired[1] == (pytest.approx(at, abs=1e-10), "k")
    assert fired[2][1] == "sx"
    want = (math.hypot(1.0, 0.3) + force * 0.3) / (1.0 - force**2)
    assert fired[2][0] == pytest.approx(want, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("second", [((1.2, 1.6), 1.0), ((1.2, 1.6001), 1.0), ((0.3, -0.4), 0.25)])
def test_two_slips_that_end_together_or_nearly(second: tuple[tuple[float, float], float]) -> None:
    m = hb.Model("two", domain="translational")
    want = []
    for name, (v, limit) in (("a", ((3.0, 4.0), 2.5)), ("b", second)):
        x, y = f"{name}x", f"{name}y"
        m.add(**{x: hb.One(law="coulomb", limit=limit), y: hb.One(law="coulomb", pair=x)})
        m.add(**{f"m{x}": hb.I(1, f=v[0]), f"m{y}": hb.I(1, f=v[1]), f"F{x}": hb.Se(0.3 * limit)})
        m.bond(f"F{x} -> {x} -> m{x}", f"{y} -> m{y}")
        want.append((math.hypot(*v) + 0.3 * v[0]) / (limit * (1.0 - 0.09)))
    run = hb.simulate(m, until=5, rtol=1e-9)
    ends = {f.machine: e.t for e in run.events for s in e.steps for f in s.fired}
    assert [ends["ax"], ends["bx"]] == pytest.approx(want, abs=1e-8)
    assert all(run.final[f"m{k}.p"] == 0.0 for k in ("ax", "ay", "bx", "by"))


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "moreau-jean"])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_a_body_that_holds_below_one_that_slips(solver: str, angle: float) -> None:
    # ground, 1.5 N, lower body, 1 N, upper body, 3 N: the lower one is held by the ground
    c, s = along(angle)
    m = hb.Model("stack", domain="translational")
    for k, part in (("x", c), ("y", s)):
        for name, limit in (("ground", 1.5), ("between", 1.0)):
            law = {"pair": f"{name}x"} if k == "y" else {"limit": limit}
            m.add(**{f"{name}{k}": hb.One(law="coulomb", **law)})
        m.add(**{f"lower{k}": hb.I(1), f"upper{k}": hb.I(1), f"F{k}": hb.Se(3.0 * part)})
        m.add(**{f"u{k}": hb.One(), f"l{k}": hb.One(), f"rub{k}": hb.Zero(), f"g{k}": hb.Zero()})
        m.bond(f"F{k} -> u{k} -> upper{k}", f"u{k} -> rub{k} -> l{k} -> lower{k}")
        m.bond(f"rub{k} -> between{k}", f"l{k} -> g{k} -> ground{k}")
    options = {"step": 0.01} if solver == "moreau-jean" else {}
    run = hb.simulate(m, until=1, solver=solver, **options)
    assert abs(run.final["lowerx.p"]) < 1e-12 and abs(run.final["lowery.p"]) < 1e-12
    assert run.final["upperx.p"] == pytest.approx(2.0 * c, abs=1e-9)
    assert run.final["uppery.p"] == pytest.approx(2.0 * s, abs=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "moreau-jean"])
def test_a_wall_that_begins_to_push(solver: str) -> None:
    m = hb.Model("wall", domain="translational")
    m.add(sx=hb.One(law="coulomb", limit=0.3), sy=hb.One(law="coulomb", pair="sx"))
    m.add(mx=hb.I(1), my=hb.I(1), jx=hb.One(), zx=hb.Zero(), wall=hb.Sf("-0.5*time*1[m/s^2]"))
    m.add(contact=hb.Zero(law="unilateral", gap="gap"))
    m.bond("jx -> mx", "jx -> zx -> sx", "jx -> contact -> wall", "sy -> my")
    m.signal(x=hb.Integral("jx.f"), at=hb.Integral("wall.f"), gap="at - x")
    options = {"step": 0.002} if solver == "moreau-jean" else {}
    run = hb.simulate(m, until=1, solver=solver, **options)
    assert run.final["mx.p"] == pytest.approx(-0.5, abs=1e-9)
    assert abs(run.final["my.p"]) < 1e-12


@pytest.mark.sampled(3)
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_no_solver_and_no_tolerance_lets_friction_push(solver: str, rtol: float) -> None:
    # a spring beside the push: x'' = 1.5 t - 1 - x from the time 1 on
    m = block(("1.2*time*1[N/s]", "0.9*time*1[N/s]"), limit=1, breakaway=1.5)
    m.add(kx=hb.C(1), ky=hb.C(1))
    m.bond("sx -> kx", "sy -> ky")
    run = hb.simulate(m, until=2, rtol=rtol, solver=solver)
    want = 1.5 + 0.5 * math.sin(1.0) - 1.5 * math.cos(1.0)
    speed = math.hypot(run.final["mx.p"], run.final["my.p"])
    assert speed == pytest.approx(want, abs=max(0.1 * rtol, 2e-6))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
@pytest.mark.parametrize("angle", [0.6, 2.0])
def test_a_slanted_swing_comes_to_rest_at_loose_tolerances(angle: float, rtol: float) -> None:
    # m = k = 1, friction 0.3, from 4: rests after 7 half periods at 0.2
    c, s = along(angle)
    m = block(limit=0.3)
    m.add(kx=hb.C(1, q=4.0 * c), ky=hb.C(1, q=4.0 * s))
    m.bond("sx -> kx", "sy -> ky")
    run = hb.simulate(m, until=24, rtol=rtol)
    assert states(run)[-1] == "sticks"
    assert run.events[-1].t == pytest.approx(7.0 * math.pi, abs=20.0 * rtol**0.75)
    x, y = run.final["kx.q"], run.final["ky.q"]
    assert x * c + y * s == pytest.approx(0.2, abs=20.0 * rtol)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("rtol", [1e-2, 2e-3, 1e-5])
@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_slip_ends_at_any_tolerance(solver: str, rtol: float) -> None:
    run = hb.simulate(block((0.5, 0.0), (3.0, 4.0), limit=2.5), until=4, solver=solver, rtol=rtol)
    assert states(run) == ["slips", "sticks"]
    want = (5.0 * 2.5 + 0.5 * 3.0) / (2.5**2 - 0.25)
    assert run.events[-1].t == pytest.approx(want, rel=rtol)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("turned", list(itertools.product((1, -1), repeat=4)))
def test_bonds_turned_round_turn_their_own_signs_alone(turned: tuple[int, ...]) -> None:
    m = hb.Model("block", domain="translational")
    m.add(sx=hb.One(law="coulomb", limit=1), sy=hb.One(law="coulomb", pair="sx"))
    m.add(Fx=hb.Se(0.6), Fy=hb.Se(0.2), mx=hb.I(1, f=1.0), my=hb.I(1, f=0.5))
    bonds = (("Fx", "sx"), ("sx", "mx"), ("Fy", "sy"), ("sy", "my"))
    for turn, (a, b) in zip(turned, bonds, strict=True):
        m.bond(f"{a} -> {b}" if turn > 0 else f"{b} -> {a}")
    run = hb.simulate(m, until=1, rtol=1e-10)
    # a source turned round pushes the other way, a mass turned round starts the other way
    push_x, mass_x, push_y, mass_y = turned
    straight = block((0.6 * push_x, 0.2 * push_y), (1.0 * mass_x, 0.5 * mass_y), limit=1)
    want = hb.simulate(straight, until=1, rtol=1e-10)
    assert run["mx.p"].at(1.0) == pytest.approx(mass_x * want["mx.p"].at(1.0), abs=1e-9)
    assert run["my.p"].at(1.0) == pytest.approx(mass_y * want["my.p"].at(1.0), abs=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize("step", [pytest.param(0.001, marks=pytest.mark.slow), 0.03, 0.2])
def test_fixed_steps_do_not_pass_rest(step: float) -> None:
    run = hb.simulate(block((0.5, 0.0), (3.0, 4.0), limit=2.5), until=4, solver="rk4", step=step)
    assert states(run) == ["slips", "sticks"]
    want = (5.0 * 2.5 + 0.5 * 3.0) / (2.5**2 - 0.25)
    assert run.events[-1].t == pytest.approx(want, abs=1e-4 if step > 0.1 else 1e-6)


@pytest.mark.slow
def test_breaking_loose_at_the_limit_does_not_depend_on_how_long_the_run_is() -> None:
    force = tuple(f"(2[N] + 0.5*time*1[N/s])*{f}(time/1[s])" for f in ("cos", "sin"))
    ends = []
    for until, solver in ((2.1, "rk45"), (2.1, "radau"), (4.0, "rk45")):
        run = hb.simulate(block(force, limit=3), until=until, solver=solver)
        assert run.events[-1].t == pytest.approx(2.0, abs=1e-9)
        ends.append((run["mx.p"].at(2.1), run["my.p"].at(2.1)))
    assert ends[1] == pytest.approx(ends[0], abs=1e-8)
    assert ends[2] == pytest.approx(ends[0], abs=1e-8)


@pytest.mark.slow
def test_two_engines_agree_on_a_pair() -> None:
    found = hb.cross_check(block((1.0, 0.0), (1.0, 2.0), limit=2.0), until=2, step=0.01)
    assert found.agrees
    # how slip is led to rest is not part of the answer
    assert not {"sx.heading", "sx.slow"} & {d.quantity.name for d in found.differences}


def test_slip_needs_inertia() -> None:
    m = hb.Model("massless", domain="translational")
    m.add(x=hb.One(law="coulomb", limit=1), y=hb.One(law="coulomb", pair="x"))
    m.add(kx=hb.C(1, q=2), ky=hb.C(1), my=hb.I(1))
    m.bond("x -> kx", "y -> ky", "y -> my")
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, until=1)
    assert caught.value.code == "HB-C105"
