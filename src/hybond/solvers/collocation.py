"""The three-stage Radau IIA method: its coefficients, and what follows from them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from hybond.solvers.base import FloatArray

_S6 = math.sqrt(6.0)

C1, C2 = (4.0 - _S6) / 10.0, (4.0 + _S6) / 10.0
"""The abscissae before the last one, which is 1."""

_BUTCHER = np.array(
    [
        [(88 - 7 * _S6) / 360, (296 - 169 * _S6) / 1800, (-2 + 3 * _S6) / 225],
        [(296 + 169 * _S6) / 1800, (88 + 7 * _S6) / 360, (-2 - 3 * _S6) / 225],
        [(16 - _S6) / 36, (16 + _S6) / 36, 1 / 9],
    ]
)

_POWERS = np.array([1.0, 2.0, 3.0])


@dataclass(frozen=True, slots=True, eq=False)
class Collocation:
    """What the solver needs of the method, computed once.

    The inverse of the Butcher matrix has one real and two conjugate eigenvalues. In the basis
    of its eigenvectors the linear system of a Newton iteration, of size 3m, falls apart into a
    real one and a complex one of size m.

    Attributes
    ----------
    c : ndarray, shape (3,)
        Abscissae of the stages.
    a, inverse : ndarray, shape (3, 3)
        The Butcher matrix and its inverse.
    real, pair : float, complex
        Eigenvalues of `inverse`: the real one, and that of the pair with positive imaginary
        part.
    real_out, real_in : ndarray, shape (3,)
        Eigenvector of the real one, and the row that gives its coordinate.
    pair_out, pair_in : ndarray, shape (3,), complex
        The same for `pair`.
    projections : ndarray, shape (9, 3)
        Outer products of the above as rows of (3, 3) matrices: that of the real eigenvalue,
        twice the real part and minus twice the imaginary part of that of the pair.
    error : ndarray, shape (3,)
        Weights of the stages in the error estimate, see `collocation`.
    polynomial : ndarray, shape (3, 3)
        From stages to the coefficients of x, x^2, x^3 of the collocation polynomial.
    """

    c: FloatArray
    a: FloatArray
    inverse: FloatArray
    real: float
    pair: complex
    real_out: FloatArray
    real_in: FloatArray
    pair_out: NDArray[np.complex128]
    pair_in: NDArray[np.complex128]
    projections: FloatArray
    error: FloatArray
    polynomial: FloatArray


@cache
def collocation() -> Collocation:
    """Return the method; computed at first use, because most runs are explicit.

    Notes
    -----
    The error is measured by a second formula of order 3, which takes the derivative at the
    start with the weight ``g = 1/real``. Its weights differ from those of the method by d with
    ``sum(d) = -g``, ``sum(d*c) = sum(d*c**2) = 0``. With the derivatives of the stages
    written as ``inverse @ z/h`` and the filter ``1/(1 - h*g*J)``, which keeps the estimate
    bounded for stiff components, it is ``(real/h - J)^-1 (f0 + error @ z/h)``.

    Examples
    --------
    >>> m = collocation()
    >>> round(m.real, 6), complex(round(m.pair.real, 6), round(m.pair.imag, 6))
    (3.637834, (2.681083+3.050430j))
    """
    c = np.array([C1, C2, 1.0])
    inverse = np.linalg.inv(_BUTCHER)
    values, vectors = np.linalg.eig(inverse)
    # By size of the imaginary part, not by the order in which the library lists them.
    k, p = int(np.argmin(np.abs(values.imag))), int(np.argmax(values.imag))
    rows = np.linalg.inv(vectors)
    real_out, real_in = vectors[:, k].real, rows[k].real
    # The real eigenvector comes with an arbitrary complex phase of +1 or -1: out and in cancel.
    pair_out, pair_in = vectors[:, p], rows[p]
    outer = 2.0 * np.outer(pair_out, pair_in)
    parts = np.array([np.outer(real_out, real_in), outer.real, -outer.imag])
    real = float(values[k].real)
    moments = np.linalg.solve(c ** (_POWERS[:, None] - 1.0), np.array([-1.0 / real, 0.0, 0.0]))
    return Collocation(
        c=c,
        a=_BUTCHER,
        inverse=inverse,
        real=real,
        pair=complex(values[p]),
        real_out=real_out,
        real_in=real_in,
        pair_out=pair_out,
        pair_in=pair_in,
        projections=np.ascontiguousarray(parts.reshape(3, 9).T),
        error=real * (moments @ inverse),
        polynomial=np.linalg.inv(c[:, None] ** _POWERS),
    )


def continued(coefficients: FloatArray, ratio: float, origin: float) -> FloatArray:
    """Return the stages that a collocation polynomial foresees for another step.

    Parameters
    ----------
    coefficients : ndarray, shape (3, m)
        Of ``x, x^2, x^3``, x in units of the step it belongs to.
    ratio : float
        Size of the other step in units of that one.
    origin : float
        Where the other step starts: 1 for the end of that one, 0 for its start.

    Returns
    -------
    ndarray, shape (3, m)
        Differences from the value at `origin`.

    Examples
    --------
    >>> line = np.array([[2.0], [0.0], [0.0]])
    >>> continued(line, 0.5, 1.0)[2]
    array([1.])
    """
    x = origin + ratio * collocation().c
    square = x * x
    stages: FloatArray = (np.array((x, square, square * x)) - origin).T.dot(coefficients)
    return stages
