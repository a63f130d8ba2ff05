"""The words around a picture: title, mode caption, legend; and the size of the page."""

from __future__ import annotations

from hybond.draw.geometry import STROKE_LENGTH, Box
from hybond.draw.measure import shorten, width
from hybond.draw.scene import Frame, Group, Line, Mark, Scene, Text
from hybond.draw.sketch import Sketch
from hybond.draw.style import look

_MARGIN = 14.0
_LEAST = 260.0
_MOST = 520.0
"""How far a title may widen the page."""
_LEGEND = (
    ("dynamic", "stroke dynamic", "depends on the mode"),
    ("derivative", "stroke derivative", "derivative causality"),
    ("conflict", "stroke conflict", "causal conflict"),
    ("off", "bond off", "off"),
)


def with_words(groups: tuple[Group, ...], sketch: Sketch) -> Scene:
    """Return the scene of `groups` with its words, moved to the page's origin."""
    extent = [box for g in groups for m in g.marks for box in [extent_of(m)]]
    x0, y0 = min((b.x0 for b in extent), default=0.0), min((b.y0 for b in extent), default=0.0)
    x1, y1 = max((b.x1 for b in extent), default=0.0), max((b.y1 for b in extent), default=0.0)
    legend = _legend(sketch)
    size = look("title").size or 13.0
    wide = max(x1 - x0, min(width(sketch.title, size, bold=True), _MOST), _LEAST, legend[1])

    head: list[Mark] = []
    y = _MARGIN
    if sketch.title:
        title = shorten(sketch.title, 1.1 * size, wide)
        y += size
        head.append(Text("title", title, _MARGIN, y, "start"))
        y += 6.0
    for line in _wrapped(sketch.caption, wide):
        size = look("caption").size or 11.0
        y += size
        head.append(Text("caption", line, _MARGIN, y, "start"))
        y += 4.0
    y += 8.0 if head else 0.0

    page = wide + 2 * _MARGIN
    dx, dy = _MARGIN - x0 + (wide - (x1 - x0)) / 2, y - y0
    moved = tuple(
        Group(g.name, g.key, g.about, tuple(_moved(m, dx, dy) for m in g.marks)) for g in groups
    )
    bottom = y1 + dy + _MARGIN
    if legend[0]:
        head += [_moved(m, _MARGIN, bottom + 8.0) for m in legend[0]]
        bottom += 16.0 + _MARGIN
    all_groups = (*moved, Group("words", "", "", tuple(head))) if head else moved
    return Scene(round(page, 1), round(bottom, 1), all_groups, title=sketch.title)


def extent_of(mark: Mark) -> Box:
    """Return a box around a mark, large enough for the widest font.

    Examples
    --------
    >>> extent_of(Line("bond", ((0.0, 5.0), (10.0, 5.0))))
    Box(x0=0.0, y0=5.0, x1=10.0, y1=5.0)
    """
    if isinstance(mark, Line):
        xs, ys = [p[0] for p in mark.points], [p[1] for p in mark.points]
        return Box(min(xs), min(ys), max(xs), max(ys))
    if isinstance(mark, Frame):
        return mark.box
    style = look(mark.role)
    size = style.size or 11.0
    wide = width(mark.text, size, bold=bool(style.bold))
    left = mark.x - {"start": 0.0, "middle": wide / 2, "end": wide}[mark.anchor]
    return Box(left, mark.y - 0.75 * size, left + wide, mark.y + 0.22 * size)


def _moved(mark: Mark, dx: float, dy: float) -> Mark:
    if isinstance(mark, Line):
        return Line(mark.role, tuple((x + dx, y + dy) for x, y in mark.points))
    if isinstance(mark, Frame):
        b = mark.box
        return Frame(mark.role, Box(b.x0 + dx, b.y0 + dy, b.x1 + dx, b.y1 + dy))
    return Text(mark.role, mark.text, mark.x + dx, mark.y + dy, mark.anchor)


def _wrapped(caption: str, room: float, most: int = 4) -> list[str]:
    """Break a caption at its commas; what passes `most` lines is cut."""
    size = look("caption").size or 11.0
    lines: list[str] = []
    for part in caption.split(", ") if caption else []:
        if lines and width(f"{lines[-1]}, {part}", size) <= room:
            lines[-1] += f", {part}"
        else:
            lines.append(part)
    if len(lines) > most:
        lines = [*lines[: most - 1], lines[most - 1] + ", …"]
    return [shorten(line, size, room) for line in lines]


def _legend(sketch: Sketch) -> tuple[list[Mark], float]:
    """Return the legend of what is out of the ordinary, from x = 0 on, and its width."""
    shown = {
        "dynamic": any(a.dynamic and a.strokes for a in sketch.arrows),
        "derivative": any(a.derivative and a.strokes for a in sketch.arrows),
        "conflict": any(a.conflict for a in sketch.arrows),
        "off": any(a.off for a in sketch.arrows) or any(s.off for s in sketch.symbols),
    }
    marks: list[Mark] = []
    size = look("legend").size or 10.0
    x = 0.0
    for key, role, meaning in _LEGEND:
        if not shown[key]:
            continue
        if key == "off":
            marks.append(Line(role, ((x, 0.0), (x + 14.0, 0.0))))
            x += 20.0
        else:
            half = STROKE_LENGTH / 2
            marks.append(Line(role, ((x + 3.0, half), (x + 3.0, -half))))
            x += 11.0
        marks.append(Text("legend", meaning, x, 0.36 * size, "start"))
        x += width(meaning, size) + 18.0
    return marks, x
