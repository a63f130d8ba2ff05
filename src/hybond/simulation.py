"""`simulate`: the one entry point from a model to a `Result`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Literal, Unpack

from hybond.blocks.runners import runners_of
from hybond.calls import called
from hybond.engine.outcome.engines import choose_engine
from hybond.engine.tables.bands import banded
from hybond.engine.tables.options import notices, settings_of
from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.model.parts import Value
from hybond.one_run import (
    Start,
    begun,
    gone,
    graph_of,
    handed_over,
    made,
    of_experiment,
)
from hybond.progress import Asked, shown
from hybond.result import Result
from hybond.runs.asked import RunOptions, kept, opened, solver_of
from hybond.runs.ends import Until, ends_of
from hybond.runs.policies import Journal

if TYPE_CHECKING:
    from pathlib import Path


@called('hb.simulate(model, until="1 s", solver="auto")', options=RunOptions)
def simulate(
    model: Model | FlatGraph,
    until: Until = None,
    *,
    start: Start = None,
    parameters: Mapping[str, Value] | None = None,
    progress: Asked = None,
    watch: Callable[[Result], object] | None = None,
    on_error: Literal["raise", "return"] = "raise",
    engine: Literal["library", "python"] | None = None,
    keep: Journal | int | None = None,
    journal: str | Path | None = None,
    fmus: bool = False,
    **options: Unpack[RunOptions],
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
    method : Method or str
        How motion is computed, with all that belongs to it: `hybond.Auto`, `hybond.RK45`,
        `hybond.Radau`, `hybond.Exact`, `hybond.RK4`, `hybond.Euler`, `hybond.QSS`,
        `hybond.LIQSS` or `hybond.MoreauJean`, as ``method=hb.Radau(rtol=1e-6)``; or the name of a
        solver. In short, by options: `solver`, `rtol`, `atol`, `step`, `max_step`, `theta`.
    solver : str
        ``"auto"``, which propagates linear modes exactly, leaves others to ``"rk45"`` and, where
        that turns out to be stiff, to ``"radau"``, and says so in `Result.method`; ``"rk45"``,
        ``"radau"``, ``"rk4"`` or ``"euler"``; ``"exact"``, which never leaves modes to
        ``"radau"``; ``"qss1"`` to ``"qss3"`` or ``"liqss1"`` to ``"liqss3"``, which quantise
        states; or ``"moreau-jean"``, time-stepping: it locates no events, and takes contacts,
        diodes and friction as laws of each step. Default ``"auto"``, or what the experiment says.
    rtol : float
        Relative tolerance, default 1e-8. Stored quantities are measured against the largest value
        they have lately had, and against 1e-6 of the value that would hold the energy of
        what they are connected with.
    atol : float
        Absolute tolerance in SI for every state, instead of that floor.
    step : float or str
        Step of the fixed-step solvers and of time-stepping.
    max_step : float or str
        Longest step.
    theta : float
        Of time-stepping: 1/2 (default) to 1, how much the end of a step weighs in its smooth part.
    sliding : {"filippov", "refuse"} or Hysteresis
        What happens on a switching surface into which both sides push: slide along it (default);
        stop where the events accumulate; or switch with a band around every such surface,
        `hybond.Hysteresis`. In short: ``sliding="hysteresis"`` and `hysteresis`.
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
    keep : int or Journal
        Segments and events that the result has at the least, the last ones; None keeps all. A run
        with millions of events then needs no more memory than one with few. A `hybond.Journal`
        writes events to a file as well.
    limits : Limits
        After how much a run that gets nowhere stops, `hybond.Limits`. In short: `max_events`,
        `max_steps`.
    max_events : int
        Events after which the run stops with HB-N404, default 1,000,000.
    max_steps : int
        Steps between two events after which the run stops with HB-N409, default 4,000,000: a
        result keeps them all, at about a kilobyte each.
    journal : str or Path
        In short for ``keep=hb.Journal(...)``: a CSV file to which events are written as they
        happen: time, cause, the states of the machines, stored quantities and signals after it.
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
    graph = graph_of(model, parameters, on_error)
    if watch is not None and not callable(watch):
        raise UsageError(
            f"watch = {watch!r} cannot be called",
            code="HB-S131",
            where="watch",
            hint="watch=look, where look(run) takes what was computed so far",
        )
    try:
        asked = opened(options)
        name = solver_of(asked, graph.experiment)
        last, journal = kept(keep, journal, name)
        ends = ends_of(until, graph.experiment)
        settings, band = settings_of(graph.experiment, ends.time, **asked)
    except UsageError as error:
        raise of_experiment(error, graph, {"until": until, **options}) from None
    if band is not None:
        graph = banded(graph, band)
    maker = choose_engine(engine)
    given = start if start is not None else graph.experiment.get("start")
    try:
        begin, settings = begun(given, graph, settings, maker)
    except UsageError as error:
        raise of_experiment(error, graph, {"start": start, "until": until}) from None
    runners = runners_of(graph, fmus=fmus)
    try:
        with shown(progress, settings.until) as shows:

            def look(t: float, events: int) -> None:
                if shows is not None:
                    shows(t, events)
                if watch is not None:
                    with run.so_far():
                        watch(Result(graph, run.trace, "running", settings.until, name, None))

            run = made(
                graph,
                ends.conditions,
                settings,
                maker,
                begin=begin,
                progress=None if shows is None and watch is None else look,
                runners=runners,
                keep=last,
                journal=journal,
            )
            for text in notices(graph, settings, asked.get("impact")):
                run.trace.warn(text)
            status, failure = gone(run, graph)
            for warning in graph.warnings:
                run.trace.warn(warning)
            result = Result(graph, run.trace, status, settings.until, name, failure)
            return handed_over(result, on_error)
    finally:
        for runner in runners.values():
            runner.close()
