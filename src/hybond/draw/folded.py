"""A circuit that is much wider than a page, folded into bands one below the other.

Where few rails pass the picture is cut; a rail that goes on leaves its band at the right and enters
the next one at the left. The zero goes down at the left of all.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from hybond.draw.geometry import Point

WIDEST = 2200.0
"""Pixels from which on a picture is folded."""
SHAPE = 3.0
"""How much wider than high a folded one is, about."""
MOST = 3
"""Rails that may pass where it is cut, beside the zero."""
CHANNEL, STEP = 90.0, 10.0
"""Pixels between two bands, and between two wires in that."""


@dataclass(frozen=True, slots=True)
class Folds:
    """Bands, and the ways of rails from one to the next.

    Parameters
    ----------
    tall : float
        From a place in a band to the same in the next one.
    lowest : float
        The lowest rail of the first band.
    sides : mapping of node to (left, right, down)
        Of rails that pass where it is cut: the places at which they go down, and how far below
        the lowest rail they go back.
    zero : str
    """

    tall: float
    lowest: float
    sides: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    zero: str = ""

    def band(self, y: float) -> int:
        """Return the band in which a place is."""
        return max(0, math.floor((y - self.lowest + 0.7 * self.tall) / self.tall))

    def way(self, a: Point, b: Point, node: str, dot: Point) -> tuple[Point, ...]:
        """Return the way from a place to another by the rail of a node, whose dot is given."""
        own, there = self.band(a[1]), self.band(b[1])
        from_dot = [k - self.band(dot[1]) for k in range(max(own, there) + 1)]
        rails = [dot[1] + k * self.tall for k in from_dot]
        points = [a, (a[0], rails[own])]
        if own != there:
            left, right, down = self.sides[node]
            if node == self.zero:
                points += [(left, rails[own]), (left, rails[there])]
            else:
                turns = []
                for k in range(min(own, there), max(own, there)):
                    back = self.lowest + k * self.tall + down
                    turns += [(right, rails[k]), (right, back), (left, back), (left, rails[k + 1])]
                points += turns if own < there else turns[::-1]
        return plain([*points, (b[0], rails[there]), b])


def plain(points: Sequence[Point]) -> tuple[Point, ...]:
    """Leave out places that are no corners."""
    found = [points[0]]
    for p in points[1:]:
        if p == found[-1]:
            continue
        if len(found) > 1:
            a, b = found[-2], found[-1]
            if a[0] == b[0] == p[0] or a[1] == b[1] == p[1]:
                found.pop()
        found.append(p)
    return tuple(found) if len(found) > 1 else (points[0], points[-1])


def cuts(
    xs: Sequence[float], tall: float, spans: Sequence[tuple[int, int]], together: set[int]
) -> list[int]:
    """Return the columns at which bands begin, beside the first: none of a picture that fits.

    Parameters
    ----------
    xs : sequence of float
        Where columns are.
    spans : sequence of (first, last)
        From which column to which each rail goes, the zero left out.
    together : set of int
        Columns that stay with the next one.

    Examples
    --------
    >>> cuts([100.0 * k for k in range(40)], 300.0, [(k, k + 1) for k in range(39)], set())
    [19]
    """
    wide = xs[-1] - xs[0]
    if wide <= WIDEST:
        return []
    bands = max(2, round(math.sqrt(wide / (SHAPE * tall))))
    found: list[int] = []
    for k in range(1, bands):
        aim = xs[0] + wide * k / bands
        near = [
            c
            for c in range((found[-1] if found else 0) + 2, len(xs) - 1)
            if c - 1 not in together and abs(xs[c] - aim) < 0.4 * wide / bands
        ]
        rails = {c: sum(a < c <= b for a, b in spans) for c in near}
        fit = [c for c in near if rails[c] <= MOST]
        if fit:
            found.append(min(fit, key=lambda c: (rails[c], abs(xs[c] - aim))))
    return found


def folds(
    nodes: Mapping[str, tuple[int, int]],
    zero: str,
    starts: Sequence[int],
    wide: float,
    size: tuple[float, float],
) -> Folds:
    """Return the folds of a picture whose bands begin at some columns.

    Parameters
    ----------
    nodes : mapping of node to (first, last)
        From which column to which its rail goes.
    wide : float
        Where the widest band ends; all begin at zero.
    size : (lowest, deep)
        The lowest rail, and how far parts go down from the highest one.
    """
    sides: dict[str, tuple[float, float, float]] = {zero: (-6.0 * STEP, 0.0, 0.0)}
    lanes: dict[int, int] = {}
    for name, (first, last) in nodes.items():
        passed = [k for k, c in enumerate(starts) if first < c <= last]
        if name == zero or not passed:
            continue
        lane = max(lanes.get(k, 0) for k in passed)
        for k in passed:
            lanes[k] = lane + 1
        aside = STEP * lane
        sides[name] = (-2.0 * STEP - aside, wide + 2.0 * STEP + aside, CHANNEL / 2.0 + aside)
    return Folds(size[1] + CHANNEL, size[0], sides, zero)
