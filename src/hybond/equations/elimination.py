"""Sparse Gauss-Jordan elimination that knows when a row vanished by structure.

Unknown columns are eliminated in the order rows arrive; known columns are only carried along. A
row whose unknowns all cancel is not lost: it is a constraint among the knowns, which is how
dependent storage and contradicting sources show themselves.

Unknowns that are equal (the common variable of a junction's bonds) are one from the start; only one
of them, their representative, has a row.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

Row = dict[int, float]
"""Column to coefficient; the row says that the sum of coefficient times column is zero."""

CANCELLATION = 1e-12
"""A sum below this part of its terms is a cancellation, hence zero."""
CLEAR = 1e-9
"""A sum above this part of its terms has digits enough."""
NOISE = 1e-14
"""A sum below this part of its terms may be nothing but rounding."""


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

    Parameters
    ----------
    unknowns : int
    equal : iterable of (int, int)
        Pairs of unknowns that are equal.
    """

    def __init__(self, unknowns: int, equal: Iterable[tuple[int, int]] = ()) -> None:
        self.unknowns = unknowns
        self.representative = _representatives(unknowns, equal)
        self.solved: dict[int, Row] = {}
        """``unknown + sum(row) = 0``, the row in free unknowns and knowns only."""
        self._users: dict[int, set[int]] = {}
        """Free unknown to the solved unknowns whose rows contain it."""
        self.least = 1.0
        """The smallest part of its terms that some sum left; below `CLEAR` it has few digits."""
        self.dropped = 0.0
        """The largest part of its terms that some sum left and that counts as zero."""
        self._shared: set[int] = set()
        """Solved unknowns whose rows belong to other eliminations as well."""

    def copy(self) -> Elimination:
        """Return an independent copy; rows are copied when one of both changes them."""
        other = Elimination.__new__(Elimination)
        other.unknowns = self.unknowns
        other.representative = self.representative
        other.solved = dict(self.solved)
        other._users = {k: set(v) for k, v in self._users.items()}
        self._shared = set(self.solved)
        other.least, other.dropped = self.least, self.dropped
        other._shared = set(self.solved)
        return other

    def reduce(self, row: Row) -> Row:
        """Return the row with solved unknowns replaced and cancelled terms dropped."""
        total: Row = {}
        size: Row = {}
        for k, c in row.items():
            column = self.representative[k] if k < self.unknowns else k
            inner = self.solved.get(column)
            if inner is None:
                total[column] = total.get(column, 0.0) + c
                size[column] = size.get(column, 0.0) + abs(c)
                continue
            for i, d in inner.items():
                total[i] = total.get(i, 0.0) - c * d
                size[i] = size.get(i, 0.0) + abs(c * d)
        return {k: c for k, c in total.items() if not self._cancels(c, size[k])}

    def _cancels(self, total: float, size: float) -> bool:
        """Whether a sum of terms of that size is zero; note how sure that is."""
        part = abs(total)
        if part > CLEAR * size:
            return False
        zero = part <= CANCELLATION * size
        if not zero:
            self.least = min(self.least, part / size)
        elif part > NOISE * size:
            self.dropped = max(self.dropped, part / size)
        return zero

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
        if user in self._shared:
            self._shared.discard(user)
            row = self.solved[user] = dict(row)
        c = row.pop(pivot)
        for k, d in solved.items():
            old = row.get(k, 0.0)
            new = old - c * d
            if self._cancels(new, abs(old) + abs(c * d)):
                row.pop(k, None)
                if k < self.unknowns:
                    self._users[k].discard(user)
            else:
                row[k] = new
                if k < self.unknowns:
                    self._users.setdefault(k, set()).add(user)

    def put_in(self, known: Mapping[int, Row]) -> None:
        """Replace known columns: ``column + sum(row) = 0``, the rows in other knowns only."""
        for user, row in self.solved.items():
            met = known.keys() & row.keys()
            if not met:
                continue
            total = {k: c for k, c in row.items() if k not in met}
            size = {k: abs(c) for k, c in total.items()}
            for k in sorted(met):
                for i, d in known[k].items():
                    total[i] = total.get(i, 0.0) - row[k] * d
                    size[i] = size.get(i, 0.0) + abs(row[k] * d)
            self.solved[user] = {k: c for k, c in total.items() if not self._cancels(c, size[k])}
            self._shared.discard(user)

    def free(self) -> list[int]:
        """Return the unknowns that no row has determined, in order: of equal ones the first."""
        return [k for k, r in enumerate(self.representative) if k == r and k not in self.solved]


def _representatives(unknowns: int, equal: Iterable[tuple[int, int]]) -> list[int]:
    """Return the first of the unknowns that each one is equal to."""
    first = list(range(unknowns))

    def root(k: int) -> int:
        while first[k] != k:
            first[k] = first[first[k]]
            k = first[k]
        return k

    for a, b in equal:
        a, b = sorted((root(a), root(b)))
        first[b] = a
    return [root(k) for k in range(unknowns)]
