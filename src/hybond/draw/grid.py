"""From grid cells to pixels: columns as wide as their texts ask for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hybond.draw.geometry import Point

PITCH = 84.0
_WIDEST = 170.0
_LANE = 22.0
"""By which columns or rows stand farther apart where a bond runs between them."""


@dataclass(frozen=True, slots=True)
class Grid:
    """Where the columns and rows of a drawing are.

    Parameters
    ----------
    left, top : int
        The first column and row.
    columns, rows : tuple of float
        Where they are in pixels, and one more.
    """

    left: int
    top: float
    columns: tuple[float, ...]
    rows: tuple[float, ...]

    def at(self, place: Point) -> Point:
        """Return the pixels of a place in cells."""
        return (
            _between(self.columns, place[0] - self.left),
            _between(self.rows, place[1] - self.top),
        )


def _between(edges: Sequence[float], place: float) -> float:
    """Return where a place is between numbered edges; beyond them by `PITCH`."""
    k = min(max(math.floor(place), 0), len(edges) - 2)
    if 0 <= place <= len(edges) - 1:
        return edges[k] + (place - k) * (edges[k + 1] - edges[k])
    return edges[0] + place * PITCH if place < 0 else edges[-1] + (place - len(edges) + 1) * PITCH


def grid_of(
    positions: Sequence[Point],
    widths: Sequence[float],
    *,
    corner: Sequence[bool],
    bends: Sequence[Sequence[Point]] = (),
) -> Grid:
    """Return columns and rows with room for texts, and for bonds that run between them.

    Parameters
    ----------
    positions : sequence of (x, y)
        Of the nodes, in grid cells; fractions are allowed.
    widths : sequence of float
        Width of the small text of each node.
    corner : sequence of bool
        Whether that text stands in a corner, right of the node, rather than centred under it.
    bends : sequence of sequence of (x, y)
        Where bonds bend, in grid cells.

    Examples
    --------
    >>> grid = grid_of([(0, 0), (1, 0), (1, 1)], [0, 0, 0], corner=[False] * 3)
    >>> grid.at((1, 0)), grid.at((0.5, 1))
    ((84.0, 0.0), (42.0, 84.0))
    """
    if not positions:
        return Grid(0, 0, (0.0, PITCH), (0.0, PITCH))
    first = math.floor(min(x for x, _ in positions))
    last = math.ceil(max(x for x, _ in positions))
    top = min(y for _, y in positions)
    bottom = max(y for _, y in positions)
    # Half of the text centred in each column, and the text right of its junctions.
    middle = [0.0] * (last - first + 2)
    right = [0.0] * (last - first + 2)
    for (x, _), w, in_corner in zip(positions, widths, corner, strict=True):
        side = right if in_corner else middle
        column = math.floor(x) - first
        side[column] = max(side[column], w + 30.0 if in_corner else w / 2 + 4.0)
    lanes = {
        (axis, math.floor(p[axis] - (first, top)[axis]))
        for way in bends
        for p in way
        for axis in (0, 1)
        if 0.2 < (p[axis] - (first, top)[axis]) % 1.0 < 0.8
    }
    columns = [0.0]
    for column in range(last - first):
        need = max(PITCH, middle[column] + middle[column + 1], right[column])
        need += _LANE if (0, column) in lanes else 0.0
        columns.append(columns[-1] + min(need, _WIDEST))
    columns.append(columns[-1] + PITCH)
    rows = [0.0]
    for row in range(math.ceil(bottom - top)):
        rows.append(rows[-1] + PITCH + (_LANE if (1, row) in lanes else 0.0))
    rows.append(rows[-1] + PITCH)
    return Grid(first, top, tuple(columns), tuple(rows))
