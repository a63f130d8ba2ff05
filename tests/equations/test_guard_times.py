"""Where and when guards fire, against closed-form times."""

from __future__ import annotations

import math

import pytest

import hybond as hb


def base(**signals) -> hb.Model:
    m = hb.Model("guards")
    m.add(c=hb.C(1.0, q=1.0), r=hb.R(1.0), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    m.signal(**signals)
    return m


def watch(m: hb.Model, *guards: str, name: str = "m") -> None:
    states = [f"{name}{k}" for k in range(len(guards) + 1)]
    m.machine(
        name,
        states={s: [] for s in states},
        start=states[0],
        rules=[f"{states[k]} -> {states[k + 1]} when {g}" for k, g in enumerate(guards)],
    )


def times(run: hb.Result) -> list[float]:
    return [e.t for e in run.trace.events if e.t > 0]


RAMP = hb.Integral("1", start=0.0)


def parabola(lowest: float = 0.0) -> hb.Integral:
    return hb.Integral("2*(ramp - 1)", start=1.0 + lowest)


@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("rtol", [1e-8, 1e-3])
def test_two_crossings_in_one_step(depth, rtol) -> None:
    m = base(ramp=RAMP, s=parabola())
    watch(m, f"s < {depth}")
    run = hb.simulate(m, until=3.0, rtol=rtol)
    slack = 1e-12 / math.sqrt(depth)  # the crossing flattens with its depth
    assert times(run) == [pytest.approx(1.0 - math.sqrt(depth), rel=1e-9, abs=slack)]


@pytest.mark.sampled(19)
@pytest.mark.parametrize("where", [0.5, 0.7, 1.0, 1.37, 1.9])
@pytest.mark.parametrize("guard", ["s < 0", "s <= 0"])
def test_a_touch_is_told_from_a_miss(guard, where) -> None:
    # an integral rounds: whether it comes back to zero exactly is not for a guard to say, but a
    # part in 1e13 to either side is
    for lowest in (1e-13, -1e-13):
        s = hb.Integral(f"2*(ramp - {where})", start=where**2 + lowest)
        m = base(ramp=RAMP, s=s)
        watch(m, guard)
        run = hb.simulate(m, until=3.0)
        assert run.mode == {"m": "m0" if lowest > 0.0 else "m1"}
        assert all(t == pytest.approx(where, abs=1e-6) for t in times(run))


def test_restart_exactly_on_a_guard() -> None:
    m = base(ramp=RAMP)
    watch(m, "ramp >= 1", "ramp > 1", "ramp >= 2", "ramp > 2 and r.e > 0")
    run = hb.simulate(m, until=3.0)
    assert run.mode == {"m": "m4"}
    at = times(run)
    assert all(min(abs(t - 1), abs(t - 2)) < 1e-9 for t in at)


def test_guard_true_at_the_start_and_at_the_end() -> None:
    m = base(ramp=RAMP)
    watch(m, "ramp >= 0", "time >= 2")
    run = hb.simulate(m, until=2.0)
    assert run.mode == {"m": "m2"}
    assert run.trace.events[0].t == 0.0
    assert run.trace.events[-1].t == 2.0


@pytest.mark.parametrize("level", [2.0 - 1e-9, 2.0])
def test_crossing_at_the_end(level) -> None:
    # a crossing within the event tolerance of the end belongs to the end, or is not reached
    m = base(ramp=RAMP)
    watch(m, f"ramp >= {level!r}")
    run = hb.simulate(m, until=2.0)
    assert run.t_end == 2.0
    for t in times(run):
        assert abs(t - level) < 1e-9


def test_fifty_machines_at_one_instant() -> None:
    m = base(s=hb.Integral("cos(1*time)"))
    for k in range(50):
        watch(m, "s >= 0.5", name=f"m{k}_")
    run = hb.simulate(m, until=1.0, rtol=1e-11)
    (event,) = (e for e in run.trace.events if e.t > 0)
    assert sum(len(s.fired) for s in event.steps) == 50
    assert event.t == pytest.approx(math.pi / 6, rel=1e-9)


@pytest.mark.sampled(1)
def test_fifty_machines_at_fifty_instants() -> None:
    m = base()
    levels = [math.exp(-0.02 * (k + 1)) for k in range(50)]
    for k, level in enumerate(levels):
        watch(m, f"c.q <= {level!r}", name=f"m{k}_")
    run = hb.simulate(m, until=1.2, rtol=1e-11)
    assert times(run) == pytest.approx([0.02 * (k + 1) for k in range(50)], rel=1e-9)


@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9])
def test_narrow_window(width) -> None:
    m = base(ramp=RAMP)
    watch(m, f"ramp > 1.3 and ramp < {1.3 + width!r}")
    run = hb.simulate(m, until=3.0)
    assert times(run) == [pytest.approx(1.3, rel=1e-9)]


def test_two_windows_of_different_signals() -> None:
    # 0.5 <= ramp and exp(-t) >= exp(-0.5): true at one instant only
    m = base(ramp=RAMP)
    watch(m, f"ramp >= 0.5 and c.q >= {math.exp(-0.5) - 1e-7!r}")
    run = hb.simulate(m, until=3.0, rtol=1e-10)
    assert times(run) == [pytest.approx(0.5, abs=1e-9)]


def test_time_event_and_guard_at_once_are_settled_once() -> None:
    m = base(ramp=RAMP)
    watch(m, "ramp >= 1", name="g")
    watch(m, "time >= 1", name="t")
    run = hb.simulate(m, until=2.0)
    assert times(run) == [1.0]
    event = run.trace.events[-1]
    assert {f.machine for s in event.steps for f in s.fired} == {"g", "t"}


@pytest.mark.sampled(1)
def test_pwm_edges_are_exact() -> None:
    m = base()
    m.input(gate=hb.Input(pwm={"period": 0.1, "duty": 0.3}))
    m.machine(
        "p",
        states={"hi": [], "lo": []},
        start="hi",
        rules=["hi -> lo when gate < 0.5", "lo -> hi when gate > 0.5"],
    )
    run = hb.simulate(m, until=50.0)
    at = times(run)
    want = sorted([k * 0.1 for k in range(1, 501)] + [(k + 0.3) * 0.1 for k in range(500)])
    want = [t for t in want if t <= 50.0]
    assert len(at) in (len(want), len(want) - 1)
    assert at == want[: len(at)]


def test_machines_read_each_other() -> None:
    m = base(ramp=RAMP)
    watch(m, "ramp >= 1", name="a")
    m.machine("b", states={"x": [], "y": []}, start="x", rules=['x -> y when a.state == "a1"'])
    m.machine(
        "e",
        states={"x": [], "y": []},
        start="x",
        rules=['x -> y when b.state == "y" and pre(a.state == "a0")'],
    )
    m.machine(
        "d",
        states={"x": [], "y": []},
        start="x",
        rules=['x -> y when a.state != "a0" and e.state == "y"'],
    )
    run = hb.simulate(m, until=2.0)
    assert run.mode == {"a": "a1", "b": "y", "e": "y", "d": "y"}
    (event,) = (e for e in run.trace.events if e.t > 0)
    assert event.t == pytest.approx(1.0, rel=1e-9)


def test_nested_pre() -> None:
    m = base(ramp=RAMP)
    watch(m, "pre(pre(ramp)) >= 1")
    try:
        run = hb.simulate(m, until=2.0)
    except hb.HybondError as error:
        assert error.hint
    else:
        assert times(run) == [pytest.approx(1.0, rel=1e-9)]


def test_sequence_of_exponential_times() -> None:
    # charge and discharge between 1/3 and 2/3: a relaxation oscillator
    m = hb.Model("astable")
    m.add(
        c=hb.C(1.0, q=1 / 3), r=hb.R(1.0), s=hb.Se('if m.state == "up" then 1 else 0'), i=hb.One()
    )
    m.bond("s -> i", "i -> c", "i -> r")
    m.machine(
        "m",
        states={"up": [], "down": []},
        start="up",
        rules=["up -> down when c.e >= 2/3", "down -> up when c.e <= 1/3"],
    )
    run = hb.simulate(m, until=14.0, rtol=1e-11)
    assert times(run) == pytest.approx([math.log(2) * (k + 1) for k in range(20)], rel=1e-9)


def test_cosine_extremum_just_above_and_below_the_level() -> None:
    for level, fires in ((1.0 - 1e-9, True), (1.0 + 1e-9, False)):
        m = base(s=hb.Integral("cos(1*time)"))
        watch(m, f"s > {level!r}")
        run = hb.simulate(m, until=3.0, rtol=1e-12)
        assert bool(times(run)) is fires
