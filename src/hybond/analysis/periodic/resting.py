"""Contacts that are closed for a whole period: which states there are near its beginning at all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.fields import Fields
from hybond.analysis.sensitivity.gaps import closing, has_gap
from hybond.analysis.sensitivity.switch import started
from hybond.model.expressions import Expr
from hybond.model.graph import Mode
from hybond.result import Result

Vector = NDArray[np.float64]

ROUNDED = 1e-9
"""Part of its terms by which a gap may be open that is closed but for rounding."""
PLACES = 8
"""Last places of a state that are tried until something is zero."""
SOME = 1e-6
"""Part of a state by which it is moved to see what that does."""


def resting(run: Result, fields: Fields) -> Vector:
    """Return the variations that a period begins with, shape (n, n + parameters)."""
    n, many = fields.columns.time, len(fields.columns.parameters)
    found = np.eye(n, n + many)
    closed = [
        k
        for k, m in enumerate(run.graph.machines)
        if has_gap(fields, k) and all(m.states[s.mode[k]] == "closed" for s in run.segments)
    ]
    segment, events = run.segments[0], run.trace.events
    if not closed or not len(events) or events[0].cause != "start":
        return found
    mode = list(segment.mode)
    for k in closed:
        mode[k] = run.graph.machines[k].states.index("open")
    begin = fields.within(segment, segment.t[:1])
    free = fields.entered(float(segment.t[0]), segment.y[0, :n], tuple(mode))
    entry = started(fields, events[0], found, begin)[:, :n]
    less = closing(fields, closed, free, entry)
    return found if less is None else found - less


def shut(run: Result, x: Vector, mode: Mode) -> Vector | None:
    """Return a state that is closed where the one that a run began with was open by rounding.

    Parameters
    ----------
    x : array, shape (n,)
    mode : Mode
        In which it was to begin.

    Returns
    -------
    array, shape (n,), or None
        None if the run began in another mode for another reason.
    """
    graph, begun = run.graph, run.events[0].steps[-1].mode
    other = [k for k, (a, b) in enumerate(zip(mode, begun, strict=True)) if a != b]
    sizes = np.max([np.abs(s.y[:, : len(x)]).max(axis=0) for s in run.segments], axis=0)
    stored = len(graph.storages)
    found = x.copy()
    for k in other:
        law = graph.machines[k].law
        if law is None or law.gap is None or graph.machines[k].states[mode[k]] != "closed":
            return None
        # no distance, and no speed with which it grows
        for e, own in (law.gap, range(stored, len(x))), (law.net, range(stored)):
            moved = _to_zero(run, found, begun, e, own, sizes)
            if moved is None:
                return None
            found = moved
    return found if other else None


def _to_zero(
    run: Result, x: Vector, mode: Mode, e: Expr, own: range, sizes: Vector
) -> Vector | None:
    """Return a state in which something is zero to the last bit, that is so but for rounding.

    Parameters
    ----------
    own : range
        States of which one is moved: the one that moves it most.
    """
    t = run.t_begin

    def at(state: Vector) -> float:
        return float(run.signals.after(t, state, mode, [e])[0])

    value = at(x)
    effect = np.zeros(len(x))
    for k in own:
        if sizes[k] > 0.0:
            apart = x.copy()
            apart[k] += SOME * sizes[k]
            effect[k] = (at(apart) - value) / SOME
    best = int(np.argmax(np.abs(effect)))
    size = float(np.abs(effect).max(initial=0.0))
    if not size or abs(value) > ROUNDED * size:
        return None
    found = x.copy()
    found[best] -= value / effect[best] * sizes[best]
    middle = found[best]
    for ulps in range(PLACES):
        for side in (1, -1):
            found[best] = middle + side * ulps * np.spacing(middle)
            if at(found) == 0.0:
                return found
    return None
