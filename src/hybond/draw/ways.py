"""The ways of bonds: level and upright pieces with few bends, around nodes, beside each other.

A way that the placement has found stays if it is clear; the others are looked for on the lines of
the grid and halfway between them, by E. W. Dijkstra's method (1959), with a price for bends,
crossings and corners. Ways run in grid cells.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from itertools import pairwise

from hybond.draw.geometry import Box, Point, Segment

Way = tuple[Point, ...]
"""From the centre of the tail to that of the head, with the bends between."""

_HALF = (0.34, 0.3)
"""Half the room that a node's letters take, in cells."""
_LENGTH, _BEND, _CROSS, _ASKEW = 10.0, 14.0, 160.0, 45.0
_SHARE, _TOUCH = 400.0, 60.0
_ROUNDS = 3
_EFFORT = 9000
"""Ways that are looked for, times the number of bonds: a tangle of hundreds stays one."""
_MOST = 400
"""Bonds beyond which ways stay as the placement has them."""
_AROUND = 5.0
"""Cells around the ends of a bond within which its way is looked for."""


def clear_ways(
    positions: Sequence[Point], bonds: Sequence[tuple[int, int]], ways: Sequence[Way]
) -> list[Way]:
    """Return the ways of bonds, those that are not clear led around what is in their way.

    Parameters
    ----------
    positions : sequence of (x, y)
        Of the nodes, in cells.
    bonds : sequence of (tail, head)
        No two between the same nodes.
    ways : sequence of tuple of (x, y)
        As the placement has them.

    Examples
    --------
    A bond over a node goes around it:

    >>> clear_ways([(0, 0), (1, 0), (2, 0)], [(0, 2)], [((0, 0), (2, 0))])
    [((0, 0), (0, -0.5), (2, -0.5), (2, 0))]
    """
    found = list(ways)
    boxes = [_room(p) for p in positions]
    lines: _Lines | None = None
    effort = _EFFORT // max(len(bonds), 1) if len(bonds) <= _MOST else 0
    for _ in range(_ROUNDS if effort else 0):
        changed = False
        for b, flaw in sorted(enumerate(_flaws(found, bonds, boxes)), key=lambda f: -f[1]):
            if flaw == 0 or effort == 0:
                break
            effort -= 1
            lines = lines or _Lines(positions)
            before = _price(found[b], b, found, bonds, boxes)
            new = lines.route(b, bonds, found)
            if new is not None and _price(new, b, found, bonds, boxes) < before - 1e-9:
                found[b] = new
                changed = True
        if not changed or effort == 0:
            break
    return found


def _room(p: Point) -> Box:
    return Box(p[0] - _HALF[0], p[1] - _HALF[1], p[0] + _HALF[0], p[1] + _HALF[1])


def _bounds(way: Way) -> Box:
    xs, ys = [p[0] for p in way], [p[1] for p in way]
    return Box(min(xs), min(ys), max(xs), max(ys)).grown(0.05)


def _flaws(
    ways: Sequence[Way], bonds: Sequence[tuple[int, int]], boxes: Sequence[Box]
) -> list[float]:
    """Return how much is wrong with each way: nodes that it hits, ways that it lies on, crosses."""
    found = [0.0] * len(ways)
    bounds = [_bounds(way) for way in ways]
    for b, way in enumerate(ways):
        found[b] += 10.0 * _hits(way, bonds[b], boxes, bounds[b])
        for c in range(b):
            if bounds[b].overlaps(bounds[c]):
                crossed, shared = _meet(way, ways[c])
                worst = crossed + 5.0 * shared
                found[b] += worst
                found[c] += worst
    return found


def _price(
    way: Way,
    bond: int,
    ways: Sequence[Way],
    bonds: Sequence[tuple[int, int]],
    boxes: Sequence[Box],
) -> float:
    bounds = _bounds(way)
    price = _BEND * (len(way) - 2) + 1000.0 * _hits(way, bonds[bond], boxes, bounds)
    for p, q in pairwise(way):
        dx, dy = abs(p[0] - q[0]), abs(p[1] - q[1])
        price += _LENGTH * (dx + dy) + (_ASKEW if min(dx, dy) > 1e-9 else 0.0)
    for c, other in enumerate(ways):
        if c != bond and bounds.overlaps(_bounds(other)):
            crossed, shared = _meet(way, other)
            price += _CROSS * crossed + _SHARE * shared
    return price


def _hits(way: Way, ends: tuple[int, int], boxes: Sequence[Box], bounds: Box) -> int:
    return sum(
        any(box.cut(piece) for piece in pairwise(way))
        for n, box in enumerate(boxes)
        if n not in ends and box.overlaps(bounds)
    )


def _meet(one: Way, two: Way) -> tuple[int, int]:
    """Return how often two ways cross, and how many of their pieces lie on each other."""
    crossed = shared = 0
    for p in pairwise(one):
        for q in pairwise(two):
            if _on(p, q):
                shared += 1
            elif _cross(p, q):
                crossed += 1
    # corners that touch, or a corner on a piece: read as a crossing, or as a bond that branches
    for way, other in ((one, two), (two, one)):
        for corner in way[1:-1]:
            if not shared and any(_lies(corner, piece) for piece in pairwise(other)):
                crossed += 1
    return crossed, shared


def _lies(p: Point, piece: Segment) -> bool:
    """Whether a point lies on a level or upright piece."""
    (ax, ay), (bx, by) = piece
    inside = min(ax, bx) - 1e-9 <= p[0] <= max(ax, bx) + 1e-9
    inside = inside and min(ay, by) - 1e-9 <= p[1] <= max(ay, by) + 1e-9
    return inside and (ax == bx or ay == by)


def _on(p: Segment, q: Segment) -> bool:
    """Whether two pieces lie on each other for a while, whichever way they run."""
    (ax, ay), (bx, by) = p
    dx, dy = bx - ax, by - ay
    if dx and dy:
        off = [abs(dx * (y - ay) - dy * (x - ax)) for x, y in q]
        along = sorted(dx * (x - ax) + dy * (y - ay) for x, y in q)
        long = dx * dx + dy * dy
        return max(off) < 1e-6 * long and min(along[1], long) - max(along[0], 0.0) > 1e-6 * long
    for k in (0, 1):
        m = 1 - k
        if p[0][k] == p[1][k] and q[0][k] == q[1][k] and abs(p[0][k] - q[0][k]) < 0.1:
            low = max(min(p[0][m], p[1][m]), min(q[0][m], q[1][m]))
            high = min(max(p[0][m], p[1][m]), max(q[0][m], q[1][m]))
            if high - low > 1e-6:
                return True
    return False


def _cross(p: Segment, q: Segment) -> bool:
    (a, b), (c, d) = p, q

    def turn(u: Point, v: Point, w: Point) -> float:
        return (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0])

    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0


_DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))


class _Lines:
    """The lines on which ways may run: through the nodes, and halfway between."""

    def __init__(self, positions: Sequence[Point]) -> None:
        self.positions = positions
        self.xs = _lines([p[0] for p in positions])
        self.ys = _lines([p[1] for p in positions])
        self.column = {x: k for k, x in enumerate(self.xs)}
        self.row = {y: k for k, y in enumerate(self.ys)}
        self.inside: dict[tuple[int, int], list[int]] = {}
        for n, p in enumerate(positions):
            room = _room(p)
            columns = [i for i, x in enumerate(self.xs) if room.x0 < x < room.x1]
            rows = [j for j, y in enumerate(self.ys) if room.y0 < y < room.y1]
            for i in columns:
                for j in rows:
                    self.inside.setdefault((i, j), []).append(n)

    def route(self, bond: int, bonds: Sequence[tuple[int, int]], ways: Sequence[Way]) -> Way | None:
        """Return the cheapest way of a bond among the others, None if there is none."""
        xs, ys = self.xs, self.ys
        tail, head = bonds[bond]
        start, goal = self._at(tail), self._at(head)
        start_at, goal_at = self.positions[tail], self.positions[head]
        taken, passed, slanted = self._used(bond, ways)
        ends = {tail, head}
        window = _bounds((self.positions[tail], self.positions[head])).grown(_AROUND)

        def free(i: int, j: int) -> bool:
            if not (window.x0 < xs[i] < window.x1 and window.y0 < ys[j] < window.y1):
                return False
            return all(n in ends for n in self.inside.get((i, j), ()))

        def step_price(i: int, j: int, k: int) -> tuple[float, int, int]:
            di, dj = _DIRECTIONS[k]
            u, v = i + di, j + dj
            key = (min(i, u), min(j, v), k % 2)
            length = abs(xs[u] - xs[i]) + abs(ys[v] - ys[j])
            price = _LENGTH * length + _SHARE * taken.get(key, 0) + _CROSS * slanted.get(key, 0)
            return price, u, v

        # a node with more bonds than sides is also left askew, to the next crossing of lines,
        # where no other way leaves it like that
        left = {
            (p, (q[0] > p[0], q[1] > p[1]))
            for b, way in enumerate(ways)
            if b != bond
            for p, q in ((way[0], way[1]), (way[-1], way[-2]))
            if p[0] != q[0] and p[1] != q[1]
        }
        crowded = [n for n in (tail, head) if sum(n in b for b in bonds) > 4]
        best: dict[tuple[int, int, int], float] = {}
        before: dict[tuple[int, int, int], tuple[int, int, int] | None] = {}
        queue: list[tuple[float, tuple[int, int, int]]] = []

        def offer(
            price: float, state: tuple[int, int, int], origin: tuple[int, int, int] | None
        ) -> None:
            if price < best.get(state, float("inf")) - 1e-9:
                best[state] = price
                before[state] = origin
                heapq.heappush(queue, (price, state))

        for k in range(4):
            offer(0.0, (*start, k), None)
        if tail in crowded:
            for i, j in self._around(start):
                if (
                    free(i, j)
                    and (start_at, (xs[i] > start_at[0], ys[j] > start_at[1])) not in left
                ):
                    for k in range(4):
                        offer(_ASKEW + _LENGTH, (i, j, k), None)
        askew_goals = {
            (i, j)
            for i, j in (self._around(goal) if head in crowded else ())
            if (goal_at, (xs[i] > goal_at[0], ys[j] > goal_at[1])) not in left
        }
        end: tuple[int, int, int] | None = None
        while queue:
            price, state = heapq.heappop(queue)
            if price > best[state] + 1e-9:
                continue
            i, j, k = state
            if (i, j) == goal:
                end = state
                break
            if (i, j) in askew_goals and free(i, j):
                offer(price + _ASKEW + _LENGTH, (*goal, 4 + k), state)
            for turn in range(4):
                if turn == (k + 2) % 4 or (turn != k and before[state] is None):
                    continue
                di, dj = _DIRECTIONS[turn]
                if not (0 <= i + di < len(xs) and 0 <= j + dj < len(ys)):
                    continue
                if not free(i + di, j + dj):
                    continue
                more, u, v = step_price(i, j, turn)
                if turn != k:
                    more += _BEND + _TOUCH * len(passed.get((i, j), ()))
                elif (i, j) != start:
                    more += sum(
                        _CROSS if way == 1 - k % 2 else _TOUCH
                        for way in passed.get((i, j), ())
                        if way != k % 2
                    )
                offer(price + more, (u, v, turn), state)
        if end is None:
            return None
        points = []
        at: tuple[int, int, int] | None = end
        while at is not None:
            points.append((xs[at[0]], ys[at[1]]))
            at = before[at]
        points.reverse()
        if points[0] != (xs[start[0]], ys[start[1]]):
            points.insert(0, (xs[start[0]], ys[start[1]]))
        return _plain(points)

    def _at(self, node: int) -> tuple[int, int]:
        x, y = self.positions[node]
        return self.column[x], self.row[y]

    def _around(self, at: tuple[int, int]) -> list[tuple[int, int]]:
        return [
            (at[0] + di, at[1] + dj)
            for di in (-1, 1)
            for dj in (-1, 1)
            if 0 <= at[0] + di < len(self.xs) and 0 <= at[1] + dj < len(self.ys)
        ]

    def _used(
        self, bond: int, ways: Sequence[Way]
    ) -> tuple[
        dict[tuple[int, int, int], int],
        dict[tuple[int, int], list[int]],
        dict[tuple[int, int, int], int],
    ]:
        """Return steps that other ways share, points they pass (how), steps that they cross askew.

        How: 0 level, 1 upright, 2 a corner.
        """
        taken: dict[tuple[int, int, int], int] = {}
        passed: dict[tuple[int, int], list[int]] = {}
        slanted: dict[tuple[int, int, int], int] = {}
        for b, way in enumerate(ways):
            if b == bond:
                continue
            for p, q in pairwise(way):
                if p[0] == q[0] and p[0] in self.column:
                    i = self.column[p[0]]
                    low, high = sorted((self._row(p[1]), self._row(q[1])))
                    for j in range(low, high):
                        taken[i, j, 1] = taken.get((i, j, 1), 0) + 1
                    for j in range(low + 1, high):
                        passed.setdefault((i, j), []).append(1)
                elif p[1] == q[1] and p[1] in self.row:
                    j = self.row[p[1]]
                    low, high = sorted((self._column(p[0]), self._column(q[0])))
                    for i in range(low, high):
                        taken[i, j, 0] = taken.get((i, j, 0), 0) + 1
                    for i in range(low + 1, high):
                        passed.setdefault((i, j), []).append(0)
                else:
                    self._slant(p, q, slanted)
            for x, y in way[1:-1]:
                if x in self.column and y in self.row:
                    passed.setdefault((self.column[x], self.row[y]), []).append(2)
        return taken, passed, slanted

    def _row(self, y: float) -> int:
        return self.row.get(y, 0)

    def _column(self, x: float) -> int:
        return self.column.get(x, 0)

    def _slant(self, p: Point, q: Point, slanted: dict[tuple[int, int, int], int]) -> None:
        for i, x in enumerate(self.xs):
            for j, y in enumerate(self.ys):
                if i + 1 < len(self.xs) and _cross(((x, y), (self.xs[i + 1], y)), (p, q)):
                    slanted[i, j, 0] = slanted.get((i, j, 0), 0) + 1
                if j + 1 < len(self.ys) and _cross(((x, y), (x, self.ys[j + 1])), (p, q)):
                    slanted[i, j, 1] = slanted.get((i, j, 1), 0) + 1


def _lines(places: Sequence[float]) -> list[float]:
    """Return where lines run: at each place, between them about every half cell, and outside."""
    known = sorted(set(places))
    lines = [known[0] - 0.5, known[0]]
    for a, b in pairwise(known):
        parts = max(1, round(2 * (b - a)))
        lines += [a + (b - a) * k / parts for k in range(1, parts)] + [b]
    return [*lines, known[-1] + 0.5]


def _plain(points: Sequence[Point]) -> Way:
    """Leave out points that are no bends."""
    kept = [points[0]]
    for k in range(1, len(points) - 1):
        (a, b), (c, d), (e, f) = kept[-1], points[k], points[k + 1]
        if abs((c - a) * (f - d) - (d - b) * (e - c)) > 1e-9:
            kept.append(points[k])
    return (*kept, points[-1])
