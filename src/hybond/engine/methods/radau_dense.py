"""The dense output of Radau IIA, and whether it is the motion between the stages as well.

What decays far faster than a step is where its rates vanish, at each stage. Between them it is a
cubic through the start and the stages, and the embedded error, divided by how fast it decays, says
nothing of that: driven by `cos(10 t)` it was half an amplitude off in steps of 0.6 s. So the
polynomial is put back into the equations where it is farthest from what it interpolates. What is
left, by the same factors as the error, is by how much the motion there is another.

Sources: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.8, for the
collocation; W. H. Enright, "Continuous numerical methods for ODEs with defect control",
J. Comput. Appl. Math. 125(1), 2000, for the defect.
"""

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.from_edges import is_held
from hybond.engine.methods.radau_factors import solve_real
from hybond.engine.methods.radau_room import Radau
from hybond.engine.methods.radau_stages import mean_size, rate_at, rests
from hybond.engine.words import float_table

TO_POLYNOMIAL: Final = float_table(
    10.0488093998274156,
    -1.3821427331607489,
    0.333333333333333333,
    -25.6295914470766394,
    10.2962581137433061,
    -2.66666666666666667,
    15.5807820472492238,
    -8.91411538058255716,
    3.33333333333333333,
)
FARTHEST: Final = 0.8612
"""Where in a step `x (x - c1) (x - c2) (x - 1)` is largest, c1, c2 and 1 being the stages."""


def make_polynomial(r: Radau) -> None:
    """Find the coefficients of the cubic through the start and the stages."""
    n = r.n
    for k in range(3):
        for i in range(n):
            r.coefficients[k * n + i] = (
                TO_POLYNOMIAL[3 * k] * r.z[i]
                + TO_POLYNOMIAL[3 * k + 1] * r.z[n + i]
                + TO_POLYNOMIAL[3 * k + 2] * r.z[2 * n + i]
            )


def dense_error(e: Engine, r: Radau) -> float:
    """Return how far the polynomial is from the motion where it is farthest, in tolerances.

    With what it is in ``r.end``. The tolerance is that of the step's error, ``r.other``.
    """
    n = r.n
    x = FARTHEST
    for i in range(n):
        r.shifted[i] = r.y0[i] + x * (
            r.coefficients[i] + x * (r.coefficients[n + i] + x * r.coefficients[2 * n + i])
        )
    if rate_at(e, n, r.t0 + x * r.h, r.shifted, r.end) != OK:
        r.beyond = True
        return math.inf
    for i in range(n):
        way = (
            r.coefficients[i]
            + x * (2.0 * r.coefficients[n + i] + 3.0 * x * r.coefficients[2 * n + i])
        ) / r.h
        if r.from_edge and is_held(r, i):
            # it was nothing before, and is led from there to what it is at the end
            way = r.end[i]
        # what rests here, too, is not moved by slopes that were found beyond a kink
        r.shifted[i] = 0.0 if r.end[i] == way and rests(r, i) else 1.0
        r.x_real[i] = -way
    solve_real(r, r.end, e.rate_rest, r.x_real)
    for i in range(n):
        r.end[i] = r.x_real[i] * r.shifted[i]
    return mean_size(n, 1, r.end, r.other)


def hold_dense(e: Engine, r: Radau) -> None:
    """Take the error between the stages for that of the step, where it is the larger one."""
    error = dense_error(e, r)
    if error > r.error:
        r.error = error
        copy_floats(r.n, r.end, r.error_vector)
