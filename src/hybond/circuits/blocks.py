"""The blocks of a circuit: parts of which no two share more than one node.

Between two blocks flows no current: what enters one through the shared node leaves it there. So
each block has a bond graph of its own, with that node, seen from ground, as its reference. A block
of one branch is a branch that no current can pass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BranchBlock:
    """Branches, by index, and the node through which they hang on the rest."""

    reference: int
    edges: tuple[int, ...]


def blocks(
    count: int, edges: Sequence[tuple[int, int]], ground: int
) -> tuple[list[BranchBlock], set[int]]:
    """Return the blocks of a multigraph, and the nodes that ground does not reach.

    Parameters
    ----------
    count : int
        Nodes are ``0 .. count - 1``.
    edges : sequence of (int, int)
        No loops.

    Returns
    -------
    blocks : list of BranchBlock
        By Hopcroft and Tarjan, with a stack of its own: a circuit may be a long ladder.
    apart : set of int

    Examples
    --------
    A triangle with a branch that leads nowhere:

    >>> found, apart = blocks(5, [(0, 1), (1, 2), (2, 0), (2, 3)], 0)
    >>> [(b.reference, b.edges) for b in found], apart
    ([(2, (3,)), (0, (0, 1, 2))], {4})
    """
    at: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for k, (a, b) in enumerate(edges):
        at[a].append((b, k))
        at[b].append((a, k))
    order = [-1] * count
    low = [0] * count
    found: list[BranchBlock] = []
    open_edges: list[int] = []
    pushed = [0] * len(edges)
    order[ground] = low[ground] = 0
    seen = 1
    stack = [(ground, -1, iter(at[ground]))]
    while stack:
        node, came, following = stack[-1]
        step = next(following, None)
        if step is None:
            stack.pop()
            if not stack:
                break
            parent = stack[-1][0]
            low[parent] = min(low[parent], low[node])
            if low[node] >= order[parent]:
                cut = pushed[came]
                found.append(BranchBlock(parent, tuple(sorted(open_edges[cut:]))))
                del open_edges[cut:]
            continue
        other, edge = step
        if edge == came:
            continue
        if order[other] < 0:
            order[other] = low[other] = seen
            seen += 1
            pushed[edge] = len(open_edges)
            open_edges.append(edge)
            stack.append((other, edge, iter(at[other])))
        elif order[other] < order[node]:
            open_edges.append(edge)
            low[node] = min(low[node], order[other])
    return found, {n for n in range(count) if order[n] < 0}
