"""Where a law bends along a way: the points that a quadrature must not step over."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

SAMPLES = 16
"""Parts of the way in each of which a bend is looked for."""
HALVINGS = 60


def bends(turning: Sequence[Callable[[float], float]]) -> list[float]:
    """Return where functions change their sign between 0 and 1, in order."""
    marks = [k / SAMPLES for k in range(SAMPLES + 1)]
    found: set[float] = set()
    for f in turning:
        values = [f(a) for a in marks]
        for (low, high), (one, other) in zip(pairwise(marks), pairwise(values), strict=True):
            if one * other < 0.0:
                found.add(_root(f, low, high, one))
            elif other == 0.0 and high < 1.0:
                found.add(high)
    return sorted(found)


def _root(f: Callable[[float], float], low: float, high: float, one: float) -> float:
    """Return where a function changes its sign, by halves."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if f(middle) * one > 0.0:
            low = middle
        else:
            high = middle
    return high
