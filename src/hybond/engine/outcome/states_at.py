"""The state of a run at a time, as a record."""

from __future__ import annotations

import bisect

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.beginnings import place_of
from hybond.engine.outcome.combinations import ALONE, Combination
from hybond.engine.outcome.signals import Signals
from hybond.errors import UsageError
from hybond.model.expressions import Name
from hybond.model.fingerprint import fingerprint_of
from hybond.model.graph import FlatGraph, Mode
from hybond.model.unit_words import unit_of
from hybond.runs.states import Memory, State
from hybond.runs.trace import Trace

ROUNDED = 8
"""Last places by which a time that somebody has computed may be beyond an end of the run."""


def at_ends(t: NDArray[np.float64], begin: float, end: float) -> NDArray[np.float64]:
    """Return times, with those beyond an end of the run by rounding only at that end."""
    for bound, way in ((begin, -1.0), (end, 1.0)):
        beyond = way * (t - bound)
        near = (beyond > 0.0) & (beyond <= ROUNDED * np.spacing(abs(bound)))
        if near.any():
            t = np.where(near, bound, t)
    return t


def state_at(graph: FlatGraph, trace: Trace, signals: Signals, t: float | None) -> State:
    """Return the state of a run at a time, after what happened then; at its end with None.

    At the end it holds all that the run has seen: what goes on from there is as if it had not been
    interrupted. Elsewhere a run that starts from it has the same motion, within the tolerances.

    Raises
    ------
    UsageError
        HB-S110 for a time outside the run.
    """
    tables = signals.tables
    n = len(graph.storages) + len(graph.integrals)
    end = _end(trace)
    t = end if t is None else float(at_ends(np.array([t], dtype=float), trace.begin, end)[0])
    if not trace.begin <= t <= end:
        raise UsageError(
            f"the run goes from {trace.begin:.9g} to {end:.9g} s, not to {t:g} s",
            code="HB-S110",
            where="t",
            hint="ask for a time within it",
        )
    many = len(graph.machines)
    if t == end and trace.carried is not None:
        number, place = trace.carried
        y, mode = number[1 : 1 + n].tolist(), tuple(place[:many].tolist())
        landed = tuple(m.path for m, k in zip(graph.machines, place[many:].tolist()) if k >= 0)
        deep = True
    else:
        y, mode, landed, made = _within(graph, trace, signals, t)
        number = np.array([t, *y, *_root(trace, t)])
        place = place_of(
            tables,
            mode,
            landed,
            made.surfaces,
            product=made.product,
            modes=made.modes,
            meant=made.meant,
        )
        deep = False
    memory = Memory(
        fingerprint_of(graph),
        float(tables.numbers["span"]),
        tuple(number.tolist()),
        tuple(place.tolist()),
        deep,
    )
    stored = {s.path: y[s.index] for s in graph.storages}
    rest = {i.path: y[len(graph.storages) + i.index] for i in graph.integrals}
    assert graph.read is not None
    units = {path: unit_of(graph.read(path), graph) for path in (*stored, *rest)}
    return State(graph.name, t, stored, rest, graph.mode_names(mode), landed, units, memory)


def _root(trace: Trace, t: float) -> list[float]:
    """Return the solution of laws with several that was followed, as a run is handed it."""
    k = bisect.bisect_right(trace.roots, t, key=lambda root: root[0])
    motion = bisect.bisect_right(trace.segments.times, t) - 1
    if k == 0 or motion < 0 or trace.roots[k - 1][0] < trace.segments.times[motion]:
        return []  # the motion there follows none
    at, root = trace.roots[k - 1]
    if k < len(trace.roots) and at < t:
        behind, there = trace.roots[k]
        part = (t - at) / (behind - at)
        root = [a + part * (b - a) for a, b in zip(root, there, strict=True)]
    return [1.0, *root, *root]


def _end(trace: Trace) -> float:
    if trace.segments:
        return float(trace.segments[-1].t[-1])
    return trace.events.times[-1] if trace.events else trace.begin


def _within(
    graph: FlatGraph, trace: Trace, signals: Signals, t: float
) -> tuple[list[float], Mode, tuple[str, ...], Combination]:
    n = len(graph.storages) + len(graph.integrals)
    events = trace.events
    k = bisect.bisect_right(trace.segments.times, t) - 1
    last = events[-1] if events else None
    if last is not None and (k < 0 or (t == last.t and t == float(trace.segments[-1].t[-1]))):
        # an event at the very end starts no segment
        return last.after[:n].tolist(), last.steps[-1].mode, last.landed, ALONE
    segment = trace.segments[max(k, 0)]
    if t > segment.t[-1]:
        state, mode = signals.rest(segment, t)
        return state[:n].tolist(), mode, segment.landed, ALONE
    made = segment.combined if isinstance(segment.combined, Combination) else ALONE
    if t in segment.t:
        return segment.at(t)[:n].tolist(), segment.mode, segment.landed, made
    # the polynomial of a step is off the constraints of its mode by its error, which a run that
    # starts there would begin with: so what is read there, put back on them
    names = [Name(f"x:{s.index}") for s in graph.storages]
    names += [Name(f"s:{i.index}") for i in graph.integrals]
    found = signals.of(segment, names, np.array([t]))
    return [float(v[0]) for v in found], segment.mode, segment.landed, made
