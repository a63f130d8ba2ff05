"""Contacts that are closed while their gap jumps: table edges, trapdoors, stairs.

Right values are those of free fall: 10 m/s^2, from where the floor ends to where it goes on.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

FALL = 10.0


def block(gap, *, turned=False, restitution=None, rotational=False):
    """A block of 2 kg at 3 m/s along a floor; the gap reads where it is."""
    domain = "rotational" if rotational else "translational"
    m = hb.Model("edge", domain=domain)
    more = {} if restitution is None else {"restitution": restitution}
    way = -1.0 if turned else 1.0
    m.add(mx=hb.I(2.0, f=3.0 * way), my=hb.I(2.0), vx=hb.One(), vy=hb.One())
    m.add(w=hb.Se(-2.0 * FALL * way))
    m.add(floor=hb.Zero(law="unilateral", gap=gap, **more))
    if turned:
        m.bond("floor -> vy", "mx -> vx", "my -> vy", "vy -> w")
    else:
        m.bond("w -> vy -> my", "floor -> vy", "vx -> mx")
    m.signal(x=hb.Integral("vx.f"), y=hb.Integral("vy.f"))
    return m


def lands(drop, at):
    """When a body lands that loses its floor at a time."""
    return at + math.sqrt(2.0 * drop / FALL)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau", "qss2"])
@pytest.mark.parametrize(
    "gap",
    [
        "if x < 1.5 then y else y + 0.8",
        "y + 0.4*(1 + sign(x - 1.5))",
        "if time < 0.5 then y else y + 0.8",
    ],
)
def test_a_block_falls_off_the_edge_of_a_table(gap, solver):
    """It slid on at the height of the table, status ok, audit holding."""
    run = hb.simulate(block(gap), 1.2, solver=solver)
    near = 1e-4 if solver == "qss2" else 1e-8
    assert [e.t for e in run.events] == pytest.approx([0.0, 0.5, lands(0.8, 0.5)], abs=near)
    assert run["y"].at(0.7) == pytest.approx(-0.5 * FALL * 0.2**2, abs=near)
    assert run["y"].at(1.2) == pytest.approx(-0.8, abs=near)


@pytest.mark.parametrize(
    ("given", "drop"),
    [({"rotational": True}, 0.8), ({"turned": True}, 0.8), ({"restitution": 0.0}, 0.8), ({}, 1e-7)],
)
def test_it_does_so_however_it_is_written(given, drop):
    run = hb.simulate(block(f"if x < 1.5 then y else y + {drop}", **given), 1.2)
    assert [e.t for e in run.events] == pytest.approx([0.0, 0.5, lands(drop, 0.5)], abs=1e-8)
    assert run["y"].at(1.2) == pytest.approx(-drop, rel=1e-6)


def test_what_is_not_connected_beside_it_changes_nothing():
    m = block("if x < 1.5 then y else y + 0.8")
    m.add(far=hb.C(1e6, q=1e9), none=hb.Zero(), g=hb.R(1e3))
    m.bond("far -> none", "none -> g")
    run = hb.simulate(m, 1.2)
    assert [e.t for e in run.events] == pytest.approx([0.0, 0.5, lands(0.8, 0.5)], abs=1e-8)


@pytest.mark.parametrize("solver", ["euler", "rk4"])
@pytest.mark.parametrize("step", ["1 ms", "7 ms"])
@pytest.mark.parametrize("gap", ["if x < 1.5 then y else y + 0.8", "y + 0.4*(1 + sign(x - 1.5))"])
def test_fixed_steps_see_the_edge_wherever_it_is_in_a_step(gap, step, solver):
    """They slid on in the air; an edge at the end of a step, but for rounding, is in no step."""
    run = hb.simulate(block(gap), 1.2, solver=solver, step=step)
    near = 1e-2 if solver == "euler" else 1e-8
    assert run.events.t[1] == pytest.approx(0.5, abs=1e-8)
    assert [e.t for e in run.events] == pytest.approx([0.0, 0.5, lands(0.8, 0.5)], abs=near)
    assert run["y"].at(0.7) == pytest.approx(-0.5 * FALL * 0.2**2, abs=near)
    assert run["y"].at(1.2) == pytest.approx(-0.8, abs=1e-8)


def test_stairs_are_gone_down_one_by_one():
    run = hb.simulate(block("y + 0.05*floor(x/0.6)"), 1.05)
    falls = [t for k in range(1, 6) for t in (0.2 * k, lands(0.05, 0.2 * k))]
    expected = [0.0, *(t for t in falls if t < 1.05)]
    assert [e.t for e in run.events] == pytest.approx(expected, abs=1e-8)


def test_a_trapdoor_is_opened_by_a_machine():
    m = block('if door.state == "shut" then y else y + 0.8')
    m.add(lamp=hb.One(domain="electrical"), u=hb.Se(1.0, domain="electrical"))
    m.add(r=hb.R(1.0, domain="electrical"))
    m.bond("u -> lamp -> r")
    m.machine(
        "door",
        states={"shut": ["lamp"], "ajar": []},
        start="shut",
        rules=["shut -> ajar when x > 1.5"],
    )
    run = hb.simulate(m, 1.2)
    assert run["y"].at(0.7) == pytest.approx(-0.5 * FALL * 0.2**2, abs=1e-8)
    assert run["y"].at(1.2) == pytest.approx(-0.8, abs=1e-8)


@pytest.mark.parametrize("gap", ["if x < 1.5 then y else y + 0*x", "y + 0*abs(x - 1.5)"])
def test_a_floor_that_goes_on_carries(gap):
    run = hb.simulate(block(gap), 1.2)
    assert len(run.events) == 1
    assert run["y"].at(1.2) == pytest.approx(0.0, abs=1e-12)
    assert run["floor.e"].at(1.0) == pytest.approx(2.0 * FALL, rel=1e-9)


@pytest.mark.parametrize("what", ["input", "parameter"])
def test_a_step_of_a_script_takes_the_floor_away(what):
    """Such a step begins before any mode is entered; it ended in a segmentation fault."""
    m = block("y + u")
    if what == "input":
        m.input(u=0.0)
    else:
        m.parameter(u=0.0)
    rests, falls = hb.Step(until="0.5 s"), hb.Step(until="1.2 s", set={"u": 0.8})
    run = hb.run_script(m, [rests, falls])
    assert run.status == "ok"
    assert run["y"].at(0.7) == pytest.approx(-0.5 * FALL * 0.2**2, abs=1e-8)
    assert run["y"].at(1.2) == pytest.approx(-0.8, abs=1e-8)


@pytest.mark.parametrize("keeps", [0.0, 1.5])
def test_a_step_that_changes_something_else_leaves_the_block_where_it_is(keeps):
    m = block("y + u")
    m.input(u=0.0)
    m.parameter(k=0.0)
    m.add(push=hb.Se("k"))
    m.bond("push -> vx")
    run = hb.run_script(m, [hb.Step(until="0.5 s"), hb.Step(until="1.2 s", set={"k": keeps})])
    assert run["y"].at(1.2) == pytest.approx(0.0, abs=1e-12)
    assert run["floor.e"].at(1.0) == pytest.approx(2.0 * FALL, rel=1e-9)


def vibrating(size, rate, phase):
    """A block of 2 kg on a table that moves up and down; gap reads where time has the table be."""
    m = hb.Model("table", domain="translational")
    where = f"{size} [m]*(sin({rate}*time/(1 s) + {phase}) - sin({phase}))"
    speed = f"{size * rate} [m/s]*cos({rate}*time/(1 s) + {phase})"
    m.add(my=hb.I(2.0, f=size * rate * math.cos(phase)), vy=hb.One(), w=hb.Se(-2.0 * FALL))
    m.add(table=hb.Sf(speed))
    m.add(floor=hb.Zero(law="unilateral", gap=f"y - {where}", restitution=0.5))
    m.bond("w -> vy -> my", "table -> floor -> vy")
    m.signal(y=hb.Integral("vy.f"))
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("table", [(0.01, 20, 1), (1e-6, 1000, 0.3)])
def test_what_is_sampled_beside_a_table_that_vibrates_lets_nothing_go(table, solver):
    """It opened and closed a few times: what time moves a gap by in a moment was a jump."""
    m = vibrating(*table)
    m.signal(u=hb.Sampled("y", every="0.01"))
    assert len(hb.simulate(m, 1.0, solver=solver).events) == 1


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("table", [(0.01, 20, 1), (0.01, 10, 0), (1e-6, 1000, 0.3)])
def test_a_kink_beside_a_table_that_vibrates_lets_nothing_go(table, solver):
    """It bounced fourteen times: what drifts between two points of a step was a jump."""
    m = vibrating(*table)
    m.add(M=hb.I(1.0), V=hb.One(), S=hb.Se("10 [N/m]*abs(x - 0.1 [m]) - x*1 [N/m] - x^3*1 [N/m^3]"))
    m.bond("S -> V -> M")
    m.signal(x=hb.Integral("V.f"))
    assert len(hb.simulate(m, 1.0, solver=solver).events) == 1


def test_a_run_goes_on_from_where_something_is_sampled():
    """It ended with the process: gaps were noted in a mode that was not there yet."""
    m = block("y + h")
    m.signal(h=hb.Sampled("if x < 1.4 then 0 else 0.8", every="0.1"))
    state = hb.simulate(m, 0.5).state(0.3)
    run = hb.simulate(m, 1.2, start=state)
    assert [e.t for e in run.events] == pytest.approx([0.5, lands(0.8, 0.5)], abs=1e-8)
    assert run["y"].at(1.2) == pytest.approx(-0.8, abs=1e-8)


@pytest.mark.parametrize("solver", ["auto", "rk45"])
@pytest.mark.parametrize("edge", [0.9, 1.2, 1.5, 1.53, 1.8])
def test_a_run_may_end_at_the_edge_and_go_on(edge, solver):
    """It slid on there where the end of the first run had passed the edge by rounding."""
    m = block(f"if x < {edge} then y else y + 0.5")
    at = edge / 3.0
    run = hb.simulate(m, 1.2, solver=solver, start=hb.simulate(m, at, solver=solver))
    assert run.events[-1].t == pytest.approx(lands(0.5, at), abs=1e-8)
    assert run["y"].at(1.2) == pytest.approx(-0.5, abs=1e-8)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("rule", ["x >= 1.5", "x > 1.5*(1 + 1e-15)", "time >= 0.5"])
def test_a_machine_may_go_on_at_the_edge(rule, solver):
    """It slid on where the guard of another machine held in the instant of the edge."""
    m = block("if x < 1.5 then y else y + 0.5")
    m.add(u=hb.Se(1.0), lamp=hb.One(), r=hb.R(1.0))
    m.bond("u -> lamp -> r")
    states = {"before": [], "behind": ["lamp"]}
    m.machine("place", states=states, start="before", rules=[f"before -> behind when {rule}"])
    run = hb.simulate(m, 1.2, solver=solver)
    assert run.events[-1].t == pytest.approx(lands(0.5, 0.5), abs=1e-8)
    assert run["y"].at(1.2) == pytest.approx(-0.5, abs=1e-8)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "rk4", "moreau-jean"])
@pytest.mark.parametrize("restitution", [None, 0.0])
@pytest.mark.parametrize("turned", [False, True])
def test_what_a_start_says_is_closed_falls_where_the_floor_is_elsewhere(
    turned, restitution, solver
):
    """The floor carried the block 0.8 m above it: a closed contact was not asked for its gap."""
    m = block("y + h", turned=turned, restitution=restitution)
    m.parameter(h=0.0)
    fixed = {} if solver == "auto" else {"solver": solver, "step": "1 ms"}
    state = hb.simulate(m, 0.5, **fixed).state(0.5)
    run = hb.simulate(m, 1.2, start=state, parameters={"h": 0.8}, **fixed)
    near = 1e-8 if solver != "moreau-jean" else 3e-3
    assert run.events.t[-1] == pytest.approx(lands(0.8, 0.5), abs=near)
    assert run["y"].at(1.2) == pytest.approx(-0.8, abs=near)


def test_a_start_that_is_closed_but_for_the_error_of_a_run_stays_so():
    start = {"y": 1.0 + 1e-8, "floor": "closed"}
    run = hb.simulate(block("y - 1", restitution=0.0), 0.2, start=start)
    assert run["floor.e"].at(0.0) == pytest.approx(2.0 * FALL)
    assert run["y"].at(0.2) == 1.0 + 1e-8


@pytest.mark.parametrize("solver", ["auto", "euler", "moreau-jean"])
@pytest.mark.parametrize(
    "gap", ["if x < 1.5 then y else y - 0.3", "if time < 0.5 then y else y - 0.3", "y - u"]
)
def test_a_floor_that_jumps_up_into_a_block_is_told_of(gap, solver):
    """It was held 0.3 m below the floor without a word."""
    m = block(gap)
    m.input(u=hb.Input(table=[(0.0, 0.0), (0.5, 0.3)]))
    fixed = {} if solver == "auto" else {"solver": solver, "step": "1 ms"}
    told = hb.simulate(m, 1.2, **fixed).warnings
    assert len(told) == 1
    assert told[0].startswith("the gap of 'floor' jumps to -0.3 at t = 0.5")


@pytest.mark.parametrize(
    ("solver", "step"),
    [
        ("auto", None),
        ("radau", None),
        ("rk4", "70 ms"),
        ("euler", "7 ms"),
        ("moreau-jean", "20 ms"),
    ],
)
def test_a_floor_that_jumps_up_into_what_falls_is_told_of_in_steps_of_any_length(solver, step):
    """By long steps it was not: a block falls farther in one than the floor jumps."""
    m = block("y + 1.35 - u")
    m.input(u=hb.Input(table=[(0.0, 0.0), (0.5, 0.3)]))
    told = hb.simulate(m, 0.6, solver=solver, **({"step": step} if step else {})).warnings
    assert len(told) == 1
    assert told[0].startswith("the gap of 'floor' jumps to -0.")
    assert "at t = 0.5 s" in told[0]


@pytest.mark.parametrize("solver", ["auto", "moreau-jean"])
def test_what_bounces_down_a_stair_is_not_told_of(solver):
    fixed = {} if solver == "auto" else {"solver": solver, "step": "1 ms"}
    run = hb.simulate(block("y + 0.05*floor(x/0.6)", restitution=0.5), 1.05, **fixed)
    assert not any("overlaps" in w for w in run.warnings)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau", "rk4"])
@pytest.mark.parametrize(
    "floor",
    [
        "0.4*(1 + tanh((x - 1.5)/1e-4))",
        "-0.4*(1 + tanh((x - 1.5)/1e-4))",
        "0.8/(1 + exp((1.5 - x)*1e3))",
    ],
)
def test_a_floor_that_slopes_within_a_step_is_refused_and_not_flown_over(floor, solver, turned):
    """At the end of the step it is level again: the block slid on in the air, status ok."""
    step = {"step": "7 ms"} if solver == "rk4" else {}
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(block(f"y + {floor}", turned=turned), 1.2, solver=solver, **step)
    assert caught.value.code == "HB-M205"
    assert caught.value.partial.t_end < 0.51


def test_a_floor_whose_slope_the_bonds_know_is_followed_within_a_step():
    # a relative: a cam as steep lifts what rests on it, and throws it off where it levels
    m = hb.Model("cam")
    m.add(W=hb.Se(-FALL), v=hb.One(), b=hb.I(1.0), vx=hb.One(), bx=hb.I(1e9, f=1.0))
    m.add(cam=hb.TF("5/cosh((x - 0.5)/1e-4)^2"))
    m.add(c=hb.Zero(law="unilateral", gap="h - 5e-4*(1 + tanh((x - 0.5)/1e-4))", restitution=0))
    m.bond("W -> v -> b", "c -> v", "vx -> bx", "vx -> cam -> c")
    m.signal(h=hb.Integral("v.f"), x=hb.Integral("vx.f"))
    run = hb.simulate(m, 0.9)
    assert run["h"].at(0.9) == pytest.approx(5e-4 + 5.0 * 0.4 - 0.5 * FALL * 0.4**2, rel=1e-6)
