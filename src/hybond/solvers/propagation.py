"""Propagation of ``z' = M z`` by the exponential of the matrix, for any time at once.

Up to a *unit* of time, about the inverse of the norm, a state is propagated by its Taylor series.
For longer there are levels: the exponentials for a unit, two, four, ..., each less the identity,
made when they are needed and kept. Less the identity, because slow motions beside a fast one hardly
change in a unit: squared as ``(I + D)^2 - I = 2 D + D^2``, what they do is not lost in rounding.

The matrix is balanced first, by powers of two: in other units the norm is often much smaller.
"""

from __future__ import annotations

import math

import numpy as np

from hybond.solvers.base import FloatArray

TERMS = 24
"""Terms of a series; in one unit they fall below rounding before."""
SMALL = 2.0**-60
"""Part of the state below which a term is nothing."""
LEVELS = 60
"""Levels at the most."""
SWEEPS = 12
"""Passes over the rows while balancing."""
PARTS = 5
"""Parts of a step in which its dense output is made from."""


def balanced(matrix: FloatArray) -> FloatArray:
    """Return scales `d`, powers of two, for which ``M[i, j] d[j]/d[i]`` has even rows and columns.

    After Osborne (1960), with the rule of Parlett and Reinsch (1969).

    Examples
    --------
    >>> balanced(np.array([[0.0, 1e6], [1e-6, 0.0]])).tolist()
    [1048576.0, 1.0]
    """
    size = np.abs(matrix)
    np.fill_diagonal(size, 0.0)
    d = np.ones(len(size))
    for _ in range(SWEEPS):
        settled = True
        for i in range(len(size)):
            row, column = float(size[i].sum()), float(size[:, i].sum())
            if row == 0.0 or column == 0.0:
                continue
            exponent = round(0.5 * math.log2(row / column))
            factor = 2.0**exponent
            if exponent and column * factor + row / factor < 0.95 * (row + column):
                size[:, i] *= factor
                size[i] /= factor
                d[i] *= factor
                settled = False
        if settled:
            break
    return d


class Propagator:
    """The flow of one matrix.

    Parameters
    ----------
    matrix : array, shape (n, n)

    Attributes
    ----------
    scale : array, shape (n,)
        ``z = scale * b``, in which the matrix is balanced.
    matrix : array, shape (n, n)
        Of ``b``.
    norm : float
        Of the balanced matrix: the largest sum of magnitudes in a row.
    unit : float
        A power of two, s; the norm times it is no more than 1.

    Examples
    --------
    >>> turn = Propagator(np.array([[0.0, 1.0], [-1.0, 0.0]]))
    >>> np.round(turn.after(np.array([1.0, 0.0]), np.pi), 12) + 0.0
    array([-1.,  0.])
    """

    def __init__(self, matrix: FloatArray) -> None:
        self.scale = balanced(matrix)
        self.matrix = matrix * self.scale / self.scale[:, None]
        self.norm = float(np.abs(self.matrix).sum(axis=1).max(initial=0.0))
        exponent = math.ceil(math.log2(self.norm)) if 0.0 < self.norm < math.inf else 0
        self.unit = 2.0**-exponent if self.norm else math.inf
        self._levels: list[FloatArray] = []

    def after(self, z: FloatArray, h: float) -> FloatArray:
        """Return the state a time `h` later."""
        return np.asarray(self._after(z / self.scale, h) * self.scale)

    def parts(self, z: FloatArray, h: float) -> FloatArray:
        """Return the states at 0, 1, ... `PARTS` parts of a time `h`, a row each."""
        b = z / self.scale
        if h <= self.unit:
            terms = self._series(b, h)
            x = np.arange(PARTS + 1)[:, None] / PARTS
            rows = b + (x ** np.arange(1, len(terms) + 1)) @ terms
        else:
            ends = [h * k / PARTS for k in range(PARTS)] + [h]
            rows = np.empty((PARTS + 1, len(z)))
            rows[0] = b
            for k in range(PARTS):
                rows[k + 1] = self._after(rows[k], ends[k + 1] - ends[k])
        return np.asarray(rows * self.scale)

    def derivatives(self, z: FloatArray, most: int) -> FloatArray:
        """Return the derivatives 1, 2, ... `most` of the state, each over its factorial: rows."""
        b = z / self.scale
        rows = np.empty((most, len(z)))
        for k in range(most):
            b = rows[k] = self.matrix @ b / (k + 1.0)
        return np.asarray(rows * self.scale)

    def _after(self, b: FloatArray, h: float) -> FloatArray:
        whole = int(h / self.unit) if self.unit < math.inf else 0
        if whole >> LEVELS:
            return np.full_like(b, np.nan)
        for k in reversed(range(whole.bit_length())):
            if whole >> k & 1:
                b = b + self._level(k) @ b
        return np.asarray(b + self._series(b, h - whole * self.unit if whole else h).sum(axis=0))

    def _series(self, b: FloatArray, h: float) -> FloatArray:
        """Return the terms of the Taylor series but for the first."""
        terms = np.zeros((TERMS, len(b)))
        total, term = b, b
        for k in range(TERMS):
            term = terms[k] = (h / (k + 1.0)) * (self.matrix @ term)
            # each component for itself: a small one may stand beside a large one all the time
            total = total + term
            if not (np.abs(term) > SMALL * np.abs(total)).any():
                return terms[: k + 1]
        return terms

    def _level(self, k: int) -> FloatArray:
        """Return the exponential for ``2^k`` units, less the identity."""
        if not self._levels:
            step = self.matrix * self.unit
            power, total = np.eye(len(step)), np.zeros_like(step)
            for j in range(TERMS):
                power = power @ step / (j + 1.0)
                total += power
            self._levels.append(total)
        while len(self._levels) <= k:
            d = self._levels[-1]
            self._levels.append(2.0 * d + d @ d)
        return self._levels[k]
