"""Fixed steps on a grid: what forward Euler and the classical Runge-Kutta method share."""

from __future__ import annotations

import math
from abc import abstractmethod

import numpy as np

from hybond.engine.outcome.polynomial import Polynomial
from hybond.solvers.base import FloatArray, Solver, Step, StepFailure, first_not_finite

_SLACK = 1e-9
"""Part of a step within which a time counts as a point of the grid."""


class FixedStep(Solver):
    """Steps to the grid ``t_start + k*step``, laid anew by each `start`.

    The last step before a `t_end` is shortened to it; the one after goes to the next point of
    the grid. The grid is computed by multiplication, so that it does not drift.

    Parameters
    ----------
    step : float
        Step size, positive and finite.
    """

    adaptive = False

    def __init__(self, step: float) -> None:
        super().__init__()
        if not 0.0 < step < math.inf:
            raise ValueError(f"a step must be positive and finite, not {step}")
        self._h = float(step)
        self._t_start = 0.0
        self._next = 1
        self._f: FloatArray | None = None

    @property
    def h(self) -> float:
        """The step. Setting it has no effect: the size is fixed."""
        return self._h

    @h.setter
    def h(self, value: float) -> None:
        pass

    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        self._t_start = self._t
        self._next = 1
        if moved:
            self._f = None
            # Evaluated here, so that a start where nothing is defined is refused by the start.
            self._f = self._finite_derivative(self._t, self._y)

    def step(self, t_end: float) -> Step:
        """Make one step, to the next point of the grid or to `t_end`."""
        t_end = float(t_end)
        self._remaining(t_end)
        grid = self._t_start + self._next * self._h
        slack = _SLACK * self._h
        t1 = t_end if t_end <= grid + slack else grid
        if t1 <= self._t:
            raise StepFailure.underflow(self._t, self._h, None)
        with np.errstate(all="ignore"):
            if self._f is None:
                self._f = self._finite_derivative(self._t, self._y, h=t1 - self._t)
            step = self._advance_to(t1, self._t, self._y, self._f)
        if t1 >= grid - slack:
            self._next += 1
        return step

    def retry(self, t_end: float) -> Step:
        """Repeat the last step, with the size that ends it at `t_end`."""
        t0, y0, f0 = self._last(t_end)
        with np.errstate(all="ignore"):
            step = self._advance_to(float(t_end), t0, y0, f0)
        passed = t_end + _SLACK * self._h
        while self._next > 1 and self._t_start + (self._next - 1) * self._h > passed:
            self._next -= 1
        while self._t_start + self._next * self._h <= passed:
            self._next += 1
        return step

    def _advance_to(self, t1: float, t0: float, y0: FloatArray, f0: FloatArray) -> Step:
        y1, f1, coefficients = self._advance(t0, t1, y0, f0)
        for values in (y1,) if f1 is None else (y1, f1):
            bad = first_not_finite(values)
            if bad is not None:
                raise StepFailure.not_finite(t0, t1 - t0, bad)
        y1.flags.writeable = False
        self._retryable = (t0, y0, f0)
        self._t, self._y, self._f = t1, y1, f1
        interpolant = Polynomial(t0, t1, y0, y1, coefficients)
        return Step(t0, t1, y0, y1, interpolant, math.nan, self._counted(), 0)

    @abstractmethod
    def _advance(
        self, t0: float, t1: float, y0: FloatArray, f0: FloatArray
    ) -> tuple[FloatArray, FloatArray | None, FloatArray]:
        """Return `y1`, the derivative there if it is known, and the dense output's rows."""
