"""Names of parts and nodes in schematics, where they cover least of wires and symbols."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Final, Literal

from hybond.draw.geometry import Box, Point
from hybond.draw.measure import width
from hybond.draw.scene import Group, Line, Mark, Text

CLEAR = 2.5
"""Pixels that texts keep from wires where they can."""
Anchor = Literal["start", "middle", "end"]
Wire = tuple[str, str, tuple[Point, ...]]
"""The ends of a bond as written, and the way of its wire."""
LABEL = 10.5
"""Size of letters."""
FARTHER: Final = 14.0
"""Pixels by which a name that finds no place is set off farther."""
_BESIDE_A_NODE: Final[tuple[tuple[float, float, Anchor], ...]] = (
    (5.0, -6.0, "start"),
    (-5.0, -6.0, "end"),
    (5.0, 14.0, "start"),
    (-5.0, 14.0, "end"),
)
"""Where the name of a node may stand, best first."""


def beside(box: Box, words: Sequence[str]) -> list[list[Mark]]:
    """Return the places of a name and what is written below it, best first."""
    (x, y), more = ((box.x0 + box.x1) / 2.0, (box.y0 + box.y1) / 2.0), len(words) - 1
    high = 13.0 * more
    places: list[tuple[float, float, Anchor]] = [
        (x, box.y1 + 12.0, "middle"),
        (x, box.y0 - 6.0 - high, "middle"),
        (box.x1 + 5.0, y + 4.0 - high / 2.0, "start"),
        (box.x0 - 5.0, y + 4.0 - high / 2.0, "end"),
        *((box.x1 + 5.0, y + aside, "start") for aside in (16.0, -8.0 - high)),
        *((box.x0 - 5.0, y + aside, "end") for aside in (16.0, -8.0 - high)),
        (box.x1 + 3.0, box.y0 - 4.0 - high, "start"),
        (box.x1 + 3.0, box.y1 + 10.0, "start"),
        (box.x0 - 3.0, box.y1 + 10.0, "end"),
        (box.x0 - 3.0, box.y0 - 4.0 - high, "end"),
        # beyond a wire that passes close by
        *((x, box.y1 + 12.0 + k * FARTHER, "middle") for k in (1, 2)),
        *((x, box.y0 - 6.0 - high - k * FARTHER, "middle") for k in (1, 2)),
        (box.x1 + 5.0 + FARTHER, y + 4.0 - high / 2.0, "start"),
        (box.x0 - 5.0 - FARTHER, y + 4.0 - high / 2.0, "end"),
    ]
    roles = ("name", "parameter")
    return [
        [Text(roles[k], w, u, v + 13.0 * k, anchor) for k, w in enumerate(words)]
        for u, v, anchor in places
    ]


def covers(own: Sequence[Box], lines: Sequence[tuple[Point, Point]], boxes: Sequence[Box]) -> int:
    """Return how many wires and symbols some texts cover."""
    hits = sum(b.cut(line) is not None for b in own for line in lines)
    return hits + sum(b.overlaps(other) for b in own for other in boxes)


def tight(
    own: Sequence[Box], lines: Sequence[tuple[Point, Point]], boxes: Sequence[Box]
) -> tuple[int, int]:
    """Return how many wires and symbols some texts cover, and how many they nearly do."""
    return covers(own, lines, boxes), covers([b.grown(CLEAR) for b in own], lines, ())


def close_by(
    own: Sequence[Box], lines: Sequence[tuple[Point, Point]], boxes: Sequence[Box]
) -> tuple[list[tuple[Point, Point]], list[Box]]:
    """Return the wires and symbols that may touch some texts: the others need no second look."""
    x0, y0 = min(b.x0 for b in own) - CLEAR, min(b.y0 for b in own) - CLEAR
    x1, y1 = max(b.x1 for b in own) + CLEAR, max(b.y1 for b in own) + CLEAR
    return [
        (p, q)
        for p, q in lines
        if min(p[0], q[0]) <= x1
        and max(p[0], q[0]) >= x0
        and min(p[1], q[1]) <= y1
        and max(p[1], q[1]) >= y0
    ], [b for b in boxes if b.x0 <= x1 and b.x1 >= x0 and b.y0 <= y1 and b.y1 >= y0]


def freest(
    places: Sequence[list[Mark]], lines: Sequence[tuple[Point, Point]], boxes: Sequence[Box]
) -> list[Mark]:
    """Return the texts, of those at several places, that cover least; the first of the best."""
    covered = [[box_of(mark) for mark in texts] for texts in places]
    near = close_by([box for own in covered for box in own], lines, boxes)
    costs = [tight(own, *near) for own in covered]
    return places[costs.index(min(costs))]


def named_nodes(
    at: Mapping[str, Point], drawn: Sequence[Group], wires: Sequence[Wire]
) -> list[Group]:
    """Return the names of places where wires meet, each where it covers least of what is drawn."""
    lines = [piece for _, _, way in wires for piece in itertools.pairwise(way)]
    boxes = [box_of(m) for g in drawn if g.name != "wire" for m in g.marks]
    found = []
    for name, (x, y) in at.items():
        texts: list[list[Mark]] = [
            [Text("junctionname", name, x + u, y + v, anchor)] for u, v, anchor in _BESIDE_A_NODE
        ]
        (text,) = freest(texts, lines, boxes)
        boxes.append(box_of(text))
        found.append(Group("node", name, name, (text,)))
    return found


def box_of(mark: Mark) -> Box:
    """Return what a line or a text covers."""
    if isinstance(mark, Line):
        xs, ys = zip(*mark.points)
        return Box(min(xs), min(ys), max(xs), max(ys))
    assert isinstance(mark, Text)
    wide = width(mark.text, LABEL)
    left = {"start": 0.0, "middle": wide / 2.0, "end": wide}[mark.anchor]
    return Box(mark.x - left, mark.y - LABEL, mark.x - left + wide, mark.y + 3.0)
