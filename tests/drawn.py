"""What a picture of a bond graph does wrong, counted on its marks alone.

``python tests/drawn.py`` prints the counts of all examples and circuits; names after it choose.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise
from pathlib import Path

import hybond as hb
from hybond.draw.geometry import Box, Point, Segment
from hybond.draw.scene import Frame, Group, Line, Scene, Text
from hybond.draw.words import extent_of

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))
NETLISTS = sorted((ROOT / "examples" / "netlists").glob("*.cir"))
CONVERTERS = sorted((ROOT / "benchmarks" / "converters").glob("*.cir"))
DECKS = sorted(p for p in (ROOT / "benchmarks" / "decks").iterdir() if p.is_file())

_TOUCH = 0.5
"""Pixels by which boxes may lie on each other: the widths of texts are a little too large."""


@dataclass(frozen=True)
class Counts:
    """Flaws of a picture, and how large it is."""

    nodes: int
    bonds: int
    through: int
    """Bonds that run through letters of a node, each node counted."""
    on_node: int
    """Texts that lie on letters of another node."""
    on_label: int
    """Pairs of texts that lie on each other."""
    on_bond: int
    """Texts that a bond runs through."""
    along: int
    """Pairs of bonds that lie on each other for a while."""
    crossings: int
    bends: int
    askew: int
    """Pieces of bonds that are neither level nor upright."""


def counts(scene: Scene) -> Counts:
    """Return the flaws of a picture."""
    nodes = [g for g in scene.groups if g.name == "node"]
    bonds = [g for g in scene.groups if g.name == "bond"]
    letters = [(g, _letters(g)) for g in nodes]
    texts = [(g, _grown(box, -_TOUCH)) for g in nodes for box in _texts(g)]
    texts += [(g, _grown(box, -_TOUCH)) for g in bonds for box in _texts(g)]
    ways = [_way(g) for g in bonds]
    pieces = [list(pairwise(way)) for way in ways]
    near = _Near([(k, p) for k, way in enumerate(pieces) for p in way])
    through = {(k, g.key) for g, box in letters for k, p in near.of(box) if box.cut(p)}
    on_node = sum(
        box.overlaps(other)
        for g, box in texts
        for h, other in letters
        if g is not h or g.name == "bond"
    )
    on_label = sum(a.overlaps(b) for (_, a), (_, b) in combinations(texts, 2))
    on_bond = {(k, n) for n, (_, box) in enumerate(texts) for k, p in near.of(box) if box.cut(p)}
    crossings = along = 0
    for a, b in combinations(range(len(ways)), 2):
        crossings += sum(_cross(p, q) for p in pieces[a] for q in pieces[b])
        along += any(_along(p, q) for p in pieces[a] for q in pieces[b])
    return Counts(
        nodes=len(nodes),
        bonds=len(bonds),
        through=len(through),
        on_node=on_node,
        on_label=on_label,
        on_bond=len(on_bond),
        along=along,
        crossings=crossings,
        bends=sum(len(way) - 2 for way in ways),
        askew=sum(min(abs(p[0] - q[0]), abs(p[1] - q[1])) > 0.5 for w in pieces for p, q in w),
    )


class _Near:
    """Pieces of bonds by place."""

    def __init__(self, pieces: list[tuple[int, Segment]]) -> None:
        self._cells: dict[tuple[int, int], list[tuple[int, Segment]]] = {}
        for k, piece in pieces:
            (ax, ay), (bx, by) = piece
            for cell in _cells(Box(min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))):
                self._cells.setdefault(cell, []).append((k, piece))

    def of(self, box: Box) -> Iterator[tuple[int, Segment]]:
        for cell in _cells(box):
            yield from self._cells.get(cell, ())


def _cells(box: Box) -> Iterator[tuple[int, int]]:
    for i in range(int(box.x0 // 60), int(box.x1 // 60) + 1):
        for j in range(int(box.y0 // 60), int(box.y1 // 60) + 1):
            yield i, j


def _grown(box: Box, by: float) -> Box:
    return box.grown(by)


def _letters(group: Group) -> Box:
    """Return the box of a node's letters, or of the dotted frame around them."""
    for m in group.marks:
        if isinstance(m, Frame) and m.role.startswith(("switch", "part")):
            return m.box
    return next(
        extent_of(m) for m in group.marks if isinstance(m, Text) and m.role.startswith("node")
    )


def _texts(group: Group) -> Iterator[Box]:
    """Yield the boxes of the small texts."""
    for m in group.marks:
        if isinstance(m, Text) and not m.role.startswith(("node", "subscript", "badge")):
            yield extent_of(m)
        elif isinstance(m, Frame) and m.role.startswith("badge"):
            yield m.box


def _way(group: Group) -> tuple[Point, ...]:
    return next(m.points for m in group.marks if isinstance(m, Line) and m.role.startswith("bond"))


def _cross(p: Segment, q: Segment) -> bool:
    """Whether two pieces go through each other; touching at an end does not count."""
    (a, b), (c, d) = p, q

    def turn(u: Point, v: Point, w: Point) -> float:
        return (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0])

    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0


def _along(p: Segment, q: Segment) -> bool:
    (ax, ay), (bx, by) = p
    long = math.dist(*p)
    if min(abs(bx - ax), abs(by - ay), *(abs(u - v) for u, v in zip(*q, strict=True))) > 2.0:
        ux, uy = (bx - ax) / long, (by - ay) / long
        off = [abs(ux * (y - ay) - uy * (x - ax)) for x, y in q]
        ends = sorted(ux * (x - ax) + uy * (y - ay) for x, y in q)
        return max(off) < 2.0 and min(ends[1], long) - max(ends[0], 0.0) > 2.0
    for k in (0, 1):
        m = 1 - k
        if max(abs(p[0][k] - p[1][k]), abs(q[0][k] - q[1][k]), abs(p[0][k] - q[0][k])) < 2.0:
            low = max(min(p[0][m], p[1][m]), min(q[0][m], q[1][m]))
            high = min(max(p[0][m], p[1][m]), max(q[0][m], q[1][m]))
            if high - low > 2.0:
                return True
    return False


def read(path: Path) -> hb.Model:
    """Return the model of a model file or of a circuit."""
    return hb.load(path) if path.suffix == ".toml" else hb.read_circuit(path).model


def main(names: list[str]) -> None:
    """Print the table."""
    fields = list(Counts.__dataclass_fields__)
    print(f"{'':34}" + "".join(f"{f:>10}" for f in fields) + f"{'s':>8}")
    total = dict.fromkeys(fields, 0)
    begun = time.perf_counter()
    for path in (*EXAMPLES, *NETLISTS, *CONVERTERS, *DECKS):
        if names and not any(n in str(path) for n in names):
            continue
        try:
            model = read(path)
        except hb.HybondError as error:
            print(f"{path.name:34}{str(error).splitlines()[0][:90]}")
            continue
        start = time.process_time()
        drawing = model.draw()
        seconds = time.process_time() - start
        found = counts(drawing.scene)
        print(
            f"{path.parent.name[:4] + '/' + path.name:34}"
            + "".join(f"{getattr(found, f) or '':>10}" for f in fields)
            + f"{seconds:8.2f}",
            flush=True,
        )
        for f in fields:
            total[f] += getattr(found, f)
    print(f"{'all':34}" + "".join(f"{total[f]:>10}" for f in fields), end="")
    print(f"{time.perf_counter() - begun:8.1f}")


if __name__ == "__main__":
    main(sys.argv[1:])
