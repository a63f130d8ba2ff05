"""Elimination of what no sensor sees, without dividing by the time derivative.

An unknown is solved only from a row in which its coefficient has no derivative. Such steps can be
undone, so nothing is lost and nothing added: what remains holds for exactly the motions for which
the rows did. (Dividing by a polynomial in the derivative would add equations: two equal
low-pass filters of one input have equal outputs only if they started equal.)

Order: sensors say what their junctions' variables are; then laws and junctions without sensors,
shortest first; where all rows left have two unknowns or more, one is torn. The balance of a
junction with a sensor is used last: it is to remain, as the residual of that junction.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Sequence

from hybond.analysis.residuals.sensor_rows import LAW, MONITORED, D, SensorRows
from hybond.equations.ring import Row, Symbols, substituted
from hybond.equations.symbolic.rational import Rational


def has_rate(c: Rational) -> bool:
    """Whether the time derivative occurs in a coefficient."""
    return D in c.atoms()


def degree(c: Rational) -> int:
    """Return the highest derivative in a coefficient, a polynomial in it."""
    highest = dict(c.monomial).get(D, 0)
    for factor, power in c.factors.items():
        highest += power * max(dict(m).get(D, 0) for m in factor.terms)
    return highest


class UnitPivots:
    """Eliminates the unknowns of `rows` as far as the sensors reach.

    Attributes
    ----------
    constraints : list of (int, Row)
        Number of a row that is left and the row, among knowns, switch variables and `free`.
    free : list of int
        Unknowns that remain.
    """

    def __init__(self, given: SensorRows) -> None:
        self.given = given
        self.ring: Symbols = given.ring
        self.kept = given.known.keys() | given.switches.keys()
        self.solved: dict[int, Row[Rational]] = {}
        self.tears: list[int] = []
        self.constraints: list[tuple[int, Row[Rational]]] = []
        self._peel()
        self._close()
        for row in given.closing.values():
            # an unknown that only a switched law reads
            for k in row or ():
                if k not in self.kept and k not in self.solved:
                    self.tears.append(k)
                    self.solved[k] = {k: self.ring.one}
        self.free = [t for t in self.tears if self.solved[t] == {t: self.ring.one}]

    def value(self, column: int) -> Row[Rational]:
        """Return an unknown in terms of knowns, switch variables and what is free."""
        if column in self.kept:
            return {column: self.ring.one}
        return self._settled(self.solved.get(column, {column: self.ring.one}))

    def reduce(self, row: Row[Rational]) -> Row[Rational]:
        """Return a row with all unknowns replaced by their values."""
        return self._settled(self._reduced(row))

    def _reduced(self, row: Row[Rational]) -> Row[Rational]:
        return substituted(self.ring, row, {k: self.solved[k] for k in row if k in self.solved})

    def _settled(self, row: Row[Rational]) -> Row[Rational]:
        closed = {
            k: self.solved[k]
            for k in row
            if k in self.solved and self.solved[k] != {k: self.ring.one}
        }
        return substituted(self.ring, row, closed)

    # -- peeling

    def _peel(self) -> None:
        rows, kinds = self.given.rows, self.given.kinds
        at: dict[int, list[int]] = {}
        for r, row in enumerate(rows):
            for k in row:
                if k not in self.kept:
                    at.setdefault(k, []).append(r)
        ready: list[tuple[int, int, int, int]] = []
        done = [False] * len(rows)

        def offer(r: int) -> None:
            if done[r]:
                return
            row = rows[r]
            unknown = [k for k in row if k not in self.kept and k not in self.solved]
            if len(unknown) != 1 or kinds[r] == MONITORED:
                return
            c = row[unknown[0]]
            if not has_rate(c) and not self.given.vanishes(c):
                value = self._reduced({k: c for k, c in row.items() if k != unknown[0]})
                order = max((degree(c) for c in value.values()), default=0)
                heapq.heappush(ready, (kinds[r], order, len(value), r))

        for r in range(len(rows)):
            offer(r)
        while True:
            while ready:
                r = heapq.heappop(ready)[-1]
                unknown = [k for k in rows[r] if k not in self.kept and k not in self.solved]
                if done[r] or not unknown:
                    continue
                done[r] = True
                (k,) = unknown
                self.solved[k] = solved_for(self.ring, self._reduced_but(rows[r], k), k)
                for other in at[k]:
                    offer(other)
            tear = self._tear(at, done)
            if tear is None:
                break
            self.tears.append(tear)
            self.solved[tear] = {tear: self.ring.one}
            for other in at[tear]:
                offer(other)
        self._left = [r for r in range(len(rows)) if not done[r]]

    def _reduced_but(self, row: Row[Rational], column: int) -> Row[Rational]:
        rest = self._reduced({k: c for k, c in row.items() if k != column})
        return {**rest, column: row[column]}

    def _tear(self, at: dict[int, list[int]], done: Sequence[bool]) -> int | None:
        """Return the unknown that opens most rows, laws and plain junctions first."""
        kinds = self.given.kinds
        best: tuple[int, int, int] | None = None
        for k, where in at.items():
            if k in self.solved:
                continue
            open_ = [r for r in where if not done[r]]
            near = sum(kinds[r] != MONITORED for r in open_)
            mine = (near, len(open_), -k)
            if best is None or mine > best:
                best = mine
        return None if best is None else -best[2]

    # -- closing loops

    def _close(self) -> None:
        """Solve tears from the rows that are left; what then remains are constraints."""
        ring = self.ring
        open_ = {r: self._reduced(self.given.rows[r]) for r in self._left}
        tears = set(self.tears)
        while True:
            found = self._best(open_, tears)
            if found is None:
                break
            r, tear = found
            value = {tear: solved_for(ring, open_.pop(r), tear)}
            tears.discard(tear)
            for other in [j for j, row in open_.items() if tear in row]:
                open_[other] = substituted(ring, open_[other], value)
            for other in self.tears:
                if tear in self.solved[other]:
                    self.solved[other] = substituted(ring, self.solved[other], value)
            self.solved[tear] = value[tear]
        self.constraints = [(r, row) for r, row in open_.items() if row]

    def _best(
        self, open_: dict[int, Row[Rational]], tears: Collection[int]
    ) -> tuple[int, int] | None:
        kinds, switches = self.given.kinds, self.given.switches
        best: tuple[tuple[int, ...], int, int] | None = None
        for r, row in open_.items():
            pivot = unit_pivot(self.given, row, tears)
            if pivot is None:
                continue
            order = max(degree(c) for c in row.values())
            measure = (
                max(kinds[r], LAW),
                any(k in switches for k in row),
                order,
                len(row),
                r,
            )
            if best is None or measure < best[0]:
                best = (measure, r, pivot)
        return None if best is None else (best[1], best[2])


def unit_pivot(given: SensorRows, row: Row[Rational], columns: Collection[int]) -> int | None:
    """Return the column with the best coefficient that has no derivative."""
    fit = [
        (given.ring.cost(c), abs(k), k)
        for k, c in row.items()
        if k in columns and not has_rate(c) and not given.vanishes(c)
    ]
    return min(fit)[2] if fit else None


def solved_for(ring: Symbols, row: Row[Rational], column: int) -> Row[Rational]:
    """Return the value of `column` that a row gives."""
    c = row[column]
    if c == ring.of(-1.0):
        return {k: d for k, d in row.items() if k != column}
    return {k: -d / c for k, d in row.items() if k != column}
