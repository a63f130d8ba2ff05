"""The Runge-Kutta pair 5(4) of Dormand and Prince, with Shampine's dense output of order 4.

The norm of the error is the root mean square over the controlled components in units of their
scale. Sources: J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6(1), 1980; L. F. Shampine,
Math. Comput. 46, 1986. The size of its steps is controlled in `control`.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.engine import NOT_FINITE, OK, Engine, say_fault
from hybond.engine.methods.explicit.step_room import Step
from hybond.engine.methods.tolerances.defects import begin_levels, defect_of_stages
from hybond.engine.methods.tolerances.scale import error_norm, tolerance
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats, float_table

SMALLEST_ERROR: Final = 1e-4
BEYOND_HALF: Final = 1.1102230246251568e-16
"""Half a unit in the last place of 1, and a little more."""
TABLE: Final = float_table(
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0, 0.0,
    19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0, 0.0,
    9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0, 0.0,
    35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0, 0.0,
    -71.0 / 57600.0, 0.0, 71.0 / 16695.0, -71.0 / 1920.0, 17253.0 / 339200.0, -22.0 / 525.0,
    1.0 / 40.0,
    1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    -8048581381.0 / 2820520608.0, 0.0, 131558114200.0 / 32700410799.0,
    -1754552775.0 / 470086768.0, 127303824393.0 / 49829197408.0, -282668133.0 / 205662961.0,
    40617522.0 / 29380423.0,
    8663915743.0 / 2820520608.0, 0.0, -68118460800.0 / 10900136933.0,
    14199869525.0 / 1410260304.0, -318862633887.0 / 49829197408.0, 2019193451.0 / 616988883.0,
    -110615467.0 / 29380423.0,
    -12715105075.0 / 11282082432.0, 0.0, 87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0, 701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
)  # fmt: skip
"""Rows of seven: stages (1 to 5), solution (6), error (7), dense output (8 to 11)."""
STAGES: Final = 7
FEW: Final = 8
"""States below which a sum over stages stays in a register."""
STAGE_AT: Final = float_table(0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0)


def spacing(t: float) -> float:
    """Return the distance to the next larger number.

    Source: S. M. Rump et al., BIT 49, 2009: what is more than half of it and less than all of it,
    added, gives the next number.
    """
    size = math.fabs(t)
    return max((size + BEYOND_HALF * size) - size, 5e-324)


def goes_elsewhere(e: Engine, t: float, y: Floats, forget: bool) -> bool:
    """Take where the next step begins; say whether the last one did not end there."""
    s = e.step
    moved = forget or t != s.t
    for k in range(e.states):
        moved = moved or y[k] != s.y[k]
        s.y[k] = y[k]
    s.started = True
    s.t = t
    return moved


def first_step(e: Engine, limit: float, order: float) -> float:
    """Choose the first step, with one evaluation of the field."""
    s = e.step
    n = e.states
    unit = limit if limit < math.inf else 1.0
    for k in range(e.model.storages, n):
        if s.y[k] == 0.0:
            s.scale[k] = math.inf  # a signal that has not begun has no size yet
    d0 = error_norm(n, s.y, s.scale)
    d1 = error_norm(n, s.f, s.scale)
    h0 = 1e-6 * unit
    if d1 > 0.0 and d1 < math.inf:
        h0 = max(0.01 * d0, 10.0) / d1
    h0 = min(h0, 1e-3 * unit) if h0 > 0.0 else 1e-6 * unit
    for k in range(n):
        s.trial[k] = s.y[k] + h0 * s.f[k]
    if field(e, e.mode, s.t + h0, s.trial, s.rate) != OK:
        return 0.01 * h0
    for k in range(n):
        s.rate[k] -= s.f[k]
    d2 = error_norm(n, s.rate, s.scale) / h0
    if not math.isfinite(d2):
        return 0.01 * h0
    h1 = math.inf
    if d2 > 0.0 and d1 < math.inf:
        if d1 > 0.0:
            h1 = d1 / d2 * math.pow(0.01 / d1 * (d2 / d1), 1.0 / (order + 1.0))
        h1 = max(h1 if d1 > 0.0 else 0.0, math.pow(d2, -0.5))
    return min(100.0 * h0, min(h1, limit))


def weigh(n: int, many: int, h: float, row: int, s: Step, out: Floats, at: int) -> None:
    """Put the sum of so many stages, weighed by a row of the table, into `out` from `at` on.

    Both ways add in one order. Few states are summed each in a register, many stage after stage,
    each of which is read as it stands.
    """
    if n < FEW and many == STAGES:
        weigh_all(n, h, row, s, out, at)
        return
    for j in range(many):
        s.weight[j] = h * TABLE[row + j]
    if n < FEW:
        for i in range(n):
            total = 0.0
            for j in range(many):
                total += s.weight[j] * s.k[j * n + i]
            out[at + i] = total
        return
    weight = s.weight[0]
    for i in range(n):
        out[at + i] = weight * s.k[i]
    first = 1
    while first < many:
        if s.weight[first] == 0.0:
            first += 1
            continue
        # two at once: half as often each sum is read and written
        weight = s.weight[first]
        other = s.weight[first + 1] if first + 1 < many else 0.0
        begin = first * n
        if other == 0.0:
            for i in range(n):
                out[at + i] += weight * s.k[begin + i]
        else:
            for i in range(n):
                out[at + i] = (out[at + i] + weight * s.k[begin + i]) + other * s.k[begin + n + i]
        first += 2


def weigh_all(n: int, h: float, row: int, s: Step, out: Floats, at: int) -> None:
    """Put the sum of all stages of few states there; the second one has no weight in any row."""
    a = h * TABLE[row]
    c = h * TABLE[row + 2]
    d = h * TABLE[row + 3]
    f = h * TABLE[row + 4]
    g = h * TABLE[row + 5]
    last = h * TABLE[row + 6]
    for i in range(n):
        total = 0.0 + a * s.k[i]
        total += c * s.k[2 * n + i]
        total += d * s.k[3 * n + i]
        total += f * s.k[4 * n + i]
        total += g * s.k[5 * n + i]
        out[at + i] = total + last * s.k[6 * n + i]


def dopri_attempt(e: Engine, t1: float) -> float:
    """Make a step to t1; return the norm of its error, nan if something is not finite."""
    s = e.step
    n = e.states
    h = t1 - s.t0
    copy_floats(n, s.f0, s.k)
    for stage in range(1, 7):
        at = s.y1 if stage == 6 else s.trial
        weigh(n, stage, h, 7 * stage, s, at, 0)
        for k in range(n):
            at[k] += s.y0[k]
        t = t1 if stage >= 5 else s.t0 + STAGE_AT[stage] * h
        if field(e, e.mode, t, at, s.rate) != OK or not all_finite(n, s.rate):
            return math.nan
        copy_part(n, s.rate, 0, s.k, stage * n)
    if not all_finite(n, s.y1):
        return math.nan
    weigh(n, 7, h, 49, s, s.error, 0)
    tolerance(e, s.y0, s.y1, s.scale)
    return error_norm_of(n, s.error, s.scale, s.controlled)


def error_norm_of(n: int, error: Floats, scale: Floats, many: int) -> float:
    """Return the norm of an error over so many controlled components."""
    total = 0.0
    for k in range(n):
        if scale[k] == 0.0:
            if error[k] != 0.0:
                return math.inf
            continue
        share = error[k] / scale[k]
        total += share * share
    return math.sqrt(total / float(many)) if total == total else math.nan


def not_finite(e: Engine) -> int:
    """Say why no step is small enough: a law or a derivative has no finite value."""
    if e.refusal:
        return NOT_FINITE
    return say_fault(e, "HB-N202", "the derivative is not finite", "")


def begin_step(e: Engine) -> None:
    """Begin a step where the last one ended."""
    s = e.step
    s.t0 = s.t
    for k in range(e.states):
        s.y0[k] = s.y[k]
        s.f0[k] = s.f[k]
    begin_levels(e)


def dopri_accept(e: Engine, t1: float) -> None:
    """Keep the step just made, with its dense output."""
    s = e.step
    n = e.states
    h = t1 - s.t0
    s.t1 = t1
    s.t = t1
    for k in range(n):
        s.y[k] = s.y1[k]
        s.f[k] = s.k[6 * n + k]
    for row in range(4):
        weigh(n, 7, h, 7 * (8 + row), s, s.dense, row * n)
    defect_of_stages(e, h)
