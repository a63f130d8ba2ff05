"""How states change along given quantised states: an affine field by its matrix, others by fits.

A field is a function that evaluates everything at once, and says not what depends on what. If it
has been found to be affine in the states and constant in time (`Affine`), a quantum event of one
state adds one column of the matrix to the derivatives, and the field itself is asked once per
step, to confirm the matrix. If not (`Fitted`), the field is sampled along the quantised states at
as many times as the method has orders, and once at the end of the step, to confirm the fit: this
is also how inputs that are functions of time are followed.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.solvers.base import FloatArray, StepFailure, first_not_finite
from hybond.solvers.qss_motion import Motion

Evaluate = Callable[[float, FloatArray], FloatArray]
"""Time and controlled states to all derivatives."""
Indices = NDArray[np.intp]

CONFIRMED = 1e-9
"""The field confirms a matrix if it differs by less than this part of the size of the terms."""
NOTHING = 1e-6
"""Part of a quantum by which a step may be off without a second look."""
SAME = 1e-9
"""Part of a step by which it may differ from the time that was fitted."""
_FIT = 0.1
"""Part of a quantum that the error of a fit at the end of a step, if it lasted, may make."""
_SAFETY, _SHRINK, _GROW = 0.9, 0.1, 4.0

NODES: dict[int, FloatArray] = {
    n: 0.5 * np.polynomial.legendre.leggauss(n)[0] + 0.5 for n in (1, 2, 3)
}
"""Gauss nodes on [0, 1]: the error of a fit on them has no integral, to a high order."""
_TO_COEFFICIENTS = {n: np.linalg.inv(np.vander(c, increasing=True)) for n, c in NODES.items()}


class Rates(ABC):
    """The derivatives of a motion.

    Attributes
    ----------
    jacobian : ndarray, shape (n, n)
        Derivatives by states; exact or an estimate.
    rows : list of ndarray
        Per state, the states whose derivatives it enters.
    until : float
        Time to which the rates in a motion are good, and how far a step may go.
    """

    exact: bool

    def __init__(self, evaluate: Evaluate, states: Indices, rest: Indices, matrix: FloatArray):
        self.evaluate = evaluate
        self.states = states
        self.rest = rest
        self.jacobian = matrix
        self.until = math.inf
        everyone = np.arange(len(matrix))
        self.rows = [np.flatnonzero(matrix[:, i]) for i in everyone]

    def moved(self, motion: Motion, i: int, change: FloatArray) -> Indices:
        """Add what a change of quantised state `i` does, by its column; return the rows."""
        rows = self.rows[i]
        column = self.jacobian[rows, i]
        for k, c in enumerate(change.tolist()):
            motion.x[k + 1, rows] += column * (c / (k + 1))
        return rows

    @abstractmethod
    def first(self, t: float, x: FloatArray) -> FloatArray:
        """Return the derivatives at states `x`."""

    @abstractmethod
    def renew(self, motion: Motion, horizon: float, moved: tuple[int, float] | None) -> None:
        """Write the derivatives along ``motion.q`` for `horizon` seconds into the motion.

        `moved`: the one state whose quantised state has just changed, and by how much.
        """

    @abstractmethod
    def confirm(self, motion: Motion, h: float, quanta: FloatArray) -> bool:
        """Ask the field whether the motion is right up to `h`; if not, it is not to be made."""

    @abstractmethod
    def quadratures(self, motion: Motion, h: float) -> FloatArray:
        """Return the coefficients of the rates of quadratures for a step, shape (order, m)."""


@dataclass(frozen=True, slots=True, eq=False)
class Quadratic:
    """Rates of quadratures that are quadratic in the states: ``c + g d + d H d``, d = y - y0."""

    origin: FloatArray
    constant: FloatArray
    gradient: FloatArray
    hessian: FloatArray

    def at(self, q: FloatArray) -> FloatArray:
        """Return the rates at k states, (k, n) to (k, m)."""
        d = q - self.origin
        value: FloatArray = (
            self.constant + d @ self.gradient.T + np.einsum("ki,mij,kj->km", d, self.hessian, d)
        )
        return value

    def size(self, q: FloatArray) -> FloatArray:
        """Return the sum of the magnitudes of the terms at one state, (n,) to (m,)."""
        d = np.abs(q - self.origin)
        value: FloatArray = (
            np.abs(self.constant) + np.abs(self.gradient) @ d + np.abs(self.hessian) @ d @ d
        )
        return value


class Affine(Rates):
    """``x' = A q + b``: a quantum event costs a column of A."""

    exact = True
    _refresh = 64
    """Events after which rounding of the additions is wiped out."""

    def __init__(
        self,
        evaluate: Evaluate,
        states: Indices,
        rest: Indices,
        matrix: FloatArray,
        constant: FloatArray,
        form: Quadratic | None,
    ) -> None:
        super().__init__(evaluate, states, rest, matrix)
        self.constant = constant
        self.form = form
        self._sizes = np.abs(matrix), np.abs(constant)
        self._added = 0

    def first(self, t: float, x: FloatArray) -> FloatArray:
        """Return ``A x + b``."""
        value: FloatArray = self.jacobian @ x + self.constant
        return value

    def moved(self, motion: Motion, i: int, change: FloatArray) -> Indices:
        """Add a column, and now and then all of them anew."""
        self._added += 1
        if self._added < self._refresh:
            return super().moved(motion, i, change)
        self.renew(motion, math.inf, None)
        return self.rows[i]

    def renew(self, motion: Motion, horizon: float, moved: tuple[int, float] | None) -> None:
        """Compute all derivatives by the matrix."""
        self._added = 0
        motion.x[1:] = (motion.q @ self.jacobian.T) / np.arange(1, len(motion.x))[:, None]
        motion.x[1] += self.constant

    def confirm(self, motion: Motion, h: float, quanta: FloatArray) -> bool:
        """Compare matrix and field at the end of the step."""
        q = motion.quantised(h)
        f = self.evaluate(motion.t + h, q)
        size = self._sizes[0] @ np.abs(q) + self._sizes[1]
        difference = np.abs(f[self.states] - self.first(0.0, q))
        # a state that has come to rest is rounding, of which a part says nothing
        same = (difference <= CONFIRMED * size) | (difference * h <= NOTHING * quanta)
        if not same.all():
            return False
        if self.form is None or not self.rest.size:
            return True
        r = f[self.rest]
        difference = np.abs(r - self.form.at(q[None])[0])
        return bool((difference <= CONFIRMED * (self.form.size(q) + np.abs(r))).all())

    def quadratures(self, motion: Motion, h: float) -> FloatArray:
        """Expand the quadratic form, or sample the field, at Gauss nodes of the step."""
        n = len(motion.q)
        if not self.rest.size:
            return np.zeros((n, 0))
        q = np.array([motion.quantised(c * h) for c in NODES[n]])
        if self.form is not None:
            rates = self.form.at(q)
        else:
            times = (motion.t + NODES[n] * h).tolist()
            rates = np.array([self.evaluate(t, a)[self.rest] for t, a in zip(times, q)])
        return _fit(rates, h)


class Fitted(Rates):
    """Any field: derivatives fitted along the quantised states, at Gauss nodes."""

    exact = False

    def __init__(
        self,
        evaluate: Evaluate,
        states: Indices,
        rest: Indices,
        matrix: FloatArray,
        *,
        reach: float,
    ) -> None:
        super().__init__(evaluate, states, rest, np.array(matrix))
        self.reach = reach
        """How long the next fit may be."""
        everyone = np.arange(len(matrix))
        self.rows = [everyone for _ in everyone]
        self._last: tuple[float, FloatArray] = (math.nan, np.empty(0))
        self._fitted = (math.nan, math.nan)
        """Where the fit of the quadratures begins, and how long it is."""

    def first(self, t: float, x: FloatArray) -> FloatArray:
        """Evaluate the field."""
        return self.evaluate(t, x)[self.states]

    def renew(self, motion: Motion, horizon: float, moved: tuple[int, float] | None) -> None:
        """Fit the derivatives over `horizon`, or over what of it the field has values for."""
        n = len(motion.q)
        t = motion.t
        h = min(horizon, self.reach)
        smallest = 4.0 * math.ulp(t)
        while True:
            h = max(h, smallest)
            f = np.array([self.evaluate(t + c * h, motion.quantised(c * h)) for c in NODES[n]])
            bad = first_not_finite(f.sum(axis=0))
            if bad is None:
                break
            if h <= smallest:
                raise StepFailure.not_finite(t, h, bad)
            h *= _SHRINK
            self.reach = h
        coefficients = _fit(f, h)
        motion.x[1:] = coefficients[:, self.states] / np.arange(1.0, n + 1.0)[:, None]
        motion.r = coefficients[:, self.rest]
        self._fitted = t, h
        # a little further than the events foreseen, but not than a fit that failed
        self.until = t + max(h, min(1.5 * h, self.reach))
        if moved is not None and moved[1] != 0.0 and self._last[0] == t:
            # a secant for nothing: the field just before and just after one state's jump
            self.jacobian[:, moved[0]] = (motion.x[1] - self._last[1]) / moved[1]

    def confirm(self, motion: Motion, h: float, quanta: FloatArray) -> bool:
        """Compare fit and field at the end of the step; choose how long the next fit may be."""
        n = len(motion.q)
        f = self.evaluate(motion.t + h, motion.quantised(h))[self.states]
        degrees = np.arange(n)
        fit = ((degrees + 1.0) * h**degrees) @ motion.x[1:]
        ratios = np.abs(f - fit) * h / (_FIT * quanta)
        ratio = float(ratios.max(initial=0.0))
        finite = math.isfinite(ratio)
        smallest = 4.0 * math.ulp(motion.t)
        if ratio <= 1.0 or (finite and h <= smallest):
            self._last = (motion.t + h, f)
            factor = _SAFETY * max(ratio, 1e-10) ** (-1.0 / (n + 1))
            reach = h * min(max(factor, _SHRINK), _GROW)
            self.reach = max(self.reach, reach) if factor >= 1.0 else reach
            return True
        if h <= smallest:
            bad = first_not_finite(ratios)
            raise StepFailure.not_finite(
                motion.t, h, None if bad is None else int(self.states[bad])
            )
        factor = _SAFETY * ratio ** (-1.0 / (n + 1)) if finite else 0.0
        self.reach = h * max(factor, _SHRINK)
        return False

    def quadratures(self, motion: Motion, h: float) -> FloatArray:
        """Return the fit; a new one if the step is not the time that was fitted.

        The error of a fit on Gauss nodes has no integral over exactly the time fitted. Over part
        of it, where an event cuts a step, or beyond, it has one, and no tolerance looks at it.
        """
        if not self.rest.size:
            return motion.r
        start, length = self._fitted
        if motion.t == start and abs(h - length) <= SAME * length:
            return motion.r
        nodes = NODES[len(motion.q)]
        rates = np.array(
            [self.evaluate(motion.t + c * h, motion.quantised(c * h))[self.rest] for c in nodes]
        )
        if not np.isfinite(rates).all():
            return motion.r
        self._fitted = motion.t, h
        return _fit(rates, h)


def _fit(values: FloatArray, h: float) -> FloatArray:
    """Return the coefficients of the polynomial through values at the Gauss nodes of (0, h)."""
    n = len(values)
    fit: FloatArray = _TO_COEFFICIENTS[n] @ values / h ** np.arange(n)[:, None]
    return fit
