"""Undetermined variables: the member of the admissible set with the least leakage power.

Where the mode equations leave something free (a node that floats between open switches, the
shares of two closed switches in parallel), the value is the one that small leaks would choose:
first the leaks of controlled junctions, then those of the undetermined bonds. With one reference
resistance R0 per domain (1 SI unit) the sum is in watts, so it does not depend on the order of
elements. The result is flagged wherever it is used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.model.graph import FlatGraph

Matrix = NDArray[np.float64]

MOVED = 1e-9
"""A variable is undetermined if a unit of freedom moves it by more than this."""
CANCELS = 1e-13
"""What is below this part of its terms is what rounding leaves of zero."""


def junction_rows(graph: FlatGraph, off: frozenset[int]) -> Matrix:
    """Return the rows whose squares are the leakage power of controlled junctions.

    Blocked effort of an OFF 1-junction, shorted flow of an OFF 0-junction, through flow of an ON
    1-junction, common effort of an ON 0-junction. Shape (controlled junctions, 2 * bonds).
    """
    bonds = len(graph.bonds)
    switched = [n for n in graph.nodes if n.controlled and n.is_junction and n.ends]
    rows = np.zeros((len(switched), 2 * bonds))
    for row, node in zip(rows, switched, strict=True):
        common = 0 if node.kind == "0" else bonds
        if node.index in off:
            for end in node.ends:
                row[bonds - common + end.bond] += end.sign
        else:
            row[common + node.ends[0].bond] = 1.0
    return rows


def undetermined(freedom: Matrix) -> NDArray[np.intp]:
    """Return the bond variables that the columns of `freedom`, shape (n, k), move."""
    if freedom.shape[1] == 0:
        return np.zeros(0, dtype=np.intp)
    size = np.abs(freedom).max(axis=1)
    return np.flatnonzero(size > MOVED * size.max())


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """A matrix P by what it takes off: ``P = (1 - basis2 @ taken2) @ (1 - basis1 @ taken1)``.

    Parameters
    ----------
    stages : tuple of (basis, taken)
        The first one first; arrays of shapes (n, k) and (k, n).
    """

    stages: tuple[tuple[Matrix, Matrix], ...]

    def __matmul__(self, w: Matrix) -> Matrix:
        """Return ``P @ w`` for a vector or a matrix."""
        for basis, taken in self.stages:
            w = w - basis @ (taken @ w)
        return w

    def after(self, m: Matrix) -> Matrix:
        """Return ``m @ P``."""
        for basis, taken in reversed(self.stages):
            m = m - (m @ basis) @ taken
        return m


def least_leakage(freedom: Matrix, junctions: Matrix) -> Projection:
    """Return the projection of any solution onto the one of least leakage.

    Parameters
    ----------
    freedom : array, shape (n, k)
        Directions in which bond variables are free.
    junctions : array, shape (m, n)
        From `junction_rows`.

    Returns
    -------
    Projection
        P with ``w_least = P @ w`` for every admissible w.

    Examples
    --------
    Two closed switches share a current of 1 A:

    >>> import numpy as np
    >>> least_leakage(np.array([[1.0], [-1.0]]), np.eye(2)) @ np.array([1.0, 0.0])
    array([0.5, 0.5])
    """
    stages = []
    basis = freedom
    bonds = undetermined(freedom)
    if junctions.shape[0] and basis.shape[1]:
        seen = without_rounding(junctions @ basis, np.abs(junctions) @ np.abs(basis))
        stages.append((basis, np.linalg.pinv(seen, rcond=MOVED) @ junctions))
        basis = times_orthonormal(basis, null_space(seen))
    if len(bonds) and basis.shape[1]:
        taken = np.zeros((basis.shape[1], len(basis)))
        taken[:, bonds] = np.linalg.pinv(basis[bonds], rcond=MOVED)
        stages.append((basis, taken))
    return Projection(tuple(stages))


def without_rounding(a: Matrix, size: Matrix) -> Matrix:
    """Return `a` with zero where it is no more than rounding of terms of that size."""
    return np.asarray(np.where(np.abs(a) <= CANCELS * size, 0.0, a))


def times_orthonormal(a: Matrix, basis: Matrix) -> Matrix:
    """Return `a` times columns of length 1, by which rounding of them is measured."""
    return without_rounding(a @ basis, np.abs(a).sum(axis=1, keepdims=True))


def null_space(m: Matrix, *, rank: int | None = None, tolerance: float = 1e-10) -> Matrix:
    """Return an orthonormal basis of the null space of `m`, columns, scaled rank decision."""
    if m.shape[0] == 0 or m.shape[1] == 0:
        return np.eye(m.shape[1])
    size = np.abs(m).max(axis=1, keepdims=True)
    scaled = m / np.where(size > 0.0, size, 1.0)
    _, values, vt = np.linalg.svd(scaled)
    if rank is None:
        rank = int((values > tolerance * max(values[0], 1e-300)).sum()) if values.size else 0
    return np.asarray(vt[rank:].T)
