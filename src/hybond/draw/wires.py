"""Wires of schematics: level and upright pieces from pin to pin, as a draughtsman would lead them.

Wires run on lines of a grid through all pins. A way costs what a reader minds: bends, crossings,
wires close to symbols; to lie on a wire of another net, or to pass through a symbol, costs more
than any way around, and to go along a wire of the same net next to nothing. The cheapest way is
found for each wire in turn (Lee 1961; Hart, Nilsson, Raphael 1968), then each is taken out and led
once more, when it is known where the others are.
"""

from __future__ import annotations

import heapq
import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from hybond.draw.geometry import Box, Point

End = tuple[Point, Point | None]
"""Where a wire ends, and the way in which it leaves; None at a dot, where any way is right."""
GRID = 10.0
"""Pixels from one line of the grid to the next."""
AROUND = 90.0
"""Pixels around two ends in which their wire is looked for first."""
BEND, CROSSING, SIDEWAYS = 30.0, 45.0, 60.0
"""Pixels that a bend is worth, a crossing, and a pin that is left another way than it points."""
FORBIDDEN, THROUGH = 2000.0, 400.0
"""Likewise a step on a wire of another net, and one through a symbol: a pin may be within one."""
NEAR_SYMBOL, NEAR_WIRE, ON_OWN = 1.0, 0.6, 0.15
"""What a pixel costs more close to a symbol or to a wire of another net; and all it costs on one of
its own net."""
CLOSE = 9.0
_WAYS = ((1, 0), (0, 1), (-1, 0), (0, -1))

Node = tuple[int, int]
Step = tuple[Node, Node]
"""From a node of the grid to the next to the right, or below."""


@dataclass(frozen=True, slots=True)
class Wire:
    """A wire that is wanted: its ends, and the net that it belongs to."""

    a: End
    b: End
    net: str


@dataclass(slots=True)
class _Field:
    """The grid, and what is on it."""

    xs: list[float]
    ys: list[float]
    inside: set[Node]
    """Nodes within symbols, and close to them."""
    close: set[Node]
    steps: dict[Step, list[str]] = field(default_factory=dict)
    """The nets whose wires run there, once for each wire."""
    corners: dict[Node, list[str]] = field(default_factory=dict)
    """The nets whose wires end or bend there."""

    def at(self, p: Point) -> Node:
        return bisect_left(self.xs, p[0]), bisect_left(self.ys, p[1])

    def place(self, n: Node) -> Point:
        return self.xs[n[0]], self.ys[n[1]]


def led(
    wires: Sequence[Wire],
    boxes: Sequence[Box],
    *,
    given: Sequence[tuple[Point, ...] | None] = (),
) -> list[tuple[Point, ...]]:
    """Return the ways of wires among symbols, each from its first end to its second.

    Parameters
    ----------
    given : sequence of tuple of (x, y) or None
        Ways that are known and stay, their corners in line with ends of wires; the others are led
        around them.

    Examples
    --------
    >>> one = Wire(((0.0, 0.0), (1.0, 0.0)), ((40.0, 30.0), (0.0, -1.0)), "n")
    >>> led([one], [])
    [((0.0, 0.0), (40.0, 0.0), (40.0, 30.0))]
    """
    if not wires:
        return []
    f = _field(wires, boxes, given)
    found: list[list[Node]] = [[] for _ in wires]

    def length(k: int) -> float:
        (p, _), (q, _) = wires[k].a, wires[k].b
        return abs(p[0] - q[0]) + abs(p[1] - q[1])

    known = [given[k] if k < len(given) else None for k in range(len(wires))]
    if all(way is not None for way in known):
        return [way for way in known if way is not None]
    for k, way in enumerate(known):
        if way is not None:
            found[k] = _along(f, way)
            _put(f, found[k], wires[k].net, 1)
    order = sorted((k for k in range(len(wires)) if known[k] is None), key=length)
    for again in (False, True):
        for k in order:
            if again:
                _put(f, found[k], wires[k].net, -1)
            own = {
                n for j, w in enumerate(wires) if w.net == wires[k].net and j != k for n in found[j]
            }
            found[k] = _way(f, wires[k], own)
            _put(f, found[k], wires[k].net, 1)
    return [
        way if way is not None else _corners([f.place(n) for n in nodes])
        for way, nodes in zip(known, found, strict=True)
    ]


def _along(f: _Field, way: Sequence[Point]) -> list[Node]:
    """Return the nodes that a known way passes."""
    nodes = [f.at(way[0])]
    for p in way[1:]:
        (i, j), (u, v) = nodes[-1], f.at(p)
        steps = max(abs(u - i), abs(v - j))
        dx, dy = (u > i) - (u < i), (v > j) - (v < j)
        nodes += [(i + k * dx, j + k * dy) for k in range(1, steps + 1)]
    return nodes


def clear(
    wires: Sequence[Wire], ways: Sequence[tuple[Point, ...]], boxes: Sequence[Box]
) -> list[tuple[Point, ...] | None]:
    """Return the ways that touch no symbol and lie on no way of another net, None for others.

    Examples
    --------
    >>> ends = ((0.0, 0.0), None), ((40.0, 0.0), None)
    >>> clear([Wire(*ends, "n"), Wire(*ends, "m")], [((0, 0), (40, 0))] * 2, [])
    [((0, 0), (40, 0)), None]
    """
    solid = [_solid(box) for box in boxes]
    solid = [box for box in solid if box.x0 < box.x1 and box.y0 < box.y1]
    lines: dict[tuple[int, float], list[tuple[float, float, str]]] = {}
    found: list[tuple[Point, ...] | None] = []
    for w, way in zip(wires, ways, strict=True):
        own = []
        free = True
        for p, q in pairwise(way):
            k = 0 if p[0] == q[0] else 1
            low, high = min(p[1 - k], q[1 - k]), max(p[1 - k], q[1 - k])
            there = lines.get((k, p[k]), ())
            free &= all(n == w.net or b < low or high < a for a, b, n in there)
            free &= not any(box.cut((p, q)) for box in solid)
            own.append(((k, p[k]), (low, high, w.net)))
        found.append(way if free else None)
        if free:
            for key, piece in own:
                lines.setdefault(key, []).append(piece)
    return found


def _field(
    wires: Sequence[Wire], boxes: Sequence[Box], given: Sequence[tuple[Point, ...] | None]
) -> _Field:
    pins = [end[0] for w in wires for end in (w.a, w.b)]
    pins += [p for way in given if way is not None for p in way]
    edges = [Box(x, y, x, y) for x, y in pins] + list(boxes)
    xs = _lines({p[0] for p in pins}, min(b.x0 for b in edges), max(b.x1 for b in edges))
    ys = _lines({p[1] for p in pins}, min(b.y0 for b in edges), max(b.y1 for b in edges))
    f = _Field(xs, ys, set(), set())
    for box in boxes:
        f.inside |= _nodes(f, _solid(box))
        f.close |= _nodes(f, box.grown(CLOSE))
    for w in wires:
        for p, _ in (w.a, w.b):
            f.corners.setdefault(f.at(p), []).append(w.net)
    return f


def _solid(box: Box) -> Box:
    """Return what no wire passes: a symbol up to its pins, its own line where it is thin."""
    x, y = (-1.0 if long > 2.0 * GRID else 1.0 for long in (box.x1 - box.x0, box.y1 - box.y0))
    return Box(box.x0 - x, box.y0 - y, box.x1 + x, box.y1 + y)


def _lines(pins: set[float], low: float, high: float) -> list[float]:
    """Return lines through all pins, and others where these leave room."""
    first, last = math.floor((low - AROUND) / GRID), math.ceil((high + AROUND) / GRID)
    own = sorted(pins)
    found = list(own)
    for k in range(first, last + 1):
        v = k * GRID
        i = bisect_left(own, v)
        if all(abs(v - own[j]) > 0.6 * GRID for j in (i - 1, i) if 0 <= j < len(own)):
            found.append(v)
    return sorted(found)


def _nodes(f: _Field, box: Box) -> set[Node]:
    across = range(bisect_left(f.xs, box.x0), bisect_left(f.xs, box.x1 + 1e-9))
    down = range(bisect_left(f.ys, box.y0), bisect_left(f.ys, box.y1 + 1e-9))
    return {(i, j) for i in across for j in down}


def _way(f: _Field, w: Wire, own: set[Node]) -> list[Node]:
    """Return the nodes of the cheapest way, looked for near its ends first.

    `own` are the nodes on other wires of its net.
    """
    least = _least(f, f.at(w.b[0]), own)
    (p, _), (q, _) = w.a, w.b
    near = Box(min(p[0], q[0]), min(p[1], q[1]), max(p[0], q[0]), max(p[1], q[1])).grown(AROUND)
    low, high = f.at((near.x0, near.y0)), f.at((near.x1, near.y1))
    high = (min(high[0], len(f.xs) - 1), min(high[1], len(f.ys) - 1))
    way, cost = _cheapest(f, w, least, low, high)
    if cost >= FORBIDDEN:
        way, _ = _cheapest(f, w, least, (0, 0), (len(f.xs) - 1, len(f.ys) - 1))
    return way


def _least(f: _Field, goal: Node, own: set[Node]) -> list[list[float]]:
    """Return what a way from each node costs at least: to the goal, or to its own net and on there.

    The search begins with what may end soonest by it, and leaves the far side of the paper out.
    """
    xs, ys = np.array(f.xs), np.array(f.ys)
    least = np.full((len(xs), len(ys)), np.inf)
    x, y = f.place(goal)
    for i, j in own:
        least[i, j] = ON_OWN * (abs(f.xs[i] - x) + abs(f.ys[j] - y))
    least[goal] = 0.0
    for values, at in ((least, xs[:, None]), (least.T, ys[:, None])):
        before = np.minimum.accumulate(values - at, axis=0) + at
        after = np.minimum.accumulate((values + at)[::-1], axis=0)[::-1] - at
        values[:] = np.minimum(before, after)
    found: list[list[float]] = least.tolist()
    return found


def _cheapest(
    f: _Field, w: Wire, least: Sequence[Sequence[float]], low: Node, high: Node
) -> tuple[list[Node], float]:
    """Return the cheapest way between nodes of a part of the grid, and what it costs."""
    start, goal = f.at(w.a[0]), f.at(w.b[0])
    best: dict[tuple[Node, int], float] = {}
    before: dict[tuple[Node, int], tuple[Node, int]] = {}
    steps: dict[tuple[Node, int], float] = {}
    turns: dict[Node, float] = {}
    heap: list[tuple[float, float, int, Node]] = []
    for d in range(4):
        best[start, d] = cost = _aside(w.a[1], d)
        heapq.heappush(heap, (cost + least[start[0]][start[1]], cost, d, start))
    ends: list[tuple[float, int]] = []
    limit = math.inf
    while heap and heap[0][0] < limit:
        _, cost, d, n = heapq.heappop(heap)
        if cost > best[n, d]:
            continue
        if n == goal:
            total = cost + _aside(w.b[1], (d + 2) % 4)
            ends.append((total, d))
            limit = min(limit, total)
            continue
        for e in (d, (d + 1) % 4, (d + 3) % 4):
            if e != d and n == start:
                continue
            m = (n[0] + _WAYS[e][0], n[1] + _WAYS[e][1])
            if not (low[0] <= m[0] <= high[0] and low[1] <= m[1] <= high[1]):
                continue
            step = steps.get((n, e))
            if step is None:
                step = steps[n, e] = _step(f, w.net, n, m)
            more, known = cost + step + (BEND if e != d else 0.0), best.get((m, e), math.inf)
            if more >= known:
                continue
            if e != d:
                if n not in turns:
                    turns[n] = _turn(f, w.net, n)
                more += turns[n]
            if n != start:
                more += _through(f, w.net, n, e, turned=e != d)
            if more < known:
                best[m, e] = more
                before[m, e] = (n, d)
                heapq.heappush(heap, (more + least[m[0]][m[1]], more, e, m))
    cost, d = min(ends)
    at, way = (goal, d), [goal]
    while at in before:
        at = before[at]
        way.append(at[0])
    return way[::-1], cost


def _aside(pin: Point | None, d: int) -> float:
    """Return what it costs to leave a pin in a way."""
    if pin is None:
        return 0.0
    return SIDEWAYS * (1.0 - pin[0] * _WAYS[d][0] - pin[1] * _WAYS[d][1])


def _step(f: _Field, net: str, n: Node, m: Node) -> float:
    """Return what the step to the next node costs."""
    long = abs(f.xs[m[0]] - f.xs[n[0]]) + abs(f.ys[m[1]] - f.ys[n[1]])
    there = f.steps.get((n, m) if n < m else (m, n))
    if there:
        return FORBIDDEN + long if _foreign(there, net) else ON_OWN * long
    if n in f.inside or m in f.inside:
        return THROUGH + long
    more = NEAR_SYMBOL if n in f.close and m in f.close else 0.0
    return long * (1.0 + more + NEAR_WIRE * _beside(f, net, n, m))


def _beside(f: _Field, net: str, n: Node, m: Node) -> float:
    """Return on how many sides a wire of another net runs close beside a step."""
    dx, dy = (0, 1) if n[1] == m[1] else (1, 0)
    found = 0
    for s in (-1, 1):
        one, two = (n[0] + s * dx, n[1] + s * dy), (m[0] + s * dx, m[1] + s * dy)
        others = f.steps.get((one, two) if one < two else (two, one))
        found += _foreign(others, net)
    return float(found)


def _foreign(there: Sequence[str] | None, net: str) -> bool:
    """Whether one of the wires there is of another net; most often there is none."""
    return there is not None and any(other != net for other in there)


def _turn(f: _Field, net: str, n: Node) -> float:
    """Return what a bend costs more where wires of another net cross."""
    for i, j in ((n[0] + 1, n[1]), (n[0] - 1, n[1]), (n[0], n[1] + 1), (n[0], n[1] - 1)):
        if _foreign(f.steps.get((min(n, (i, j)), max(n, (i, j)))), net):
            return FORBIDDEN
    return 0.0


def _through(f: _Field, net: str, n: Node, d: int, *, turned: bool) -> float:
    """Return what it costs to pass a node where others bend, end, or cross."""
    if _foreign(f.corners.get(n), net):
        return FORBIDDEN
    if turned:
        return 0.0
    dx, dy = _WAYS[(d + 1) % 4]
    m = (n[0] + dx, n[1] + dy)
    across = f.steps.get((min(n, m), max(n, m)))
    return CROSSING if _foreign(across, net) else 0.0


def _put(f: _Field, way: Sequence[Node], net: str, sign: int) -> None:
    """Put a way onto the field, or take it from there."""

    def change(there: list[str]) -> None:
        there.append(net) if sign > 0 else there.remove(net)

    for n, m in pairwise(way):
        change(f.steps.setdefault((min(n, m), max(n, m)), []))
    for a, b, c in zip(way, way[1:], way[2:], strict=False):
        if a[0] != c[0] and a[1] != c[1]:
            change(f.corners.setdefault(b, []))


def _corners(way: Sequence[Point]) -> tuple[Point, ...]:
    """Leave out corners that are none."""
    found = [way[0]]
    for a, b, c in zip(way, way[1:], way[2:], strict=False):
        if not (a[0] == b[0] == c[0] or a[1] == b[1] == c[1]):
            found.append(b)
    return (*found, way[-1]) if len(way) > 1 else (way[0], way[0])
