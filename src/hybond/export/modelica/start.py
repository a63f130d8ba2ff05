"""The state and mode in which hybond settles the start, and when the experiment ends."""

from __future__ import annotations

from dataclasses import dataclass

from hybond.errors import ModelError
from hybond.model.graph import FlatGraph, Mode
from hybond.runs.times import end_of
from hybond.simulation import simulate

PART = 1e-9
"""Part of the experiment that is run to see how the start settles."""


@dataclass(frozen=True, slots=True)
class Start:
    """Where the start settles."""

    mode: Mode
    values: tuple[float, ...]
    """Stored quantities, then integrals."""


def settled_start(graph: FlatGraph) -> Start:
    """Return where the start of a graph settles.

    Raises
    ------
    HybondError
        If it does not.
    """
    run = simulate(graph, until=PART * (until_of(graph) or 1.0), on_error="return")
    if not len(run.events):
        raise run.error or ModelError(
            "the start does not settle",
            code="HB-E681",
            where="the Modelica text",
            hint="give starts and guards that settle: hybond run says what they do",
        )
    event = run.events[0]
    return Start(event.steps[-1].mode, tuple(float(v) for v in event.after))


def until_of(graph: FlatGraph) -> float | None:
    """Return when the experiment ends, s; None if it does not say so."""
    return end_of(None, graph.experiment) if "until" in graph.experiment else None
