"""The ways of bonds: level and upright pieces with few bends, around nodes, beside each other.

A way that the placement has found stays if it is clear; the others are looked for on the lines of
the grid and halfway between them, by E. W. Dijkstra's method (1959), with a price for bends,
crossings and corners. Ways run in grid cells.
"""

from __future__ import annotations

import heapq
import math
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from hybond.draw.geometry import Box, Point, Segment

Way = tuple[Point, ...]
"""From the centre of the tail to that of the head, with the bends between."""
Sides = npt.NDArray[np.float64]

_HALF = (0.34, 0.3)
"""Half the room that a node's letters take, in cells."""
_LENGTH, _BEND, _CROSS, _ASKEW = 10.0, 14.0, 160, 45.0
_SHARE, _TOUCH = 400, 60
_ROUNDS = 3
_EFFORT = 18000
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
    table = _Table(positions, bonds, ways)
    lines: _Lines | None = None
    effort = _EFFORT // max(len(bonds), 1) if len(bonds) <= _MOST else 0
    for _ in range(_ROUNDS if effort else 0):
        changed = False
        for b, flaw in sorted(enumerate(table.flaws()), key=lambda f: -f[1]):
            if flaw == 0 or effort == 0:
                break
            effort -= 1
            lines = lines or _Lines(positions, bonds, table.ways)
            new = lines.route(b)
            if new is None or new == table.ways[b]:
                continue
            if table.price(new, b) < table.price(table.ways[b], b) - 1e-9:
                table.put(b, new)
                lines.put(b, new)
                changed = True
        if not changed or effort == 0:
            break
    return table.ways


def _room(p: Point) -> Box:
    return Box(p[0] - _HALF[0], p[1] - _HALF[1], p[0] + _HALF[0], p[1] + _HALF[1])


def _bounds(way: Way) -> Box:
    xs, ys = [p[0] for p in way], [p[1] for p in way]
    return Box(min(xs), min(ys), max(xs), max(ys)).grown(0.05)


class _Table:
    """The ways of all bonds with their bounds, so that only those are compared that may meet."""

    def __init__(
        self, positions: Sequence[Point], bonds: Sequence[tuple[int, int]], ways: Sequence[Way]
    ) -> None:
        self.bonds = bonds
        self.ways = list(ways)
        self.boxes = [_room(p) for p in positions]
        self._rooms = _sides(self.boxes)
        self._bounds = _sides([_bounds(way) for way in ways])
        self._met: dict[tuple[Way, Way], tuple[int, int]] = {}

    def put(self, bond: int, way: Way) -> None:
        """Give a bond another way."""
        self.ways[bond] = way
        self._bounds[:, bond] = _sides([_bounds(way)])[:, 0]

    def flaws(self) -> list[float]:
        """Return how much is wrong with each way: what it hits, lies on, crosses."""
        found = [0.0] * len(self.ways)
        for b, way in enumerate(self.ways):
            bounds = self._bounds[:, b]
            found[b] += 10.0 * self._hits(way, b, bounds)
            for c in _overlapping(self._bounds[:, :b], bounds):
                crossed, shared = self._meet(way, self.ways[c])
                worst = crossed + 5.0 * shared
                found[b] += worst
                found[c] += worst
        return found

    def price(self, way: Way, bond: int) -> float:
        """Return what a way costs among those of the other bonds."""
        bounds = _sides([_bounds(way)])[:, 0]
        price = _BEND * (len(way) - 2) + 1000.0 * self._hits(way, bond, bounds)
        for p, q in pairwise(way):
            dx, dy = abs(p[0] - q[0]), abs(p[1] - q[1])
            price += _LENGTH * (dx + dy) + (_ASKEW if min(dx, dy) > 1e-9 else 0.0)
        for c in _overlapping(self._bounds, bounds):
            if c != bond:
                crossed, shared = self._meet(way, self.ways[c])
                price += _CROSS * crossed + _SHARE * shared
        return price

    def _hits(self, way: Way, bond: int, bounds: Sides) -> int:
        ends = self.bonds[bond]
        return sum(
            any(self.boxes[n].cut(piece) for piece in pairwise(way))
            for n in _overlapping(self._rooms, bounds)
            if n not in ends
        )

    def _meet(self, one: Way, two: Way) -> tuple[int, int]:
        known = self._met.get((one, two))
        if known is None:
            known = self._met[one, two] = self._met[two, one] = _meet(one, two)
        return known


def _sides(boxes: Sequence[Box]) -> Sides:
    """Return the left, top, right and bottom sides of boxes."""
    return np.array([(b.x0, b.y0, b.x1, b.y1) for b in boxes]).reshape(-1, 4).T.copy()


def _overlapping(boxes: Sides, one: Sides) -> list[int]:
    """Return which of these boxes overlap another one."""
    x0, y0, x1, y1 = boxes
    inside = (x0 < one[2]) & (one[0] < x1) & (y0 < one[3]) & (one[1] < y1)
    found: list[int] = np.flatnonzero(inside).tolist()
    return found


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


_NOWHERE = -1
_DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))


class _Lines:
    """The lines on which ways may run: through the nodes, and halfway between.

    Where column `i` and row `j` cross is the spot `i * rows + j`; the step from there to the next
    column is twice that, the one to the next row one more.
    """

    def __init__(
        self, positions: Sequence[Point], bonds: Sequence[tuple[int, int]], ways: Sequence[Way]
    ) -> None:
        self.positions, self.bonds, self.ways = positions, bonds, list(ways)
        self.xs = _lines([p[0] for p in positions])
        self.ys = _lines([p[1] for p in positions])
        self.column = {x: k for k, x in enumerate(self.xs)}
        self.row = {y: k for k, y in enumerate(self.ys)}
        high = len(self.ys)
        self.inside: dict[int, list[int]] = {}
        for n, p in enumerate(positions):
            room = _room(p)
            for i in range(bisect_right(self.xs, room.x0), bisect_left(self.xs, room.x1)):
                for j in range(bisect_right(self.ys, room.y0), bisect_left(self.ys, room.y1)):
                    self.inside.setdefault(i * high + j, []).append(n)
        self.taken: Counter[int] = Counter()  # how many ways go a step
        self.slanted: Counter[int] = Counter()  # and how many cross it askew
        self._slants: dict[Segment, list[int]] = {}
        # what it costs to bend at a spot, and to pass it level or upright
        self.turned: Counter[int] = Counter()
        self.across: tuple[Counter[int], Counter[int]] = (Counter(), Counter())
        # how many ways leave a node askew, and where to
        self.askew: Counter[tuple[Point, tuple[bool, bool]]] = Counter()
        self.degree = Counter(n for bond in bonds for n in bond)
        for way in ways:
            self._enter(way, 1)

    def put(self, bond: int, way: Way) -> None:
        """Give a bond another way."""
        self._enter(self.ways[bond], -1)
        self.ways[bond] = way
        self._enter(way, 1)

    def route(self, bond: int) -> Way | None:
        """Return the cheapest way of a bond among the others, None if there is none."""
        self._enter(self.ways[bond], -1)
        found = self._cheapest(*self.bonds[bond])
        self._enter(self.ways[bond], 1)
        return found

    def _cheapest(self, tail: int, head: int) -> Way | None:
        xs, ys, high = self.xs, self.ys, len(self.ys)
        start_at, goal_at = self.positions[tail], self.positions[head]
        start, goal = self._at(tail), self._at(head)
        first, last = start[0] * high + start[1], goal[0] * high + goal[1]
        window = _bounds((start_at, goal_at)).grown(_AROUND)
        left, right = bisect_right(xs, window.x0), bisect_left(xs, window.x1) - 1
        top, bottom = bisect_right(ys, window.y0), bisect_left(ys, window.y1) - 1
        inside, ends = self.inside, {tail, head}

        def free(i: int, j: int) -> bool:
            if not (left <= i <= right and top <= j <= bottom):
                return False
            return all(n in ends for n in inside.get(i * high + j, ()))

        # a node with more bonds than sides is also left askew, to the next crossing of lines,
        # where no other way leaves it like that
        best: dict[int, float] = {}
        before: dict[int, int] = {}
        queue: list[tuple[float, int]] = []

        def offer(price: float, state: int, origin: int) -> None:
            if price < best.get(state, math.inf) - 1e-9:
                best[state] = price
                before[state] = origin
                heapq.heappush(queue, (price, state))

        for k in range(4):
            offer(0.0, 8 * first + k, _NOWHERE)
        for i, j in self._around(start) if self.degree[tail] > 4 else ():
            if free(i, j) and not self.askew[start_at, (xs[i] > start_at[0], ys[j] > start_at[1])]:
                for k in range(4):
                    offer(_ASKEW + _LENGTH, 8 * (i * high + j) + k, _NOWHERE)
        askew_goals = {
            i * high + j
            for i, j in (self._around(goal) if self.degree[head] > 4 else ())
            if not self.askew[goal_at, (xs[i] > goal_at[0], ys[j] > goal_at[1])] and free(i, j)
        }
        taken, slanted, turned, across = self.taken, self.slanted, self.turned, self.across
        steps = [(k, *way, way[0] * high + way[1]) for k, way in enumerate(_DIRECTIONS)]
        end: int | None = None
        while queue:
            price, state = heapq.heappop(queue)
            if price > best[state] + 1e-9:
                continue
            spot, k = divmod(state, 8)
            if spot == last:
                end = state
                break
            if spot in askew_goals:
                offer(price + _ASKEW + _LENGTH, 8 * last + 4 + k, state)
            begun = before[state] == _NOWHERE
            i, j = divmod(spot, high)
            for turn, di, dj, by in steps:
                if (turn ^ k) == 2 or (begun and turn != k):
                    continue
                u, v, there = i + di, j + dj, spot + by
                if not (left <= u <= right and top <= v <= bottom):
                    continue
                if there in inside and not free(u, v):
                    continue
                step = 2 * min(spot, there) + turn % 2
                length = abs(ys[v] - ys[j]) if di == 0 else abs(xs[u] - xs[i])
                more = _LENGTH * length
                more += _SHARE * taken.get(step, 0) + _CROSS * slanted.get(step, 0)
                if turn != k:
                    more += _BEND + turned.get(spot, 0.0)
                elif spot != first:
                    more += across[k % 2].get(spot, 0.0)
                offer(price + more, 8 * there + turn, state)
        if end is None:
            return None
        points = []
        at = end
        while at != _NOWHERE:
            i, j = divmod(at // 8, high)
            points.append((xs[i], ys[j]))
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

    def _enter(self, way: Way, by: int) -> None:
        """Count a way, with `by` of -1 no longer."""
        column, row, high = self.column, self.row, len(self.ys)
        level, upright = self.across
        for p, q in pairwise(way):
            if p[0] == q[0] and p[0] in column:
                base = column[p[0]] * high
                low, end = sorted((row.get(p[1], 0), row.get(q[1], 0)))
                for j in range(low, end):
                    self.taken[2 * (base + j) + 1] += by
                for j in range(low + 1, end):
                    level[base + j] += by * _CROSS
                    self.turned[base + j] += by * _TOUCH
            elif p[1] == q[1] and p[1] in row:
                j = row[p[1]]
                low, end = sorted((column.get(p[0], 0), column.get(q[0], 0)))
                for i in range(low, end):
                    self.taken[2 * (i * high + j)] += by
                for i in range(low + 1, end):
                    upright[i * high + j] += by * _CROSS
                    self.turned[i * high + j] += by * _TOUCH
            else:
                for step in self._slant(p, q):
                    self.slanted[step] += by
        for x, y in way[1:-1]:
            if x in column and y in row:
                spot = column[x] * high + row[y]
                for prices in (level, upright, self.turned):
                    prices[spot] += by * _TOUCH
        for p, q in ((way[0], way[1]), (way[-1], way[-2])):
            if p[0] != q[0] and p[1] != q[1]:
                self.askew[p, (q[0] > p[0], q[1] > p[1])] += by

    def _slant(self, p: Point, q: Point) -> list[int]:
        """Return the steps that a piece crosses askew."""
        known = self._slants.get((p, q))
        if known is not None:
            return known
        xs, ys, high = self.xs, self.ys, len(self.ys)
        found = self._slants[p, q] = []
        left, right = sorted((p[0], q[0]))
        top, bottom = sorted((p[1], q[1]))
        for i in range(max(bisect_left(xs, left) - 1, 0), bisect_right(xs, right)):
            for j in range(max(bisect_left(ys, top) - 1, 0), bisect_right(ys, bottom)):
                x, y = xs[i], ys[j]
                if i + 1 < len(xs) and _cross(((x, y), (xs[i + 1], y)), (p, q)):
                    found.append(2 * (i * high + j))
                if j + 1 < high and _cross(((x, y), (x, ys[j + 1])), (p, q)):
                    found.append(2 * (i * high + j) + 1)
        return found


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
