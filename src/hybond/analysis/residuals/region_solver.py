"""Elimination within one region: unit pivots first, then Euclid's algorithm on what is left."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.analysis.residuals.jets import by_order
from hybond.analysis.residuals.sensor_rows import MONITORED, D, SensorRows
from hybond.analysis.residuals.unit_pivots import (
    degree,
    has_rate,
    solved_for,
    unit_pivot,
)
from hybond.equations.ring import Row, substituted
from hybond.equations.symbolic.rational import Rational

Item = tuple[str, int]
"""``("constraint", position)`` or ``("closing", switch)``: where a row comes from."""


class RegionSolver:
    """Solves rows for the variables of one region in one combination of its switches.

    Attributes
    ----------
    solved : dict
        Variable to what it is.
    open : set of int
        Variables that no row gives without a derivative.
    used : dict
        Row to the variable that it was used for.
    left : dict
        Rows without variables: residuals.
    special : bool
        Whether a coefficient that is zero only at the model's own values was dropped.
    """

    def __init__(
        self,
        given: SensorRows,
        kinds: Sequence[int],
        variables: set[int],
        rows: list[tuple[Item, Row[Rational]]],
    ) -> None:
        self.given = given
        self.ring = given.ring
        self.kinds = kinds
        self.variables = variables
        self.solved: dict[int, Row[Rational]] = {}
        self.used: dict[Item, int] = {}
        self.rows = dict(rows)
        self.special = False
        self.rows = {tag: self._clean(row) for tag, row in self.rows.items()}
        while True:
            unit = self._unit()
            if unit is not None:
                self._solve(*unit)
            elif not self._gather():
                break
        self.open = self.variables - self.solved.keys()
        self.left = {
            tag: row for tag, row in self.rows.items() if row and not row.keys() & self.variables
        }

    def _unit(self) -> tuple[Item, int] | None:
        best: tuple[tuple[object, ...], Item, int] | None = None
        for tag, row in self.rows.items():
            pivot = unit_pivot(self.given, row, self.variables)
            if pivot is None:
                continue
            closing = tag[0] == "closing"
            monitored = not closing and self.kinds[tag[1]] == MONITORED
            order = max(degree(c) for c in row.values())
            measure = (not closing, monitored, order, len(row), tag)
            if best is None or measure < best[0]:
                best = (measure, tag, pivot)
        return None if best is None else (best[1], best[2])

    def _solve(self, tag: Item, pivot: int) -> None:
        value = {pivot: solved_for(self.ring, self.rows.pop(tag), pivot)}
        self.used[tag] = pivot
        for other, row in self.rows.items():
            self.rows[other] = self._clean(substituted(self.ring, row, value))
        for v, row in self.solved.items():
            self.solved[v] = substituted(self.ring, row, value)
        self.solved.update(value)

    def _gather(self) -> bool:
        """Bring a variable whose coefficients have derivatives into one row (Euclid's algorithm).

        Each step adds a multiple of one row to another, so nothing is lost. What is left of the
        variable is the greatest common divisor of its coefficients: if that has no derivative, it
        is solved next; else its row has a solution whatever the rest is, and says nothing.
        """
        places: dict[int, list[Item]] = {}
        for tag, row in self.rows.items():
            for v in row.keys() & self.variables:
                places.setdefault(v, []).append(tag)
        if not places:
            return False
        v = min(places, key=lambda k: (len(places[k]), k))
        tags = places[v]
        while len(tags) > 1:
            pivot = min(tags, key=lambda t: (degree(self.rows[t][v]), len(self.rows[t]), t))
            own = self.rows[pivot]
            for tag in tags:
                if tag == pivot:
                    continue
                row = self.rows[tag]
                while v in row and degree(row[v]) >= degree(own[v]):
                    row = self._divided(row, own, v)
                self.rows[tag] = row
            tags = [t for t in tags if v in self.rows[t]]
        (pivot,) = tags
        if has_rate(self.rows[pivot][v]):
            self.used[pivot] = v
            del self.rows[pivot]
        return True

    def _divided(self, row: Row[Rational], own: Row[Rational], v: int) -> Row[Rational]:
        """Lower the degree of `v` in a row by a multiple of another."""
        mine, other = by_order(row[v]), by_order(own[v])
        top, low = max(mine), max(other)
        minus = self.ring.of(-1.0)
        factor = mine[top] / other[low]
        if top > low:
            factor = factor * Rational.atom(D) ** (top - low)
        return self._clean(self.ring.collect([(self.ring.one, row), (minus * factor, own)]))

    def _clean(self, row: Row[Rational]) -> Row[Rational]:
        """Drop from the coefficients of variables what is zero at the model's own values."""
        found = dict(row)
        for v in row.keys() & self.variables:
            parts = by_order(row[v])
            gone = [n for n, c in parts.items() if self.given.vanishes(c)]
            if not gone:
                continue
            self.special = True
            del found[v]
            kept = Rational.of(0)
            for n, c in parts.items():
                if n not in gone:
                    kept = kept + c * Rational.atom(D) ** n
            if kept:
                found[v] = kept
        return found
