"""From grid cells to pixels: columns as wide as their texts ask for."""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybond.draw.geometry import Point

PITCH = 84.0
_WIDEST = 170.0


def pixels(
    positions: Sequence[Point], widths: Sequence[float], *, corner: Sequence[bool]
) -> list[Point]:
    """Return the centre of each node in pixels.

    Parameters
    ----------
    positions : sequence of (x, y)
        In grid cells; fractions are allowed.
    widths : sequence of float
        Width of the small text of each node.
    corner : sequence of bool
        Whether that text stands in a corner, right of the node, rather than centred under it.

    Examples
    --------
    >>> pixels([(0, 0), (1, 0), (1, 1)], [0, 0, 0], corner=[False] * 3)
    [(0.0, 0.0), (84.0, 0.0), (84.0, 84.0)]
    """
    if not positions:
        return []
    first = math.floor(min(x for x, _ in positions))
    last = math.ceil(max(x for x, _ in positions))
    top = min(y for _, y in positions)
    # Half of the text centred in each column, and the text right of its junctions.
    middle = [0.0] * (last - first + 2)
    right = [0.0] * (last - first + 2)
    for (x, _), w, in_corner in zip(positions, widths, corner, strict=True):
        side = right if in_corner else middle
        column = math.floor(x) - first
        side[column] = max(side[column], w + 30.0 if in_corner else w / 2 + 4.0)
    edges = [0.0]
    for column in range(last - first):
        need = max(PITCH, middle[column] + middle[column + 1], right[column])
        edges.append(edges[-1] + min(need, _WIDEST))
    edges.append(edges[-1] + PITCH)

    def across(x: float) -> float:
        column = math.floor(x) - first
        return edges[column] + (x - math.floor(x)) * (edges[column + 1] - edges[column])

    return [(across(x), (y - top) * PITCH) for x, y in positions]
