"""Solving a sparse linear structure by peeling rows, tearing where they form loops.

A row with one unknown left gives that unknown in terms of what is known; the network around it
follows, at a cost of the ends touched. Where every row left has two unknowns or more (an
algebraic loop, storage that depends on other storage), one unknown is *torn*: taken as known
until a row closes the loop and gives it. A row that closes without a tear in it is a constraint
among the knowns, and a tear that nothing closes is free: both are results, not errors.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from typing import Generic, TypeVar

from hybond.equations.ring import Ring, Row

T = TypeVar("T")


class Peeling(Generic[T]):
    """Unknown columns ``0 .. unknowns - 1``; all other columns are known.

    Parameters
    ----------
    ring : Ring
        The coefficients.
    rows : sequence of Row
        Each says that the sum of coefficient times column is zero.

    Attributes
    ----------
    constraints : list of Row
        Rows among knowns (and free tears) that the structure implies.

    Examples
    --------
    >>> from hybond.equations.ring import Numbers
    >>> p = Peeling(Numbers({}), [{0: 1.0, 1: 1.0, 2: -1.0}, {0: 1.0, 1: -1.0}], 2)
    >>> p.value(0), p.value(1)  # a + b = u, a = b: a loop of two rows
    ({2: 0.5}, {2: 0.5})
    """

    def __init__(self, ring: Ring[T], rows: Sequence[Row[T]], unknowns: int) -> None:
        self.ring = ring
        self.rows = rows
        self.unknowns = unknowns
        self.constraints: list[Row[T]] = []
        self._solved: dict[int, Row[T]] = {}
        self._tears: dict[int, Row[T] | None] = {}
        """A torn unknown, and its value once a loop has closed."""
        self._users: dict[int, set[int]] = {}
        """Open tear to the closed tears whose values contain it."""
        self._run()

    def value(self, column: int) -> Row[T]:
        """Return an unknown in terms of knowns and free tears."""
        row = self._solved[column]
        settled = self._settle(row)
        if settled is not row:
            self._solved[column] = settled
        return settled

    def reduce(self, row: Row[T]) -> Row[T]:
        """Return a row with all unknowns replaced by their values."""
        if not any(k < self.unknowns for k in row):
            return row
        parts: list[tuple[T, Row[T]]] = []
        plain: Row[T] = {}
        for k, c in row.items():
            if k < self.unknowns:
                parts.append((c, self.value(k)))
            else:
                plain[k] = c
        return self.ring.collect([(self.ring.one, plain), *parts])

    def free(self) -> list[int]:
        """Return the tears that nothing determines, in order."""
        return sorted(k for k, row in self._tears.items() if row is None)

    # -- the run

    def _run(self) -> None:
        n = self.unknowns
        rows = self.rows
        left = [sum(1 for k in row if k < n) for row in rows]
        at: list[list[int]] = [[] for _ in range(n)]
        for r, row in enumerate(rows):
            for k in row:
                if k < n:
                    at[k].append(r)
        ready = [r for r in range(len(rows) - 1, -1, -1) if left[r] <= 1]
        done = [False] * len(rows)
        waiting = [(left[r], r) for r in range(len(rows)) if left[r] > 1]
        heapq.heapify(waiting)
        nowhere = iter([k for k in range(n) if not at[k]])

        def mark(column: int) -> None:
            for r in at[column]:
                left[r] -= 1
                if done[r]:
                    continue
                if left[r] <= 1:
                    ready.append(r)
                else:
                    heapq.heappush(waiting, (left[r], r))

        while True:
            while ready:
                r = ready.pop()
                if done[r]:
                    continue
                done[r] = True
                column = self._take(rows[r])
                if column is not None:
                    mark(column)
            while waiting and (done[waiting[0][1]] or left[waiting[0][1]] != waiting[0][0]):
                heapq.heappop(waiting)
            if waiting:
                row = rows[waiting[0][1]]
                open_ = [k for k in row if k < n and k not in self._solved]
                tear = max(open_, key=lambda k: (sum(not done[r] for r in at[k]), -k))
            else:
                last = next(nowhere, None)
                if last is None:
                    return
                tear = last
            self._tears[tear] = None
            self._solved[tear] = {tear: self.ring.one}
            mark(tear)

    def _take(self, row: Row[T]) -> int | None:
        """Use a row with at most one unknown; return the unknown that it gives, if any."""
        open_ = [k for k in row if k < self.unknowns and k not in self._solved]
        if not open_:
            self._close(self.reduce(row))
            return None
        (column,) = open_
        ring = self.ring
        c = row[column]
        others = {k: d for k, d in row.items() if k != column}
        if len(others) == 1:
            # the common variable of a junction: share the row, do not copy it
            ((k, d),) = others.items()
            factor = -d / c  # type: ignore[operator]
            value = self.value(k) if k < self.unknowns else {k: ring.one}
            self._solved[column] = (
                value if factor == ring.one else {j: factor * v for j, v in value.items()}
            )
        else:
            value = self.reduce(others)
            self._solved[column] = {k: -v / c for k, v in value.items()}  # type: ignore[operator]
        return column

    def _close(self, row: Row[T]) -> None:
        """A row without unknowns: it gives a tear, or it is a constraint."""
        tears = {k: c for k, c in row.items() if k < self.unknowns}
        if not tears:
            if row:
                self.constraints.append(row)
            return
        sizes = {k: self.ring.size(c) for k, c in tears.items()}
        biggest = max(sizes.values())
        fit = [k for k in tears if sizes[k] >= 0.1 * biggest > 0.0]
        if not fit:
            self.constraints.append(row)
            return
        pivot = min(
            fit,
            key=lambda k: (
                not self.ring.steady(tears[k]),
                self.ring.cost(tears[k]),
                len(self._users.get(k, ())),
                k,
            ),
        )
        c = row[pivot]
        value = {k: -d / c for k, d in row.items() if k != pivot}  # type: ignore[operator]
        self._tears[pivot] = value
        for user in sorted(self._users.pop(pivot, ())):
            old = self._tears[user]
            assert old is not None
            if pivot not in old:  # it has cancelled when another tear of that value closed
                continue
            self._tears[user] = self._replaced(old, pivot, value)
            self._use(user)
        self._use(pivot)

    def _use(self, closed: int) -> None:
        for k in self._tears[closed] or {}:
            if k < self.unknowns:
                self._users.setdefault(k, set()).add(closed)

    def _replaced(self, row: Row[T], tear: int, value: Row[T]) -> Row[T]:
        rest = {k: c for k, c in row.items() if k != tear}
        return self.ring.collect([(self.ring.one, rest), (row[tear], value)])

    def _settle(self, row: Row[T]) -> Row[T]:
        """Return `row` with closed tears replaced."""
        closed = [k for k in row if k < self.unknowns and self._tears[k] is not None]
        if not closed:
            return row
        rest = {k: c for k, c in row.items() if k not in closed}
        parts = [(row[k], self._tears[k] or {}) for k in closed]
        return self.ring.collect([(self.ring.one, rest), *parts])

    def settled(self, row: Row[T]) -> Row[T]:
        """Return a row of knowns and tears with the tears that have closed since replaced."""
        return self._settle(row)
