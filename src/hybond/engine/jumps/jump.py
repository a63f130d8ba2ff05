"""Entering a mode: the jump that conserves state.

    x+ = x + D nu,   nu such that   G z(x+) = c

`D` spans the rates that impulses allowed by the power structure can make. `G z = c` are the
constraints of the power structure and the sources at the right limit. The areas `nu` sent through
the junction structure are the impulses of every bond.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import row_times
from hybond.engine.algebra.products import are_equal, copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.constraints.constraints import (
    begin_constraints,
    gaps,
    residual,
    restore_bonds,
)
from hybond.engine.constraints.impulse_ways import find_ways
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.jumps.jump_steps import BEST, CONSISTENT, jump_step, meets_own_terms
from hybond.engine.jumps.led_jump import find_areas
from hybond.engine.jumps.untouched import hold_untouched, note_reached
from hybond.engine.mode.digits.part_energies import find_energies
from hybond.engine.mode.digits.reach import reach_at
from hybond.engine.mode.left_free.leakage import least_leakage, project
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.nonlinear.agreement import check_agreement
from hybond.engine.mode.rows.storage import is_alone
from hybond.engine.words import Floats

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
    copy_floats(m.storages, x, after)
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
    status = find_areas(e, mode, v, x, ways, measured)
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
            # what a jump between straight laws has brought to zero is there
            after[k] -= change if after[k] != 0.0 or not ways.known else 0.0
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
        copy_floats(m.storages, w.here, after)
    restore_bonds(e, mode, v)


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


def all_follow(e: Engine, mode: Mode, v: Floats, x: Floats) -> bool:
    """Whether all that impulses move is held by the constraints alone, wherever it comes from.

    Then `moves_first` of the ways of the mode says what that is.
    """
    if mode.constraints.rows == 0 and mode.structures == 0:
        return False
    begin_constraints(e, mode, v, x)
    residual(e, mode, v, x)
    restore_bonds(e, mode, v)
    ways = mode.ways
    find_ways(e, mode, v, x)
    restore_bonds(e, mode, v)
    many = 0
    for k in range(e.model.storages):
        many += 1 if ways.moves_first.at[k] < ways.moves_first.at[k + 1] else 0
    return many > 0 and many == ways.areas and e.work.constraints >= many


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
        copy_floats(e.model.storages, e.work.landed, y)
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
