"""The words around a picture: title, mode caption, legend; and the size of the page."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from hybond.draw.geometry import Box
from hybond.draw.legend import Entry, moved, rows, width_of
from hybond.draw.measure import shorten, width, wrapped
from hybond.draw.scene import Band, Frame, Group, Line, Mark, Scene, Text
from hybond.draw.style import look

MARGIN = 14.0
_LEAST = 260.0
_MOST = 520.0
"""How far a title may widen the page."""
_TITLE_LINES = 3
_CAPTION_LINES = 4


def with_words(
    groups: tuple[Group, ...], *, title: str = "", caption: str = "", legend: Sequence[Entry] = ()
) -> Scene:
    """Return the scene of `groups` with its words, moved to the page's origin.

    Examples
    --------
    >>> bond = Group("bond", "a -> b", "", (Line("bond", ((0.0, 0.0), (300.0, 0.0))),))
    >>> scene = with_words((bond,), title="A bond")
    >>> scene.width, [group.name for group in scene.groups]
    (328.0, ['bond', 'words'])
    """
    extent = extent_of_groups(groups)
    size = look("title").size or 13.0
    wide = max(
        extent.x1 - extent.x0,
        min(width(title, size, bold=True), _MOST),
        _LEAST,
        width_of(legend),
    )
    head: list[Mark] = []
    y = MARGIN
    for line in wrapped(title, size, wide, most=_TITLE_LINES, words=True, bold=True):
        y += size
        head.append(Text("title", line, MARGIN, y, "start"))
        y += 6.0
    lines, y = caption_lines(caption, wide, MARGIN, y)
    head += lines
    y += 8.0 if head else 0.0

    dx, dy = MARGIN - extent.x0 + (wide - (extent.x1 - extent.x0)) / 2, y - extent.y0
    bottom = extent.y1 + dy + MARGIN
    marks, height = rows(legend, wide)
    if marks:
        head += [moved(m, MARGIN, bottom) for m in marks]
        bottom += height + MARGIN - 4.0
    all_groups = shifted(groups, dx, dy)
    if head:
        all_groups = (*all_groups, Group("words", "", "", tuple(head)))
    return Scene(round(wide + 2 * MARGIN, 1), round(bottom, 1), all_groups, title=title)


def caption_lines(caption: str, room: float, x: float, y: float) -> tuple[list[Mark], float]:
    """Return the lines of a caption below `y`, and where the last one ends."""
    size = look("caption").size or 11.0
    marks: list[Mark] = []
    for line in _wrapped(caption, room):
        y += size
        marks.append(Text("caption", line, x, y, "start"))
        y += 4.0
    return marks, y


def shifted(groups: Iterable[Group], dx: float, dy: float) -> tuple[Group, ...]:
    """Return groups moved to the right and down."""
    return tuple(
        Group(g.name, g.key, g.about, tuple(moved(m, dx, dy) for m in g.marks)) for g in groups
    )


def extent_of_groups(groups: Iterable[Group]) -> Box:
    """Return a box around groups; an empty one at the origin if there are none.

    Strokes do not count: they stand at one end or the other, and no picture moves for that.
    """
    extent = [extent_of(m) for g in groups for m in g.marks if not m.role.startswith("stroke")]
    return Box(
        min((b.x0 for b in extent), default=0.0),
        min((b.y0 for b in extent), default=0.0),
        max((b.x1 for b in extent), default=0.0),
        max((b.y1 for b in extent), default=0.0),
    )


def extent_of(mark: Mark) -> Box:
    """Return a box around a mark, large enough for the widest font.

    Examples
    --------
    >>> extent_of(Line("bond", ((0.0, 5.0), (10.0, 5.0))))
    Box(x0=0.0, y0=5.0, x1=10.0, y1=5.0)
    """
    if isinstance(mark, Line | Band):
        xs, ys = [p[0] for p in mark.points], [p[1] for p in mark.points]
        box = Box(min(xs), min(ys), max(xs), max(ys))
        return box.grown(mark.breadth / 2) if isinstance(mark, Band) else box
    if isinstance(mark, Frame):
        return mark.box
    style = look(mark.role)
    size = style.size or 11.0
    wide = width(mark.text, size, bold=bool(style.bold))
    left = mark.x - {"start": 0.0, "middle": wide / 2, "end": wide}[mark.anchor]
    return Box(left, mark.y - 0.75 * size, left + wide, mark.y + 0.22 * size)


def _wrapped(caption: str, room: float) -> list[str]:
    """Break a caption at its commas; what passes the last line is cut."""
    size = look("caption").size or 11.0
    lines: list[str] = []
    for part in caption.split(", ") if caption else []:
        if lines and width(f"{lines[-1]}, {part}", size) <= room:
            lines[-1] += f", {part}"
        else:
            lines.append(part)
    if len(lines) > _CAPTION_LINES:
        lines = [*lines[: _CAPTION_LINES - 1], lines[_CAPTION_LINES - 1] + ", …"]
    return [shorten(line, size, room) for line in lines]
