"""Newton's method for a jump: areas of impulses at which the constraints of a mode hold.

Steps are shortened until they bring the constraints nearer. Where that leads nowhere, as over the
hump of a law or far up an exponential, `led_jump` goes the way that what is missing drives.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import largest
from hybond.engine.algebra.separate import least_squares_separate
from hybond.engine.algebra.svd import least_squares
from hybond.engine.constraints.constraints import residual
from hybond.engine.constraints.impulse_ways import (
    rank_of,
    scale_slope,
    size_by_entries,
    slope_of,
)
from hybond.engine.constraints.sparse_ways import sparse_step
from hybond.engine.engine import OK, Engine, svd_room
from hybond.engine.jumps.off_flat import off_flat
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.rows.storage import own_stiffness, with_stored
from hybond.engine.words import Floats

CONSISTENT: Final = 1e-12
"""A constraint is met if its residual is below this part of its terms."""
BEST: Final = 1e-14
CREEPS: Final = 0.95
"""Part of what was left before that is left at least where Newton's method comes no nearer."""
STEPS: Final = 60
FLAT: Final = 3
"""Times that Newton's method is led off a place at which a law has no slope."""
LEAST_FACTOR: Final = 0.45
MOST_FACTOR: Final = 0.95
"""Factors of Newton's steps towards a root of multiplicity 2 to 20."""
STEADY: Final = 0.02
"""Part by which two of these factors may differ."""
HALVES: Final = 40
NO_SIZE: Final = 1e-280
"""What is zero has about 1e-296 times what multiplies it, so as never to be divided by."""

FAR: Final = -2
LOCKED: Final = -3
"""What Newton's method says where its steps lead nowhere; where nothing that moves what is stored
changes what is missing."""


def newton_steps(
    e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, measured: bool, begun: bool
) -> int:
    """Find the areas at which the constraints hold, into `e.work.nu`; OK, FAR or LOCKED.

    From nothing, or from what is there where it has `begun`. Where they are `measured`, the
    residuals at `x` are in `e.work`.
    """
    m = e.model
    w = e.work
    count = w.constraints
    areas = ways.areas
    best = math.inf
    last_length = 0.0
    last_ratio = 0.0
    turns_off_flat = 0
    for a in range(areas if not begun else 0):
        w.nu.at[a] = 0.0
    for j in range(ways.many if ways.sparse else 0):
        w.combined.at[j] = 0.0
    fit(w.gap_first, count)
    if not begun:
        keep_reach(e, x)
    for turn in range(STEPS):
        if turn > 0 and not ways.known:
            # slopes are many residuals, of which none is asked any more where all is met
            gap_at(e, mode, v, x, ways, 0.0)
            if best < math.inf and is_met(e, mode, ways, best):
                return OK
        if not ways.known:
            put_here(m.storages, x, ways, w.nu.at, w.here)
            slope_of(e, mode, v, w.here, ways)
        if turn > 0 or not measured:
            gap_at(e, mode, v, x, ways, 0.0)
        for i in range(count):
            # what ends at zero has no size of its own: its rounding is that of what it was; what
            # was large on the way there only is none
            if turn == 0 and not begun:
                w.gap_first.at[i] = w.gap_size.at[i]
            w.gap_size.at[i] = max(first_size(w.gap_first.at[i], ways), w.gap_size.at[i])
        worst = furthest(e, w.gap_size.at)
        if turn == 0 and not begun:
            w.missing = worst
        if ways.known and best < math.inf and is_met(e, mode, ways, best):
            return OK
        rank = jump_step(e, ways, count)
        most = 0.0
        for i in range(count):
            most = max(most, w.gap_size.at[i])
        if rank < count and unreached(count, areas, w.gap.at, ways.slope.at, w.step.at) > (
            1e-9 * most
        ):
            if turns_off_flat < FLAT and off_flat(e, mode, v, ways):
                # Newton's method goes on from beside the place without a slope
                turns_off_flat += 1
                find_step(e, ways, count)
                for a in range(areas):
                    w.nu.at[a] -= w.step.at[a]
                last_length = 0.0
                continue
            return LOCKED
        best = min(best, worst)
        part = 1.0 if ways.known or worst <= CONSISTENT else nearer(e, mode, v, x, ways)
        length = largest(areas, w.step.at)
        ratio = length / last_length if part == 1.0 and last_length > 0.0 else 0.0
        if not ways.known and is_steady(ratio, last_ratio):
            part = over_flat_root(e, mode, v, x, ways, ratio)
        last_ratio = ratio
        last_length = length if part == 1.0 else 0.0
        for a in range(areas):
            w.nu.at[a] -= part * w.step.at[a]
        for j in range(ways.many if ways.sparse else 0):
            w.combined.at[j] -= w.sent.at[j]
    gap_at(e, mode, v, x, ways, 0.0)
    for i in range(count):
        off = math.fabs(w.gap.at[i])
        size = max(first_size(w.gap_first.at[i], ways), w.gap_size.at[i])
        if not (off <= 1e-9 * size and off < math.inf):
            return FAR
    return OK


def is_met(e: Engine, mode: Mode, ways: Ways, best: float) -> bool:
    """Whether the constraints hold; they have come as near as `best` before.

    Residuals are there, with what their terms are now; sizes are not less than they were at
    first where laws are straight.
    """
    w = e.work
    for i in range(w.constraints):
        w.gap_size.at[i] = max(first_size(w.gap_first.at[i], ways), w.gap_size.at[i])
    own = meets_own_terms(e, mode, BEST)
    worst = furthest(e, w.gap_size.at)
    # where the slopes are wrong by a corner of a law it comes nearer by a part of the way only
    stays = worst >= (0.5 if own else CREEPS) * best
    return (own and worst <= BEST) or (worst <= CONSISTENT and stays)


def first_size(size: float, ways: Ways) -> float:
    """Return what a constraint is measured by of the size that its terms had at first.

    Where laws bend that says nothing of where they end: far up an exponential it is beyond all that
    is asked for, and what is off by 1e-12 of it is no solution.
    """
    return size if ways.known else 0.0


def nearer(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> float:
    """Return the part of Newton's step that brings the constraints nearer; 1 if none is found.

    Sizes are those of the terms before the step: what was zero at first has none of its own, and
    the rounding of one that has grown since would outweigh all that the step mends.
    """
    w = e.work
    fit(w.gap_before, w.constraints)
    for i in range(w.constraints):
        w.gap_before.at[i] = w.gap_size.at[i]
    before = furthest(e, w.gap_before.at)
    part = 1.0
    for _ in range(HALVES):
        gap_at(e, mode, v, x, ways, part)
        if furthest(e, w.gap_before.at) < before:
            return part
        part *= 0.5
    return 1.0


def is_steady(ratio: float, before: float) -> bool:
    """Whether Newton's steps become shorter by one factor, as towards a root without a slope."""
    return (
        before >= LEAST_FACTOR
        and ratio <= MOST_FACTOR
        and math.fabs(ratio - before) <= STEADY * ratio
    )


def over_flat_root(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, ratio: float) -> float:
    """Return how many of Newton's steps to take at once: all that would follow, if that is nearer.

    Where a law has no slope at the root, as ``q^3`` at zero, each is the same part of what is left.
    """
    w = e.work
    gap_at(e, mode, v, x, ways, 1.0)
    left = furthest(e, w.gap_first.at)
    all_of_them = 1.0 / (1.0 - ratio)
    gap_at(e, mode, v, x, ways, all_of_them)
    return all_of_them if furthest(e, w.gap_first.at) < left else 1.0


def furthest(e: Engine, sizes: Floats) -> float:
    """Return the largest residual, each a part of such a size of its terms."""
    w = e.work
    most = 0.0
    for i in range(w.constraints):
        size = sizes[i]
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


def keep_reach(e: Engine, x: Floats) -> None:
    """Keep what rounding of storages at first is measured by; of laws that bend, what is stored."""
    m = e.model
    w = e.work
    for k in range(m.storages):
        w.reach_before[k] = w.reach[k]
        if m.co_energy[k] >= 0:
            own = math.fabs(own_stiffness(m, k, with_stored(e, x)))
            held = w.reach[k] / own if own > 0.0 else 0.0
            w.reach_before[k] = held if math.isfinite(held) else math.fabs(x[k])


def count_moves(e: Engine, mode: Mode, ways: Ways, nu: Floats) -> None:
    """Count what moves what is stored among the terms: of those that cancel rounding is left.

    What was stored at first counts by the slope of its law at `e.work.here`.
    """
    m = e.model
    values = with_stored(e, e.work.here)
    for i in range(mode.bounds):
        k = mode.bound[i]
        if k >= m.storages:
            break
        moved = 0.0
        for p in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
            moved += math.fabs(ways.moves_by.at[p] * nu[ways.moves.at[p]])
        before = e.work.reach_before[k]
        if m.co_energy[k] >= 0:
            moved = max(moved, before)
            before = 0.0
        if moved > 0.0:
            moved *= math.fabs(own_stiffness(m, k, values))
        e.work.reach[k] = max(before, moved)


def put_here(n: int, x: Floats, ways: Ways, nu: Floats, here: Floats) -> None:
    """Put ``x + d nu`` into `here`."""
    for k in range(n):
        here[k] = x[k]
        for i in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
            here[k] += ways.moves_by.at[i] * nu[ways.moves.at[i]]


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
