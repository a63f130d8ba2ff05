"""What moves between two quantum events: polynomials of states, quantised states, quadratures."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np

from hybond.solvers.base import FloatArray

_DEGREES = 6
_EXPONENT = np.array([[max(j - k, 0) for j in range(_DEGREES)] for k in range(_DEGREES)])
_BINOMIAL = np.array([[float(comb(j, k)) for j in range(_DEGREES)] for k in range(_DEGREES)])
_DEGREE = np.arange(_DEGREES)


@dataclass(slots=True, eq=False)
class Motion:
    """Polynomials of the time since `t`; row k holds the coefficients of ``s^k``.

    Parameters
    ----------
    t : float
        Their origin.
    x : ndarray, shape (order + 1, n)
        The states.
    q : ndarray, shape (order, n)
        The quantised states.
    r : ndarray, shape (order, m)
        The rates of the quadratures.

    Examples
    --------
    >>> m = Motion(0.0, np.array([[1.0], [2.0]]), np.array([[1.0]]), np.zeros((1, 0)))
    >>> m.later(0.5).x[:, 0], m.quantised(0.5)
    (array([2., 2.]), array([1.]))
    """

    t: float
    x: FloatArray
    q: FloatArray
    r: FloatArray

    def quantised(self, s: float) -> FloatArray:
        """Return the quantised states `s` after the origin, shape (n,)."""
        value: FloatArray = s ** _DEGREE[: len(self.q)] @ self.q
        return value

    def later(self, s: float) -> Motion:
        """Return the same motion with its origin moved by `s`."""
        shift = _BINOMIAL * s**_EXPONENT
        d = len(self.q)
        small = shift[:d, :d]
        return Motion(self.t + s, shift[: d + 1, : d + 1] @ self.x, small @ self.q, small @ self.r)
