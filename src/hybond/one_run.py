"""One run, as `simulate` and the steps of a script have it: asked for, begun, made, gone."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from hybond.blocks.runners import Runner
from hybond.engine.outcome.beginnings import Beginning, beginning_by_name, beginning_of
from hybond.engine.outcome.engine_run import EngineRun
from hybond.engine.outcome.engines import EngineChoice, Prepared, choose_engine, prepared
from hybond.engine.outcome.journal import EventFile
from hybond.engine.outcome.outgrown import outgrown
from hybond.engine.outcome.steps_run import StepsRun
from hybond.engine.outcome.unsound import unsound_refusal
from hybond.engine.tables.options import Settings, settings_of
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.graph import FlatGraph
from hybond.model.kept import kept_graph
from hybond.options import STEPPING
from hybond.result import Result, Status
from hybond.runs.asked import chosen
from hybond.runs.ends import ended, ends_of
from hybond.runs.states import State, load_state
from hybond.runs.times import check_instants, time_in
from hybond.uncollected import uncollected

Start = Result | State | Mapping[str, Any] | str | os.PathLike[str] | None
"""Where a run may begin."""
_WANTED_BY = {"step": "solver", "theta": "solver", "hysteresis": "sliding"}
"""Options that another one cannot do without."""


@uncollected
def graph_of(model: Model | FlatGraph, parameters: Any, on_error: str) -> FlatGraph:
    """Return the graph of a model with other values, for a call whose arguments fit.

    Raises
    ------
    UsageError
        HB-S105, HB-S130.
    """
    check_model(model)
    if not isinstance(parameters, Mapping | None):
        raise UsageError(
            f"parameters = {parameters!r} does not map paths to values",
            code="HB-S130",
            where="parameters",
            hint='parameters={"m": "2 kg", "ball.f": 1.0}',
        )
    if on_error not in ("raise", "return"):
        raise UsageError(
            f"on_error = {on_error!r}", code="HB-S105", where="on_error", hint="raise or return"
        )
    return kept_graph(model, parameters or {}) if isinstance(model, Model) else model


@uncollected
def begun(
    start: Start, graph: FlatGraph, settings: Settings, maker: EngineChoice
) -> tuple[Beginning | None, Settings]:
    """Return where a run begins, None where the model says, and what it is asked for then.

    Raises
    ------
    UsageError
        HB-S133 if it would end before; HB-S134, HB-S135 for a start that is none.
    """
    if start is None:
        return None, settings
    given = start.state() if isinstance(start, Result) else start
    if isinstance(given, str | os.PathLike):
        given = load_state(given)
    if not isinstance(given, State | Mapping):
        raise UsageError(
            f"start = {given!r} is no run, no state and no mapping",
            code="HB-S134",
            where="start",
            hint='start=run, start=run.state("1 s"), or start={"ball.p": "1 kg*m/s"}',
        )
    if isinstance(given, State) and given.memory and time_in(graph.experiment.get("until")) is None:
        settings = replace(settings, span=given.memory.span)
    tables = prepared(graph, settings, maker).tables
    units = [s.path for s in graph.samples if s.block is not None and s.block.function is None]
    if isinstance(given, State) and given.t > 0.0 and units:
        raise UsageError(
            f"the run cannot go on: the unit of {units[0]} would begin anew",
            code="HB-S138",
            where="start",
            hint="run it in one, or by a script, in which units go on",
        )
    if isinstance(given, State):
        begin = beginning_of(given, graph, tables)
    else:
        begin = beginning_by_name(given, graph, tables)
    if not 0.0 <= begin.t < settings.until:
        raise UsageError(
            f"the run begins at t = {begin.t:.9g} s and ends at {settings.until:.9g} s",
            code="HB-S133",
            where="until",
            hint="time goes on where the other run ended: until is later than that",
        )
    return begin, settings


def of_experiment(error: UsageError, graph: FlatGraph, asked: Mapping[str, Any]) -> UsageError:
    """Return a refusal that says where the model asks for what is refused, unless the call does."""
    name = error.where.partition(".")[0]
    if graph.locate is not None and asked.get(name) is None:
        wants = _WANTED_BY.get(name, "")
        if name in graph.experiment:
            error.where = f"experiment.{error.where}"
        elif wants in graph.experiment and asked.get(wants) is None:
            error.where = f"experiment.{wants}"
        graph.locate(error)
    return error


def check_run(graph: FlatGraph) -> None:
    """Refuse what a run of which nothing else is asked would refuse before it begins.

    An experiment without an end is fine: who runs it gives one.

    Raises
    ------
    UsageError
        As `hybond.simulate`, with the place in the experiment.
    """
    experiment = graph.experiment
    try:
        ends = ends_of(None, experiment)
        if ends.time is None:
            chosen({}, experiment)
            return
        settings = settings_of(experiment, ends.time)[0]
        if "start" in experiment and "script" not in experiment:
            begun(experiment["start"], graph, settings, choose_engine(None))
    except UsageError as error:
        raise of_experiment(error, graph, {}) from None


@uncollected
def made(
    graph: FlatGraph,
    conditions: tuple[str, ...],
    settings: Settings,
    maker: EngineChoice,
    *,
    begin: Beginning | None,
    progress: Callable[[float, int], object] | None,
    runners: Mapping[str, Runner],
    until: float | None = None,
    keep: int | None = None,
    journal: str | None = None,
) -> EngineRun | StepsRun:
    """Return a run that is ready to go, by the executive or by time-stepping.

    Parameters
    ----------
    conditions : tuple of str
        What ends it before its time.
    begin : Beginning or None
        None where the model says.
    runners : mapping
        What runs each block, by its path.
    until : float, optional
        When it ends, s, if that is before the time of `settings`.
    keep : int, optional
    journal : str, optional
        As for `hybond.simulate`; not for time-stepping.

    Raises
    ------
    UsageError
        HB-S136 for what is no condition, HB-S113 for what is no file of a journal, HB-S142 for
        instants without end.
    """
    check_instants(graph, settings.until)
    ending = ended(graph, conditions)
    shown: Prepared | None = None if ending is graph else prepared(graph, settings, maker)
    run: EngineRun | StepsRun
    if settings.solver in STEPPING:
        run = StepsRun(
            ending,
            settings,
            maker,
            progress=progress,
            runners=runners,
            begin=begin,
            until=until,
            shown=shown,
        )
    else:
        own = prepared(ending, settings, maker)
        run = EngineRun(
            own,
            progress=progress,
            keep=keep,
            # last of all: it replaces the file that is there
            journal=None if journal is None else EventFile(journal, graph),
            runners=runners,
            begin=begin,
            until=until,
            shown=shown,
        )
    run.trace.engine = maker.said
    return run


def gone(run: EngineRun | StepsRun, graph: FlatGraph) -> tuple[Status, HybondError | None]:
    """Run to the end; return how it went, and what stopped it if it is an error."""
    trace = run.trace
    status: Status = "error"
    failure: HybondError | None = None
    try:
        status = "accumulation" if run.run() == "accumulation" else "ok"
    except KeyboardInterrupt:
        status = "interrupted"
    except HybondError as error:
        failure = error
    if isinstance(run, EngineRun) and status in ("ok", "accumulation"):
        numbers = run.tables.numbers
        grown = [*outgrown(graph, trace, int(numbers["method"]), float(numbers["step"]))]
        made = run.records.warnings.made
        # what grows makes energy: that is said once
        for text in grown or [made] * bool(made):
            trace.warn(text)
    if status in ("ok", "accumulation") and trace.unsound:
        status = "unsound"
        reached = trace.segments[-1].t[-1] if trace.segments else trace.begin
        failure = unsound_refusal(trace.unsound, float(reached))
    if failure is not None and graph.locate is not None:
        failure = graph.locate(failure)
    return status, failure


R = TypeVar("R", bound=Result)


def handed_over(result: R, on_error: str) -> R:
    """Return a result, or raise what stopped its run with the result as `partial`."""
    if result.error is not None and on_error == "raise":
        result.error.partial = result
        raise result.error
    return result
