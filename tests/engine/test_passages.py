"""Event after event by the library, against closed forms: nothing is lost on the way."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from engine.switched_models import converter
from scipy.optimize import brentq

import hybond as hb


def ball(restitution: float) -> hb.Model:
    """Return a ball that a machine throws back."""
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se("-9.81"), ball=hb.I(1.0), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf(f"-{restitution}*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "rebound -> contact")
    m.signal(height=hb.Integral("v.f", start=3.0))
    rules = [
        "away -> impact when height <= 0 and v.f < 0",
        "impact -> away when pre(ball.p) >= 0",
    ]
    states: dict[str, list[str]] = {"away": [], "impact": ["contact"]}
    m.machine("floor", states=states, start="away", rules=rules)
    return m


def oscillating(rules: list[str], **parts: object) -> hb.Model:
    """Return a capacitor with a leak that a machine switches in rhythm."""
    m = hb.Model("rhythm")
    m.add(c=hb.C(1, q=1.0), n=hb.Zero(), g=hb.G(0.1), s=hb.One(), r=hb.R(1), **parts)
    m.bond("n -> c", "n -> g", "n -> s -> r")
    m.machine("M", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    return m


RHYTHM = ["off -> on when sin(5*time) > 0.1", "on -> off when sin(5*time) < -0.2"]


def test_bounces_against_the_closed_form() -> None:
    run = hb.simulate(ball(0.95), 20.0)
    fall = np.sqrt(2.0 * 3.0 / 9.81)
    k = np.arange(len(run.events) - 1)
    bounces = fall * (1.0 + 2.0 * 0.95 * (1.0 - 0.95**k) / 0.05)
    assert [e.t for e in run.events[1:]] == pytest.approx(bounces, rel=1e-9)
    speeds = np.sqrt(2.0 * 9.81 * 3.0) * 0.95**k
    assert [-e.before[0] for e in run.events[1:]] == pytest.approx(speeds, rel=1e-7)
    lost = [e.steps[0].energy.lost for e in run.events[1:]]
    assert lost == pytest.approx(0.5 * speeds**2 * (1.0 - 0.95**2), rel=1e-6)
    writing = [e for e in run.events if any(s.impulses for s in e.steps if s.kind != "mythical")]
    telling = list(run.events.with_impulses())
    assert len(writing) > 10 and [e for e in telling if e in writing] == writing


def test_a_rhythm_is_that_of_its_closed_form() -> None:
    run = hb.simulate(oscillating(RHYTHM), 20.0, rtol=1e-10)
    up, down = np.arcsin(0.1) / 5, (np.pi + np.arcsin(0.2)) / 5
    period = 2 * np.pi / 5
    meant = sorted([*(up + period * np.arange(20)), *(down + period * np.arange(20))])
    meant = [t for t in meant if t < 20.0]
    assert [e.t for e in run.events[1:]] == pytest.approx(meant, abs=1e-10)
    q, t, rate = 1.0, 0.0, 0.1
    for until in [*meant, 20.0]:
        q, t, rate = q * np.exp(-rate * (until - t)), until, 1.1 if rate == 0.1 else 0.1
    assert run["c.q"].at(20.0) == pytest.approx(q, abs=1e-10)
    assert not any(s.impulses for e in run.events for s in e.steps)


def test_sources_of_constraints_read_signals_of_the_same_instant() -> None:
    m = hb.Model("keep", domain="electrical")
    m.add(V=hb.Se("(1 [V])*(1 + A)"), s=hb.One(), z=hb.Zero(), c=hb.C("1 F", q=1.1))
    m.add(i=hb.One(), L=hb.I("1 H"), r=hb.R(1))
    m.bond("V -> s -> z", "z -> c", "z -> i -> L", "i -> r")
    m.signal(A=hb.Integral("sin(3*time)", start=0.1))
    m.machine("M", states={"on": ["s"], "off": []}, start="on", rules=["on -> off when time > 10"])
    run = hb.simulate(m, 1.0, rtol=1e-11)
    assert run["c.q"].at(0.5) == pytest.approx(1.0 + run["A"].at(0.5), rel=1e-12)
    # L' = 1 + A - L, A = 1/10 + (1 - cos 3t)/3
    a = 1.1 + 1 / 3
    b = -np.real(np.exp(3j) / (1 + 3j)) / 3
    c = -a + np.real(1 / (1 + 3j)) / 3
    assert run["L.p"].at(1.0) == pytest.approx(a + b + c * np.exp(-1.0), rel=1e-9)


def test_a_law_with_several_solutions_keeps_its_branch() -> None:
    """f^3 - 3 f = e, of which a machine beside it changes nothing."""
    m = oscillating(
        ["off -> on when sin(5*time) > 0.1", "on -> off when sin(5*time) < -0.1"],
        V=hb.Se("0.5 + 10*u"),
        i=hb.One(),
        td=hb.R({"e": "f^3 - 3*f"}),
    )
    m.bond("V -> i -> td")
    m.input(u=hb.Input(pwm={"period": 4.0, "duty": 0.25, "phase": 0.5}))
    run = hb.simulate(m, 4.0, rtol=1e-9)
    high = brentq(lambda f: f**3 - 3 * f - 10.5, 1.0, 4.0)
    assert run["td.f"].at(1.0) == pytest.approx(high, rel=1e-8)
    # which of three is taken where the source has jumped is not said, but events leave it as it is
    for t in ([0.01, 0.3, 0.49], [1.6, 2.0, 3.0, 3.9]):
        f = np.array(run["td.f"].at(t))
        assert f**3 - 3 * f == pytest.approx(0.5, rel=1e-9)
        assert np.ptp(f) < 1e-12
    assert len(run.events) > 5


def test_nothing_was_before_while_time_passes() -> None:
    m = oscillating(RHYTHM)
    m.signal(A=hb.Integral("pre(c.e)", start=0.25))
    run = hb.simulate(m, 6.0)
    assert len(run.events) > 5 and run["A"].at(6.0) == 0.25


def test_inputs_cross_a_bound_at_the_same_instant() -> None:
    values = [-0.3, 0.4, -0.2, 0.6, -0.7, 0.1, -0.9, 0.3, -0.1, 0.7, -0.6]
    m = oscillating(["off -> on when w > 0", "on -> off when w < -0.01"])
    m.input(w=hb.Input(table=[(0.1 * k, v) for k, v in enumerate(values)], linear=True))
    m.input(u=hb.Input(pwm={"period": 0.07, "duty": 0.5}))
    run = hb.simulate(m, 1.0)
    meant = []
    for k, (a, b) in enumerate(pairwise(values)):
        bound = 0.0 if b > a else -0.01
        meant.append(0.1 * (k + (bound - a) / (b - a)))
    fired = [e.t for e in run.events if any(s.fired for s in e.steps)]
    assert fired == pytest.approx(meant, abs=1e-12)


def test_two_diodes_in_series_block_together() -> None:
    """One warning says that the voltage between them is open."""
    m = hb.Model("series", domain="electrical")
    m.add(V=hb.Se("5*sin(2*time)"), n=hb.Zero(), k=hb.Zero(), g=hb.Zero(), r=hb.R(1.0))
    m.add(d1=hb.One(law="diode"), d2=hb.One(law="diode"), c=hb.C(0.1))
    m.bond("V -> n -> d1 -> k -> d2 -> g -> r", "g -> c")
    run = hb.simulate(m, 20.0, solver="rk45")
    assert len([w for w in run.warnings if "least leakage" in w]) == 1
    # conducting the capacitor follows the source, until r takes more than it gives back
    off = (np.pi - np.arctan(2.0 * 0.1)) / 2.0
    assert run.events[1].t == pytest.approx(off, rel=1e-9)
    later = run["c.q"].at(off + 0.3)
    assert later == pytest.approx(0.5 * np.sin(2.0 * off) * np.exp(-3.0), rel=1e-7)


@pytest.mark.parametrize("side", ["left", "right"])
def test_samples_of_many_segments_are_those_one_by_one(side: str) -> None:
    m = oscillating(
        ["off -> on when u > 0.5 and time < 3.05", "on -> off when u < 0.5 or time > 4"]
    )
    m.input(u=hb.Input(pwm={"period": 0.3, "duty": 0.4}))
    m.input(w=hb.Input(table=[(0.0, 0.0), (1.1, 2.0), (2.7, -1.0), (6.0, 3.0)], linear=True))
    m.signal(both="u + w + (if time > 2 then 10 else 0)")
    run = hb.simulate(m, 6.0)
    t = [*np.linspace(0.0, 6.0, 83).tolist(), *(e.t for e in run.events)]
    names = ["c.q", "c.e", "both", "s.f"]
    together = run.sample(t, names, side=side)
    for name in names:
        alone = [float(run.sample([a], [name], side=side)[name][0]) for a in t]
        assert together[name] == pytest.approx(alone, rel=1e-13, abs=1e-15), name


def test_corners_of_an_input_beside_an_event_do_not_crowd() -> None:
    """The edge of a pulse ends 50 ps after the switch has seen it, period after period."""
    m = hb.Model("gated", domain="electrical")
    m.add(V=hb.Se("10 V"), s=hb.One(), r=hb.R("1 ohm"), n=hb.Zero(), c=hb.C("1 mF"))
    m.add(g=hb.G("0.1 S"))
    m.bond("V -> s -> n -> c", "s -> r", "n -> g")
    edges = [["0 s", 0], ["100 ps", 1], ["0.4 ms", 1], ["400.0001 us", 0]]
    m.input(gate=hb.Input(table=edges, linear=True, period="1 ms"))
    rules = ["off -> on when gate > 0.5", "on -> off when gate < 0.5"]
    m.machine("M", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    run = hb.simulate(m, "20 ms")
    assert len(run.events) == 41
    # charged by 10 V through 1 ohm and 0.1 S, discharged by 0.1 S alone
    on, off, q = np.exp(-1.1 * 0.4), np.exp(-0.1 * 0.6), 0.0
    for _ in range(20):
        q = (0.01 / 1.1 + (q - 0.01 / 1.1) * on) * off
    assert run["c.q"].at(20e-3) == pytest.approx(q, rel=1e-6)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_guards_on_shares_that_least_leakage_sets(rtol: float) -> None:
    """Two closed switches in parallel: rounding is that of the terms before they share."""
    m = hb.Model("parallel", domain="electrical")
    m.add(V=hb.Se("sin(10*time)"), i=hb.One(), r=hb.R(1), z=hb.Zero(), c=hb.C("0.1 F"))
    m.add(z2=hb.Zero(), s1=hb.One(), s2=hb.One(), g=hb.G(1))
    m.bond("V -> i -> r", "i -> z -> c", "z -> s1 -> z2", "z -> s2 -> z2", "z2 -> g")
    m.signal(A=hb.Integral("abs(s1.f)/(1 [A])", start=0))
    rules = [
        "a -> b when A > 0.05",
        "b -> x when s1.f + s2.f < -0.1*(1 [A])",
        "x -> a when s2.f > 0.1*(1 [A])",
    ]
    m.machine("M", states={"a": ["s1"], "b": ["s1", "s2"], "x": ["s2"]}, start="a", rules=rules)
    run = hb.simulate(m, until=0.5, rtol=rtol)

    def e(t: float) -> float:
        """Across c, by e' = 10 sin 10 t - 20 e."""
        return float(np.imag(10 * np.exp(10j * t) / (20 + 10j)) + 0.2 * np.exp(-20 * t))

    last = run.events[-1]
    named = [[run.graph.machines[0].states[s.mode[0]] for s in ev.steps][-1] for ev in run.events]
    assert named == ["a", "b", "x"]
    assert last.t == pytest.approx(brentq(lambda t: e(t) + 0.1, 0.3, 0.45), abs=1e3 * rtol)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(8))
def test_random_networks_do_the_same_by_every_method(seed: int) -> None:
    """Stiffness, steps and exponentials: events and ends agree as far as tolerances go."""
    runs = [
        hb.simulate(converter(seed), 1.0, solver=solver, rtol=1e-10, on_error="return")
        for solver in ("rk45", "radau", "exact")
    ]
    told = [[(e.cause, [s.mode for s in e.steps]) for e in run.events] for run in runs]
    assert told[0] == told[1] == told[2]
    for run in runs[1:]:
        assert [e.t for e in run.events] == pytest.approx([e.t for e in runs[0].events], abs=1e-7)
        for name, value in runs[0].final.items():
            assert run.final[name] == pytest.approx(value, rel=1e-6, abs=1e-6), name
