"""What is collected of a member that was an ordinary run, and of the modes that any one wrote."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.errors import HybondError, UsageError
from hybond.model.graph import FlatGraph
from hybond.sweep.collect import Collector
from hybond.sweep.journeys import Journeys, journey_of

if TYPE_CHECKING:
    from hybond.result import Result


def read_run(
    run: Result, collectors: Sequence[Collector], graph: FlatGraph, *, modes: bool
) -> tuple[dict[str, Any], HybondError | None]:
    """Return what is collected of a run, and the first thing that there is not.

    Parameters
    ----------
    graph : FlatGraph
        Of the model that ran.
    modes : bool
        Whether any of them wants the modes that were written.
    """
    found: dict[str, Any] = {}
    failed: HybondError | None = None
    journey = journey_of(run) if modes and run.segments else None
    for c in collectors:
        try:
            if c.measure is not None:
                found[c.text] = float(c.measure.of(run)) if run.segments else np.nan
            elif c.function == "ended":
                found[c.text] = run.ended_by
            elif c.of_modes:
                if journey is not None:
                    found[c.text] = of_modes(c, journey, graph)[0]
            elif c.function == "count":
                found[c.text] = run.trace.events.total
            elif run.segments:
                found[c.text] = _read(c, run)
        except HybondError as error:
            failed = failed or error
    return found, failed


def _read(c: Collector, run: Result) -> Any:
    if c.function == "final":
        return run.sample(run.t_end, [c.signal])[c.signal][0]
    if c.function == "at":
        if not c.t <= run.t_end:
            raise UsageError(
                f"{c.text}: the run ended at {run.t_end:.9g} s",
                code="HB-S110",
                where=c.text,
                hint="ask for a time within it",
            )
        return run.sample(c.t, [c.signal])[c.signal][0]
    t = np.linspace(0.0, run.until, c.points)
    row = np.full(c.points, np.nan)
    there = t <= run.t_end
    row[there] = run.sample(t[there].tolist(), [c.signal])[c.signal]
    return row


def of_modes(c: Collector, journeys: Journeys, graph: FlatGraph) -> Any:
    """Return what is collected of modes, for each run."""
    match c.function:
        case "mode_time":
            return journeys.time_in(c.machine, c.states)
        case "first":
            return journeys.first_in(c.machine, c.states)
        case "mode":
            return journeys.last_modes(graph)
        case "sequence":
            return journeys.sequences(graph)
        case _:
            return journeys.changes_of(c.machine)
