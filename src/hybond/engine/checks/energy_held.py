"""The energy of a run: what is stored is what powers bring, step by step and jump by jump.

No power is lost in the junction structure, which is looked at where laws are: what sources give
less what resistors take is what flows into storage, `z x'`. So the balance of a run is kept by
what is stored: of each step that of its rates at its stages (`defects`), or, where it is
implicit, that it ends by the rates that are there; where laws are looked at that these are the
rates that are shown; and of each jump that nothing comes from nowhere.

What is off is held against all that moved, and against what tolerances let each step be off by: a
state that is off by e changes what is stored by e times its co-energy variable. Steps of a fixed
length are as long as somebody wished: what they make of nothing is told in joules, and no fault.
Their method sums up powers as coarsely as it steps, and what dies out in a few steps is summed up
to a third. What is stored goes the wrong way only where steps make more than powers bring.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_places
from hybond.engine.algebra.rounding import EPSILON, UNDERFLOW
from hybond.engine.engine import OK, Engine
from hybond.engine.instant.jump_balance import PART
from hybond.engine.method_numbers import EULER, MOREAU, RK4
from hybond.engine.methods.tolerances.defects import chord
from hybond.engine.methods.tolerances.scale import FAINT
from hybond.engine.mode.digits.part_energies import part_of_bond
from hybond.engine.mode.digits.sizes import seen_of, size_of
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.nonlinear.newton import knowns_of
from hybond.engine.mode.nonlinear.put_back import NEAR
from hybond.engine.mode.rows.storage import own_stiffness, with_stored
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.reasons.noting import BALANCE, MOVES, note_in_state, note_violation
from hybond.engine.reasons.warned import MADE_BY_STEPS, add_about, begin_warning
from hybond.engine.surfaces.values import field

TIMES: Final = 10.0
"""How many times what tolerances allow it may be off: as in the audit."""
MADE: Final = 0.1
"""Part of the energy that moved which steps of a fixed length may make beside what powers bring: as
much as one in ten that was put in and taken out, half of it each time."""
LOST_DIGITS: Final = 1e-10
"""Part of the terms that made a variable by which a rate may be off that is made another way."""
INSTANT: Final = 1e-12
"""Part of the run in which what the largest rate of its kind stores is no energy yet."""


def hold_step(e: Engine) -> None:
    """Count the step just noted, and hold the balance of the run against what moved."""
    m = e.model
    c = e.checks
    s = e.step
    if e.curved or m.storages == 0:
        return
    moved = 0.0
    size = 0.0
    stored = 0.0
    put = 0.0
    lost = 0.0
    # a step may count up to a place within it
    whole = e.t == s.t1
    for k in range(m.storages):
        if m.storage_pseudo[k] != 0:
            continue
        level = s.level1[k]
        change = 0.5 * (s.level0[k] + level) * (e.y[k] - s.y0[k])
        stored += change
        moved += math.fabs(change)
        size += math.fabs(level * e.y[k])
        put += level * (e.y[k] - s.y1[k]) if whole else 0.0
        lost += math.fabs(level)
    c.size = max(c.size, size)
    c.moved += moved
    c.may += (m.rtol + EPSILON) * c.size
    if m.atol == m.atol:
        c.may += m.atol * lost
    # what is across a law beside its limit is known to a part of where that is
    c.may += m.rtol * m.bends * lost * (s.t1 - s.t0)
    if not whole:
        return
    c.unbalanced += s.defect + put
    c.brought += stored - s.defect - put
    bound = PART * c.moved + TIMES * c.may
    if math.fabs(c.unbalanced) <= bound and math.fabs(c.apart + s.apart) <= bound:
        c.apart += s.apart
        c.strayed = math.inf
        return
    hold_apart_rates(e, bound)
    if m.method >= RK4:
        return
    bound += nothing(e)
    if math.fabs(c.unbalanced) <= bound and math.fabs(c.apart) <= bound:
        c.strayed = math.inf
    elif c.strayed == math.inf:
        c.strayed = e.t
        c.strayed_by = most_moved(e)
        copy_places(m.machines, e.mode.state, 0, c.strayed_state, 0)


def tell_balance(e: Engine) -> None:
    """Tell, where a run ends, that its balance has not held since some step.

    Not before: what begins with next to nothing may be off by a large part of that, as tolerances
    are of what it comes to, and is nothing beside what moves then.
    """
    c = e.checks
    if c.strayed < math.inf and not is_off_by_nothing(e):
        off = math.fabs(c.unbalanced)
        if not off >= math.fabs(c.apart):
            off = math.fabs(c.apart)
        note_in_state(e, c.strayed_state, c.strayed, BALANCE, c.strayed_by, off, c.moved)


def is_off_by_nothing(e: Engine) -> bool:
    """Whether all that is off is an energy that is none, now that rates at the end are known.

    Those behind a jump in the last instant are of no step before.
    """
    most = nothing(e)
    return math.fabs(e.checks.unbalanced) <= most and math.fabs(e.checks.apart) <= most


def hold_apart_rates(e: Engine, bound: float) -> None:
    """Count by how much the rates shown at the end of a step are not those of its motion.

    Beside what they may be off as states are off by their tolerance: what follows its drive at once
    has a force that is the small difference of two large ones.
    """
    m = e.model
    c = e.checks
    s = e.step
    if math.fabs(c.apart + s.apart) <= bound:
        c.apart += s.apart
        return
    h = s.t1 - s.t0
    may = 0.0
    known = True
    refusal = e.refusal
    hold_guess(e, e.mode)
    for j in range(e.states):
        copy_floats(e.states, s.y1, c.beside)
        shift = tolerance_of(e, j)
        c.beside[j] += shift
        known = known and field(e, e.mode, s.t1, c.beside, c.rate) == OK
        for k in range(m.storages if known else 0):
            if m.storage_pseudo[k] == 0:
                may += math.fabs(s.level1[k] * (c.rate[k] - s.f[k])) * h
    give_back_guess(e, e.mode)
    e.refusal = refusal
    if not known or not math.fabs(s.apart) > may:
        return
    c.apart += s.apart - math.copysign(may, s.apart)


def tolerance_of(e: Engine, j: int) -> float:
    """Return what a state may be off by, of its own size or by the energy of the run."""
    m = e.model
    s = e.step
    size = max(math.fabs(s.y1[j]), math.fabs(s.y0[j]))
    if j < m.storages:
        own = math.fabs(own_stiffness(m, j, with_stored(e, s.y1)))
        if own > 0.0 and math.isfinite(own):
            size = max(size, 1e-6 * math.sqrt(2.0 * e.checks.size / own))
    return m.rtol * size + (m.atol if m.atol == m.atol else 0.0)


def nothing(e: Engine) -> float:
    """Return an energy that is none: what the largest rates would store in no time."""
    m = e.model
    c = e.checks
    total = FAINT * FAINT
    for k in range(m.storages):
        rate = rate_bond(m, k)
        way = INSTANT * e.span * c.largest[m.bond_class[rate]]
        own = math.fabs(chord(e, k))
        if way > 0.0 and math.isfinite(own) and m.storage_pseudo[k] == 0:
            total += own * way * way
    return total


def most_moved(e: Engine) -> int:
    """Return the storage that the last step has moved most energy into, or out of."""
    m = e.model
    s = e.step
    most = -1.0
    found = 0
    for k in range(m.storages):
        moved = math.fabs((s.level0[k] + s.level1[k]) * (s.y1[k] - s.y0[k]))
        if m.storage_pseudo[k] == 0 and moved > most:
            most = moved
            found = k
    return found


def hold_last_rates(e: Engine) -> None:
    """Hold the rates that a step has ended with, where it did just now and laws were looked at.

    What puts the state back on its constraints is rounding, or should be. Where laws or sources
    jump, rates are those of one side, and what is shown may be of the other.
    """
    s = e.step
    m = e.model
    if e.checks.shown_at != e.t:
        return
    if e.curved or s.t1 != e.t or s.t != e.t or m.method == EULER or e.t >= e.next_break:
        return
    same = True
    for k in range(m.storages):
        same = same and e.y[k] == s.y1[k]
    if same or m.kinks == 0:
        hold_rates(e)


def hold_rates(e: Engine) -> None:
    """Hold the rates that the last step has ended with against those shown, in `e.checks.v`.

    Both are solved from their own beginnings, and each is taken for a solution where another step
    of Newton's method would move it by no more than a part of the largest of its kind.
    """
    m = e.model
    c = e.checks
    if e.slide.k > 0 or c.shown_at != e.t or m.method >= MOREAU:
        return
    for k in range(m.storages):
        at = rate_bond(m, k)
        shown = way_of_rate(m, k) * c.v[m.bond_slot + at]
        off = math.fabs(e.step.f[k] - shown)
        may = PART * math.fabs(shown) + NEAR * c.largest[m.bond_class[at]] + UNDERFLOW
        if off <= may:
            continue
        # what was evaluated since then has left its own knowns there
        knowns_of(e, e.mode, c.v, False)
        may += LOST_DIGITS * size_of(e, e.mode, at, e.work.xi, c.v)
        if not off <= may + LOST_DIGITS * left_of(e, at):
            note_violation(e, e.mode, e.t, MOVES, k, off, math.fabs(shown))


def left_of(e: Engine, b: int) -> float:
    """Return what bond variable `b` might be by the most energy that its part has held.

    Where nothing moves any more after a jump, what is left has the rounding of what moved before.
    """
    seen_of(e, e.mode, e.checks.v, e.y)
    part = part_of_bond(e.model, e.mode, b)
    return math.sqrt(e.mode.part_energy[part]) * e.mode.seen[b]


def warn_of_steps(e: Engine) -> None:
    """Say what steps of a fixed length have made of nothing, or lost, if that is much.

    That is more than powers have brought, so that what is stored went the other way.
    """
    m = e.model
    c = e.checks
    if (m.method != RK4 and m.method != EULER) or m.tells == 0:
        return
    if math.fabs(c.unbalanced) <= math.fabs(c.brought) + MADE * c.moved + TIMES * c.may:
        return
    begin_warning(e.warned, MADE_BY_STEPS, e.t)
    add_about(e.warned, c.unbalanced)
    add_about(e.warned, c.moved)
