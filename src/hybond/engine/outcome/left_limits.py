"""Limits from the left: a moment before, where a segment ends at a kink."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.chronicle import Chronicle
from hybond.engine.algebra.rounding import AT_KINK
from hybond.engine.tables import ModelTables
from hybond.model.expressions import Expr
from hybond.runs.trace import Segment, Trace

Vector = NDArray[np.float64]

MOMENTS = 64
"""Units in the last place that a limit from the left is before a kink, at first."""
ROUNDS = 7
"""How often that is made four times as long where the kink is not passed."""

Read = Callable[[Chronicle[Segment], NDArray[np.intp], Vector, Sequence[Expr]], list[Vector]]
"""Reads expressions at points: segments, the segment of each point, its time, expressions."""


def left_limits(
    tables: ModelTables,
    trace: Trace,
    segments: Chronicle[Segment],
    which: NDArray[np.intp],
    t: Vector,
    read: Read,
) -> Vector:
    """Return the times, a moment earlier where a segment ends at a kink: its left limit.

    A source that jumps there has the value behind the kink at the very time.
    """
    many = int(tables.numbers["kinks"]) + int(tables.numbers["slide_kinks"])
    starts = segments.times
    if not many or not len(t) or not len(starts):
        return t
    last = trace.events.times[-1:]
    end = last[0] if len(last) and last[0] > starts[-1] else np.inf
    ends = np.flatnonzero(np.append(starts, end)[which + 1] == t)
    if not len(ends):
        return t
    first = int(tables.numbers["kink_atom"])
    atoms = [
        tables.values.all[k]
        for name in ("atom_value", "atom_size")
        for k in tables.ints[name][first : first + many]
    ]
    here = np.array(read(segments, which[ends], t[ends], atoms))
    near = np.abs(here[:many]) <= AT_KINK * np.abs(here[many:])
    behind = np.sign(here[:many])
    earlier = np.array(t, dtype=float)
    moment = MOMENTS * np.spacing(np.maximum(np.abs(t[ends]), segments[-1].t[-1]))
    # a signal alone is no sum of terms that it is small beside: it is what it is just before,
    # and may begin at the kink itself
    near_t = np.maximum(t[ends] - moment, np.asarray(starts)[which[ends]])
    just = np.array(read(segments, which[ends], near_t, atoms[:many]))
    near |= (behind != 0.0) & (just * behind <= 0.0)
    todo = np.asarray(near.any(axis=0))
    for _ in range(ROUNDS):
        at = ends[todo]
        if not len(at):
            break
        before = np.maximum(t[at] - moment[todo], np.asarray(starts)[which[at]])
        earlier[at] = before
        there = np.array(read(segments, which[at], before, atoms[:many]))
        passed = (np.sign(there) != behind[:, todo]) & (there != 0.0)
        todo[todo] = (near[:, todo] & ~passed).any(axis=0)
        moment *= 4.0
    return earlier
