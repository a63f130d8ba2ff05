"""Wires of schematics: level and upright pieces from pin to pin, around symbols where they can."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from hybond.draw.geometry import Box, Point

End = tuple[Point, Point | None]
"""Where a wire ends, and the way in which it leaves; None at a dot, where any way is right."""
_NEAR = 3.0
"""Pixels by which a wire may slant unseen: it is made straight."""
_OUT = 10.0
"""Pixels that a wire goes on from a pin that points away."""


def routed(
    a: End, b: End, boxes: Sequence[Box], others: Sequence[tuple[Point, Point]] = ()
) -> tuple[Point, ...]:
    """Return the wire from one end to the other with fewest bends, through fewest symbols.

    `others` are pieces of wires that it has nothing to do with: it must not lie on them.

    Examples
    --------
    >>> routed(((0.0, 0.0), (1.0, 0.0)), ((40.0, 30.0), (0.0, -1.0)), [])
    ((0.0, 0.0), (40.0, 0.0), (40.0, 30.0))
    >>> routed(((0.0, 0.0), None), ((40.0, 1.0), (-1.0, 0.0)), [])
    ((0.0, 0.0), (40.0, 1.0))
    """
    (p, u), (q, v) = a, b
    start = [p] if u is None or _ahead(p, u, q) else [p, (p[0] + _OUT * u[0], p[1] + _OUT * u[1])]
    end = [q] if v is None or _ahead(q, v, p) else [(q[0] + _OUT * v[0], q[1] + _OUT * v[1]), q]
    ways = [_clean([*start, *middle, *end]) for middle in _middles(start[-1], end[0])]
    return min(ways, key=lambda way: _cost(way, u, v, boxes, others))


def _ahead(p: Point, way: Point, q: Point) -> bool:
    """Whether a pin points to where the wire goes."""
    return way[0] * (q[0] - p[0]) + way[1] * (q[1] - p[1]) >= -_NEAR


def _middles(p: Point, q: Point) -> list[list[Point]]:
    """Return the corners of wires with no bend, one, and two."""
    (a, b), (c, d) = p, q
    found: list[list[Point]] = []
    if abs(a - c) <= _NEAR or abs(b - d) <= _NEAR:
        found.append([])
    found += [[(c, b)], [(a, d)]]
    for part in (0.5, 0.25, 0.75):
        x, y = a + part * (c - a), b + part * (d - b)
        found += [[(x, b), (x, d)], [(a, y), (c, y)]]
    for aside in (46.0, -46.0):
        low, high = sorted((b, d))
        y = high + aside if aside > 0 else low + aside
        left, right = sorted((a, c))
        x = right + aside if aside > 0 else left + aside
        found += [[(a, y), (c, y)], [(x, b), (x, d)]]
    return found


def _clean(way: Sequence[Point]) -> tuple[Point, ...]:
    """Leave out corners that are none."""
    kept = [way[0]]
    for p in way[1:]:
        if p != kept[-1]:
            kept.append(p)
    found = kept[:1]
    for k in range(1, len(kept) - 1):
        (a, b), (c, d), (e, f) = found[-1], kept[k], kept[k + 1]
        if (c - a) * (f - d) != (d - b) * (e - c) or (c - a) * (e - c) + (d - b) * (f - d) < 0:
            found.append(kept[k])
    return (*found, kept[-1]) if len(kept) > 1 else (way[0], way[-1])


def _on(p: Point, q: Point, r: Point, s: Point) -> bool:
    """Whether two pieces lie on each other for a while."""
    for k in (0, 1):
        m = 1 - k
        if p[k] == q[k] and r[k] == s[k] and abs(p[k] - r[k]) < _NEAR:
            low, high = max(min(p[m], q[m]), min(r[m], s[m])), min(max(p[m], q[m]), max(r[m], s[m]))
            if high - low > 1.0:
                return True
    return False


def _cost(
    way: Sequence[Point],
    u: Point | None,
    v: Point | None,
    boxes: Sequence[Box],
    others: Sequence[tuple[Point, Point]],
) -> tuple[float, float]:
    through = sum(_on(*piece, *other) for piece in pairwise(way) for other in others)
    for p, q in pairwise(way):
        for box in boxes:
            inner = Box(box.x0 + 1.0, box.y0 + 1.0, box.x1 - 1.0, box.y1 - 1.0)
            if inner.x1 > inner.x0 and inner.y1 > inner.y0 and inner.cut((p, q)) is not None:
                through += 1
    wrong = 0.0
    for pin, own, other in ((u, way[0], way[1]), (v, way[-1], way[-2])):
        if pin is not None:
            dx, dy = other[0] - own[0], other[1] - own[1]
            far = abs(dx) + abs(dy) or 1.0
            wrong += 1.0 - (pin[0] * dx + pin[1] * dy) / far
    long = sum(abs(q[0] - p[0]) + abs(q[1] - p[1]) for p, q in pairwise(way))
    return (40.0 * through + 6.0 * wrong + 3.0 * (len(way) - 2) + 0.02 * long, long)
