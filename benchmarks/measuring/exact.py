"""Motion through modes with linear fields, each followed by the exponential of its matrix.

It is what the runs are held against: no step size, no tolerance but that of the root finder.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Linear:
    """A mode ``y' = A y`` (constants and sines are states too) and the rules that leave it.

    Parameters
    ----------
    matrix : array, shape (n, n)
    rules : tuple
        Guards as rows, which mean something where ``row @ y`` falls through zero (with
        ``also @ y < 0``, if given), and the mode and the state after it.
    grid : float
        Distance at which guards are looked at, s.
    """

    matrix: Vector
    rules: tuple[tuple[Vector, Vector | None, Hashable, Callable[[Vector], Vector]], ...]
    grid: float

    @functools.cached_property
    def one_grid(self) -> Vector:
        """Return what brings a state from one look at the guards to the next."""
        from scipy.linalg import expm

        return np.asarray(expm(self.matrix * self.grid))


def follow(
    modes: dict[Hashable, Linear], mode: Hashable, y: Vector, until: float
) -> tuple[Vector, list[float]]:
    """Return the state at the end, and the times of events."""
    from scipy.linalg import expm
    from scipy.optimize import brentq

    t, times = 0.0, []
    while until - t > 1e-12 * until:
        now = modes[mode]
        h = min(now.grid, until - t)
        after = (now.one_grid if h == now.grid else expm(now.matrix * h)) @ y
        best: tuple[float, int] | None = None
        for k, (row, also, _, _) in enumerate(now.rules):
            if row @ y > 0.0 >= row @ after and (also is None or also @ after < 0.0):
                x = brentq(
                    lambda s, row=row, y=y, a=now.matrix: row @ expm(a * s) @ y,
                    0.0,
                    h,
                    xtol=1e-16,
                    rtol=1e-15,
                )
                if best is None or x < best[0]:
                    best = (x, k)
        if best is None:
            t, y = t + h, after
            continue
        y = expm(now.matrix * best[0]) @ y
        t += best[0]
        times.append(t)
        row, _, mode, jump = now.rules[best[1]]
        y = jump(y)
    return y, times
