"""A matrix by what is not zero in it: dense underneath where it is small, sparse where not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Places = NDArray[np.intp]

SMALL = 40_000
"""Entries up to which a dense matrix multiplies faster."""


@dataclass(frozen=True, slots=True, eq=False)
class Sparse:
    """Entries row by row: those of row k are ``first[k] <= i < first[k + 1]``.

    Parameters
    ----------
    shape : (int, int)
    first : array of int, shape (rows + 1,)
    column : array of int, shape (entries,)
    value : array, shape (entries,)

    Examples
    --------
    >>> m = Sparse.of((2, 3), [1, 0], [2, 0], [5.0, 4.0])
    >>> m.times(np.array([1.0, 1.0, 2.0]))
    array([ 4., 10.])
    >>> m.columns([2])
    array([[0.],
           [5.]])
    """

    shape: tuple[int, int]
    first: Places
    column: Places
    value: Vector
    row: Places = field(repr=False)
    """The row of each entry."""
    _made: Any = field(repr=False)

    @staticmethod
    def of(
        shape: tuple[int, int],
        rows: Sequence[int] | Places,
        columns: Sequence[int] | Places,
        values: Sequence[float] | Vector,
    ) -> Sparse:
        """Make a matrix of entries in any order, no place twice."""
        row, column = np.array(rows, dtype=np.intp), np.array(columns, dtype=np.intp)
        value = np.array(values, dtype=np.float64)
        order = np.lexsort((column, row))
        row, column, value = row[order], column[order], value[order]
        first = np.searchsorted(row, np.arange(shape[0] + 1))
        if shape[0] * shape[1] <= SMALL:
            made: Any = np.zeros(shape)
            made[row, column] = value
        else:
            from scipy.sparse import csr_array

            made = csr_array((value, column, first), shape=shape)
        return Sparse(shape, first, column, value, row, made)

    def times(self, x: Vector) -> Vector:
        """Return the product with a vector, or with a matrix."""
        return np.asarray(self._made @ x)

    def after(self, m: Matrix) -> Matrix:
        """Return ``m @ self``."""
        return np.asarray(m @ self._made)

    def columns(self, which: Sequence[int] | Places) -> Matrix:
        """Return some columns, dense, shape (rows, len(which))."""
        taken = self._made[:, np.asarray(which, dtype=np.intp)]
        return np.array(taken if isinstance(taken, np.ndarray) else taken.toarray())

    def used(self) -> NDArray[np.bool_]:
        """Return whether each column has an entry that is not zero."""
        found = np.zeros(self.shape[1], dtype=bool)
        found[self.column[self.value != 0.0]] = True
        return found

    def diagonal(self) -> Vector:
        """Return the diagonal."""
        return np.array(self._made.diagonal())

    def block(self, which: Sequence[int] | Places) -> Matrix:
        """Return the square block of some rows and columns, dense."""
        _, column, value = entries = self.rows(which)
        place = {int(k): i for i, k in enumerate(which)}
        found = np.zeros((len(place), len(place)))
        row = np.repeat(np.arange(len(place)), np.diff(entries[0]))
        for i, k, c in zip(row.tolist(), column.tolist(), value.tolist(), strict=True):
            if k in place:
                found[i, place[k]] = c
        return found

    def rows(self, which: Sequence[int] | Places) -> tuple[Places, Places, Vector]:
        """Return where each of some rows begins, columns and values of their entries."""
        taken = np.asarray(which, dtype=np.intp)
        many = self.first[taken + 1] - self.first[taken]
        begin = np.concatenate([[0], np.cumsum(many)])
        at = np.repeat(self.first[taken] - begin[:-1], many) + np.arange(begin[-1])
        return begin, self.column[at], self.value[at]

    def dense(self) -> Matrix:
        """Return the whole matrix, dense, made anew."""
        made = self._made
        return np.array(made if isinstance(made, np.ndarray) else made.toarray())
