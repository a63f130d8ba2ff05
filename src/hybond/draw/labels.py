"""Place small texts beside letters and lines where they touch nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from hybond.draw.geometry import Box, Point, Segment

Anchor = Literal["start", "middle", "end"]

_BUCKET = 80.0
_GAP = 3.0


class Clutter:
    """What is already drawn: boxes and segments, found by place.

    Examples
    --------
    >>> clutter = Clutter()
    >>> clutter.add_box(Box(0, 0, 10, 10))
    >>> clutter.add_line(((20, 0), (20, 10)))
    >>> clutter.hits(Box(5, 5, 30, 8)), clutter.hits(Box(11, 0, 19, 10))
    (5, 0)
    """

    def __init__(self) -> None:
        self._boxes: dict[tuple[int, int], list[tuple[int, Box]]] = {}
        self._lines: dict[tuple[int, int], list[tuple[int, Segment]]] = {}
        self._count = 0

    def add_box(self, box: Box) -> None:
        """Add letters."""
        self._count += 1
        for key in _keys(box):
            self._boxes.setdefault(key, []).append((self._count, box))

    def add_line(self, line: Segment) -> None:
        """Add a line."""
        self._count += 1
        (ax, ay), (bx, by) = line
        for key in _keys(Box(min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))):
            self._lines.setdefault(key, []).append((self._count, line))

    def hits(self, box: Box) -> int:
        """Return how bad it is to write into `box`: 3 for each letters met, 2 for each line."""
        boxes, lines = set(), set()
        for key in _keys(box):
            boxes |= {n for n, other in self._boxes.get(key, ()) if box.overlaps(other)}
            lines |= {n for n, line in self._lines.get(key, ()) if box.cut(line)}
        return 3 * len(boxes) + 2 * len(lines)


def _keys(box: Box) -> Iterator[tuple[int, int]]:
    for i in range(int(box.x0 // _BUCKET), int(box.x1 // _BUCKET) + 1):
        for j in range(int(box.y0 // _BUCKET), int(box.y1 // _BUCKET) + 1):
            yield i, j


@dataclass(frozen=True, slots=True)
class Place:
    """A place for a block of text: its box, and how the lines are aligned in it."""

    box: Box
    anchor: Anchor

    @property
    def x(self) -> float:
        """Where the lines of text are anchored."""
        if self.anchor == "start":
            return self.box.x0
        return self.box.x1 if self.anchor == "end" else (self.box.x0 + self.box.x1) / 2


def beside_element(letters: Box, size: Point, taken: set[str]) -> list[Place]:
    """Return places for the text of an element, best first.

    Parameters
    ----------
    letters : Box
        Of the element's symbol.
    size : (width, height)
        Of the block of text.
    taken : set of {"n", "e", "s", "w"}
        Sides where bonds leave.
    """
    order = "nsew" if taken == {"s"} else "snew"
    sides = [s for s in order if s not in taken] + [s for s in order if s in taken]
    return [_side(letters, size, s, gap) for gap in (_GAP, 4 * _GAP) for s in sides] + _corners(
        letters, size
    )


def beside_junction(letters: Box, size: Point, taken: set[str]) -> list[Place]:
    """Return places for the name of a junction, best first: a free side, else a corner."""
    free = [s for s in "ns" if s not in taken] + [s for s in "ew" if s not in taken]
    corners = _corners(letters, size)
    near = [_side(letters, size, s, _GAP) for s in free]
    return near + corners + [_side(letters, size, s, 4 * _GAP) for s in "nsew"]


def beside_bond(line: Segment, normal: Point, size: Point) -> list[Place]:
    """Return places for the number of a bond: opposite its barb, then on the barb's side."""
    places = []
    (ax, ay), (bx, by) = line
    for sign in (-1.0, 1.0):
        for along in (0.5, 0.36, 0.64, 0.24):
            # The block's half size along the normal keeps its nearest corner off the line.
            reach = 4.2 + abs(normal[0]) * size[0] / 2 + abs(normal[1]) * size[1] / 2
            x = ax + along * (bx - ax) + sign * reach * normal[0]
            y = ay + along * (by - ay) + sign * reach * normal[1]
            box = Box(x - size[0] / 2, y - size[1] / 2, x + size[0] / 2, y + size[1] / 2)
            places.append(Place(box, "middle"))
    return places


def best(places: list[Place], clutter: Clutter) -> tuple[Place, int]:
    """Return the first of the places that touches least, and how much it touches."""
    chosen, least = places[0], clutter.hits(places[0].box)
    for place in places[1:]:
        if least == 0:
            break
        hits = clutter.hits(place.box)
        if hits < least:
            chosen, least = place, hits
    return chosen, least


def _side(letters: Box, size: Point, side: str, gap: float) -> Place:
    w, h = size
    x, y = (letters.x0 + letters.x1) / 2, (letters.y0 + letters.y1) / 2
    if side == "n":
        return Place(Box(x - w / 2, letters.y0 - gap - h, x + w / 2, letters.y0 - gap), "middle")
    if side == "s":
        return Place(Box(x - w / 2, letters.y1 + gap, x + w / 2, letters.y1 + gap + h), "middle")
    if side == "e":
        left = letters.x1 + gap
        return Place(Box(left, y - h / 2, left + w, y + h / 2), "start")
    right = letters.x0 - gap
    return Place(Box(right - w, y - h / 2, right, y + h / 2), "end")


def _corners(letters: Box, size: Point) -> list[Place]:
    """Return places in the corners between bonds, nearest first."""
    w, h = size
    x, y = (letters.x0 + letters.x1) / 2, (letters.y0 + letters.y1) / 2
    places = []
    for gap in (10.0, 14.0, 20.0, 28.0, 38.0):
        for south in (False, True):
            for west in (False, True):
                top = y + gap if south else y - gap - h
                if west:
                    places.append(Place(Box(x - gap - w, top, x - gap, top + h), "end"))
                else:
                    places.append(Place(Box(x + gap, top, x + gap + w, top + h), "start"))
    return places
