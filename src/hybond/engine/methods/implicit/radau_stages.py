"""The stages of a step of Radau IIA by Newton's iteration.

Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.8. In the basis of
the eigenvectors of the inverse of the method's matrix the linear system of an iteration, of three
times the size of the state, falls apart into a real and a complex one.
"""

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.methods.explicit.one_instant import jump_lies_between
from hybond.engine.methods.implicit.radau_factors import solve_stages
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.rates_in_stages import rates_left
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.methods.tolerances.signal_sizes import allow_rounding
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats, float_table

ITERATIONS: Final = 7
ENOUGH: Final = 0.001
STAGE_1: Final = 0.15505102572168219
STAGE_2: Final = 0.6449489742783178
REAL_OUT: Final = float_table(0.0944387624889752415, 0.250213122965333311, 1.0)
PAIR_OUT_RE: Final = float_table(-0.141255295020954208, 0.204129352293799932, 1.0)
PAIR_OUT_IM: Final = float_table(0.0300291941051474245, -0.382942112757261938, 0.0)

STILL_SWINGS: Final = 0.5
"""A correction is more than this part of the one before where stages swing and do not settle."""
OPEN: Final = 0.1
"""Part of what rates may be off by that stages may leave open."""
NO_MATRIX: Final = 0
KEPT_MATRIX: Final = 1
FRESH_MATRIX: Final = 2

STAGES_CONVERGED: Final = 0
STAGES_FAILED: Final = 1
STAGES_BEYOND: Final = 2


def rate_at(e: Engine, n: int, t: float, y: Floats, f: Floats) -> int:
    """Find the derivative, of n numbers; NOT_FINITE where there is none."""
    if field(e, e.mode, t, y, f) != OK or not all_finite(n, f):
        return NOT_FINITE
    return OK


def foresee(r: Radau) -> None:
    """Begin with the stages that the polynomial of another step foresees."""
    n = r.n
    for k in range(3 * n):
        r.z[k] = 0.0
    if not r.known:
        return
    for s in range(3):
        x = r.origin + r.h / r.span * (STAGE_1 if s == 0 else STAGE_2 if s == 1 else 1.0)
        for i in range(n):
            r.z[s * n + i] = (
                (x - r.origin) * r.polynomial[i]
                + (x * x - r.origin) * r.polynomial[n + i]
                + (x * x * x - r.origin) * r.polynomial[2 * n + i]
            )
            if r.y0[i] == 0.0 and r.f0[i] == 0.0:
                # where it stays nothing it is found so from nothing
                r.z[s * n + i] = 0.0


def stage_time(r: Radau, s: int) -> float:
    """Return when a stage is."""
    if s == 2:
        return r.t1
    return r.t0 + (STAGE_1 if s == 0 else STAGE_2) * r.h


def stage_rate(e: Engine, r: Radau, s: int) -> int:
    """Find the derivative at a stage."""
    n = r.n
    for i in range(n):
        r.stage[i] = r.y[s * n + i]
    found = rate_at(e, n, stage_time(r, s), r.stage, r.end)
    for i in range(n):
        r.f[s * n + i] = r.end[i]
        if r.twofold:
            r.f_rest.at[s * n + i] = e.rate_rest[i]
    return found


def stage_rates(e: Engine, r: Radau) -> int:
    """Find the derivatives at all stages; NOT_FINITE where one has none."""
    for s in range(3):
        if stage_rate(e, r, s) != OK:
            return NOT_FINITE
    return OK


def place_stages(r: Radau) -> None:
    """Find the states of the stages from their differences."""
    n = r.n
    for s in range(3):
        for i in range(n):
            r.y[s * n + i] = r.y0[i] + r.z[s * n + i]


def correct_stages(r: Radau) -> None:
    """Correct the stages by what is left of their equations."""
    n = r.n
    solve_stages(r)
    for s in range(3):
        for i in range(n):
            half = PAIR_OUT_RE[s] * r.x_re[i] - PAIR_OUT_IM[s] * r.x_im[i]
            r.last[s * n + i] = REAL_OUT[s] * r.x_real[i] + 2.0 * half
    for i in range(n):
        if rests(r, i):
            for s in range(3):
                r.last[s * n + i] = -r.z[s * n + i]
    for k in range(3 * n):
        r.z[k] += r.last[k]
    place_stages(r)


def rests(r: Radau, i: int) -> bool:
    """Whether a state that is nothing has no rate where the step begins, nor at any stage.

    It stays: what slopes from beyond a kink, or what was foreseen, would leave of it is nothing
    that a tolerance could be made of.
    """
    n = r.n
    still = r.y0[i] == 0.0 and r.f0[i] == 0.0
    return still and r.f[i] == 0.0 and r.f[n + i] == 0.0 and r.f[2 * n + i] == 0.0


def many_rest(r: Radau) -> int:
    """Return how many states stay nothing in the stages as they are.

    What stands behind others that leave rest within the step does so one iteration after the other.
    """
    many = 0
    for i in range(r.n):
        if rests(r, i):
            many += 1
    return many


def mean_size(n: int, rows: int, x: Floats, unit: Floats) -> float:
    """Return the root mean square of rows in units of the tolerance; nothing in nothing is 0."""
    total = 0.0
    for s in range(rows):
        for i in range(n):
            a = x[s * n + i]
            if unit[i] == 0.0:
                if a != 0.0:
                    return math.inf
            else:
                total += a / unit[i] * (a / unit[i])
    size = math.sqrt(total / float(rows * n)) if n > 0 else 0.0
    return size if size == size else math.inf


def swing_within(r: Radau, other: bool) -> bool:
    """Whether stages swing about where they should be, within the tolerance.

    A state that a law like a root has brought to rest is led past zero by any slope that is less
    than without bound, to and fro, however short the step.
    """
    n = r.n
    back = r.rate > STILL_SWINGS and r.size <= 1.0
    for s in range(3):
        for i in range(n):
            k = s * n + i
            unit = r.other[i] if other else r.tolerance[i]
            small = math.fabs(r.last[k]) <= ENOUGH * unit
            back = back and (small or r.last[k] * r.swung[k] < 0.0)
    return back


def swing_over_jump(e: Engine, r: Radau) -> bool:
    """Whether the last stage swings over a kink that is no root: a law may jump there.

    It is held between its two sides by nothing: the step ends at the kink, or is made shorter.
    """
    n = r.n
    copy_part(n, r.y, 2 * n, r.stage, 0)
    for i in range(n):
        r.shifted[i] = r.stage[i] - r.last[2 * n + i]
    return jump_lies_between(e, r.t1, r.stage, r.shifted)


def settle_swing(r: Radau) -> None:
    """Put stages that swing half way between where they were and where they are."""
    for k in range(3 * r.n):
        r.z[k] -= 0.5 * r.last[k]
    place_stages(r)
    r.swings = True


def iterate_stages(e: Engine, r: Radau, rtol: float) -> int:
    """Iterate until the error left is negligible, or until it is clear that it will not be."""
    n = r.n
    # below ten units of rounding of the state itself no iteration can come
    enough = max(ENOUGH, 10.0 * EPSILON / rtol)
    before = 0.0
    # beside a kink what is foreseen may be beyond, and looks right there by slopes of this side
    r.known = r.known and not r.sided
    foresee(r)
    r.swings = False
    r.rate = 0.0
    # what was foreseen beside a kink may be beyond: how fast others converged says nothing then
    r.now_left = 1.0 if r.sided else math.pow(max(r.left, 1e-16), 0.8)
    place_stages(r)
    other = False
    found_all = False
    resting = n + 1
    count = 0
    while count < ITERATIONS:
        count += 1
        r.iterations = count
        found = stage_rates(e, r)
        if found != OK and count == 1 and r.known:
            # foreseen beyond where laws end or jump: straight on by the rates there are
            for s in range(3):
                for i in range(n):
                    r.z[s * n + i] = (stage_time(r, s) - r.t0) * r.f0[i]
            place_stages(r)
            found = stage_rates(e, r)
        if found != OK:
            return STAGES_BEYOND
        still = many_rest(r)
        if still < resting and resting <= n:
            # what moves something was found only now: nothing is known of what it moves
            count = 1
            r.iterations = 1
            r.now_left = 1.0
            other = False
            found_all = False
        resting = min(resting, still)
        open_rates = rates_left(r)
        correct_stages(r)
        r.size = math.inf if other else mean_size(n, 3, r.last, r.tolerance)
        if r.size == math.inf:
            # a state that leaves 0 in this step, and may be at 0 again where it ends
            for i in range(n):
                r.stage[i] = max(math.fabs(r.y[i]), math.fabs(r.y[n + i]))
                r.stage[i] = max(r.stage[i], math.fabs(r.y[2 * n + i]))
            tolerance(e, r.y0, r.stage, r.other)
            allow_rounding(e, r.h, r.y0, r.stage, r.other)
            other = True
            r.size = mean_size(n, 3, r.last, r.other)
        if count > 1:
            r.rate = r.size / before if before > 0.0 else 0.0
            if swing_within(r, other) and not swing_over_jump(e, r):
                settle_swing(r)
                return STAGES_CONVERGED
            if found_all and not r.rate < STILL_SWINGS:
                # what is left of rates is rounding
                return STAGES_CONVERGED
            if not r.rate < 1.0:
                return STAGES_FAILED
            r.now_left = r.rate / (1.0 - r.rate)
            ahead = math.pow(r.rate, float(ITERATIONS - count)) * r.now_left * r.size
            if ahead > enough and not found_all:
                return STAGES_FAILED
        found_all = found_all or r.now_left * r.size <= enough
        if found_all and (count == ITERATIONS or r.now_left * open_rates <= OPEN):
            return STAGES_CONVERGED
        before = r.size
        copy_floats(3 * n, r.last, r.swung)
    return STAGES_FAILED
