"""Time-stepping of Moreau and Jean against published numbers, closed forms and located events."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.errors import UsageError

EXAMPLES = Path(__file__).parents[3] / "examples"


def step_run(model: hb.Model, until: float, h: float, **options: object) -> hb.Result:
    return hb.simulate(model, until, solver="moreau-jean", step=h, **options)


def ends(run: hb.Result, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and values at the ends of the steps, the second of two at an instant."""
    table = run.table([name])
    t = np.asarray(table["t"])
    last = np.append(t[1:] != t[:-1], True)
    return t[last], np.asarray(table[name])[last]


def ball(*, floor_below: bool = True, eps: float = 0.9) -> hb.Model:
    m = hb.Model("ball", domain="translational")
    m.add(
        weight=hb.Se("-9.81 N"),
        ball=hb.I("1 kg"),
        v=hb.One(),
        contact=hb.Zero(law="unilateral", gap="height", restitution=eps),
        floor=hb.Sf(0.0),
    )
    m.bond("weight -> v -> ball")
    m.bond(*(("floor -> contact -> v",) if floor_below else ("contact -> floor", "contact -> v")))
    m.signal(height=hb.Integral("v.f", start="1 m"))
    return m


PUBLISHED_BALL = (
    (0.49, 0.138682, 3.6297),
    (0.99, 0.727282, -1.2753),
    (1.99, 0.03642501, -3.487455),
    (4.99, 0.15838576, -0.65415813),
    (7.99, 0.00428949, -0.00269000),
)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("floor_below", [True, False])
def test_the_bouncing_ball_has_the_published_digits(floor_below: bool) -> None:
    run = step_run(ball(floor_below=floor_below), 10.0, 0.005)
    for t, q, v in PUBLISHED_BALL:
        assert float(run["height"].at(t)) == pytest.approx(q, abs=5.1e-9 if t > 1.5 else 5.1e-7)
        assert float(run["v.f"].at(t)) == pytest.approx(v, abs=5.1e-9 if t > 4 else 5.1e-7)
    # past the accumulation at 8.58 s it rests: the floor carries the weight
    assert run.status == "ok"
    assert run.final["height"] == pytest.approx(-2.2886e-5, abs=5e-10)
    assert 0.005 * float(run["contact.e"].at(10.0)) == pytest.approx(0.04905, abs=1e-12)
    assert run.mode == {"contact": "closed"}
    assert run.audit().power < 1e-12


def test_an_impact_is_an_event_of_the_step_with_its_percussion() -> None:
    run = step_run(ball(), 1.0, 0.005)
    impact = run.events[1]
    assert (impact.cause, impact.t0, impact.t) == (
        "step",
        pytest.approx(0.45),
        pytest.approx(0.455),
    )
    before, after = impact.before[0], impact.after[0]
    # p+ = p - m g h + percussion, and p+ = -eps p
    assert after == pytest.approx(-0.9 * before, rel=1e-12)
    percussion = after - before + 9.81 * 0.005
    assert impact.steps[0].impulses["contact.e"] == pytest.approx(percussion, rel=1e-12)
    assert impact.steps[0].kind == "pinnacle"
    assert "t = 0.45 .. 0.455 s" in str(run.events) and "in the step" in str(run.events)
    assert "δ" not in str(run.events)


def rlcd(*, turned: bool = False) -> hb.Model:
    m = hb.Model("rlcd", domain="electrical")
    m.add(
        c=hb.C("1 uF", e="10 V"), l=hb.I("10 mH"), r=hb.R("1 kohm"), d=hb.One(law="diode"),
        n=hb.Zero(),
    )  # fmt: skip
    m.bond(*(("c -> n", "l -> n", "r -> d") if turned else ("n -> c", "n -> l", "d -> r")))
    m.bond("n -> d")
    return m


def test_the_diode_circuit_has_the_published_digits_and_converges() -> None:
    run = step_run(rlcd(), 0.005, 1e-5)
    assert float(run["c.e"].at(4.98e-3)) == pytest.approx(2.5143, abs=5e-5)
    assert 1e3 * float(run["l.f"].at(4.98e-3)) == pytest.approx(-16.64, abs=5e-3)
    turned = step_run(rlcd(turned=True), 0.005, 1e-5)
    assert float(turned["c.q"].at(4.98e-3)) == pytest.approx(
        float(run["c.q"].at(4.98e-3)), rel=1e-9
    )
    assert float(turned["l.p"].at(4.98e-3)) == pytest.approx(
        float(run["l.p"].at(4.98e-3)), rel=1e-9
    )

    located = hb.simulate(rlcd(), 0.005)
    t = np.linspace(0.0, 0.005, 101)[:-1]
    exact = located.sample(t, ["c.e"])["c.e"]
    errors = [
        np.abs(step_run(rlcd(), 0.005, h).sample(t, ["c.e"])["c.e"] - exact).mean()
        for h in (2.5e-6, 1.25e-6)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.15)
    # every event is found in the step in which it happens, or the next one
    found = step_run(rlcd(), 0.005, 2.5e-6)
    for a, b in zip(found.events[1:], located.events[1:], strict=True):
        assert a.t0 is not None
        assert abs(a.t - b.t) < 8e-6


def bridge() -> hb.Model:
    m = hb.Model("bridge", domain="electrical")
    m.add(
        c=hb.C("1 uF", e="10 V"), l=hb.I("10 mH"), r=hb.R("1 kohm"), lc=hb.Zero(), src=hb.One(),
        a=hb.Zero(), b=hb.Zero(), p=hb.Zero(), q=hb.Zero(), load=hb.One(),
        d1=hb.One(law="diode"), d2=hb.One(law="diode"),
        d3=hb.One(law="diode"), d4=hb.One(law="diode"),
    )  # fmt: skip
    m.bond("src -> lc", "lc -> c", "lc -> l", "a -> src", "src -> b")
    m.bond("a -> d1 -> p", "b -> d2 -> p", "q -> d3 -> a", "q -> d4 -> b")
    m.bond("p -> load", "load -> r", "load -> q")
    return m


def test_the_rectifier_bridge_has_the_published_digits() -> None:
    run = step_run(bridge(), 0.005, 1e-6)
    for t, v in (
        (0.498e-3, 2.38228),
        (0.998e-3, -5.05198),
        (1.998e-3, 1.50583),
        (4.998e-3, 0.78430),
    ):
        assert float(run["c.e"].at(t)) == pytest.approx(v, abs=5.1e-6)
    w = math.sqrt(1e8 - 500.0**2)
    t = np.linspace(0.0, 0.005, 101)[:-1]
    closed = 10.0 * np.exp(-500.0 * t) * (np.cos(w * t) - 500.0 / w * np.sin(w * t))
    assert np.abs(run.sample(t, ["c.e"])["c.e"] - closed).max() < 0.02


def peak_detector(source: str, r: float = 0.0) -> hb.Model:
    m = hb.Model("peak", domain="electrical")
    m.add(u=hb.Se(source), d=hb.One(law="diode"), c=hb.C("1 F"))
    m.bond("u -> d -> c")
    if r:
        m.add(r=hb.R(r))
        m.bond("d -> r")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("theta", [0.5, 0.75, 1.0])
@pytest.mark.parametrize("h", [1e-6, 1e-3, 0.1, 1.0])
@pytest.mark.parametrize("source", ["10", "10*sin(2*time)", "3*time"])
def test_a_capacitor_behind_a_diode_follows_the_highest_voltage_so_far(
    source: str, h: float, theta: float
) -> None:
    run = step_run(peak_detector(source), 60 * h, h, theta=theta)
    t, v = ends(run, "c.e")
    given_ = {"10": 10.0 + 0 * t, "10*sin(2*time)": 10 * np.sin(2 * t), "3*time": 3 * t}[source]
    assert v == pytest.approx(np.maximum.accumulate(given_), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("h", [1e-6, 1e-2, 1.0, 30.0])
def test_it_never_overshoots_behind_a_resistor(h: float, theta: float) -> None:
    _, v = ends(step_run(peak_detector("10", 0.1), 40 * h, h, theta=theta), "c.e")
    assert (np.diff(v) >= -1e-12).all() and v.max() <= 10.0 * (1 + 1e-12)
    # implicit Euler of the linear circuit, which is what the scheme is behind a diode
    assert v == pytest.approx(10.0 * (1.0 - (1.0 + h / 0.1) ** -np.arange(len(v))), abs=1e-9)


@pytest.mark.slow
def test_dry_friction_turns_where_the_closed_form_does() -> None:
    m = hb.Model("oscillator", domain="translational")
    m.add(mass=hb.I("1 kg", f="6 m/s"), k=hb.C("1 m/N", q="12 m"))
    m.add(v=hb.One(law="coulomb", limit="1 N"))
    m.bond("v -> mass", "v -> k")
    turns = np.array([13.317821, -11.317821, 9.317821, -7.317821, 5.317821, -3.317821, 1.317821])
    errors = []
    for h in (0.04, 0.02, 0.01):
        run = step_run(m, 23.0, h)
        _, q = ends(run, "k.q")
        way = np.sign(np.where(np.abs(np.diff(q)) > 1e-12, np.diff(q), 0.0))
        top = [q[k + 1] for k in range(len(way) - 1) if way[k] * way[k + 1] < 0]
        assert len(top) == len(turns)
        errors.append(float(np.abs(np.array(top) - turns).max()))
        assert run.final["mass.f"] == 0.0 or abs(run.final["mass.f"]) < 1e-13
        assert run.final["k.q"] == pytest.approx(0.682179, abs=h)
        assert run.mode == {"v": "sticks"}
    assert errors[2] < 0.6 * errors[1] < 0.36 * errors[0] and errors[2] < 2e-3


def block(limit: str, vx: float, vy: float, height: float) -> hb.Model:
    """A block with horizontal and vertical velocity above a plane with friction."""
    m = hb.Model("block", domain="translational")
    m.add(
        mx=hb.I("2 kg", f=vx), my=hb.I("2 kg", f=vy), weight=hb.Se("-2*9.81"),
        slip=hb.One(law="coulomb", limit=limit), up=hb.One(),
        contact=hb.Zero(law="unilateral", gap="height"), floor=hb.Sf(0.0),
    )  # fmt: skip
    m.bond("slip -> mx", "weight -> up -> my", "floor -> contact -> up")
    m.signal(height=hb.Integral("up.f", start=height))
    return m


@pytest.mark.slow
def test_friction_under_a_contact_force_brakes_and_holds() -> None:
    run = step_run(block("0.3*contact.e", 3.0, 0.0, 0.0), 2.0, 1e-3)
    stop = 3.0 / (0.3 * 9.81)
    for t in (0.25, 0.5, 1.0):
        assert float(run["mx.f"].at(t)) == pytest.approx(3.0 - 0.3 * 9.81 * t, rel=1e-9)
    assert float(run["mx.f"].at(2.0)) == pytest.approx(0.0, abs=1e-12)
    event = next(e for e in run.events if e.steps[-1].mode[0] == 0 and e.t > 0)
    assert event.t0 is not None and event.t0 <= stop <= event.t
    assert run.audit().power < 1e-12


def test_friction_acts_during_an_impact() -> None:
    # in one step: normal percussion m |vy| + weight, friction mu times that (Moreau)
    h = 1e-3
    run = step_run(block("0.3*contact.e", 3.0, -1.0, 0.0), h * 5, h)
    assert float(run["my.f"].at(h)) == pytest.approx(0.0, abs=1e-12)
    start = float(run["mx.f"].at(0.0))
    assert start - float(run["mx.f"].at(h)) <= 0.3 * (1.0 + 9.81 * h) + 1e-12
    assert any("during impacts" in w for w in run.warnings)
    falling = step_run(block("0.3*contact.e", 3.0, -1.0, 0.01), 0.1, h)
    hit = next(e for e in falling.events if e.cause == "step" and e.t > 0.005)
    p = hit.before - hit.after
    normal = -p[1] + 2 * 9.81 * h
    assert p[0] == pytest.approx(0.3 * normal, rel=1e-9)


@pytest.mark.slow
def test_what_sticks_breaks_loose_at_its_breakaway_force() -> None:
    m = hb.Model("pull", domain="translational")
    m.add(mass=hb.I("1 kg"), pull=hb.Se("2*time"))
    m.add(v=hb.One(law="coulomb", limit="1 N", breakaway="1.5 N"))
    m.bond("pull -> v -> mass")
    run = step_run(m, 1.5, 1e-3)
    event = run.events[1]
    assert event.t0 is not None and event.t0 - 1e-9 <= 0.75 <= event.t
    # m v' = 2 t - 1 from 0.75 s
    assert run.final["mass.f"] == pytest.approx(1.5**2 - 1.5 - (0.75**2 - 0.75), rel=3e-3)


def test_three_balls_in_one_problem_share_the_blow() -> None:
    # one complementarity problem for both contacts: (-1/3, 2/3, 2/3), not Newton's cradle
    m = hb.Model("balls", domain="translational")
    for k, v in ((1, 1.0), (2, 0.0), (3, 0.0)):
        m.add(**{f"m{k}": hb.I(1.0, f=v), f"v{k}": hb.One()})
        m.bond(f"v{k} -> m{k}")
    m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=s) for k, s in ((1, -0.1), (2, 0), (3, 0))})
    for k, gap in ((1, "x2 - x1"), (2, "x3 - x2")):
        law = hb.Zero(law="unilateral", gap=gap, restitution=1.0)
        m.add(**{f"hit{k}": law})
        m.bond(f"hit{k} -> v{k + 1}", f"v{k} -> hit{k}")
    run = step_run(m, 0.2, 1e-3)
    assert [run.final[f"m{k}.f"] for k in (1, 2, 3)] == pytest.approx([-1 / 3, 2 / 3, 2 / 3])


@pytest.mark.slow
def test_a_thyristor_waits_for_its_gate() -> None:
    m = hb.Model("gate", domain="electrical")
    m.add(u=hb.Se("10*sin(1*time)"), r=hb.R(2.0), th=hb.One(law="thyristor", gate="time >= 1"))
    m.bond("u -> th -> r")
    for coil in (False, True):
        if coil:
            m.add(coil=hb.I("1 mH"))
            m.bond("th -> coil")
        run = step_run(m, 4.0, 1e-3)
        t, i = ends(run, "th.f")
        assert (i[t < 0.999] == 0.0).all() or np.abs(i[t < 0.999]).max() < 1e-12
        inside = (t > 1.02) & (t < 3.1)
        assert i[inside] == pytest.approx(5 * np.sin(t[inside]), abs=0.02)
        assert np.abs(i[t > 3.2]).max() < 1e-12


@pytest.mark.slow
def test_a_coil_whose_switch_opens_goes_on_through_its_diode() -> None:
    m = hb.Model("coil", domain="electrical")
    m.add(
        V=hb.Se("10 V"), R=hb.R("10 ohm"), L=hb.I("0.1 H"), drop=hb.Se("0.7 V"),
        switch=hb.One(), diode=hb.One(law="diode"), node=hb.Zero(),
    )  # fmt: skip
    m.bond("V -> switch -> node -> L", "switch -> R", "diode -> node", "diode -> drop")
    m.machine("Sw", states={"closed": ["switch"], "open": []}, start="closed",
              rules=["closed -> open when time >= 50 ms"])  # fmt: skip
    run = step_run(m, 0.3, 1e-4)
    assert float(run["L.f"].at(0.05)) == pytest.approx(0.993262, abs=1e-5)
    assert float(run["L.f"].at(0.1)) == pytest.approx(0.993262 - 7.0 * 0.05, abs=1e-4)
    assert run.final["L.f"] == pytest.approx(0.0, abs=1e-12)
    last = run.events[-1]
    assert last.t0 is not None and last.t0 <= 0.05 + 0.141895 + 1e-5 and last.t >= 0.1918


# -- energy


@st.composite
def ladders(draw: st.DrawFn) -> hb.Model:
    """A ladder of coils, capacitors, resistors and diodes, charged, without sources."""
    value = st.floats(0.2, 5.0)
    m = hb.Model("ladder", domain="electrical")
    stages = draw(st.integers(1, 3))
    m.add(n0=hb.Zero(), c0=hb.C(draw(value), e=draw(st.floats(-5, 5))))
    m.bond("n0 -> c0")
    for k in range(1, stages + 1):
        series = draw(st.sampled_from(["coil", "resistor", "plain"]))
        law = draw(st.booleans())
        m.add(**{f"s{k}": hb.One(law="diode") if law else hb.One(), f"n{k}": hb.Zero()})
        back = draw(st.booleans())
        a, b = (k, k - 1) if back else (k - 1, k)
        m.bond(f"n{a} -> s{k}", f"s{k} -> n{b}")
        if series == "coil":
            start = 0.0 if law else draw(st.floats(-2, 2))
            m.add(**{f"l{k}": hb.I(draw(value), f=start)})
            m.bond(f"s{k} -> l{k}")
        if series == "resistor" or not law:
            m.add(**{f"r{k}": hb.R(draw(value))})
            m.bond(f"s{k} -> r{k}")
        m.add(**{f"c{k}": hb.C(draw(value), e=draw(st.floats(-5, 5)))})
        m.bond(f"n{k} -> c{k}" if draw(st.booleans()) else f"c{k} -> n{k}")
    if draw(st.booleans()):
        m.add(shunt=hb.One(law="diode"))
        m.bond(f"n{stages} -> shunt" if draw(st.booleans()) else f"shunt -> n{stages}")
        m.add(rs=hb.R(draw(value)))
        m.bond("shunt -> rs")
    return m


def stored_energy(run: hb.Result) -> np.ndarray:
    """Half of k x^2 or x^2 / m of each storage, by its own value and flow or effort."""
    total = 0.0
    for s in run.graph.storages:
        other = "e" if s.kind == "C" else "f"
        name = s.path.rpartition(".")[0]
        _, x = ends(run, s.path)
        _, z = ends(run, f"{name}.{other}")
        total = total + 0.5 * x * z
    return np.asarray(total)


@pytest.mark.slow
@settings(max_examples=25)
@given(ladders(), st.floats(1e-3, 3.0))
def test_the_implicit_scheme_never_creates_energy(model: hb.Model, h: float) -> None:
    run = step_run(model, 20 * h, h, theta=1.0)
    energy = stored_energy(run)
    assert (np.diff(energy) <= 1e-12 * energy.max(initial=0.0)).all()
    assert run.audit().created <= 1e-12


@pytest.mark.slow
@settings(max_examples=8)
@given(ladders())
def test_the_middle_scheme_creates_no_more_than_its_switching_steps_explain(
    model: hb.Model,
) -> None:
    # ... which vanishes with the step: h/2 l w per step, l and w of the end and the beginning
    run = step_run(model, 1.0, 0.01, theta=0.5)
    energy = stored_energy(run)
    finer = step_run(model, 1.0, 0.0025, theta=0.5)
    rise = np.maximum(np.diff(energy), 0.0).sum()
    finer_rise = np.maximum(np.diff(stored_energy(finer)), 0.0).sum()
    top = energy.max(initial=0.0)
    assert rise <= 1e-2 * top
    assert finer_rise <= 0.4 * rise + 1e-12 * top


@pytest.mark.slow
@settings(max_examples=8)
@given(ladders())
def test_steps_and_located_events_agree(model: hb.Model) -> None:
    located = hb.simulate(model, 1.0)
    t = np.linspace(0.05, 1.0, 20)
    names = [f"{s.path}" for s in located.graph.storages]
    exact = located.sample(t, names)
    errors = []
    for h in (0.01, 0.0025):
        run = step_run(model, 1.0, h).sample(t, names)
        errors.append(max(np.abs(run[n] - exact[n]).max() for n in names))
    size = max(np.abs(exact[n]).max() for n in names)
    assert errors[1] <= 0.4 * errors[0] + 1e-7 * size
    assert errors[1] <= 0.05 * size


# -- the smooth part


@pytest.mark.slow
def test_without_switching_the_order_is_two_or_one() -> None:
    m = hb.Model("pendulum", domain="translational")
    m.add(mass=hb.I(1.0), pull=hb.Se("-9.81*sin(angle/(1 m))"), v=hb.One(), rub=hb.R(0.3))
    m.bond("pull -> v -> mass", "v -> rub")
    m.signal(angle=hb.Integral("v.f", start=2.0))
    exact = hb.simulate(m, 2.0, rtol=1e-11).final["angle"]
    for theta, order in ((0.5, 2), (1.0, 1)):
        coarse, fine = (
            abs(step_run(m, 2.0, h, theta=theta).final["angle"] - exact) for h in (4e-3, 2e-3)
        )
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.1)


@pytest.mark.slow
def test_a_nonlinear_resistor_behind_a_diode() -> None:
    m = hb.Model("valve")
    m.add(u=hb.Se("10*sin(1*time)"), d=hb.One(law="diode"), c=hb.C(1.0))
    m.add(r=hb.R({"e": "0.5*f + f^3"}), n=hb.Zero(), load=hb.R(2.0))
    m.bond("u -> d -> r", "d -> n -> c", "n -> load")
    exact = hb.simulate(m, 8.0, rtol=1e-9).sample([2.0, 4.0, 7.0, 8.0], ["c.e"])["c.e"]
    errors = [
        np.abs(step_run(m, 8.0, h).sample([2.0, 4.0, 7.0, 8.0], ["c.e"])["c.e"] - exact).max()
        for h in (0.08, 0.04)
    ]
    assert errors[1] < 0.6 * errors[0] < 0.05


def test_storage_in_derivative_causality_keeps_its_constraint() -> None:
    m = hb.Model("tied", domain="electrical")
    m.add(u=hb.Se("sin(1*time)"), c1=hb.C(1.0), c2=hb.C(2.0), n=hb.Zero(), d=hb.One(law="diode"))
    m.add(c3=hb.C(1.0), r=hb.R(1.0))
    m.bond("u -> n", "n -> c1", "n -> c2", "n -> d -> r", "d -> c3")
    t, v = ends(step_run(m, 5.0, 0.05), "c1.e")
    assert v == pytest.approx(np.sin(t), abs=1e-12)


# -- time, options, results


def test_timed_events_are_hit_and_the_last_step_is_shortened() -> None:
    m = hb.Model("pulse", domain="electrical")
    m.add(
        u=hb.Se("if time >= 0.3333 then 5 else 0"), d=hb.One(law="diode"), c=hb.C(1.0), r=hb.R(1.0)
    )
    m.bond("u -> d -> c", "d -> r")
    run = step_run(m, 0.777, 0.1)
    t, _ = ends(run, "c.e")
    assert t == pytest.approx([0, 0.1, 0.2, 0.3, 0.3333, 0.4333, 0.5333, 0.6333, 0.7333, 0.777])


def test_signals_between_points_are_linear() -> None:
    run = step_run(ball(), 1.0, 0.1)
    t = np.array([0.0, 0.025, 0.05, 0.1])
    v = run.sample(t, ["v.f", "height"])
    assert v["v.f"] == pytest.approx(-9.81 * t)
    assert v["height"][1] == pytest.approx(0.75 + 0.25 * v["height"][3])
    assert len(run["contact.e"]) >= 11 and run.names and run.to_csv
    assert run.weight("contact", "open", 0.05) == 1.0


@pytest.mark.slow
def test_the_error_estimate_is_of_the_size_of_the_error() -> None:
    located = hb.simulate(rlcd(), 0.005)
    for h in (2e-5, 5e-6):
        run = step_run(rlcd(), 0.005, h)
        true = abs(run.final["l.p"] - located.final["l.p"]) / np.abs(run["l.p"].y).max()
        assert 0.3 * true < run.stats["step_error"] < 5 * true
        assert run.stats["step_advised"] < h
    assert any("estimated error" in w for w in step_run(rlcd(), 0.005, 2e-5).warnings)


def rectifier() -> hb.Model:
    m = hb.Model("rectifier", domain="electrical")
    m.add(s=hb.Se("10 [V]*sin(6.283185307179586 [Hz]*50*time)"), d=hb.One(law="diode"))
    m.add(n=hb.Zero(), c=hb.C("1 mF"), r=hb.R("100 ohm"))
    m.bond("s -> d -> n", "n -> c", "n -> r")
    return m


@pytest.mark.parametrize(("until", "says"), [(0.06, "cannot be estimated"), (0.1, "means little")])
def test_a_run_of_few_steps_says_that_it_is_coarse(until: float, says: str) -> None:
    # steps of the period of the source: it is zero at every one of them
    run = step_run(rectifier(), until, 0.02)
    assert abs(run.final["c.e"]) < 1e-9
    (warning,) = [w for w in run.warnings if "coarse" in w]
    assert says in warning and f"only {round(until / 0.02)} steps" in warning
    assert ("step_error" in run.stats) == (until > 0.08)


@pytest.mark.parametrize("until", [0.1, 1.0])
def test_steps_of_the_period_do_not_pass_for_exact(until: float) -> None:
    run = step_run(rectifier(), until, 0.02)
    assert run.stats["step_error"] > 0.05 and run.stats["step_advised"] < 0.002
    assert any("estimated error" in w for w in run.warnings)


def test_enough_steps_are_not_called_coarse() -> None:
    run = step_run(rectifier(), 0.1, 1e-4)
    assert run.warnings == () and run.final["c.e"] > 8.0


@pytest.mark.slow
def test_a_law_of_impacts_that_is_not_its_own_is_not_ignored_silently() -> None:
    def of_impacts(run: hb.Result) -> list[str]:
        return [w for w in run.warnings if "impact = " in w]

    for law in (None, "newton_simultaneous"):
        assert of_impacts(step_run(ball(), 1.0, 5e-3, impact=law)) == []
    for law in ("newton", "poisson", "lzb_hertz"):
        (warning,) = of_impacts(step_run(ball(), 1.0, 5e-3, impact=law))
        assert repr(law) in warning and "'newton_simultaneous'" in warning
    m = ball()
    m.experiment.update(impact="poisson")
    assert len(of_impacts(step_run(m, 1.0, 5e-3))) == 1
    # what the call says replaces it
    assert of_impacts(step_run(m, 1.0, 5e-3, impact="newton_simultaneous")) == []
    with pytest.raises(UsageError) as caught:
        step_run(ball(), 1.0, 5e-3, impact="newtonian")
    assert caught.value.code == "HB-J205"


def test_options() -> None:
    for options, code in (
        ({}, "HB-S102"),
        ({"step": -1.0}, "HB-S102"),
        ({"step": 0.1, "theta": 0.4}, "HB-S112"),
        ({"step": 0.1, "theta": 1.1}, "HB-S112"),
        ({"step": 0.1, "theta": math.nan}, "HB-S112"),
    ):
        with pytest.raises(UsageError) as caught:
            hb.simulate(ball(), 1.0, solver="moreau-jean", **options)
        assert caught.value.code == code
    with pytest.raises(UsageError) as caught:
        hb.simulate(ball(), 1.0, solver="rk45", theta=0.5)
    assert caught.value.code == "HB-S112"
    m = ball()
    m.experiment.update(solver="moreau-jean", step="5 ms", theta=1.0, until="1 s")
    assert hb.simulate(m).solver == "moreau-jean"
    assert hb.simulate(m).final["height"] != step_run(ball(), 1.0, 5e-3).final["height"]


def test_sources_against_each_other_through_a_diode_have_no_step() -> None:
    m = hb.Model("short", domain="electrical")
    m.add(u=hb.Se("10*time"), d=hb.One(law="diode"), v=hb.Se(1.0))
    m.bond("u -> d -> v")
    with pytest.raises(hb.HybondError) as caught:
        step_run(m, 1.0, 0.01)
    assert caught.value.code == "HB-J120" and "d" in caught.value.why
    assert caught.value.partial.t_end == pytest.approx(0.1, abs=0.011)


# -- machines written by hand


@pytest.mark.slow
def test_a_ball_with_a_machine_of_its_own_bounces_at_step_ends() -> None:
    model = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
    located = hb.simulate(model, 3.0)
    run = step_run(model, 3.0, 1e-3)
    assert len(run.events) == len(located.events)
    for a, b in zip(run.events[1:], located.events[1:], strict=True):
        assert a.cause == "guard" and abs(a.t - b.t) < 5e-3 and a.t0 is not None
        assert [s.kind for s in a.steps] == [s.kind for s in b.steps]


@pytest.mark.slow
def test_it_says_that_such_a_machine_cannot_rest() -> None:
    run = step_run(hb.load(EXAMPLES / "bouncing_ball_newton.toml"), 20.0, 0.01)
    assert run.status == "ok" and any("at the end of every step" in w for w in run.warnings)


@pytest.mark.slow
def test_the_diode_inductor_has_its_mythical_modes_and_its_times() -> None:
    run = step_run(hb.load(EXAMPLES / "diode_inductor.toml"), 0.2, 1e-4)
    located = hb.simulate(hb.load(EXAMPLES / "diode_inductor.toml"), 0.2)
    for a, b in zip(run.events, located.events, strict=True):
        assert [s.kind for s in a.steps] == [s.kind for s in b.steps]
        assert [s.mode for s in a.steps] == [s.mode for s in b.steps]
        assert a.t == pytest.approx(b.t, abs=1.1e-4)
    with pytest.raises(hb.HybondError) as caught:
        step_run(hb.load(EXAMPLES / "diode_inductor_no_mode.toml"), 0.2, 1e-4)
    assert caught.value.code == "HB-N401"


# -- steps that Newton once gave up


def woodpecker(*, bent: bool) -> hb.Model:
    """The toy; with a spring that bends and a drag, so that its steps are not linear."""
    text = (EXAMPLES / "woodpecker.toml").read_text()
    if bent:
        for old, new in (
            ('spring = { C = "1/c",', 'spring = { C = { e = "c*(q + 2*q^3)" },'),
            ("fall   =", 'drag   = { R = { e = "1e-3*f*abs(f)" } }\nfall   ='),
            ('"fall -> y -> body.1"', '"fall -> y -> body.1", "y -> drag"'),
        ):
            assert old in text
            text = text.replace(old, new)
    return hb.loads(text)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("bent", "h"), [(False, 7e-4), (False, 4e-4), (True, 1e-3)])
def test_contacts_with_friction_converge_at_any_step(bent: bool, h: float) -> None:
    # rounding of what carries nothing is no reason to go on
    run = step_run(woodpecker(bent=bent), 0.1, h)
    assert run.status == "ok" and run.t_end == pytest.approx(0.1)
    assert run.audit().power < 1e-12
    # the beak and both edges of the sleeve strike
    assert {m for e in run.events for m in _closed(e)} == {"hit1", "hit2", "hit3"}


def _closed(event: object) -> list[str]:
    return [
        f.machine
        for s in event.steps  # type: ignore[attr-defined]
        for f in s.fired
        if f.target in ("closed", "impact")
    ]
