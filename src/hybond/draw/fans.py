"""Junctions with more bonds than the eight ways of a grid: their one-ports fan out.

What has no way of its own from a crowded node gets a cell that the bond reaches in a straight line
of another slope, a knight's move away or farther, where that is free.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from hybond.draw.geometry import Box, Point

_WAYS = 8
_HALF = (0.28, 0.27)
"""Half the room of a node's letters, in cells, that a slanted bond keeps clear of."""
_FARTHEST = 3
_CLOSE = 0.12
"""Least angle between two bonds of a node, as the sine of it."""


def fanned(
    positions: Sequence[Point], bonds: Sequence[tuple[int, int]], fixed: Collection[int]
) -> tuple[tuple[Point, ...], set[int]]:
    """Return where nodes stand, and the bonds that run straight: those of crowded nodes.

    Parameters
    ----------
    bonds : sequence of (tail, head)
        No two between the same nodes.
    fixed : collection of int
        Nodes that stay.

    Examples
    --------
    Nine one-ports: the last one stands behind another.

    >>> around = [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y]
    >>> places, straight = fanned([(0, 0), *around, (2, 0)], [(0, k) for k in range(1, 10)], ())
    >>> places[9], sorted(straight)
    ((2.0, -1.0), [8])
    """
    at = [(float(x), float(y)) for x, y in positions]
    near: list[list[int]] = [[] for _ in at]
    bond_of: dict[tuple[int, int], int] = {}
    for b, (p, q) in enumerate(bonds):
        near[p].append(q)
        near[q].append(p)
        bond_of[p, q] = bond_of[q, p] = b
    straight: set[int] = set()
    for n, others in enumerate(near):
        if len(others) <= _WAYS:
            continue
        # two may stand before a third, and each is moved in turn
        for m in [*others, *others, *others]:
            if _own_way(n, m, at, others) or bond_of[n, m] in straight:
                continue
            moved = m if len(near[m]) == 1 else _between(n, m, at, near)
            if moved is None or moved in fixed:
                continue
            cell = _cell(n, moved, at, others)
            if cell is not None:
                at[moved] = cell
                straight.add(bond_of[n, moved])
    return tuple(at), straight


def _own_way(n: int, m: int, at: Sequence[Point], others: Sequence[int]) -> bool:
    """Whether a bond goes straight to a neighbour, level, upright or askew to the next cell."""
    (x, y), (u, v) = at[n], at[m]
    dx, dy = u - x, v - y
    if dx and dy and max(abs(dx), abs(dy)) > 1.0:
        return False
    return not any(
        _sign(at[k], at[n]) == _sign(at[m], at[n]) and _nearer(k, m, n, at)
        for k in others
        if k != m
    )


def _nearer(k: int, m: int, n: int, at: Sequence[Point]) -> bool:
    return (
        _distance(at[k], at[n]) < _distance(at[m], at[n])
        and abs(_sine(at[n], at[k], at[m])) < _CLOSE
    )


def _between(
    n: int, m: int, at: Sequence[Point], near: Mapping[int, list[int]] | Sequence[list[int]]
) -> int | None:
    """Return a one-port of a node that stands between it and another neighbour in line with it."""
    for k in near[n]:
        if (
            len(near[k]) == 1
            and _sign(at[k], at[n]) == _sign(at[m], at[n])
            and _nearer(k, m, n, at)
        ):
            return k
    return None


def _cell(n: int, moved: int, at: Sequence[Point], others: Sequence[int]) -> Point | None:
    """Return the nearest free cell to which a straight bond touches nothing."""
    x, y = at[n]
    rooms = [Box(u - _HALF[0], v - _HALF[1], u + _HALF[0], v + _HALF[1]) for u, v in at]
    span = range(-_FARTHEST, _FARTHEST + 1)
    steps = [(dx, dy) for dx in span for dy in span if dx and dy and abs(dx) != abs(dy)]
    here = at[moved]
    steps.sort(key=lambda s: (abs(s[0]) + abs(s[1]), _distance((x + s[0], y + s[1]), here), s))
    taken = {(round(u), round(v)) for u, v in at}
    for dx, dy in steps:
        cell = (x + dx, y + dy)
        if (round(cell[0]), round(cell[1])) in taken:
            continue
        if any(
            abs(_sine(at[n], at[k], cell)) < _CLOSE and _sign(at[k], at[n]) == _sign(cell, at[n])
            for k in others
            if k != moved
        ):
            continue
        if not any(room.cut(((x, y), cell)) for k, room in enumerate(rooms) if k not in (n, moved)):
            return cell
    return None


def _sign(p: Point, origin: Point) -> tuple[int, int]:
    x, y = p[0] - origin[0], p[1] - origin[1]
    return (x > 0) - (x < 0), (y > 0) - (y < 0)


def _sine(origin: Point, p: Point, q: Point) -> float:
    """Return the sine of the angle between the ways to two places."""
    ax, ay, bx, by = p[0] - origin[0], p[1] - origin[1], q[0] - origin[0], q[1] - origin[1]
    long = _distance(p, origin) * _distance(q, origin)
    return (ax * by - ay * bx) / long if long else 0.0


def _distance(p: Point, q: Point) -> float:
    return float(((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2) ** 0.5)
