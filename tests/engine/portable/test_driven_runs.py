"""Runs that somebody else drives, and sampled signals, in the exported runtime."""

import numpy as np
import pytest
from portable_runs import assert_the_same

import hybond as hb
from hybond.engine.engine import OK, make_engine
from hybond.engine.run import run_records, unit
from hybond.engine.run.log import make_report
from hybond.engine.tables import answered, tables_of


def loop() -> hb.Model:
    """A flywheel whose speed a sampled PI controller holds, with a relay that reads a sample."""
    m = hb.Model("loop", domain="rotational")
    m.parameter(T="2 ms", kp="0.4 N*m*s/rad", ki="30 N*m/rad")
    m.add(J=hb.I("0.01 kg*m^2"), B=hb.R("0.02 N*m*s/rad"), D=hb.G("5 rad/(N*m*s)"))
    m.add(u=hb.Se("torque"), w=hb.One(), brake=hb.Zero())
    m.bond("u -> w -> J", "w -> B", "w -> brake -> D")
    m.input(ref=hb.Input(table=[(0, 10), ("51 ms", 5)]))
    m.signal(
        error="ref - w.f",
        torque=hb.Sampled("kp*error + ki*sum", every="T"),
        sum=hb.Sampled("sum + T*error", every="T", start=0.05),
        seen=hb.Sampled("w.f", every="7 ms", phase="1 ms"),
    )
    m.machine(
        "guardian",
        states={"free": [], "braking": ["brake"]},
        start="free",
        rules=["free -> braking when seen > 8", "braking -> free when seen < 6"],
    )
    return m


def test_samples_are_events_of_the_engine_as_python(monkeypatch: pytest.MonkeyPatch) -> None:
    run, _ = assert_the_same(loop(), monkeypatch, until="0.1 s")
    assert "sample" in {event.cause for event in run.events}


def begun(model: hb.Model, until: float):
    e = make_engine(answered(tables_of(model.flatten(), until=until)))
    r = run_records.make_run(e, make_report(e))
    assert unit.begin_unit(e, r) == OK
    return e, r


def driven(model: hb.Model, until: float, pieces: int) -> np.ndarray:
    e, r = begun(model, until)
    for k in range(1, pieces + 1):
        assert unit.advance(e, r, until * k / pieces) == OK
    assert e.t == until
    return np.array(e.y)


@pytest.mark.parametrize("shape", ["sign(time - 1 [s])", "ceil(time/(1 s))", "floor(time/(1 s))"])
def test_a_source_that_jumps_where_pieces_meet_does_so_once(shape: str) -> None:
    """The body follows its source; the other one's momentum is the integral of its force."""
    m = hb.Model("met", domain="translational")
    m.add(s=hb.Sf(f"({shape})*1 [m/s]"), tied=hb.I("2 kg"), v=hb.One())
    m.add(push=hb.Se(f"({shape})*1 [N]"), free=hb.I("1 kg"), w=hb.One())
    m.bond("s -> v -> tied", "push -> w -> free")
    tied, free = driven(m, 1.5, 3)
    before, after = (
        (-1.0, 1.0) if "sign" in shape else (1.0, 2.0) if "ceil" in shape else (0.0, 1.0)
    )
    assert tied == pytest.approx(2.0 * after, rel=1e-12)
    assert free == pytest.approx(before + 0.5 * after, abs=1e-9)


@pytest.mark.parametrize("name", ["bouncing_ball_newton", "half_bridge"])
def test_a_run_in_pieces_is_the_run(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model = hb.load(f"examples/{name}.toml")
    until = {"bouncing_ball_newton": 3.0, "half_bridge": 1e-4}[name]
    whole = hb.simulate(model, until=until, rtol=1e-10)
    state = driven(model, until, 7)
    n = len(state)
    last = np.asarray(whole.trace.segments[-1].y)[-1][:n]
    assert state == pytest.approx(last, rel=1e-6, abs=1e-8 * np.abs(last).max())


def test_instants_that_are_one_but_for_rounding_are_one() -> None:
    m = hb.Model("chain")
    m.add(V=hb.Se("wave"), R=hb.R(1), i=hb.One(), C=hb.C(1))
    m.bond("V -> i -> R", "i -> C")
    m.input(wave=hb.Input(pwm={"period": "1 ms", "duty": 0.3}))
    m.signal(
        read=hb.Sampled("time/(1 ms)", every="1 ms"),
        late=hb.Sampled("read", every="1 ms", phase="1 ms"),
        edge=hb.Sampled("V.e", every="0.1 ms"),
    )
    e, r = begun(m, 1.0)
    for k in range(300):
        assert unit.advance(e, r, (k + 0.5) * 1e-4) == OK
        late, edge = e.y[2], e.y[3]
        assert late == pytest.approx(max(k // 10 - 1, 0), abs=1e-9)
        assert edge == (1.0 if k % 10 in (1, 2, 3) or k == 0 else 0.0)


def pulled() -> hb.Model:
    """A block that a spring pulls ever more, until friction of 10 N lets go."""
    m = hb.Model("pulled", domain="translational")
    m.add(block=hb.I("2 kg"), spring=hb.C("0.01 m/N"), pull=hb.Sf("0.1 m/s"))
    m.add(rub=hb.One(law="coulomb", limit="6 N", breakaway="10 N"), v=hb.One(), line=hb.Zero())
    m.bond("pull -> line -> v -> block", "line -> spring", "v -> rub")
    return m


@pytest.mark.parametrize("excess", [1e-15, 1e-14, 1e-13, 1e-12, 1e-9])
def test_a_guard_acts_where_an_importer_finds_it(excess: float) -> None:
    """A root is found to rounding; what laws decide takes more than that."""
    e, r = begun(pulled(), 4.0)
    indicators = [0.0] * unit.indicators_of(e)
    e.t = 1.0
    e.y[1] = 0.1  # at its bound, neither beyond it nor at rest
    assert unit.indicators_now(e, indicators) == OK
    assert min(map(abs, indicators)) > 0.0
    before = [z > 0.0 for z in indicators]
    e.t = 1.0 + excess
    e.y[1] = 0.1 + 0.1 * excess
    assert unit.indicators_now(e, indicators) == OK
    crossed = [z > 0.0 for z in indicators] != before
    assert crossed is (e.y[1] > 0.1)
    held = list(e.state)
    assert unit.settle_unit(e, r) == OK
    assert (list(e.state) != held) is crossed
    assert e.t == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize("excess", [0.0, 1e-16, 1e-13, 1e-9, 1e-3])
@pytest.mark.parametrize("shape", ["if x < 1.5 then y else y + 1", "if x <= 1.5 then y else y + 1"])
def test_a_closed_contact_lets_go_where_an_importer_finds_its_gap_jump(shape, excess) -> None:
    """A block at 3 m/s leaves a table; no guard of it is about to hold, and no step is known."""
    m = hb.Model("edge", domain="translational")
    m.add(vx=hb.One(), mx=hb.I(1.0, f=3.0), vy=hb.One(), my=hb.I(1.0), w=hb.Se(-10.0))
    m.add(floor=hb.Zero(law="unilateral", gap=shape))
    m.bond("vx -> mx", "w -> vy -> my", "floor -> vy")
    m.signal(x=hb.Integral("vx.f"), y=hb.Integral("vy.f"))
    e, r = begun(m, 2.0)
    rate = [0.0] * e.states
    assert unit.rates_now(e, rate) == OK
    indicators = [0.0] * unit.indicators_of(e)
    sides = []
    for at in (0.3, 0.5 + excess):
        for k, speed in enumerate(rate):
            e.y[k] += speed * (at - e.t)
        e.t = at
        assert unit.indicators_now(e, indicators) == OK
        sides.append([z > 0.0 for z in indicators])
    assert sides[0] != sides[1]
    held = list(e.state)
    assert unit.settle_unit(e, r) == OK
    assert list(e.state) != held
    assert unit.rates_now(e, rate) == OK
    assert sorted(rate) == pytest.approx([-10.0, 0.0, 0.0, 3.0], abs=1e-8)


def test_states_are_measured_by_what_they_store() -> None:
    m = hb.Model("small")
    m.add(V=hb.Se(1), i=hb.One(), R=hb.R(1), C=hb.C("2 uF"), L=hb.I("3 mH"), M=hb.I("7 H"))
    m.bond("V -> i -> R", "i -> C", "i -> L", "i -> M")
    m.signal(total=hb.Integral("i.f"))
    e, _ = begun(m, 1.0)
    found = [unit.nominal_now(e, k) for k in range(4)]
    assert found == pytest.approx([2e-6, 3e-3, 1.0, 1.0])
