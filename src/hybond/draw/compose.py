"""From a sketch and grid positions to marks with their places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from hybond.draw.arrange import Arrangement
from hybond.draw.geometry import (
    PARALLEL,
    BondShape,
    Box,
    Point,
    Segment,
    barb_side,
    bond_shape,
    stroke,
)
from hybond.draw.grid import grid_of
from hybond.draw.labels import (
    Clutter,
    Place,
    beside_bond,
    beside_element,
    beside_junction,
    best,
)
from hybond.draw.measure import shorten, width, wrapped
from hybond.draw.opened import opened
from hybond.draw.scene import Band, Frame, Group, Line, Mark, Text
from hybond.draw.sketch import Arrow, Sketch, Symbol
from hybond.draw.style import look

_CAP = 0.73
"""Height of a capital letter per font size."""
_LEADING = 1.22
"""Distance of lines of text per font size."""
_ROOM = 130.0
"""Widest small text before it is cut."""
_ROOMS = ((_ROOM, 3), (100.0, 3), (_ROOM, 1), (70.0, 3), (70.0, 1), (45.0, 1), (30.0, 1), (20.0, 1))
"""Width and lines of a law that are tried in turn for the small text of a symbol."""
_REGION = 24.0
"""Breadth of the ground under a bond of dynamic causality and the nodes that it joins."""
_EMPHASIS = 17.0
_SHORTER = 6.0
"""By which that ground ends before the bond, so that its round end touches no letters."""
_CROSS = 4.5
"""Half the size of the cross on a bond in conflict."""


@dataclass(frozen=True, slots=True)
class _Words:
    """One line of small text."""

    role: str
    text: str

    @property
    def size(self) -> float:
        return look(self.role).size or 10.0

    @property
    def width(self) -> float:
        return width(self.text, self.size) + (8.0 if self.in_frame else 0.0)

    @property
    def height(self) -> float:
        return self.size * (1.75 if self.in_frame else _LEADING)

    @property
    def in_frame(self) -> bool:
        return self.role.startswith("badge")


def compose(sketch: Sketch, places: Arrangement) -> tuple[Group, ...]:
    """Return the marks of a sketch whose symbols and arrows have these `places`.

    Where letters and texts stand does not depend on the strokes, so that the pictures of two
    modes lie exactly on each other.
    """
    words = [_words(s, _ROOM) for s in sketch.symbols]
    grid = grid_of(
        places.positions,
        [max((w.width for w in ws), default=0.0) for ws in words],
        corner=[s.is_junction for s in sketch.symbols],
        bends=places.bends,
    )
    centres = [grid.at(p) for p in places.positions]
    bends = [tuple(grid.at(p) for p in way) for way in places.bends]
    boxes = [_letters(s, c) for s, c in zip(sketch.symbols, centres, strict=True)]
    framed = [
        b.grown(2.0) if s.controlled else b for s, b in zip(sketch.symbols, boxes, strict=True)
    ]
    shapes = _shapes(sketch.arrows, framed, centres, bends)

    clutter = Clutter()
    for box in framed:
        clutter.add_box(box)
    groups = []
    for arrow, shape in zip(sketch.arrows, shapes, strict=True):
        marks = _bond_marks(arrow, shape)
        for line in (
            *pairwise(shape.points),
            shape.barb,
            stroke(shape, 0),
            stroke(shape, 1),
            *_cross(shape),
        ):
            clutter.add_line(line)
        groups.append((arrow, shape, marks))

    nodes = []
    # Elements first: their places are better defined than the corners of junctions.
    order = sorted(range(len(boxes)), key=lambda k: sketch.symbols[k].is_junction)
    texts: dict[int, tuple[Mark, ...]] = {}
    for k in order:
        taken = _sides(k, sketch.arrows, centres, bends)
        texts[k] = _label(sketch.symbols[k], framed[k], taken, clutter)
    for k, symbol in enumerate(sketch.symbols):
        marks_of = (*_node_marks(symbol, boxes[k], centres[k]), *texts[k])
        nodes.append(Group("node", symbol.path, symbol.about, marks_of))

    bonds = []
    for arrow, shape, marks in groups:
        number = _number(arrow, shape, clutter)
        bonds.append(Group("bond", arrow.name, arrow.name, (*marks, *number)))
    grounds = _grounds(sketch, shapes, centres, bends, framed)
    return (*opened(sketch, nodes, centres), *grounds, *bonds, *nodes)


def _grounds(
    sketch: Sketch,
    shapes: Sequence[BondShape],
    centres: Sequence[Point],
    bends: Sequence[Sequence[Point]],
    framed: Sequence[Box],
) -> tuple[Group, ...]:
    """Return what lies under the graph: regions of dynamic causality, bonds pointed out."""
    bands: list[Mark] = [
        Band("region", (centres[a.tail], *way, centres[a.head]), _REGION)
        for a, way in zip(sketch.arrows, bends, strict=True)
        if a.region
    ]
    bands += [
        Band("emphasis", shape.shortened(_SHORTER), _EMPHASIS)
        for a, shape in zip(sketch.arrows, shapes, strict=True)
        if a.emphasis
    ]
    within = {node for a in sketch.arrows if a.region for node in (a.tail, a.head)}
    # The frame of a switch is larger than the ends of the bands.
    bands += [
        Frame("ground", framed[node].grown(2.0))
        for node in sorted(within)
        if sketch.symbols[node].controlled
    ]
    return (Group("region", "", "", tuple(bands)),) if bands else ()


def _words(symbol: Symbol, room: float, most: int = 1) -> tuple[_Words, ...]:
    """Return the small text of a symbol, line by line; a law has at most so many."""
    state = " off" if symbol.off else ""
    role = "junctionname" if symbol.is_junction else "name"
    lines = [] if symbol.kind == "part" else [(role + state, symbol.path, True)]
    said = "parameter" + state
    law = wrapped(symbol.parameter, look(said).size or 10.0, room, most=most)
    lines += [(said, line, False) for line in law]
    if symbol.machine:
        lines.append(("machine" + state, f"[{symbol.machine}]", False))
    if symbol.law:
        lines.append(("badge grey", symbol.law, False))
    if symbol.badge is not None:
        lines.append((f"badge {symbol.badge.tone}", symbol.badge.text, False))
    return tuple(
        _Words(role, shorten(text, look(role).size or 10.0, room, keep_end=keep_end))
        for role, text, keep_end in lines
        if text
    )


def _letters(symbol: Symbol, centre: Point) -> Box:
    """Return the box of a symbol's letters, with the subscript of a controlled one."""
    if symbol.kind == "part":
        half = max(
            width(symbol.letters, look("node boxed").size or 13.0, bold=True) / 2 + 7.0, 20.0
        )
        return Box(centre[0] - half, centre[1] - 14.0, centre[0] + half, centre[1] + 14.0)
    size = look("node").size or 19.0
    half = max(width(symbol.letters, size, bold=True) / 2, 6.0)
    if symbol.controlled:
        half += 6.0
    return Box(
        centre[0] - half,
        centre[1] - _CAP * size / 2 - 1.0,
        centre[0] + half,
        centre[1] + _CAP * size / 2 + (3.0 if symbol.controlled else 1.0),
    )


def _shapes(
    arrows: Sequence[Arrow],
    boxes: Sequence[Box],
    centres: Sequence[Point],
    bends: Sequence[Sequence[Point]],
) -> list[BondShape]:
    together: dict[tuple[int, int], list[int]] = {}
    for k, a in enumerate(arrows):
        together.setdefault((min(a.tail, a.head), max(a.tail, a.head)), []).append(k)
    shapes = []
    for k, a in enumerate(arrows):
        same = together[min(a.tail, a.head), max(a.tail, a.head)]
        shift = PARALLEL * (same.index(k) - (len(same) - 1) / 2)
        ends = (boxes[a.tail], boxes[a.head], centres[a.tail], centres[a.head])
        shapes.append(bond_shape(*ends, shift=shift, bends=bends[k]))
    return shapes


def _bond_marks(arrow: Arrow, shape: BondShape) -> list[Line]:
    state = (" off" if arrow.off else "") + (" conflict" if arrow.conflict else "")
    marks = [
        Line("bond" + state, shape.points),
        Line("barb" + state, shape.barb),
    ]
    for end in arrow.strokes:
        late = " derivative" if end in arrow.late else ""
        marks.append(Line("stroke" + late + state, stroke(shape, end)))
    for end in arrow.dashed:
        # What is OFF in the reference mode is ON where a dashed stroke counts: no grey.
        late = " derivative" if end in arrow.late else ""
        marks.append(Line("stroke dynamic" + late, stroke(shape, end)))
    if arrow.conflict:
        marks += [Line("cross conflict", line) for line in _cross(shape)]
    return marks


def _cross(shape: BondShape) -> tuple[Segment, Segment]:
    """Return the cross that strikes out the middle of a bond."""
    (x, y), c = shape.middle, _CROSS
    return ((x - c, y - c), (x + c, y + c)), ((x - c, y + c), (x + c, y - c))


def _node_marks(symbol: Symbol, box: Box, centre: Point) -> list[Mark]:
    if symbol.kind == "part":
        late = " derivative" if symbol.derivative else ""
        role = "node boxed" + late + (" off" if symbol.off else "")
        baseline = centre[1] + 0.36 * (look("node boxed").size or 13.0)
        return [Frame("part" + late, box, 3.0), Text(role, symbol.letters, centre[0], baseline)]
    size = look("node").size or 19.0
    role = "node junction" if symbol.is_junction else "node"
    if symbol.controlled:
        role += " controlled " + ("off" if symbol.off else "on")
    if symbol.derivative:
        role += " derivative"
    baseline = centre[1] + _CAP * size / 2
    marks: list[Mark] = []
    if symbol.controlled:
        state = " off" if symbol.off else ""
        marks.append(Frame("switch" + state, box.grown(2.0)))
        # The letter moves left for its subscript, so that the pair stands in the middle.
        shift = width(symbol.letters, size, bold=True) / 2
        marks.append(Text(role, symbol.letters, centre[0] - 4.0, baseline))
        marks.append(
            Text("subscript" + state, "c", centre[0] + shift - 3.5, baseline + 3.5, "start")
        )
    else:
        marks.append(Text(role, symbol.letters, centre[0], baseline))
    return marks


def _sides(
    node: int,
    arrows: Sequence[Arrow],
    centres: Sequence[Point],
    bends: Sequence[Sequence[Point]],
) -> set[str]:
    """Return the compass sides of a node where bonds leave."""
    sides = set()
    for a, way in zip(arrows, bends, strict=True):
        if node not in (a.tail, a.head):
            continue
        other = (*way, centres[a.head])[0] if a.tail == node else (centres[a.tail], *way)[-1]
        dx, dy = other[0] - centres[node][0], other[1] - centres[node][1]
        if abs(dy) >= 0.3 * abs(dx):
            sides.add("s" if dy > 0 else "n")
        if abs(dx) >= 0.3 * abs(dy):
            sides.add("e" if dx > 0 else "w")
    return sides


def _label(symbol: Symbol, box: Box, taken: set[str], clutter: Clutter) -> tuple[Mark, ...]:
    """Place the small text of a symbol; where there is no room for all, it is cut."""
    found: tuple[Place, int, tuple[_Words, ...]] | None = None
    for room, most in _ROOMS:
        lines = _words(symbol, room, most)
        if not lines:
            return ()
        size = (max(w.width for w in lines), sum(w.height for w in lines))
        options = (beside_junction if symbol.is_junction else beside_element)(box, size, taken)
        place, hits = best(options, clutter)
        if found is None or hits < found[1]:
            found = (place, hits, lines)
        if hits == 0:
            break
    assert found is not None
    place, _, lines = found
    clutter.add_box(place.box)
    marks: list[Mark] = []
    y = place.box.y0
    for w in lines:
        y += w.height
        if not w.in_frame:
            marks.append(Text(w.role, w.text, place.x, y - 0.27 * w.size, place.anchor))
            continue
        left = place.x - {"start": 0.0, "middle": w.width / 2, "end": w.width}[place.anchor]
        frame = Box(left, y - w.height + 2.5, left + w.width, y - 0.5)
        marks.append(Frame(w.role, frame, radius=4.0))
        middle = (frame.y0 + frame.y1) / 2
        marks.append(Text(w.role, w.text, left + w.width / 2, middle + 0.35 * w.size))
    return tuple(marks)


def _number(arrow: Arrow, shape: BondShape, clutter: Clutter) -> tuple[Mark, ...]:
    if not arrow.number:
        return ()
    size = look("number").size or 9.0
    (ax, ay), (bx, by) = line = shape.longest
    block = (width(arrow.number, size), size)
    place, _ = best(beside_bond(line, barb_side(bx - ax, by - ay), block), clutter)
    clutter.add_box(place.box)
    role = "number" + (" off" if arrow.off else "")
    return (Text(role, arrow.number, place.x, place.box.y1 - 0.13 * size, place.anchor),)
