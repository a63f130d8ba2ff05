"""Alternating paths: how a choice of strokes is repaired or improved by flipping a path.

Flipping the stroke of one bond leaves a junction with two causes or none; flipping another of
its bonds mends it and moves the fault on. The path ends at a leaf that may change (a resistor,
a storage that gains) or at another fault. Without gyrators on odd cycles the graph is bipartite
and a plain breadth-first search finds such a path if there is one; odd cycles are contracted as
blossoms (J. Edmonds, *Paths, trees, and flowers*, Canadian Journal of Mathematics 17, 1965), so
the answer is exact for every graph.

The sets of leaves that can be matched together are the feasible sets of a delta-matroid
(A. Bouchet, *Greedy algorithm and symmetric matroids*, Mathematical Programming 38, 1987).
Hence taking storages one by one, each in integral causality if that is feasible with those
before it, ends with as many as possible; and if no path leads from a storage in derivative
causality to a resistor or another such storage, there is no better choice anywhere.
"""

from __future__ import annotations

from hybond.causality.arrays import MIDDLE, Arrays
from hybond.causality.forest import Forest, Log, Tree

EXPOSED = -1
"""The mate of a vertex that has no cause."""
SETTLED = -2
"""The mate of a vertex that needs none: it is OFF, or something fixed is its cause."""


class Matching:
    """Strokes, and what is the cause of what.

    Parameters
    ----------
    arrays : Arrays
        The compiled graph.

    Notes
    -----
    `stroke` per bond; `free` whether nothing fixes it; `mate` per vertex the vertex it is
    matched to, over the bond `via`; `shut` the leaves (and optional vertices) that a search must
    not change: those that would lose by it.
    """

    def __init__(self, arrays: Arrays) -> None:
        size = arrays.nodes + arrays.bonds
        self.arrays = arrays
        self.stroke = [0] * arrays.bonds
        self.free = [True] * arrays.bonds
        self.mate = [EXPOSED] * size
        self.via = [-1] * size
        self.shut = [False] * size
        self.optional = bytearray(arrays.optional)
        self.log: Log = []
        self.before: dict[int, int] = {}
        """Bonds whose stroke was set since the log began, with the stroke they had."""
        self.touched: list[int] = []
        """Bonds whose stroke was set since somebody last looked."""
        self._label = [0] * size
        self._stamp = 0
        self._up = [-1] * size
        self._up_by = [-1] * size
        self._base: dict[int, int] = {}
        self.seen: list[int] = []
        """The vertices that the last search has seen."""
        self.met: list[Tree] = []
        """The regions of failed searches at which it stopped."""

    def put(self, bond: int, stroke: int) -> None:
        """Set the stroke of a bond."""
        if self.stroke[bond] != stroke:
            self.before.setdefault(bond, self.stroke[bond])
            self.stroke[bond] = stroke
            self.touched.append(bond)

    def join(self, v: int, w: int, bond: int) -> None:
        """Match `v` with `w` over `bond`."""
        arrays, mate, via, log = self.arrays, self.mate, self.via, self.log
        for a, b in ((v, w), (w, v)):
            log.append((mate, a, mate[a]))
            log.append((via, a, via[a]))
            mate[a] = b
            via[a] = bond
        self.put(bond, arrays.cause_stroke(bond, v if v < arrays.nodes else w))

    def part(self, v: int) -> int:
        """Leave `v` and its mate without each other; return the mate."""
        mate = self.mate
        w = mate[v]
        self.log.append((mate, v, w))
        self.log.append((mate, w, v))
        mate[v] = mate[w] = EXPOSED
        self.drop(self.via[v])
        return w

    def set_mate(self, v: int, value: int) -> None:
        """Set the mate of `v` to `EXPOSED` or `SETTLED`."""
        self.log.append((self.mate, v, self.mate[v]))
        self.mate[v] = value

    def drop(self, bond: int) -> None:
        """Let `bond` be no cause of either end; a middle keeps its stroke until it is matched."""
        arrays = self.arrays
        if arrays.form[bond] != MIDDLE:
            cause = arrays.at_tail[bond]
            self.put(bond, 1 - (cause if cause >= 0 else arrays.at_head[bond]))

    # -- paths

    def cover(self, root: int, forest: Forest, *, at_any_price: bool) -> bool:
        """Match the exposed vertex `root` by flipping a path, if there is one.

        Parameters
        ----------
        root : int
            A junction or middle without a cause, or a leaf that wants to be matched.
        forest : Forest
            Where not to look.
        at_any_price : bool
            Whether the path may end, for want of a better end, at a leaf that is shut.
        """
        end = self._search(root, forest, at_any_price)
        if end == EXPOSED:
            return False
        self._flip(end)
        return True

    def uncover(self, leaf: int, forest: Forest) -> bool:
        """Take the matched `leaf` out of the matching by flipping a path, if there is one."""
        v = self.mate[leaf]
        bond = self.via[leaf]
        self.part(leaf)
        end = self._search(v, forest, False, without=leaf)
        if end == EXPOSED:
            self.seen.append(leaf)
            self.join(v, leaf, bond)
            return False
        self._flip(end)
        return True

    def look(self, leaf: int) -> int:
        """Return the end of a path that would change `leaf`, or `EXPOSED`; flip nothing."""
        if self.mate[leaf] == EXPOSED:
            return self._search(leaf, None, False)
        v, bond = self.mate[leaf], self.via[leaf]
        self.part(leaf)
        end = self._search(v, None, False, without=leaf)
        self.join(v, leaf, bond)
        return end

    def _search(
        self, root: int, forest: Forest | None, at_any_price: bool, *, without: int = -1
    ) -> int:
        """Return the end of an alternating path from the exposed vertex `root`, or `EXPOSED`.

        An *outer* vertex is one that the path would leave without a mate; an *inner* one would
        get a second mate, so that it gives up its first, which becomes outer.
        """
        near, mate, free = self.arrays.near, self.mate, self.free
        label, up, up_by = self._label, self._up, self._up_by
        optional, shut = self.optional, self.shut
        tree_of = forest.tree_of if forest else None
        self._stamp += 2
        outer = self._stamp
        inner = outer + 1
        self._base.clear()
        met: list[Tree] = []
        inners: list[int] = []
        self.seen = queue = [root]
        label[root] = outer
        if without >= 0:
            label[without] = inner
        spare = EXPOSED
        for u in queue:
            for bond, w in near[u]:
                if not free[bond]:
                    continue
                seen = label[w]
                if seen == inner:
                    continue
                if seen == outer:
                    known = len(queue)
                    self._contract(u, w, bond, queue)
                    for v in queue[known:]:
                        if optional[v] and not shut[v]:
                            return v
                    continue
                m = mate[w]
                if m == SETTLED:
                    continue
                if tree_of is not None and (tree := tree_of[w]) is not None and not tree.doubted:
                    met.append(tree)
                    continue
                label[w] = inner
                up[w] = u
                up_by[w] = bond
                inners.append(w)
                if m == EXPOSED:
                    if not shut[w]:
                        return w
                    if spare == EXPOSED:
                        spare = w
                    continue
                label[m] = outer
                queue.append(m)
                if optional[m]:
                    if not shut[m]:
                        return m
                    if spare == EXPOSED:
                        spare = m
        # A bond that led nowhere may lead on once its end changes, so what is only looked at
        # counts as seen too; ends that are settled wake their neighbours instead.
        self.seen = queue + inners
        self.met = met
        return spare if at_any_price else EXPOSED

    def _flip(self, end: int) -> None:
        """Flip the path from its end to its root."""
        mate = self.mate
        v = end
        if mate[end] != EXPOSED:
            # An optional vertex that gives up its mate: the path goes on from that mate.
            v = self.part(end)
        up, up_by = self._up, self._up_by
        while v != EXPOSED:
            u = up[v]
            bond = up_by[v]
            following = mate[u]
            if following != EXPOSED:
                self.drop(self.via[u])
                self.log.append((mate, following, u))
                mate[following] = EXPOSED
            self.join(v, u, bond)
            v = following

    def _contract(self, x: int, y: int, bond: int, queue: list[int]) -> None:
        """Contract the odd cycle that the bond between two outer vertices closes."""
        if self._find(x) == self._find(y):
            return
        base = self._common_base(x, y)
        outer = self._stamp
        label, up, up_by, mate = self._label, self._up, self._up_by, self.mate
        for start, other in ((x, y), (y, x)):
            u, w, by = start, other, bond
            while self._find(u) != base:
                up[u] = w
                up_by[u] = by
                w = mate[u]
                if label[w] != outer:
                    label[w] = outer
                    queue.append(w)
                for v in (u, w):
                    if self._find(v) == v:
                        self._base[v] = base
                by = up_by[w]
                u = up[w]

    def _find(self, v: int) -> int:
        base = self._base
        root = v
        while (above := base.get(root, root)) != root:
            root = above
        while v != root:
            base[v], v = root, base.get(v, v)
        return root

    def _common_base(self, x: int, y: int) -> int:
        """Return the first base that the ways from `x` and `y` to the root share."""
        passed = set()
        while True:
            if x != EXPOSED:
                x = self._find(x)
                if x in passed:
                    return x
                passed.add(x)
                x = self.mate[x]
                if x != EXPOSED:
                    x = self._up[x]
            x, y = y, x
