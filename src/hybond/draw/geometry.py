"""The geometry of a bond: numbers only. x to the right, y downwards, in pixels.

Conventions: the half arrow's barb is always on the same hand of the page, below a horizontal
bond and left of a vertical one; the causal stroke is a bar across the end of the bond where
effort acts as input, as long as the letters are high.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

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

    @property
    def middle(self) -> Point:
        """The point halfway."""
        return ((self.tail[0] + self.head[0]) / 2, (self.tail[1] + self.head[1]) / 2)

    def shortened(self, by: float) -> Segment:
        """Return the line less `by` at each end, or its middle if it is not that long."""
        (ax, ay), (bx, by_) = self.tail, self.head
        long = math.hypot(bx - ax, by_ - ay)
        part = min(by / long, 0.5) if long else 0.5
        dx, dy = part * (bx - ax), part * (by_ - ay)
        return ((ax + dx, ay + dy), (bx - dx, by_ - dy))


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


def bond_shape(tail: Box, head: Box, a: Point, b: Point, *, shift: float = 0.0) -> BondShape:
    """Return the shape of a bond between two nodes.

    Parameters
    ----------
    tail, head : Box
        The boxes of the nodes' letters; the line stays `CLEARANCE` away from them.
    a, b : point
        The points that the line joins: the centres of the nodes.
    shift : float
        Offset towards the barb's side, for parallel bonds.

    Examples
    --------
    >>> shape = bond_shape(Box(-5, -5, 5, 5), Box(95, -5, 105, 5), (0, 0), (100, 0))
    >>> shape.tail, shape.head
    ((10.5, 0.0), (89.5, 0.0))
    >>> shape.barb[1][1] > 0  # below
    True
    """
    dx, dy = b[0] - a[0], b[1] - a[1]
    nx, ny = barb_side(dx, dy)
    a, b = (a[0] + shift * nx, a[1] + shift * ny), (b[0] + shift * nx, b[1] + shift * ny)
    out, into = tail.grown(CLEARANCE).cut((a, b)), head.grown(CLEARANCE).cut((a, b))
    first, last = out[1] if out else 0.0, into[0] if into else 1.0
    if last <= first:  # letters that touch: a short bond is better than none
        first, last = 0.35, 0.65
    start = (a[0] + first * dx, a[1] + first * dy)
    end = (a[0] + last * dx, a[1] + last * dy)
    long = math.hypot(dx, dy)
    ux, uy = dx / long, dy / long
    size = min(BARB_LENGTH, 0.5 * long * (last - first))
    back, aside = size * math.cos(BARB_ANGLE), size * math.sin(BARB_ANGLE)
    tip = (end[0] - back * ux + aside * nx, end[1] - back * uy + aside * ny)
    return BondShape(start, end, (end, tip))


def stroke(shape: BondShape, end: int) -> Segment:
    """Return the causal stroke across the tail (`end` = 0) or head (`end` = 1) of a bond.

    Examples
    --------
    >>> shape = BondShape((0.0, 0.0), (50.0, 0.0), ((50.0, 0.0), (42.0, 6.0)))
    >>> stroke(shape, 1)
    ((50.0, 7.5), (50.0, -7.5))
    """
    nx, ny = barb_side(shape.head[0] - shape.tail[0], shape.head[1] - shape.tail[1])
    x, y = shape.head if end else shape.tail
    half = STROKE_LENGTH / 2
    return ((x + half * nx, y + half * ny), (x - half * nx, y - half * ny))
