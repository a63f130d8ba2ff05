"""Where wires of schematics meet: nets, places that all wires of a node share, dots."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

from hybond.draw.beside import Wire
from hybond.draw.geometry import Point
from hybond.draw.scene import Line
from hybond.draw.symbols import Placed

DOT = 3.0
"""Radius of the dot where three wires meet."""


def element_of(end: str) -> str:
    """Return the element of an end: ``r`` of ``r.plus``."""
    return end.partition(".")[0]


def port_of(end: str) -> str:
    """Return the port of an end, nothing of a node."""
    return end.partition(".")[2]


def nets_of(shared: set[str], bonds: Sequence[tuple[str, str]]) -> list[str]:
    """Return of each bond the net that its wire belongs to, by one of the ends of that.

    `shared` are the ends that wires share: dots and pins. What meets at letters meets in what they
    mean, and is no net.
    """
    net: dict[str, str] = {}

    def root(end: str) -> str:
        while net.get(end, end) != end:
            end = net[end]
        return end

    owners = []
    for k, (a, b) in enumerate(bonds):
        one, other = (end if end in shared else f"{end} {k}" for end in (a, b))
        net[root(one)] = root(other)
        owners.append(one)
    return [root(one) for one in owners]


def cut_back(wires: Sequence[Wire], dots: Sequence[str]) -> tuple[list[Wire], dict[str, Point]]:
    """Let wires that all come to a dot by one way meet where that begins, and return where."""
    ways = [list(way) for _, _, way in wires]
    meets: dict[str, Point] = {}
    for dot in dots:
        own = [
            (k, element_of(a) == dot)
            for k, (a, b, _) in enumerate(wires)
            if dot in (element_of(a), element_of(b))
        ]
        if len(own) < 2:
            continue
        paths = [ways[k] if first else ways[k][::-1] for k, first in own]
        shared = _shared(paths)
        meets[dot] = shared[-1]
        for (k, first), path in zip(own, paths, strict=True):
            rest = [shared[-1], *path[len(shared) - (shared[-1] not in path) :]]
            ways[k] = rest if first else rest[::-1]
    return [(a, b, tuple(way)) for (a, b, _), way in zip(wires, ways, strict=True)], meets


def _shared(paths: Sequence[Sequence[Point]]) -> list[Point]:
    """Return the part from their first place on that all paths have in common."""
    found = [paths[0][0]]
    while True:
        here = found[-1]
        ahead = [_after(path, len(found) - 1) for path in paths]
        steps = [(q[0] - here[0], q[1] - here[1]) for q in ahead if q is not None]
        if len(steps) < len(paths) or len({(_sign(x), _sign(y)) for x, y in steps}) > 1:
            return found
        x, y = min(steps, key=lambda step: abs(step[0]) + abs(step[1]))
        there = (here[0] + x, here[1] + y)
        if any(there == path[-1] for path in paths):
            return found  # else a wire had no length
        found.append(there)
        if any(step != (x, y) for step in steps):
            return found


def _after(path: Sequence[Point], k: int) -> Point | None:
    """Return the corner after the k-th, or the other end of the path; None after that."""
    return path[k + 1] if k + 1 < len(path) else None


def joints_of(wires: Sequence[Wire], nets: Sequence[str], put: Mapping[str, Placed]) -> list[Point]:
    """Return the places where three or four wires of one net meet: there stands a dot.

    At a pin the line of its symbol is one of them.
    """
    pieces: dict[str, list[tuple[Point, Point]]] = {}
    for net, (a, b, way) in zip(nets, wires, strict=True):
        pieces.setdefault(net, []).extend(itertools.pairwise(way))
        for end in (a, b):
            pins = put[element_of(end)].pins if element_of(end) in put else {}
            if port_of(end) in pins:
                (x, y), (dx, dy) = pins[port_of(end)]
                pieces[net].append(((x, y), (x - dx, y - dy)))
    found = []
    for own in pieces.values():
        places = {p for piece in own for p in piece}
        places |= {(p[0], r[1]) for p, q in own if p[0] == q[0] for r, s in own if r[1] == s[1]}
        found += [at for at in sorted(places) if len(_rays(at, own)) > 2]
    return found


def _rays(at: Point, pieces: Sequence[tuple[Point, Point]]) -> set[tuple[int, int]]:
    """Return the ways in which wires leave a place."""
    found = set()
    for p, q in pieces:
        inside = min(p[0], q[0]) <= at[0] <= max(p[0], q[0])
        inside &= min(p[1], q[1]) <= at[1] <= max(p[1], q[1])
        if not inside or (p[0] != q[0] and p[1] != q[1]):
            continue
        for end in (p, q):
            way = (_sign(end[0] - at[0]), _sign(end[1] - at[1]))
            if way != (0, 0):
                found.add(way)
    return found


def _sign(v: float) -> int:
    return (v > 0) - (v < 0)


def joint(at: Point) -> Line:
    """Return the dot at a place where wires meet."""
    around = [2.0 * math.pi * k / 12 for k in range(13)]
    corners = tuple((at[0] + DOT * math.cos(a), at[1] + DOT * math.sin(a)) for a in around)
    return Line("symbol filled", corners)
