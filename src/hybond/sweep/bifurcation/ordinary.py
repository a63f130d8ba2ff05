"""A value as an ordinary run: where there is no library, or more to say than it keeps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybond.blocks.runners import runners_of
from hybond.engine.compiled.sections import Carry
from hybond.engine.outcome.beginnings import CHANGED, Beginning, beginning_by_name
from hybond.engine.outcome.engines import choose_engine, prepared
from hybond.engine.tables.bands import banded
from hybond.engine.tables.options import Settings
from hybond.errors import HybondError, NumericsError, UsageError
from hybond.model.graph import FlatGraph, Mode
from hybond.one_run import gone, made
from hybond.result import Result
from hybond.runs.trace import Event
from hybond.sweep.bifurcation.question import Question

Vector = NDArray[np.float64]


class Read:
    """What is kept of a run: samples, when they were taken, and the modes written since.

    Parameters
    ----------
    samples : array, shape (signals, samples)
    when : array, shape (samples + 1,)
    since : array
    modes : sequence of Mode
    carry : Carry or None
        Where it has come.
    warnings : tuple of str
    error : HybondError or None
    """

    __slots__ = ("carry", "error", "modes", "samples", "since", "warnings", "when")

    def __init__(
        self,
        samples: Vector,
        when: Vector,
        since: Vector,
        modes: list[Mode],
        carry: Carry | None = None,
        warnings: tuple[str, ...] = (),
        error: HybondError | None = None,
    ) -> None:
        self.samples, self.when, self.since, self.modes = samples, when, since, modes
        self.carry, self.warnings, self.error = carry, warnings, error


def failed(q: Question, error: HybondError, warnings: tuple[str, ...] = ()) -> Read:
    """Return what is kept of a run that has stopped."""
    none = np.zeros((len(q.of), 0))
    return Read(none, np.zeros(1), np.zeros(0), [], None, warnings, error)


def ordinary(
    q: Question,
    value: float,
    carry: Carry | None,
    settings: Settings,
    band: float | None,
    settle: int,
) -> Read:
    """Run a value, from the start of the model or from where another has come.

    Raises
    ------
    UsageError
        For what is wrong with every value.
    KeyboardInterrupt
    """
    try:
        graph = q.graph(value)
        period = q.duration(graph)
        if band is not None:
            graph = banded(graph, band)
        return _ran(q, graph, period, carry, settings, settle)
    except UsageError:
        raise
    except HybondError as error:
        return failed(q, error)


def _ran(
    q: Question,
    graph: FlatGraph,
    period: float,
    carry: Carry | None,
    settings: Settings,
    settle: int,
) -> Read:
    events = not q.period
    behind = 0.0 if carry is None else carry.counted
    begun = 0.0 if carry is None else float(carry.number[0]) if events else behind * period
    end = begun + period if events else (behind + settle + q.cut.keep) * period
    options = {name: q.options[name] for name in ("engine",) if name in q.options}
    maker = choose_engine(options.get("engine"))
    settings = replace(settings, until=max(settings.until, end))
    tables = prepared(graph, settings, maker).tables
    if carry is None:
        begin = beginning_by_name({}, graph, tables)
    else:
        number = np.array(carry.number)
        number[0] = begun
        states = len(graph.storages) + len(graph.integrals)
        begin = Beginning(number, np.array(carry.place), CHANGED, False, states)
    runners = runners_of(graph, fmus=bool(q.options.get("fmus")))
    try:
        run = made(
            graph,
            (),
            settings,
            maker,
            begin=begin,
            progress=None,
            runners=runners,
            until=end,
        )
        status, failure = gone(run, graph)
        if status == "interrupted":
            raise KeyboardInterrupt
        result = Result(graph, run.trace, status, end, settings.solver, failure)
        said = (*run.trace.warnings, *graph.warnings)
        if failure is None and status != "ok":
            failure = NumericsError(
                f"the run ended in {status} at {result.t_end:.9g} s",
                code="HB-P134",
                where=q.factor.path,
                hint="events accumulate there: see the run alone",
            )
        if failure is not None:
            return failed(q, failure, said)
        start = graph.start_mode if carry is None else tuple(carry.place[: len(graph.machines)])
        read = _read(q, result, start, (behind + settle) * period, period, settle)
        assert run.trace.carried is not None
        number, place = run.trace.carried
        read.carry = Carry(number, place, behind + settle + q.cut.keep)
        read.warnings = said
        return read
    finally:
        for runner in runners.values():
            runner.close()


def _read(q: Question, run: Result, mode: Mode, first: float, period: float, settle: int) -> Read:
    """Return samples and modes of a run."""
    keep = q.cut.keep
    if q.period:
        when: Vector = np.array(first + period * np.arange(keep + 1), dtype=float)
        times = np.array(run.trace.events.times)
        for k, t in enumerate(when[:-1]):
            near = times[np.abs(times - t) <= 1e-9 * period]
            when[k] = near[-1] if len(near) else t
        when[-1] = run.t_end
    else:
        when = np.array(_entries(q, run, mode)[settle : settle + keep + 1])
    many = max(len(when) - 1, 0)
    samples = np.zeros((len(q.of), many))
    if many:
        side: Literal["left", "right"] = "left" if q.cut.before else "right"
        values: Mapping[str, Vector] = run.sample(when[:-1].tolist(), q.of, side=side)
        samples = np.array([values[name] for name in q.of])
    since, modes = [when[0] if many else 0.0], [mode]
    for event in run.trace.events:
        for step in event.steps:
            if step.kind == "mythical":
                continue
            if many and event.t >= when[0] - (1e-9 * period if q.period else 0.0):
                since.append(event.t)
                modes.append(step.mode)
            else:
                modes[0] = step.mode
    return Read(samples, when if many else np.zeros(1), np.array(since), modes)


def _entries(q: Question, run: Result, mode: Mode) -> list[float]:
    """Return when a machine entered its state."""
    machine = run.graph.machines[q.cut.machine]
    state, found, was = q.cut.state, [], mode[q.cut.machine]
    for event in run.trace.events:
        entered, was = _enters(event, machine.path, q.cut.machine, state, machine.states, was)
        if entered:
            found.append(event.t)
    return found


def _enters(
    event: Event, path: str, machine: int, state: int, states: tuple[str, ...], was: int
) -> tuple[bool, int]:
    fires = entered = False
    for step in event.steps:
        now = step.mode[machine]
        fired = [f for f in step.fired if f.machine == path]
        if fired:
            fires = fired[-1].target == states[state]
        fires = fires or now != was
        entered = entered or (fires and step.kind != "mythical" and now == state)
        was = now
    return entered, was
