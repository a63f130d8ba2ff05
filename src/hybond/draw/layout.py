"""Compass layout: where the nodes of a bond graph stand on an integer grid.

Power flows from left to right along a horizontal spine of junctions and two-ports; one-ports
hang north and south of it; loops are rectangles. A first placement by these rules is then
improved by moves and swaps at falling temperature (simulated annealing with the threshold of
Dueck & Scheuer, *J. Comput. Phys.* 90, 1990), with a fixed seed and number of steps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from hybond.draw.board import Board, Cell
from hybond.draw.improve import improve
from hybond.draw.skeleton import components, rings, spine

Position = tuple[float, float]

_FULL = 80
"""Number of nodes up to which the search is thorough."""
_TRIES = 9
"""Searches for a picture without a flaw; only for graphs of half that size."""


def layout(
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    *,
    pinned: Mapping[int, Position] | None = None,
    seed: int = 1,
) -> tuple[Position, ...]:
    """Place nodes on a grid.

    Parameters
    ----------
    kinds : sequence of str
        The kind of each node, such as ``"C"`` or ``"1"``.
    bonds : sequence of (tail, head)
        Node numbers.
    pinned : mapping of int to (x, y)
        Nodes that stay where the user put them, in grid cells: x to the right, y **downwards**.
    seed : int
        Seed of the search.

    Returns
    -------
    tuple of (x, y)
        One position per node, in grid cells. Whole numbers, except pinned ones.

    Examples
    --------
    >>> layout(["Se", "1", "I", "R"], [(0, 1), (1, 2), (1, 3)])
    ((0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (1.0, 2.0))
    """
    pins = {n: (float(x), float(y)) for n, (x, y) in (pinned or {}).items()}
    near = Board(kinds, bonds).near
    placed: dict[int, Position] = dict(pins)
    floating = []
    for nodes in components(near):
        own = {n: pins[n] for n in nodes if n in pins}
        cells = _component(kinds, bonds, nodes, own, seed, len(kinds))
        if own:
            placed.update({n: (float(x), float(y)) for n, (x, y) in cells.items() if n not in own})
        else:
            floating.append(cells)
    on_pages(floating, placed)
    return tuple(placed[n] for n in range(len(kinds)))


def on_pages(parts: list[dict[int, Cell]], placed: dict[int, Position]) -> None:
    """Set components out from left to right, in rows about as wide as a page, beside `placed`."""
    left, top = 0, 0
    if placed:
        left = math.ceil(max(x for x, _ in placed.values())) + 2
        top = math.floor(min(y for _, y in placed.values()))
    area = sum((_size(c)[0] + 1) * (_size(c)[1] + 1) for c in parts)
    page = max(12, *(_size(c)[0] for c in parts), math.isqrt(3 * area)) if parts else 0
    x, y, tall = 0, top, 0
    for cells in parts:
        width, height = _size(cells)
        if x and x + width > page:
            x, y, tall = 0, y + tall + 1, 0
        west, north = min(c[0] for c in cells.values()), min(c[1] for c in cells.values())
        for n, (cx, cy) in cells.items():
            placed[n] = (float(left + x + cx - west), float(y + cy - north))
        x, tall = x + width + 1, max(tall, height)


def _size(cells: Mapping[int, Cell]) -> tuple[int, int]:
    xs, ys = [c[0] for c in cells.values()], [c[1] for c in cells.values()]
    return max(xs) - min(xs) + 1, max(ys) - min(ys) + 1


def _component(
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    nodes: Sequence[int],
    pins: Mapping[int, Position],
    seed: int,
    total: int,
) -> dict[int, Cell]:
    """Lay out one connected component; returns its cells."""
    local = {n: k for k, n in enumerate(nodes)}
    own_kinds = [kinds[n] for n in nodes]
    own_bonds = [(local[a], local[b]) for a, b in bonds if a in local]
    fixed: dict[int, Cell] = {}
    for n, (x, y) in pins.items():
        # Two pins may round to one cell: the second takes the nearest free one for the search.
        fixed[local[n]] = nearest((round(x), round(y)), set(fixed.values()))
    size = len(nodes)
    rows = first_rows(Board(own_kinds, own_bonds), fixed)
    starts = [start_board(own_kinds, own_bonds, fixed, row) for row in rows]
    starts.sort(key=lambda b: b.cost(range(size)))  # stable: a tie keeps the order of trying
    # A step of a tangled graph costs more and gains less.
    tangle = min(1.0, size / max(len(own_bonds), 1)) ** 2
    steps = int(tangle * min(_FULL / max(total, 1), 1.0) * min(260 * size, 5000))
    # A picture without a flaw is good enough; otherwise other beginnings are tried.
    best: tuple[int, list[Cell | None]] | None = None
    for attempt in range(_TRIES if size <= _FULL // 2 else 1):
        board = Board(own_kinds, own_bonds)
        for n, cell in enumerate(starts[attempt % len(starts)].at):
            if cell is not None:
                board.put(n, cell)
        hot = 160 if attempt else 40
        improve(board, fixed, steps=steps, seed=seed + attempt, hot=hot)
        if not fixed and size <= _FULL:
            _turn_about(board)
            improve(board, fixed, steps=0, seed=seed)
        cost = board.cost(range(size))
        if best is None or cost < best[0]:
            best = cost, board.at
        if not board.defects():
            break
    assert best is not None
    cells = [c for c in best[1] if c is not None]
    return dict(zip(nodes, cells, strict=True))


def _turn_about(board: Board) -> None:
    """Mirror or turn the whole picture to the way that suits the compass best."""
    nodes = range(len(board.kinds))
    here = {n: c for n, c in enumerate(board.at) if c is not None}
    ways = []
    for a, b in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        ways.append({n: (a * x, b * y) for n, (x, y) in here.items()})
        ways.append({n: (a * y, b * x) for n, (x, y) in here.items()})
    costs = []
    for way in ways:
        board.move(way)
        costs.append(board.cost(nodes))
    board.move(ways[costs.index(min(costs))])


def first_rows(board: Board, fixed: Mapping[int, Cell]) -> list[dict[int, Cell]]:
    """Return candidate placements of the spine or of the longest ring."""
    if fixed:
        return [{}]
    nodes = range(len(board.kinds))
    rows = [_snake(spine(board, nodes))]
    ring = rings(board.near, nodes)
    if 4 <= len(ring) <= 40:
        for height in range(1, min(4, len(ring) // 2)):
            frame = _rectangle(len(ring), height)
            for shift in range(0, len(ring), max(1, len(ring) // 4)):
                turned = ring[shift:] + ring[:shift]
                rows.append(dict(zip(turned, frame, strict=True)))
    return rows


def _snake(path: Sequence[int]) -> dict[int, Cell]:
    """Place a path on a row; a long one is folded so that the picture fits a page."""
    size = len(path)
    per_row = size if size <= 16 else max(12, math.isqrt(6 * size))
    cells = {}
    for k, node in enumerate(path):
        row, column = divmod(k, per_row)
        cells[node] = (column if row % 2 == 0 else per_row - 1 - column, 3 * row)
    return cells


def _rectangle(size: int, height: int) -> list[Cell]:
    """Return `size` cells around a rectangle, clockwise; one long side if `size` is odd."""
    width = (size + 1) // 2 - height
    around = [(x, 0) for x in range(width)] + [(width, y) for y in range(height)]
    around += [(x, height) for x in range(width, 0, -1)] + [(0, y) for y in range(height, 0, -1)]
    return around[:size]


def start_board(
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    fixed: Mapping[int, Cell],
    row: Mapping[int, Cell],
) -> Board:
    """Place pinned nodes and `row`, then every other node next to a placed neighbour."""
    board = Board(kinds, bonds)
    for node, cell in {**fixed, **row}.items():
        board.put(node, cell)
    if not board.who:
        board.put(spine(board, range(len(kinds)))[0], (0, 0))
    # Skeleton before one-ports: these find room, a branch does not.
    for inner in (True, False):
        pending = [
            n
            for n in range(len(kinds))
            if board.at[n] is None and (len(board.near[n]) > 1) == inner
        ]
        while pending:
            ready = [n for n in pending if any(board.at[m] for m in board.near[n])]
            if not ready:
                break
            for node in ready:
                board.put(node, _best_cell(board, node))
            pending = [n for n in pending if board.at[n] is None]
    for node in range(len(kinds)):
        if board.at[node] is None:  # a part of the skeleton that only one-ports lead to
            board.put(node, _best_cell(board, node))
    return board


def _best_cell(board: Board, node: int) -> Cell:
    """Return the free cell near the node's placed neighbours that costs least."""
    anchors = [c for m in board.near[node] if (c := board.at[m]) is not None] or [(0, 0)]
    best: tuple[int, int, Cell] | None = None
    for reach in (2, 4, 8, 16, 64):
        for ax, ay in anchors:
            for dx in range(-reach, reach + 1):
                for dy in range(-reach, reach + 1):
                    cell = (ax + dx, ay + dy)
                    if cell in board.who:
                        continue
                    board.put(node, cell)
                    # Room around a branch is worth more than a short bond to it.
                    crowd = sum(
                        (cell[0] + i, cell[1] + j) in board.who
                        for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))
                    )
                    cost = board.cost([node]) + (6 * crowd if len(board.near[node]) > 1 else 0)
                    board.take(node)
                    if best is None or (cost, abs(dx) + abs(dy)) < best[:2]:
                        best = (cost, abs(dx) + abs(dy), cell)
        if best is not None:
            return best[2]
    return nearest(anchors[0], set(board.who))


def nearest(wish: Cell, taken: set[Cell]) -> Cell:
    """Return the free cell nearest to `wish`."""
    reach = 0
    while True:
        ring = [
            (wish[0] + dx, wish[1] + dy)
            for dx in range(-reach, reach + 1)
            for dy in range(-reach, reach + 1)
            if max(abs(dx), abs(dy)) == reach
        ]
        free = [c for c in ring if c not in taken]
        if free:
            return min(free, key=lambda c: (abs(c[0] - wish[0]) + abs(c[1] - wish[1]), c))
        reach += 1
