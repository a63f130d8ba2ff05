"""What an elimination leaves, as matrices: bond variables by free unknowns and by knowns."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.equations.elimination import Elimination

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(slots=True)
class Solved:
    """``w = free r + known[row] xi``.

    Parameters
    ----------
    free : array, shape (2 * bonds, free unknowns)
    known : array, shape (classes, knowns)
        One row for all bond variables that are equal: a mode of a large graph is mostly this.
    row : array of int, shape (2 * bonds,)
        The row of each bond variable in `known`.
    """

    free: Matrix
    known: Matrix
    row: NDArray[np.intp]
    _terms: tuple[NDArray[np.intp], NDArray[np.intp], Vector] = field(init=False)
    """Row, column and magnitude of what is not zero in `known`, rows in order."""

    @staticmethod
    def of(e: Elimination, knowns: int) -> Solved:
        """Read the rows of an elimination with so many columns of knowns."""
        # the place of each unknown's row among those of representatives, and of each free unknown
        one = np.array(e.representative, dtype=np.intp)
        shared, row = np.unique(one, return_inverse=True)
        place = np.zeros(e.unknowns, dtype=np.intp)
        place[shared] = np.arange(len(shared))
        free = e.free()
        number = np.zeros(e.unknowns, dtype=np.intp)
        number[free] = np.arange(len(free))
        rows: list[int] = []
        columns: list[int] = []
        values: list[float] = []
        for k, terms in e.solved.items():
            rows += [k] * len(terms)
            columns += terms.keys()
            values += terms.values()
        at, column = place[np.array(rows, dtype=np.intp)], np.array(columns, dtype=np.intp)
        value = -np.array(values)
        inner = column < e.unknowns
        n, x = np.zeros((len(shared), len(free))), np.zeros((len(shared), knowns))
        n[at[inner], number[column[inner]]] = value[inner]
        n[place[free], number[free]] = 1.0
        at, column, value = at[~inner], column[~inner] - e.unknowns, value[~inner]
        x[at, column] = value
        found = Solved(n[row], x, row)
        order = np.lexsort((column, at))
        found._terms = at[order], column[order], np.abs(value[order])
        return found

    def by_knowns(self, xi: Vector) -> Vector:
        """Return what `xi` adds to the bond variables: shape (2 * bonds,), or a column each."""
        return np.asarray((self.known @ xi)[self.row])

    def spread(self) -> Matrix:
        """Return the matrix by knowns of all bond variables, shape (2 * bonds, knowns)."""
        return self.known[self.row]

    def sizes(self, xi: Vector) -> Vector:
        """Return the sum of the magnitudes of what each known adds, shape (2 * bonds,)."""
        row, column, size = self._terms
        terms = size * np.abs(xi)[column]
        return np.asarray(np.bincount(row, terms, len(self.known))[self.row], dtype=np.float64)

    def largest(self, xi: Vector) -> Vector:
        """Return the largest magnitude of what one of the first knowns `xi` adds to each."""
        row, column, size = self._terms
        first = column < len(xi)
        found = np.zeros(len(self.known))
        np.maximum.at(found, row[first], size[first] * np.abs(xi)[column[first]])
        return found[self.row]

    def sparse(self, rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp], Vector]:
        """Return where each of some rows begins, columns and values of what is not zero there."""
        first = np.searchsorted(self._terms[0], np.arange(len(self.known) + 1))
        many = first[rows + 1] - first[rows]
        begin = np.concatenate([[0], np.cumsum(many)])
        taken = np.repeat(first[rows] - begin[:-1], many) + np.arange(begin[-1])
        column = self._terms[1][taken]
        return begin, column, self.known[np.repeat(rows, many), column]
