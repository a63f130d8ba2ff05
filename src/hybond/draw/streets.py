"""The board of a drawing: nodes on an integer grid, bonds level or upright with at most one bend.

As on a `Board` all costs are integers, so that sums do not depend on their order. A bond between
two nodes that are not in line has a *turn*: where it bends, or that it runs askew to the next cell,
which is left to nodes with more bonds than sides.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

from hybond.draw.board import (
    BACKWARDS,
    BENT,
    LEVEL_FIRST,
    LONGER,
    STRAIGHT_AWAY,
    UNIT,
    UPRIGHT_FIRST,
    VERTICAL,
    Board,
    Cell,
)

ON_NODE = 260
CROSS = 200
SAME_WAY = 90
"""Each step that two bonds share."""
BEND = 40
ASKEW = 60

_ROW = 12
"""Bits of a cell's number that are its row: `x * 2**12 + y`. A step's is that of its cell, twice
doubled, and its kind: 0 level, 1 upright, 2 and 3 askew."""

Numbers = tuple[int, ...]


class Streets(Board):
    """Positions of nodes and turns of bonds, with costs that can be asked for a few nodes.

    Parameters
    ----------
    kinds : sequence of str
        The kind of each node, a key of `hybond.model.kinds.KINDS`.
    bonds : sequence of (tail, head)
        Node numbers, no two of them the same pair.

    Examples
    --------
    >>> board = Streets(["Se", "1", "I"], [(0, 1), (1, 2)])
    >>> for node, cell in enumerate([(0, 0), (1, 0), (2, 1)]):
    ...     board.put(node, cell)
    >>> board.defects(), board.corner(1)
    (0, (2, 0))
    """

    def __init__(self, kinds: Sequence[str], bonds: Sequence[tuple[int, int]]) -> None:
        super().__init__(kinds, bonds)
        self.turns = [LEVEL_FIRST] * len(bonds)
        self._taken: set[int] = set()  # cells of nodes
        self._level: dict[int, list[int]] = {}  # bonds by the cells that they pass level
        self._upright: dict[int, list[int]] = {}  # the same for upright ones; corners are both
        self._shared: dict[int, list[int]] = {}  # bonds by their steps
        self._ways: list[tuple[list[int], list[int], list[int]]] = [([], [], []) for _ in bonds]
        self._long = [0] * len(bonds)  # what they cost by themselves
        self._clear: set[int] = set()  # those that are known to meet nothing
        self._known: dict[int, int] = {}  # what nodes cost where they are

    def put(self, node: int, cell: Cell) -> None:
        """Place a node on a free cell."""
        self.at[node] = cell
        self.who[cell] = node
        number = (cell[0] << _ROW) + cell[1]
        self._taken.add(number)
        for passes in (self._level, self._upright):
            self._clear.difference_update(passes.get(number, ()))
        for b in self.bonds_of[node]:
            tail, head = self.bonds[b]
            start, end = self.at[tail], self.at[head]
            if start is not None and end is not None:
                self._lay(b, start, end)

    def take(self, node: int) -> Cell:
        """Take a node off the board and return the cell where it was."""
        cell = self.at[node]
        assert cell is not None
        for b in self.bonds_of[node]:
            if self._ends[b] is not None:
                self._lift(b)
        self.at[node] = None
        del self.who[cell]
        self._taken.discard((cell[0] << _ROW) + cell[1])
        return cell

    def _lay(self, b: int, start: Cell, end: Cell) -> None:
        """Enter the way of a bond."""
        self._ends[b] = (start, end)
        if self.turns[b] == STRAIGHT_AWAY and not _next_door(start, end):
            self.turns[b] = LEVEL_FIRST
        self._long[b] = self._alone(b, start, end, self.turns[b])
        for n in self.bonds[b]:
            self._known.pop(n, None)
        clear = self._clear
        clear.discard(b)
        level, upright, steps = self._ways[b] = _way(start, end, self.turns[b])
        for known, numbers in (
            (self._level, level),
            (self._upright, upright),
            (self._shared, steps),
        ):
            for number in numbers:
                if number in known:
                    known[number].append(b)
                else:
                    known[number] = [b]
        for met, numbers in (
            (self._upright, level),
            (self._level, upright),
            (self._shared, steps),
        ):
            for number in numbers:
                if number in met:
                    clear.difference_update(met[number])
        if self.turns[b] == STRAIGHT_AWAY:
            for step in steps:
                clear.difference_update(self._shared.get(step ^ 1, ()))

    def _lift(self, b: int) -> None:
        way = self._ways[b]
        for n in self.bonds[b]:
            self._known.pop(n, None)
        for known, numbers in zip((self._level, self._upright, self._shared), way, strict=True):
            for number in numbers:
                known[number].remove(b)
        self._ways[b], self._ends[b], self._long[b] = ([], [], []), None, 0

    def turn(self, bond: int, way: int) -> None:
        """Give a bond another turn."""
        ends = self._ends[bond]
        self._lift(bond)
        self.turns[bond] = way
        if ends is not None:
            self._lay(bond, *ends)

    def best_turns(self, bonds: Iterable[int]) -> None:
        """Give each of these bonds the turn that costs least where the others are."""
        for b in bonds:
            ends = self._ends[b]
            if ends is None or ends[0][0] == ends[1][0] or ends[0][1] == ends[1][1]:
                continue
            here = self.turns[b]
            if here != STRAIGHT_AWAY and not self._met(b, self._ways[b], _NONE):
                continue
            ways = (LEVEL_FIRST, UPRIGHT_FIRST, STRAIGHT_AWAY)[: 3 if _next_door(*ends) else 2]
            costs = []
            for way in ways:
                more = 0 if way == here else 1  # a tie leaves it as it is
                costs.append(_length(*ends, way) + more + self._met(b, _way(*ends, way), _NONE))
            best = costs.index(min(costs))
            if best != here:
                self.turn(b, best)

    def corner(self, bond: int) -> Cell | None:
        """Return where a bond bends, None if it is straight."""
        ends = self._ends[bond]
        return None if ends is None else _corner(*ends, self.turns[bond])

    def cost(self, nodes: Iterable[int], *, most: float = math.inf) -> int:
        """Return the part of the cost that depends on where `nodes` are; `most` as for `Board`."""
        changed = set(nodes)
        bonds = {b for n in changed for b in self.bonds_of[n]}
        total = 0
        for b in bonds:
            total += self._long[b] if b in self._clear else self._bond_cost(b, bonds)
            if total > most:
                return total
        touched = set(changed)
        for n in changed:
            touched.update(self.near[n])
            cell = self.at[n]
            if cell is not None:
                number = (cell[0] << _ROW) + cell[1]
                for passes in (self._level, self._upright):
                    for b in passes.get(number, ()):
                        if b not in bonds:
                            total += ON_NODE
        known = self._known
        for n in touched & self._choosy:
            if n not in known:
                known[n] = self._node_cost(n)
            total += known[n]
        return total

    def least(self, moves: Mapping[int, Cell], most: float = math.inf) -> int:
        """Return a lower bound of what `cost` would be after these moves, found without them.

        Each bond takes the turn that is best for it alone, and those that move do not meet each
        other. Of a bound above `most` only as much is counted as it takes to know that.
        """
        at, total = self.at, 0
        bonds = {b for n in moves for b in self.bonds_of[n]}
        ways: list[tuple[Cell, Cell]] = []
        for b in bonds:
            tail, head = self.bonds[b]
            start, end = moves.get(tail) or at[tail], moves.get(head) or at[head]
            if start is None or end is None:
                continue
            dx, dy = end[0] - start[0], end[1] - start[1]
            long = UNIT + LONGER * (abs(dx) + abs(dy) - 1) + (BEND if dx and dy else 0)
            if self._inner[b]:
                long += BACKWARDS * (dx < 0 or (dx == 0 and dy < 0)) + VERTICAL * (dy != 0)
            total += long
            ways.append((start, end))
        if total > most:
            return total
        old = {(c[0] << _ROW) + c[1] for n in moves if (c := at[n]) is not None}
        new = {(x << _ROW) + y for x, y in moves.values()}
        for number in new:
            for passes in (self._level, self._upright):
                for b in passes.get(number, ()):
                    if b not in bonds:
                        total += ON_NODE
        total += self._node_costs_after(moves)
        if total > most:
            return total
        taken = (self._taken - old) | new
        for start, end in ways:
            if start[0] == end[0] or start[1] == end[1]:
                total += self._least_way(start, end, LEVEL_FIRST, bonds, taken)
            else:
                met = self._least_way(start, end, LEVEL_FIRST, bonds, taken)
                if met:
                    met = min(met, self._least_way(start, end, UPRIGHT_FIRST, bonds, taken))
                more = ASKEW - BEND
                if met > more and _next_door(start, end):
                    more += self._least_way(start, end, STRAIGHT_AWAY, bonds, taken)
                    met = min(met, more)
                total += met
            if total > most:
                break
        return total

    def _least_way(
        self, start: Cell, end: Cell, turn: int, changed: set[int], taken: set[int]
    ) -> int:
        """Return what it costs that a bond on this way meets nodes, and bonds not `changed`."""
        total = 0
        first = (start[0] << _ROW) + start[1]
        level, upright, steps = _from_origin(end[0] - start[0], end[1] - start[1], turn)
        for offsets, across in ((level, self._upright), (upright, self._level)):
            for offset in offsets:
                number = first + offset
                if number in taken:
                    total += ON_NODE
                for other in across.get(number, ()):
                    if other not in changed:
                        total += CROSS
        first <<= 2
        shared = self._shared
        for offset in steps:
            step = first + offset
            for other in shared.get(step, ()):
                if other not in changed:
                    total += SAME_WAY
            if step & 2:
                total += CROSS * sum(o not in changed for o in shared.get(step ^ 1, ()))
        return total

    def defects(self) -> int:
        """Return how many crossings, shared steps and passed nodes there are, askew ones too."""
        total = sum(len(s) - 1 for s in self._shared.values() if len(s) > 1)
        for b, (level, upright, _) in enumerate(self._ways):
            total += len(self._taken.intersection(level)) + len(self._taken.intersection(upright))
            total += self.turns[b] == STRAIGHT_AWAY and self._askew(b)
            total += sum(o != b for number in level for o in self._upright.get(number, ()))
        return total

    def _askew(self, bond: int) -> bool:
        ends = self._ends[bond]
        return ends is not None and ends[0][0] != ends[1][0] and ends[0][1] != ends[1][1]

    def _bond_cost(
        self, bond: int, changed: set[int] | frozenset[int], most: float = math.inf
    ) -> int:
        if bond in self._clear or self._ends[bond] is None:
            return self._long[bond]
        met = self._met(bond, self._ways[bond], changed)
        if not met and not self._met(bond, self._ways[bond], _NONE):
            self._clear.add(bond)
        return self._long[bond] + met

    def _alone(self, bond: int, start: Cell, end: Cell, turn: int) -> int:
        """Return what a bond costs by its length, bend and direction."""
        total = _length(start, end, turn)
        if self._inner[bond]:
            dx, dy = end[0] - start[0], end[1] - start[1]
            total += BACKWARDS * (dx < 0 or (dx == 0 and dy < 0)) + VERTICAL * (dy != 0)
        return total

    def _met(
        self,
        bond: int,
        way: tuple[list[int], list[int], list[int]],
        changed: set[int] | frozenset[int],
    ) -> int:
        """Return what it costs that a bond on this way meets nodes and other bonds.

        A pair of bonds that are both `changed` is counted once.
        """
        total = 0
        level, upright, steps = way
        taken, shared = self._taken, self._shared
        for numbers, across in ((level, self._upright), (upright, self._level)):
            for number in numbers:
                if number in taken:
                    total += ON_NODE
                for other in across.get(number, ()):
                    if other != bond and (other not in changed or bond < other):
                        total += CROSS
        for step in steps:
            for other in shared.get(step, ()):
                if other != bond and (other not in changed or bond < other):
                    total += SAME_WAY
            if step & 2:
                over = shared.get(step ^ 1, ())
                total += CROSS * sum(o not in changed or bond < o for o in over)
        return total

    def _node_cost(self, node: int) -> int:
        cost = super()._node_cost(node)
        near = self.near[node]
        if cost == 0 and len(near) == 2 and self.kinds[node] in ("TF", "GY"):
            # in line by where its neighbours stand; by its bonds it may bend all the same
            cost += BENT * any(self.corner(b) is not None for b in self.bonds_of[node])
        return cost


_NONE: frozenset[int] = frozenset()


def _next_door(a: Cell, b: Cell) -> bool:
    return abs(a[0] - b[0]) == 1 == abs(a[1] - b[1])


def _corner(a: Cell, b: Cell, turn: int) -> Cell | None:
    if a[0] == b[0] or a[1] == b[1] or turn == STRAIGHT_AWAY:
        return None
    return (b[0], a[1]) if turn == LEVEL_FIRST else (a[0], b[1])


def _length(a: Cell, b: Cell, turn: int) -> int:
    dx, dy = abs(b[0] - a[0]), abs(b[1] - a[1])
    if dx == 0 or dy == 0:
        return UNIT + LONGER * (dx + dy - 1)
    return UNIT + LONGER * (dx + dy - 1) + (ASKEW if turn == STRAIGHT_AWAY else BEND)


def _way(a: Cell, b: Cell, turn: int) -> tuple[list[int], list[int], list[int]]:
    """Return the cells that a bond passes level and upright, and the steps that it goes."""
    level, upright, steps = _from_origin(b[0] - a[0], b[1] - a[1], turn)
    start = (a[0] << _ROW) + a[1]
    first = start << 2
    return (
        [start + n for n in level],
        [start + n for n in upright],
        [first + n for n in steps],
    )


@lru_cache(maxsize=8192)
def _from_origin(dx: int, dy: int, turn: int) -> tuple[Numbers, Numbers, Numbers]:
    if turn == STRAIGHT_AWAY and abs(dx) == 1 == abs(dy):
        corner = (min(dx, 0) << _ROW) + min(dy, 0)
        return (), (), ((corner << 2) + (2 if dx * dy > 0 else 3),)
    level_y, upright_x = (0, dx) if turn == LEVEL_FIRST else (dy, 0)
    left, right, top, bottom = min(dx, 0), max(dx, 0), min(dy, 0), max(dy, 0)
    level = [(x << _ROW) + level_y for x in range(left + 1, right)]
    upright = [(upright_x << _ROW) + y for y in range(top + 1, bottom)]
    steps = [((x << _ROW) + level_y) << 2 for x in range(left, right)]
    steps += [(((upright_x << _ROW) + y) << 2) + 1 for y in range(top, bottom)]
    if dx and dy:
        corner = (upright_x << _ROW) + level_y
        level.append(corner)
        upright.append(corner)
    return tuple(level), tuple(upright), tuple(steps)
