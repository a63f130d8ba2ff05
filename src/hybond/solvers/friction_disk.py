"""Coulomb's disk: the friction force in the plane that a slip velocity and its cause agree on.

A force `p` on the edge of a disk changes a velocity, ``f = f0 - A p``, and must point along it:
``p = L f / |f|``. With ``p = L d`` and ``d = (cos phi, sin phi)`` that is one equation of one
angle, ``d x (f0 - L A d) = 0``, with ``d . (f0 - L A d) >= 0``. For a symmetric positive definite
`A` it has one solution if the disk cannot hold ``f = 0``: ``(A + (|f|/L) 1) p = f0`` is the
secular equation of a trust region. The limit may follow the force, ``L = limit + slope . p``.

Source: V. Acary, F. Cadoux, C. Lemarechal, J. Malick, *A formulation of the linear discrete
Coulomb friction problem via convex optimization*, ZAMM 91 (2011).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

DIRECTIONS = 96
"""Angles at which a change of sign is looked for."""
AGAINST = 1e-9
"""A slip this far against the force, as a part of its terms, is rounding."""
HALVINGS = 70
"""Steps to a root at most. Halving alone would take a bracket of ``2 pi / DIRECTIONS`` to rounding
in 50; the Illinois method takes fewer unless the slip is next to discontinuous."""
CLOSED = 1e-16
"""Width of a bracket that has closed, rad: rounding of an angle of order one is no less."""
_MARKS = np.linspace(-math.pi, math.pi, DIRECTIONS + 1) + 0.5 / DIRECTIONS
_ROUND = np.array([np.cos(_MARKS), np.sin(_MARKS)])


def on_disk(f0: Vector, A: Matrix, limit: float, slope: Vector | None = None) -> Vector | None:
    """Return the direction of the force on the edge of the disk, None if there is none.

    Parameters
    ----------
    f0 : array, shape (2,)
        The velocity without friction.
    A : array, shape (2, 2)
        What one unit of friction takes from it.
    limit : float
    slope : array, shape (2,), optional
        How the limit follows the force.

    Returns
    -------
    array, shape (2,)
        A unit vector, the direction of slip.

    Examples
    --------
    >>> import numpy as np
    >>> on_disk(np.array([3.0, 4.0]), np.eye(2), 1.0).round(12)
    array([0.6, 0.8])
    >>> A = np.diag([1.0, 3.0])
    >>> d = on_disk(np.array([1.0, 2.0]), A, 0.5)
    >>> f = np.array([1.0, 2.0]) - A @ (0.5 * d)
    >>> bool(abs(d[0] * f[1] - d[1] * f[0]) < 1e-14 and f @ d > 0)
    True
    """
    follow = np.zeros(2) if slope is None else slope
    size = float(np.abs(f0).max()) + abs(limit) * float(np.abs(A).max())
    if not size > 0.0:
        return None

    def slip(phi: float) -> tuple[float, float]:
        """Return the parts of the slip across and along the direction."""
        x, y = math.cos(phi), math.sin(phi)
        along = 1.0 - follow[0] * x - follow[1] * y
        force = limit / along if along > 0.0 else math.inf
        u = f0[0] - force * (A[0, 0] * x + A[0, 1] * y)
        v = f0[1] - force * (A[1, 0] * x + A[1, 1] * y)
        return x * v - y * u, x * u + y * v

    found: list[tuple[float, float]] = []
    for k in _turns(f0, A, limit, follow).tolist():
        low, high = float(_MARKS[k]), float(_MARKS[k + 1])
        at_low, at_high = slip(low)[0], slip(high)[0]
        if at_low * at_high <= 0.0:
            phi = _root(lambda a: slip(a)[0], low, high, at_low, at_high)
            found.append((slip(phi)[1], phi))
    if not found:
        return None
    along, phi = max(found)
    if along < -AGAINST * size:
        return None
    return np.array([math.cos(phi), math.sin(phi)])


def _turns(f0: Vector, A: Matrix, limit: float, follow: Vector) -> NDArray[np.intp]:
    """Return between which directions the slip across changes its sign."""
    along = 1.0 - follow @ _ROUND
    with np.errstate(divide="ignore", invalid="ignore"):
        f = f0[:, None] - np.where(along > 0.0, limit / along, np.inf) * (A @ _ROUND)
        across = np.sign(_ROUND[0] * f[1] - _ROUND[1] * f[0])
        # nan where there is no force: no change of sign there
        return np.flatnonzero(across[1:] * across[:-1] <= 0.0)


def _root(
    f: Callable[[float], float], low: float, high: float, at_low: float, at_high: float
) -> float:
    """Return a root of `f` in a bracket (Illinois method)."""
    if at_low == 0.0:
        return low
    side = 0
    for _ in range(HALVINGS):
        if at_high == at_low:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        value = f(middle)
        if value == 0.0 or abs(high - low) <= CLOSED:
            return float(middle)
        if value * at_high > 0.0:
            high, at_high = middle, value
            at_low = 0.5 * at_low if side == -1 else at_low
            side = -1
        else:
            low, at_low = middle, value
            at_high = 0.5 * at_high if side == 1 else at_high
            side = 1
    return 0.5 * (low + high)
