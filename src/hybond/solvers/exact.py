"""Exact propagation of linear modes; what is not linear is left to `rk45`."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.polynomial import Polynomial
from hybond.solvers.base import FloatArray, Scale, Step
from hybond.solvers.control import error_norm
from hybond.solvers.dopri import DormandPrince
from hybond.solvers.propagation import PARTS, Propagator


@dataclass(frozen=True, slots=True, eq=False)
class Linear:
    """What a field is, where it is linear: ``z' = M z``.

    Parameters
    ----------
    flow : Propagator
        Of z.
    states : array of int
        The components of the state that z begins with; all others are integrals along them.
    generators : callable
        The other components of z at a time.
    watched : array of int
        Of those, in z, what integrals depend on: steps must resolve it.
    """

    flow: Propagator
    states: NDArray[np.intp]
    generators: Callable[[float], FloatArray]
    watched: NDArray[np.intp]


_X = np.arange(PARTS + 1) / PARTS
_MET = [2, 4, 5]
"""Parts at which the dense output meets the motion, ..."""
_ASKED = 3
"""... and the one where it is asked how far it is off: nearly the farthest between them."""
FIT = np.linalg.inv(np.array([[_X[k] ** p for p in (2, 3, 4)] for k in _MET]))
"""From what a line along the first derivative leaves there to coefficients of ``x^2 ... x^4``."""
SUMS = np.array(
    [[_X[k] ** (p + 1) / (p + 1) for p in range(PARTS + 1)] for k in range(1, PARTS + 1)]
)
SUMS = SUMS @ np.linalg.inv(np.vander(_X, increasing=True))
"""From values at all parts to integrals up to the second, third, ... of them: of order 6."""
START = np.linalg.inv(np.vander(_X, increasing=True))[1]
"""From values at all parts to the slope at the first one."""
BETWEEN = 0.3819660112501051
"""Part at which rates that are integrated along are asked once more: the smaller golden section."""
VALUE, SUM = (
    row @ np.linalg.inv(np.vander(_X, increasing=True))
    for row in (
        np.array([BETWEEN**p for p in range(PARTS + 1)]),
        np.array([BETWEEN ** (p + 1) / (p + 1) for p in range(PARTS + 1)]),
    )
)
"""From values at all parts to the value there, and to the integral up to there."""
FARTHEST = 0.00576
"""How far ``x^5`` is from the dense output that it has, at the part that is asked."""
LOOSE = 100.0
"""What a generator may be off by, in units of `rtol`: powers are integrals of high order of it."""
DOUBTFUL = 64.0 * float(np.finfo(np.float64).eps)
"""Part of a rate, at least, that is rounding, in units of the norm of the matrix."""
ORDERS = (5, 6, 7)
"""Derivatives that choose the first step: one of them is not small by chance."""


class Exact(DormandPrince):
    """Exact propagation where the field is linear and says so; elsewhere `DormandPrince`.

    The ends of steps are exact but for rounding, whatever their size. What limits it is the dense
    output, a polynomial of degree 4 through the state at some parts of a step with its first
    derivative: it is compared with the state at another part. A motion that died away is no longer
    seen, however fast it was.

    Parameters
    ----------
    scale : callable
        ``scale(y0, y1)``: what the dense output of a step may be off by, per component.
    rtol : float
        Relative tolerance behind `scale`.
    max_step : float, optional
        Largest step.

    Attributes
    ----------
    linear : Linear or None
        What the field is; None: not linear. To be set before each start.

    References
    ----------
    C. Moler, C. Van Loan, "Nineteen dubious ways to compute the exponential of a matrix,
    twenty-five years later", SIAM Review 45(1), 2003. A. H. Al-Mohy, N. J. Higham, "Computing the
    action of the matrix exponential", SIAM J. Sci. Comput. 33(2), 2011.

    Examples
    --------
    >>> solver = Exact(lambda y0, y1: 1e-9 + 1e-6 * np.abs(y1), rtol=1e-6)
    >>> none, nothing = np.empty(0, dtype=np.intp), np.empty(0)
    >>> flow = Propagator(np.array([[-1.0]]))
    >>> solver.linear = Linear(flow, np.array([0]), lambda t: nothing, none)
    >>> solver.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    >>> t = 0.0
    >>> while t < 1.0:
    ...     step = solver.step(1.0)
    ...     t = step.t1
    >>> bool(abs(step.y1[0] - np.exp(-1.0)) < 1e-15)
    True
    """

    name = "exact"
    propagates: ClassVar[bool] = True

    def __init__(self, scale: Scale, *, rtol: float, max_step: float = math.inf) -> None:
        super().__init__(scale, max_step=max_step)
        self._rtol = float(rtol)
        self._coefficients: FloatArray = np.empty((4, 0))
        self._amplitude: FloatArray = np.empty(0)
        """The largest value that each watched generator had since the start."""

    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        linear = self.linear
        if linear is not None and (forget or len(self._amplitude) != len(linear.watched)):
            self._amplitude = np.zeros(len(linear.watched))
        super()._begin(t_bound, forget=forget, moved=moved)

    def _first_size(self, scale: FloatArray, limit: float) -> float:
        linear = self.linear
        if linear is None:
            return super()._first_size(scale, limit)
        h = self._first(linear, scale, limit)
        if self._y.size == len(linear.states) + 2:
            return h
        # signals are integrated along: their rates may move faster than what is linear
        return min(h, super()._first_size(scale, limit))

    def _first(self, linear: Linear, scale: FloatArray, limit: float) -> float:
        """Choose the first step from derivatives: halved until its dense output will do."""
        m = len(linear.states)
        z = np.concatenate([self._y[linear.states], linear.generators(self._t)])
        c = np.abs(linear.flow.derivatives(z, ORDERS[-1]))
        allowed = np.full(len(z), np.inf)
        allowed[:m] = scale[linear.states]
        allowed[linear.watched] = LOOSE * self._rtol * np.abs(z[linear.watched])
        relative = np.full(len(z), self._rtol)
        relative[linear.watched] *= LOOSE
        h = limit if limit < math.inf else max(1e3 * linear.flow.unit, 1.0)
        if not math.isfinite(h):
            h = 1.0
        for _ in range(1100):
            # what has not moved yet has no size but that which it will have
            size = sum(c[p - 1] * h**p for p in range(1, ORDERS[0]))
            off = FARTHEST * sum(c[p - 1] * h**p for p in ORDERS)
            if error_norm(off, allowed + relative * size) <= 1.0:
                break
            h *= 0.5
        return h

    def _attempt(
        self, t0: float, y0: FloatArray, f0: FloatArray, t1: float
    ) -> tuple[FloatArray, float, FloatArray]:
        linear = self.linear
        if linear is None:
            return super()._attempt(t0, y0, f0, t1)
        h = t1 - t0
        m, states = len(linear.states), linear.states
        z = linear.flow.parts(np.concatenate([y0[states], linear.generators(t0)]), h)
        y = np.tile(y0, (PARTS + 1, 1))
        y[:, states] = z[:, :m]
        f = self._rates(t0, t1, y, f0)
        along = np.ones(y0.size, dtype=bool)
        along[states] = False
        y[1:, along] += h * (SUMS @ f[:, along])
        first = h * f0
        if h * linear.flow.norm * DOUBTFUL > self._rtol:
            # a slope that is small beside its terms is rounding, times a long step
            first[states] = START @ z[:, :m]
        self._coefficients, vector = _fitted(y, first)
        self._k[0], self._k[6] = f0, f[PARTS]
        y1 = y[PARTS].copy()
        if not (np.isfinite(z).all() and np.isfinite(f).all() and np.isfinite(y1).all()):
            return y1, math.nan, vector
        along[-2:] = False
        if along.any():
            vector[along] = self._between(linear, (t0, h, y0), f, vector, along)
        error = error_norm(vector, self._scale(y0, y1))
        return y1, max(error, self._unresolved(linear, z, h)), vector

    def _rates(self, t0: float, t1: float, y: FloatArray, f0: FloatArray) -> FloatArray:
        """Return the field at all parts of a step; that of integrals along the others counts."""
        field = self._field
        assert field is not None
        h = t1 - t0
        f = np.empty_like(y)
        f[0] = f0
        for k in range(1, PARTS + 1):
            f[k] = field(t1 if k == PARTS else t0 + _X[k] * h, y[k])
        self._evaluations += PARTS
        return f

    def _between(
        self,
        linear: Linear,
        step: tuple[float, float, FloatArray],
        f: FloatArray,
        vector: FloatArray,
        along: NDArray[np.bool_],
    ) -> FloatArray:
        """Return the errors of signals that are integrated along.

        Their rates are asked where no whole number of periods divides the step: at all parts they
        may look alike by chance.
        """
        t0, h, y0 = step
        field = self._field
        assert field is not None
        z = np.concatenate([y0[linear.states], linear.generators(t0)])
        y = y0.copy()
        y[linear.states] = linear.flow.after(z, BETWEEN * h)[: len(linear.states)]
        y[along] += h * (SUM @ f[:, along])
        found = np.array(field(t0 + BETWEEN * h, y))[along]
        self._evaluations += 1
        off = h * np.abs(found - VALUE @ f[:, along])
        return np.asarray(np.fmax(np.abs(vector[along]), np.where(off == off, off, np.inf)))

    def _unresolved(self, linear: Linear, z: FloatArray, h: float) -> float:
        """Return how far the generators that integrals depend on are off, in what they may be."""
        watched = linear.watched
        if not len(watched):
            return 0.0
        g = z[:, watched]
        rates = (linear.flow.matrix[watched] @ (z[0] / linear.flow.scale)) * linear.flow.scale[
            watched
        ]
        _, vector = _fitted(g, h * rates)
        self._amplitude = np.maximum(self._amplitude, np.abs(g[0]))
        size = np.maximum(self._amplitude, np.abs(g).max(axis=0))
        return error_norm(vector, LOOSE * self._rtol * size)

    def _accept(
        self,
        t0: float,
        t1: float,
        y0: FloatArray,
        y1: FloatArray,
        f0: FloatArray,
        error: float,
        rejected: int,
    ) -> Step:
        step = super()._accept(t0, t1, y0, y1, f0, error, rejected)
        if self.linear is None:
            return step
        dense = Polynomial(t0, t1, y0, y1, self._coefficients)
        return Step(t0, t1, y0, y1, dense, error, step.evaluations, rejected)


def _fitted(y: FloatArray, first: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the coefficients of the dense output, and how far it is off where it is asked."""
    left = y - y[0] - _X[:, None] * first
    higher = FIT @ left[_MET]
    x = _X[_ASKED]
    return np.vstack([first, higher]), np.array([x**2, x**3, x**4]) @ higher - left[_ASKED]
