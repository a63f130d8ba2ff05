"""Events that the kernel settles are those of the reference, and nothing is lost on the way."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.modes.executive import Executive
from hybond.modes.motion import Limits


def both(model, until, **options):
    """Return the reference's run and the kernel's."""
    return [
        hb.simulate(model, until, kernel=k, on_error="return", **options) for k in (False, True)
    ]


def told(run):
    """What happened: causes, modes, guards."""
    return [
        (e.cause, [(s.mode, s.kind, [(f.machine, f.guard) for f in s.fired]) for s in e.steps])
        for e in run.events
    ]


def ball(restitution=0.9):
    """Return a ball that a machine throws back."""
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se("-9.81"), ball=hb.I(1.0), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf(f"-{restitution}*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "rebound -> contact")
    m.signal(height=hb.Integral("v.f", start=3.0))
    m.machine(
        "floor",
        states={"away": [], "impact": ["contact"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m


def oscillating(rules, parts=None, bonds=()):
    """Return a capacitor with a leak that a machine switches in rhythm."""
    m = hb.Model("rhythm")
    m.add(c=hb.C(1, q=1.0), n=hb.Zero(), g=hb.G(0.1), s=hb.One(), r=hb.R(1), **(parts or {}))
    m.bond("n -> c", "n -> g", "n -> s -> r", *bonds)
    m.machine("M", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    return m


RHYTHM = ["off -> on when sin(5*time) > 0.1", "on -> off when sin(5*time) < -0.2"]


def test_bounces_against_the_closed_form(kernel):
    run = hb.simulate(ball(0.95), 20.0)
    assert run.stats["crossed"] > 0.8 * len(run.events)
    fall = np.sqrt(2.0 * 3.0 / 9.81)
    k = np.arange(len(run.events) - 1)
    bounces = fall * (1.0 + 2.0 * 0.95 * (1.0 - 0.95**k) / 0.05)
    assert [e.t for e in run.events[1:]] == pytest.approx(bounces, rel=1e-9)
    speeds = np.sqrt(2.0 * 9.81 * 3.0) * 0.95**k
    assert [-e.before[0] for e in run.events[1:]] == pytest.approx(speeds, rel=1e-7)
    lost = [e.steps[0].energy.lost for e in run.events[1:]]
    assert lost == pytest.approx(0.5 * speeds**2 * (1.0 - 0.95**2), rel=1e-6)


def test_records_are_those_of_the_reference(kernel):
    a, b = both(ball(), 9.0, rtol=1e-10)
    assert b.stats["crossed"] > 0 and told(a) == told(b)
    for one, other in zip(a.events, b.events, strict=True):
        assert one.before == pytest.approx(other.before, rel=1e-8, abs=1e-9)
        for x, y in zip(one.steps, other.steps, strict=True):
            assert x.impulses == pytest.approx(y.impulses, rel=1e-8)
            assert x.exchanged == pytest.approx(y.exchanged, rel=1e-8)
    assert str(a.events).splitlines()[0] == str(b.events).splitlines()[0]


def test_accumulation_still_lands(kernel):
    a, b = both(ball(0.5), 6.0, rtol=1e-10)
    (x,), (y,) = a.accumulations, b.accumulations
    assert b.stats["crossed"] > 0
    assert x.landed and y.landed and y.t == pytest.approx(x.t, rel=1e-6)
    assert a.mode == b.mode


def test_sources_of_constraints_read_signals_of_the_same_instant(kernel):
    m = hb.Model("keep", domain="electrical")
    m.add(V=hb.Se("(1 [V])*(1 + A)"), s=hb.One(), z=hb.Zero(), c=hb.C("1 F", q=1.1))
    m.add(i=hb.One(), L=hb.I("1 H"), r=hb.R(1))
    m.bond("V -> s -> z", "z -> c", "z -> i -> L", "i -> r")
    m.signal(A=hb.Integral("sin(3*time)", start=0.1))
    m.machine("M", states={"on": ["s"], "off": []}, start="on", rules=["on -> off when time > 10"])
    a, b = both(m, 1.0, rtol=1e-11)
    assert b.stats["marched"] == b.stats["steps"]
    assert b["L.p"].at(1.0) == pytest.approx(a["L.p"].at(1.0), rel=1e-9)
    assert b["c.q"].at(0.5) == pytest.approx(1.0 + b["A"].at(0.5), rel=1e-12)


@pytest.mark.slow
def test_more_modes_than_are_kept_ready(kernel):
    m = hb.Model("many")
    m.add(c=hb.C(1, q=1.0), n=hb.Zero(), g=hb.G(0.1))
    m.bond("n -> c", "n -> g")
    for k in range(9):
        rate = 2.0 * np.pi / 2.0**k
        rules = [f"off -> on when sin({rate!r}*time) > 0.1"]
        rules += [f"on -> off when sin({rate!r}*time) < -0.1"]
        m.machine(f"M{k}", states={"off": [], "on": []}, start="off", rules=rules)
    a, b = both(m, 140.0)
    assert len({e.steps[-1].mode for e in a.events}) > 256
    assert b.stats["crossed"] > 0 and told(a) == told(b)


def test_nothing_was_before_while_time_passes(kernel):
    m = oscillating(RHYTHM)
    m.signal(A=hb.Integral("pre(c.e)", start=0))
    a, b = both(m, 6.0)
    assert b.stats["crossed"] > 5
    assert b["A"].at(6.0) == pytest.approx(a["A"].at(6.0), abs=1e-9)


def test_a_law_with_several_solutions_keeps_its_branch(kernel):
    parts = {"V": hb.Se("0.5 + 10*u"), "i": hb.One(), "td": hb.R({"e": "f^3 - 3*f"})}
    m = oscillating(["off -> on when sin(5*time) > 0.1", "on -> off when sin(5*time) < -0.1"],
                    parts, ["V -> i -> td"])  # fmt: skip
    m.input(u=hb.Input(pwm={"period": 4.0, "duty": 0.25, "phase": 0.5}))
    a, b = both(m, 4.0, rtol=1e-9)
    assert b.stats["crossed"] > 3
    t = [1.0, 2.0, 3.0, 3.9]
    assert b["td.f"].at(t) == pytest.approx(a["td.f"].at(t), rel=1e-8)


@pytest.mark.slow
def test_an_impulse_times_what_jumps_is_refused(kernel):
    """A factor in a guard that the mode before did not read."""
    m = hb.Model("stale", domain="electrical")
    m.add(V=hb.Se("1"), sw=hb.One(), r=hb.R(1), L=hb.I("1 H"), U=hb.Se("3"), hi=hb.One())
    m.add(rh=hb.R(1), lo=hb.One(), rl=hb.R(2), z=hb.Zero(), g=hb.G(1), zz=hb.Zero())
    m.bond("V -> sw -> r", "sw -> L", "U -> zz", "zz -> hi -> z", "hi -> rh", "zz -> lo -> z")
    m.bond("lo -> rl", "z -> g")
    asked = "sin(4*time) < -0.5 or sw.e*g.f < -1e9*(1 [W])"
    rules = ["closed -> open when sin(4*time) > 0.5", f"open -> closed when {asked}"]
    m.machine("M", states={"closed": ["sw"], "open": []}, start="closed", rules=rules)
    rules = ["a -> b when sin(1.37*time) > 0.3", "b -> a when sin(1.37*time) < 0.2"]
    m.machine("P", states={"a": [], "b": []}, start="a", rules=rules)
    late = "sin(4*time) < -0.5 and sin(4*time) > -0.8 and cos(4*time) < 0 and cos(0.1*time) < -0.2"
    back = "(sin(4*time) > 0.5 and time > 30.01) or (time < 30.01 and sin(4*time) < -0.9)"
    m.machine("N", states={"hi": ["hi"], "lo": ["lo"]}, start="hi",
              rules=[f"hi -> lo when {late}", f"lo -> hi when {back}"])  # fmt: skip
    a, b = both(m, 42.0, rtol=1e-9)
    assert b.stats["crossed"] > 30
    assert (a.error.code, b.error.code) == ("HB-J101", "HB-J101")
    assert b.t_end == pytest.approx(a.t_end)


def test_a_surface_that_repels_is_told(kernel):
    m = hb.Model("repels")
    m.add(x=hb.C(1, q=0.5), n=hb.Zero(), f=hb.Sf("v"))
    m.bond("f -> n -> x")
    m.signal(
        v='if R.state == "hi" then (if S.state == "a" then -1 else 1) else -0.5 - 0.8*sin(2*time)'
    )
    m.machine("R", states={"lo": [], "hi": []}, start="hi",
              rules=["lo -> hi when x.q > 0", "hi -> lo when x.q < 0"])  # fmt: skip
    m.machine("S", states={"a": [], "b": []}, start="a",
              rules=['a -> b when R.state == "lo"', "b -> a when x.q > 0.2"])  # fmt: skip
    a, b = both(m, 6.0)
    assert a.warnings == b.warnings != ()


def test_inputs_cross_a_bound_at_the_same_instant(kernel):
    values = [-0.3, 0.4, -0.2, 0.6, -0.7, 0.1, -0.9, 0.3, -0.1, 0.7, -0.6]
    m = oscillating(["off -> on when w > 0", "on -> off when w < -0.01"])
    m.input(w=hb.Input(table=[(0.1 * k, v) for k, v in enumerate(values)], linear=True))
    m.input(u=hb.Input(pwm={"period": 0.07, "duty": 0.5}))
    a, b = both(m, 1.0)
    assert b.stats["crossed"] > 5 and told(a) == told(b)


def test_the_limit_of_events_holds(kernel, monkeypatch):
    begin = Executive.__init__

    def limited(self, program, solver, limits, **options):
        begin(self, program, solver, Limits(limits.until, limits.event_tol, 20), **options)

    monkeypatch.setattr(Executive, "__init__", limited)
    a, b = both(oscillating(RHYTHM), 50.0)
    assert (a.error.code, b.error.code) == ("HB-N404", "HB-N404")
    assert (len(b.events), b.t_end) == (len(a.events), pytest.approx(a.t_end))


def test_progress_is_told_and_may_stop_a_run(kernel):
    seen = []

    def tell(t, events):
        seen.append((t, events))
        if t > 30.0:
            raise KeyboardInterrupt

    run = hb.simulate(oscillating(RHYTHM), 2000.0, progress=tell)
    assert run.status == "interrupted" and 30.0 < run.t_end < 2000.0
    assert len(run.events) == seen[-1][1] == len(list(run.events))
    assert np.all(np.diff([t for t, _ in seen]) >= 0.0)


def test_diodes_that_may_share_at_will_are_left_to_the_reference(kernel):
    """Two diodes in series turn off together: both block, and one warning says what is open."""
    m = hb.Model("series", domain="electrical")
    m.add(V=hb.Se("5*sin(2*time)"), n=hb.Zero(), k=hb.Zero(), g=hb.Zero(), r=hb.R(1.0))
    m.add(d1=hb.One(law="diode"), d2=hb.One(law="diode"), c=hb.C(0.1))
    m.bond("V -> n -> d1 -> k -> d2 -> g -> r", "g -> c")
    a, b = both(m, 20.0)
    assert told(a) == told(b) and a.warnings == b.warnings
    assert b["c.q"].at(19.0) == pytest.approx(a["c.q"].at(19.0), rel=1e-7)


@pytest.mark.parametrize("side", ["left", "right"])
def test_samples_of_many_segments_are_those_one_by_one(kernel, side):
    m = oscillating(
        ["off -> on when u > 0.5 and time < 3.05", "on -> off when u < 0.5 or time > 4"]
    )
    m.input(u=hb.Input(pwm={"period": 0.3, "duty": 0.4}))
    m.input(w=hb.Input(table=[(0.0, 0.0), (1.1, 2.0), (2.7, -1.0), (6.0, 3.0)], linear=True))
    m.signal(both="u + w + (if time > 2 then 10 else 0)")
    run = hb.simulate(m, 6.0)
    assert run.stats["crossed"] > 5
    edges = [e.t for e in run.events]
    t = [*np.linspace(0.0, 6.0, 83).tolist(), *edges]
    names = ["c.q", "c.e", "both", "s.f"]
    together = run.sample(t, names, side=side)
    for name in names:
        alone = [float(run.sample([a], [name], side=side)[name][0]) for a in t]
        assert together[name] == pytest.approx(alone, rel=1e-13, abs=1e-15), name


def test_corners_of_an_input_beside_an_event_do_not_crowd(kernel):
    """The edge of a pulse ends 50 ps after the switch has seen it, period after period."""
    m = hb.Model("gated", domain="electrical")
    m.add(
        V=hb.Se("10 V"), s=hb.One(), r=hb.R("1 ohm"), n=hb.Zero(), c=hb.C("1 mF"), g=hb.G("0.1 S")
    )
    m.bond("V -> s -> n -> c", "s -> r", "n -> g")
    edges = [["0 s", 0], ["100 ps", 1], ["0.4 ms", 1], ["400.0001 us", 0]]
    m.input(gate=hb.Input(table=edges, linear=True, period="1 ms"))
    m.machine(
        "M",
        states={"off": [], "on": ["s"]},
        start="off",
        rules=["off -> on when gate > 0.5", "on -> off when gate < 0.5"],
    )
    slow, fast = both(m, "20 ms")
    assert told(slow) == told(fast)
    assert len(fast.events) == 41
    assert "in doubt" not in fast.kernel
    # charged by 10 V through 1 ohm and 0.1 S, discharged by 0.1 S alone
    on, off, q = np.exp(-1.1 * 0.4), np.exp(-0.1 * 0.6), 0.0
    for _ in range(20):
        q = (0.01 / 1.1 + (q - 0.01 / 1.1) * on) * off
    assert fast["c.q"].at(20e-3) == pytest.approx(q, rel=1e-6)


def test_events_without_impulses_are_known_without_their_records(kernel):
    run = hb.simulate(ball(0.95), 20.0)
    telling = list(run.events.with_impulses())
    writing = [e for e in run.events if any(s.impulses for s in e.steps if s.kind != "mythical")]
    assert len(writing) > 10
    assert [e for e in telling if e in writing] == writing
    quiet = hb.simulate(oscillating(RHYTHM), 20.0)
    assert quiet.stats["crossed"] > 20
    known = len(list(quiet.events.with_impulses()))
    assert known <= len(quiet.events) - quiet.stats["crossed"]
    assert not any(s.impulses for e in quiet.events for s in e.steps)
