"""`Blend`: the combination of modes at one point of a sliding motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

ROUNDING = 1e-14
"""An average below this part of what it is made of is zero."""


@dataclass(frozen=True, slots=True)
class Blend:
    """The combination at one point.

    Parameters
    ----------
    weights : array, shape (k,)
        Of the state above, per surface.
    coefficients : array, shape (parts,)
    w : array, shape (2 * bonds,)
    rates : array, shape (nx + ns + 2,)
        ``y'``.
    slopes : array, shape (k, k)
        ``d(dg_i/dt) / d lambda_j``.
    directions : array, shape (k, nx + ns)
        ``d y' / d lambda_j``.
    solutions : list of array
        Bond variables of each part.
    pushes : array, shape (2, k), or None
        Where parts have constraints of their own: how fast each surface is approached from below
        and from above before a jump, as a part of both speeds; negative where it is not.
    """

    weights: Vector
    coefficients: Vector
    w: Vector
    rates: Vector
    slopes: Matrix
    directions: Matrix
    solutions: list[Vector]
    pushes: Matrix | None = None


def margins_of(here: Blend) -> Matrix:
    """Return how far a motion is from leaving each surface, below and above, shape (2, k)."""
    both = np.array([here.weights, 1.0 - here.weights])
    return both if here.pushes is None else np.minimum(both, here.pushes)


def averaged(coefficients: Vector, terms: Matrix) -> Vector:
    """Return the combination of rows; what cancels but for rounding is zero.

    Else a state that a surface holds at zero would be steered by rounding.
    """
    total = coefficients @ terms
    size = np.abs(coefficients) @ np.abs(terms)
    return np.where(np.abs(total) <= ROUNDING * size, 0.0, total)


def solved(matrix: Matrix, right: Vector, otherwise: NumericsError) -> Vector:
    """Solve, or raise `otherwise`."""
    try:
        found = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        raise otherwise from None
    if not np.isfinite(found).all():
        raise otherwise
    return np.asarray(found)
