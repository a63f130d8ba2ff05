"""Sparse Gauss-Jordan elimination that knows when a row vanished by structure.

Unknown columns are eliminated in the order rows arrive; known columns are only carried along. A
row whose unknowns all cancel is not lost: it is a constraint among the knowns, which is how
dependent storage and contradicting sources show themselves.
"""

from __future__ import annotations

Row = dict[int, float]
"""Column to coefficient; the row says that the sum of coefficient times column is zero."""

CANCELLATION = 1e-12
"""A sum below this part of its terms is a cancellation, hence zero."""


class Elimination:
    """Unknown columns ``0 .. unknowns - 1``, knowns after them.

    Examples
    --------
    >>> e = Elimination(2)
    >>> e.add({0: 1.0, 1: 1.0, 2: -1.0})  # a + b = u
    >>> e.add({0: 1.0, 3: -1.0})          # a = v
    >>> e.add({1: 1.0, 4: -1.0})          # b = w: then u - v - w = 0
    {2: 1.0, 3: -1.0, 4: -1.0}
    >>> e.solved[0]
    {3: -1.0}
    """

    def __init__(self, unknowns: int) -> None:
        self.unknowns = unknowns
        self.solved: dict[int, Row] = {}
        """``unknown + sum(row) = 0``, the row in free unknowns and knowns only."""
        self._users: dict[int, set[int]] = {}
        """Free unknown to the solved unknowns whose rows contain it."""

    def copy(self) -> Elimination:
        """Return an independent copy."""
        other = Elimination(self.unknowns)
        other.solved = {k: dict(row) for k, row in self.solved.items()}
        other._users = {k: set(v) for k, v in self._users.items()}
        return other

    def reduce(self, row: Row) -> Row:
        """Return the row with solved unknowns replaced and cancelled terms dropped."""
        total: Row = {}
        size: Row = {}
        for column, c in row.items():
            inner = self.solved.get(column)
            if inner is None:
                total[column] = total.get(column, 0.0) + c
                size[column] = size.get(column, 0.0) + abs(c)
                continue
            for k, d in inner.items():
                total[k] = total.get(k, 0.0) - c * d
                size[k] = size.get(k, 0.0) + abs(c * d)
        return {k: c for k, c in total.items() if abs(c) > CANCELLATION * size[k]}

    def add(self, row: Row, prefer: frozenset[int] = frozenset()) -> Row | None:
        """Add a row. Return it, scaled, if it constrains only knowns; None if it was used.

        `prefer` are columns that should be solved for, if the row lets them.
        """
        left = self.reduce(row)
        free = [k for k in left if k < self.unknowns]
        if not free:
            return left
        biggest = max(abs(left[k]) for k in free)
        pivot = min(
            (k for k in free if abs(left[k]) >= 0.1 * biggest),
            key=lambda k: (k not in prefer, len(self._users.get(k, ())), k),
        )
        scale = left.pop(pivot)
        solved = {k: c / scale for k, c in left.items()}
        for user in sorted(self._users.pop(pivot, ())):
            self._replace(user, pivot, solved)
        self.solved[pivot] = solved
        for k in solved:
            if k < self.unknowns:
                self._users.setdefault(k, set()).add(pivot)
        return None

    def _replace(self, user: int, pivot: int, solved: Row) -> None:
        row = self.solved[user]
        c = row.pop(pivot)
        for k, d in solved.items():
            old = row.get(k, 0.0)
            new = old - c * d
            if abs(new) <= CANCELLATION * (abs(old) + abs(c * d)):
                row.pop(k, None)
                if k < self.unknowns:
                    self._users[k].discard(user)
            else:
                row[k] = new
                if k < self.unknowns:
                    self._users.setdefault(k, set()).add(user)

    def free(self) -> list[int]:
        """Return the unknowns that no row has determined, in order."""
        return [k for k in range(self.unknowns) if k not in self.solved]
