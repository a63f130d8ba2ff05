"""The step that Newton's residual and Jacobian ask for."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import Engine
from hybond.engine.mode.nonlinear.freedom import step_of_singular
from hybond.engine.mode.nonlinear.single_terms import take_single
from hybond.engine.mode.nonlinear.sparse_step import sparse_step
from hybond.engine.words import Floats

TOLERANCE: Final = 1e-13
"""Newton ends when an update is below this part of the bond variables' size."""
SWINGS: Final = 0.1
"""Two steps that cancel to within this part of them lead over a root that is steep on both sides:
from f to nearly -f."""
CLEAR_PIVOT: Final = 1e-6
"""A pivot above this part of the largest entry of its column is no cancellation."""
NO_PIVOT: Final = 16.0 * EPSILON
"""One below that is the rounding of what cancels: a step by it leads beyond all that is known."""


def newton_step(e: Engine, rows: int, frees: int) -> bool:
    """Solve ``jacobian step = residual``; if it is singular, what is free is zero.

    Whether it is regular beyond doubt: no pivot is a small part of its column.
    """
    work = e.work
    if rows == frees and sparse_step(e, rows):
        return True
    if rows == frees:
        fit(work.jacobian2, rows * frees)
        fit_places(work.pivots, rows)
        copy_floats(rows * frees, work.jacobian.at, work.jacobian2.at)
        copy_floats(rows, work.residual.at, work.step.at)
        if lu_factor(rows, work.jacobian2.at, work.pivots.at) != SINGULAR:
            lu_solve(rows, work.jacobian2.at, work.pivots.at, 1, work.step.at)
            least = least_pivot(rows, work.jacobian.at, work.jacobian2.at)
            if all_finite(rows, work.step.at) and least >= NO_PIVOT:
                clear = least >= CLEAR_PIVOT
                if not clear and work.bends:
                    refine_step(e, rows)
                take_single(e, rows, False)
                return clear
    step_of_singular(e, rows, frees)
    return False


def refine_step(e: Engine, n: int) -> None:
    """Take what the step leaves of each residual out of it, once.

    Each equation holds to a part of its own terms then: an unknown that is zero is not left with
    the rounding of those a million times as large. Source: R. D. Skeel, *Iterative refinement
    implies numerical stability for Gaussian elimination*, Mathematics of Computation 35 (1980).
    """
    work = e.work
    fit(work.left_over, n)
    for i in range(n):
        total = work.residual.at[i]
        for j in range(n):
            total -= work.jacobian.at[i * n + j] * work.step.at[j]
        work.left_over.at[i] = total
    lu_solve(n, work.jacobian2.at, work.pivots.at, 1, work.left_over.at)
    for j in range(n):
        if math.isfinite(work.left_over.at[j]):
            work.step.at[j] += work.left_over.at[j]


def least_pivot(n: int, a: Floats, factors: Floats) -> float:
    """Return the least part of the largest entry in its column that a pivot is."""
    least = math.inf
    for k in range(n):
        most = 0.0
        for i in range(n):
            most = max(most, math.fabs(a[i * n + k]))
        least = min(least, math.fabs(factors[k * n + k]) / most)
    return least
