"""Where the nodes of a drawing stand, and where its bonds bend.

Power flows from left to right along a horizontal spine; one-ports hang north and south of it; loops
are rectangles; equal parts are copies of one in a row. First a graph with one part of each kind is
placed, then the others are put beside it, then all is improved together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybond.draw.board import Board, Cell
from hybond.draw.geometry import Point
from hybond.draw.layout import first_rows, nearest, on_pages, start_board
from hybond.draw.legs import Leg, legs_of
from hybond.draw.search import Search
from hybond.draw.skeleton import components
from hybond.draw.streets import LEVEL_FIRST, STRAIGHT_AWAY, Streets
from hybond.draw.ways import Way, clear_ways

_THOROUGH = 110
"""Number of nodes up to which the search is thorough."""
_LARGE = 320
"""Beyond, only the first placement is made."""
_TRIES = 6
_STEPS = 9000


_SLANT = 0.12
"""Cells by which a bond may slant unseen."""


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Where nodes stand and bonds run, in grid cells, y downwards.

    Parameters
    ----------
    positions : tuple of (x, y)
        One per node.
    bends : tuple of tuple of (x, y)
        Per bond, from tail to head, its bends; none for a straight one.
    """

    positions: tuple[Point, ...]
    bends: tuple[tuple[Point, ...], ...]


def arrange(
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    *,
    pinned: Mapping[int, Point] | None = None,
    seed: int = 1,
) -> Arrangement:
    """Return where the nodes of a drawing stand and how its bonds run.

    Parameters
    ----------
    kinds, bonds, pinned, seed
        As for `hybond.draw.layout.layout`. Bonds between two pinned nodes are straight where
        nothing is in their way.

    Examples
    --------
    >>> found = arrange(["Se", "1", "I", "R"], [(0, 1), (1, 2), (1, 3)])
    >>> found.positions, found.bends
    (((0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (1.0, 2.0)), ((), (), ()))
    """
    pins = {n: (float(x), float(y)) for n, (x, y) in (pinned or {}).items()}
    pairs: dict[tuple[int, int], None] = {}
    for a, b in bonds:
        if a != b and (b, a) not in pairs:
            pairs[a, b] = None
    single = list(pairs)
    placed: dict[int, Point] = dict(pins)
    floating: list[dict[int, Cell]] = []
    turns: dict[tuple[int, int], int] = {}
    for nodes in components(Board(kinds, single).near):
        local = {n: k for k, n in enumerate(nodes)}
        own = [(a, b) for a, b in single if a in local]
        fixed: dict[int, Cell] = {}
        for n in nodes:
            if n in pins:
                # Two pins may round to one cell: the second takes the nearest free one.
                wish = (round(pins[n][0]), round(pins[n][1]))
                fixed[local[n]] = nearest(wish, set(fixed.values()))
        board = arranged(
            [kinds[n] for n in nodes], [(local[a], local[b]) for a, b in own], fixed, seed=seed
        )
        turns.update(zip(own, board.turns, strict=True))
        cells = {n: cell for n, cell in zip(nodes, board.at, strict=True) if cell is not None}
        if fixed:
            placed.update({n: (float(x), float(y)) for n, (x, y) in cells.items() if n not in pins})
        else:
            floating.append(cells)
    on_pages(floating, placed)
    positions = tuple(placed[n] for n in range(len(kinds)))
    ways: list[Way] = []
    for a, b in single:
        way = STRAIGHT_AWAY if a in pins and b in pins else turns[a, b]
        ways.append(_way(positions[a], positions[b], way))
    known = dict(zip(single, clear_ways(positions, single, ways), strict=True))
    bends = [
        known[a, b][1:-1] if (a, b) in known else known[b, a][-2:0:-1] if a != b else ()
        for a, b in bonds
    ]
    return Arrangement(positions, tuple(bends))


def _way(a: Point, b: Point, turn: int) -> Way:
    if turn == STRAIGHT_AWAY or min(abs(a[0] - b[0]), abs(a[1] - b[1])) < _SLANT:
        return (a, b)
    return (a, (b[0], a[1]) if turn == LEVEL_FIRST else (a[0], b[1]), b)


def arranged(
    kinds: Sequence[str], bonds: Sequence[tuple[int, int]], fixed: Mapping[int, Cell], *, seed: int
) -> Streets:
    """Return the board of a connected graph, without bonds between one pair of nodes twice.

    Examples
    --------
    >>> board = arranged(["Se", "1", "I", "R"], [(0, 1), (1, 2), (1, 3)], {}, seed=1)
    >>> board.defects(), board.at[1][0] - board.at[0][0]
    (0, 1)
    """
    size = len(kinds)
    groups = legs_of(kinds, bonds) if not fixed and size <= _LARGE else []
    small = size <= _THOROUGH
    alone = size - sum(len(leg) for group in groups for leg in group[1:])
    steps = min(150 * alone, _STEPS) if small else min(_STEPS, 400000 // size)
    near = Board(kinds, bonds).near
    crowded = sum(max(0, len(n) - 4) for n in near)  # bonds that have no side of their own
    best: tuple[int, Streets] | None = None
    tries = max(2, min(_TRIES, _TRIES * 40 // size)) if small else 1
    for attempt in range(tries):
        board = _begun(kinds, bonds, fixed, groups, seed, attempt)
        search = Search(board, set(fixed), groups)
        if size <= _LARGE:
            search.anneal(steps, seed=seed + attempt, hot=160 if attempt else 40)
            search.descend(rounds=6 if small else 2, reach=2 if small else 1)
            if not fixed and small:
                _turn_about(search)
                search.descend(rounds=2, reach=1)
        cost = board.cost(range(size))
        if best is None or cost < best[0]:
            best = cost, board
        if board.defects() <= crowded:
            break
    assert best is not None
    return best[1]


def _begun(
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    fixed: Mapping[int, Cell],
    groups: Sequence[Sequence[Leg]],
    seed: int,
    attempt: int,
    row: Mapping[int, Cell] | None = None,
) -> Streets:
    """Return a board with every node placed, legs in a row; `row` is where some begin."""
    if not groups:
        board = Streets(kinds, bonds)
        rows = [row] if row else first_rows(board, fixed)
        starts = [start_board(kinds, bonds, fixed, cells) for cells in rows]
        starts.sort(key=lambda b: b.cost(range(len(kinds))))
        for n, cell in enumerate(starts[attempt % len(starts)].at):
            if cell is not None:
                board.put(n, cell)
        return board
    upright = attempt % 2 == 0
    if row is None and attempt % 3 < 2:
        row = _between_hubs(Board(kinds, bonds), groups, upright=upright)
    legs = groups[0]
    links = _links(Board(kinds, bonds), legs)
    kept = [n for n in range(len(kinds)) if n not in links and not any(n in g for g in legs[1:])]
    number = {n: k for k, n in enumerate(kept)}
    fewer = [
        [tuple(number[n] for n in leg) for leg in group]
        for group in groups[1:]
        if all(n in number for leg in group for n in leg)
    ]
    own = [(number[a], number[b]) for a, b in bonds if a in number and b in number]
    own_kinds = [kinds[n] for n in kept]
    inner = None if row is None else {number[n]: cell for n, cell in row.items() if n in number}
    small = _begun(own_kinds, own, {}, fewer, seed, attempt, inner)
    search = Search(small, set(), fewer)
    # what is begun well is only put right, or it is lost again
    search.anneal(min(100 * len(kept), 3000), seed=seed + attempt, hot=15 if row else 160)
    search.descend(rounds=2, reach=1)
    cells = {n: cell for n, k in number.items() if (cell := small.at[k]) is not None}
    if row:
        return _multiplied(kinds, bonds, cells, legs, 0 if upright else 1)
    boards = [_multiplied(kinds, bonds, cells, legs, axis) for axis in (0, 1)]
    boards.sort(key=lambda b: b.cost(range(len(kinds))))
    return boards[attempt % 2]


def _between_hubs(
    board: Board, groups: Sequence[Sequence[Leg]], *, upright: bool
) -> dict[int, Cell] | None:
    """Return a line from hub to hub through the first leg of each group that lies between two.

    Legs that stand side by side then reach each hub from its own side, and nothing is crossed.
    """
    lines: list[list[int]] = []
    for legs in groups:
        inside = set(legs[0])
        shared = set.intersection(*({m for n in leg for m in board.near[n]} for leg in legs))
        hubs = sorted(shared - inside)
        paths = [
            path
            for k, a in enumerate(hubs)
            for b in hubs[k + 1 :]
            if (path := _through(board, a, b, inside)) is not None
        ]
        if not paths:
            continue
        line = max(paths, key=len)
        for known in lines:  # one hub may end one line and begin the next
            if {known[0], known[-1]} & {line[0], line[-1]} and len({*known} & {*line}) == 1:
                if known[0] in (line[0], line[-1]):
                    known.reverse()
                known += (line if line[0] == known[-1] else line[::-1])[1:]
                break
        else:
            lines.append(line)
    cells: dict[int, Cell] = {}
    for k, line in enumerate(lines):
        for place, n in enumerate(line):
            cells.setdefault(n, (6 * k, place) if upright else (place, 6 * k))
    return cells or None


def _through(board: Board, a: int, b: int, inside: set[int]) -> list[int] | None:
    """Return the shortest path from one hub to another through the nodes of a leg."""
    before: dict[int, int] = {a: a}
    new = [a]
    for node in new:
        for m in board.near[node]:
            if m in before or (m not in inside and (m != b or node == a)):
                continue
            before[m] = node
            if m == b:
                path = [b]
                while path[-1] != a:
                    path.append(before[path[-1]])
                return path[::-1]
            new.append(m)
    return None


def _multiplied(
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    cells: Mapping[int, Cell],
    legs: Sequence[Leg],
    axis: int,
) -> Streets:
    """Return a board with the other legs beside the first, along `axis`, and room for them."""
    first = [cells[n] for n in legs[0]]
    low, high = min(c[axis] for c in first), max(c[axis] for c in first)
    pitch = high - low + (2 if len(cells) + len(first) * (len(legs) - 1) < len(kinds) else 1)
    more = pitch * (len(legs) - 1)
    board = Streets(kinds, bonds)

    def moved(cell: Cell, by: int) -> Cell:
        return (cell[0] + by, cell[1]) if axis == 0 else (cell[0], cell[1] + by)

    inside = set(legs[0])
    # what every leg hangs on stands at the middle one
    hubs = {a if b in inside else b for a, b in bonds if (a in inside) != (b in inside)}
    half = pitch * ((len(legs) - 1) // 2)
    for k, leg in enumerate(legs):
        for n, cell in zip(leg, first, strict=True):
            board.put(n, moved(cell, k * pitch))
    for n, cell in sorted(cells.items()):
        if n in inside:
            continue
        wish = moved(
            cell, more if cell[axis] > high else half if n in hubs and cell[axis] >= low else 0
        )
        board.put(n, nearest(wish, set(board.who)))
    if len(board.who) < len(kinds):
        known = {n: cell for n, cell in enumerate(board.at) if cell is not None}
        whole = start_board(kinds, bonds, known, {})
        for n, place in enumerate(whole.at):
            if n not in known and place is not None:
                board.put(n, place)
    board.best_turns(range(len(bonds)))
    return board


def _links(board: Board, legs: Sequence[Leg]) -> set[int]:
    """Return what lies between legs and is joined to some of them but not to all."""
    leg_of = {n: k for k, leg in enumerate(legs) for n in leg}
    hubs = set.intersection(*({m for n in leg for m in board.near[n]} for leg in legs))
    found: set[int] = set()
    seen = set(leg_of) | hubs
    for start in range(len(board.kinds)):
        if start in seen:
            continue
        seen.add(start)
        piece, met, outside = [start], set(), False
        for node in piece:
            for m in board.near[node]:
                if m in leg_of:
                    met.add(leg_of[m])
                elif m in hubs:
                    outside = True
                elif m not in seen:
                    seen.add(m)
                    piece.append(m)
        if met and not outside:
            found.update(piece)
    return found


def _turn_about(search: Search) -> None:
    """Mirror or turn the whole picture to the way that suits the compass best."""
    board = search.board
    nodes = range(len(board.kinds))
    here = {n: c for n, c in enumerate(board.at) if c is not None}
    turns = list(board.turns)
    found = []
    for swap in (False, True):
        for a, b in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
            way = {n: (a * y, b * x) if swap else (a * x, b * y) for n, (x, y) in here.items()}
            ways = [t if t > 1 or not swap else 1 - t for t in turns]
            _set(board, way, ways)
            found.append((board.cost(nodes), way, ways))
    _, way, ways = min(found, key=lambda f: f[0])
    _set(board, way, ways)


def _set(board: Streets, cells: Mapping[int, Cell], turns: Sequence[int]) -> None:
    board.move(cells)
    for b, way in enumerate(turns):
        if board.turns[b] != way:
            board.turn(b, way)
