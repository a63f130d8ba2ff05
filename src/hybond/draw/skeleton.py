"""The skeleton of a bond graph: what the eye follows.

Junctions and two-ports with more than one neighbour carry the picture. A tree is drawn along
its *spine*, the longest path, from a source to the far end; a graph with loops around its
longest *ring*.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from itertools import pairwise

from hybond.draw.board import Board
from hybond.model.kinds import SOURCES


def components(near: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the connected components, each sorted, in the order of their first nodes.

    Examples
    --------
    >>> components([[1], [0], []])
    [[0, 1], [2]]
    """
    seen: set[int] = set()
    found = []
    for start in range(len(near)):
        if start in seen:
            continue
        reached = _distances(near, start, None)
        seen |= reached.keys()
        found.append(sorted(reached))
    return found


def spine(board: Board, nodes: Sequence[int]) -> list[int]:
    """Return the longest path of a component's skeleton, in the direction of most of its power.

    In a graph with loops it is the longest of the shortest paths.

    Examples
    --------
    Se - 1 - TF - 1 - R: the one-ports are no part of it.

    >>> board = Board(["R", "1", "TF", "1", "Se"], [(1, 0), (2, 1), (3, 2), (4, 3)])
    >>> spine(board, range(5))
    [3, 2, 1]
    """
    near = board.near
    inner = {n for n in nodes if len(near[n]) > 1}
    if not inner:
        return [min(nodes, key=lambda n: (board.kinds[n] not in ("0", "1"), n))]
    best: list[int] = []
    start = min(inner)
    # Twice the farthest node gives the diameter of a tree; a third time is for loops.
    for _ in range(3):
        path = _farthest(near, start, inner)
        if len(path) > len(best):
            best = path
        start = path[-1]
    bonds = set(board.bonds)
    along = sum((a, b) in bonds for a, b in pairwise(best))
    against = sum((b, a) in bonds for a, b in pairwise(best))
    forward = along - against + 2 * (_drive(board, best[0]) - _drive(board, best[-1]))
    # A tie keeps the order in which the model was written.
    if forward < 0 or (forward == 0 and best[-1] < best[0]):
        best.reverse()
    return best


def _drive(board: Board, end: int) -> int:
    """Return the number of sources that feed a node, less those that it feeds."""
    sources = {m for m in board.near[end] if board.kinds[m] in SOURCES}
    return sum(
        (board.bonds[b][0] in sources) - (board.bonds[b][1] in sources) for b in board.bonds_of[end]
    )


def rings(near: Sequence[Sequence[int]], nodes: Sequence[int], *, effort: int = 4000) -> list[int]:
    """Return the longest ring (cycle) that a bounded search finds, or an empty list.

    Examples
    --------
    >>> rings([[1, 2], [0, 2], [0, 1]], range(3))
    [0, 1, 2]
    """
    core = _core(near, nodes)
    best: list[int] = []
    for start in sorted(core)[:4]:
        budget = effort
        stack: list[tuple[int, int]] = [(start, 0)]
        path = {start: None}
        while stack and budget:
            budget -= 1
            node, turn = stack[-1]
            choices = [m for m in near[node] if m in core]
            if turn == len(choices):
                stack.pop()
                del path[node]
                continue
            stack[-1] = (node, turn + 1)
            step = choices[turn]
            if step == start and len(path) > 2 and len(path) > len(best):
                best = list(path)
            elif step not in path:
                path[step] = None
                stack.append((step, 0))
    return best


def _core(near: Sequence[Sequence[int]], nodes: Sequence[int]) -> set[int]:
    """Return what remains when ends are taken off again and again: the loops and links of them."""
    core = set(nodes)
    loose = deque(n for n in nodes if len(near[n]) < 2)
    while loose:
        node = loose.popleft()
        if node not in core:
            continue
        core.discard(node)
        loose.extend(m for m in near[node] if m in core and sum(k in core for k in near[m]) < 2)
    return core


def _distances(
    near: Sequence[Sequence[int]], start: int, within: set[int] | None
) -> dict[int, int | None]:
    """Return for each node that can be reached the node before it on a shortest path."""
    before: dict[int, int | None] = {start: None}
    queue = deque([start])
    while queue:
        node = queue.popleft()
        for m in near[node]:
            if m not in before and (within is None or m in within):
                before[m] = node
                queue.append(m)
    return before


def _farthest(near: Sequence[Sequence[int]], start: int, within: set[int]) -> list[int]:
    before = _distances(near, start, within)
    path: list[int] = []
    at: int | None = list(before)[-1]  # breadth first: the last one found is farthest
    while at is not None:
        path.append(at)
        at = before[at]
    return path[::-1]
