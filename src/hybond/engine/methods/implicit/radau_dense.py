"""The dense output of Radau IIA, and whether it is the motion between the stages as well.

What decays far faster than a step is where its rates vanish, at each stage. Between them it is a
cubic through the start and the stages, and the embedded error, divided by how fast it decays, says
nothing of that: driven by `cos(10 t)` it was half an amplitude off in steps of 0.6 s. So the
polynomial is put back into the equations where it is farthest from what it interpolates. What is
left, by the same factors as the error, is by how much the motion there is another. Where rates are
held as well the dense output is led through the motion there, and asked once more.

Sources: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.8, for the
collocation; W. H. Enright, "Continuous numerical methods for ODEs with defect control",
J. Comput. Appl. Math. 125(1), 2000, for the defect.
"""

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.from_edges import is_held
from hybond.engine.methods.implicit.radau_factors import solve_real
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import mean_size, rate_at, rests
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
BETWEEN_STAGES: Final = 0.4
"""Where it is farthest in that once it is led through the motion there."""


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


def put_dense(r: Radau, at: int) -> None:
    """Put the coefficients of the dense output, of four powers, among those of pieces.

    With ``c1 + c2 = 0.8`` and ``c1 c2 = 0.1``, what is zero at all stages is
    ``x^4 - 1.8 x^3 + 0.9 x^2 - 0.1 x``.
    """
    n = r.n
    to = r.piece_polynomial
    for i in range(n):
        bent = r.bent[i]
        to[at + i] = r.coefficients[i]
        to[at + n + i] = r.coefficients[n + i]
        to[at + 2 * n + i] = r.coefficients[2 * n + i]
        to[at + 3 * n + i] = bent
        if bent != 0.0:
            to[at + i] -= 0.1 * bent
            to[at + n + i] += 0.9 * bent
            to[at + 2 * n + i] -= 1.8 * bent


def dense_rates(e: Engine, r: Radau, x: float) -> int:
    """Find the rates where the dense output is at a part of the step, in ``r.end``.

    Those that it moves by there are in ``r.x_real``, with the other sign.
    """
    n = r.n
    bends = x * (x - 1.0) * (x * x - 0.8 * x + 0.1)
    turns = x * (x * (4.0 * x - 5.4) + 1.8) - 0.1
    for i in range(n):
        r.shifted[i] = r.y0[i] + x * (
            r.coefficients[i] + x * (r.coefficients[n + i] + x * r.coefficients[2 * n + i])
        )
        r.shifted[i] += bends * r.bent[i]
    found = rate_at(e, n, r.t0 + x * r.h, r.shifted, r.end)
    for i in range(n):
        way = (
            r.coefficients[i]
            + x * (2.0 * r.coefficients[n + i] + 3.0 * x * r.coefficients[2 * n + i])
        ) / r.h
        r.x_real[i] = -(way + turns * r.bent[i] / r.h)
    return found


def dense_error(e: Engine, r: Radau) -> float:
    """Return how far the polynomial is from the motion where it is farthest, in tolerances.

    With what it is in ``r.end``. The tolerance is that of the step's error, ``r.other``.
    """
    n = r.n
    if dense_rates(e, r, FARTHEST) != OK:
        r.beyond = True
        return math.inf
    for i in range(n):
        if r.from_edge and is_held(r, i):
            # it was nothing before, and is led from there to what it is at the end
            r.x_real[i] = -r.end[i]
        # what rests here, too, is not moved by slopes that were found beyond a kink
        r.shifted[i] = 0.0 if r.end[i] == -r.x_real[i] and rests(r, i) else 1.0
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
    if r.rates_asked and r.error <= 1.0:
        r.error = max(r.error, bend_dense(e, r))


def bend_dense(e: Engine, r: Radau) -> float:
    """Lead the dense output through where the motion is between the stages.

    What exchanges far faster than the step has rates that are right where the state is so by many
    digits more than its tolerance. Returns by how much rates then differ from those that it moves
    by, in what they may be off by.
    """
    for i in range(r.n):
        r.bent[i] = r.end[i] / (FARTHEST * (FARTHEST - 1.0) * ((FARTHEST - 0.8) * FARTHEST + 0.1))
    if dense_rates(e, r, BETWEEN_STAGES) != OK:
        r.beyond = True
        return math.inf
    most = 0.0
    for i in range(r.n):
        if r.rate_may[i] < math.inf:
            most = max(most, r.h * math.fabs(r.end[i] + r.x_real[i]) / r.rate_may[i])
    return most
