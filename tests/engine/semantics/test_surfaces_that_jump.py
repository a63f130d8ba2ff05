"""A relay follows a level that jumps: the current stays, and is driven to where the level is.

A leg of ±24 V drives a coil of 1 mH and 2 ohm to a level, slides along it, and leaves it where the
level jumps. Between jumps and until it is there again, ``L i' = u - R i`` has a closed form.
"""

import math
from itertools import pairwise

import pytest

import hybond as hb

VOLTS, OHM, HENRY = 24.0, 2.0, 1e-3
UNTIL = 5e-3
TURNS = [k * math.pi / 2500 for k in range(1, 4)]


def led_to(levels: list[float], jumps: list[float], t: float) -> float:
    """Return the current, from 0, where the level is ``levels[k]`` up to ``jumps[k]``."""
    i = 0.0
    for level, (begin, end) in zip(levels, pairwise([0.0, *jumps, UNTIL]), strict=True):
        final = math.copysign(VOLTS / OHM, level - i)
        now = final + (i - final) * math.exp(-(min(t, end) - begin) * OHM / HENRY)
        i = level if (now - level) * (i - level) <= 0.0 else now
        if t <= end:
            break
    return i


def leg(level: str, *, read: str = "L.f", turned: bool = False) -> hb.Model:
    """Build the leg; turned, its current counts the other way."""
    m = hb.Model("leg")
    volts = 'if sw.state == "low" then -24 else 24'
    m.add(u=hb.Se(volts), i=hb.One(), L=hb.I(HENRY), R=hb.R(OHM))
    m.bond(*(["i -> u", "L -> i", "i -> R"] if turned else ["u -> i -> L", "i -> R"]))
    up, down = (">", "<") if turned else ("<", ">")
    rules = [f"low -> high when {read} {up} {level}", f"high -> low when {read} {down} {level}"]
    m.machine("sw", states={"low": [], "high": []}, start="high", rules=rules)
    return m


def left(run: hb.Result) -> list[tuple[float, str]]:
    """Return when surfaces were left, and why."""
    fired = [(e.t, f) for e in run.events for s in e.steps for f in s.fired]
    return [(t, f.guard) for t, f in fired if f.source == "sliding"]


def holds(m: hb.Model, levels: list[float], jumps: list[float], **options: object) -> hb.Result:
    """Run the leg, hold its current against the closed form, and return the run."""
    run = hb.simulate(m, until=UNTIL, **options)
    for k in range(1, 250):
        t = k * UNTIL / 250 + 1.3e-8
        assert run["L.f"].at(t) == pytest.approx(led_to(levels, jumps, t), abs=1e-6)
    for t, level in zip([*jumps, UNTIL], levels, strict=True):
        assert run["L.f"].at(t, side="left") == pytest.approx(level, abs=1e-9)
    assert [t for t, _ in left(run)] == pytest.approx(jumps, abs=1e-12)
    return run


SAID: dict[str, tuple[str, list[float], list[float]]] = {
    "sign of a sine": ("3*sign(sin(2500*time))", [3, -3, 3, -3], TURNS),
    "comparison of a sine": ("(if sin(2500*time) > 0 then 3 else -2)", [3, -2, 3, -2], TURNS),
    "sign of a time": ("3*sign(0.0011 - time)", [3, -3], [1.1e-3]),
    "comparison of the time": ("(if time < 0.0011 then 3 else 5)", [3, 5], [1.1e-3]),
    "whole number": ("(3 - 2*floor(700*time))", [3, 1, -1, -3], [k / 700 for k in (1, 2, 3)]),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("said", SAID)
@pytest.mark.parametrize("turned", [False, True])
def test_a_level_that_a_function_of_time_makes_jump_is_left(said: str, turned: bool) -> None:
    level, levels, jumps = SAID[said]
    run = holds(leg(level, turned=turned), levels, jumps)
    assert [why for _, why in left(run)] == [f"L.f = {level}: it has jumped away"] * len(jumps)


@pytest.mark.parametrize("solver", ["rk45", "radau", "rk4"])
def test_by_each_way_to_step(solver: str) -> None:
    step = {"step": "20 us"} if solver == "rk4" else {}
    holds(leg("3*sign(sin(2500*time))"), [3, -3, 3, -3], TURNS, solver=solver, **step)


def test_a_voltage_that_no_storage_gives_is_told_from_one_side_of_the_jump() -> None:
    # its rate is found by differences, which must not reach over the jump
    holds(leg("6*sign(sin(2500*time))", read="R.e"), [3, -3, 3, -3], TURNS)


def test_an_input_that_jumps_is_left() -> None:
    m = leg("level")
    m.input(level=hb.Input(pwm={"period": "2.2 ms", "duty": 0.5, "high": 3, "low": -2}))
    holds(m, [3, -2, 3, -2, 3], [1.1e-3, 2.2e-3, 3.3e-3, 4.4e-3])


def test_a_sampled_level_is_left_at_each_sample_that_moves_it() -> None:
    m = leg("r")
    m.signal(r=hb.Sampled("3*cos(1000*time)", every="1 ms"))
    levels = [3 * math.cos(k) for k in range(5)]
    holds(m, levels, [k * 1e-3 for k in range(1, 5)])


@pytest.mark.parametrize("level", ["3*sign(1.2 - ramp)", '(if o.state == "a" then 3 else -3)'])
def test_a_level_that_another_state_or_machine_makes_jump_is_left(level: str) -> None:
    m = leg(level)
    m.signal(ramp=hb.Integral("1000 [1/s]"))
    m.machine("o", states={"a": [], "b": []}, start="a", rules=["a -> b when ramp > 1.2"])
    holds(m, [3, -3], [1.2e-3])


def test_a_level_that_an_impact_makes_jump_is_left() -> None:
    m = leg("3*v.f")
    m.add(body=hb.I(2.0, f=1.0), v=hb.One())
    m.add(wall=hb.Zero(law="unilateral", gap="0.0012 - x", restitution=0.5))
    m.bond("v -> body", "v -> wall")
    m.signal(x=hb.Integral("v.f"))
    holds(m, [3, -1.5], [1.2e-3])


def test_of_two_surfaces_the_one_that_stays_is_slid_on() -> None:
    m = leg("3*sign(0.0011 - time)")
    m.add(u2=hb.Se('if sw2.state == "low" then -24 else 24'), i2=hb.One(), L2=hb.I(HENRY))
    m.bond("u2 -> i2 -> L2")
    rules = ["low -> high when L2.f < 1", "high -> low when L2.f > 1"]
    m.machine("sw2", states={"low": [], "high": []}, start="high", rules=rules)
    run = holds(m, [3, -3], [1.1e-3])
    assert [s.machines for s in run.sliding if s.t0 < 1.2e-3 < s.t1] == [("sw2",)]
    assert run["L2.f"].at(1.2e-3) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("level", ["3*sign(0.1 - ramp)", '(if o.state == "a" then 3 else -3)'])
def test_a_level_that_jumps_over_the_current_is_not_slid_on_yet(level: str) -> None:
    # on the way to 3 A: the machine switches, and both sides push to where the level is now
    m = leg(level)
    m.signal(ramp=hb.Integral("1000 [1/s]"))
    m.machine("o", states={"a": [], "b": []}, start="a", rules=["a -> b when ramp > 0.1"])
    run = hb.simulate(m, until=UNTIL)
    for k in range(1, 100):
        t = k * 1e-5 + 1.3e-8
        assert run["L.f"].at(t) == pytest.approx(led_to([3, -3], [1e-4], t), abs=1e-6)
    assert left(run) == []


def test_a_level_that_jumps_to_and_fro_before_it_is_reached_is_chased() -> None:
    turns = [k * math.pi / 40000 for k in range(1, 13)]
    run = hb.simulate(leg("3*sign(sin(40000*time))"), until=1e-3)
    for k in range(1, 200):
        t = k * 5e-6 + 1.3e-8
        led = led_to([3, -3] * 6 + [3], turns, t)
        assert run["L.f"].at(t) == pytest.approx(led, abs=1e-6)


def test_fixed_steps_round_a_corner_are_put_back_however_long_they_are() -> None:
    # a relative: where a surface bends, steps of fixed length drift off by far more than an error
    m = hb.Model("circle")
    side = '(if k.state == "out" then 2 else -2)'
    m.add(x=hb.C(1.0, q=1.0), y=hb.C(1.0), nx=hb.Zero(), ny=hb.Zero())
    m.add(u=hb.Sf(f"-30*y.e - {side}*x.e"), v=hb.Sf(f"30*x.e - {side}*y.e"))
    m.bond("u -> nx -> x", "v -> ny -> y")
    square = "x.e^2 + y.e^2"
    rules = [f"in -> out when {square} > 1.5", f"out -> in when {square} < 1.5"]
    m.machine("k", states={"in": [], "out": []}, start="in", rules=rules)
    for solver in ("rk4", "euler"):
        run = hb.simulate(m, until=1.0, solver=solver, step="20 ms")
        assert left(run) == []
        assert run["x.e"].at(0.98) ** 2 + run["y.e"].at(0.98) ** 2 == pytest.approx(1.5)


def test_small_steps_of_a_level_are_no_way_to_be_carried_along() -> None:
    # 10 steps of 1 mA: each takes L*1e-3/24 seconds, in which the leg gives what is stored
    run = hb.simulate(leg("floor(1e6*time)/1000"), until=1.05e-5)
    assert len(left(run)) == 10
    assert run["u.e"].at(3.01e-6) == pytest.approx(24.0)
    assert run["L.f"].at(1.05e-5) == pytest.approx(0.01, abs=1e-12)


def test_a_level_that_bends_at_a_comparison_goes_on_being_slid_on() -> None:
    # a relative: the comparison changes, and the level does not jump there
    run = hb.simulate(leg("(if time < 0.002 then 3 else 3 + 1000*(time - 0.002))"), until=UNTIL)
    assert left(run) == []
    assert run["L.f"].at(4e-3) == pytest.approx(5.0, abs=1e-9)
    assert run["u.e"].at(4e-3) == pytest.approx(5.0 * OHM + 1000 * HENRY, abs=1e-6)
