"""Pictures side by side on one page: panels of one size, a caption in each, one legend."""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybond.draw.arrange import Arrangement
from hybond.draw.compose import compose
from hybond.draw.geometry import Box
from hybond.draw.legend import entries, moved, rows, width_of
from hybond.draw.measure import width, wrapped
from hybond.draw.scene import Frame, Group, Mark, Scene, Text
from hybond.draw.sketch import Sketch
from hybond.draw.style import look
from hybond.draw.words import MARGIN, caption_lines, extent_of_groups, shifted

_PADDING = 12.0
_GAP = 12.0
_NARROWEST = 190.0
_PAGE = 1.5
"""Width per height that the panels aim at."""


def side_by_side(
    sketches: Sequence[Sketch],
    places: Arrangement,
    *,
    columns: int | None = None,
    legend: bool = True,
) -> Scene:
    """Return one scene with a panel for each sketch; the title is that of the first.

    Parameters
    ----------
    sketches : sequence of Sketch
        Of one graph, so that `places` hold for all.
    columns : int, optional
        Panels in a row.

    Examples
    --------
    >>> from hybond.draw.sketch import Symbol
    >>> two = [Sketch((Symbol("c", "C", "C"),), (), caption=text) for text in ("on", "off")]
    >>> scene = side_by_side(two, Arrangement(((0.0, 0.0),), ()), columns=2)
    >>> [mark.x for group in scene.groups for mark in group.marks if mark.role == "node"]
    [121.0, 347.0]
    """
    pictures = [compose(s, places) for s in sketches]
    extent = extent_of_groups(g for groups in pictures for g in groups)
    inner = max(extent.x1 - extent.x0, _NARROWEST)
    captions = [caption_lines(s.caption, inner, 0.0, 0.0) for s in sketches]
    head = max(bottom for _, bottom in captions)
    wide = inner + 2 * _PADDING
    tall = head + 8.0 + extent.y1 - extent.y0 + 2 * _PADDING
    count = len(sketches)
    across = min(columns or _columns(count, wide, tall), count)
    down = -(-count // across)
    page = across * wide + (across - 1) * _GAP

    title = sketches[0].title
    size = look("title").size or 13.0
    words: list[Mark] = []
    top = MARGIN
    for text in wrapped(title, size, page, most=3, words=True, bold=True):
        words.append(Text("title", text, MARGIN, top + size, "start"))
        top += size + 6.0
    top += 6.0 if title else 0.0
    panels: list[Group] = []
    for k, (groups, (caption, _), one) in enumerate(zip(pictures, captions, sketches, strict=True)):
        row, column = divmod(k, across)
        x, y = MARGIN + column * (wide + _GAP), top + row * (tall + _GAP)
        frame = Frame("panel", Box(x, y, x + wide, y + tall), 4.0)
        lines = tuple(moved(m, x + _PADDING, y + _PADDING) for m in caption)
        panels.append(Group("panel", one.caption, "", (frame, *lines)))
        dx = x + (wide - (extent.x1 - extent.x0)) / 2 - extent.x0
        panels += shifted(groups, dx, y + _PADDING + head + 8.0 - extent.y0)
    bottom = top + down * tall + (down - 1) * _GAP + MARGIN
    room = max(page, width(title, size, bold=True) if title else 0.0)
    found = entries(sketches) if legend else []
    marks, height = rows(found, max(page, width_of(found)))
    if marks:
        words += [moved(m, MARGIN, bottom - 4.0) for m in marks]
        bottom += height + MARGIN - 8.0
        room = max(room, width_of(found))
    if words:
        panels.append(Group("words", "", "", tuple(words)))
    room = min(room, max(page, 520.0))
    return Scene(round(room + 2 * MARGIN, 1), round(bottom, 1), tuple(panels), title=title)


def _columns(count: int, wide: float, tall: float) -> int:
    """Return how many panels in a row come nearest to a page, with few places left empty."""

    def awkward(columns: int) -> tuple[float, int]:
        down = -(-count // columns)
        shape = columns * wide / (down * tall)
        empty = down * columns - count
        return (abs(math.log(shape / _PAGE)) + 0.5 * empty / columns, columns)

    return min(range(1, count + 1), key=awkward)
