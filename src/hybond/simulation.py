"""`simulate`: the one entry point from a model to a `Result`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from hybond.blocks.runners import runners_of
from hybond.calls import called
from hybond.engine.outcome.beginnings import Beginning, beginning_by_name, beginning_of
from hybond.engine.outcome.engine_run import EngineRun
from hybond.engine.outcome.engines import EngineChoice, choose_engine, prepared
from hybond.engine.outcome.journal import Journal
from hybond.engine.outcome.steps_run import StepsRun
from hybond.engine.outcome.unsound import unsound_refusal
from hybond.engine.tables.bands import banded
from hybond.engine.tables.options import Settings, settings_of
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.graph import FlatGraph
from hybond.model.kept import kept_graph
from hybond.model.parts import Value
from hybond.progress import Asked, shown
from hybond.result import Result, Status
from hybond.runs.ends import Until, ended, ends_of
from hybond.runs.options import (
    STEPPING,
    STEPPING_IMPACT,
    Choice,
    ignored_impact,
    solver_of,
    time_in,
)
from hybond.runs.states import State, load_state

Start = Result | State | Mapping[str, Any] | str | Path | None
"""Where a run may begin."""
ENGINE: Literal["library", "python"] | None = None
"""What makes runs that do not say what should."""


@called('hb.simulate(model, until="1 s", solver="auto")')
def simulate(
    model: Model | FlatGraph,
    until: Until = None,
    *,
    start: Start = None,
    parameters: Mapping[str, Value] | None = None,
    solver: str | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    step: float | str | None = None,
    max_step: float | str | None = None,
    theta: float | None = None,
    sliding: Choice | None = None,
    hysteresis: float | str | None = None,
    impact: str | None = None,
    progress: Asked = None,
    watch: Callable[[Result], object] | None = None,
    on_error: Literal["raise", "return"] = "raise",
    engine: Literal["library", "python"] | None = None,
    keep: int | None = None,
    max_events: int | None = None,
    max_steps: int | None = None,
    journal: str | Path | None = None,
    fmus: bool = False,
) -> Result:
    """Simulate a model from t = 0, or from where another run has come.

    Parameters
    ----------
    model : Model or FlatGraph
        A model, built or loaded. Options that are not given are taken from its experiment.
    until : float, str or list
        End time, s or a quantity (``"50 ms"``); a condition as guards are (``"v.f < 0"``), where it
        holds first; or conditions and one time, whatever is first. Conditions alone have the time
        of the experiment beside them. `Result.ended_by` says what it was.
    start : Result, State, mapping, str or Path
        Where the run begins. A run, or a state of one (`Result.state`), also in a file: time goes
        on, so that `until` is later. With the same model and parameters it goes on as if it had not
        been interrupted; another model has what is stored and the modes that both have, and is
        settled. A mapping gives values by name in place of those of the model:
        ``{"ball.p": "1 kg*m/s", "floor": "touching"}``.
    parameters : mapping
        Values by dotted path that replace the model's own.
    solver : str
        ``"auto"``, which propagates linear modes exactly, leaves others to ``"rk45"`` and, where
        that turns out to be stiff, to ``"radau"``, and says so in `Result.method`; ``"rk45"``,
        ``"radau"``, ``"rk4"`` or ``"euler"``; ``"exact"``, which never leaves modes to
        ``"radau"``; ``"qss1"`` to ``"qss3"`` or ``"liqss1"`` to ``"liqss3"``, which quantise
        states; or ``"moreau-jean"``, time-stepping: it locates no events, and takes contacts,
        diodes and friction as laws of each step. Default ``"auto"``, or what the experiment says.
    rtol : float
        Relative tolerance, default 1e-8. Stored quantities are measured against the largest value
        they have had, and against 1e-6 of the value that would hold the system's energy.
    atol : float
        Absolute tolerance in SI for every state, instead of that floor.
    step : float or str
        Step of the fixed-step solvers and of time-stepping.
    max_step : float or str
        Longest step.
    theta : float
        Of time-stepping: 1/2 (default) to 1, how much the end of a step weighs in its smooth part.
    sliding : {"filippov", "hysteresis", "refuse"}
        What happens on a switching surface into which both sides push: slide along it (default);
        switch with a band of `hysteresis` around every such surface; or stop where the events
        accumulate.
    hysteresis : float or str
        Half the width of that band, in the unit of the switching functions or in SI.
    impact : {"newton", "newton_simultaneous", "poisson", "lzb", "lzb_hertz"}
        The law of impacts at several contacts with restitution; see
        `hybond.engine.impacts.impact_laws`. Default ``"newton"``, contact after contact: the only
        one that needs no more than what a single impact tells, and gives the textbook answer for
        rows of balls. Newton's law with impulsive friction may create energy: the run warns, in J.
        Time-stepping has ``"newton_simultaneous"`` built in, and warns if it is another one.
    progress : bool, bar of tqdm or callable
        True for a bar on stderr with the time to go; a bar of tqdm, which is moved along; or
        ``progress(t, events)``, called about twenty times a second.
    watch : callable
        ``watch(run)``, called as often with what was computed so far, a `Result` with the status
        ``"running"``. It may be read until `watch` returns; meanwhile the run waits.
    on_error : {"raise", "return"}
        What to do when the run stops with an error: raise it, with what was computed in
        ``error.partial``, or return that with ``result.error`` set.
    engine : {"library", "python"}
        What makes the run: the engine compiled as a library, or the same engine run as Python,
        which is many times slower. By default the library if there is one, and else Python. The
        results are the same but for rounding of elementary functions; `Result.engine` says which
        it was.
    keep : int
        Segments and events that the result has at the least, the last ones; None keeps all. A run
        with millions of events then needs no more memory than one with few.
    max_events : int
        Events after which the run stops with HB-N404, default 1,000,000.
    max_steps : int
        Steps between two events after which the run stops with HB-N409, default 4,000,000: a
        result keeps them all, at about a kilobyte each.
    journal : str or Path
        A CSV file to which events are written as they happen: time, cause, the states of the
        machines, stored quantities and signals after it.
    fmus : bool
        Whether the functional mock-up units that the model names may run. They are machine code
        and can do what any program can: say so for files that you trust.

    Returns
    -------
    Result

    Raises
    ------
    HybondError
        Unless `on_error` is ``"return"``. Errors of the model itself are always raised.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> run = hb.simulate(m, until="1 s")
    >>> round(float(run["c.e"].at(1.0)), 6)
    3.678794
    """
    check_model(model)
    if not isinstance(parameters, Mapping | None):
        raise UsageError(
            f"parameters = {parameters!r} does not map paths to values",
            code="HB-S130",
            where="parameters",
            hint='parameters={"m": "2 kg", "ball.f": 1.0}',
        )
    if watch is not None and not callable(watch):
        raise UsageError(
            f"watch = {watch!r} cannot be called",
            code="HB-S131",
            where="watch",
            hint="watch=look, where look(run) takes what was computed so far",
        )
    graph = kept_graph(model, parameters or {}) if isinstance(model, Model) else model
    if on_error not in ("raise", "return"):
        raise UsageError(
            f"on_error = {on_error!r}", code="HB-S105", where="on_error", hint="raise or return"
        )
    try:
        name = solver_of(solver, graph.experiment)
        whole = isinstance(keep, int) and not isinstance(keep, bool) and keep >= 1
        if keep is not None and (not whole or name in STEPPING):
            raise UsageError(
                f"keep is given, but solver {name!r} keeps all" if whole else f"keep = {keep!r}",
                code="HB-S113",
                where="keep",
                hint="one or more, with a solver that locates events",
            )
        if journal is not None and name in STEPPING:
            raise UsageError(
                f"a journal is given, but solver {name!r} has none",
                code="HB-S113",
                where="journal",
                hint="take a solver that locates events",
            )
        ends = ends_of(until, graph.experiment)
        settings, band = settings_of(
            graph.experiment,
            ends.time,
            solver=solver,
            rtol=rtol,
            atol=atol,
            step=step,
            max_step=max_step,
            theta=theta,
            sliding=sliding,
            hysteresis=hysteresis,
            impact=impact,
            max_events=max_events,
            max_steps=max_steps,
        )
    except UsageError as error:
        asked = {"until": until, "solver": solver, "rtol": rtol, "atol": atol, "step": step}
        asked |= {"max_step": max_step, "theta": theta, "sliding": sliding, "impact": impact}
        asked |= {"hysteresis": hysteresis, "max_events": max_events, "max_steps": max_steps}
        raise _of_experiment(error, graph, asked) from None
    if band is not None:
        graph = banded(graph, band)
    maker = choose_engine(engine or ENGINE)
    given = start if start is not None else graph.experiment.get("start")
    begin, settings = begun(given, graph, settings, maker)
    runners = runners_of(graph, fmus=fmus)
    ending = ended(graph, ends.conditions)
    shown_by = None if ending is graph else prepared(graph, settings, maker)
    run: EngineRun | StepsRun
    try:
        with shown(progress, settings.until) as shows:

            def look(t: float, events: int) -> None:
                if shows is not None:
                    shows(t, events)
                if watch is not None:
                    with run.so_far():
                        watch(Result(graph, run.trace, "running", settings.until, name, None))

            looked = None if shows is None and watch is None else look
            if name in STEPPING:
                run = StepsRun(
                    ending,
                    settings,
                    maker,
                    progress=looked,
                    runners=runners,
                    begin=begin,
                    shown=shown_by,
                )
            else:
                own = prepared(ending, settings, maker)
                # last of all: it replaces the file that is there
                opened = None if journal is None else _opened(journal, graph)
                run = EngineRun(
                    own,
                    progress=looked,
                    keep=keep,
                    journal=opened,
                    runners=runners,
                    begin=begin,
                    shown=shown_by,
                )
            run.trace.engine = maker.said
            for text in notices(graph, settings, impact):
                run.trace.warn(text)
            return _finish(graph, run, settings.until, name, on_error)
    finally:
        for runner in runners.values():
            runner.close()


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
    if isinstance(given, str | Path):
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


def _of_experiment(error: UsageError, graph: FlatGraph, asked: Mapping[str, Any]) -> UsageError:
    """Say where the model asks for what is refused, unless the call does."""
    if graph.locate is not None and asked.get(error.where) is None:
        if error.where in graph.experiment:
            error.where = f"experiment.{error.where}"
        graph.locate(error)
    return error


def notices(graph: FlatGraph, settings: Settings, impact: str | None) -> list[str]:
    """Return what is to be said of what a run is asked for, before it begins."""
    if settings.solver in STEPPING:
        said = ignored_impact(impact, graph.experiment)
    else:
        said = _friction_left_out(settings.impact[0], graph)
    return [] if said is None else [said]


def _friction_left_out(impact: str, graph: FlatGraph) -> str | None:
    """Return what is to be said where a law of impacts has no friction, and the model has some."""
    names = [m.path for m in graph.machines if m.law for law in m.law.junctions if law.impulsive]
    if not names or impact in ("newton", STEPPING_IMPACT):
        return None
    return (
        f"impact = {impact!r} has no friction: the impulses of {', '.join(names)} are left out; "
        f"'newton' and {STEPPING_IMPACT!r} have them"
    )


def _opened(journal: str | Path, graph: FlatGraph) -> Journal:
    if not isinstance(journal, str | Path) or Path(journal).suffix.lower() != ".csv":
        # a file that is there is replaced: let it not be a model
        raise UsageError(
            f"the journal cannot be {str(journal)!r}",
            code="HB-S113",
            where="journal",
            hint='name a CSV file, such as journal="events.csv"',
        )
    return Journal(Path(journal), graph)


def _finish(
    graph: FlatGraph,
    run: EngineRun | StepsRun,
    end: float,
    name: str,
    on_error: str,
) -> Result:
    """Run; return the result, also that of a run that stopped."""
    trace = run.trace
    status: Status = "error"
    failure: HybondError | None = None
    try:
        status = "accumulation" if run.run() == "accumulation" else "ok"
    except KeyboardInterrupt:
        status = "interrupted"
    except HybondError as error:
        failure = error
    if status in ("ok", "accumulation") and trace.unsound:
        status = "unsound"
        reached = trace.segments[-1].t[-1] if trace.segments else trace.begin
        failure = unsound_refusal(trace.unsound, float(reached))
    for warning in graph.warnings:
        trace.warn(warning)
    if failure is not None and graph.locate is not None:
        failure = graph.locate(failure)
    result = Result(graph, trace, status, end, name, failure)
    if failure is not None and on_error == "raise":
        failure.partial = result
        raise failure
    return result
