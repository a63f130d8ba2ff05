"""Laws that rise without bound, or whose slope is `0/0` as written, at points where nothing flows.

Of ``f = k*sign(e)*sqrt(abs(e))`` at e = 0 the derivative as written is 0/0, and its limit infinite:

    df = S de + f_p dp,    S -> infinity        so that    de = (df - f_p dp)/S = 0

The other way round the law is smooth, ``e = f*abs(f)/k^2``, and this is its slope. Where the mode
itself holds e (a junction that is OFF), there is no de at all, and df = f_p dp. A mode that moves e
contradicts it; its rows are then singular, and there is no derivative.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.gradients import Gradients, Values

Vector = NDArray[np.float64]

BESIDE = (1e-100, 1e-60)
"""Beside a zero at which no slope is told, its limit is looked at here: squares are numbers yet."""
RISES = 2.0
"""From the farther to the nearer of them, a slope that is infinite at zero grows by this factor."""
NOTHING = 1e-40
"""Part of a slope that rises without bound, at the nearer of them, that is nothing beside it."""
SAME = 1e-9
"""Part by which a slope that has a limit may differ there."""


def limits(slopes: Gradients, names: list[str], values: Values, found: Vector) -> Vector:
    """Return slopes by names with limits in place of what has no value at the zero of its name.

    Parameters
    ----------
    slopes : Gradients
    names : list of str
        By which they are.
    values : mapping
        Shape (points,), or a number.
    found : array, shape (points, rows, names)
        The slopes as they are written. Where a limit is infinite there will be inf, where nothing
        is known nan.
    """
    found, points = np.array(found), len(found)
    bad = ~np.isfinite(found)
    for i, j in np.argwhere(bad.any(axis=0)).tolist():
        own = np.broadcast_to(np.asarray(values[names[j]], float), (points,))
        where = bad[:, i, j] & (own == 0.0)
        limit = np.full(points, np.nan)
        if where.any():
            sides = [_limit(slopes, names[j], values, points, i, j, side) for side in (1.0, -1.0)]
            limit = np.where(_alike(*sides), sides[0], np.nan)
        found[bad[:, i, j], i, j] = np.where(where, limit, np.nan)[bad[:, i, j]]
    return found


def _limit(
    slopes: Gradients, name: str, values: Values, points: int, i: int, j: int, side: float
) -> Vector:
    """Return the limits of one slope from one side: inf where it rises without bound."""
    near, far = (
        slopes.at({**values, name: np.full(points, side * h)}, points)[:, i, j] for h in BESIDE
    )
    with np.errstate(invalid="ignore"):
        a, b = np.abs(near), np.abs(far)
        steady = np.abs(near - far) <= SAME * b
        found = np.where(steady, near, np.nan)
        found = np.where(a >= RISES * b, np.inf, found)
        return np.asarray(np.where(RISES * a <= b, 0.0, found))


def _alike(one: Vector, other: Vector) -> NDArray[np.bool_]:
    """Whether limits from both sides are one."""
    with np.errstate(invalid="ignore"):
        return np.asarray((one == other) | (np.abs(one - other) <= SAME * np.abs(one)))
