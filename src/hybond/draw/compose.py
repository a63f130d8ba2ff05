"""From a sketch and grid positions to a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybond.draw.geometry import (
    PARALLEL,
    BondShape,
    Box,
    Point,
    barb_side,
    bond_shape,
    stroke,
)
from hybond.draw.grid import pixels
from hybond.draw.labels import (
    Clutter,
    Place,
    beside_bond,
    beside_element,
    beside_junction,
    best,
)
from hybond.draw.measure import shorten, width
from hybond.draw.scene import Frame, Group, Line, Mark, Scene, Text
from hybond.draw.sketch import Arrow, Sketch, Symbol
from hybond.draw.style import look
from hybond.draw.words import with_words

_CAP = 0.73
"""Height of a capital letter per font size."""
_LEADING = 1.22
"""Distance of lines of text per font size."""
_ROOM = 130.0
"""Widest small text before it is cut."""


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
        return width(self.text, self.size)


def compose(sketch: Sketch, positions: Sequence[Point]) -> Scene:
    """Return the scene of a sketch whose symbols stand at `positions` (grid cells)."""
    words = [_words(s, _ROOM) for s in sketch.symbols]
    centres = pixels(
        positions,
        [max((w.width for w in ws), default=0.0) for ws in words],
        corner=[s.is_junction for s in sketch.symbols],
    )
    boxes = [_letters(s, c) for s, c in zip(sketch.symbols, centres, strict=True)]
    framed = [
        b.grown(2.0) if s.controlled else b for s, b in zip(sketch.symbols, boxes, strict=True)
    ]
    shapes = _shapes(sketch.arrows, framed, centres)

    clutter = Clutter()
    for box in framed:
        clutter.add_box(box)
    groups = []
    for arrow, shape in zip(sketch.arrows, shapes, strict=True):
        marks = _bond_marks(arrow, shape)
        for mark in marks:
            clutter.add_line((mark.points[0], mark.points[1]))
        groups.append((arrow, shape, marks))

    nodes = []
    # Elements first: their places are better defined than the corners of junctions.
    order = sorted(range(len(boxes)), key=lambda k: sketch.symbols[k].is_junction)
    texts: dict[int, tuple[Mark, ...]] = {}
    for k in order:
        taken = _sides(k, sketch.arrows, centres)
        texts[k] = _label(sketch.symbols[k], words[k], framed[k], taken, clutter)
    for k, symbol in enumerate(sketch.symbols):
        marks_of = (*_node_marks(symbol, boxes[k], centres[k]), *texts[k])
        nodes.append(Group("node", symbol.path, symbol.about, marks_of))

    bonds = []
    for arrow, shape, marks in groups:
        number = _number(arrow, shape, clutter)
        bonds.append(Group("bond", arrow.name, arrow.name, (*marks, *number)))
    return with_words((*bonds, *nodes), sketch)


def _words(symbol: Symbol, room: float) -> tuple[_Words, ...]:
    """Return the small text of a symbol, line by line."""
    state = " off" if symbol.off else ""
    role = "junctionname" if symbol.is_junction else "name"
    lines = [(role + state, symbol.path, True), ("parameter" + state, symbol.parameter, False)]
    if symbol.machine:
        lines.append(("machine" + state, f"[{symbol.machine}]", False))
    return tuple(
        _Words(role, shorten(text, look(role).size or 10.0, room, keep_end=keep_end))
        for role, text, keep_end in lines
        if text
    )


def _letters(symbol: Symbol, centre: Point) -> Box:
    """Return the box of a symbol's letters, with the subscript of a controlled one."""
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
    arrows: Sequence[Arrow], boxes: Sequence[Box], centres: Sequence[Point]
) -> list[BondShape]:
    together: dict[tuple[int, int], list[int]] = {}
    for k, a in enumerate(arrows):
        together.setdefault((min(a.tail, a.head), max(a.tail, a.head)), []).append(k)
    shapes = []
    for k, a in enumerate(arrows):
        same = together[min(a.tail, a.head), max(a.tail, a.head)]
        shift = PARALLEL * (same.index(k) - (len(same) - 1) / 2)
        shapes.append(
            bond_shape(boxes[a.tail], boxes[a.head], centres[a.tail], centres[a.head], shift=shift)
        )
    return shapes


def _bond_marks(arrow: Arrow, shape: BondShape) -> list[Line]:
    state = (" off" if arrow.off else "") + (" conflict" if arrow.conflict else "")
    kind = (" dynamic" if arrow.dynamic else "") + (" derivative" if arrow.derivative else "")
    marks = [
        Line("bond" + state, (shape.tail, shape.head)),
        Line("barb" + state, shape.barb),
    ]
    return marks + [Line("stroke" + kind + state, stroke(shape, end)) for end in arrow.strokes]


def _node_marks(symbol: Symbol, box: Box, centre: Point) -> list[Mark]:
    size = look("node").size or 19.0
    role = "node junction" if symbol.is_junction else "node"
    if symbol.controlled:
        role += " controlled " + ("off" if symbol.off else "on")
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


def _sides(node: int, arrows: Sequence[Arrow], centres: Sequence[Point]) -> set[str]:
    """Return the compass sides of a node where bonds leave."""
    sides = set()
    for a in arrows:
        if node not in (a.tail, a.head):
            continue
        other = centres[a.head if a.tail == node else a.tail]
        dx, dy = other[0] - centres[node][0], other[1] - centres[node][1]
        if abs(dy) >= 0.3 * abs(dx):
            sides.add("s" if dy > 0 else "n")
        if abs(dx) >= 0.3 * abs(dy):
            sides.add("e" if dx > 0 else "w")
    return sides


def _label(
    symbol: Symbol, words: tuple[_Words, ...], box: Box, taken: set[str], clutter: Clutter
) -> tuple[Mark, ...]:
    """Place the small text of a symbol; where there is no room for all, it is cut."""
    found: tuple[Place, int, tuple[_Words, ...]] | None = None
    for room in (_ROOM, 70.0, 45.0, 30.0):
        lines = words if room == _ROOM else _words(symbol, room)
        if not lines:
            return ()
        size = (max(w.width for w in lines), sum(w.size * _LEADING for w in lines))
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
        y += w.size * _LEADING
        marks.append(Text(w.role, w.text, place.x, y - 0.27 * w.size, place.anchor))
    return tuple(marks)


def _number(arrow: Arrow, shape: BondShape, clutter: Clutter) -> tuple[Mark, ...]:
    if not arrow.number:
        return ()
    size = look("number").size or 9.0
    normal = barb_side(shape.head[0] - shape.tail[0], shape.head[1] - shape.tail[1])
    block = (width(arrow.number, size), size)
    place, _ = best(beside_bond((shape.tail, shape.head), normal, block), clutter)
    clutter.add_box(place.box)
    role = "number" + (" off" if arrow.off else "")
    return (Text(role, arrow.number, place.x, place.box.y1 - 0.13 * size, place.anchor),)
