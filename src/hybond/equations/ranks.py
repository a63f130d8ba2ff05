"""Ranks with a margin, and the scaling that makes them mean something.

Stored quantities come in coulombs and metres, resistances in milliohms and megohms; a rank decided
on the raw numbers would be a matter of units. Rows, columns, inputs, outputs and time are first
scaled by powers of two (no rounding) that bring all entries that are not zero as near to 1 as they
can, in the least-squares sense of their logarithms (A. R. Curtis and J. K. Reid, *On the automatic
scaling of matrices for Gaussian elimination*, J. Inst. Maths Applics 10, 1972).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.equations.descriptor import Descriptor

Matrix = NDArray[np.float64]

RANK = 1e-10
"""A singular value below this part of the size of the scaled matrix counts as zero."""
DOUBT = 1e-7
"""A singular value between `RANK` and this part makes a rank doubtful, and so does one that was
counted as zero but is above `NOISE`."""
NOISE = 1e-12
ROUNDING = 1e-14
"""What is made of numbers is right to this part of their sizes; below it, an entry is zero.
Rounding left as an entry would be scaled up until it mattered."""
ENDS = -53.0
"""Binary places below one, in units made without it, under which an entry decides no units: it is
rounding beside the others."""
FAR = 0.5
"""An entry is doubted that is, in units made with all, at least this part as many places below one
as the worst: least squares spread what one entry asks for over others of its row and column, so
the worst need not be the one that spoils the units. `ENDS` then decides, in units without them."""
NEAR = ENDS / 8.0
"""No entry is doubted where `FAR` of the worst is above this, the worst a quarter of `ENDS`: what
is rounding keeps more of its places below one, even in units that are made with it."""
ALL = slice(None)


@dataclass(frozen=True, slots=True)
class Rank:
    """A rank and how clear it is.

    Examples
    --------
    >>> rank_of(np.array([[1.0, 2.0], [2.0, 4.0]])).value
    1
    """

    value: int
    smallest: float = 1.0
    """The smallest singular value that counts, as a part of the size; 1 if there is none."""
    dropped: float = 0.0
    """The largest one that does not count, likewise; 0 if there is none."""

    @property
    def sure(self) -> bool:
        """Whether no singular value lies near the limit."""
        return self.smallest > DOUBT and self.dropped < NOISE

    @property
    def gap(self) -> float:
        """The ratio of the last singular value that counts to the first that does not."""
        return self.smallest / self.dropped if self.dropped else float("inf")


def rank_of(matrix: NDArray[Any], size: float | None = None) -> Rank:
    """Return the rank of a scaled matrix; `size` is what its singular values are measured by."""
    if not matrix.size:
        return Rank(0)
    values = np.linalg.svd(matrix, compute_uv=False)
    return counted(values, float(values[0]) if size is None else size)


def counted(values: NDArray[Any], size: float) -> Rank:
    """Return the rank that descending singular `values` tell."""
    if size == 0.0 or not len(values):
        return Rank(0)
    parts = np.asarray(values, dtype=float) / size
    count = int((parts > RANK).sum())
    smallest = min(float(parts[count - 1]), 1.0) if count else 1.0
    return Rank(count, smallest, float(parts[count]) if count < len(parts) else 0.0)


def worst(*ranks: Rank) -> tuple[float, float]:
    """Return the least clear margins among `ranks`."""
    return min(r.smallest for r in ranks), max(r.dropped for r in ranks)


@dataclass(frozen=True, slots=True)
class Tracked:
    """A matrix with a bound of the rounding in each entry.

    An entry that is no larger than its bound becomes zero, even if what it was made of cancelled
    some operations ago.

    Examples
    --------
    >>> row = Tracked.of(np.array([[0.1, 0.2, -0.3]]))
    >>> (row @ Tracked.of(np.ones((3, 1)))).value
    array([[0.]])
    """

    value: Matrix
    error: Matrix

    @staticmethod
    def of(value: Matrix) -> Tracked:
        """Return given numbers, right to rounding."""
        return Tracked(value, ROUNDING * np.abs(value))

    @staticmethod
    def _made(value: Matrix, error: Matrix) -> Tracked:
        return Tracked(np.where(np.abs(value) > error, value, 0.0), error)

    def __add__(self, other: Tracked) -> Tracked:
        return self._made(self.value + other.value, self.error + other.error)

    def __matmul__(self, other: Tracked) -> Tracked:
        a, b = np.abs(self.value), np.abs(other.value)
        error = a @ other.error + self.error @ b + ROUNDING * (a @ b)
        return self._made(self.value @ other.value, error)

    def __neg__(self) -> Tracked:
        return Tracked(-self.value, self.error)

    def take(
        self, rows: NDArray[np.intp] | slice = ALL, columns: NDArray[np.intp] | slice = ALL
    ) -> Tracked:
        """Return some rows and columns."""
        return Tracked(self.value[rows][:, columns], self.error[rows][:, columns])

    def inverse(self) -> Tracked:
        """Return the inverse of a square matrix."""
        from scipy.linalg import lu

        if not self.value.size:
            return self
        permuted, lower, upper = lu(self.value)
        left = np.asarray(np.linalg.inv(lower), dtype=float) @ permuted.T
        right = np.asarray(np.linalg.inv(upper), dtype=float)
        # the terms of the inverse, fill-in that cancels included
        terms = np.abs(right) @ np.abs(left)
        error = terms @ self.error @ terms + ROUNDING * terms
        return self._made(right @ left, error)


@dataclass(frozen=True, slots=True)
class Scaled:
    """A descriptor in scaled variables: ``v = columns * v_scaled``, ``s = time * s_scaled``.

    The inputs and outputs are scaled as well; by how much does not matter to any rank.
    """

    E: Matrix
    A: Matrix
    B: Matrix
    C: Matrix
    F: Matrix
    columns: Matrix
    time: float


def scaled(d: Descriptor) -> Scaled:
    """Return `d` scaled by powers of two.

    Examples
    --------
    A 1 mF capacitor that 1 kohm discharges: its time constant becomes the unit of time.

    >>> d = Descriptor.of([[1.0]], [[-1.0]], [[1e-3]], states=("q",), inputs=("u",))
    >>> s = scaled(d)
    >>> s.E, s.A, s.B, s.time
    (array([[1.]]), array([[-1.]]), array([[1.024]]), 1.0)
    """
    m, n = d.A.shape
    p, q = d.B.shape[1], len(d.C)
    # unknown exponents: rows of the equations, columns, inputs, outputs, time
    rows, columns, inputs, outputs, time = 0, m, m + n, m + n + p, m + n + p + q
    terms: list[tuple[tuple[tuple[int, float], ...], float]] = []

    def collect(matrix: Matrix, first: int, second: int, *, with_time: bool) -> None:
        for i, j in np.argwhere(matrix):
            which = [(first + int(i), 1.0), (second + int(j), 1.0)]
            if with_time:
                which.append((time, 1.0))
            terms.append((tuple(which), float(np.log2(abs(matrix[i, j])))))

    collect(d.E, rows, columns, with_time=True)
    collect(d.A, rows, columns, with_time=False)
    collect(d.B, rows, inputs, with_time=False)
    collect(d.C, outputs, columns, with_time=False)
    collect(d.F, outputs, columns, with_time=True)
    x = _without_dust(terms, time + 1)
    r, c, u, y = (
        np.exp2(x[k : k + size]) for k, size in ((rows, m), (columns, n), (inputs, p), (outputs, q))
    )
    t = float(np.exp2(x[time]))
    left, right = r[:, None], c[None, :]
    return Scaled(
        E=d.E * left * right * t,
        A=d.A * left * right,
        B=d.B * left * u,
        C=d.C * y[:, None] * right,
        F=d.F * y[:, None] * right * t,
        columns=c,
        time=t,
    )


def _without_dust(
    terms: list[tuple[tuple[tuple[int, float], ...], float]], unknowns: int
) -> NDArray[np.float64]:
    """Return exponents for the terms but those that no units make more than rounding.

    A speed that has died out leaves a coefficient of 1e-37 where a modulus turns with it: units
    that bring it near one make all others rounding.
    """
    x = exponents(terms, unknowns)
    while True:
        logs = [log + sum(c * x[k] for k, c in which) for which, log in terms]
        limit = FAR * min(logs, default=0.0)
        seen = np.zeros(unknowns)
        for which, _ in terms:
            for k, _ in which:
                seen[k] += 1
        left, small = [], []
        for term, log in zip(terms, logs, strict=True):
            own = [k for k, _ in term[0]]
            if log > limit or limit > NEAR or min(seen[own]) <= 1:
                left.append(term)
            else:
                seen[own] -= 1
                small.append(term)
        if not small:
            return x
        # an entry is rounding if units that are made without it say so
        without = exponents(left, unknowns)
        back = [t for t in small if t[1] + sum(c * without[k] for k, c in t[0]) >= ENDS]
        if len(back) == len(small):
            return x
        terms = left + back
        x = exponents(terms, unknowns)


def exponents(
    terms: list[tuple[tuple[tuple[int, float], ...], float]], unknowns: int
) -> NDArray[np.float64]:
    """Return whole exponents x with each ``sum(c * x[k] for k, c in which) + log`` near zero.

    The normal equations are solved for the smallest x, so that what is free stays as written.
    """
    normal = np.zeros((unknowns, unknowns))
    right = np.zeros(unknowns)
    for which, log in terms:
        for k, c in which:
            right[k] -= c * log
            for m, b in which:
                normal[k, m] += c * b
    if not terms:
        return right
    found = np.linalg.lstsq(normal, right, rcond=1e-12)[0]
    return np.asarray(np.round(found))
