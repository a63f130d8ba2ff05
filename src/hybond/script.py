"""Runs by a script: step after step, each with what is set at its beginning and what ends it."""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hybond.blocks.runners import runners_of
from hybond.engine.outcome.audit import Audit
from hybond.engine.outcome.beginnings import CHANGED, GOES_ON, Beginning, beginning_by_name
from hybond.engine.outcome.engine_run import EngineRun
from hybond.engine.outcome.engines import choose_engine, prepared
from hybond.engine.outcome.signals import Signals
from hybond.engine.outcome.steps_run import StepsRun
from hybond.engine.tables.bands import banded
from hybond.engine.tables.options import settings_of
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.expressions import Expr
from hybond.model.given import check_model
from hybond.model.graph import FlatGraph
from hybond.model.kept import kept_graph, kind_of
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.progress import Asked, shown
from hybond.result import Result, Status, read_name
from hybond.run_ends import ended
from hybond.run_options import STEPPING, seconds_of, time_in
from hybond.script_steps import Step, conditions_of, latest_end, steps_of, unrolled
from hybond.simulation import Start, begun, notices
from hybond.states import State, load_state
from hybond.trace import Event, Segment, Trace
from hybond.trace import Step as Visit

Vector = NDArray[np.float64]
STARTS = ("start", "p", "q", "e", "f")
"""How paths end that say where a model begins."""


@dataclass(frozen=True, slots=True)
class Done:
    """A step that was done.

    Parameters
    ----------
    label : str
    t0, t1 : float
        s.
    ended_by : str
        A condition as written, ``"time"``, or the status of a run that stopped.
    set : mapping
        What was set at its beginning.
    """

    label: str
    t0: float
    t1: float
    ended_by: str
    set: Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Part:
    """The run of one step: its model, what it wrote down."""

    graph: FlatGraph
    trace: Trace
    signals: Signals


class ScriptResult(Result):
    """The run of a script: one `Result`, in which every step has the parameters it had.

    Attributes
    ----------
    steps : tuple of Done
    marks : tuple of (float, str)
        When steps begin, s, and their labels.
    """

    def __init__(
        self,
        graph: FlatGraph,
        parts: Sequence[Part],
        done: Sequence[Done],
        status: Status,
        until: float,
        solver: str,
        error: HybondError | None,
    ) -> None:
        self.parts = tuple(parts)
        self.steps = tuple(done)
        super().__init__(graph, joined(parts, done), status, until, solver, error)
        self.marks = tuple((d.t0, d.label) for d in done if d.label)
        self._first = np.cumsum([0, *(len(p.trace.segments) for p in parts)])
        self._read: dict[tuple[int, str], Expr] = {}

    @cached_property
    def signals(self) -> Signals:
        """What tells the signals of the last step."""
        return self.parts[-1].signals

    def part_of(self, segment: int) -> int:
        """Return in which step a segment lies, by their numbers."""
        return int(bisect.bisect_right(self._first.tolist(), segment)) - 1

    def _of(
        self, names: Iterable[str], which: Sequence[int] | NDArray[np.intp], t: Vector
    ) -> list[Vector]:
        asked = list(names)
        segments = np.asarray(which, dtype=np.intp)
        found = [np.zeros(len(t)) for _ in asked]
        for k, part in enumerate(self.parts):
            first, beyond = self._first[k], self._first[k + 1]
            places = np.flatnonzero((segments >= first) & (segments < beyond))
            if not len(places):
                continue
            read = part.signals.of_points(
                part.trace.segments,
                segments[places] - first,
                t[places],
                [self._expression_in(k, name) for name in asked],
            )
            for row, values in zip(found, read, strict=True):
                row[places] = values
        return found

    def _expression_in(self, k: int, name: str) -> Expr:
        if (k, name) not in self._read:
            self._read[k, name] = read_name(self.parts[k].graph, name)
        return self._read[k, name]

    def _after_last_event(self, names: Sequence[str]) -> dict[str, float]:
        event = self.trace.events[-1]
        last = len(self.parts) - 1
        expressions = [self._expression_in(last, n) for n in names]
        found = self.signals.after(event.t, event.after, event.steps[-1].mode, expressions)
        return dict(zip(names, found, strict=True))

    def weight(
        self, machine: str, state: str, t: float, *, side: Literal["left", "right"] = "right"
    ) -> float:
        """Return the part of the time that a machine spends in a state at `t`."""
        self.sample([t], [], side=side)
        return self._alone(self.part_of(self._segment_at(t, side))).weight(
            machine, state, t, side=side
        )

    def energies(self, segment: Segment) -> Vector:
        """Return energy supplied and dissipated within a segment, as `Result.energies`."""
        times = self.trace.segments.times
        at = bisect.bisect_right(times, float(segment.t[0])) - 1
        k = self.part_of(at)
        part = self.parts[k]
        return part.signals.energies(part.trace.segments[at - int(self._first[k])])

    def audit(self) -> Audit:
        """Return the worst imbalance of power and energy over all steps."""
        found = [self._alone(k).audit() for k, p in enumerate(self.parts) if p.trace.segments]
        if not found:
            return Audit(0.0, 0.0, 0.0)
        return Audit(
            max(a.power for a in found),
            max(a.energy for a in found),
            max(a.created for a in found),
            max(a.accuracy for a in found),
            tuple(law for a in found for law in a.laws),
        )

    def state(self, t: float | str | None = None) -> State:
        """Return the state at a time, or at the end, as `Result.state`."""
        asked = seconds_of(t, "t")
        if asked is None or not self.parts:
            return self._alone(len(self.parts) - 1).state()
        begins = [p.trace.begin for p in self.parts]
        return self._alone(max(bisect.bisect_right(begins, asked) - 1, 0)).state(asked)

    def _alone(self, k: int) -> Result:
        part = self.parts[k]
        return Result(part.graph, part.trace, self.status, self.until, self.solver, None)


def joined(parts: Sequence[Part], done: Sequence[Done]) -> Trace:
    """Return what the runs of all steps wrote down, as one; labels stand at their events."""
    whole = Trace()
    whole.begin = parts[0].trace.begin if parts else 0.0
    for k, (part, step) in enumerate(zip(parts, done, strict=True)):
        own = part.trace
        before = len(whole.slidings)
        whole.segments.extend(own.segments.times, _moved(own, before))
        events = list(own.events)
        if k == 0 and events and step.label:
            events[0] = replace(events[0], label=step.label)
        elif k:
            if not events or events[0].cause != "change" or events[0].t != step.t0:
                events.insert(0, _begin(part, parts[k - 1]))
            events[0] = replace(events[0], label=step.label)
        for event in events:
            whole.events.append(event)
        whole.slidings += own.slidings
        whole.accumulations += own.accumulations
        whole.turns += own.turns
        whole.unsound += own.unsound
        for text in own.warnings:
            whole.warn(text)
        for name, value in own.stats.items():
            most = name in ("step_error", "step_advised")
            whole.stats[name] = max(whole.stats.get(name, 0.0), value) if most else (
                whole.stats.get(name, 0.0) + value
            )
        whole.energy = max(whole.energy, own.energy)
        whole.engine, whole.method = own.engine, own.method
        whole.ended_by, whole.signals, whole.carried = own.ended_by, own.signals, own.carried
    whole.stats["events"] = float(len(whole.events))
    return whole


def _moved(own: Trace, before: int) -> Any:
    """Return what makes the segments of a step, with the number of their sliding in all steps."""

    def make(k: int) -> Segment:
        segment = own.segments[k]
        if segment.sliding is None or not before:
            return segment
        return replace(segment, sliding=segment.sliding + before)

    return make


def _begin(part: Part, last: Part) -> Event:
    """Return the event of a step at which nothing was set: it begins there, and nothing happens."""
    carried = last.trace.carried
    assert carried is not None
    n = len(part.graph.storages) + len(part.graph.integrals)
    many = len(part.graph.machines)
    y = carried[0][1 : 1 + n]
    mode = tuple(carried[1][:many].tolist())
    landed = carried[1][many : 2 * many].tolist()
    at_rest = tuple(m.path for m, k in zip(part.graph.machines, landed, strict=True) if k >= 0)
    visit = Visit(mode, "continuous", (), {}, None)
    return Event(part.trace.begin, "change", (visit,), y, y, at_rest)


def run_script(
    model: Model,
    steps: Sequence[Step | Mapping[str, Any]] | None = None,
    *,
    limit: float | str | None = None,
    start: Start = None,
    parameters: Mapping[str, Value] | None = None,
    progress: Asked = None,
    on_error: Literal["raise", "return"] = "raise",
    engine: Literal["library", "python"] | None = None,
    fmus: bool = False,
    **options: Any,
) -> ScriptResult:
    """Run a model by a script, as on a test rig; return one run.

    Each step sets parameters, values of elements and inputs, which stay so from then on, and ends
    at a time, after a while, or where a condition holds. The model stays what it is: what would
    make other parts of it is refused.

    Parameters
    ----------
    model : Model
    steps : sequence of Step
        Or tables with the same words; by default those of the experiment, `script`.
    limit : float or str
        When the script ends at the latest, s or a quantity; by default when the experiment does. A
        step that ends where a condition holds, and says no time, has until then.
    start : Result, State, mapping, str or Path
        Where it begins, as for `simulate`.
    parameters : mapping
        Values by dotted path that replace the model's own.
    progress, on_error, engine, fmus
        As for `simulate`.
    **options
        `solver`, `rtol`, `atol`, `step`, `max_step`, `theta`, `sliding`, `hysteresis`, `impact`,
        `max_events`, `max_steps`, as for `simulate`.

    Returns
    -------
    ScriptResult
        Its events have the labels of steps; `steps` says when each began and what ended it.

    Raises
    ------
    UsageError
        HB-S140 for a script that makes no sense, HB-S141 for what a step cannot set, HB-S132 for
        one that may not end.
    HybondError
        As `simulate`.

    Examples
    --------
    A capacitor is charged until it has 8 V, and rests for a second.

    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"V": "10 V"})
    >>> m.add(U=hb.Se("V"), R=hb.R("1 kohm"), C=hb.C("1 mF"), i=hb.One())
    >>> m.bond("U -> i -> R", "i -> C")
    >>> charge = hb.Step(until="C.e > 8", label="charge")
    >>> run = hb.run_script(m, [charge, hb.Step(lasts="1 s", set={"V": "8 V"})], limit="10 s")
    >>> [(step.ended_by, round(step.t1, 6)) for step in run.steps]
    [('C.e > 8', 1.609438), ('time', 2.609438)]
    """
    check_model(model)
    base = kept_graph(model, parameters or {})
    script = steps_of(base.experiment.get("script") if steps is None else steps)
    todo = list(unrolled(script))
    own = {**base.experiment, "until": time_in(base.experiment.get("until"))}
    bound = seconds_of(limit if limit is not None else own["until"], "limit")
    if isinstance(start, str):
        start = load_state(start)
    latest = _latest(todo, bound, start)
    if own["until"] is None:
        own.pop("until")
    settings, band = settings_of(own, latest, **options)
    writes = _Writing(model, base, parameters or {}, todo)
    maker = choose_engine(engine)
    first = base if band is None else banded(base, band)
    given = start if start is not None else base.experiment.get("start")
    begin, settings = begun(given, first, settings, maker)
    if begin is None:
        begin = beginning_by_name({}, first, prepared(first, settings, maker).tables)
    runners = runners_of(base, fmus=fmus)
    parts: list[Part] = []
    done: list[Done] = []
    status: Status = "ok"
    failure: HybondError | None = None
    try:
        with shown(progress, latest) as shows:
            for k, step in enumerate(todo):
                graph = writes.graph(step)
                if band is not None:
                    graph = banded(graph, band)
                end = latest_end(step, begin.t, bound)
                assert end is not None
                if end <= begin.t:
                    raise UsageError(
                        f"step {k + 1} begins at {begin.t:.9g} s and ends at {end:.9g} s",
                        code="HB-S140",
                        where=f"steps[{k}].until",
                        hint="until is a time since the start of the run; lasts is how long",
                    )
                runs_with = ended(graph, conditions_of(step))
                plain = prepared(graph, settings, maker)
                run: EngineRun | StepsRun
                if settings.solver in STEPPING:
                    run = StepsRun(
                        runs_with, settings, maker, progress=shows, runners=runners,
                        begin=begin, until=end, shown=plain,
                    )  # fmt: skip
                else:
                    run = EngineRun(
                        prepared(runs_with, settings, maker), progress=shows, runners=runners,
                        begin=begin, until=end, shown=plain,
                    )  # fmt: skip
                run.trace.engine = maker.said
                assert isinstance(run.trace.signals, Signals)
                parts.append(Part(graph, run.trace, run.trace.signals))
                status, failure = _went(run, graph)
                done.append(_done(step, run.trace, begin.t, status))
                if status != "ok" or run.trace.carried is None:
                    break
                if run.trace.ended_by == "" and _is_last_chance(step, end, bound):
                    if k + 1 < len(todo):
                        run.trace.warn(_over(k, step, end, len(todo)))
                    break
                changes = k + 1 < len(todo) and bool(todo[k + 1].set)
                begin = _next(run.trace, graph, changes=changes)
    finally:
        for runner in runners.values():
            runner.close()
    for text in notices(base, settings, options.get("impact")):
        parts[0].trace.warn(text)
    for warning in base.warnings:
        parts[0].trace.warn(warning)
    result = ScriptResult(base, parts, done, status, latest, settings.solver, failure)
    if failure is not None and on_error == "raise":
        failure.partial = result
        raise failure
    return result


def _went(run: EngineRun | StepsRun, graph: FlatGraph) -> tuple[Status, HybondError | None]:
    try:
        stopped = run.run() == "accumulation"
    except KeyboardInterrupt:
        return "interrupted", None
    except HybondError as error:
        return "error", graph.locate(error) if graph.locate is not None else error
    if run.trace.unsound:
        from hybond.engine.outcome.unsound import unsound_refusal

        reached = run.trace.segments[-1].t[-1] if run.trace.segments else run.trace.begin
        return "unsound", unsound_refusal(run.trace.unsound, float(reached))
    return ("accumulation" if stopped else "ok"), None


def _done(step: Step, trace: Trace, t0: float, status: Status) -> Done:
    t1 = float(trace.segments[-1].t[-1]) if trace.segments else t0
    ended_by = trace.ended_by or ("time" if status == "ok" else status)
    return Done(step.label, t0, t1, ended_by, dict(step.set))


def _next(trace: Trace, graph: FlatGraph, *, changes: bool) -> Beginning:
    """Return how the step after this one begins: with something set, or as if nothing was."""
    assert trace.carried is not None
    number, place = trace.carried
    n = len(graph.storages) + len(graph.integrals)
    return Beginning(number, place, CHANGED if changes else GOES_ON, True, n)


def _latest(steps: Sequence[Step], bound: float | None, start: Start) -> float:
    """Return when a script ends at the latest, s."""
    begin = 0.0
    if isinstance(start, Result):
        begin = start.t_end
    elif isinstance(start, State):
        begin = start.t
    latest = begin
    for k, step in enumerate(steps):
        end = latest_end(step, latest, bound)
        if end is None:
            raise UsageError(
                f"step {k + 1} ends where {conditions_of(step)[0]!r} holds, and may not end at all",
                code="HB-S132",
                where=f"steps[{k}].until",
                hint='give a time beside it, lasts="10 s", or a limit for the whole script',
            )
        latest = max(latest, end)
    return latest


def _is_last_chance(step: Step, end: float, bound: float | None) -> bool:
    """Whether a step had until the end of the script, and no time of its own."""
    return bool(conditions_of(step)) and latest_end(step, 0.0, None) is None and end == bound


def _over(k: int, step: Step, end: float, many: int) -> str:
    name = f" ({step.label})" if step.label else ""
    return (
        f"the script stopped in step {k + 1} of {many}{name}: {conditions_of(step)[0]!r} did not "
        f"hold up to its end, t = {end:.9g} s"
    )


class _Writing:
    """The graphs of a model with what the steps of a script set.

    All that is ever set is so from the beginning, at first to what it was: then the numbers of each
    step are written into the slots of one graph.
    """

    def __init__(
        self,
        model: Model,
        base: FlatGraph,
        parameters: Mapping[str, Value],
        steps: Sequence[Step],
    ) -> None:
        self._model = model
        self._base = base
        self._now: dict[str, Value] = dict(parameters)
        for k, step in enumerate(steps):
            for path, value in step.set.items():
                if path.rpartition(".")[2] in STARTS and path not in base.parameters:
                    raise self._refused(k, path, "it says where the model starts", "a parameter")
                if path in self._now or path not in base.parameters:
                    continue
                kind, _ = kind_of(value)
                if kind is None:
                    self._now[path] = float(base.parameters[path])
                elif not isinstance(kind, str):
                    self._now[path] = f"{float(base.parameters[path])!r} {kind}"
        self._k = 0

    def graph(self, step: Step) -> FlatGraph:
        """Return the model with what a step sets."""
        k, self._k = self._k, self._k + 1
        self._now.update(step.set)
        if not self._now:
            return self._base
        try:
            found = kept_graph(self._model, self._now)
        except HybondError as error:
            path = next(iter(step.set), "")
            raise self._refused(k, path, error.why, error.hint) from None
        for name in ("nodes", "bonds", "storages", "machines", "integrals", "inputs"):
            if _said(getattr(found, name)) != _said(getattr(self._base, name)):
                path = next(iter(step.set), "")
                raise self._refused(
                    k, path, "it makes other parts of the model", "what is a number in it"
                )
        return found

    @staticmethod
    def _refused(k: int, path: str, why: str, hint: str) -> UsageError:
        return UsageError(
            f"step {k + 1} cannot set {path!r}: {why}",
            code="HB-S141",
            where=f"steps[{k}].set.{path}",
            hint=hint or did_you_mean(path, ()) or "a parameter, the value of an element, an input",
        )


def _said(items: Sequence[Any]) -> list[Any]:
    """Return what parts there are, without their numbers."""
    keys = ("path", "kind", "states", "on", "ends", "tail", "head", "controlled")
    return [[getattr(item, key, None) for key in keys] for item in items]
