"""The board of a drawing: nodes on an integer grid, bonds level or upright with at most one bend.

As on a `Board` all costs are integers, so that sums do not depend on their order. A bond between
two nodes that are not in line has a *turn*: where it bends, or that it runs askew to the next cell,
which is left to nodes with more bonds than sides.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from hybond.draw.board import BACKWARDS, BENT, LONGER, UNIT, VERTICAL, Board, Cell

ON_NODE = 260
CROSS = 120
SAME_WAY = 90
"""Each step that two bonds share."""
BEND = 24
ASKEW = 60

LEVEL_FIRST, UPRIGHT_FIRST, STRAIGHT_AWAY = 0, 1, 2
"""Turns, seen from the tail of a bond."""

_LEVEL, _UPRIGHT, _CORNER = 1, 2, 3

Step = tuple[int, int, int]
"""A unit of the grid's lines: its lower end, and 0 for level, 1 for upright, 2 or 3 for askew."""


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
        self._passes: dict[Cell, dict[int, int]] = {}  # bonds by the cells that they pass, and how
        self._shared: dict[Step, list[int]] = {}
        self._cells: list[list[tuple[Cell, int]]] = [[] for _ in bonds]
        self._steps: list[list[Step]] = [[] for _ in bonds]

    def put(self, node: int, cell: Cell) -> None:
        """Place a node on a free cell."""
        self.at[node] = cell
        self.who[cell] = node
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
            self._lift(b)
        self.at[node] = None
        del self.who[cell]
        return cell

    def _lay(self, b: int, start: Cell, end: Cell) -> None:
        """Enter the way of a bond."""
        self._ends[b] = (start, end)
        if self.turns[b] == STRAIGHT_AWAY and not _next_door(start, end):
            self.turns[b] = LEVEL_FIRST
        cells, steps = _way(start, end, self.turns[b])
        self._cells[b], self._steps[b] = cells, steps
        for cell, how in cells:
            self._passes.setdefault(cell, {})[b] = how
        for step in steps:
            self._shared.setdefault(step, []).append(b)

    def _lift(self, b: int) -> None:
        for cell, _ in self._cells[b]:
            del self._passes[cell][b]
        for step in self._steps[b]:
            self._shared[step].remove(b)
        self._cells[b], self._steps[b], self._ends[b] = [], [], None

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
            ways = (LEVEL_FIRST, UPRIGHT_FIRST, STRAIGHT_AWAY)[: 3 if _next_door(*ends) else 2]
            costs = []
            for way in ways:
                cells, steps = _way(*ends, way)
                more = 0 if way == here else 1  # a tie leaves it as it is
                costs.append(_length(*ends, way) + more + self._met(b, cells, steps, _NONE))
            best = costs.index(min(costs))
            if best != here:
                self.turn(b, best)

    def corner(self, bond: int) -> Cell | None:
        """Return where a bond bends, None if it is straight."""
        ends = self._ends[bond]
        return None if ends is None else _corner(*ends, self.turns[bond])

    def cost(self, nodes: Iterable[int]) -> int:
        """Return the part of the cost that depends on where `nodes` are."""
        changed = set(nodes)
        bonds = {b for n in changed for b in self.bonds_of[n]}
        total = 0
        for b in bonds:
            total += self._bond_cost(b, bonds)
        touched = set(changed)
        for n in changed:
            touched.update(self.near[n])
            cell = self.at[n]
            if cell is not None and cell in self._passes:
                total += ON_NODE * sum(b not in bonds for b in self._passes[cell])
        return total + sum(self._node_cost(n) for n in touched)

    def least(self, moves: Mapping[int, Cell]) -> int:
        """Return a quick lower bound of what `cost` would be after these moves."""
        total = 0
        for b in {b for n in moves for b in self.bonds_of[n]}:
            tail, head = self.bonds[b]
            start, end = moves.get(tail) or self.at[tail], moves.get(head) or self.at[head]
            if start is not None and end is not None:
                total += _length(start, end, LEVEL_FIRST)
        return total

    def flaws(self, bond: int) -> int:
        """Return over how many nodes a bond runs, and how many steps it shares with others."""
        found = sum(cell in self.who for cell, _ in self._cells[bond])
        return found + sum(len(self._shared[s]) - 1 for s in self._steps[bond])

    def defects(self) -> int:
        """Return how many crossings, shared steps and passed nodes there are, askew ones too."""
        total = sum(len(s) - 1 for s in self._shared.values() if len(s) > 1)
        for b, cells in enumerate(self._cells):
            total += sum(cell in self.who for cell, _ in cells)
            total += self.turns[b] == STRAIGHT_AWAY and self.corner(b) is None and self._askew(b)
            for cell, how in cells:
                total += sum(o > b and _meet(how, h) for o, h in self._passes[cell].items())
        return total

    def _askew(self, bond: int) -> bool:
        ends = self._ends[bond]
        return ends is not None and ends[0][0] != ends[1][0] and ends[0][1] != ends[1][1]

    def _bond_cost(self, bond: int, changed: set[int] | frozenset[int]) -> int:
        ends = self._ends[bond]
        if ends is None:
            return 0
        (ax, ay), (bx, by) = ends
        total = _length(*ends, self.turns[bond])
        tail, head = self.bonds[bond]
        if len(self.near[tail]) > 1 and len(self.near[head]) > 1:
            dx, dy = bx - ax, by - ay
            total += BACKWARDS * (dx < 0 or (dx == 0 and dy < 0)) + VERTICAL * (dy != 0)
        return total + self._met(bond, self._cells[bond], self._steps[bond], changed)

    def _met(
        self,
        bond: int,
        cells: Sequence[tuple[Cell, int]],
        steps: Sequence[Step],
        changed: set[int] | frozenset[int],
    ) -> int:
        """Return what it costs that a bond on this way meets nodes and other bonds.

        A pair of bonds that are both `changed` is counted once.
        """
        total = 0
        who, passes, shared = self.who, self._passes, self._shared
        for cell, how in cells:
            if cell in who:
                total += ON_NODE
            others = passes.get(cell)
            if others:
                for other, passing in others.items():
                    if other == bond or (other in changed and bond > other):
                        continue
                    if how != passing or how == _CORNER:
                        total += CROSS
        for step in steps:
            along = shared.get(step)
            if along:
                for other in along:
                    if other != bond and (other not in changed or bond < other):
                        total += SAME_WAY
            if step[2] > 1:
                over = shared.get((step[0], step[1], 5 - step[2]), ())
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


def _meet(how: int, passing: int) -> bool:
    """Whether two bonds that pass one cell cross there, or touch at a corner."""
    return how != passing or how == _CORNER


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


def _way(a: Cell, b: Cell, turn: int) -> tuple[list[tuple[Cell, int]], list[Step]]:
    """Return the cells that a bond passes, and the steps that it goes."""
    (ax, ay), (bx, by) = a, b
    if turn == STRAIGHT_AWAY and _next_door(a, b):
        falls = (bx - ax) * (by - ay) > 0
        return [], [(min(ax, bx), min(ay, by), 2 if falls else 3)]
    level_y, upright_x = (ay, bx) if turn == LEVEL_FIRST else (by, ax)
    left, right = (ax, bx) if ax < bx else (bx, ax)
    top, bottom = (ay, by) if ay < by else (by, ay)
    steps = [(x, level_y, 0) for x in range(left, right)]
    steps += [(upright_x, y, 1) for y in range(top, bottom)]
    cells = [((x, level_y), _LEVEL) for x in range(left + 1, right)]
    cells += [((upright_x, y), _UPRIGHT) for y in range(top + 1, bottom)]
    if ax != bx and ay != by:
        cells.append(((upright_x, level_y), _CORNER))
    return cells, steps
