"""Dense output: a step as a function of time, exact at both ends."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Interpolant(ABC):
    """A function of time over one step that returns the ends bit for bit.

    Rounding would otherwise leave a gap between two steps, and a guard that is zero at the end
    of one step could change sign twice.
    """

    __slots__ = ("t0", "t1", "y0", "y1")

    def __init__(self, t0: float, t1: float, y0: FloatArray, y1: FloatArray) -> None:
        self.t0 = t0
        self.t1 = t1
        self.y0 = y0
        self.y1 = y1

    def __call__(self, t: float | FloatArray) -> FloatArray:
        """Return the state at a time, shape (n,), or at k times, shape (n, k)."""
        if not isinstance(t, float):
            times = np.asarray(t, dtype=np.float64)
            if times.ndim:
                return self._column_by_column(times)
            t = float(times)
        if t == self.t0:
            return self.y0.copy()
        if t == self.t1:
            return self.y1.copy()
        return self._at(t)

    def _column_by_column(self, times: FloatArray) -> FloatArray:
        values = self._at_all(times)
        values[:, times == self.t0] = self.y0[:, None]
        values[:, times == self.t1] = self.y1[:, None]
        return values

    @abstractmethod
    def _at(self, t: float) -> FloatArray: ...

    @abstractmethod
    def _at_all(self, times: FloatArray) -> FloatArray: ...


class Polynomial(Interpolant):
    """``y0 + c[0] x + c[1] x^2 + ...`` with ``x = (t - t0)/(t1 - t0)``.

    Parameters
    ----------
    t0, t1 : float
        Start and end of the step.
    y0, y1 : ndarray, shape (n,)
        States there.
    coefficients : ndarray, shape (d, n)
        Of ``x, ..., x^d``, d at most 8.

    Examples
    --------
    >>> line = Polynomial(0.0, 2.0, np.zeros(1), np.ones(1), np.ones((1, 1)))
    >>> line(0.5)
    array([0.25])
    >>> line(np.array([0.0, 1.0, 2.0]))
    array([[0. , 0.5, 1. ]])
    """

    __slots__ = ("_h", "coefficients")

    def __init__(
        self, t0: float, t1: float, y0: FloatArray, y1: FloatArray, coefficients: FloatArray
    ) -> None:
        self.t0 = t0
        self.t1 = t1
        self.y0 = y0
        self.y1 = y1
        self._h = t1 - t0
        self.coefficients = coefficients

    def _at(self, t: float) -> FloatArray:
        x = (t - self.t0) / self._h
        # one product after the other, as the engine takes them: a touch is decided by the last bits
        powers = [x]
        for _ in range(len(self.coefficients) - 1):
            powers.append(powers[-1] * x)
        value: FloatArray = self.y0 + np.array(powers).dot(self.coefficients)
        return value

    def _at_all(self, times: FloatArray) -> FloatArray:
        x = (times - self.t0) / self._h
        powers = np.cumprod(np.tile(x, (len(self.coefficients), 1)), axis=0)
        values: FloatArray = self.y0[:, None] + self.coefficients.T.dot(powers)
        return values
