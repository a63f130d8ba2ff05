"""Inputs that are functions in Python, and blocks, called by the library while it runs."""

from __future__ import annotations

import gc
import math
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from engine.by_engine import EngineModel, EngineRun
from engine.test_native_runs import said_by
from export.programs import check, expected

import hybond as hb
from hybond.engine.compiled import answering as of_a_run
from hybond.engine.compiled.rows import Rows
from hybond.engine.compiled.sliced import OK, RAISED, REFUSED
from hybond.engine.tables import tables_of
from hybond.export.c import to_c


def native(model: hb.Model, until: float, **options: Any) -> EngineModel:
    return EngineModel(tables_of(model.flatten(), calling=True, until=until, **options))


def done(run: EngineRun) -> EngineRun:
    list(run.slices(steps=40))
    return run


def circuit(source: str = "u") -> hb.Model:
    """A capacitor charged through a resistor: q' = u - q."""
    m = hb.Model("circuit", domain="electrical")
    m.add(V=hb.Se(source), R=hb.R("1 ohm"), C=hb.C("1 F"), i=hb.One())
    m.bond("V -> i -> R", "i -> C")
    return m


def driven(u: Callable[[float], float], breaks: Sequence[float] = ()) -> hb.Model:
    m = circuit()
    m.input(u=hb.Input(function=u, breaks=breaks))
    return m


def integrated(u: Callable[[float], float], breaks: Sequence[float] = ()) -> hb.Model:
    """What an input adds up to, beside a storage that has nothing to do with it."""
    m = circuit("0")
    m.input(u=hb.Input(function=u, breaks=breaks))
    m.signal(total=hb.Integral("u"))
    return m


def same_as_by_simulate(make: Callable[[], hb.Model], until: float, **options: Any) -> hb.Result:
    """Run a model that may remember something by the library and by `simulate`."""
    run = EngineRun(native(make(), until, **options))
    rows = list(run.slices(steps=40))
    meant = hb.simulate(make(), until=until, **options)
    assert run.status == OK
    check("", said_by(run, rows), expected(meant))
    return meant


# -- inputs


def test_a_sine_is_what_the_closed_form_says() -> None:
    w, until = 3.0, 4.0
    run = done(EngineRun(native(driven(lambda t: math.sin(w * t)), until, rtol=1e-11)))
    decay = w * math.exp(-until)
    meant = (math.sin(w * until) - w * math.cos(w * until) + decay) / (1.0 + w * w)
    assert run.y == pytest.approx([meant], rel=1e-9)
    signal_itself = done(EngineRun(native(circuit("sin(3*time)"), until, rtol=1e-11)))
    assert run.y == pytest.approx(signal_itself.y, rel=1e-9)


def test_the_rate_of_a_function_reaches_a_hidden_constraint() -> None:
    """A capacitor right at the source: its current is C u'."""
    m = hb.Model("hidden", domain="electrical")
    m.add(V=hb.Se("u"), n=hb.Zero(), C=hb.C("2 F"))
    m.bond("V -> n -> C")
    m.input(u=lambda t: math.sin(t))
    m.signal(charge=hb.Integral("C.f"))
    run = done(EngineRun(native(m, 2.0, rtol=1e-10)))
    assert run.y == pytest.approx([2.0 * math.sin(2.0)] * 2, rel=1e-7)


def test_pieces_are_joined_at_breaks_exactly() -> None:
    def u(t: float) -> float:
        return t if t < 1.0 else 5.0 if t < 2.5 else -t

    def make() -> hb.Model:
        m = integrated(u, breaks=[2.5, 1.0])
        m.add(tap=hb.One(), load=hb.R("3 ohm"), node=hb.Zero())
        m.bond("node -> tap -> load", "i -> node")
        rules = ["low -> high when u > 3", "high -> low when u < 0"]
        m.machine("w", states={"low": [], "high": ["tap"]}, start="low", rules=rules)
        return m

    run = EngineRun(native(make(), 4.0))
    instants = [t for rows in run.slices() for t, *_ in rows.instant_time]
    assert instants == [0.0, 1.0, 2.5]
    assert run.y[1] == pytest.approx(0.5 + 7.5 - (16.0 - 6.25) / 2.0, rel=1e-12)
    meant = same_as_by_simulate(make, 4.0)
    assert [e.cause for e in meant.events] == ["start", "input", "input"]


def test_a_function_is_not_asked_twice_for_an_instant() -> None:
    asked: list[float] = []

    def u(t: float) -> float:
        asked.append(t)
        return math.cos(t)

    model = native(integrated(u, breaks=[1.5]), 3.0, rtol=1e-10)
    asked.clear()  # making tables looks at the start
    run = done(EngineRun(model))
    assert run.y[1] == pytest.approx(math.sin(3.0), rel=1e-8)
    assert len(asked) > 20
    assert all(a != b for a, b in pairwise(asked))
    assert math.nextafter(1.5, 0.0) in asked and 1.5 in asked


def test_a_function_drives_a_bridge_of_diodes() -> None:
    def make() -> hb.Model:
        m = hb.load("examples/diode_bridge.toml")
        m.add(pump=hb.Sf("u"))
        m.bond("pump -> osc")
        step = 2e-3
        m.input(
            u=hb.Input(
                function=lambda t: 0.05 * math.sin(9e3 * t) if t < step else -0.02, breaks=[step]
            )
        )
        return m

    meant = same_as_by_simulate(make, 5e-3, rtol=1e-10)
    assert len(meant.events) > 8


def test_a_function_makes_a_guard_true() -> None:
    def make() -> hb.Model:
        m = driven(lambda t: math.sin(t))
        m.add(tap=hb.One(), load=hb.R("0.5 ohm"), node=hb.Zero())
        m.bond("node -> tap -> load", "i -> node")
        rules = ["off -> on when u > 0.5", "on -> off when u < -0.5"]
        m.machine("w", states={"off": [], "on": ["tap"]}, start="off", rules=rules)
        return m

    meant = same_as_by_simulate(make, 10.0)
    times = [math.pi / 6, 7 * math.pi / 6, 13 * math.pi / 6, 19 * math.pi / 6]
    assert [e.t for e in meant.events[1:]] == pytest.approx([t for t in times if t < 10.0])
    run = EngineRun(native(make(), 10.0))
    instants = [t for rows in run.slices() for t, *_ in rows.instant_time]
    assert instants[1:] == pytest.approx([t for t in times if t < 10.0], rel=1e-12)


# -- blocks


def flywheel() -> hb.Model:
    m = hb.Model("flywheel", domain="rotational")
    m.add(J=hb.I("0.5 kg*m^2"), B=hb.R("0.1 N*m*s/rad"), torque=hb.Se("ctl.u"), w=hb.One())
    m.bond("torque -> w -> J", "w -> B")
    return m


def controlled() -> hb.Model:
    """A speed held by a controller that remembers, and a brake that a relay on its output sets."""
    state = {"sum": 0.0, "turns": 0.0}

    def control(t: float, u: dict[str, float]) -> dict[str, float]:
        error = (3.0 if t < 1.0 else 1.0) - u["speed"]
        state["sum"] += 0.05 * error
        state["turns"] += 1.0
        return {"u": 2.0 * error + 4.0 * state["sum"], "turns": state["turns"]}

    m = flywheel()
    m.block(
        ctl=hb.Block(control, inputs={"speed": "w.f"}, outputs=["u", "turns"], every="50 ms"),
        late=hb.Block(
            lambda t, u: {"seen": u["turns"] + 0.25},
            inputs={"turns": "ctl.turns"},
            outputs=["seen"],
            every="50 ms",
            phase="100 ms",
        ),
    )
    m.signal(held=hb.Sampled("w.f", every="30 ms"))
    m.add(brake=hb.Zero(), D=hb.G("2 rad/(N*m*s)"))
    m.bond("w -> brake -> D")
    rules = [
        "free -> held_back when ctl.u < -1 and w.f > 1.5 [1/s]",
        "held_back -> free when w.f < 1.2 [1/s]",
    ]
    m.machine("relay", states={"free": [], "held_back": ["brake"]}, start="free", rules=rules)
    return m


def test_a_block_controls_a_plant_as_by_simulate() -> None:
    meant = same_as_by_simulate(controlled, 2.0)
    assert meant["ctl.turns"].at(1.99) == 40.0
    # what another block reads is what was there before the instant
    assert meant["late.seen"].at(1.99) == 39.25
    assert {"sample", "guard"} <= {e.cause for e in meant.events}


def test_a_block_is_called_once_an_instant_and_not_at_the_end() -> None:
    calls: list[tuple[float, float]] = []

    def seen(t: float, u: dict[str, float]) -> dict[str, float]:
        calls.append((t, u["now"]))
        return {"u": 1.0}

    m = flywheel()
    m.block(ctl=hb.Block(seen, inputs={"now": "time"}, outputs=["u"], every=0.25))
    run = done(EngineRun(native(m, 1.0)))
    assert run.status == OK
    assert calls == [(t, t) for t in (0.0, 0.25, 0.5, 0.75)]


# -- what is raised


def until_two(t: float) -> float:
    if t > 2.0:
        raise ValueError("no input beyond 2 s")
    return 1.0


@pytest.mark.parametrize("error", [ValueError("x"), KeyboardInterrupt(), SystemExit(3)])
def test_what_an_input_raises_ends_the_run_which_keeps_its_rows(
    error: BaseException, capfd: pytest.CaptureFixture[str]
) -> None:
    def u(t: float) -> float:
        if t > 2.0:
            raise error
        return 1.0

    run = EngineRun(native(driven(u), 9.0))
    kept: list[Rows] = []
    with pytest.raises(type(error)) as caught:
        for rows in run.slices(steps=7):
            kept.append(rows)
    assert caught.value is error and run.error is error
    assert run.status == RAISED and run.t <= 2.0
    assert kept[0].instant_time[0, 0] == 0.0
    assert 1.0 < kept[-1].step_time[-1, 2] == run.t
    assert run.y == pytest.approx([1.0 - math.exp(-run.t)], rel=1e-7)
    with pytest.raises(type(error)):
        list(run.slices())
    assert capfd.readouterr().err == ""


def test_simulate_raises_the_same() -> None:
    with pytest.raises(ValueError, match="no input beyond"):
        hb.simulate(driven(until_two), until=9.0)
    with pytest.raises(ValueError, match="no input beyond"):
        done(EngineRun(native(driven(until_two), 9.0)))


def failing(t: float, u: dict[str, float]) -> dict[str, float]:
    return {"u": 1.0 / (0.5 - t)}


def test_a_block_that_fails_is_told_as_by_simulate() -> None:
    m = flywheel()
    m.block(ctl=hb.Block(failing, inputs={}, outputs=["u"], every=0.25))
    said = []
    for run in (lambda: hb.simulate(m, until=1.0), lambda: done(EngineRun(native(m, 1.0)))):
        with pytest.raises(hb.NumericsError) as caught:
            run()
        said.append((caught.value.code, str(caught.value)))
    assert said[0] == said[1]
    assert said[0][0] == "HB-N306"


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_block_without_a_value_stops_the_run(value: float) -> None:
    m = flywheel()
    m.block(ctl=hb.Block(lambda t, u: {"u": value}, inputs={}, outputs=["u"], every=0.25))
    run = done(EngineRun(native(m, 1.0)))
    assert (run.status, run.fault.code, run.fault.place) == (REFUSED, "HB-N305", "ctl.u")
    assert hb.simulate(m, until=1.0, on_error="return").error.code == "HB-N305"


@pytest.mark.skipif(sys.platform == "win32", reason="no timers")
@pytest.mark.sampled(2)
@pytest.mark.parametrize("after", np.linspace(1e-3, 6e-3, 12).tolist())
def test_an_interrupt_between_two_calls_is_not_lost(
    after: float, capfd: pytest.CaptureFixture[str]
) -> None:
    """It comes at any instant: while the library runs, and where it calls back."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    run = EngineRun(native(driven(math.sin), 1e7))
    # what is raised while others' remains are collected is lost wherever it comes from
    gc.collect()
    gc.disable()
    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, after)
            list(run.slices(steps=-1))
    finally:
        signal.signal(signal.SIGALRM, before)
        gc.enable()
    assert capfd.readouterr().err == ""


# -- whose runners


class Gain:
    """Sets a multiple of what it read last, of one run and in one thread."""

    def __init__(self, gain: float) -> None:
        self.gain, self.last, self.closed = gain, 0.0, 0
        self.threads: set[int] = set()

    def step(self, t: float, values: Sequence[float]) -> list[float]:
        self.threads.add(threading.get_ident())
        found = self.gain * (3.0 - self.last)
        self.last = values[0]
        return [found]

    def close(self) -> None:
        self.closed += 1


def test_runs_on_one_model_in_threads_keep_their_own_runners() -> None:
    m = flywheel()
    m.block(ctl=hb.Block(failing, inputs={"speed": "w.f"}, outputs=["u"], every="1 ms"))
    m.input(wind=hb.Input(function=lambda t: 0.1 * math.sin(9.0 * t)))
    m.signal(path=hb.Integral("wind"))
    model = native(m, 1.0)
    alone = [done(EngineRun(model, runners={"ctl": Gain(g)})).y for g in (1.0, 2.0)]
    assert not np.array_equal(alone[0], alone[1])
    gains = [Gain(g) for g in (1.0, 2.0)]
    runs = [EngineRun(model, runners={"ctl": gain}) for gain in gains]
    threads = [threading.Thread(target=done, args=(run,)) for run in runs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for run, y, gain in zip(runs, alone, gains):
        assert run.status == OK and np.array_equal(run.y, y)
        assert len(gain.threads) == 1
        assert gain.closed == 0  # by who has made it


def test_a_run_closes_what_it_made_where_it_ends_or_is_dropped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gains: list[Gain] = []

    def made(graph: object, *, fmus: bool) -> dict[str, Gain]:
        gains.append(Gain(1.0))
        return {"ctl": gains[-1]}

    monkeypatch.setattr(of_a_run, "runners_of", made)
    m = flywheel()
    m.block(ctl=hb.Block(failing, inputs={"speed": "w.f"}, outputs=["u"], every="1 ms"))
    model = native(m, 1.0)
    ended = done(EngineRun(model))
    assert gains[0].closed == 1
    del ended
    left = EngineRun(model)
    next(left.slices(steps=5))
    assert gains[1].closed == 0
    del left
    assert [g.closed for g in gains] == [1, 1]


# -- exports


@pytest.mark.parametrize("where", ["inputs.u", "blocks.ctl"])
def test_exports_refuse_what_a_run_calls(where: str) -> None:
    m = driven(math.sin)
    if where == "blocks.ctl":
        m = flywheel()
        m.block(ctl=hb.Block(failing, inputs={}, outputs=["u"], every=0.25))
    unsaid = [lambda to=to: hb.export(m, to=to) for to in ("c", "java", "fmu")]  # no end of the run
    for refused in (
        lambda: tables_of(m.flatten(), until=1.0),
        lambda: to_c(m, until=1.0),
        *unsaid,
    ):
        with pytest.raises(hb.ModelError) as caught:
            refused()
        assert (caught.value.code, caught.value.where) == ("HB-E630", where)
