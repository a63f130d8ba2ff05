"""Newton with steps that are shortened until they help.

Full steps jump to and fro where a law is bent like a root on both sides of rest: two orifices in a
row. A step is taken as far as the *next* one, with the same slopes, becomes smaller. That test does
not depend on the units of the equations (P. Deuflhard, *Newton Methods for Nonlinear Problems*,
2004, section 3.3: natural monotonicity).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

DAMPED_STEPS = 200
SHORTEST = 2.0**-30
"""The smallest part of a step that is tried."""


def damped(
    system: Callable[[Vector], tuple[Vector, Matrix]],
    solve: Callable[[Matrix, Vector], Vector],
    start: Vector,
    *,
    tolerance: float,
) -> Vector | None:
    """Return a root of a system of equations, or None if none is found from `start`.

    Parameters
    ----------
    system : callable
        Residual, shape (m,), and Jacobian, shape (m, n), at an argument of shape (n,).
    solve : callable
        The step of a Jacobian and a residual.
    start : array, shape (n,)
    tolerance : float
        A step below this part of the largest argument is the last.

    Examples
    --------
    >>> def root(x):  # a root with a short straight piece at rest, at which full steps do not end
    ...     x = float(x[0])
    ...     s = (x * x + 1e-12) ** 0.25
    ...     return np.array([x / s - 2.0]), np.array([[1 / s - x * x / (2 * s**5)]])
    >>> float(damped(root, np.linalg.solve, np.array([-40.0]), tolerance=1e-13)[0])
    4.0
    """
    r = start
    weight = np.zeros(len(r))
    for _ in range(DAMPED_STEPS):
        residual, jacobian = system(r)
        if not residual.any():
            return r
        if not (np.isfinite(residual).all() and np.isfinite(jacobian).all()):
            return None
        step = solve(jacobian, residual)
        weight = np.maximum(weight, np.maximum(np.abs(r), np.abs(step)))
        if (np.abs(step) <= tolerance * np.abs(r).max(initial=0.0)).all():
            return r - step
        part = _part(system, solve, r, jacobian, step, np.where(weight > 0.0, weight, 1.0))
        if part is None:
            return None
        r = r - part * step
    return None


def _part(
    system: Callable[[Vector], tuple[Vector, Matrix]],
    solve: Callable[[Matrix, Vector], Vector],
    r: Vector,
    jacobian: Matrix,
    step: Vector,
    weight: Vector,
) -> float | None:
    length = float(np.abs(step / weight).max(initial=0.0))
    part = 1.0
    while part >= SHORTEST:
        residual, _ = system(r - part * step)
        if np.isfinite(residual).all():
            ahead = float(np.abs(solve(jacobian, residual) / weight).max(initial=0.0))
            if ahead <= (1.0 - part / 2.0) * length:
                return part
        part /= 2.0
    return None
