"""Where the nodes of a picture stand before any is moved: a row or a ring, what hangs on it, pages.

A row of junctions and two-ports from left to right, or the longest ring as a rectangle; then every
other node where it costs least beside a placed neighbour.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from hybond.draw.board import Board, Cell
from hybond.draw.skeleton import rings, spine

Position = tuple[float, float]


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
    most: float = math.inf,
) -> Board | None:
    """Place pinned nodes and `row`, then every other node next to a placed neighbour.

    None if that costs more than `most`, which is seen on the way.
    """
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
                often = most < math.inf and len(board.who) % 16 == 0
                if often and board.cost(range(len(kinds))) > most:
                    return None
            pending = [n for n in pending if board.at[n] is None]
    for node in range(len(kinds)):
        if board.at[node] is None:  # a part of the skeleton that only one-ports lead to
            board.put(node, _best_cell(board, node))
    return board


def _best_cell(board: Board, node: int) -> Cell:
    """Return the free cell near the node's placed neighbours that costs least."""
    anchors = [c for m in board.near[node] if (c := board.at[m]) is not None] or [(0, 0)]
    inner = len(board.near[node]) > 1
    for reach in (2, 4, 8, 16, 64):
        span = range(-reach, reach + 1)
        ways = [(dx, dy) for dx in span for dy in span]
        # the nearest first: most of the others are then known to cost more without being tried
        near = sorted(range(len(ways)), key=lambda k: abs(ways[k][0]) + abs(ways[k][1]))
        best: tuple[int, int, int] | None = None
        found = anchors[0]
        for place, (ax, ay) in enumerate(anchors):
            for k in near:
                dx, dy = ways[k]
                cell = (ax + dx, ay + dy)
                if cell in board.who:
                    continue
                # Room around a branch is worth more than a short bond to it.
                x, y = cell
                around = ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)) if inner else ()
                crowd = 6 * sum(c in board.who for c in around)
                most = math.inf if best is None else best[0] - crowd
                if board.least({node: cell}, most) > most:
                    continue
                board.put(node, cell)
                cost = board.cost([node], most=most) + crowd
                board.take(node)
                rank = (cost, abs(dx) + abs(dy), place * len(ways) + k)
                if best is None or rank < best:
                    best, found = rank, cell
        if best is not None:
            return found
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
