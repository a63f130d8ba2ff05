"""Contacts that are closed for a whole period: which states near the start there are at all.

The mode holds speeds together, and a variation of the gap would stay as it is. But a state with a
gap comes back to the contact, and one with less than none there is not: variations are put onto
the gap's own surface, along the way on which the contact moves what it pushes.

    d <- d - E (C E)^-1 (C d + C_p dp)      C: the gap's slopes, E = A (1 - S): where impulses lead
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.fields import Fields
from hybond.analysis.sensitivity.switch import started
from hybond.analysis.sensitivity.tangent import Read
from hybond.result import Result

Vector = NDArray[np.float64]

MOVED = 1e-9
"""Part of the largest by which impulses move a gap at the least, or it is another's."""


def resting(run: Result, fields: Fields) -> Vector:
    """Return the variations that a period begins with, shape (n, n + parameters)."""
    n, many = fields.columns.time, len(fields.columns.parameters)
    found = np.eye(n, n + many)
    closed = _closed(run)
    segment, events = run.segments[0], run.trace.events
    if not closed or not len(events) or events[0].cause != "start":
        return found
    mode = list(segment.mode)
    for k in closed:
        mode[k] = run.graph.machines[k].states.index("open")
    begin = fields.within(segment, segment.t[:1])
    free = fields.entered(float(segment.t[0]), segment.y[0, :n], tuple(mode))
    laws = [run.graph.machines[k].law for k in closed]
    gaps = [free.tangent.rows.moving(law.gap) for law in laws if law is not None and law.gap]
    slopes = Read(free.tangent, gaps).at(free.at, free.bonds)[0]
    C, by = slopes[:, :n], slopes[:, n + 1 :]
    E = free.slopes[0, :, :n] @ (np.eye(n) - started(fields, events[0], found, begin)[:, :n])
    moved = C @ E
    if np.linalg.matrix_rank(moved, MOVED * float(np.abs(moved).max(initial=0.0))) < len(gaps):
        return found
    back = E @ np.linalg.pinv(moved)
    return found - back @ np.hstack([C, by])


def _closed(run: Result) -> list[int]:
    """Return the contacts with a gap that are closed all the time."""
    return [
        k
        for k, m in enumerate(run.graph.machines)
        if m.law is not None and m.law.kind == "unilateral" and m.law.gap is not None
        if all(m.states[s.mode[k]] == "closed" for s in run.segments)
    ]
