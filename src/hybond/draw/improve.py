"""Improve a placement: moves and swaps on the grid under a falling threshold."""

from __future__ import annotations

import random
from collections.abc import Mapping

from hybond.draw.board import Board, Cell


def improve(
    board: Board, fixed: Mapping[int, Cell], *, steps: int, seed: int, hot: int = 40
) -> None:
    """Move the nodes of `board` to cheaper places; those in `fixed` stay.

    Parameters
    ----------
    board : Board
        Every node placed; changed in place.
    fixed : mapping
        Nodes that stay.
    steps : int
        Number of moves tried while hot; a descent until nothing improves follows.
    seed : int
        Seed of the choice of moves.
    hot : int
        First threshold, in units of `board` costs: 40 allows a diagonal or a long bond, 160 a
        crossing on the way.

    Examples
    --------
    >>> board = Board(["Se", "1", "I"], [(0, 1), (1, 2)])
    >>> for node, cell in enumerate([(5, 5), (1, 0), (0, 3)]):
    ...     board.put(node, cell)
    >>> improve(board, {1: (1, 0)}, steps=200, seed=1)
    >>> board.at
    [(0, 0), (1, 0), (1, -1)]
    """
    free = [n for n in range(len(board.kinds)) if n not in fixed]
    if not free:
        return
    rng = random.Random(seed)
    groups = _groups(board, fixed)
    best, record, score = list(board.at), 0, 0
    for step in range(steps):
        threshold = hot * (1.0 - step / steps) ** 2
        node = free[int(rng.random() * len(free))]
        anchor = (
            board.near[node][int(rng.random() * len(board.near[node]))]
            if (board.near[node])
            else node
        )
        cell = board.at[anchor]
        assert cell is not None
        reach = 1 if rng.random() < 0.6 else 3
        wish = (
            cell[0] + int(rng.random() * (2 * reach + 1)) - reach,
            cell[1] + int(rng.random() * (2 * reach + 1)) - reach,
        )
        whole = groups[node] if rng.random() < 0.5 else (node,)
        moves = _moves(board, fixed, node, wish, whole)
        score += _attempt(board, moves, threshold * rng.random())
        if score < record:
            best, record = list(board.at), score
    if score > record:
        board.move({n: c for n, c in enumerate(best) if c is not None})
    _descend(board, fixed, free, groups)


def _groups(board: Board, fixed: Mapping[int, Cell]) -> list[tuple[int, ...]]:
    """Return for each node what moves along with it: its one-ports."""
    return [
        (n, *(m for m in near if len(board.near[m]) == 1 and m not in fixed))
        if len(near) > 1
        else (n,)
        for n, near in enumerate(board.near)
    ]


def _moves(
    board: Board, fixed: Mapping[int, Cell], node: int, wish: Cell, whole: tuple[int, ...]
) -> dict[int, Cell]:
    """Return the moves that bring `node` to `wish` with `whole`; nothing if there is no way.

    Who stands there already changes places with the mover.
    """
    here = board.at[node]
    assert here is not None
    if wish == here:
        return {}
    dx, dy = wish[0] - here[0], wish[1] - here[1]
    moves: dict[int, Cell] = {}
    left = {c for n in whole if (c := board.at[n]) is not None}
    for n in whole:
        at = board.at[n]
        assert at is not None
        moves[n] = (at[0] + dx, at[1] + dy)
    vacant = sorted(left - set(moves.values()))
    # Each mover that pushes another out leaves room for it: its own old cell where that is
    # free, so that two junctions with their one-ports swap one for one.
    for n in whole:
        other = board.who.get(moves[n])
        if other is None or other in moves:
            continue
        old = board.at[n]
        if other in fixed or not vacant or old is None:
            return {}
        back = old if old in vacant else vacant[0]
        vacant.remove(back)
        moves[other] = back
    return moves


def _attempt(board: Board, moves: Mapping[int, Cell], threshold: float) -> int:
    """Make the moves unless they cost more than `threshold`; return the change of the cost."""
    if not moves:
        return 0
    old = {n: c for n in moves if (c := board.at[n]) is not None}
    before = board.cost(moves)
    if board.least(moves) > before + threshold:
        return 0
    board.move(moves)
    change = board.cost(moves) - before
    if change > threshold:
        board.move(old)
        return 0
    return change


def _descend(
    board: Board, fixed: Mapping[int, Cell], free: list[int], groups: list[tuple[int, ...]]
) -> None:
    """Try all near cells for all nodes until nothing improves, a few rounds at most."""
    if len(free) > 320:  # seconds, for little: big models are drawn by part
        return
    reach = 2 if len(free) <= 80 else 1
    for _ in range(6 if len(free) <= 80 else 2):
        gain = 0
        for node in free:
            for whole in dict.fromkeys((groups[node], (node,))):
                here = board.at[node]
                assert here is not None
                for dx in range(-reach, reach + 1):
                    for dy in range(-reach, reach + 1):
                        wish = (here[0] + dx, here[1] + dy)
                        gain += _attempt(board, _moves(board, fixed, node, wish, whole), -1)
        if not gain:
            return
