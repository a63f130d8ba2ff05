"""Signals with jumps as lines: broken where they jump, with both limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

_VISIBLE = 0.004
"""A jump smaller than this part of the range is thinner than the line."""


@dataclass(frozen=True, slots=True)
class Trace:
    """A signal ready to be drawn."""

    t: Vector
    y: Vector
    """Shape (n,). `t` and `y`: one line; NaN where it is broken."""
    jumps: Vector
    """Shape (k, 3). Time, left limit and right limit of each visible jump."""


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
    values = np.concatenate([y for _, y in full])
    finite = values[np.isfinite(values)]
    span = float(finite.max() - finite.min()) if finite.size else 0.0
    ts: list[Vector] = []
    ys: list[Vector] = []
    jumps = []
    gap = np.array([np.nan])
    for k, (t, y) in enumerate(full):
        if k:
            left, right = float(full[k - 1][1][-1]), float(y[0])
            if not abs(right - left) <= _VISIBLE * span:
                jumps.append((float(t[0]), left, right))
                ts.append(gap)
                ys.append(gap)
        ts.append(t)
        ys.append(y)
    table = np.array(jumps) if jumps else np.zeros((0, 3))
    return Trace(np.concatenate(ts), np.concatenate(ys), table)


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
