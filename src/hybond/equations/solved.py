"""What an elimination leaves, as matrices: bond variables by free unknowns and by knowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.elimination import Elimination
from hybond.equations.leakage import Projection
from hybond.equations.sparse import Sparse

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Solved:
    """``w = free r + known[row] xi``.

    Parameters
    ----------
    free : array, shape (2 * bonds, free unknowns)
    known : Sparse, shape (classes, knowns)
        One row for all bond variables that are equal: a mode of a large graph is mostly this.
    row : array of int, shape (2 * bonds,)
        The row of each bond variable in `known`.
    """

    free: Matrix
    known: Sparse
    row: NDArray[np.intp]

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
        n = np.zeros((len(shared), len(free)))
        n[at[inner], number[column[inner]]] = value[inner]
        n[place[free], number[free]] = 1.0
        shape = len(shared), knowns
        known = Sparse.of(shape, at[~inner], column[~inner] - e.unknowns, value[~inner])
        return Solved(n[row], known, row)

    def by_knowns(self, xi: Vector) -> Vector:
        """Return what `xi` adds to the bond variables: shape (2 * bonds,), or a column each."""
        return self.known.times(xi)[self.row]

    def spread(self) -> Matrix:
        """Return the matrix by knowns of all bond variables, shape (2 * bonds, knowns)."""
        return self.known.dense()[self.row]

    def after(self, m: Matrix) -> Matrix:
        """Return ``m @ spread()``, for few rows."""
        gathered = np.zeros((self.known.shape[0], len(m)))
        np.add.at(gathered, self.row, m.T)
        return self.known.after(gathered.T)

    def projected(self, project: Projection) -> Solved:
        """Return ``project @ spread()``, a row for each bond variable.

        Only rows that the projection touches fill up.
        """
        free = self.free
        first, column, value = self.known.rows(self.row)
        row = np.repeat(np.arange(len(self.row)), np.diff(first))
        touched = np.zeros(len(self.row), dtype=bool)
        for basis, _ in project.stages:
            touched |= basis.any(axis=1)
        at = np.flatnonzero(touched)
        dense = np.zeros((len(at), self.known.shape[1]))
        begin, inner, own = self.known.rows(self.row[at])
        dense[np.repeat(np.arange(len(at)), np.diff(begin)), inner] = own
        earlier: list[tuple[Matrix, Matrix]] = []
        for basis, taken in project.stages:
            added = self.after(taken)
            for other, by in earlier:
                added = added - (taken @ other) @ by
            dense = dense - basis[at] @ added
            earlier.append((basis, added))
        few, inner = np.nonzero(dense)
        still = ~touched[row]
        known = Sparse.of(
            (len(self.row), self.known.shape[1]),
            np.concatenate([row[still], at[few]]),
            np.concatenate([column[still], inner]),
            np.concatenate([value[still], dense[few, inner]]),
        )
        return Solved(project @ free, known, np.arange(len(self.row)))

    def columns(self, which: NDArray[np.intp]) -> Matrix:
        """Return some columns of `spread`, shape (2 * bonds, len(which))."""
        return self.known.columns(which)[self.row]

    def sizes(self, xi: Vector) -> Vector:
        """Return the sum of the magnitudes of what each known adds, shape (2 * bonds,)."""
        known = self.known
        terms = np.abs(known.value) * np.abs(xi)[known.column]
        found = np.bincount(known.row, terms, known.shape[0])
        return np.asarray(found[self.row], dtype=np.float64)

    def largest(self, xi: Vector) -> Vector:
        """Return the largest magnitude of what one of the first knowns `xi` adds to each."""
        known = self.known
        first = known.column < len(xi)
        found = np.zeros(known.shape[0])
        size = np.abs(known.value[first]) * np.abs(xi)[known.column[first]]
        np.maximum.at(found, known.row[first], size)
        return found[self.row]
