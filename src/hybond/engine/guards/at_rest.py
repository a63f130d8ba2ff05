"""Guards whose thresholds are where the motion comes to rest: rounding fires none of them.

A capacitor charges to 1 V and is never there, but rounding puts it there, and the error of the run
beyond. So a guard that is found to hold is asked once more if all that one of its comparisons
depends on is at rest as far as the run can tell: the slopes of the rates lead from the state to
where they are zero. Comparisons are asked there, in the limit, where little is unknown. One that is
clear of zero there decides. One that is zero there has not changed its sign: the guard holds only
if it would with either sign. What time alone does later belongs to it: what is at rest is so up to
the next timed event.

A ramp has no place to rest at, nor has what turns round: these cross or touch, and fire. What was
zero where the motion began, and stays, is equal, not nearly equal.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import (
    atom_here,
    holds_here,
    look_at_state,
    terms_here,
)
from hybond.engine.guards.locator import NO_KINK, Locator
from hybond.engine.guards.quartic import COEFFICIENTS
from hybond.engine.guards.rest_limits import (
    find_felt,
    find_limit,
    lead_to_rest,
    moves_on,
    stays_near,
)
from hybond.engine.guards.rest_records import make_room, side_of
from hybond.engine.guards.sides_seen import creeps_in
from hybond.engine.methods.control import is_propagated
from hybond.engine.methods.stepping import between, by_radau
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.reasons.warned import GUARD_AT_REST, add_about, begin_warning
from hybond.engine.surfaces.values import field
from hybond.engine.words import float_table

MOVES: Final = 0
"""A comparison does not come to rest, or nobody can tell yet; ..."""
CLEAR: Final = 1
"""... or it does, away from zero; ..."""
ZERO: Final = 2
"""... or at zero."""
MOST: Final = 64
"""States of which it is looked whether they are at rest."""
TELL: Final = 10.0
"""Times the tolerance that errors of steps may add up to, and polynomials between them may be off.
"""
PROPAGATED: Final = 1e-6
"""Part of what it was from which on a state that dies out is not known by its own digits alone,
where modes are propagated exactly: the rest is rounding, ..."""
DAMPED: Final = 1e-2
"""... and in implicit steps, of which errors die out as it does. Explicit ones go on making some
that are as large as the tolerance lets them, and so do quanta."""
DIGITS: Final = 1e-12
"""Part of a state that its tolerance is at least."""
CLEARLY: Final = 1e-4
"""Part of its terms that a comparison which crosses moves by in a step."""
CLEARER: Final = 1e-3
"""... so that it is seen by the polynomial of the step, whose slope is as right as the step is."""
SHIFT: Final = 1e-9
"""Part of its terms by which a comparison is put beside zero, clear of rounding."""
BENT: Final = 0.05
"""Part of a slope that it may differ by from the next one."""
NO_SLOPE: Final = 1e-12
"""Part of the slopes of a rate below which one is rounding."""
JUST: Final = 1e-6
"""Part of a motion that is its end."""
LITTLE: Final = 1e-8
"""Part of a state that it is moved by to see how a comparison follows."""
LATER: Final = float_table(1e-6, 1e-4, 1e-2, 0.113, 0.261, 0.372, 0.5127, 0.6291, 0.7713, 0.8837)
"""Where in what is left of the interval it is looked whether all stays at rest: unevenly."""
LOOKS: Final = 10


def see_rests(e: Engine, g: Locator) -> bool:
    """Whether a guard that holds at the instant found does so by rounding; it rests then."""
    m = e.model
    if e.slide.k > 0 or m.disks > 0 or e.states > MOST or g.failed:
        return False
    asks = False
    for k in range(g.guards):
        asks = asks or may_rest(e, g, k)
    if not asks:
        return False
    found = False
    refused = e.refusal
    evaluations = e.evaluations
    hold_guess(e, e.mode)
    for k in range(g.guards):
        if may_rest(e, g, k):
            found = is_held_by_rounding(e, g, k) or found
            # where a law ends a little farther, nothing is said of a place to rest at
            g.failed = False
    give_back_guess(e, e.mode)
    e.refusal = refused
    e.evaluations = evaluations
    g.looked = math.nan
    return found


def may_rest(e: Engine, g: Locator, k: int) -> bool:
    """Whether guard k is one of a machine written by hand, and is not seen at once to cross."""
    if g.rule[k] < 0 or g.part[k] >= 0 or g.side[k] != NO_KINK or not is_by_hand(e, g.rule[k]):
        return False
    if g.foreseen[k] != 0 and e.timetable.until[g.rule[k]] > g.at:
        return False  # what time alone decides is known not to hold yet
    return g.solved[k] == 0 or not crosses_clearly(e, g, k)


def crosses_clearly(e: Engine, g: Locator, k: int) -> bool:
    """Whether all comparisons of a guard are polynomials that go on with a clear rate.

    Most guards are asked no more than this. A ramp of time alone has no place to rest at.
    """
    s = g.sums
    step = e.step
    h = step.t1 - step.t0
    x = (g.at - step.t0) / h if h > 0.0 else 0.0
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if s.known.at[a] == 0:
            return False
        if s.first.at[a] == s.first.at[a + 1] and s.drift.at[a] != 0.0:
            continue
        at = COEFFICIENTS * a
        slope = 4.0 * g.step[at + 4] * x + 3.0 * g.step[at + 3]
        slope = (slope * x + 2.0 * g.step[at + 2]) * x + g.step[at + 1]
        size = g.extent[a]
        for p in range(s.first.at[a], s.first.at[a + 1]):
            j = s.column.at[p]
            most = max(e.largest_state[j], math.fabs(e.rests.began[j]))
            size += s.size.at[p] * most
        if not math.fabs(slope) > CLEARER * size:
            return False
    return True


def is_by_hand(e: Engine, rule: int) -> bool:
    """Whether a rule is one of a machine that is no law of a junction, nor of an element."""
    m = e.model
    for k in range(m.machines):
        if rule < m.rule_first[k + 1]:
            return m.is_law[k] == 0 and m.leads_on[k] == 0
    return False


def is_held_by_rounding(e: Engine, g: Locator, k: int) -> bool:
    """Whether guard k holds at the instant found, and would not without rounding."""
    q = e.rests
    n = e.states
    t = g.at
    first = g.atom_first[k]
    many = g.atom_first[k + 1] - first
    if q.rule[g.rule[k]] != 0 or many == 0:
        return False
    make_room(q, n, e.model.rule_first[e.model.machines], many)
    between(e, t, q.y)
    look_at_state(e, g, t, q.y)
    if not holds_here(e, g, k) or g.failed or not is_slow(e, g, k, t):
        return False
    if not find_slopes(e, g, k, t):
        return False
    copy_floats(n, q.y, q.rest)
    zeros = 0
    rests = 0
    for a in range(many):
        q.kind[a] = how_it_rests(e, g, k, a, t)
        zeros += 1 if q.kind[a] == ZERO else 0
        rests += 1 if q.kind[a] != MOVES else 0
    if rests == 0 or g.failed or holds_in_the_limit(e, g, k, t, zeros > 0):
        return False
    note_rest(e, g, k, zeros > 0)
    return True


def is_slow(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Whether a comparison of a guard would stay near zero for as long as a step is."""
    q = e.rests
    first = g.atom_first[k]
    many = g.atom_first[k + 1] - first
    for a in range(many):
        q.level[a] = atom_here(e, g, first + a)
        q.size[a] = terms_here(e, g, k, first + a)
    if field(e, e.mode, t, q.y, q.rate) != OK or not all_finite(e.states, q.rate):
        return False
    h = e.step.t1 - e.step.t0
    for a in range(many):
        q.limit[a] = math.inf
    # what bends goes elsewhere from where it is than it does from far: the eighth power of that
    for way in range(2):
        part = 1.0 if way == 0 else LITTLE
        for i in range(e.states):
            q.shifted[i] = q.y[i] + part * size_of_state(e, i)
        look_at_state(e, g, t, q.shifted)
        for a in range(many):
            there = atom_here(e, g, first + a)
            moved = math.fabs(there - q.level[a]) / part
            q.limit[a] = min(q.limit[a], moved) if math.isfinite(moved) else q.limit[a]
    for a in range(many):
        if math.isfinite(q.limit[a]):
            q.size[a] = max(q.size[a], q.limit[a])
    for i in range(e.states):
        q.shifted[i] = q.y[i] + h * q.rate[i]
    look_at_state(e, g, t, q.shifted)
    slow = False
    for a in range(many):
        there = atom_here(e, g, first + a)
        slow = slow or math.fabs(there - q.level[a]) <= CLEARLY * q.size[a]
    return slow and not g.failed


def size_of_state(e: Engine, i: int) -> float:
    """Return the size that a state has, had, or began with."""
    own = max(math.fabs(e.rests.y[i]), math.fabs(e.rests.began[i]))
    return max(own, e.largest_state[i])


def find_slopes(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Find the slopes of the rates, and of the comparisons of a guard, by differences."""
    q = e.rests
    n = e.states
    first = g.atom_first[k]
    steep = e.model.edges > 0 or e.model.begins > 0
    part = PROPAGATED if is_propagated(e) else DAMPED if by_radau(e) else 1.0
    for j in range(n):
        size = max(math.fabs(q.y[j]), part * size_of_state(e, j))
        atol = e.model.atol if e.model.atol == e.model.atol else 0.0
        q.tell[j] = TELL * (max(e.model.rtol, DIGITS) * size + atol)
        if not (q.tell[j] > 0.0 and q.tell[j] < math.inf):
            q.tell[j] = TELL * e.model.rtol
        q.shifted[j] = q.y[j]
    for j in range(n):
        size = max(size_of_state(e, j), q.tell[j] / TELL)
        q.shifted[j] = q.y[j] + math.sqrt(EPSILON) * size
        width = q.shifted[j] - q.y[j]
        if field(e, e.mode, t, q.shifted, q.other) != OK or not all_finite(n, q.other):
            return False
        for i in range(n):
            q.jacobian[i * n + j] = (q.other[i] - q.rate[i]) / width
        if steep and not is_straight(e, j, t, width):
            return False
        look_at_state(e, g, t, q.shifted)
        for a in range(first, g.atom_first[k + 1]):
            there = atom_here(e, g, a)
            q.slope[(a - first) * n + j] = (there - q.level[a - first]) / width
        q.shifted[j] = q.y[j]
    return not g.failed


def is_straight(e: Engine, j: int, t: float, width: float) -> bool:
    """Whether slopes on a state are the same a little farther: it is not beside a root's end.

    What runs out by a root is at its end in finite time.
    """
    q = e.rests
    n = e.states
    beside = q.shifted[j]
    q.shifted[j] = beside + width
    if field(e, e.mode, t, q.shifted, q.other) != OK or not all_finite(n, q.other):
        return False
    q.shifted[j] = beside
    for i in range(n):
        change = q.jacobian[i * n + j] * width
        bent = q.other[i] - q.rate[i] - 2.0 * change
        if not math.fabs(bent) <= BENT * math.fabs(change) + NO_SLOPE * math.fabs(q.rate[i]):
            return False
    return True


def how_it_rests(e: Engine, g: Locator, k: int, a: int, t: float) -> int:
    """Say how comparison a of guard k comes to rest; put what it depends on where it does so."""
    q = e.rests
    n = e.states
    which = g.atom_first[k] + a
    size = q.size[a]
    near = 2.0 * ROUNDING * size
    for j in range(n):
        near += math.fabs(q.slope[a * n + j]) * q.tell[j]
    q.near[a] = near
    if not math.fabs(q.level[a]) <= near or was_zero(e, g, k, which):
        return MOVES
    many = find_inside(e, g, k, a)
    if creeps_in(e, g, which, t):
        return ZERO
    if many < 0 or not find_limit(e, many):
        return MOVES
    if many == 0 and (q.driver[a] >= 0 or is_reached(e, g, which, t, size)):
        return MOVES
    end = min(e.next_break, e.stop)
    limit = 0.0
    for i in range(LOOKS + 1):
        later = t if i == 0 else t + LATER[i - 1] * (end - t)
        if not lead_to_rest(e, many, later) or (i == 0 and not stays_near(e, a, many)):
            return MOVES
        if i == 0 and moves_on(e, many, t, end):
            return MOVES
        look_at_state(e, g, later, q.shifted)
        there = atom_here(e, g, which)
        if not math.fabs(there - (limit if i > 0 else q.level[a])) <= near:
            return MOVES
        limit = there
    kind = ZERO if math.fabs(limit) <= ROUNDING * size else CLEAR
    if kind == CLEAR and many == 0:
        return MOVES
    for i in range(many):
        q.rest[q.place[i]] = q.shifted[q.place[i]]
    q.limit[a] = limit
    return kind


def keep_side(e: Engine, g: Locator, k: int, a: int) -> None:
    """Keep comparison a of guard k where it was, or on the side that its limit is on."""
    q = e.rests
    which = g.atom[g.atom_first[k] + a]
    q.some = True
    q.atom[which] = q.kind[a]
    q.away[which] = 0
    q.band[which] = 2.0 * q.near[a]
    q.extent[which] = q.size[a]
    if q.kind[a] == CLEAR:
        q.side[which] = 1 if q.limit[a] > 0.0 else -1
        q.turns[which] = 0


def was_zero(e: Engine, g: Locator, k: int, a: int) -> bool:
    """Whether a comparison is zero since the motion began: it is equal then, not nearly equal."""
    q = e.rests
    size = q.size[a - g.atom_first[k]]
    if q.since[g.rule[k]] != 0:
        return False
    look_at_state(e, g, q.began_at, q.began)
    began = atom_here(e, g, a)
    look_at_state(e, g, e.step.t0, e.step.y0)
    before = atom_here(e, g, a)
    return math.fabs(began) <= ROUNDING * size and math.fabs(before) <= ROUNDING * size


def is_reached(e: Engine, g: Locator, a: int, t: float, size: float) -> bool:
    """Whether what has no slope came to zero with a clear rate, and stays: it is cut off, or jumps.

    So it does if it was clear of zero a last part of its way before.
    """
    q = e.rests
    back = JUST * (t - q.began_at)
    for i in range(e.states):
        q.shifted[i] = q.y[i] - back * q.rate[i]
    look_at_state(e, g, t - back, q.shifted)
    here = atom_here(e, g, a)
    return not math.fabs(here) <= 4.0 * ROUNDING * size


def find_inside(e: Engine, g: Locator, k: int, a: int) -> int:
    """Put the states there that a comparison depends on; return how many, -1 if one just moves.

    What nothing moves has no part in it. A comparison without a slope, as of a cube at zero, may be
    moved by what is farther.
    """
    q = e.rests
    n = e.states
    size = q.size[a]
    best = 0.0
    q.driver[a] = -1
    for j in range(n):
        part = math.fabs(q.slope[a * n + j]) * q.tell[j]
        q.inside[j] = 1 if part > 0.0 and part > ROUNDING * q.tell[j] * size else 0
        if q.inside[j] != 0 and part > best:
            best = part
            q.driver[a] = j
    if best == 0.0:
        find_felt(e, g, g.atom_first[k] + a, size)
    for i in range(n):
        q.largest[i] = 0.0
        for j in range(n):
            q.largest[i] = max(q.largest[i], math.fabs(q.jacobian[i * n + j]) * q.tell[j])
    grown = True
    while grown:
        grown = False
        for i in range(n):
            for j in range(n if q.inside[i] != 0 else 0):
                part = math.fabs(q.jacobian[i * n + j]) * q.tell[j]
                if q.inside[j] == 0 and part > NO_SLOPE * q.largest[i]:
                    q.inside[j] = 1
                    grown = True
    many = 0
    for j in range(n):
        if q.inside[j] == 0:
            continue
        if q.largest[j] > 0.0:
            q.place[many] = j
            many += 1
        elif q.rate[j] != 0.0:
            return -1
    return many


def holds_in_the_limit(e: Engine, g: Locator, k: int, t: float, doubtful: bool) -> bool:
    """Whether a guard holds with what comes to rest in its limit, zeros being either sign."""
    q = e.rests
    if not doubtful:
        look_at_state(e, g, t, q.rest)
        holds = holds_here(e, g, k)
        if holds:
            warn_of_instant(e, g, k)
        return holds
    for a in range(g.atom_first[k + 1] - g.atom_first[k]):
        if q.kind[a] == ZERO and q.driver[a] < 0:
            return False
    put_beside(e, g, k, 1.0)
    look_at_state(e, g, t, q.shifted)
    above = holds_here(e, g, k)
    put_beside(e, g, k, -1.0)
    look_at_state(e, g, t, q.shifted)
    below = holds_here(e, g, k)
    return above and below


def put_beside(e: Engine, g: Locator, k: int, sign: float) -> None:
    """Put the state there with comparisons that rest at zero clear of it, where they were last.

    Of those that never were, all are on one side.
    """
    q = e.rests
    n = e.states
    copy_floats(n, q.rest, q.shifted)
    for a in range(g.atom_first[k + 1] - g.atom_first[k]):
        j = q.driver[a]
        if q.kind[a] == ZERO and j >= 0:
            side = side_of(q, g.atom[g.atom_first[k] + a])
            own = float(side) if side != 0 else sign
            q.shifted[j] = q.rest[j] + own * SHIFT * q.size[a] / q.slope[a * n + j]


def note_rest(e: Engine, g: Locator, k: int, doubtful: bool) -> None:
    """Note that a guard holds by rounding, and warn of it once, if nothing else can tell."""
    q = e.rests
    rule = g.rule[k]
    n = e.states
    q.rule[rule] = 1
    q.since[rule] = 1
    q.any = True
    for a in range(g.atom_first[k + 1] - g.atom_first[k]):
        if q.kind[a] != MOVES:
            keep_side(e, g, k, a)
    for way in range(2):
        if doubtful:
            put_beside(e, g, k, 1.0 if way == 0 else -1.0)
        for i in range(n):
            still = q.rest[i] == q.y[i] and (not doubtful or q.shifted[i] == q.rest[i])
            q.kept[rule * n + i] = math.nan if still else q.rest[i]
            aside = q.shifted[i] - q.rest[i] if doubtful else 0.0
            if way == 0:
                q.aside[rule * n + i] = aside
            else:
                q.across[rule * n + i] = aside
    if e.model.tells == 0 or q.said[rule] != 0 or not doubtful:
        return
    q.said[rule] = 1
    least = math.inf
    part = 0.0
    for a in range(g.atom_first[k + 1] - g.atom_first[k]):
        if q.kind[a] == ZERO and math.fabs(q.level[a]) < math.fabs(least):
            least = q.level[a]
            part = q.size[a]
    begin_warning(e.warned, GUARD_AT_REST, g.at)
    add_about(e.warned, float(rule))
    add_about(e.warned, 0.0)
    add_about(e.warned, least)
    add_about(e.warned, part)


def warn_of_instant(e: Engine, g: Locator, k: int) -> None:
    """Warn once of a guard that fires so near to where the motion rests that nobody can tell when.

    The values are those of the limit.
    """
    q = e.rests
    rule = g.rule[k]
    for a in range(g.atom_first[k + 1] - g.atom_first[k]):
        if e.model.tells == 0 or q.said[rule] != 0 or q.kind[a] != CLEAR:
            continue
        there = atom_here(e, g, g.atom_first[k] + a)
        if math.fabs(there) <= q.near[a]:
            q.said[rule] = 1
            begin_warning(e.warned, GUARD_AT_REST, g.at)
            add_about(e.warned, float(rule))
            add_about(e.warned, 1.0)
            add_about(e.warned, there)
            add_about(e.warned, q.near[a])
