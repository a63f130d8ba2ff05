"""Impacts that accumulate: landing at the limit, resting, leaving. Oracles are closed forms."""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

import hybond as hb

G = 9.81


def drop(eps: float, h: float) -> tuple[float, float]:
    """Return the first impact and the limit of all of a ball that falls from h."""
    first = math.sqrt(2 * h / G)
    return first, first * (1 + eps) / (1 - eps)


def balls(*which: tuple[float, float], force: str = "0", **inputs: hb.Input) -> hb.Model:
    """Return balls of mass 1, 2, ... over one floor, each with its restitution and height."""
    m = hb.Model("balls", domain="translational")
    m.input(**inputs)
    for k, (eps, h) in enumerate(which, 1):
        weight, rebound = hb.Se(f"-{G}*{k} + ({force})"), hb.Sf(f"-{eps}*pre(v{k}.f)")
        parts = {"w": weight, "b": hb.I(k), "v": hb.One(), "c": hb.Zero(), "r": rebound}
        m.add(**{f"{name}{k}": part for name, part in parts.items()})
        m.bond(f"w{k} -> v{k} -> b{k}", f"c{k} -> v{k}", f"r{k} -> c{k}")
        m.signal(**{f"h{k}": hb.Integral(f"v{k}.f", start=h)})
        m.machine(
            f"F{k}",
            states={"away": [], "impact": [f"c{k}"]},
            start="away",
            rules=[
                f"away -> impact when h{k} <= 0 and v{k}.f < 0",
                f"impact -> away when pre(b{k}.p) >= 0",
            ],
        )
    return m


# -- one ball


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("eps", [1e-8, 1e-6, 0.1, 0.5, 0.9])
def test_a_ball_comes_to_rest_at_the_closed_form(eps: float, solver: str) -> None:
    _, limit = drop(eps, 1.0)
    run = hb.simulate(balls((eps, 1.0)), 2 * limit, solver=solver)
    assert run.status == "ok" and not run.warnings
    (record,) = run.accumulations
    assert record.t == pytest.approx(limit, abs=1e-10)
    assert record.landed and (record.machine, record.state) == ("F1", "impact")
    assert record.ratio is None or record.ratio == pytest.approx(eps, rel=1e-5)
    last = run.events[-1]
    assert (last.cause, last.t, last.landed) == ("accumulation", pytest.approx(limit), ("F1",))
    later = [limit * k for k in (1.0001, 1.3, 1.999)]
    assert run["c1.e"].at(later) == pytest.approx([G] * 3, rel=1e-12)
    assert run["v1.f"].at(later) == pytest.approx([0.0] * 3, abs=1e-15)
    assert run["h1"].at(later) == pytest.approx([0.0] * 3, abs=1e-14)
    assert run.mode == {"F1": "impact"}
    assert run.audit().holds()


def test_the_number_of_events_grows_as_the_heights_shrink() -> None:
    run = hb.simulate(balls((0.9, 1.0)), 12.0)
    # heights shrink by eps**2; the last flight is 1e-16 of the first, give or take a factor
    expected = math.log(1e-16) / math.log(0.81)
    assert run.accumulations[0].events == pytest.approx(expected, rel=0.05)
    assert len(run.events) == run.accumulations[0].events + 2  # the start, and the landing


@pytest.mark.parametrize("solver", ["rk45", "radau", "rk4"])
def test_a_dead_ball_lies_on_the_floor_at_once(solver: str) -> None:
    step = 0.01 if solver == "rk4" else None
    run = hb.simulate(balls((0.0, 1.0)), 2.0, solver=solver, step=step)
    first, _ = drop(0.0, 1.0)
    assert run.status == "ok"
    assert [e.cause for e in run.events] == ["start", "guard", "accumulation"]
    (record,) = run.accumulations
    assert record.t == pytest.approx(first, abs=1e-12) and record.ratio is None
    assert run["c1.e"].at(1.9) == pytest.approx(G)
    assert run["h1"].at(1.9) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("eps", [0.0, 0.5, 1.0])
def test_a_ball_that_starts_on_the_floor_stays_there(eps: float) -> None:
    run = hb.simulate(balls((eps, 0.0)), 3.0, solver="rk45")
    assert run.status == "ok" and len(run.events) == 3
    assert run["c1.e"].at(1.0) == pytest.approx(G)
    assert run["h1"].at(3.0) == pytest.approx(0.0, abs=1e-30)


def test_an_elastic_ball_never_lands() -> None:
    run = hb.simulate(balls((1.0, 1.0)), 10.0)
    first, _ = drop(0.0, 1.0)
    assert run.status == "ok" and run.accumulations == ()
    assert len(run.events) == 1 + 1 + int((10.0 - first) / (2 * first))


def test_landing_is_told_as_such() -> None:
    run = hb.simulate(balls((0.5, 1.0)), 2.0)
    rows = [r for r in run.events.rows() if r[1] == "accumulation" or r[3] == "landed"]
    assert [(r[1], r[2], r[3]) for r in rows] == [
        ("accumulation", "F1  away -> impact", ""),
        ("", "(impact)", "landed"),
    ]
    resting = [s for s in run.segments if s.landed]
    assert [(s.mode, s.landed) for s in resting] == [((1,), ("F1",))]
    assert run.events[-1].steps[0].energy.lost >= 0.0
    assert run.events[-1].steps[0].impulses == {}


# -- leaving


def test_a_pulse_throws_the_ball_off_again() -> None:
    pulse = hb.Input(function=lambda t: 20.0 if 3 <= t < 3.5 else 0.0, breaks=[3, 3.5])
    run = hb.simulate(balls((0.5, 1.0), force="F", F=pulse), 10.0)
    assert run.status == "ok"
    speed, height = (20 - G) * 0.5, 0.5 * (20 - G) * 0.25
    assert run["h1"].at(3.5) == pytest.approx(height, rel=1e-9)
    assert run["v1.f"].at(3.5) == pytest.approx(speed, rel=1e-9)
    assert run["c1.e"].at([2.9, 3.2]) == pytest.approx([G, 0.0])
    down = math.sqrt(speed**2 + 2 * G * height)
    again = 3.5 + (speed + down) / G + 2 * down * 0.5 / (G * 0.5)
    assert [a.t for a in run.accumulations] == pytest.approx([drop(0.5, 1.0)[1], again], abs=1e-9)
    (left,) = [e for e in run.events if e.t == 3.0]
    assert left.cause == "input" and left.landed == ()
    assert left.steps[-1].fired[0].guard == "c1.e < 0"


def test_it_leaves_when_the_reaction_turns() -> None:
    run = hb.simulate(balls((0.2, 0.1), force="4*time"), 4.0)
    left = run.events[-1]
    assert left.t == pytest.approx(G / 4, abs=1e-9)  # where 4 t = m g
    assert (left.steps[-1].fired[0].source, left.steps[-1].fired[0].target) == ("impact", "away")
    assert run["h1"].at(4.0) == pytest.approx(4 / 6 * (4.0 - G / 4) ** 3, rel=1e-7)


def on_a_table(eps: float, amplitude: float, omega: float, gap: float) -> hb.Model:
    m = hb.Model("table", domain="translational")
    speed = f"{amplitude * omega}*cos({omega}*time)"
    m.add(w=hb.Se(-G), ball=hb.I(1.0), v=hb.One(), c=hb.Zero(), table=hb.Sf(speed))
    m.add(r=hb.Sf(f"-{eps}*(pre(v.f) - pre(table.f))"))
    m.bond("w -> v -> ball", "c -> v", "r -> c", "table -> c")
    m.signal(u=speed, gap=hb.Integral("v.f - table.f", start=gap))
    m.machine(
        "F",
        states={"away": [], "impact": ["c"]},
        start="away",
        rules=[
            "away -> impact when gap <= 0 and v.f < table.f",
            "impact -> away when pre(ball.f) >= pre(u)",
        ],
    )
    return m


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_what_a_table_gives_a_ball_that_lands_is_its_own(way: float) -> None:
    """The landing takes the speed of the table, whose force does the work; no energy is made."""
    m = hb.Model("table", domain="translational")
    m.add(w=hb.Se(-G), ball=hb.I(1.0), v=hb.One(), c=hb.Zero(), table=hb.Sf(f"{2 * way}*time"))
    m.add(r=hb.Sf("-0.3*(pre(v.f) - pre(table.f))"))
    m.bond("w -> v -> ball", "c -> v", "r -> c", "table -> c")
    m.signal(gap=hb.Integral("v.f - table.f", start=1.0), slip=f"v.f - {2 * way}*time")
    rules = ["away -> impact when gap <= 0 and slip < 0", "impact -> away when pre(slip) >= 0"]
    m.machine("F", states={"away": [], "impact": ["c"]}, start="away", rules=rules)
    run = hb.simulate(m, 2.0)
    first = math.sqrt(2.0 / (G + 2.0 * way))
    (record,) = run.accumulations
    assert record.t == pytest.approx(first * 1.3 / 0.7, rel=1e-9)
    energy = run.events[-1].steps[-1].energy
    assert energy is not None
    # what is left of the impact: half the square of the last rebound, far below the table's work
    assert abs(energy.source) > 1e-9
    assert energy.lost == pytest.approx(0.0, abs=1e-14)
    assert not run.warnings


def test_on_a_vibrating_table_it_lands_and_takes_off() -> None:
    omega, strength = 10.0, 1.2  # the table accelerates by 1.2 g at most
    a = strength * G / omega**2
    run = hb.simulate(on_a_table(0.1, a, omega, 0.05), 2.0)
    assert run.status == "ok"
    leaving = [e.t for e in run.events for s in e.steps for f in s.fired if f.guard == "c.e < 0"]
    # it leaves where the table falls away as fast as a free ball: a w^2 sin(w t) = g
    phase = math.asin(1 / strength)
    assert leaving == pytest.approx([(phase + 2 * math.pi * k) / omega for k in (1, 2, 3)])
    # the flight after it, by the same parabola over the same sine
    t0 = leaving[0]
    y0, v0 = a * math.sin(omega * t0), a * omega * math.cos(omega * t0)

    def gap(t: float) -> float:
        return y0 + v0 * (t - t0) - 0.5 * G * (t - t0) ** 2 - a * math.sin(omega * t)

    touch = next(e.t for e in run.events if e.t > t0)
    assert touch == pytest.approx(brentq(gap, t0 + 0.1, t0 + 0.3), abs=1e-7)
    later = next(r.t for r in run.accumulations if r.t > t0) + 0.05
    assert run["c.e"].at(later) == pytest.approx(G - a * omega**2 * math.sin(omega * later))
    assert run["gap"].at(later) == pytest.approx(0.0, abs=1e-8 * a)  # rtol of the way it moves


# -- several machines


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "which",
    [
        ((0.5, 1.0), (0.7, 1.0)),
        ((0.5, 1.0), (0.5, 1.0)),
        ((0.6, 1.0), (0.6, 1.0 + 1e-9)),
        ((0.0, 1.0), (0.0, 1.0)),
        ((0.5, 1.0), (1.0, 1.3)),
    ],
)
def test_balls_accumulate_each_by_its_own_ratio(which: tuple[tuple[float, float], ...]) -> None:
    run = hb.simulate(balls(*which), 4.0)
    assert run.status == "ok"
    found = {r.machine: r for r in run.accumulations}
    for k, (eps, h) in enumerate(which, 1):
        if eps == 1.0:
            assert f"F{k}" not in found
            continue
        assert found[f"F{k}"].t == pytest.approx(drop(eps, h)[1], abs=1e-9)
        assert run[f"c{k}.e"].at(3.9) == pytest.approx(k * G)
    assert len(run.accumulations) == sum(eps < 1.0 for eps, _ in which)


def test_a_ball_on_a_ball() -> None:
    m = hb.Model("stack", domain="translational")
    m.add(w1=hb.Se(-G), w2=hb.Se(-3 * G), b1=hb.I(1), b2=hb.I(3), v1=hb.One(), v2=hb.One())
    m.add(c1=hb.Zero(), c2=hb.Zero(), r1=hb.Sf("-0.5*pre(v1.f)"))
    m.add(r2=hb.Sf("-0.5*pre(v2.f - v1.f)"))
    m.bond("w1 -> v1 -> b1", "w2 -> v2 -> b2", "c1 -> v1 -> c2 -> v2", "r1 -> c1", "r2 -> c2")
    m.signal(h1=hb.Integral("v1.f", start=1), h2=hb.Integral("v2.f - v1.f", start=0.5))
    for k, closing in ((1, "v1.f < 0"), (2, "v2.f < v1.f")):
        apart = "pre(b1.p) >= 0" if k == 1 else "pre(b2.f) >= pre(b1.f)"
        m.machine(
            f"F{k}",
            states={"away": [], "impact": [f"c{k}"]},
            start="away",
            rules=[f"away -> impact when h{k} <= 0 and {closing}", f"impact -> away when {apart}"],
        )
    run = hb.simulate(m, 8.0)
    assert run.status == "ok"
    assert {r.machine for r in run.accumulations} == {"F1", "F2"}
    assert run["c1.e"].at(7.9) == pytest.approx(4 * G)
    assert run["c2.e"].at(7.9) == pytest.approx(3 * G)
    assert run.audit().holds()


def test_two_contacts_of_one_body_share_no_more_than_is_known() -> None:
    m = hb.Model("table", domain="translational")
    m.add(w=hb.Se(-G), b=hb.I(1.0), v=hb.One(), c1=hb.Zero(), c2=hb.Zero())
    m.add(r1=hb.Sf("-0.5*pre(v.f)"), r2=hb.Sf("-0.5*pre(v.f)"))
    m.bond("w -> v -> b", "r1 -> c1 -> v", "r2 -> c2 -> v")
    m.signal(h=hb.Integral("v.f", start=1.0))
    for k in (1, 2):
        rules = ["away -> impact when h <= 0 and v.f < 0", "impact -> away when pre(b.p) >= 0"]
        m.machine(f"F{k}", states={"away": [], "impact": [f"c{k}"]}, start="away", rules=rules)
    run = hb.simulate(m, 3.0)
    assert run.status == "ok"
    assert run.accumulations[0].t == pytest.approx(drop(0.5, 1.0)[1], abs=1e-9)
    assert run["c1.e"].at(2.9) + run["c2.e"].at(2.9) == pytest.approx(G)
    assert run["h"].at(2.9) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.slow
def test_a_relay_that_slides_meanwhile_goes_on_sliding() -> None:
    m = balls((0.5, 1.0))
    drive = '-(if R.state == "above" then 1 else -1) + 0.5*sin(3*time)'
    m.add(x=hb.C(1.0, q=-0.2), s=hb.Sf(drive), n=hb.Zero())
    m.bond("s -> n -> x")
    rules = ["above -> below when x.q < 0", "below -> above when x.q > 0"]
    m.machine("R", states={"above": [], "below": []}, start="below", rules=rules)
    run = hb.simulate(m, 3.0)
    assert run.status == "ok"
    (record,) = run.accumulations
    assert (record.machine, record.t) == ("F1", pytest.approx(drop(0.5, 1.0)[1], abs=1e-9))
    assert run["x.q"].at(2.9) == pytest.approx(0.0, abs=1e-12)
    assert run["c1.e"].at(2.9) == pytest.approx(G)


def test_a_chattering_relay_is_no_impact() -> None:
    m = hb.Model()
    m.add(x=hb.C(1.0, q=-0.2), s=hb.Sf('-(if R.state == "above" then 1 else -1)'), n=hb.Zero())
    m.bond("s -> n -> x")
    rules = ["above -> below when x.q < 0", "below -> above when x.q > 0"]
    m.machine("R", states={"above": [], "below": []}, start="below", rules=rules)
    run = hb.simulate(m, 1.0, sliding="refuse")
    assert run.status == "accumulation"
    (record,) = run.accumulations
    assert (record.machine, record.landed) == ("R", False)
    assert record.t == pytest.approx(0.2, abs=1e-9)
    assert any("R accumulate" in w for w in run.warnings)


# -- no landing


def test_a_law_that_does_not_vanish_at_rest_is_not_landed() -> None:
    """A speed that may change stands in the law by hand: with pre() at zero it is 1.5 times it."""
    m = hb.Model("lift", domain="translational")
    m.signal(u=hb.Integral("0*u", start=0.2))
    m.add(w=hb.Se(-G), b=hb.I(1.0), v=hb.One(), c=hb.Zero(), r=hb.Sf("1.5*u - 0.5*pre(v.f)"))
    m.bond("w -> v -> b", "c -> v", "r -> c")
    m.signal(gap=hb.Integral("v.f - u", start=0.5))
    rules = ["away -> impact when gap <= 0 and v.f < u", "impact -> away when pre(b.f) >= pre(u)"]
    m.machine("F", states={"away": [], "impact": ["c"]}, start="away", rules=rules)
    run = hb.simulate(m, 5.0)
    assert run.status == "accumulation"
    (record,) = run.accumulations
    speed = math.sqrt(2 * G * 0.5 + 0.2**2)  # it starts at rest, 0.2 slower than the table
    first = (speed - 0.2) / G
    limit = first + 2 * speed * 0.5 / (G * 0.5)
    assert not record.landed and record.t == pytest.approx(limit, abs=1e-9)
    assert any("F cannot rest: its rebounds do not vanish" in w for w in run.warnings)


def jerks(way: float, rebound: float, *pulls: float, slack: float = 0.458) -> hb.Model:
    """Return a body of 1 kg on its stop, a rope from it to a block that is pulled, and so on."""
    m = hb.Model("jerks", domain="translational")
    bounce = {"restitution": rebound} if rebound else {}
    m.add(A=hb.I(1.0), W=hb.Se(-way * 10.363), v0=hb.One())
    m.add(stop=hb.Zero(law="unilateral", gap="h", **bounce))
    up = way > 0.0
    m.bond("W -> v0 -> A", "stop -> v0" if up else "v0 -> stop")
    m.signal(h=hb.Integral(f"{way}*v0.f"))
    for k, pull in enumerate(pulls, 1):
        parts = {f"B{k}": hb.I(0.5), f"P{k}": hb.Se(way * pull), f"v{k}": hb.One()}
        m.add(**parts, **{f"rope{k}": hb.Zero(law="unilateral", gap=f"g{k}")})
        low, high = (f"v{k}", f"v{k - 1}") if up else (f"v{k - 1}", f"v{k}")
        m.bond(f"P{k} -> v{k} -> B{k}", f"{low} -> rope{k} -> {high}")
        m.signal(**{f"g{k}": hb.Integral(f"{way}*(v{k - 1}.f - v{k}.f)", slack)})
    return m


@pytest.mark.parametrize("rebound", [0.0, 0.3])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_contacts_that_strike_in_turn_rest_at_their_limit(way: float, rebound: float) -> None:
    """A rope jerks a body off its stop, to which it falls back: each time a third of the speed."""
    slack, pull, weight = 0.458, 5.0, 10.363
    run = hb.simulate(jerks(way, rebound, pull), until=3.0)
    assert run.status == "ok" and not run.warnings and run.audit().holds()
    if rebound == 0.0:
        speed = math.sqrt(2 * slack * pull / 0.5)
        limit = speed / (pull / 0.5) + speed * (1.5 / (weight - pull) + 0.5 / pull)
        (record,) = run.accumulations
        assert record.landed and record.t == pytest.approx(limit, rel=1e-9)
        assert run.events[-1].cause == "accumulation"
    for name, value in {"v0.f": 0.0, "v1.f": 0.0, "h": 0.0, "g1": 0.0}.items():
        assert run[name].at(2.9) == pytest.approx(value, abs=1e-12)
    assert run["rope1.e"].at(2.9) == pytest.approx(pull)
    assert run["stop.e"].at(2.9) == pytest.approx(weight - pull)


@pytest.mark.parametrize("rebound", [0.0, 0.4])
def test_a_chain_of_ropes_that_jerks_rests_at_its_limit(rebound: float) -> None:
    run = hb.simulate(jerks(1.0, rebound, 2.0, 3.0), until=8.0)
    assert run.status == "ok" and run.mode == {
        "stop": "closed",
        "rope1": "closed",
        "rope2": "closed",
    }
    forces = [float(run[f"{name}.e"].at(7.9)) for name in ("stop", "rope1", "rope2")]
    assert forces == pytest.approx([10.363 - 5.0, 5.0, 3.0])


def test_contacts_that_rest_at_a_limit_leave_it_when_what_pulls_grows() -> None:
    """The pull grows past the weight: the body that came to rest is lifted when it does."""
    m = jerks(1.0, 0.0, 5.0)
    m.add(more=hb.Se("1 [N/s]*max(0, time - 2)"))
    m.bond("more -> v0")
    run = hb.simulate(m, until=9.0)
    lifted = 2.0 + 10.363 - 5.0
    assert run.status == "ok" and run.events[-1].t == pytest.approx(lifted, rel=1e-9)
    assert run["v1.f"].at(9.0) == pytest.approx((9.0 - lifted) ** 2 / 2 / 1.5, rel=1e-7)
