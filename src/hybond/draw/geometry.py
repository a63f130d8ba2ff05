"""The geometry of a bond: numbers only. x to the right, y downwards, in pixels.

Conventions: the half arrow's barb is always on the same hand of the page, below a horizontal
bond and left of a vertical one; the causal stroke is a bar across the end of the bond where
effort acts as input, as long as the letters are high.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

Point = tuple[float, float]
Segment = tuple[Point, Point]

CLEARANCE = 5.5
"""Between a node's letters and the end of a bond."""
BARB_LENGTH = 11.0
BARB_ANGLE = math.radians(35.0)
STROKE_LENGTH = 15.0
PARALLEL = 9.0
"""Between bonds that join the same two nodes."""


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle with sides parallel to the axes.

    Examples
    --------
    >>> Box(0, 0, 10, 10).overlaps(Box(9, 9, 20, 20)), Box(0, 0, 1, 1).overlaps(Box(2, 0, 3, 1))
    (True, False)
    """

    x0: float
    y0: float
    x1: float
    y1: float

    def grown(self, by: float) -> Box:
        """Return the box with `by` added on every side."""
        return Box(self.x0 - by, self.y0 - by, self.x1 + by, self.y1 + by)

    def overlaps(self, other: Box) -> bool:
        """Whether the interiors meet."""
        return (
            self.x0 < other.x1 and other.x0 < self.x1 and self.y0 < other.y1 and other.y0 < self.y1
        )

    def cut(self, segment: Segment) -> tuple[float, float] | None:
        """Return the fractions of a segment at which it enters and leaves the box.

        Liang and Barsky's clipping; None if the segment does not pass through the interior.

        Examples
        --------
        >>> Box(1, -1, 2, 1).cut(((0, 0), (4, 0)))
        (0.25, 0.5)
        """
        (ax, ay), (bx, by) = segment
        low, high = 0.0, 1.0
        for start, step, least, most in (
            (ax, bx - ax, self.x0, self.x1),
            (ay, by - ay, self.y0, self.y1),
        ):
            if step == 0.0:
                if not least < start < most:
                    return None
                continue
            one, two = (least - start) / step, (most - start) / step
            low, high = max(low, min(one, two)), min(high, max(one, two))
        return (low, high) if low < high else None


@dataclass(frozen=True, slots=True)
class BondShape:
    """A drawn bond: its line from tail to head, and its barb from the head backwards."""

    tail: Point
    head: Point
    barb: Segment
    bends: tuple[Point, ...] = ()

    @property
    def points(self) -> tuple[Point, ...]:
        """The line, from tail to head."""
        return (self.tail, *self.bends, self.head)

    @property
    def longest(self) -> Segment:
        """The longest straight piece of the line, the first of those that are equal."""
        return max(pairwise(self.points), key=lambda piece: round(math.dist(*piece), 6))

    @property
    def middle(self) -> Point:
        """The point halfway along its longest piece."""
        (ax, ay), (bx, by) = self.longest
        return ((ax + bx) / 2, (ay + by) / 2)

    def end(self, end: int) -> Segment:
        """Return the piece at the tail (0) or head (1), in the direction of the bond."""
        return (self.points[-2], self.head) if end else (self.tail, self.points[1])

    def shortened(self, by: float) -> tuple[Point, ...]:
        """Return the line less `by` at each end, or the middle of a piece not that long."""
        points = list(self.points)
        for here, there in ((0, 1), (-1, -2)):
            (ax, ay), (bx, by_) = points[here], points[there]
            long = math.hypot(bx - ax, by_ - ay)
            most = long / 2 if len(points) == 2 and here == 0 else long
            part = min(by, most) / long if long else 0.0
            points[here] = (ax + part * (bx - ax), ay + part * (by_ - ay))
        return tuple(points)


def barb_side(dx: float, dy: float) -> Point:
    """Return the unit normal on the barb's side of a line that runs along (dx, dy).

    Examples
    --------
    >>> barb_side(1.0, 0.0), barb_side(-1.0, 0.0)  # below, whichever way the power flows
    ((0.0, 1.0), (0.0, 1.0))
    >>> barb_side(0.0, 1.0), barb_side(0.0, -1.0)  # left
    ((-1.0, 0.0), (-1.0, 0.0))
    """
    long = math.hypot(dx, dy)
    nx, ny = -dy / long, dx / long
    below = ny > 0 if abs(dx) >= abs(dy) else nx < 0
    return (nx + 0.0, ny + 0.0) if below else (-nx + 0.0, -ny + 0.0)


def bond_shape(
    tail: Box, head: Box, a: Point, b: Point, *, shift: float = 0.0, bends: Sequence[Point] = ()
) -> BondShape:
    """Return the shape of a bond between two nodes.

    Parameters
    ----------
    tail, head : Box
        The boxes of the nodes' letters; the line stays `CLEARANCE` away from them.
    a, b : point
        The points that the line joins: the centres of the nodes.
    shift : float
        Offset towards the barb's side, for parallel bonds.
    bends : sequence of point
        Where the line bends on its way.

    Examples
    --------
    >>> shape = bond_shape(Box(-5, -5, 5, 5), Box(95, -5, 105, 5), (0, 0), (100, 0))
    >>> shape.tail, shape.head
    ((10.5, 0.0), (89.5, 0.0))
    >>> shape.barb[1][1] > 0  # below
    True
    """
    points = _beside((a, *bends, b), shift) if shift else (a, *bends, b)
    first, second = (points[0], points[1]), (points[-2], points[-1])
    out, into = tail.grown(CLEARANCE).cut(first), head.grown(CLEARANCE).cut(second)
    leave, reach = out[1] if out else 0.0, into[0] if into else 1.0
    if len(points) == 2 and reach <= leave:  # letters that touch: a short bond beats none
        leave, reach = 0.35, 0.65
    start, end = _along(first, min(leave, 0.95)), _along(second, max(reach, 0.05))
    dx, dy = second[1][0] - second[0][0], second[1][1] - second[0][1]
    nx, ny = barb_side(dx, dy)
    long = math.hypot(dx, dy)
    ux, uy = dx / long, dy / long
    last = math.dist(start if len(points) == 2 else second[0], end)
    size = min(BARB_LENGTH, 0.5 * last if len(points) == 2 else last)
    back, aside = size * math.cos(BARB_ANGLE), size * math.sin(BARB_ANGLE)
    tip = (end[0] - back * ux + aside * nx, end[1] - back * uy + aside * ny)
    return BondShape(start, end, (end, tip), tuple(points[1:-1]))


def _along(piece: Segment, part: float) -> Point:
    (ax, ay), (bx, by) = piece
    return (ax + part * (bx - ax), ay + part * (by - ay))


def _beside(points: Sequence[Point], shift: float) -> tuple[Point, ...]:
    """Return a line beside another, towards the barb's side of each of its pieces."""
    moves: list[tuple[float, float]] = []
    for (ax, ay), (bx, by) in pairwise(points):
        nx, ny = barb_side(bx - ax, by - ay)
        moves.append((shift * nx, shift * ny))
    found = []
    for k, (x, y) in enumerate(points):
        near = {moves[max(k - 1, 0)], moves[min(k, len(moves) - 1)]}
        found.append((x + sum(m[0] for m in near), y + sum(m[1] for m in near)))
    return tuple(found)


def stroke(shape: BondShape, end: int) -> Segment:
    """Return the causal stroke across the tail (`end` = 0) or head (`end` = 1) of a bond.

    Examples
    --------
    >>> shape = BondShape((0.0, 0.0), (50.0, 0.0), ((50.0, 0.0), (42.0, 6.0)))
    >>> stroke(shape, 1)
    ((50.0, 7.5), (50.0, -7.5))
    """
    (ax, ay), (bx, by) = shape.end(end)
    nx, ny = barb_side(bx - ax, by - ay)
    x, y = shape.head if end else shape.tail
    half = STROKE_LENGTH / 2
    return ((x + half * nx, y + half * ny), (x - half * nx, y - half * ny))
