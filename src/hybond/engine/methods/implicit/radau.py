"""Radau IIA of order 5 for stiff modes: one step, and the size of the next.

Sources: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.8; K. Gustafsson,
"Control-theoretic techniques for stepsize selection in implicit Runge-Kutta methods", ACM Trans.
Math. Softw. 20(4), 1994.
"""

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.lu import SINGULAR
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import is_one_kink, room_of_instant
from hybond.engine.methods.implicit.beside_edges import (
    begins_at_edge,
    iterate_beside_edge,
    own_stages,
    stages_through_rest,
)
from hybond.engine.methods.implicit.beside_kinks import go_on_converging, leads_beyond
from hybond.engine.methods.implicit.from_edges import keep_within, widen
from hybond.engine.methods.implicit.hidden_peaks import hidden_in_stages
from hybond.engine.methods.implicit.nearer_slopes import takes_nearer_slopes
from hybond.engine.methods.implicit.radau_dense import hold_dense, make_polynomial, put_dense
from hybond.engine.methods.implicit.radau_factors import factorise, solve_real
from hybond.engine.methods.implicit.radau_room import (
    ERROR_BLAMED,
    PIECES,
    RATE_BLAMED,
    STAGES_BLAMED,
    Radau,
)
from hybond.engine.methods.implicit.radau_slopes import (
    begin_closely,
    differences,
    has_grown,
    held_by_law,
)
from hybond.engine.methods.implicit.radau_stages import (
    FRESH_MATRIX,
    ITERATIONS,
    KEPT_MATRIX,
    NO_MATRIX,
    STAGES_BEYOND,
    STAGES_CONVERGED,
    STAGES_FAILED,
    mean_size,
    rate_at,
    rests,
)
from hybond.engine.methods.implicit.rates_in_stages import ask_rates_too
from hybond.engine.methods.tolerances.beside_flat import narrow_beside_flat
from hybond.engine.methods.tolerances.noise_here import measure_here
from hybond.engine.methods.tolerances.onset import foresee_onset
from hybond.engine.methods.tolerances.scale import (
    CREEPS,
    measure_again,
    tolerance,
)
from hybond.engine.methods.tolerances.signal_sizes import allow_begun, ask_rates
from hybond.engine.methods.tolerances.strayed import strayed
from hybond.engine.words import Floats, float_table

RADAU_SAFETY: Final = 0.9
RADAU_SHRINK: Final = 0.2
RADAU_GROW: Final = 8.0
RADAU_SMALLEST: Final = 1e-2
KEEP_SIZE: Final = 1.2
SLOW_RATE: Final = 1e-3
ERROR_WEIGHT: Final = float_table(-10.0488093998274156, 1.3821427331607489, -0.333333333333333333)

SWINGING: Final = 2.0
"""How much longer the step is at least after one that swings about rest within the tolerance."""
STEP_MADE: Final = 0
STEP_REJECTED: Final = 1
STEP_TOO_SMALL: Final = 2


def begin_radau(r: Radau, jumped: bool) -> None:
    """Forget the Jacobian, or after a jump everything, where a motion starts or goes on."""
    if r.matrix == FRESH_MATRIX:
        r.matrix = KEPT_MATRIX
    if not jumped:
        return
    r.matrix = NO_MATRIX
    r.nearer = 1.0
    r.doubted_at = math.nan
    r.slow = False
    r.served = 0.0
    r.left = 1.0
    r.known = False
    r.span = 1.0
    r.origin = 1.0
    r.h_before = 0.0
    r.error_before = 0.0
    for k in range(r.beside.size):
        r.beside.at[k] = 0.0


def filtered_error(r: Radau, f: Floats, rest: Floats) -> float:
    """Find the error ``(REAL/h - J)^-1 (f + weights z / h)``; return its norm."""
    n = r.n
    first = ERROR_WEIGHT[0] / r.h
    second = ERROR_WEIGHT[1] / r.h
    third = ERROR_WEIGHT[2] / r.h
    for i in range(n):
        r.error_vector[i] = first * r.z[i] + second * r.z[n + i] + third * r.z[2 * n + i]
    solve_real(r, f, rest, r.error_vector)
    for i in range(n):
        if rests(r, i):
            r.error_vector[i] = 0.0
    return mean_size(n, 1, r.error_vector, r.other)


def estimate_error(e: Engine, r: Radau) -> None:
    """Estimate the error of the step that is tried."""
    n = r.n
    copy_part(n, r.y, 2 * n, r.stage, 0)
    e.step.tried = r.h
    e.step.solved = True
    tolerance(e, r.y0, r.stage, r.other)
    e.step.solved = False
    e.step.tried = 0.0
    if e.step.left_edge:
        widen(e, r, r.other)
    if e.mode.closely:
        allow_time(r, r.other)
    if e.model.bends > 0.0:
        held_by_law(e, r, r.other)
    r.error = filtered_error(r, r.f0, r.f0_rest)
    if r.error <= 1.0 or not (r.rejected > 0 or r.h_before == 0.0):
        return
    # in a fast transient the estimate is too large; filtered twice it is right
    for i in range(n):
        r.shifted[i] = r.y0[i] + r.error_vector[i]
    if rate_at(e, n, r.t0, r.shifted, r.end) != OK:
        return
    twice = filtered_error(r, r.end, e.rate_rest)
    if twice < r.error:
        r.error = twice


def allow_time(r: Radau, unit: Floats) -> None:
    """Let a tolerance be no less than what a step moves by while the time is rounded.

    What exchanges fast may be over within a few numbers of a late time.
    """
    part = EPSILON * math.fabs(r.t0) / r.h
    for i in range(r.n):
        unit[i] = max(unit[i], part * math.fabs(r.z[2 * r.n + i]))


def radau_rounds(r: Radau) -> float:
    """Return how a step size is corrected for the iterations that the step took."""
    return (2.0 * float(ITERATIONS) + 1.0) / (2.0 * float(ITERATIONS) + float(r.iterations))


def try_radau(e: Engine, r: Radau, rtol: float) -> int:
    """Try a step of size r.h to r.t1; if it is rejected, r.shrink says what to try next."""
    n = r.n
    r.shrink = 0.5
    r.beyond = False
    if e.model.tells != 0:
        r.blamed = RATE_BLAMED
    r.from_edge = begins_at_edge(e, r, rtol)
    if r.matrix == NO_MATRIX:
        differences(e, r, rtol, False)
    if factorise(r) == SINGULAR:
        return STEP_REJECTED
    if r.twofold and not r.f0_closely:
        begin_closely(e, r)
    ask_rates_too(e, r)
    # stages that go on from the last ones leave rest
    r.known = r.known and not e.step.on_edge
    fresh = r.matrix == FRESH_MATRIX
    if e.model.bends > 0.0:
        tolerance(e, r.y0, r.y0, r.tolerance)
        held_by_law(e, r, r.tolerance)
    found = STAGES_CONVERGED if r.from_edge else iterate_beside_edge(e, r, rtol)
    if found != STAGES_CONVERGED and fresh and e.model.bends > 0.0:
        # one matrix does not serve stages before and behind where a current has all but ended
        if own_stages(e, r, rtol, 0.0) and factorise(r) != SINGULAR:
            found = STAGES_CONVERGED
    if found == STAGES_FAILED and fresh and takes_nearer_slopes(e, r, rtol):
        if factorise(r) != SINGULAR:
            found = iterate_beside_edge(e, r, rtol)
    through = found == STAGES_FAILED and fresh and r.sided and goes_through(e, r, rtol)
    if through:
        found = STAGES_CONVERGED
    if found == STAGES_FAILED and fresh and stages_through_rest(e, r, rtol):
        if factorise(r) != SINGULAR:
            found = STAGES_CONVERGED
    if e.model.tells != 0:
        r.blamed = ERROR_BLAMED if found == STAGES_CONVERGED else STAGES_BLAMED
    if found != STAGES_CONVERGED:
        if over_kink(e, r):
            return STEP_MADE
        if found == STAGES_BEYOND:
            r.beyond = True
            r.shrink = RADAU_SHRINK
        if not fresh:
            # the Jacobian may be to blame; where something is not finite, the size as well
            r.matrix = NO_MATRIX
            if found != STAGES_BEYOND:
                r.shrink = 1.0
        return STEP_REJECTED
    estimate_error(e, r)
    make_polynomial(r)
    keep_within(e, r)
    if r.error <= 1.0 and not r.swings:
        # what swings about rest is within the tolerance, and its rates say nothing of how far
        hold_dense(e, r)
    copy_part(n, r.y, 2 * n, r.y1, 0)
    if r.error <= 1.0:
        r.error = max(r.error, strayed(e, r.t0, r.y0, r.t1, r.y1))
        r.error = hidden_in_stages(e, r, r.error)
    if not r.error <= 1.0 and not is_one_kink(e, r.t0, r.y0, r.t1, r.y1):
        factor = RADAU_SAFETY * radau_rounds(r) * math.pow(r.error, -0.25)
        r.shrink = min(max(factor, RADAU_SHRINK), RADAU_SAFETY)
        return STEP_REJECTED
    if rate_at(e, n, r.t1, r.y1, r.f1) != OK:
        r.beyond = True
        r.shrink = RADAU_SHRINK
        return STEP_REJECTED
    return STEP_MADE


def goes_through(e: Engine, r: Radau, rtol: float) -> bool:
    """Whether a step goes through a kink by the slopes beyond; they serve no step but this."""
    differences(e, r, rtol, True)
    found = factorise(r) != SINGULAR and iterate_beside_edge(e, r, rtol) == STAGES_CONVERGED
    r.matrix = NO_MATRIX
    return found and go_on_converging(e, r, rtol) and leads_beyond(e, r)


def over_kink(e: Engine, r: Radau) -> bool:
    """Pass a kink within one instant by a straight line: no stages converge over a jump.

    Nor do they where a current runs into the limit of its law.
    """
    n = r.n
    for i in range(n):
        r.y1[i] = r.y0[i] + r.h * r.f0[i]
    bends = e.model.bends > 0.0 and r.h <= room_of_instant(e, r.t0)
    if not (bends or is_one_kink(e, r.t0, r.y0, r.t1, r.y1)):
        return False
    if rate_at(e, n, r.t1, r.y1, r.f1) != OK:
        return False
    for i in range(n):
        r.coefficients[i] = r.h * r.f0[i]
        r.coefficients[n + i] = 0.0
        r.coefficients[2 * n + i] = 0.0
    r.error = 1.0
    return True


def advance_radau(e: Engine, r: Radau, rtol: float, t_end: float, h: float, longest: float) -> int:
    """Make one step of about h that satisfies the tolerance and ends at t_end or before.

    From r.t0, r.y0, r.f0 to r.t1, r.y1, r.f1.
    """
    remaining = t_end - r.t0
    smallest = 10.0 * spacing(r.t0)
    h = max(min(h, longest), smallest)
    may_land = remaining <= longest * (1.0 + 1e-12)
    r.rejected = 0
    r.vain_h = 0.0
    r.f0_closely = False
    r.beside_known = False
    measure_here(e, e.mode)
    narrow_beside_flat(e, r.t0, r.y0)
    tolerance(e, r.y0, r.y0, r.tolerance)
    while True:
        r.trial = h
        # a little longer rather than a sliver of a step afterwards
        r.t1 = t_end if may_land and remaining <= 1.01 * h else min(r.t0 + h, t_end)
        h = r.t1 - r.t0
        r.h = h
        allow_begun(e, h, r.y0, r.f0, r.tolerance)
        if try_radau(e, r, rtol) == STEP_MADE:
            return STEP_MADE
        r.rejected += 1
        if r.rejected == 1:
            ask_rates(e, r.t0, h, r.y0, r.f0)
            tolerance(e, r.y0, r.y0, r.tolerance)
        if r.rejected == 1 and h < CREEPS * e.span and e.slide.k == 0:
            measure_again(e, e.mode)
        seen = h < CREEPS * e.span and foresee_onset(e, e.mode, r.t0, r.y0, r.f0)
        if seen:
            tolerance(e, r.y0, r.y0, r.tolerance)
        # what never moved has no size: it is found to be zero from zero alone
        r.known = r.known and any_moves(r)
        if r.shrink < 1.0 and h * r.shrink < smallest and not seen:
            return STEP_TOO_SMALL
        h = max(h * r.shrink, min(h, smallest)) if seen else h * r.shrink


def any_moves(r: Radau) -> bool:
    """Whether anything is there or moves where the step begins."""
    moves = False
    for i in range(r.n):
        moves = moves or r.y0[i] != 0.0 or r.f0[i] != 0.0
    return moves


def control_radau(e: Engine, r: Radau, rtol: float, t_end: float, longest: float) -> int:
    """Make one step from r.t0, and choose the size of the next, r.next.

    With what it leaves to the next step.
    """
    if r.slow or has_grown(r):
        r.matrix = NO_MATRIX
        r.slow = False
    made = advance_radau(e, r, rtol, t_end, r.next, longest)
    if made != STEP_MADE:
        return made
    cut = r.h < 0.99 * r.trial
    error = max(r.error, 1e-10)
    factor = RADAU_SAFETY * radau_rounds(r) * math.pow(error, -0.25)
    if r.h_before > 0.0 and not cut:
        # Gustafsson: the error is expected to go on changing as over the last two steps
        factor *= min(1.0, r.h / r.h_before * math.pow(r.error_before / error, 0.25))
    if r.swings:
        # the error that is left is that of swinging, and no less in shorter steps
        factor = max(factor, SWINGING)
    factor = min(max(factor, RADAU_SHRINK), 1.0 if r.rejected > 0 else RADAU_GROW)
    r.slow = r.iterations > 2 and r.rate > SLOW_RATE
    if cut and factor >= 1.0:
        # cut short by t_end: its small error says little about the size after it
        r.next = max(r.trial, r.h * factor)
    elif not r.slow and factor >= 1.0 and factor < KEEP_SIZE:
        r.next = r.h
    else:
        r.next = r.h * factor
    if not cut:
        r.h_before = r.h
        r.error_before = max(r.error, RADAU_SMALLEST)
    copy_floats(3 * r.n, r.coefficients, r.polynomial)
    r.left = r.now_left
    r.span = r.h
    r.origin = 1.0
    r.known = not r.swings
    return STEP_MADE


def step_radau(e: Engine, r: Radau, rtol: float, t_end: float, longest: float) -> int:
    """Make one step from r.t0, r.y0 and r.f0 to r.t1, r.y1 and r.f1, of about the size r.next."""
    n = r.n
    r.start = r.t0
    copy_floats(n, r.y0, r.start_y)
    copy_floats(n, r.f0, r.start_f)
    h_before = r.h_before
    error_before = r.error_before
    made = control_radau(e, r, rtol, t_end, longest)
    if made != STEP_MADE:
        return made
    r.again_matrix = r.matrix
    r.again_h_before = h_before
    r.again_error_before = error_before
    r.again_left = r.left
    r.again_span = r.span
    copy_floats(3 * n, r.polynomial, r.again_polynomial)
    if r.matrix == FRESH_MATRIX:
        r.matrix = KEPT_MATRIX
    r.pieces = 0
    add_piece(r)
    return STEP_MADE


def add_piece(r: Radau) -> None:
    """Note the dense output of the step just made, behind those of the same retry."""
    n = r.n
    k = r.pieces
    r.piece_t0[k] = r.t0
    r.piece_t1[k] = r.t1
    for i in range(n):
        r.piece_y0[k * n + i] = r.y0[i]
        r.piece_y1[k * n + i] = r.y1[i]
    put_dense(r, 4 * k * n)
    copy_floats(3 * n, r.z, r.piece_z)
    copy_floats(3 * n, r.coefficients, r.piece_coefficients)
    r.pieces = k + 1


def end_with_pieces(r: Radau) -> None:
    """Let the step end with the last of its pieces, behind which no shorter one could be made."""
    n = r.n
    last = r.pieces - 1
    r.t1 = r.piece_t1[last]
    r.h = r.t1 - r.piece_t0[last]
    copy_part(n, r.piece_y1, last * n, r.y1, 0)
    copy_floats(n, r.f0, r.f1)
    copy_floats(3 * n, r.piece_z, r.z)
    copy_floats(3 * n, r.piece_coefficients, r.coefficients)


def retry_radau(e: Engine, r: Radau, rtol: float, t_end: float, longest: float) -> int:
    """Repeat the last step, ending at t_end: in one step, if that is accurate enough.

    Jacobian and step size of the steps to come are those of before.
    """
    n = r.n
    next_size = r.next
    matrix = r.matrix
    slow = r.slow
    left = r.left
    h_before = r.h_before
    error_before = r.error_before
    copy_floats(n * n, r.jacobian, r.kept_jacobian)
    r.kept_from = r.twofold_from
    if r.kept_from < math.inf:
        fit(r.kept_rest, n * n)
        copy_floats(n * n, r.jacobian_rest.at, r.kept_rest.at)
    r.slow = False
    r.matrix = r.again_matrix
    r.h_before = r.again_h_before
    r.error_before = r.again_error_before
    r.left = r.again_left
    r.known = True
    r.span = r.again_span
    r.origin = 0.0
    copy_floats(3 * n, r.again_polynomial, r.polynomial)
    r.t0 = r.start
    copy_floats(n, r.start_y, r.y0)
    copy_floats(n, r.start_f, r.f0)
    r.next = t_end - r.t0
    r.pieces = 0
    remade = 0
    made = STEP_MADE
    while made == STEP_MADE and r.t0 < t_end:
        if r.pieces == PIECES:
            # so much shorter steps are for the run to make
            made = STEP_TOO_SMALL
            e.step.off = math.inf
            break
        if r.pieces > 0 and r.matrix == FRESH_MATRIX:
            r.matrix = KEPT_MATRIX
        before = r.made
        made = control_radau(e, r, rtol, t_end, longest)
        remade += r.made - before
        if made == STEP_MADE:
            add_piece(r)
            if r.t1 < t_end:
                r.t0 = r.t1
                copy_floats(n, r.y1, r.y0)
                copy_floats(n, r.f1, r.f0)
            else:
                break
    if made != STEP_MADE and r.pieces > 0 and r.pieces < PIECES:
        end_with_pieces(r)
        e.step.off = math.inf
    if remade > 0:
        copy_floats(n * n, r.kept_jacobian, r.jacobian)
        r.twofold_from = r.kept_from
        if r.kept_from < math.inf:
            copy_floats(n * n, r.kept_rest.at, r.jacobian_rest.at)
        r.served = 0.0
    r.matrix = NO_MATRIX if matrix == NO_MATRIX else KEPT_MATRIX
    r.next = next_size
    r.slow = slow
    r.left = left
    r.h_before = h_before
    r.error_before = error_before
    r.origin = 1.0
    return made


def radau_between(r: Radau, t: float, y: Floats) -> None:
    """Put the state at a time of the last step into `y`, by its dense output.

    At both ends it is the state there to the last bit.
    """
    n = r.n
    k = r.pieces - 1
    while k > 0 and t < r.piece_t0[k]:
        k -= 1
    if t == r.piece_t0[k]:
        copy_part(n, r.piece_y0, k * n, y, 0)
        return
    if t == r.piece_t1[k]:
        copy_part(n, r.piece_y1, k * n, y, 0)
        return
    x = (t - r.piece_t0[k]) / (r.piece_t1[k] - r.piece_t0[k])
    square = x * x
    cube = square * x
    fourth = square * square
    at = 4 * k * n
    for i in range(n):
        y[i] = r.piece_y0[k * n + i] + (
            x * r.piece_polynomial[at + i]
            + square * r.piece_polynomial[at + n + i]
            + cube * r.piece_polynomial[at + 2 * n + i]
            + fourth * r.piece_polynomial[at + 3 * n + i]
        )
