"""Sliding where crossings are jumps, against closed forms and the limit of a shrinking band."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from engine.sliding_models import swapped

import hybond as hb

EXAMPLES = Path(__file__).parents[3] / "examples"


def clutch(torque: str, *, drum: float = 1.5, leave: str = "v.f < 1") -> hb.Model:
    """A shaft (1) and a dragged drum (2): coupled above speed 1, with a brake then; free below."""
    m = hb.Model("clutch", domain="rotational")
    m.add(
        shaft=hb.I(1.0),
        motor=hb.Se(torque),
        drum=hb.I(2.0, f=drum),
        drag=hb.R(3.0),
        brake=hb.Se('if k.state == "on" then -8 else 0'),
        v=hb.One(),
        w=hb.One(),
        link=hb.Zero(),
    )
    m.bond("motor -> v -> shaft", "brake -> v", "v -> link -> w -> drum", "w -> drag")
    m.machine(
        "k",
        states={"off": [], "on": ["link"]},
        start="off",
        rules=["off -> on when v.f > 1", f"on -> off when {leave}"],
    )
    return m


def engaged(torque: float) -> float:
    """Part of the time: coupled, the speed is held by torque - 8 on - 3 = 0."""
    return (torque - 3.0) / 8.0


def test_a_clutch_that_strikes_at_every_engagement_slides_where_its_strokes_vanish() -> None:
    run = hb.simulate(clutch("5 + 1.5*sin(2*time/(1 s))"), until=6.0, rtol=1e-10)
    (sliding,) = run.sliding
    assert sliding.t1 == 6.0
    for t in np.linspace(sliding.t0 + 0.1, 6.0, 9):
        expected = engaged(5.0 + 1.5 * np.sin(2.0 * t))
        assert run.weight("k", "on", float(t)) == pytest.approx(expected, abs=1e-12)
        # mean of torque and strokes: what the drum's drag takes
        assert run["link.e"].at(float(t)) == pytest.approx(3.0, abs=1e-12)
        assert run["v.f"].at(float(t)) == pytest.approx(1.0, abs=1e-14)
        assert run["w.f"].at(float(t)) == pytest.approx(1.0, abs=1e-14)
        assert run["drum.e"].at(float(t)) == pytest.approx(0.0, abs=1e-12)
    assert run.audit().holds(1e-10)


def test_switching_in_a_band_tends_to_it_with_order_one() -> None:
    torque = "5 + 1.5*sin(2*time/(1 s))"
    slid = hb.simulate(clutch(torque), until=1.0, rtol=1e-10)
    errors = []
    for band in (1e-2, 2.5e-3):
        run = hb.simulate(
            clutch(torque), until=1.0, rtol=1e-8, sliding="hysteresis", hysteresis=band
        )
        t = np.linspace(0.5, 1.0, 101)
        errors.append(np.abs(run["w.f"].at(t) - slid["w.f"].at(t)).max())
        assert errors[-1] < 3.0 * band
    assert errors[1] == pytest.approx(0.25 * errors[0], rel=0.25)


def test_strokes_that_do_not_vanish_are_a_divergence_of_time() -> None:
    """Below torque 3 a stroke throws the shaft back below its speed by more than it gained."""
    with pytest.raises(hb.DivergenceOfTime, match="HB-N401"):
        hb.simulate(clutch("4 [N*m] - 1 [N*m/s]*time"), until=3.0)
    run = hb.simulate(clutch("4 [N*m] - 1 [N*m/s]*time"), until=3.0, on_error="return")
    (sliding,) = run.sliding
    assert sliding.t1 == pytest.approx(1.0, abs=1e-9)


def test_a_stroke_that_throws_back_too_far_is_told_where_sliding_would_begin() -> None:
    """At torque 2 both sides push in, but the stroke leaves less speed than there was."""
    m = clutch("2", drum=1.5)
    m.elements["shaft"] = hb.I(1.0, f=1.0)
    run = hb.simulate(m, until=3.0, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N401"
    assert run.sliding == ()
    assert any("throws back by more than was gained" in w for w in run.warnings)


def test_a_stroke_and_a_release_at_once_approach_the_sliding_motion_and_end_in_it() -> None:
    """With a priori guards each stroke is a pinnacle: a geometric sequence of strokes."""
    run = hb.simulate(clutch("5", drum=0.0, leave="pre(v.f) < 1"), until=3.0, rtol=1e-10)
    (sliding,) = run.sliding
    # the map from stroke to stroke, iterated here
    t, w = 0.0, 0.0
    v = 0.0
    for _ in range(200):
        dt = (1.0 - v) / 5.0
        t += dt
        w *= np.exp(-1.5 * dt)
        v = w = (1.0 + 2.0 * w) / 3.0
    assert sliding.t0 == pytest.approx(t, abs=1e-8)
    assert run.weight("k", "on", 2.0) == pytest.approx(engaged(5.0), abs=1e-12)
    strokes = [e for e in run.events if any(s.impulses for s in e.steps)]
    assert 20 < len(strokes) < 150
    assert run.audit().created <= 1e-12


@pytest.mark.parametrize("share", [0.5, 0.375, 0.9])
@pytest.mark.parametrize("turned", [False, True])
def test_strokes_too_soft_for_an_impulse_still_end_in_the_sliding_motion(share, turned) -> None:
    """Two drums on a differential turn as one, and could hold more than it at the same energy.

    So a stroke is no impulse beside that before it is nothing beside what the shaft holds.
    """
    whole = hb.simulate(clutch("5", drum=0.0, leave="pre(v.f) < 1"), until=2.0, rtol=1e-10)
    m = clutch("5", drum=0.0, leave="pre(v.f) < 1")
    del m.elements["drum"]
    m.bonds[:] = [chain.replace("w -> drum", "w -> n") for chain in m.bonds]
    m.add(a=hb.I(2.0 / share), b=hb.I(2.0 / (1.0 - share)), n=hb.Zero())
    m.bond("a -> n" if turned else "n -> a", "n -> b")
    run = hb.simulate(m, until=2.0, rtol=1e-10)
    (sliding,) = run.sliding
    (expected,) = whole.sliding
    assert sliding.t0 == pytest.approx(expected.t0, abs=1e-8)
    assert run.weight("k", "on", 1.5) == pytest.approx(engaged(5.0), abs=1e-12)
    assert run["w.f"].at(1.5) == pytest.approx(1.0, abs=1e-12)
    assert run.audit().holds(1e-9)


def test_the_governor_example() -> None:
    run = hb.simulate(hb.load(EXAMPLES / "sliding_clutch.toml"))
    (sliding,) = run.sliding
    assert sliding.t1 == 4.0
    for t in (1.0, 2.5, 3.9):
        expected = (2.0 + 1.5 * np.sin(2.0 * t)) / 8.0
        assert run.weight("clutch", "engaged", t) == pytest.approx(expected, abs=1e-12)
        assert run["link.e"].at(t) == pytest.approx(3.0, abs=1e-11)
    assert run.audit().holds()


# -- jumps on both sides


def capacitors(first: float, second: float, start: float) -> hb.Model:
    """A capacitor joined to a second one below a falling threshold, to a third one above."""
    m = hb.Model("capacitors")
    m.add(
        c=hb.C(1.0, q=start),
        c1=hb.C(0.5, q=0.5 * first),
        c2=hb.C(2.0, q=2.0 * second),
        source=hb.Sf('if k.state == "high" then -2 else 3'),
        leak1=hb.R(5.0),
        leak2=hb.R(4.0),
        n=hb.Zero(),
        n1=hb.Zero(),
        n2=hb.Zero(),
        l1=hb.One(),
        l2=hb.One(),
    )
    m.bond("source -> n -> c", "n -> l1 -> n1 -> c1", "n -> l2 -> n2 -> c2")
    m.bond("n1 -> leak1", "n2 -> leak2")
    m.signal(z="0.5 + 0.5*exp(-time/(1 s))")
    m.machine(
        "k",
        states={"low": ["l1"], "high": ["l2"]},
        start="high",
        rules=["low -> high when n.e > z", "high -> low when n.e < z"],
    )
    return m


@pytest.mark.parametrize(("first", "second"), [(0.5, 1.2), (0.2, 2.0)])
def test_every_crossing_is_a_jump_and_they_vanish(first: float, second: float) -> None:
    run = hb.simulate(capacitors(first, second, 2.0), until=3.0)
    (sliding,) = run.sliding
    sizes = [
        max(abs(a) for a in s.impulses.values())
        for e in run.events[1:]
        for s in e.steps
        if s.impulses
    ]
    assert len(sizes) >= 3
    assert all(b < 0.2 * a for a, b in pairwise(sizes))
    t = np.linspace(sliding.t0, 3.0, 20)[1:]
    z, slope = 0.5 + 0.5 * np.exp(-t), -0.5 * np.exp(-t)
    for name in ("c.e", "c1.e", "c2.e"):
        assert run[name].at(t) == pytest.approx(z, abs=1e-14)
    # all three follow the threshold: the mean source feeds them and both leaks
    mean = 3.5 * slope + z / 5.0 + z / 4.0
    assert run["source.f"].at(t) == pytest.approx(mean, abs=1e-12)
    assert run.weight("k", "high", 2.5) == pytest.approx(
        (3.0 - 3.5 * -0.5 * np.exp(-2.5) - 0.45 * (0.5 + 0.5 * np.exp(-2.5))) / 5.0, abs=1e-12
    )
    assert run["leak1.f"].at(t) + run["leak2.f"].at(t) == pytest.approx(0.45 * z, abs=1e-12)
    assert run.audit().holds()


def test_jumps_of_one_instant_are_added_up_to_their_limit() -> None:
    run = hb.simulate(swapped(), until=2.0)
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(0.5, abs=1e-12)
    for name, size in (("c", 1.0), ("c1", 0.5), ("c2", 2.0)):
        # 6 units of charge on 3.5
        assert run[f"{name}.q"].at(1.0) == pytest.approx(size * 12.0 / 7.0, rel=1e-14)
    assert run.weight("k", "high", 1.0) == pytest.approx(2.0 / 3.0, abs=1e-14)
    pinnacle, last = run.events[-1].steps
    assert (pinnacle.kind, last.kind) == ("pinnacle", "continuous")
    before = run.events[-1].before[0]
    moved = pinnacle.impulses["c.f"] + last.impulses["c.f"]
    assert before + moved == pytest.approx(12.0 / 7.0, rel=1e-13)
    lost = sum(s.energy.lost for s in run.events[-1].steps)
    stored = lambda q, q1, q2: 0.5 * (q**2 + q1**2 / 0.5 + q2**2 / 2.0)  # noqa: E731
    drop = stored(2 / 3, 1 / 3, 5.0) - stored(12 / 7, 6 / 7, 24 / 7)
    assert lost == pytest.approx(drop, rel=1e-12)


def test_the_same_limit_is_that_of_a_narrow_band() -> None:
    run = hb.simulate(swapped(), until=1.0, sliding="hysteresis", hysteresis=1e-3)
    assert run.final["c.q"] == pytest.approx(12.0 / 7.0, rel=1e-9)


def test_jumps_without_end_are_told_and_do_not_slide() -> None:
    """A mass between two belts that run in opposite directions."""
    m = hb.Model("belts", domain="translational")
    m.add(mass=hb.I(1.0), up=hb.Sf(1.0), down=hb.Sf(-1.0), v=hb.One(), a=hb.Zero(), b=hb.Zero())
    m.bond("v -> mass", "up -> a -> v", "down -> b -> v")
    m.signal(x=hb.Integral("v.f", start=-0.5))
    m.machine(
        "k",
        states={"low": ["a"], "high": ["b"]},
        start="low",
        rules=["low -> high when x > 0", "high -> low when x < 0"],
    )
    run = hb.simulate(m, until=2.0)
    assert run.status == "accumulation"
    assert run.sliding == ()
    assert run.t_end == pytest.approx(0.5, abs=1e-9)
    assert any("k is pushed back over x = 0" in w and "without an end" in w for w in run.warnings)


# -- a jump on one side that throws back


def pipe(guards: tuple[str, str]) -> hb.Model:
    """A tank fed by 1, a pipe with inertia that runs above the edge: stopped, it runs at once."""
    m = hb.Model("pipe")
    m.add(
        feed=hb.Sf(1.0),
        tank=hb.C(1.0),
        inertia=hb.I(0.1),
        loss=hb.R(0.5),
        bottom=hb.Zero(),
        pipe=hb.One(),
        other=hb.C(1.0, q=-5.0),
        apart=hb.Zero(),
    )
    m.bond("feed -> bottom -> tank", "bottom -> pipe -> inertia", "pipe -> loss", "apart -> other")
    m.machine(
        "weir",
        states={"dry": [], "runs": ["pipe"]},
        start="dry",
        rules=[f"dry -> runs when {guards[0]}", f"runs -> dry when {guards[1]}"],
    )
    return m


@pytest.mark.parametrize(
    "guards",
    [
        ("tank.e > 1", "tank.e < 1"),
        ("tank.e > 1 or other.e > 1", "tank.e <= 1 and other.e <= 1"),
        ("not (tank.e <= 1 and other.e < 1)", "other.e < 1 and not (tank.e > 1)"),
    ],
)
def test_closing_and_opening_at_once_is_one_event_with_a_pinnacle(guards) -> None:
    run = hb.simulate(pipe(guards), until=6.0, rtol=1e-9)
    assert run.sliding == ()
    _, first, *cycles = run.events
    assert first.t == pytest.approx(1.0, abs=1e-10)
    assert len(cycles) >= 5
    gaps = np.diff([first.t, *(e.t for e in cycles)])
    assert gaps == pytest.approx(gaps[0], rel=1e-6)
    for e in cycles:
        assert [s.kind for s in e.steps] == ["pinnacle", "continuous"]
        assert [(f.source, f.target) for s in e.steps for f in s.fired] == [
            ("runs", "dry"),
            ("dry", "runs"),
        ]
        assert e.steps[0].impulses
        assert not e.steps[1].impulses
    assert run.audit().holds(1e-9)


@pytest.mark.slow
def test_a_stop_that_an_input_leads_away_from_does_not_hide_the_other_stop() -> None:
    # an amplifier between two stops; at 2 ms the input jumps, and with it what is asked of it
    part = hb.library.part("electrical.op_amp")
    part.machines["limit"] = replace(
        part.machines["limit"],
        rules=(
            "linear -> at_high when inside >= high and asked > 0",
            "linear -> at_low when inside <= low and asked < 0",
            "at_high -> linear when asked < 0",
            "at_low -> linear when asked > 0",
        ),
    )
    m = hb.Model("inverting", domain="electrical")
    m.add(V=hb.Se("v"), i=hb.One(), r1=hb.R(1000), n=hb.Zero(), j=hb.One(), r2=hb.R(5000))
    m.add(u=hb.Submodel(part, low="-10 V", high="12 V"), y=hb.Zero(), zero=hb.Se(0), g=hb.Zero())
    m.bond("V -> i -> n -> j -> y", "i -> r1", "j -> r2", "zero -> g", "u.out -> y")
    m.bond("g -> u.plus", "n -> u.minus", "g -> u.ground")
    m.input(v=hb.Input(table=[(0, "-1 V"), ("1 ms", "-8 V"), ("2 ms", "8 V")]))
    run = hb.simulate(m, until="3 ms")
    found = run["u.voltage"].at([0.0009, 0.0019, 0.0029])
    assert found == pytest.approx([5 / (1 + 6e-5), 12, -10], rel=1e-8)
    assert not run.sliding
