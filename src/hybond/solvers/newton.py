"""Simplified Newton iteration for the stages of a Radau step, and its linear algebra."""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hybond.solvers.base import Field, FloatArray, Scale
from hybond.solvers.collocation import C1, C2, collocation
from hybond.solvers.control import error_norm

Choice: TypeAlias = slice | NDArray[np.intp]
"""Indices of some components; a slice where they are neighbours, which is faster."""

ITERATIONS = 7
"""Iterations after which a smaller step is cheaper."""

_ASSEMBLED = 60
"""Number of states up to which one product by a matrix of three times the size is cheaper."""

_STEADY = 1e-3
"""Relative change of step size that the same factors serve: no slower than what is tolerated."""


class Factors:
    """Inverses of ``real/h - J`` and ``pair/h - J``.

    Inverses and not factors of triangular shape: these systems are small, so that what counts
    is the number of calls; and an error of rounding in them only slows the iteration.

    Parameters
    ----------
    jacobian : ndarray, shape (m, m)
        J.
    h : float
        Step size.

    Raises
    ------
    numpy.linalg.LinAlgError
        If one of the matrices is singular.

    Examples
    --------
    >>> factors = Factors(np.array([[-1.0]]), 1e-3)
    >>> stages = factors.correct(np.ones((3, 1)))
    >>> bool(np.abs(stages[:, 0] / 1e-3 - collocation().c).max() < 1e-3)
    True
    """

    __slots__ = ("_assembled", "_pair", "_real", "h", "jacobian")

    def __init__(self, jacobian: FloatArray, h: float) -> None:
        self.jacobian = jacobian
        self.h = h
        m = len(jacobian)
        method = collocation()
        # In C order, so that the flat array is a view and every (m+1)-th of it the diagonal.
        shifted = np.negative(jacobian, order="C")
        shifted.reshape(-1)[:: m + 1] += method.real / h
        self._real = np.linalg.inv(shifted)
        lifted = shifted.astype(np.complex128)
        lifted.reshape(-1)[:: m + 1] += (method.pair - method.real) / h
        self._pair = np.linalg.inv(lifted)
        self._assembled: FloatArray | None = None
        if m <= _ASSEMBLED:
            parts = np.array((self._real, self._pair.real, self._pair.imag)).reshape(3, m * m)
            blocks = method.projections.dot(parts).reshape(3, 3, m, m)
            self._assembled = blocks.transpose(0, 2, 1, 3).reshape(3 * m, 3 * m)

    def serves(self, jacobian: FloatArray, h: float) -> bool:
        """Return whether these factors are those of `jacobian` and about those of `h`."""
        return self.jacobian is jacobian and abs(h - self.h) <= _STEADY * h

    def correct(self, residual: FloatArray) -> FloatArray:
        """Solve for the correction of the stages, shape (3, m)."""
        if self._assembled is not None:
            correction: FloatArray = self._assembled.dot(residual.reshape(-1))
            return correction.reshape(residual.shape)
        method = collocation()
        real = self._real.dot(method.real_in.dot(residual))
        pair = self._pair.dot(method.pair_in.dot(residual))
        whole: FloatArray = np.outer(method.real_out, real)
        whole += 2.0 * np.outer(method.pair_out, pair).real
        return whole

    def filtered(self, vector: FloatArray) -> FloatArray:
        """Return ``(real/h - J)^-1`` times a vector, shape (m,)."""
        result: FloatArray = self._real.dot(vector)
        return result


class Stages(NamedTuple):
    """Outcome of an iteration.

    Attributes
    ----------
    converged, finite : bool
        Whether it converged; whether all derivatives on the way were finite.
    z : ndarray, shape (3, m)
        Differences of the stages from the start.
    y, f : ndarray, shape (3, n)
        States of the stages, the last correction included, and derivatives without it.
    last : ndarray, shape (3, m)
        The last correction.
    size : float
        Its norm in units of the tolerance.
    rate : float
        Ratio of the last two corrections; 0 if there was one.
    left : float
        Bound of the error left, in units of the last correction; a first guess for the next
        iteration.
    iterations : int
        Three evaluations of the field each.
    """

    converged: bool
    finite: bool
    z: FloatArray
    y: FloatArray
    f: FloatArray
    last: FloatArray
    size: float
    rate: float
    left: float
    iterations: int


def solve_stages(
    field: Field,
    t0: float,
    t1: float,
    y0: FloatArray,
    *,
    z: FloatArray,
    chosen: Choice,
    factors: Factors,
    scale: Scale,
    tolerance: FloatArray,
    enough: float,
    left: float,
) -> Stages:
    """Iterate until the error left is negligible, or until it is clear that it will not be.

    Parameters
    ----------
    field : callable
        The derivative.
    t0, t1 : float
        Start and end of the step.
    y0 : ndarray, shape (n,)
        State at the start.
    z : ndarray, shape (3, m)
        Where to begin.
    chosen : slice or ndarray
        The m components to solve for. The others keep their value: nothing depends on them.
    factors : Factors
        Of a Jacobian at about `y0` and a step size of about ``t1 - t0``.
    scale : callable
        Used where `tolerance` is 0, for a state that leaves 0 in this step.
    tolerance : ndarray, shape (m,)
        Error allowed.
    enough : float
        Part of it that may be left.
    left : float
        `Stages.left` of the iteration before.
    """
    h = t1 - t0
    t_a, t_b = t0 + C1 * h, t0 + C2 * h
    inverse = collocation().inverse / h
    start = y0[chosen]
    y, f = np.empty((3, y0.size)), np.empty((3, y0.size))
    y[:] = y0
    y[:, chosen] += z
    flat = f.reshape(-1)
    left = max(left, 1e-16) ** 0.8
    rate = before = 0.0
    for count in range(1, ITERATIONS + 1):
        f[0] = field(t_a, y[0])
        f[1] = field(t_b, y[1])
        f[2] = field(t1, y[2])
        # The sum of squares sees anything not finite in one call; it overflows before the
        # values do, hence the second look.
        if not math.isfinite(flat.dot(flat)) and not np.isfinite(flat).all():
            return Stages(False, False, z, y, f, z, math.inf, rate, left, count)
        last = factors.correct(f[:, chosen] - inverse.dot(z))
        z = z + last
        y[:, chosen] = start + z
        size = norm(last, tolerance)
        if size == math.inf:
            tolerance = scale(y0, y[2])[chosen]
            size = norm(last, tolerance)
        if count > 1:
            rate = size / before if before > 0.0 else 0.0
            if not rate < 1.0:
                break
            left = rate / (1.0 - rate)
            if rate ** (ITERATIONS - count) * left * size > enough:
                break
        if left * size <= enough:
            return Stages(True, True, z, y, f, last, size, rate, left, count)
        before = size
    return Stages(False, True, z, y, f, last, size, rate, left, count)


def norm(vector: FloatArray, tolerance: FloatArray) -> float:
    """Return the root mean square of ``vector/tolerance``, 0/0 being 0, and nan infinite.

    To be called where warnings of NumPy are off.

    Examples
    --------
    >>> norm(np.array([[3.0, 4.0]]), np.array([1.0, 1.0]))
    3.5355339059327378
    """
    if vector.size == 0:
        return 0.0
    ratios = (vector / tolerance).reshape(-1)
    size = math.sqrt(ratios.dot(ratios) / ratios.size)
    if math.isfinite(size):
        return size
    # A tolerance of zero, an overflow of squares, or the real thing.
    size = error_norm(vector.reshape(-1), np.broadcast_to(tolerance, vector.shape).reshape(-1))
    return math.inf if math.isnan(size) else size
