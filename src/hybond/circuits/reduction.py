"""Series and parallel structure of one block: what a bond graph shows as 1- and 0-junctions.

A node with two branches makes a series of them, and branches between the same two nodes stand in
parallel; this is repeated until neither is left. What remains, the core, has nodes of three or more
branches; of most circuits nothing but one node remains.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(eq=False, slots=True)
class Tree:
    """A branch, or a series or parallel connection of trees, from node `a` to node `b`."""

    kind: str
    """``"leaf"``, ``"series"`` or ``"parallel"``."""
    a: int
    b: int
    branch: int = -1
    """Of a leaf."""
    parts: list[tuple[Tree, bool]] = field(default_factory=list)
    """Of a connection: each part, and whether it leads the same way as the whole."""


@dataclass(frozen=True, slots=True)
class Core:
    """What remains of a block."""

    trees: list[Tree]
    """Between the nodes of the core."""
    nodes: list[int]
    """Nodes other than the reference that have trees; none if the block is one loop or has one node
    beside the reference."""
    whole: Tree | None
    """The block itself if it is a single connection: all parts of a ``"parallel"`` have the same
    voltage, or all of a ``"series"`` are one loop."""


def reduce_block(
    edges: Mapping[int, tuple[int, int]], reference: int, order: Sequence[int]
) -> Core:
    """Return the series and parallel structure of a block of two or more branches.

    Parameters
    ----------
    edges : mapping
        Branch to its two nodes.
    reference : int
        The node that stays.
    order : sequence of int
        The nodes, in the order in which they are looked at.
    """
    return _Reduction(edges, reference).run(order)


class _Reduction:
    def __init__(self, edges: Mapping[int, tuple[int, int]], reference: int) -> None:
        self.reference = reference
        self.at: dict[int, dict[int, Tree]] = {}
        """Of each node, its trees by their other node: parallel ones are joined at once."""
        for branch, (a, b) in edges.items():
            self.add(Tree("leaf", a, b, branch))

    def add(self, tree: Tree) -> None:
        there = self.at.setdefault(tree.a, {})
        self.at.setdefault(tree.b, {})
        known = there.get(tree.b)
        if known is not None:
            tree, _ = _joined("parallel", known, tree, same=known.a == tree.a)
        self.at[tree.a][tree.b] = self.at[tree.b][tree.a] = tree

    def run(self, order: Sequence[int]) -> Core:
        waiting = deque(n for n in order if n != self.reference)
        queued = set(waiting)
        while waiting:
            node = waiting.popleft()
            queued.discard(node)
            if len(self.at.get(node, ())) != 2:
                continue
            (p, first), (q, second) = self.at.pop(node).items()
            del self.at[p][node], self.at[q][node]
            inward, outward = first.b == node, second.a == node
            whole, of_first = _joined("series", first, second, same=inward == outward)
            ahead = inward if of_first else outward
            whole.a, whole.b = (p, q) if ahead else (q, p)
            self.add(whole)
            for n in (p, q):
                if n != self.reference and n not in queued:
                    waiting.append(n)
                    queued.add(n)
        trees = list(dict.fromkeys(tree for n in order for tree in self.at.get(n, {}).values()))
        if len(trees) == 1:
            return Core([], [], _one_loop(trees[0]))
        return Core(trees, [n for n in order if n in self.at and n != self.reference], None)


def _joined(kind: str, first: Tree, second: Tree, *, same: bool) -> tuple[Tree, bool]:
    """Return two trees as one, and whether it leads the way of the first.

    The parts of the smaller connection move into the larger one, so that each part moves rarely.
    """
    if first.kind == kind and (second.kind != kind or len(second.parts) <= len(first.parts)):
        base, other, of_first = first, second, True
    elif second.kind == kind:
        base, other, of_first = second, first, False
    else:
        return Tree(kind, first.a, first.b, parts=[(first, True), (second, same)]), True
    if other.kind == kind:
        base.parts += [(tree, ahead == same) for tree, ahead in other.parts]
    else:
        base.parts.append((other, same))
    return base, of_first


def _one_loop(tree: Tree) -> Tree:
    """Return a block that is one connection; two parts in parallel are a loop if they may be."""
    if tree.kind != "parallel" or len(tree.parts) != 2:
        return tree
    (first, ahead), (second, along) = tree.parts
    if "series" not in (first.kind, second.kind):
        return tree
    # around the loop the second part is passed from its end to its beginning
    whole, _ = _joined("series", first, second, same=ahead != along)
    return whole
