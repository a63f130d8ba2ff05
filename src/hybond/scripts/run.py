"""Runs by a script: step after step, each with what is set at its beginning and what ends it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any, Literal, Unpack

from hybond.blocks.runners import Runner, runners_of
from hybond.calls import called
from hybond.engine.outcome.beginnings import CHANGED, GOES_ON, Beginning, beginning_by_name
from hybond.engine.outcome.engines import EngineChoice, choose_engine, prepared
from hybond.engine.outcome.signals import Signals
from hybond.engine.tables.bands import banded
from hybond.engine.tables.options import Settings, notices, settings_of
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph, Machine
from hybond.model.kept import kept_graph, kind_of
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.one_run import Start, begun, gone, graph_of, handed_over, made, of_experiment
from hybond.options import seconds_of
from hybond.progress import Asked, shown
from hybond.records import dataclass
from hybond.result import Result, Status
from hybond.runs.asked import RunOptions, opened
from hybond.runs.states import State, load_state
from hybond.runs.times import time_in
from hybond.runs.trace import Trace
from hybond.scripts.result import Done, Part, ScriptResult
from hybond.scripts.steps import Step, conditions_of, latest_end, places_of, steps_of, unrolled

STARTS = ("start", "p", "q", "e", "f")
"""How paths end that say where a model begins."""
SCRIPT = "experiment.script"
"""Where a model has a script."""
_STEP = re.compile(r"steps\[(\d+)\](.*)\Z", re.DOTALL)


@called('hb.run_script(model, steps=[hb.Step(until="1 s")])', options=RunOptions)
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
    **options: Unpack[RunOptions],
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
        As for `simulate`, the same for all steps: `method`, `sliding`, `impact`, `limits`, and what
        is short for them.

    Returns
    -------
    ScriptResult
        Its events have the labels of steps; `steps` says when each began and what ended it.

    Raises
    ------
    UsageError
        HB-S130 for a flat graph, HB-S140 for a script that makes no sense, HB-S141 for what a step
        cannot set, HB-S132 for one that may not end.
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
    base = graph_of(model, parameters, on_error)
    if not isinstance(model, Model):
        raise UsageError(
            "a script sets parameters of a model, and its flat graph has none to set any more",
            code="HB-S130",
            where="model",
            hint="give the hybond.Model that it was made of",
        )
    listed = base.experiment.get("script") if steps is None else None
    script = steps_of(steps) if listed is None else steps_of(listed, SCRIPT)
    if listed is not None:
        check_script(model, base, parameters)
    todo = list(unrolled(script))
    own = {**base.experiment, "until": time_in(base.experiment.get("until"))}
    bound = seconds_of(limit if limit is not None else own["until"], "limit")
    if isinstance(start, str | Path):
        start = load_state(start)
    latest = _latest(todo, bound, start)
    if own["until"] is None:
        own.pop("until")
    try:
        asked = opened(options)
        settings, band = settings_of(own, latest, **asked)
    except UsageError as error:
        raise of_experiment(error, base, {"until": latest, **options}) from None
    maker = choose_engine(engine)
    first = base if band is None else banded(base, band)
    given = start if start is not None else base.experiment.get("start")
    begin, settings = begun(given, first, settings, maker)
    if begin is None:
        begin = beginning_by_name({}, first, prepared(first, settings, maker).tables)
    runners = runners_of(base, fmus=fmus)
    rig = _Rig(_Writing(model, base, parameters or {}, todo), band, settings, maker, runners, bound)
    try:
        with shown(progress, latest) as shows:
            status, failure = rig.run(todo, begin, shows)
    except UsageError as error:
        raise (error if listed is None else of_script(error, base, listed)) from None
    finally:
        for runner in runners.values():
            runner.close()
    for text in (*notices(base, settings, asked.get("impact")), *base.warnings):
        rig.parts[0].trace.warn(text)
    result = ScriptResult(base, rig.parts, rig.done, status, latest, settings.solver, failure)
    return handed_over(result, on_error)


def check_script(
    model: Model, graph: FlatGraph, parameters: Mapping[str, Value] | None = None
) -> float | None:
    """Refuse a script of the experiment that `run_script` would refuse, with the line of the step.

    Return when it ends at the latest, s; None if there is no script.

    Parameters
    ----------
    model : Model
    graph : FlatGraph
        Of the model.
    parameters : mapping, optional
        Values that replace the model's own, in `graph` too.

    Raises
    ------
    UsageError
        HB-S132, HB-S140, HB-S141.
    """
    listed = graph.experiment.get("script")
    if not listed:
        return None
    try:
        todo = list(unrolled(steps_of(listed, SCRIPT)))
        bound = seconds_of(time_in(graph.experiment.get("until")), "limit")
        latest = _latest(todo, bound, None)
        writes = _Writing(model, graph, parameters or {}, todo)
        for k, step in enumerate(todo):
            if step.set:
                writes.graph(k, step)
    except UsageError as error:
        raise of_script(error, graph, listed) from None
    return latest


def of_script(error: UsageError, graph: FlatGraph, listed: Sequence[Any]) -> UsageError:
    """Return a refusal of a step that says where the experiment has it."""
    match = _STEP.match(error.where)
    if match is not None:
        places = list(places_of(steps_of(listed), SCRIPT))
        error.where = places[int(match[1])] + match[2]
    if graph.locate is not None and error.where.startswith(SCRIPT):
        graph.locate(error)
    return error


@dataclass(frozen=True, slots=True)
class _Rig:
    """What runs step after step, and what they have left behind so far."""

    writes: _Writing
    band: float | None
    settings: Settings
    maker: EngineChoice
    runners: Mapping[str, Runner]
    bound: float | None
    parts: list[Part] = field(default_factory=list)
    done: list[Done] = field(default_factory=list)

    def run(
        self, todo: Sequence[Step], begin: Beginning, shows: Callable[[float, int], object] | None
    ) -> tuple[Status, HybondError | None]:
        """Do all steps, or those up to one that stops; return how it went, and what stopped it."""
        status: Status = "ok"
        failure: HybondError | None = None
        for k, step in enumerate(todo):
            graph = self.writes.graph(k, step)
            if self.band is not None:
                graph = banded(graph, self.band)
            end = self._end(k, step, begin.t)
            run = made(
                graph,
                conditions_of(step),
                self.settings,
                self.maker,
                begin=begin,
                progress=shows,
                runners=self.runners,
                until=end,
            )
            trace = run.trace
            assert isinstance(trace.signals, Signals)
            self.parts.append(Part(graph, trace, trace.signals))
            status, failure = gone(run, graph)
            self.done.append(_done(step, trace, begin.t, status))
            if status != "ok" or trace.carried is None:
                break
            if trace.ended_by == "" and end == self.bound:
                if k + 1 < len(todo) or _is_cut(step, begin.t, end):
                    trace.warn(_over(k, step, end, len(todo)))
                break
            changes = k + 1 < len(todo) and bool(todo[k + 1].set)
            begin = _next(trace, graph, changes=changes)
        return status, failure

    def _end(self, k: int, step: Step, begin: float) -> float:
        """Return when a step ends at the latest, s."""
        end = latest_end(step, begin, self.bound)
        assert end is not None  # `_latest` has asked
        if end > begin:
            return end
        raise _backwards(k, f"{begin:.9g} s", end)


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
    latest = earliest = begin
    sure = True
    for k, step in enumerate(steps):
        if bound is not None and earliest >= bound > begin:
            break  # the script is over
        end = latest_end(step, latest, bound)
        if end is None:
            raise UsageError(
                f"step {k + 1} ends where {conditions_of(step)[0]!r} holds, and may not end at all",
                code="HB-S132",
                where=f"steps[{k}].until",
                hint='give a time beside it, lasts="10 s", or a limit for the whole script',
            )
        if end <= earliest:
            raise _backwards(k, f"{earliest:.9g} s{'' if sure else ' or later'}", end)
        latest = max(latest, end)
        if conditions_of(step):
            sure = False  # it may hold at once
        else:
            least = latest_end(step, earliest, bound)
            assert least is not None
            earliest = least
    return latest


def _backwards(k: int, begin: str, end: float) -> UsageError:
    """Return the refusal of a step that ends before it begins."""
    return UsageError(
        f"step {k + 1} begins at {begin} and ends at {end:.9g} s",
        code="HB-S140",
        where=f"steps[{k}].until",
        hint="until is a time since the start of the run; lasts is how long",
    )


def _is_cut(step: Step, begin: float, end: float) -> bool:
    """Whether a step that has a time of its own ends before it."""
    own = latest_end(step, begin, None)
    return own is not None and own > end


def _over(k: int, step: Step, end: float, many: int) -> str:
    name = f" ({step.label})" if step.label else ""
    stopped = f"the script stopped in step {k + 1} of {many}{name}"
    conditions = conditions_of(step)
    if not conditions:
        return f"{stopped}: it has until t = {end:.9g} s, the until of the experiment or its limit"
    return f"{stopped}: {conditions[0]!r} did not hold up to its end, t = {end:.9g} s"


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
                machine = _machine_of(path, base)
                if machine is not None:
                    raise self._refused(k, path, *_of_a_machine(machine))
                if path.rpartition(".")[2] in STARTS and path not in base.parameters:
                    raise self._refused(k, path, "it says where the model starts", "a parameter")
                if path in self._now or path not in base.parameters:
                    continue
                kind, _ = kind_of(value)
                if kind is None:
                    self._now[path] = float(base.parameters[path])
                elif not isinstance(kind, str):
                    self._now[path] = f"{float(base.parameters[path])!r} {kind}"

    def graph(self, k: int, step: Step) -> FlatGraph:
        """Return the model with what step `k` sets, and those before it have set."""
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


def _machine_of(path: str, graph: FlatGraph) -> Machine | None:
    """Return the machine that a path names, or whose start or state."""
    base, _, last = path.rpartition(".")
    own = (path, base) if last in ("start", "state") else (path,)
    return next((m for m in graph.machines if m.path in own and m.law is None), None)


def _of_a_machine(machine: Machine) -> tuple[str, str]:
    """Return why a script sets no state of a machine, and what does."""
    a, b = (*machine.states, *machine.states)[:2]
    return (
        f"{machine.path} is a machine, which changes its state by its own rules",
        f"let a parameter ask for it, go = 0, in a rule '{a} -> {b} when go > 0.5', and set go = 1",
    )


def _said(items: Sequence[Any]) -> list[Any]:
    """Return what parts there are, without their numbers."""
    keys = ("path", "kind", "states", "on", "ends", "tail", "head", "controlled")
    return [[getattr(item, key, None) for key in keys] for item in items]
