"""Guards at their hardest, against closed forms, by every method."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

METHODS = ["rk45", "radau", "exact"]


@pytest.fixture(params=METHODS)
def run(request):
    return functools.partial(hb.simulate, solver=request.param)


def clock(**machines):
    """A charge that is the time: q = t."""
    m = hb.Model("clock", domain="electrical")
    m.add(S=hb.Sf("1 A"), C=hb.C("1 F"), n=hb.Zero())
    m.bond("S -> n -> C")
    for name, (start, rules) in machines.items():
        states = {w: [] for r in rules for w in (r.split()[0], r.split()[2])}
        m.machine(name, states=states, start=start, rules=rules)
    return m


def parabola(depth):
    """A body that turns round where h = -depth, at t = 1: h = (t - 1)^2/2 - depth."""
    m = hb.Model("turn", domain="translational")
    m.add(push=hb.Se("1 N"), m=hb.I("1 kg", p=-1.0), v=hb.One())
    m.bond("push -> v -> m")
    m.signal(h=hb.Integral("v.f", start=0.5 - depth))
    m.machine(
        "M",
        states={"above": [], "below": []},
        start="above",
        rules=["above -> below when h < 0", "below -> above when h > 0"],
    )
    return m


def times(run):
    return [e.t for e in run.events if e.cause != "start"]


@pytest.mark.parametrize("depth", [-1e-2, -1e-6, -1e-9])
def test_what_comes_near_and_returns_does_not_fire(run, depth):
    assert times(run(parabola(depth), 2.0)) == []


@pytest.mark.parametrize("depth", [1e-2, 1e-6, 1e-9])
def test_two_crossings_inside_one_step(run, depth):
    """The whole motion is one step of each method, or a few."""
    done = run(parabola(depth), 2.0)
    half = math.sqrt(2.0 * depth)
    # a time is as sharp as the height is, over the speed there: a dozen terms of up to one half,
    # whose roundings processors add up in different order
    height = 24 * math.ulp(0.5)
    assert times(done) == pytest.approx([1.0 - half, 1.0 + half], abs=1e-13 + height / half)


def test_a_restart_exactly_on_a_guard(run):
    """The charge is 0.5 when the first rule fires; the second asks for more than that."""
    done = run(clock(M=("a", ["a -> b when time >= 0.5", "b -> c when C.q > 0.5"])), 1.0)
    assert times(done) == pytest.approx([0.5] * len(times(done)), abs=1e-12)
    assert done.mode["M"] == "c"


def test_a_restart_on_a_guard_that_is_left(run):
    """From rest on the bound away from it: nothing fires until it comes back."""
    m = hb.Model("throw", domain="translational")
    m.add(g=hb.Se("-10 N"), m=hb.I("1 kg", p=5.0), v=hb.One())
    m.bond("g -> v -> m")
    m.signal(h=hb.Integral("v.f", start=0))
    m.machine(
        "M", states={"up": [], "down": []}, start="up", rules=["up -> down when h <= 0 and v.f < 0"]
    )
    assert times(run(m, 2.0)) == pytest.approx([1.0], abs=1e-12)


def test_a_hundred_guards_at_one_instant(run):
    machines = {f"M{k}": ("a", ["a -> b when C.q >= 0.25"]) for k in range(100)}
    done = run(clock(**machines), 1.0)
    assert times(done) == pytest.approx([0.25], abs=1e-12)
    assert set(done.mode.values()) == {"b"}


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_a_grazing_contact(run, gap):
    """A ball thrown at a ceiling just below or just above where it turns."""
    speed, g = 2.0, 10.0
    for side in (1.0, -1.0):
        m = hb.Model("throw", domain="translational")
        m.add(w=hb.Se(-g), ball=hb.I(1.0, p=speed), v=hb.One(), hit=hb.Zero())
        m.add(top=hb.Sf("-0.5*pre(v.f)"))
        m.bond("w -> v -> ball", "top -> hit -> v")
        m.signal(gap=hb.Integral("-v.f", start=0.5 * speed**2 / g + side * gap))
        m.machine(
            "M",
            states={"away": [], "hits": ["hit"]},
            start="away",
            rules=["away -> hits when gap <= 0 and v.f > 0", "hits -> away when pre(v.f) <= 0"],
        )
        done = run(m, 0.39)
        if side > 0.0:
            assert times(done) == []
            continue
        left = math.sqrt(2.0 * g * gap)
        assert times(done) == pytest.approx([(speed - left) / g], abs=1e-12 + 1e-15 / left)
        t = (speed - left) / g
        want = -0.5 * left - g * (0.39 - t)
        assert done["v.f"].at(0.39) == pytest.approx(want, rel=1e-9)


def test_an_event_at_the_start(run):
    done = run(clock(M=("a", ["a -> b when C.q >= 0"])), 1.0)
    assert done.events[0].t == 0.0 and done.mode["M"] == "b"
    assert len(done.events) == 1


def test_an_event_at_the_end(run):
    done = run(clock(M=("a", ["a -> b when time >= 1"])), 1.0)
    assert times(done) in ([], [1.0])
    before = run(clock(M=("a", ["a -> b when C.q >= 0.999999"])), 1.0)
    assert times(before) == pytest.approx([0.999999], abs=1e-12) and before.mode["M"] == "b"
    after = run(clock(M=("a", ["a -> b when C.q >= 1.000001"])), 1.0)
    assert times(after) == []


def test_edges_at_the_instants_of_guards(run):
    """The charge grows by 2 A and 1 A in turn, and meets its bounds where the edges are."""
    m = hb.Model("edges", domain="electrical")
    m.input(u=hb.Input(pwm={"period": 0.5, "duty": 0.5}))
    m.add(S=hb.Sf("1 + u"), C=hb.C("1 F"), n=hb.Zero())
    m.bond("S -> n -> C")
    bounds = [0.5, 0.75, 1.25, 1.5, 2.0, 2.25]
    names = "abcdefg"
    m.machine(
        "M",
        states={k: [] for k in names},
        start="a",
        rules=[
            f"{names[k]} -> {names[k + 1]} when C.q >= {bound}" for k, bound in enumerate(bounds)
        ],
    )
    done = run(m, 1.6)
    fired = [e for e in done.events if any(step.fired for step in e.steps)]
    assert [e.t for e in fired] == pytest.approx([0.25 * k for k in range(1, 7)], abs=1e-12)
    # guard and edge are one event, not two that follow one another by rounding
    assert len(done.events) == 7
    assert done["C.q"].at(1.6) == pytest.approx(2.45, abs=1e-12)


def test_a_guard_a_last_place_beyond_its_bound_is_passed() -> None:
    """Found in the motion and a last place short of it when settled, a guard is no end of time.

    Blocked, one winding of a field follows the current u of the other, p1 = 0.384 u: what is
    stored is put back on that constraint at each instant, which moves it by a last place.
    """
    model = hb.Model("a blocked winding")
    inverse_capacity = np.linalg.inv([[1.72, -0.979], [-0.979, 1.54]])
    start = np.array([0.8976324323195317, 1.2857254477694062])
    model.add(
        j2=hb.One(),
        r0=hb.R(1.1867469879518073),
        c3=hb.C([[1.72, -0.979], [-0.979, 1.54]], q=start.tolist()),
        j1=hb.One(),
        j4=hb.One(),
        i2=hb.I(0.826530612244898, p=-0.0),
        j5=hb.One(),
        i4=hb.I([[1.88, -0.384], [-0.384, 1.08]], p=[-0.3566029470860048, -0.7709193015505678]),
    )
    model.bond("c3.2 -> j2", "j5 -> i4.2", "j5 -> j4", "r0 -> j4", "j1 -> i4.1", "j4 -> c3.1")
    model.bond("i2 -> j4")
    rules = ["off -> on when i4.1.p > 0.1855", "on -> off when i4.1.p < 0.08057"]
    model.machine("m0", states={"off": [], "on": ["j1"]}, start="off", rules=rules)
    gate = ["off -> on when time >= 0.2 and time < 0.7"]
    gate += ["on -> off when time < 0.2 or time >= 0.7"]
    model.machine("m1", states={"off": [], "on": ["j2"]}, start="on", rules=gate)
    run = hb.simulate(model, 1.31)
    assert run.status == "ok"
    inertia = 0.826530612244898 + 1.08

    def rates(_: float, y: np.ndarray) -> list[float]:
        pull = inverse_capacity[0] @ [y[1], start[1]]
        return [(pull - 1.1867469879518073 * y[0]) / inertia, -y[0]]

    def reached(_: float, y: np.ndarray) -> float:
        return 0.384 * y[0] - 0.1855

    first = [0.7709193015505678 / inertia, start[0]]
    found = solve_ivp(rates, (0, 0.19), first, events=reached, rtol=1e-12, atol=1e-13)
    assert [e.t for e in run.events] == pytest.approx([0.0, found.t_events[0][0], 0.2, 0.7])
