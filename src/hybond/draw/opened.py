"""Frames around parts that are open: a rectangle where nothing else lies in it, else a ground."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.draw.geometry import Box, Point
from hybond.draw.scene import Band, Frame, Group, Mark, Text
from hybond.draw.sketch import Sketch
from hybond.draw.words import extent_of_groups

_ROOM = 8.0
_BREADTH = 44.0
_NAME = 16.0
"""Height of the name above what is in the frame."""


def opened(sketch: Sketch, nodes: Sequence[Group], centres: Sequence[Point]) -> tuple[Group, ...]:
    """Return what marks the open parts of a sketch, outermost first."""
    found: list[Group] = []
    extents = [extent_of_groups([g]) for g in nodes]
    for frame in sketch.frames:
        if not frame.members:
            continue
        inside = [extents[k] for k in frame.members]
        box = Box(
            min(b.x0 for b in inside) - _ROOM,
            min(b.y0 for b in inside) - _ROOM - _NAME,
            max(b.x1 for b in inside) + _ROOM,
            max(b.y1 for b in inside) + _ROOM,
        )
        members = set(frame.members)
        foreign = any(box.overlaps(b) for k, b in enumerate(extents) if k not in members)
        marks: list[Mark] = []
        if foreign:
            marks += [
                Band("emphasis", (centres[a.tail], centres[a.head]), _BREADTH)
                for a in sketch.arrows
                if a.tail in members and a.head in members
            ]
            marks += [
                Band("emphasis", (centres[k], (centres[k][0] + 0.1, centres[k][1])), _BREADTH)
                for k in frame.members
            ]
            first = min(inside, key=lambda b: (b.y0, b.x0))
            marks.append(Text("partname", frame.path, first.x0, first.y0 - 4.0, "start"))
        else:
            marks.append(Frame("opened", box, 6.0))
            marks.append(Text("partname", frame.path, box.x0 + 7.0, box.y0 + 13.0, "start"))
        found.append(Group("part", frame.path, frame.path, tuple(marks)))
    return tuple(found)
