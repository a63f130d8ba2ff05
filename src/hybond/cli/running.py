"""From a file and options to a run: what `run`, `explain` and `demo` share."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from hybond.cli.interrupt import Interruptible
from hybond.cli.lists import check_experiment
from hybond.cli.netlists import read_model
from hybond.cli.settings import changed_with, flatten_with
from hybond.errors import NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.progress import Progress
from hybond.result import Result
from hybond.runs.ends import Until
from hybond.runs.options import end_of, is_condition, seconds_of, time_in
from hybond.scripts.result import ScriptResult
from hybond.scripts.run import run_script
from hybond.simulation import simulate

OPTIONS = (
    *("solver", "rtol", "atol", "step", "max_step", "theta", "impact", "sliding", "hysteresis"),
    *("max_events", "max_steps"),
)
"""What the run of a script is asked for beside its steps."""


def read_graph(file: str, settings: Sequence[str] = ()) -> FlatGraph:
    """Return the flat graph of a model file or netlist with the settings of ``--set``.

    Raises
    ------
    HybondError
    """
    graph = flatten_with(read_model(file)[0], settings)
    check_experiment(graph)
    return graph


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
    with Interruptible() as interruptible, Progress(latest) as bar:

        def progress(t: float, events: int) -> None:
            bar(t, events)
            interruptible.check()

        return simulate(
            graph,
            until,
            start=getattr(given, "start", None),
            solver=getattr(given, "solver", None),
            rtol=getattr(given, "rtol", None),
            atol=getattr(given, "atol", None),
            step=getattr(given, "step", None),
            max_step=getattr(given, "max_step", None),
            theta=getattr(given, "theta", None),
            impact=getattr(given, "impact", None),
            sliding=getattr(given, "sliding", None),
            hysteresis=getattr(given, "hysteresis", None),
            keep=getattr(given, "keep", None),
            max_events=getattr(given, "max_events", None),
            max_steps=getattr(given, "max_steps", None),
            journal=getattr(given, "journal", None),
            fmus=getattr(given, "fmus", False),
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
        if getattr(given, name) is not None:
            raise UsageError(
                f"the run of a script has no {name}",
                code="HB-S113",
                where=f"--{name}",
                hint="leave it out, or give --no-script",
            )
    bound = limits[0] if limits[0] is not None else time_in(changed.experiment.get("until"))
    end = seconds_of(bound, "--until")
    options = {name: getattr(given, name) for name in OPTIONS}
    with Interruptible() as interruptible, Progress(end or 1.0) as bar:

        def progress(t: float, events: int) -> None:
            bar(t, events)
            interruptible.check()

        return run_script(
            changed,
            limit=end,
            start=given.start,
            parameters=parameters,
            progress=progress,
            on_error="return",
            fmus=given.fmus,
            **options,
        )


def solver_options(given: Namespace) -> dict[str, Any]:
    """Return the options of `hybond.simulate` that many runs have, those that were given."""
    names = (
        *("solver", "rtol", "atol", "step", "max_step", "theta"),
        *("impact", "sliding", "hysteresis"),
    )
    return {name: getattr(given, name) for name in names if getattr(given, name) is not None}


def exit_code(run: Result) -> int:
    """Return the exit code of a run: 0 only if it is sound and came to its end."""
    if run.status == "interrupted":
        return 130
    if run.error is not None:
        return run.error.exit_code
    return 0 if run.status == "ok" else NumericsError.exit_code
