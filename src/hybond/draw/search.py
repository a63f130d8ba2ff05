"""Better places on a board: moves of nodes, of legs and of whole halves, by falling threshold.

Nodes of legs move together: what one leg's node does, those of the others do, so that legs stay
copies of each other in a row.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from hybond.draw.board import Board, Cell
from hybond.draw.legs import Leg

B = TypeVar("B", bound=Board)
Moves = dict[int, Cell]
_AROUND = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)]


@dataclass
class Search(Generic[B]):
    """A board that is improved, with what must stay together.

    Parameters
    ----------
    board : Board
        Every node placed; changed in place.
    fixed : set of int
        Nodes that stay.
    groups : sequence of sequence of tuple of int
        Groups of legs, see `hybond.draw.legs`.
    brief : bool
        In a descent, leave nodes alone around which nothing has changed since they were tried.
    """

    board: B
    fixed: set[int] = field(default_factory=set)
    groups: Sequence[Sequence[Leg]] = ()
    brief: bool = False

    def __post_init__(self) -> None:
        size = len(self.board.kinds)
        near = self.board.near
        self._costs: dict[frozenset[int], int] = {}  # of nodes as the board is
        self._awake: set[int] = set()  # nodes around which something has changed
        self.twins: list[tuple[int, ...]] = [(n,) for n in range(size)]
        self.legs: list[Sequence[Leg]] = list(self.groups)
        for legs in self.groups:
            for nodes in zip(*legs, strict=True):
                for n in nodes:
                    self.twins[n] = nodes
        self.whole = [
            (n, *(m for m in near[n] if len(near[m]) == 1 and m not in self.fixed))
            if len(near[n]) > 1
            else (n,)
            for n in range(size)
        ]

    def anneal(self, steps: int, *, seed: int, hot: int) -> None:
        """Try `steps` moves, at first also those that cost up to `hot`, and end at the best."""
        board, rng = self.board, random.Random(seed)
        free = [n for n in range(len(board.kinds)) if n not in self.fixed]
        if not free:
            return
        best, record, score = self._kept(), 0, 0
        self._costs.clear()
        for step in range(steps):
            threshold = hot * (1.0 - step / steps) ** 2
            score += self.attempt(self._random(rng, free), threshold * rng.random())
            if score < record:
                best, record = self._kept(), score
        if score > record:
            self._back(best)

    def _kept(self) -> tuple[list[Cell | None], list[int]]:
        return list(self.board.at), list(self.board.turns)

    def _back(self, kept: tuple[list[Cell | None], list[int]]) -> None:
        board = self.board
        self._costs.clear()
        moved = {n: c for n, c in enumerate(kept[0]) if c is not None and board.at[n] != c}
        board.move(moved)
        for b, way in enumerate(kept[1]):
            if board.turns[b] != way:
                board.turn(b, way)

    def _random(self, rng: random.Random, free: Sequence[int]) -> Moves:
        board = self.board
        kind = rng.random()
        if self.legs and kind < 0.08:
            legs = self.legs[int(rng.random() * len(self.legs))]
            dx, dy = int(rng.random() * 3) - 1, int(rng.random() * 3) - 1
            if rng.random() < 0.5:
                return self._shifted({n: (dx, dy) for leg in legs for n in leg})
            # farther apart or closer, in the row in which they stand
            one, two = board.at[legs[0][0]], board.at[legs[1][0]]
            if one is not None and two is not None:
                dx, dy = (dx, 0) if one[1] == two[1] else (0, dy)
            return self._shifted({n: (k * dx, k * dy) for k, leg in enumerate(legs) for n in leg})
        node = free[int(rng.random() * len(free))]
        near = board.near[node]
        anchor = near[int(rng.random() * len(near))] if near else node
        here, cell = board.at[node], board.at[anchor]
        assert cell is not None and here is not None
        reach = 1 if rng.random() < 0.6 else 3
        dx = cell[0] + int(rng.random() * (2 * reach + 1)) - reach - here[0]
        dy = cell[1] + int(rng.random() * (2 * reach + 1)) - reach - here[1]
        whole = self.whole[node] if rng.random() < 0.5 else (node,)
        return self.moves(whole, dx, dy)

    def moves(self, whole: Sequence[int], dx: int, dy: int) -> Moves:
        """Return the moves of nodes and their twins by (dx, dy); who stands there makes room."""
        if dx == 0 == dy:
            return {}
        if len(whole) == 1 == len(self.twins[whole[0]]):
            node = whole[0]
            cell = self.board.at[node]
            if cell is None or node in self.fixed:
                return {}
            target = (cell[0] + dx, cell[1] + dy)
            if target not in self.board.who:
                return {node: target}
        return self._shifted({t: (dx, dy) for n in whole for t in self.twins[n]})

    def _shifted(self, by: Mapping[int, Cell]) -> Moves:
        """Return moves by these steps, and of those who stand in the way; nothing if that fails."""
        board, at = self.board, self.board.at
        moves: Moves = {}
        for n, (dx, dy) in by.items():
            cell = at[n]
            if cell is None or n in self.fixed:
                return {}
            moves[n] = (cell[0] + dx, cell[1] + dy)
        if all(moves[n] == at[n] for n in moves):
            return {}
        taken = set(moves.values())
        if len(taken) < len(moves):
            return {}
        pushed = {o for c in taken if (o := board.who.get(c)) is not None and o not in moves}
        if not pushed:
            return moves
        if pushed & self.fixed:
            return {}
        vacant = {c for n in moves if (c := at[n]) is not None} - taken
        for n, target in list(moves.items()):
            other = board.who.get(target)
            if other is None or other not in pushed or other in moves:
                continue
            old = at[n]
            assert old is not None
            back = old if old in vacant else min(vacant, default=None)
            if back is None:
                return {}
            step = (back[0] - target[0], back[1] - target[1])
            # the twins of who is pushed out go the same way
            for t in self.twins[other]:
                cell = at[t]
                if cell is None or t in moves:
                    return {}
                goal = (cell[0] + step[0], cell[1] + step[1])
                if goal not in vacant and (goal in board.who or goal in taken):
                    return {}
                vacant.discard(goal)
                taken.add(goal)
                moves[t] = goal
        return moves if len(set(moves.values())) == len(moves) else {}

    def attempt(self, moves: Moves, threshold: float) -> int:
        """Make the moves unless they cost more than `threshold`; return the change of the cost."""
        if not moves:
            return 0
        board = self.board
        before = self._cost(moves)
        if board.least(moves, before + threshold) > before + threshold:
            return 0
        old = {n: c for n in moves if (c := board.at[n]) is not None}
        bonds = sorted({b for n in moves for b in board.bonds_of[n]})
        turns = [board.turns[b] for b in bonds]
        board.move(moves)
        board.best_turns(bonds)
        change = board.cost(moves, most=before + threshold) - before
        if change > threshold:
            board.move(old)
            for b, way in zip(bonds, turns, strict=True):
                if board.turns[b] != way:
                    board.turn(b, way)
            return 0
        self._costs.clear()
        if self.brief:
            self._wake(moves, old)
        return change

    def _wake(self, moves: Moves, old: Moves) -> None:
        board = self.board
        self._awake.update(moves)
        for n in moves:
            self._awake.update(board.near[n])
        for x, y in {*moves.values(), *old.values()}:
            for around in _AROUND:
                other = board.who.get((x + around[0], y + around[1]))
                if other is not None:
                    self._awake.add(other)

    def _cost(self, nodes: Iterable[int]) -> int:
        """Return what nodes cost where they are; nearly all moves are refused and leave it so."""
        key = frozenset(nodes)
        known = self._costs.get(key)
        if known is None:
            known = self._costs[key] = self.board.cost(key)
        return known

    def descend(self, *, rounds: int, reach: int) -> None:
        """Try all near cells for all nodes until nothing improves, `rounds` times at most."""
        board = self.board
        ways = [(dx, dy) for dx in range(-reach, reach + 1) for dy in range(-reach, reach + 1)]
        first = [n for n in range(len(board.kinds)) if self.twins[n][0] == n]
        self._costs.clear()
        self._awake = set(first)
        for _ in range(rounds):
            gain = 0
            for node in first:
                if node in self.fixed or self._awake.isdisjoint(self.twins[node]):
                    continue
                if self.brief:
                    self._awake.difference_update(self.twins[node])
                for whole in dict.fromkeys((self.whole[node], (node,))):
                    for dx, dy in ways:
                        gain += self.attempt(self.moves(whole, dx, dy), -1)
            gain += self._closer() if not self.fixed else 0
            if not gain:
                return

    def _closer(self) -> int:
        """Move halves of the picture by a row or column towards or from each other."""
        board = self.board
        gain = 0
        for axis in (0, 1):
            places = sorted({c[axis] for c in board.at if c is not None})
            for line in range(places[0] + 1, places[-1] + 1):
                for by in (-1, 1):
                    step = (by, 0) if axis == 0 else (0, by)
                    far = {
                        n: step for n, c in enumerate(board.at) if c is not None and c[axis] >= line
                    }
                    if far and self._keeps_legs(far):
                        gain += self.attempt(self._clear(far), -1)
        return gain

    def _clear(self, far: Mapping[int, Cell]) -> Moves:
        """Return the moves of a half, nothing if it runs into the other."""
        board = self.board
        moves: Moves = {}
        for n, (dx, dy) in far.items():
            x, y = board.at[n] or (0, 0)
            moves[n] = (x + dx, y + dy)
            other = board.who.get(moves[n])
            if other is not None and other not in far:
                return {}
        return moves

    def _keeps_legs(self, far: Mapping[int, Cell]) -> bool:
        """Whether legs stay copies of each other: each is moved as a whole, or none in part."""
        for legs in self.legs:
            parts = {tuple(n in far for n in leg) for leg in legs}
            if any(0 < sum(p) < len(p) for p in parts) and len(parts) > 1:
                return False
        return True
