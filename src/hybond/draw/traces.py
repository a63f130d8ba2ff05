"""Signals with jumps as lines: broken where they jump, with both limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

_VISIBLE = 0.004
"""A jump smaller than this part of the range is thinner than the line."""
_FEW = 8
"""Points in a column of pixels up to which all are drawn."""


@dataclass(frozen=True, slots=True)
class Trace:
    """A signal ready to be drawn."""

    t: Vector
    y: Vector
    """Shape (n,). `t` and `y`: one line; NaN where it is broken."""
    jumps: Vector
    """Shape (k, 3). Time, left limit and right limit of each visible jump."""

    def less(self, base: float) -> Trace:
        """Return the trace with all values less by `base`."""
        return Trace(self.t, self.y - base, self.jumps - np.array([0.0, base, base]))


def trace_of(pieces: Sequence[tuple[Vector, Vector]]) -> Trace:
    """Join the pieces of a signal, breaking the line at jumps.

    Examples
    --------
    >>> import numpy as np
    >>> one = (np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    >>> two = (np.array([1.0, 2.0]), np.array([-1.0, 0.0]))
    >>> trace = trace_of([one, two])
    >>> trace.jumps.tolist()
    [[1.0, 1.0, -1.0]]
    >>> int(np.isnan(trace.y).sum())
    1
    """
    full = [(t, y) for t, y in pieces if len(t)]
    if not full:
        return Trace(np.zeros(0), np.zeros(0), np.zeros((0, 3)))
    t, y = np.concatenate([t for t, _ in full]), np.concatenate([y for _, y in full])
    finite = y[np.isfinite(y)]
    span = float(finite.max() - finite.min()) if finite.size else 0.0
    starts = np.cumsum([len(t) for t, _ in full])[:-1]
    left, right = y[starts - 1], y[starts]
    with np.errstate(invalid="ignore"):
        broken = ~(np.abs(right - left) <= _VISIBLE * span)
    jumps = np.column_stack([t[starts], left, right])[broken]
    return Trace(np.insert(t, starts[broken], np.nan), np.insert(y, starts[broken], np.nan), jumps)


def thinned(trace: Trace, begin: float, end: float, *, columns: int) -> Trace:
    """Return a trace that looks the same when it is drawn that many pixels wide.

    Where a column of pixels holds many points, the first, lowest, highest and last of them are
    kept, in their order and without breaks: no spike is lost, and edges of fast switching are
    uprights. Elsewhere all stays as it is, with the breaks at jumps.

    Parameters
    ----------
    begin, end : float
        The time that the columns divide.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 1.0, 100001)
    >>> y = np.where(np.arange(t.size) == 70007, 5.0, 0.0)
    >>> thin = thinned(Trace(t, y, np.zeros((0, 3))), 0.0, 1.0, columns=500)
    >>> len(thin.t) <= 2100, float(thin.y.max())
    (True, 5.0)
    """
    if len(trace.t) <= _FEW * columns or not end > begin:
        return trace
    t, y = trace.t, trace.y
    # a break has no time of its own: it is in the column of what follows
    following = np.where(np.isnan(t), np.append(t[1:], t[-1:]), t)
    column = np.clip((following - begin) / (end - begin) * columns, 0, columns - 1).astype(int)
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    many = np.diff(starts, append=len(t)) > _FEW
    dense = np.repeat(many, np.diff(starts, append=len(t)))
    kept = ~dense
    for a, b in zip(starts[many], np.append(starts, len(t))[1:][many], strict=True):
        here = a + np.flatnonzero(np.isfinite(y[a:b]))
        if here.size:
            kept[here[[0, -1]]] = True
            kept[[here[np.argmin(y[here])], here[np.argmax(y[here])]]] = True
    at = np.clip((trace.jumps[:, 0] - begin) / (end - begin) * columns, 0, columns - 1)
    filled = np.zeros(columns, dtype=bool)
    filled[column[starts[many]]] = True
    return Trace(t[kept], y[kept], trace.jumps[~filled[at.astype(int)]])


def apart(times: Vector, gap: float) -> NDArray[np.bool_]:
    """Return which of the sorted `times` are at least `gap` from both neighbours.

    Examples
    --------
    >>> apart(np.array([0.0, 1.0, 1.01, 2.0]), 0.1).tolist()
    [True, False, False, True]
    """
    distance = np.diff(times, prepend=-np.inf, append=np.inf)
    near: NDArray[np.bool_] = distance >= gap
    return near[:-1] & near[1:]
