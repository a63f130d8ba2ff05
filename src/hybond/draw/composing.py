"""How the layout of a schematic stands on the paper: close together, and the right way round.

A layout of a graph has no left and no below. A draughtsman lets power come from the left, and puts
what everything is measured from, ground, tank or frame, at the bottom.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

Place = tuple[float, float]
_WIDE = 0.05
"""What is gained by being wide instead of high, beside all sources being at the left."""


def composed(
    places: Mapping[str, Place], sources: Sequence[str], grounds: Sequence[str]
) -> dict[str, Place]:
    """Return the places without empty rows and columns, turned as a reader expects it.

    Parameters
    ----------
    places : mapping of name to (x, y)
        In grid cells, y downwards.
    sources, grounds : sequence of str
        Names of what feeds the system, and of what stands for zero.

    Examples
    --------
    >>> composed({"load": (0.0, 0.0), "supply": (4.0, 0.0)}, ["supply"], [])
    {'load': (1.0, 0.0), 'supply': (0.0, 0.0)}
    """
    xs, ys = (_together([at[k] for at in places.values()]) for k in (0, 1))
    close = {name: (xs[x], ys[y]) for name, (x, y) in places.items()}
    wide, high = max(xs.values()), max(ys.values())
    best, found = -1.0, close
    for turned in (False, True):
        for left in (False, True):
            for up in (False, True):
                way = {n: _turned(at, wide, high, turned, left, up) for n, at in close.items()}
                across, down = (high, wide) if turned else (wide, high)
                worth = 2.0 + (_WIDE if across >= down else 0.0)
                worth -= _mean([way[n][0] for n in sources]) / (across or 1.0)
                worth += _mean([way[n][1] for n in grounds]) / (down or 1.0)
                if worth > best + 1e-9:
                    best, found = worth, way
    return found


def _together(values: Sequence[float]) -> dict[float, float]:
    """Return where lines stand if no gap between them is wider than one cell."""
    every = sorted(set(values))
    found = {every[0]: 0.0} if every else {}
    for a, b in pairwise(every):
        found[b] = found[a] + min(b - a, 1.0)
    return found


def _turned(at: Place, wide: float, high: float, turned: bool, left: bool, up: bool) -> Place:
    x, y = wide - at[0] if left else at[0], high - at[1] if up else at[1]
    return (y, x) if turned else (x, y)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else 0.0
