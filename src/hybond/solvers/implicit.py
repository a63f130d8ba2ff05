"""Radau IIA of order 5 for stiff modes: SciPy's, held to the step contract.

What is used of `scipy.integrate.Radau` beyond its documentation, in this file only: its
attributes ``h_abs`` (size of the next attempt) and ``f`` (derivative), which are read, and
``atol``, which is set before each step.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from hybond.solvers.base import FloatArray, Scale, Solver, Step, StepFailure, first_not_finite
from hybond.solvers.control import first_step, worst_component
from hybond.solvers.dense import Interpolant, Polynomial

Jacobian: TypeAlias = Callable[[float, FloatArray], FloatArray]

_NO_RTOL = 1e-13
"""Small against any tolerance, large enough that SciPy stops Newton's iteration at 0.02 of it."""


class RadauIIA(Solver):
    """Implicit Runge-Kutta, order 5, L-stable, adaptive; dense output of order 3.

    SciPy measures errors by ``atol + rtol*abs(y)``. Here `atol` is set to ``scale(y, y)`` at
    the start of each step and `rtol` to next to nothing, so that the caller's scale alone
    decides; it is corrected for the components of infinite scale, which SciPy would count in
    its mean. A scale of 0 becomes the smallest positive number.

    A step that must end at a given time, and the first after a jump, is made by a new object
    with a new Jacobian, because SciPy keeps the factors made for another step size.

    Parameters
    ----------
    scale : callable
        ``scale(y0, y1)``: the error a step may make, per component, shape (n,).
    rtol : float, optional
        Relative tolerance behind `scale`: ``scale/rtol`` is taken as the size of a component
        when differences for the Jacobian are chosen.
    max_step : float, optional
        Largest step.
    jacobian : callable, optional
        ``jacobian(t, y)``, shape (n, n). By default forward differences, n evaluations. The
        attribute `jacobian` may be set anew before each `start`.

    Notes
    -----
    SciPy does not tell its error estimate nor its rejected attempts: steps have error nan and
    0 rejected. On underflow the component to blame is the one that moves most tolerances per
    second.

    References
    ----------
    Hairer, Wanner, *Solving Ordinary Differential Equations II*, IV.8.

    Examples
    --------
    >>> solver = RadauIIA(lambda y0, y1: 1e-9 + 1e-6 * np.abs(y1))
    >>> stiff = lambda t, y: -1e6 * (y - np.cos(t))
    >>> solver.start(stiff, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    >>> t, steps = 0.0, 0
    >>> while t < 1.0:
    ...     step = solver.step(1.0)
    ...     t, steps = step.t1, steps + 1
    >>> bool(abs(step.y1[0] - np.cos(1.0)) < 1e-5), steps < 40
    (True, True)
    """

    name = "radau"
    order = 5
    adaptive = True

    def __init__(
        self,
        scale: Scale,
        *,
        rtol: float = 1e-6,
        max_step: float = math.inf,
        jacobian: Jacobian | None = None,
    ) -> None:
        super().__init__()
        if not max_step > 0.0:
            raise ValueError(f"max_step must be positive, not {max_step}")
        self.jacobian = jacobian
        self._scale = scale
        self._rtol = float(rtol)
        self._max_step = float(max_step)
        self._radau: Any = None
        self._f: FloatArray = np.empty(0)
        self._not_finite: int | None = None
        """Component of the last evaluation that was not finite, if the last one was not."""

    @property
    def h(self) -> float:
        """Size of the next step to try; setting it drops the history of steps."""
        return self._h

    @h.setter
    def h(self, value: float) -> None:
        if not value > 0.0:
            raise ValueError(f"a step size must be positive, not {value}")
        self._h = float(value)
        self._radau = None

    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        if moved:
            self._radau = None
            self._f = self._finite_derivative(self._t, self._y)
        if forget:
            t, y = self._t, self._y
            limit = min(self._max_step, t_bound - t) if t_bound > t else self._max_step
            scale = self._scale(y, y)
            self._h = first_step(self._derivative, t, y, self._f, scale=scale, order=3, limit=limit)

    def step(self, t_end: float) -> Step:
        """Make one step that satisfies the tolerance."""
        t_end = float(t_end)
        self._remaining(t_end)
        t0, y0, f0 = self._t, self._y, self._f
        with np.errstate(all="ignore"):
            piece = self._piece(t_end)
        self._retryable = (t0, y0, f0)
        interpolant = _Joined(t0, self._t, y0, self._y, [(t0, piece)])
        return Step(t0, self._t, y0, self._y, interpolant, math.nan, self._counted(), 0)

    def retry(self, t_end: float) -> Step:
        """Repeat the last step, ending at `t_end`; several inner steps if accuracy needs them.

        Unlike other solvers this one controls the error of a retry too, and may raise HB-N201.
        """
        t_end = float(t_end)
        t0, y0, f0 = self._last(t_end)
        before = (self._t, self._y, self._f, self._h)
        hint = self._h
        self._radau = None
        self._t, self._y, self._f, self._h = t0, y0, f0, t_end - t0
        pieces = []
        try:
            with np.errstate(all="ignore"):
                while self._t < t_end:
                    start = self._t
                    pieces.append((start, self._piece(t_end)))
        except StepFailure:
            self._t, self._y, self._f, self._h = before
            self._radau = None
            raise
        self._h = hint
        self._radau = None
        self._retryable = (t0, y0, f0)
        interpolant = _Joined(t0, self._t, y0, self._y, pieces)
        return Step(t0, self._t, y0, self._y, interpolant, math.nan, self._counted(), 0)

    def _piece(self, t_end: float) -> Any:
        """Advance by one step of SciPy and return its dense output."""
        t0, y0 = self._t, self._y
        remaining = t_end - t0
        if y0.size == 0:
            # SciPy's norms divide by the number of states.
            whole = remaining <= self._max_step * (1.0 + 1e-12)
            self._t = t_end if whole else t0 + self._max_step
            return _nothing
        if remaining <= 10.0 * math.ulp(t0):
            return self._sliver(t_end)
        trial = self._h = min(self._h, self._max_step)
        landing = remaining <= self._max_step * (1.0 + 1e-12) and remaining <= 1.01 * trial
        if landing or self._radau is None:
            self._radau = self._new(t0, y0, remaining if landing else trial)
        radau = self._radau
        radau.atol = self._tolerance(y0)
        self._not_finite = None
        radau.step()
        if radau.status == "failed":
            raise self._failure(t0, y0)
        y1 = np.array(radau.y)
        f1 = np.array(radau.f)
        for values in (y1, f1):
            bad = first_not_finite(values)
            if bad is not None:
                self._radau = None
                raise StepFailure.not_finite(t0, radau.t - t0, bad)
        dense = radau.dense_output()
        t1 = float(radau.t)
        self._h = float(radau.h_abs)
        if landing and abs(t1 - t_end) <= 4.0 * math.ulp(t_end):
            h, t1 = t1 - t0, t_end
            self._radau = None
            if h < 0.99 * trial and self._h >= h:
                # Cut short by t_end: its small error says little about the size after it.
                self._h = max(trial, self._h)
        y1.flags.writeable = False
        self._t, self._y, self._f = t1, y1, f1
        return dense

    def _sliver(self, t_end: float) -> Any:
        """Advance to an end nearer than the smallest step of SciPy, along the tangent."""
        t0, y0, f0 = self._t, self._y, self._f
        change = (t_end - t0) * f0
        y1 = y0 + change
        f1 = self._finite_derivative(t_end, y1, h=t_end - t0)
        y1.flags.writeable = False
        self._t, self._y, self._f = t_end, y1, f1
        self._radau = None
        return Polynomial(t0, t_end, y0, y1, change[None, :])

    def _new(self, t: float, y: FloatArray, h: float) -> Any:
        from scipy.integrate import Radau

        return Radau(
            self._watched,
            t,
            y,
            math.inf,
            max_step=self._max_step * (1.0 + 1e-12),
            rtol=_NO_RTOL,
            atol=self._tolerance(y),
            jac=self._matrix,
            first_step=h,
        )

    def _tolerance(self, y: FloatArray) -> FloatArray:
        scale = np.asarray(self._scale(y, y), dtype=np.float64)
        controlled = int(np.count_nonzero(scale < np.inf))
        share = math.sqrt(controlled / y.size) if controlled else 1.0
        tolerance: FloatArray = np.maximum(scale * share, np.finfo(np.float64).tiny)
        return tolerance

    def _watched(self, t: float, y: FloatArray) -> FloatArray:
        f = self._derivative(t, y)
        self._not_finite = first_not_finite(f)
        return f

    def _matrix(self, t: float, y: FloatArray) -> FloatArray:
        """Return the Jacobian, given or by forward differences."""
        if self.jacobian is not None:
            matrix = np.array(self.jacobian(t, y), dtype=np.float64)
        else:
            matrix = self._differences(t, y)
        bad = np.flatnonzero(~np.isfinite(matrix).all(axis=1))
        if bad.size:
            self._radau = None
            raise StepFailure.not_finite(t, self._h, int(bad[0]))
        return matrix

    def _differences(self, t: float, y: FloatArray) -> FloatArray:
        f = self._derivative(t, y)
        size = np.abs(y)
        scale = self._scale(y, y)
        known = scale < np.inf
        size[known] = np.maximum(size[known], scale[known] / self._rtol)
        size[size == 0.0] = 1.0
        # In the direction of motion: a state at the edge of where its law is defined is more
        # likely to have come from there than to go there.
        delta = math.sqrt(np.finfo(np.float64).eps) * np.copysign(size, f)
        matrix = np.empty((y.size, y.size))
        for j in range(y.size):
            for signed in (delta[j], -delta[j]):
                shifted = y.copy()
                shifted[j] += signed
                column = (self._derivative(t, shifted) - f) / (shifted[j] - y[j])
                if np.isfinite(column).all():
                    break
            matrix[:, j] = column
        return matrix

    def _failure(self, t: float, y: FloatArray) -> StepFailure:
        h = 10.0 * math.ulp(t)
        self._radau = None
        if self._not_finite is not None:
            return StepFailure.not_finite(t, h, self._not_finite)
        return StepFailure.underflow(t, h, worst_component(self._f, self._scale(y, y)))


def _nothing(t: float | FloatArray) -> FloatArray:
    """Return the dense output of a system without states."""
    return np.empty((0, *np.shape(t)))


class _Joined(Interpolant):
    """Dense outputs of SciPy, one after another, as one."""

    __slots__ = ("_pieces", "_starts")

    def __init__(
        self, t0: float, t1: float, y0: FloatArray, y1: FloatArray, pieces: list[tuple[float, Any]]
    ) -> None:
        super().__init__(t0, t1, y0, y1)
        self._pieces = [piece for _, piece in pieces]
        self._starts = [start for start, _ in pieces]

    def _at(self, t: float) -> FloatArray:
        index = max(bisect_right(self._starts, t) - 1, 0)
        return np.asarray(self._pieces[index](t), dtype=np.float64)

    def _at_all(self, times: FloatArray) -> FloatArray:
        if len(self._pieces) == 1:
            return np.array(self._pieces[0](times), dtype=np.float64)
        values = np.empty((self.y0.size, times.size))
        index = np.maximum(np.searchsorted(self._starts, times, side="right") - 1, 0)
        for i in np.unique(index):
            chosen = index == i
            values[:, chosen] = self._pieces[i](times[chosen])
        return values
