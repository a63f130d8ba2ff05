"""A motion that has come to an edge of where laws have values goes on from there."""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.methods.stepping import start
from hybond.engine.run.edges import reach_edges, straight_on, time_at_once
from hybond.engine.run.noted import note
from hybond.engine.run.run_records import Run, bound_of, count_step

EDGES: Final = 100
"""Edges in a row with next to no time between them that are reached."""


def is_at_edge(e: Engine, r: Run) -> bool:
    """Whether an edge has made a step as short as what is no time away from it; once at a time."""
    s = e.step
    short = s.t1 - s.t0 < time_at_once(e)
    near = e.model.edges > 0 and e.refusal and short and r.edge_at != e.t
    return near and not is_driven_on(e, r)


def begin_at_edge(e: Engine, r: Run) -> int:
    """Begin anew where a root in a law comes to nothing, if that is now."""
    if is_driven_on(e, r) or not reach_edges(e, r):
        return REFUSED
    return go_from_edge(e, r)


def is_driven_on(e: Engine, r: Run) -> bool:
    """Whether edges follow each other at once: what is led beyond where laws have values."""
    return r.edges > EDGES and e.t - r.edge_t <= time_at_once(e)


def go_from_edge(e: Engine, r: Run) -> int:
    """Note the way to the edges that was gone, in the time that it takes, and begin there."""
    if count_step(e, r) != OK:
        return REFUSED
    r.edges = r.edges + 1 if e.t - r.edge_t <= time_at_once(e) else 0
    r.edge_t = e.t
    if straight_on(e, r) and note(e, r, e.step.t1, e.step.t1) != OK:
        return REFUSED
    r.edge_at = e.t
    return start(e, e.t, e.y, bound_of(e), True)
