"""Equal parts of a picture as copies of one in a row: a line to begin with, then the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from hybond.draw.beginning import nearest, start_board
from hybond.draw.board import Board, Cell
from hybond.draw.legs import Leg

B = TypeVar("B", bound=Board)


def between_hubs(
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


def multiplied(
    kind: type[B],
    kinds: Sequence[str],
    bonds: Sequence[tuple[int, int]],
    cells: Mapping[int, Cell],
    legs: Sequence[Leg],
    axis: int,
) -> B:
    """Return a board with the other legs beside the first, along `axis`, and room for them."""
    first = [cells[n] for n in legs[0]]
    low, high = min(c[axis] for c in first), max(c[axis] for c in first)
    pitch = high - low + (2 if len(cells) + len(first) * (len(legs) - 1) < len(kinds) else 1)
    more = pitch * (len(legs) - 1)
    board = kind(kinds, bonds)

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
        assert whole is not None
        for n, place in enumerate(whole.at):
            if n not in known and place is not None:
                board.put(n, place)
    board.best_turns(range(len(bonds)))
    return board


def links_between(board: Board, legs: Sequence[Leg]) -> set[int]:
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
