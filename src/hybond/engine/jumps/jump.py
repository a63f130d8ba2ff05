"""Entering a mode: the jump that conserves state.

    x+ = x + D nu,   nu such that   G z(x+) = c

`D` spans the rates that impulses allowed by the power structure can make. `G z = c` are the
constraints of the power structure and the sources at the right limit. The areas `nu` sent through
the junction structure are the impulses of every bond.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, row_times
from hybond.engine.algebra.products import are_equal
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.algebra.separate import least_squares_separate
from hybond.engine.algebra.svd import least_squares
from hybond.engine.constraints.constraints import (
    begin_constraints,
    gaps,
    residual,
    restore_bonds,
)
from hybond.engine.constraints.impulse_ways import (
    find_ways,
    rank_of,
    scale_slope,
    size_by_entries,
    slope_of,
)
from hybond.engine.constraints.sparse_ways import sparse_step
from hybond.engine.engine import OK, REFUSED, Engine, say_fault, svd_room
from hybond.engine.jumps.untouched import hold_untouched, note_reached
from hybond.engine.mode.agreement import check_agreement
from hybond.engine.mode.leakage import least_leakage, project
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.part_energies import find_energies
from hybond.engine.mode.reach import reach_at
from hybond.engine.mode.storage import is_alone, own_stiffness
from hybond.engine.reasons.facts import refuse_jump
from hybond.engine.words import Floats

CONSISTENT: Final = 1e-12
"""A constraint is met if its residual is below this part of its terms."""
BEST: Final = 1e-14
CREEPS: Final = 0.95
"""Part of what was left before that is left at least where Newton's method comes no nearer."""
STEPS: Final = 60
HALVES: Final = 40
NO_SIZE: Final = 1e-280
"""What is zero has about 1e-296 times what multiplies it, so as never to be divided by."""
CANCELLED: Final = 1e-15
"""A sum of terms below this part of their sizes is zero."""
NOTHING: Final = 1e-20
"""A stored quantity that a constraint moves is zero below this part of what it may be."""
PLAINLY: Final = 1e10 * NOTHING * NOTHING
"""Part of an energy, in what is stored, that is far above that."""
STAYS: Final = 0
SWEPT: Final = 1
JUMPS: Final = 2
"""What entering a mode does: nothing, takes rounding away, moves what is stored by impulses."""


def enter_mode(e: Engine, mode: Mode, v: Floats, x: Floats, after: Floats) -> int:
    """Put the state on entering a mode from `x` into `after`, the impulses into `e.impulses`.

    `v` are time and inputs at the right limit, bond variables and the second copy a priori; what is
    stored in it is changed, and bond variables are kept. The result says what happened:
    `e.moved`, one of STAYS, SWEPT, JUMPS.
    """
    m = e.model
    n = 2 * m.bonds
    e.moved = STAYS
    for k in range(m.storages):
        after[k] = x[k]
    for k in range(n):
        e.impulses[k] = 0.0
    if mode.agreements.rows > 0 and check_agreement(e, mode, v) != OK:
        return REFUSED
    if mode.constraints.rows == 0 and mode.structures == 0:
        return OK
    begin_constraints(e, mode, v, x)
    count = e.work.constraints
    if count == 0:
        return OK
    residual(e, mode, v, x)
    exact = True
    rounding = True
    for i in range(count):
        r = math.fabs(e.work.gap.at[i])
        exact = exact and r == 0.0
        rounding = rounding and r <= CONSISTENT * e.work.gap_size.at[i]
    if exact:
        restore_bonds(e, mode, v)
        return OK
    ways = mode.ways
    restore_bonds(e, mode, v)
    note_reached(e, mode)
    measured = ways.known
    find_ways(e, mode, v, x)
    status = newton_jump(e, mode, v, x, ways, measured)
    restore_bonds(e, mode, v)
    if status != OK:
        return status
    moved_by(m.storages, x, ways, e.work.nu.at, after)
    # rounding is no jump: dust is swept up without an impulse
    e.moved = SWEPT if rounding else JUMPS
    if rounding:
        leave_nothing(e, mode, v, x, after)
    else:
        sharpen(e, mode, v, ways, after)
        put_impulses(e, mode, ways)
    hold_untouched(e, mode, v[0], x, after)
    return OK


def sharpen(e: Engine, mode: Mode, v: Floats, ways: Ways, after: Floats) -> None:
    """Take out of the state after a jump what rounding of the state before it has left there.

    A light mass that a heavy one brings to rest keeps the last digit of the heavy one's momentum,
    which is many of its own.
    """
    m = e.model
    w = e.work
    if not ways.known or not are_equal(m.storages, w.here, after):
        residual(e, mode, v, after)  # else it is what Newton's method has left there
    if not meets_own_terms(e, mode, EPSILON):
        jump_step(e, ways, w.constraints)
        for k in range(m.storages):
            change = 0.0
            for i in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
                change += ways.moves_by.at[i] * w.step.at[ways.moves.at[i]]
            # what the jump has brought to zero is there
            after[k] -= change if after[k] != 0.0 else 0.0
    restore_bonds(e, mode, v)


def leave_nothing(e: Engine, mode: Mode, v: Floats, x: Floats, after: Floats) -> None:
    """Let rounding that is swept up leave what is nothing as it is, where the others meet without.

    What it would be is the last digit of the others, but its sign decides which way a law turns
    that begins at it: a mass at rest behind a diode is no mass that is pushed back.
    """
    m = e.model
    w = e.work
    none = True
    for k in range(m.storages):
        w.here[k] = 0.0 if x[k] == 0.0 else after[k]
        none = none and w.here[k] == after[k]
    if none:
        return
    residual(e, mode, v, w.here)
    if meets_own_terms(e, mode, BEST):
        for k in range(m.storages):
            after[k] = w.here[k]
    restore_bonds(e, mode, v)


def meets_own_terms(e: Engine, mode: Mode, part: float) -> bool:
    """Whether every constraint holds to a part of its terms as they are.

    Not as large as the energy of their part could make them: a storage that is small beside the
    others would be far off before that shows.
    """
    w = e.work
    constraints = mode.constraints
    for i in range(constraints.rows):
        own = 0.0
        for p in range(constraints.first.at[i], constraints.first.at[i + 1]):
            own += math.fabs(constraints.value.at[p] * w.xi[constraints.column.at[p]])
        if not math.fabs(w.gap.at[i]) <= part * own:
            return False
    return True


def put_impulses(e: Engine, mode: Mode, ways: Ways) -> None:
    """Send the areas through the junction structure; shares are chosen by least leakage."""
    n = 2 * e.model.bonds
    w = e.work
    if ways.sparse:
        for k in range(n):
            e.impulses[k] = row_times(mode.free_rows, k, w.combined.at)
        return
    for k in range(ways.many):
        total = 0.0
        for a in range(ways.areas):
            total += ways.moving.at[k * ways.areas + a] * w.nu.at[a]
        w.combined.at[k] = total
    for k in range(n):
        total = 0.0
        for i in range(ways.many):
            total += ways.directions.at[k * ways.many + i] * w.combined.at[i]
        e.impulses[k] = total
    if ways.shares > 0:
        least_leakage(e, mode, ways.shares, ways.share.at, w.leakage)
        project(w.leakage, n, e.impulses)


def moved_by(n: int, x: Floats, ways: Ways, nu: Floats, after: Floats) -> None:
    """Put ``x + d nu`` into `after`, what cancels to rounding being zero."""
    for k in range(n):
        total = x[k]
        size = math.fabs(x[k])
        for i in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
            change = ways.moves_by.at[i] * nu[ways.moves.at[i]]
            total += change
            size += math.fabs(change)
        after[k] = 0.0 if math.fabs(total) <= CANCELLED * size else total


def jump_step(e: Engine, ways: Ways, count: int) -> int:
    """Put Newton's step into `e.work.step`, by the inverse if it is known; return the rank."""
    w = e.work
    if not ways.known:
        return find_step(e, ways, count)
    if ways.sparse:
        sparse_step(e, ways, count)
        return ways.rank
    for a in range(ways.areas):
        total = 0.0
        for i in range(count):
            total += ways.inverse.at[a * count + i] * w.gap.at[i]
        w.step.at[a] = total
    return ways.rank


def find_step(e: Engine, ways: Ways, count: int) -> int:
    """Put Newton's step into `e.work.step`; return the rank of the slope."""
    w = e.work
    areas = ways.areas
    d = svd_room(e, max(count, areas), max(count, areas))
    size_rows(e, ways, count)
    rank = scale_slope(e, ways, count, w.row_size.at)
    if areas == 0:
        return rank
    if rank < areas:
        rank = rank_of(e, count, areas, ways.slope.at)
        least_squares(d, count, areas, ways.slope.at, 1e-12, 1, w.gap.at, w.step.at)
        return rank
    for i in range(count):
        size = w.row_size.at[i]
        w.row_size.at[i] = w.gap.at[i] / (size if size > 0.0 else 1.0)
    least_squares_separate(
        w.separate, d, count, areas, w.scaled.at, 1e-12, w.row_size.at, w.step.at
    )
    for a in range(areas):
        w.step.at[a] = w.step.at[a] / w.column_size.at[a]
    return rank


def size_rows(e: Engine, ways: Ways, count: int) -> None:
    """Put what rows of the slope are measured by into `e.work.row_size`: the sizes of their terms.

    Where all terms of one are zero, as far from a first switch of a circuit at rest, it has no
    size, and all are measured by their largest entries.
    """
    w = e.work
    fit(w.row_size, count)
    least = math.inf
    for i in range(count):
        w.row_size.at[i] = w.gap_size.at[i]
        least = min(least, w.gap_size.at[i])
    if least > NO_SIZE:
        return
    for i in range(count):
        size_by_entries(w.row_size.at, ways, i)


def newton_jump(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, measured: bool) -> int:
    """Find the areas at which the constraints hold, into `e.work.nu`.

    Where they are `measured`, the residuals at `x` are in `e.work`.
    """
    m = e.model
    w = e.work
    count = w.constraints
    areas = ways.areas
    best = math.inf
    for a in range(areas):
        w.nu.at[a] = 0.0
    for j in range(ways.many if ways.sparse else 0):
        w.combined.at[j] = 0.0
    fit(w.gap_first, count)
    for k in range(m.storages):
        w.reach_before[k] = w.reach[k]
    for turn in range(STEPS):
        if not ways.known:
            put_here(m.storages, x, ways, w.nu.at, w.here)
            slope_of(e, mode, v, w.here, ways)
        if turn > 0 or not measured:
            gap_at(e, mode, v, x, ways, 0.0)
        for i in range(count):
            # what ends at zero has no size of its own: its rounding is that of what it was; what
            # was large on the way there only is none
            if turn == 0:
                w.gap_first.at[i] = w.gap_size.at[i]
            w.gap_size.at[i] = max(w.gap_first.at[i], w.gap_size.at[i])
        own = meets_own_terms(e, mode, BEST)
        rank = jump_step(e, ways, count)
        worst = 0.0
        most = 0.0
        for i in range(count):
            size = w.gap_size.at[i]
            worst = max(worst, math.fabs(w.gap.at[i]) / (size if size > 0.0 else 1.0))
            most = max(most, size)
        # where the slopes are wrong by a corner of a law it comes nearer by a part of the way only
        stays = worst >= (0.5 if own else CREEPS) * best
        met = (own and worst <= BEST) or (worst <= CONSISTENT and stays)
        if met and best < math.inf:
            return OK
        if rank < count and unreached(count, areas, w.gap.at, ways.slope.at, w.step.at) > (
            1e-9 * most
        ):
            why = "no redistribution of what is stored meets the constraints of this mode"
            if m.tells != 0:
                return refuse_jump(e, mode, "HB-N303", why)
            return say_fault(e, "HB-N303", why, "")
        best = min(best, worst)
        part = 1.0 if ways.known or worst <= CONSISTENT else nearer(e, mode, v, x, ways)
        for a in range(areas):
            w.nu.at[a] -= part * w.step.at[a]
        for j in range(ways.many if ways.sparse else 0):
            w.combined.at[j] -= w.sent.at[j]
    gap_at(e, mode, v, x, ways, 0.0)
    for i in range(count):
        if not math.fabs(w.gap.at[i]) <= 1e-9 * max(w.gap_first.at[i], w.gap_size.at[i]):
            if m.tells != 0:
                return refuse_jump(e, mode, "HB-N304", "the jump into this mode does not converge")
            return say_fault(e, "HB-N304", "the jump into this mode does not converge", "")
    return OK


def gap_at(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, part: float) -> None:
    """Put the residuals after `part` of the step, and the sizes of their terms, into `e.work`."""
    w = e.work
    m = e.model
    fit(w.tried, ways.areas)
    for a in range(ways.areas):
        w.tried.at[a] = w.nu.at[a] - (part * w.step.at[a] if part > 0.0 else 0.0)
    put_here(m.storages, x, ways, w.tried.at, w.here)
    count_moves(e, mode, ways, w.tried.at)
    residual(e, mode, v, w.here)


def nearer(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> float:
    """Return the part of Newton's step that brings the constraints nearer; 1 if none is found.

    Sizes are those of the terms before the step: what was zero at first has none of its own, and
    the rounding of one that has grown since would outweigh all that the step mends.
    """
    w = e.work
    fit(w.gap_before, w.constraints)
    for i in range(w.constraints):
        w.gap_before.at[i] = w.gap_size.at[i]
    before = furthest(e)
    part = 1.0
    for _ in range(HALVES):
        gap_at(e, mode, v, x, ways, part)
        if furthest(e) < before:
            return part
        part *= 0.5
    return 1.0


def furthest(e: Engine) -> float:
    """Return the largest residual, each a part of the size that its terms had before the step."""
    w = e.work
    most = 0.0
    for i in range(w.constraints):
        size = w.gap_before.at[i]
        part = math.fabs(w.gap.at[i]) / (size if size > 0.0 else 1.0)
        most = max(most, part) if math.isfinite(part) else math.inf
    return most


def unreached(count: int, areas: int, gap: Floats, slope: Floats, step: Floats) -> float:
    """Return the largest residual that a step leaves."""
    most = 0.0
    for i in range(count):
        total = gap[i]
        for a in range(areas):
            total -= slope[i * areas + a] * step[a]
        most = max(most, math.fabs(total))
    return most


def count_moves(e: Engine, mode: Mode, ways: Ways, nu: Floats) -> None:
    """Count what moves what is stored among the terms: of those that cancel rounding is left."""
    m = e.model
    for i in range(mode.bounds):
        k = mode.bound[i]
        if k >= m.storages:
            break
        moved = 0.0
        for p in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
            moved += math.fabs(ways.moves_by.at[p] * nu[ways.moves.at[p]])
        if moved > 0.0:
            moved *= math.fabs(own_stiffness(m, k, e.work.values))
        e.work.reach[k] = max(e.work.reach_before[k], moved)


def put_here(n: int, x: Floats, ways: Ways, nu: Floats, here: Floats) -> None:
    """Put ``x + d nu`` into `here`."""
    for k in range(n):
        here[k] = x[k]
        for i in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
            here[k] += ways.moves_by.at[i] * nu[ways.moves.at[i]]


def on_constraints(e: Engine, mode: Mode, v: Floats, y: Floats) -> int:
    """Put the state back on its mode's constraints, off which integration drifts.

    The same projection as a jump, but within a mode; `v` are the values of the motion at `y`.
    """
    m = e.model
    if not is_fixed(mode) or not project_once(e, mode, v, y, e.work.landed):
        status = enter_mode(e, mode, v, y, e.work.landed)
        if status != OK:
            return status
    if e.moved == STAYS:
        return OK
    small = False
    find_energies(e, mode)
    for k in range(m.storages):
        landed = e.work.landed[k]
        if landed == y[k]:
            continue  # what none moves is kept
        y[k] = landed
        if landed == 0.0:
            continue
        energy = mode.part_energy[mode.bond_part[m.storage_bond[k]]]
        if is_next_to_nothing(e, k, y, energy):
            e.work.landed[k] = 0.0
            small = True
    if small:
        hold_at_zero(e, mode, v, y)
    return OK


def is_next_to_nothing(e: Engine, k: int, y: Floats, energy: float) -> bool:
    """Whether what storage k holds is none beside what it would with all of an energy."""
    m = e.model
    if is_alone(m, k) and y[k] * y[k] * math.fabs(m.stiff_constant[m.stiff_first[k]]) > (
        PLAINLY * energy
    ):
        return False  # seen without a root, which takes longer than all else here
    held = reach_at(e, k, y, energy)
    return math.fabs(y[k]) <= NOTHING * held


def hold_at_zero(e: Engine, mode: Mode, v: Floats, y: Floats) -> None:
    """Put what a constraint holds at zero there, which would become ever smaller numbers.

    Where it holds it at what is next to nothing, as a source does that has just begun, it stays.
    `e.work.landed` is the state without what is so small.
    """
    if is_fixed(mode):
        gaps(e, mode, v, e.work.landed, False)
    else:
        residual(e, mode, v, e.work.landed)
    if meets_own_terms(e, mode, BEST):
        for k in range(e.model.storages):
            y[k] = e.work.landed[k]
    restore_bonds(e, mode, v)


def is_fixed(mode: Mode) -> bool:
    """Whether one projection, which is known, puts any state on the constraints of a mode."""
    linear = mode.dynamics == 0 and mode.structures == 0 and mode.agreements.rows == 0
    return linear and mode.ways.known and mode.ways.rank == mode.constraints.rows


def project_once(e: Engine, mode: Mode, v: Floats, y: Floats, after: Floats) -> bool:
    """Put the state on the constraints of such a mode into `after`; False if rounding forbids it.

    The first step of Newton's method, which has to meet them as the last one does.
    """
    w = e.work
    ways = mode.ways
    gaps(e, mode, v, y, False)
    exact = True
    for i in range(w.constraints):
        exact = exact and w.gap.at[i] == 0.0
    e.moved = STAYS
    if exact:
        return True
    jump_step(e, ways, w.constraints)
    for a in range(ways.areas):
        w.nu.at[a] = -w.step.at[a]
    moved_by(e.model.storages, y, ways, w.nu.at, after)
    gaps(e, mode, v, after, True)
    e.moved = SWEPT
    return meets_own_terms(e, mode, BEST)
