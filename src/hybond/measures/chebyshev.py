"""Polynomials through Chebyshev's points: many pieces at once, one row for each.

Values at ``x = cos(pi j / 10)``, in order from -1 to 1, make coefficients, integrals and extremes.
Where the last coefficients are small, the piece is known as well as they are small. See Trefethen,
Approximation Theory and Approximation Practice, chapters 2 to 4 and 18.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

DEGREE = 10
"""Steps of a run are polynomials up to degree 8."""
FINE = 48
"""Parts of a piece between which no two extremes of such a polynomial are expected."""

NODES: Vector = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
NODES[DEGREE // 2] = 0.0
_FINE: Vector = np.linspace(-1.0, 1.0, FINE + 1)


def _values_to_coefficients() -> Vector:
    vandermonde = np.polynomial.chebyshev.chebvander(NODES, DEGREE)
    return np.asarray(np.linalg.inv(vandermonde).T, dtype=np.float64)


_TO_COEFFICIENTS = _values_to_coefficients()
_INTEGRALS: Vector = np.array(
    [2.0 / (1.0 - k * k) if k % 2 == 0 else 0.0 for k in range(DEGREE + 1)], dtype=np.float64
)
WEIGHTS: Vector = _TO_COEFFICIENTS @ _INTEGRALS
"""Of an integral from -1 to 1 (Clenshaw and Curtis)."""
_TO_FINE: Vector = np.asarray(np.polynomial.chebyshev.chebvander(_FINE, DEGREE).T, dtype=np.float64)


def coefficients(values: Vector) -> Vector:
    """Return the coefficients of pieces of which values at `NODES` are given.

    Examples
    --------
    >>> coefficients(2.0 * NODES**2 - 1.0).round(12).tolist()[:4]
    [0.0, 0.0, 1.0, 0.0]
    """
    return np.asarray(values @ _TO_COEFFICIENTS)


def coefficients_of(values: Vector) -> Vector:
    """Return `coefficients`, each row by itself: no bit of it depends on which are beside it."""
    return in_order(values, _TO_COEFFICIENTS)


def in_order(values: Vector, factors: Vector) -> Vector:
    """Return the product of matrices, summed in one order however many rows there are.

    Examples
    --------
    >>> in_order(np.array([[1.0, 2.0]]), np.array([3.0, 4.0])).tolist()
    [11.0]
    """
    wide = factors.ndim == 2
    found = np.zeros((len(values), factors.shape[1]) if wide else len(values))
    for j, row in enumerate(factors):
        column = values[:, j]
        found += column[:, None] * row if wide else column * row
    return found


def tails(c: Vector) -> Vector:
    """Return the largest of the last three coefficients of each piece."""
    return np.asarray(np.abs(c[..., -3:]).max(axis=-1))


def evaluate(c: Vector, x: Vector) -> Vector:
    """Return polynomials, shape (n, 11), each at its own point, shape (n,)."""
    return np.asarray(np.polynomial.chebyshev.chebval(x, c.T, tensor=False))


def turning_points(c: Vector, sign: float) -> tuple[NDArray[np.intp], Vector]:
    """Return where polynomials have maxima of `sign` times themselves, within -1 and 1.

    Returns
    -------
    piece : array of int, shape (found,)
    x : array, shape (found,)

    Examples
    --------
    >>> hill = coefficients(1.0 - (NODES - 0.3) ** 2)[None]
    >>> piece, x = turning_points(hill, 1.0)
    >>> piece.tolist(), x.round(12).tolist()
    ([0], [0.3])
    """
    fine = sign * (c @ _TO_FINE)
    inside = (fine[:, 1:-1] >= fine[:, :-2]) & (fine[:, 1:-1] >= fine[:, 2:])
    flat = (fine[:, 1:-1] == fine[:, :-2]) & (fine[:, 1:-1] == fine[:, 2:])
    piece, at = np.nonzero(inside & ~flat)
    low, high = _FINE[at].copy(), _FINE[at + 2].copy()
    # a top between an end and the next point shows in slopes only
    slope = np.asarray(sign * np.polynomial.chebyshev.chebder(c, axis=1), dtype=float)
    for end, beside in ((0, 1), (-1, -2)):
        first, last = sorted((end, beside))  # from left to right
        falls = evaluate(slope, np.full(len(c), _FINE[last])) < 0.0
        turns = (evaluate(slope, np.full(len(c), _FINE[first])) > 0.0) & falls
        rest = np.flatnonzero(turns & (fine[:, end] >= fine[:, beside]))
        piece = np.concatenate([piece, rest])
        low = np.concatenate([low, np.full(len(rest), _FINE[first])])
        high = np.concatenate([high, np.full(len(rest), _FINE[last])])
    slope = slope[piece]
    for _ in range(54):
        middle = 0.5 * (low + high)
        rising = evaluate(slope, middle) > 0.0
        low, high = np.where(rising, middle, low), np.where(rising, high, middle)
    return piece, 0.5 * (low + high)
