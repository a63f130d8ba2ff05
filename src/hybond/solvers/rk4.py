"""The classical Runge-Kutta method."""

from __future__ import annotations

import numpy as np

from hybond.solvers.base import FloatArray
from hybond.solvers.fixed import FixedStep


class ClassicRK4(FixedStep):
    """Kutta's method of order 4 with fixed step and cubic Hermite dense output (order 3).

    The derivative at the end, which the dense output needs, is the first of the next step: four
    evaluations per step, one more at the start.

    Parameters
    ----------
    step : float
        Step size, in seconds.

    References
    ----------
    Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.1 and II.6.

    Examples
    --------
    >>> rk4 = ClassicRK4(0.5)
    >>> rk4.start(lambda t, y: np.array([4*t**3]), 0.0, np.zeros(1), t_bound=1.0, jumped=True)
    >>> rk4.step(1.0).y1, rk4.step(1.0).y1
    (array([0.0625]), array([1.]))
    """

    name = "rk4"
    order = 4

    def _advance(
        self, t0: float, t1: float, y0: FloatArray, f0: FloatArray
    ) -> tuple[FloatArray, FloatArray | None, FloatArray]:
        h = t1 - t0
        middle = t0 + 0.5 * h
        k2 = self._derivative(middle, y0 + 0.5 * h * f0)
        k3 = self._derivative(middle, y0 + 0.5 * h * k2)
        k4 = self._derivative(t1, y0 + h * k3)
        change = h / 6.0 * (f0 + 2.0 * (k2 + k3) + k4)
        y1 = y0 + change
        f1 = self._derivative(t1, y1)
        a, b = h * f0, h * f1
        return y1, f1, np.stack((a, 3.0 * change - 2.0 * a - b, a + b - 2.0 * change))
