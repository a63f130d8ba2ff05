"""What failed searches have learned: regions that no alternating path leaves.

A search that fails has seen a region from which no change is possible. Until a bond of that
region changes, a later search need not enter it, and the search itself need not be repeated
(in the matching of general graphs such Hungarian trees may be taken out: J. Edmonds, *Paths,
trees, and flowers*, Canadian Journal of Mathematics 17, 1965). A search that stopped at such a
region *leans* on it. When a region changes, its own search is repeated first, and may then enter
what leans on it, lest two failures prove each other; only if it no longer covers its old region
are those that lean on it repeated too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Log = list[tuple[Any, int, Any]]
"""What to put back where: a list, a position, the value before."""


class Tree:
    """The region of one failed search.

    Parameters
    ----------
    root : int
        What the search was for.
    vertices : list of int
        What it has seen.
    """

    __slots__ = ("alive", "doubted", "leaning", "root", "trimmed", "vertices")

    def __init__(self, root: int, vertices: list[int]) -> None:
        self.root = root
        self.vertices = vertices
        self.alive = [True]
        self.doubted = False
        """Whether it leans on a region that is being searched again."""
        self.leaning: list[Tree] = []
        self.trimmed = 8


class Forest:
    """The failed searches that still hold.

    Parameters
    ----------
    size : int
        The number of vertices.
    log : list
        Where changes are noted, so that they can be taken back.
    """

    def __init__(self, size: int, log: Log) -> None:
        self.tree_of: list[Tree | None] = [None] * size
        self.log = log
        self.felled: list[Tree] = []
        """Regions that have changed and were not searched again yet."""
        self._doubted: list[Tree] = []
        self._grown: list[Tree] = []

    def plant(self, root: int, vertices: list[int], met: list[Tree]) -> Tree:
        """Keep a failed search, which stopped wherever it met one of the trees `met`."""
        tree = Tree(root, vertices)
        tree_of, log = self.tree_of, self.log
        log.append((tree.alive, 0, False))
        entered = []
        for v in vertices:
            old = tree_of[v]
            if old is not None:
                entered.append(old)
            log.append((tree_of, v, old))
            tree_of[v] = tree
        for other in dict.fromkeys(met):
            self._lean(tree, other)
        for other in dict.fromkeys(entered):
            self._lean(other, tree)
        return tree

    def fell(self, tree: Tree) -> None:
        """Forget `tree`, one of whose bonds has changed."""
        if not tree.alive[0]:
            return
        self.log.append((tree.alive, 0, True))
        tree.alive[0] = False
        for v in tree.vertices:
            if self.tree_of[v] is tree:
                self.log.append((self.tree_of, v, tree))
                self.tree_of[v] = None
        self.felled.append(tree)

    def begin_round(self) -> list[Tree]:
        """Return what is to be searched again, and doubt all that leans on it."""
        felled, self.felled = self.felled, []
        todo = list(felled)
        while todo:
            for tree in todo.pop().leaning:
                if tree.alive[0] and not tree.doubted:
                    tree.doubted = True
                    self._doubted.append(tree)
                    todo.append(tree)
        return felled

    def end_round(self, felled: list[Tree], harmless: Callable[[int], bool]) -> None:
        """Keep what leaned on regions that are still dead ends, fell what leaned on others."""
        for tree in self._doubted:
            tree.doubted = False
        self._doubted.clear()
        tree_of = self.tree_of
        for tree in felled:
            leaning = [other for other in tree.leaning if other.alive[0]]
            if not leaning:
                continue
            owners: dict[Tree, None] = {}
            for v in tree.vertices:
                owner = tree_of[v]
                if owner is not None:
                    owners[owner] = None
                elif not harmless(v):
                    for other in leaning:
                        self.fell(other)
                    break
            else:
                for owner in owners:
                    for other in leaning:
                        if other is not owner:
                            self._lean(other, owner)

    def trim(self) -> None:
        """Drop dead trees from the lists of leaning ones; only when nothing can be undone."""
        for tree in self._grown:
            tree.leaning = [t for t in dict.fromkeys(tree.leaning) if t.alive[0]]
            tree.trimmed = max(8, len(tree.leaning))
        self._grown.clear()

    def _lean(self, tree: Tree, on: Tree) -> None:
        on.leaning.append(tree)
        if len(on.leaning) == 2 * on.trimmed + 1:
            self._grown.append(on)
