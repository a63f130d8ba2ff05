"""From a file and options to a run: what `run`, `explain` and `demo` share."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from hybond.cli.interrupt import Interruptible
from hybond.cli.lists import check_experiment
from hybond.cli.netlists import read_model
from hybond.cli.settings import flatten_with
from hybond.errors import NumericsError
from hybond.model.graph import FlatGraph
from hybond.progress import Progress
from hybond.result import Result
from hybond.simulation import simulate


def read_graph(file: str, settings: Sequence[str] = ()) -> FlatGraph:
    """Return the flat graph of a model file or netlist with the settings of ``--set``.

    Raises
    ------
    HybondError
    """
    graph = flatten_with(read_model(file)[0], settings)
    check_experiment(graph)
    return graph


def simulate_with(graph: FlatGraph, until: float, given: Namespace | None = None) -> Result:
    """Simulate with progress and Ctrl-C; errors of the run are in the result.

    Parameters
    ----------
    until : float
        s.
    given : Namespace
        The options of the solver; without it the model's own.
    """
    with Interruptible() as interruptible, Progress(until) as bar:

        def progress(t: float, events: int) -> None:
            bar(t, events)
            interruptible.check()

        return simulate(
            graph,
            until,
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


def exit_code(run: Result) -> int:
    """Return the exit code of a run: 0 only if it is sound and came to its end."""
    if run.status == "interrupted":
        return 130
    if run.error is not None:
        return run.error.exit_code
    return 0 if run.status == "ok" else NumericsError.exit_code
