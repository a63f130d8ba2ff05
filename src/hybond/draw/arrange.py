"""Where the nodes of a picture stand, and where its bonds bend if they may.

Power flows from left to right along a horizontal spine; one-ports hang north and south of it; loops
are rectangles; equal parts are copies of one in a row. First a graph with one part of each kind is
placed (`beginning`), then the others are put beside it (`copies`), then all is improved together
(`search`), by what a `Board` says it costs. Bonds of drawings may bend, on `Streets`; in the studio
and in schematics, which do not ask for bends, they are straight, on a `Board`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

from hybond.draw.beginning import first_rows, nearest, on_pages, start_board
from hybond.draw.board import LEVEL_FIRST, STRAIGHT_AWAY, Board, Cell
from hybond.draw.copies import between_hubs, links_between, multiplied
from hybond.draw.fans import fanned
from hybond.draw.geometry import Point
from hybond.draw.legs import Leg, legs_of
from hybond.draw.search import Search
from hybond.draw.skeleton import components
from hybond.draw.streets import Streets
from hybond.draw.ways import Way, clear_ways
from hybond.errors import UsageError
from hybond.model.kinds import SOURCES

_THOROUGH = 110
"""Number of nodes up to which the search is thorough."""
_LARGE = 320
"""Beyond, only the first placement is made."""
_BRIEF = 25
"""Number of nodes from which searches with bonds that may bend are brief, and only the best of
them is gone on with."""
_SHORTER, _LEGS = 0.6, 4
"""Moves of a brief search beside those of others; it has fewer where legs move together, if there
are more than so many nodes for each that moves alone."""
_TRIES = 6
_PINNED_TRIES = {Board: 3, Streets: 6}
"""Searches for a picture without a flaw; fewer where one is asked for at each edit."""
_EFFORT = {Board: 400, Streets: 150}
"""Moves tried for each node: with straight bonds few of them are worth it."""
_VAIN = 3
"""Searches in a row that find nothing better."""
_STEPS = 9000
LONGEST, MOST_CELLS = 2000, 100_000
"""Columns or rows, and places, between parts that are bonded; a board remembers each place."""
_WEST, _BACK = 60.0, 6.0
"""What it costs that all sources are at the right end of a picture, and each bond between inner
nodes by which power goes to the left."""
_SLANT = 0.12
"""Cells by which a bond may slant unseen."""

B = TypeVar("B", bound=Board)
Pair = tuple[int, int]


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


def layout(
    kinds: Sequence[str],
    bonds: Sequence[Pair],
    *,
    pinned: Mapping[int, Point] | None = None,
    seed: int = 1,
) -> tuple[Point, ...]:
    """Return where nodes stand whose bonds are straight.

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
    return _placed(Board, kinds, _single(bonds), pinned or {}, seed)[0]


def arrange(
    kinds: Sequence[str],
    bonds: Sequence[Pair],
    *,
    pinned: Mapping[int, Point] | None = None,
    seed: int = 1,
) -> Arrangement:
    """Return where the nodes of a drawing stand and how its bonds run.

    Parameters
    ----------
    kinds, bonds, pinned, seed
        As for `layout`. Bonds between two pinned nodes are straight where nothing is in their way.

    Examples
    --------
    >>> found = arrange(["Se", "1", "I", "R"], [(0, 1), (1, 2), (1, 3)])
    >>> found.positions, found.bends
    (((0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (1.0, 2.0)), ((), (), ()))
    """
    pins = pinned or {}
    single = _single(bonds)
    positions, turns = _placed(Streets, kinds, single, pins, seed)
    positions, straight = fanned(positions, single, pins)
    ways: list[Way] = []
    for k, (a, b) in enumerate(single):
        way = STRAIGHT_AWAY if k in straight or (a in pins and b in pins) else turns[a, b]
        ways.append(_way(positions[a], positions[b], way))
    known = dict(zip(single, clear_ways(positions, single, ways), strict=True))
    bends = [
        known[a, b][1:-1] if (a, b) in known else known[b, a][-2:0:-1] if a != b else ()
        for a, b in bonds
    ]
    return Arrangement(positions, tuple(bends))


def _single(bonds: Sequence[Pair]) -> list[Pair]:
    """Return the pairs of nodes with a bond between them, each once."""
    pairs: dict[Pair, None] = {}
    for a, b in bonds:
        if a != b and (b, a) not in pairs:
            pairs[a, b] = None
    return list(pairs)


def _placed(
    kind: type[Board],
    kinds: Sequence[str],
    bonds: Sequence[Pair],
    pinned: Mapping[int, Point],
    seed: int,
) -> tuple[tuple[Point, ...], dict[Pair, int]]:
    """Return where nodes stand on a kind of board, component after component, and bonds turn."""
    pins = {n: (float(x), float(y)) for n, (x, y) in pinned.items()}
    placed: dict[int, Point] = dict(pins)
    floating: list[dict[int, Cell]] = []
    turns: dict[Pair, int] = {}
    for nodes in components(Board(kinds, bonds).near):
        local = {n: k for k, n in enumerate(nodes)}
        own = [(a, b) for a, b in bonds if a in local]
        fixed: dict[int, Cell] = {}
        for n in nodes:
            if n in pins:
                # Two pins may round to one cell: the second takes the nearest free one.
                fixed[local[n]] = nearest(_cell(pins[n]), set(fixed.values()))
        inside = [(local[a], local[b]) for a, b in own]
        _check_room(fixed.values())
        board = arranged(kind, [kinds[n] for n in nodes], inside, fixed, seed=seed)
        turns.update(zip(own, board.turns, strict=True))
        cells = {n: cell for n, cell in zip(nodes, board.at, strict=True) if cell is not None}
        if fixed:
            placed.update({n: (float(x), float(y)) for n, (x, y) in cells.items() if n not in pins})
        else:
            floating.append(cells)
    on_pages(floating, placed)
    return tuple(placed[n] for n in range(len(kinds))), turns


def _check_room(cells: Iterable[Cell]) -> None:
    """Refuse places between which there is more room than a board has: HB-D112."""
    at = list(cells)
    wide, high = (max(a) - min(a) + 1 for a in zip(*at, strict=True)) if at else (1, 1)
    if max(wide, high) > LONGEST or wide * high > MOST_CELLS:
        raise UsageError(
            f"parts that are bonded stand {wide} columns and {high} rows apart",
            code="HB-D112",
            where="layout",
            hint="bring them together: neighbours stand 1 apart",
        )


def _cell(at: Point) -> Cell:
    if not (math.isfinite(at[0]) and math.isfinite(at[1])):
        raise UsageError(
            f"a part stands at {at[0]}, {at[1]}",
            code="HB-D112",
            where="layout",
            hint="give columns and rows: neighbours stand 1 apart",
        )
    return round(at[0]), round(at[1])


def _way(a: Point, b: Point, turn: int) -> Way:
    if turn == STRAIGHT_AWAY or min(abs(a[0] - b[0]), abs(a[1] - b[1])) < _SLANT:
        return (a, b)
    return (a, (b[0], a[1]) if turn == LEVEL_FIRST else (a[0], b[1]), b)


def arranged(
    kind: type[B],
    kinds: Sequence[str],
    bonds: Sequence[Pair],
    fixed: Mapping[int, Cell],
    *,
    seed: int,
) -> B:
    """Return the board of a connected graph, without bonds between one pair of nodes twice.

    Examples
    --------
    >>> board = arranged(Streets, ["Se", "1", "I", "R"], [(0, 1), (1, 2), (1, 3)], {}, seed=1)
    >>> board.defects(), board.at[1][0] - board.at[0][0]
    (0, 1)
    """
    size = len(kinds)
    groups = legs_of(kinds, bonds) if not fixed and size <= _LARGE else []
    small, brief = size <= _THOROUGH, size >= _BRIEF and kind is not Board
    alone = size - sum(len(leg) for group in groups for leg in group[1:])
    steps = min(_EFFORT[kind] * alone, _STEPS) if small else min(_STEPS, 400000 // size)
    if brief:
        steps = int(_SHORTER * steps * min(1.0, _LEGS * alone / size))
    near = Board(kinds, bonds).near
    crowded = sum(max(0, len(n) - 4) for n in near)  # bonds that have no side of their own
    best: tuple[int, Search[B]] | None = None
    found = 0
    most = _PINNED_TRIES[kind] if fixed else _TRIES
    tries = max(2, min(most, most * 40 // size)) if small else 1
    for attempt in range(tries):
        board = _begun(kind, kinds, bonds, fixed, groups, seed, attempt, brief)
        search = Search(board, set(fixed), groups, brief)
        if size <= _LARGE:
            search.anneal(steps, seed=seed + attempt, hot=160 if attempt else 40)
            if small and not brief:
                _settle(search)
            else:
                search.descend(rounds=2, reach=1)
        cost = board.cost(range(size))
        if best is None or cost < best[0]:
            best, found = (cost, search), attempt
        if board.defects() <= crowded or attempt - found >= _VAIN:
            break
    assert best is not None
    search = best[1]
    board = search.board
    if small and brief:
        _settle(search)
    if not fixed:
        _turn_about(board, _drawn_back)
    return board


def _settle(search: Search[B]) -> None:
    """Improve a picture until nothing more is found, and the way that it is turned."""
    search.descend(rounds=6, reach=2)
    if not search.fixed and (_turn_about(search.board) or not search.brief):
        search.descend(rounds=2, reach=1)


def _begun(
    kind: type[B],
    kinds: Sequence[str],
    bonds: Sequence[Pair],
    fixed: Mapping[int, Cell],
    groups: Sequence[Sequence[Leg]],
    seed: int,
    attempt: int,
    brief: bool,
    row: Mapping[int, Cell] | None = None,
) -> B:
    """Return a board with every node placed, legs in a row; `row` is where some begin."""
    if not groups:
        board = kind(kinds, bonds)
        given = [tuple((row or {}).items()), tuple(fixed.items())]
        starts = _starts(tuple(kinds), tuple(bonds), *given)
        for n, cell in enumerate(starts[attempt % len(starts)]):
            if cell is not None:
                board.put(n, cell)
        return board
    upright = attempt % 2 == 0
    if row is None and attempt % 3 < 2:
        row = between_hubs(Board(kinds, bonds), groups, upright=upright)
    legs = groups[0]
    links = links_between(Board(kinds, bonds), legs)
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
    small = _begun(kind, own_kinds, own, {}, fewer, seed, attempt, brief, inner)
    search = Search(small, set(), fewer, brief)
    # what is begun well is only put right, or it is lost again
    steps = int(min(100 * len(kept), 3000) * (_SHORTER if brief else 1.0))
    search.anneal(steps, seed=seed + attempt, hot=15 if row else 160)
    search.descend(rounds=2, reach=1)
    cells = {n: cell for n, k in number.items() if (cell := small.at[k]) is not None}
    if row:
        return multiplied(kind, kinds, bonds, cells, legs, 0 if upright else 1)
    boards = [multiplied(kind, kinds, bonds, cells, legs, axis) for axis in (0, 1)]
    boards.sort(key=lambda b: b.cost(range(len(kinds))))
    return boards[attempt % 2]


@lru_cache(maxsize=4)
def _starts(
    kinds: tuple[str, ...],
    bonds: tuple[Pair, ...],
    row: tuple[tuple[int, Cell], ...],
    fixed: tuple[tuple[int, Cell], ...],
) -> list[tuple[Cell | None, ...]]:
    """Return where nodes may stand at first, what costs least first: the same for all attempts."""
    pins = dict(fixed)
    rows = [dict(row)] if row else first_rows(Board(kinds, bonds), pins)
    found: list[tuple[int, Board]] = []
    most = math.inf
    for cells in rows:
        board = start_board(kinds, bonds, pins, cells, most)
        if board is not None:
            found.append((board.cost(range(len(kinds))), board))
            found.sort(key=lambda f: f[0])
            if len(kinds) > _THOROUGH:  # only the first is asked for
                most = found[0][0]
    return [tuple(board.at) for _, board in found]


def _turn_about(
    board: Board, besides: Callable[[Board, Mapping[int, Cell]], float] | None = None
) -> bool:
    """Mirror or turn the whole picture to the way that suits the compass best; whether it is so.

    `besides` is what a way costs beside that; it is asked when all is placed.
    """
    nodes = range(len(board.kinds))
    here = {n: c for n, c in enumerate(board.at) if c is not None}
    turns = list(board.turns)
    found = []
    for swap in (False, True):
        for a, b in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
            way = {n: (a * y, b * x) if swap else (a * x, b * y) for n, (x, y) in here.items()}
            ways = [t if t > 1 or not swap else 1 - t for t in turns]
            _set(board, way, ways)
            more = besides(board, way) if besides is not None else 0.0
            found.append((board.cost(nodes) + more, way, ways))
    _, way, ways = min(found, key=lambda f: f[0])
    _set(board, way, ways)
    return way != here


def _drawn_back(board: Board, cells: Mapping[int, Cell]) -> float:
    """Return what it costs that power comes from the right."""
    inner = [(a, b) for a, b in board.bonds if len(board.near[a]) > 1 < len(board.near[b])]
    back = _BACK * sum(cells[b][0] < cells[a][0] for a, b in inner)
    feeds = [
        n
        for n, kind in enumerate(board.kinds)
        if kind in SOURCES and all(board.bonds[b][0] == n for b in board.bonds_of[n])
    ]
    if not feeds:
        return back
    xs = [x for x, _ in cells.values()]
    low, wide = min(xs), max(xs) - min(xs)
    return back + _WEST * sum(cells[n][0] - low for n in feeds) / (len(feeds) * (wide or 1))


def _set(board: Board, cells: Mapping[int, Cell], turns: Sequence[int]) -> None:
    board.move(cells)
    for b, way in enumerate(turns):
        if board.turns[b] != way:
            board.turn(b, way)
