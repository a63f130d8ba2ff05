"""From a file and options to a run: what `run`, `explain` and `demo` share."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from hybond.cli.interrupt import Interruptible
from hybond.cli.lists import check_experiment, run_until
from hybond.cli.netlists import read_model
from hybond.cli.settings import changed_with, flatten_with
from hybond.cli.shared_words import options_given
from hybond.cli.streams import complain
from hybond.errors import NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.options import seconds_of
from hybond.progress import Progress
from hybond.result import Result
from hybond.runs.ends import Until
from hybond.runs.times import end_of, is_condition, time_in
from hybond.scripts.result import ScriptResult
from hybond.scripts.run import run_script
from hybond.simulation import simulate
from hybond.units import format_quantity


def read_graph(file: str, settings: Sequence[str] = ()) -> FlatGraph:
    """Return the flat graph of a model file or netlist with the settings of ``--set``.

    Raises
    ------
    HybondError
    """
    graph = flatten_with(read_model(file)[0], settings)
    check_experiment(graph)
    return graph


def run_with(model: Model, graph: FlatGraph, given: Namespace) -> Result:
    """Do the script of a model, unless it has none or ``--no-script`` is given: then one run.

    Parameters
    ----------
    graph : FlatGraph
        Of the model, with what ``--set`` says.
    """
    if has_script(graph, given):
        return script_with(model, given)
    until, end = run_until(graph, given.until)
    return simulate_with(graph, until, given, end=end)


def has_script(graph: FlatGraph, given: Namespace) -> bool:
    """Whether a script is to be done."""
    return bool(graph.experiment.get("script")) and not given.no_script


def tell_no_script(model: Model | FlatGraph, what: str) -> None:
    """Say that the script of a file is not done here, where it has one: `hybond run` does it."""
    if model.experiment.get("script"):
        complain(f"note: {what} without the script of the file, which `hybond run` does")


def simulate_with(
    graph: FlatGraph, until: Until, given: Namespace | None = None, *, end: float | None = None
) -> Result:
    """Simulate with progress and Ctrl-C; errors of the run are in the result.

    Parameters
    ----------
    until : float, str or list
        When it ends, as for `simulate`.
    given : Namespace
        The options of the solver; without it the model's own.
    end : float
        When it ends at the latest, s; by default `until`.
    """
    latest = end_of(until, graph.experiment) if end is None else end
    asked = options_given(given or Namespace(), "start", "keep", "journal", "fmus")
    with Interruptible() as interruptible, Progress(latest) as bar:

        def progress(t: float, events: int) -> None:
            bar(t, events)
            interruptible.check()

        return simulate(
            graph,
            until,
            **asked,
            progress=progress,
            on_error="return",
        )


def script_with(model: Model, given: Namespace) -> ScriptResult:
    """Run the script of a model with progress and Ctrl-C; errors of the run are in the result."""
    changed, parameters = changed_with(model, given.settings)
    limits = given.until or [None]
    if len(limits) > 1 or (limits[0] is not None and is_condition(limits[0])):
        raise UsageError(
            "a script has its own ends; --until is a time, the latest for all of it",
            code="HB-S106",
            where="--until",
            hint="--until 10s, or --no-script",
        )
    for name in ("keep", "journal"):
        if getattr(given, name, None) is not None:
            raise UsageError(
                f"the run of a script has no {name}",
                code="HB-S113",
                where=f"--{name}",
                hint="leave it out, or give --no-script",
            )
    bound = limits[0] if limits[0] is not None else time_in(changed.experiment.get("until"))
    end = seconds_of(bound, "--until")
    with Interruptible() as interruptible, Progress(end or 1.0) as bar:

        def progress(t: float, events: int) -> None:
            bar(t, events)
            interruptible.check()

        return run_script(
            changed,
            limit=end,
            parameters=parameters,
            progress=progress,
            on_error="return",
            **options_given(given, "start", "fmus"),
        )


def ending(run: Result) -> str:
    """Return when and how a run ended, in one line."""
    end = format_quantity(run.until, "s")
    seen = [f" from {v.t:.9g} s on" for v in sorted(run.trace.unsound, key=lambda v: v.t)]
    how = {
        "ok": "the end",
        "unsound": f"laws do not hold{''.join(seen[:1])}, of {end}",
        "interrupted": f"interrupted, of {end}",
        "accumulation": f"stopped where events accumulate, of {end}",
        "error": f"stopped by an error, of {end}",
    }[run.status]
    if run.trace.ended_by:
        how = f"{run.trace.ended_by} holds"
    mode = ", ".join(run.mode.values()) or "the only mode"
    return f"t = {run.t_end:.9g} s  {how}  ({mode})"


def exit_code(run: Result) -> int:
    """Return the exit code of a run: 0 only if it is sound and came to its end."""
    if run.status == "interrupted":
        return 130
    if run.error is not None:
        return run.error.exit_code
    return 0 if run.status == "ok" else NumericsError.exit_code
