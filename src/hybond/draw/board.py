"""A board: nodes on an integer grid, straight bonds between them, and what a placement costs.

All costs are integers, so that sums do not depend on their order and the same graph gives the
same picture on every machine. x counts columns to the right, y rows downwards.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

from hybond.model.kinds import SOURCES

Cell = tuple[int, int]

LEVEL_FIRST, UPRIGHT_FIRST, STRAIGHT_AWAY = 0, 1, 2
"""Turns of bonds, seen from their tails."""

UNIT = 10
"""A bond to the next cell."""
LONGER = 22
"""Each further cell."""
DIAGONAL = 45
SKEW = 70
ON_BOND = 250
CROSSING = 120
BENT = 14
"""A two-port whose bonds are not in line."""
BACKWARDS = 3
"""A bond between junctions that carries power to the left or upwards."""
VERTICAL = 5
"""A bond between junctions that is not horizontal."""

# Penalty of a one-port's direction as seen from its junction: north, east, south, west.
_SIDES: dict[str, tuple[int, int, int, int]] = {
    "C": (0, 5, 4, 9),
    "I": (0, 5, 4, 9),
    "R": (4, 3, 0, 9),
    "G": (4, 3, 0, 9),
    "Se": (5, 9, 6, 0),
    "Sf": (5, 9, 6, 0),
}
_SINK = (5, 0, 4, 9)
"""A source that takes power: the floor, a threshold voltage."""


class Board:
    """Positions of nodes, with costs that can be asked for a few nodes at a time.

    Parameters
    ----------
    kinds : sequence of str
        The kind of each node, a key of `hybond.model.kinds.KINDS`.
    bonds : sequence of (tail, head)
        Node numbers. Two bonds between the same nodes are allowed.

    Examples
    --------
    >>> board = Board(["Se", "1", "I"], [(0, 1), (1, 2)])
    >>> for node, cell in enumerate([(0, 0), (1, 0), (1, -1)]):
    ...     board.put(node, cell)
    >>> board.cost([0, 1, 2])
    20
    """

    def __init__(self, kinds: Sequence[str], bonds: Sequence[tuple[int, int]]) -> None:
        self.kinds = tuple(kinds)
        self.bonds = tuple(bonds)
        self.at: list[Cell | None] = [None] * len(kinds)
        self.who: dict[Cell, int] = {}
        self.bonds_of: list[list[int]] = [[] for _ in kinds]
        self.near: list[list[int]] = [[] for _ in kinds]
        for b, (tail, head) in enumerate(bonds):
            for one, other in ((tail, head), (head, tail)):
                self.bonds_of[one].append(b)
                if other not in self.near[one]:
                    self.near[one].append(other)
        self._inner = [len(self.near[a]) > 1 and len(self.near[b]) > 1 for a, b in bonds]
        self._choosy = {  # nodes that may cost something where they are
            n
            for n, kind in enumerate(kinds)
            if (len(self.near[n]) == 1 and kind in _SIDES)
            or (len(self.near[n]) == 2 and kind in ("TF", "GY"))
        }
        self.turns = [STRAIGHT_AWAY] * len(bonds)
        self._over: dict[Cell, set[int]] = {}  # bonds by the cells along them
        self._box: list[list[Cell]] = [[] for _ in bonds]  # these cells; none if not placed
        self._ends: list[tuple[Cell, Cell] | None] = [None] * len(bonds)

    def put(self, node: int, cell: Cell) -> None:
        """Place a node on a free cell."""
        self.at[node] = cell
        self.who[cell] = node
        for b in self.bonds_of[node]:
            tail, head = self.bonds[b]
            start, end = self.at[tail], self.at[head]
            if start is None or end is None:
                continue
            self._ends[b] = (start, end)
            self._box[b] = _box(start, end)
            for covered in self._box[b]:
                self._over.setdefault(covered, set()).add(b)

    def take(self, node: int) -> Cell:
        """Take a node off the board and return the cell where it was."""
        cell = self.at[node]
        assert cell is not None
        for b in self.bonds_of[node]:
            for covered in self._box[b]:
                self._over[covered].discard(b)
            self._box[b], self._ends[b] = [], None
        self.at[node] = None
        del self.who[cell]
        return cell

    def move(self, moves: Mapping[int, Cell]) -> None:
        """Move several nodes at once; their new cells are free or left by one of them."""
        for node in moves:
            self.take(node)
        for node, cell in moves.items():
            self.put(node, cell)

    def turn(self, bond: int, way: int) -> None:
        """Give a bond another turn; here all are straight."""

    def best_turns(self, bonds: Iterable[int]) -> None:
        """Give each of these bonds the turn that costs least; here all are straight."""

    def cost(self, nodes: Iterable[int], *, most: float = math.inf) -> int:
        """Return the part of the cost that depends on where `nodes` are.

        Of a cost above `most` only as much is counted as it takes to know that.
        """
        changed = set(nodes)
        bonds = {b for n in changed for b in self.bonds_of[n]}
        total = 0
        for b in bonds:
            total += self._bond_cost(b, bonds, most - total)
            if total > most:
                return total
        for n in changed:
            cell = self.at[n]
            if cell is None:
                continue
            for b in self._over.get(cell, ()):
                if b not in bonds and self._covers(b, cell):
                    total += ON_BOND
        touched = changed.union(*(self.near[n] for n in changed))
        return total + sum(self._node_cost(n) for n in touched if n in self._choosy)

    def defects(self) -> int:
        """Return how many bonds run askew, cross another or pass over a node."""
        count = 0
        for b in range(len(self.bonds)):
            ends = self._ends[b]
            if ends is None:
                continue
            (ax, ay), (bx, by) = ends
            over = {o for cell in self._box[b] for o in self._over.get(cell, ())}
            count += ax != bx and ay != by
            count += sum(self._cross(b, o) for o in over if o > b)
            count += sum(cell in self.who and self._covers(b, cell) for cell in self._box[b])
        return count

    def least(self, moves: Mapping[int, Cell], most: float = math.inf) -> int:
        """Return a lower bound of what `cost` would be after these moves, found without them.

        Bonds that move do not meet each other in it, nor nodes that move. Of a bound above `most`
        only as much is counted as it takes to know that.
        """
        total = 0
        ways: list[tuple[int, Cell, Cell]] = []
        bonds = {b for n in moves for b in self.bonds_of[n]}
        for b in bonds:
            tail, head = self.bonds[b]
            start, end = moves.get(tail) or self.at[tail], moves.get(head) or self.at[head]
            if start is None or end is None:
                continue
            total += _length(start, end)
            if self._inner[b]:
                dx, dy = end[0] - start[0], end[1] - start[1]
                total += BACKWARDS * (dx < 0 or (dx == 0 and dy < 0)) + VERTICAL * (dy != 0)
            ways.append((b, start, end))
        if total > most:
            return total
        for cell in moves.values():
            for b in self._over.get(cell, ()):
                if b not in bonds and self._covers(b, cell):
                    total += ON_BOND
        total += self._node_costs_after(moves)
        for b, start, end in ways:
            if total > most:
                break
            total += self._least_met(b, start, end, bonds, moves)
        return total

    def _least_met(
        self, bond: int, start: Cell, end: Cell, changed: set[int], moves: Mapping[int, Cell]
    ) -> int:
        """Return what it costs that a bond meets nodes that stay and bonds not `changed`."""
        total = 0
        others: set[int] = set()
        for cell in _box(start, end):
            node = self.who.get(cell)
            if node is not None and node not in moves and _near((start, end), cell):
                total += ON_BOND
            others.update(self._over.get(cell, ()))
        tail, head = self.bonds[bond]
        for other in others - changed:
            ends, pair = self._ends[other], self.bonds[other]
            if tail in pair or head in pair or ends is None:
                continue
            if _crossing((start, end), ends):
                total += CROSSING
        return total

    def _node_costs_after(self, moves: Mapping[int, Cell]) -> int:
        """Return what nodes and their neighbours would cost, where no bond bends."""
        at = self.at
        old = [(n, at[n]) for n in moves]
        touched = {m for n in moves for m in (n, *self.near[n]) if m in self._choosy}
        for n, cell in moves.items():
            at[n] = cell
        total = sum(Board._node_cost(self, n) for n in touched)
        for n, before in old:
            at[n] = before
        return total

    def _covers(self, bond: int, cell: Cell) -> bool:
        """Whether a bond passes through or close by a cell that is not one of its ends."""
        ends = self._ends[bond]
        return ends is not None and _near(ends, cell)

    def _bond_cost(self, bond: int, changed: set[int], most: float = math.inf) -> int:
        ends = self._ends[bond]
        if ends is None:
            return 0
        (ax, ay), (bx, by) = ends
        dx, dy = bx - ax, by - ay
        total = _length(*ends)
        if self._inner[bond]:
            total += BACKWARDS * (dx < 0 or (dx == 0 and dy < 0)) + VERTICAL * (dy != 0)
        others: set[int] = set()
        for cell in self._box[bond]:
            if cell in self.who and self._covers(bond, cell):
                total += ON_BOND
            others.update(self._over.get(cell, ()))
        others.discard(bond)
        for other in others:
            # A pair of changed bonds is counted once.
            if (other not in changed or bond < other) and self._cross(bond, other):
                total += CROSSING
                if total > most:
                    break
        return total

    def _cross(self, one: int, two: int) -> bool:
        a, b = self.bonds[one]
        if a in self.bonds[two] or b in self.bonds[two]:
            return False
        first, second = self._ends[one], self._ends[two]
        return first is not None and second is not None and _crossing(first, second)

    def _node_cost(self, node: int) -> int:
        here = self.at[node]
        if here is None:
            return 0
        kind = self.kinds[node]
        near = self.near[node]
        if len(near) == 1 and kind in _SIDES:
            there = self.at[near[0]]
            if there is None:
                return 0
            dx, dy = here[0] - there[0], here[1] - there[1]
            side = (2 if dy > 0 else 0) if abs(dy) >= abs(dx) else (1 if dx > 0 else 3)
            if kind in SOURCES and self.bonds[self.bonds_of[node][0]][1] == node:
                return _SINK[side]
            return _SIDES[kind][side]
        if len(near) == 2 and kind in ("TF", "GY"):
            p, q = self.at[near[0]], self.at[near[1]]
            if p is None or q is None:
                return 0
            ux, uy, vx, vy = p[0] - here[0], p[1] - here[1], q[0] - here[0], q[1] - here[1]
            return 0 if ux * vy == uy * vx and ux * vx + uy * vy < 0 else BENT
        return 0


def _near(ends: tuple[Cell, Cell], cell: Cell) -> bool:
    """Whether a line passes through or close by a cell that is not one of its ends."""
    if cell in ends:
        return False
    (ax, ay), (bx, by) = ends
    dx, dy = bx - ax, by - ay
    px, py = cell[0] - ax, cell[1] - ay
    if not 0 <= px * dx + py * dy <= dx * dx + dy * dy:
        return False
    # Nearer than 0.45 of a cell: the letters would touch the line.
    return 100 * (px * dy - py * dx) ** 2 < 21 * (dx * dx + dy * dy)


def _crossing(first: tuple[Cell, Cell], second: tuple[Cell, Cell]) -> bool:
    ((px, py), (qx, qy)), ((rx, ry), (sx, sy)) = first, second
    # twice the areas of triangles: on which side of one bond the ends of the other are
    ux, uy, vx, vy = qx - px, qy - py, sx - rx, sy - ry
    one_side = ux * (ry - py) - uy * (rx - px)
    other_side = ux * (sy - py) - uy * (sx - px)
    if one_side * other_side >= 0:
        return False
    return (vx * (py - ry) - vy * (px - rx)) * (vx * (qy - ry) - vy * (qx - rx)) < 0


def _length(a: Cell, b: Cell) -> int:
    """Return the cost of a bond's length and direction alone."""
    dx, dy = abs(b[0] - a[0]), abs(b[1] - a[1])
    askew = 0 if dx == 0 or dy == 0 else DIAGONAL if dx == dy else SKEW
    return UNIT + LONGER * (dx + dy - 1) + askew


def _box(a: Cell, b: Cell) -> list[Cell]:
    """Return the cells along a bond."""
    x, y = a
    return [(x + dx, y + dy) for dx, dy in _along(b[0] - x, b[1] - y)]


@lru_cache(maxsize=8192)
def _along(dx: int, dy: int) -> tuple[Cell, ...]:
    """Return the cells along a line from the origin.

    They are so near that the place where two lines cross is in a cell of both.
    """
    xs, ys = range(min(dx, 0), max(dx, 0) + 1), range(min(dy, 0), max(dy, 0) + 1)
    near = 51 * (dx * dx + dy * dy)
    return tuple((x, y) for x in xs for y in ys if 100 * (x * dy - y * dx) ** 2 <= near)
