"""How fast what laws decide on moves, at an instant and a moment after it.

Where a finite value and its rate are both zero, rounding must not decide: an instant is located to
its last place only, and at the peak of a sine the sign of a rate is that of what location left.
Then the rate that counts is the mean of the shortest time in which the value becomes more than
rounding.

Where what laws give acts on a value at once, and the value is zero but for rounding, so is the rate
that this rounding has: a current that dies away in nanoseconds would do so at its own rate. There
the rate that counts is that at which the value is zero.

Where sources agree at this instant only, there are as many rates as there are sources to follow,
and which of them the equations take is a matter of the order of declaration. None of them counts.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.algebra.svd import least_squares
from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.laws.law_instant import LAW_ZERO
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import open_mode, rates_of_stored, solve_with, times_partner
from hybond.engine.laws.response import SHORT_WHILE, rates_of_linear
from hybond.engine.mode.digits.sizes import size_of
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.agreement import AGREE
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.nonlinear.newton import source_of
from hybond.engine.surfaces.averages import solve_here
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats

AHEAD: Final = 1e-9
"""The time over which a change of rates is looked at, as a part of the run."""
TURNS: Final = 1e-3
"""A rate below this part of its terms may be about to change its sign."""
BENT: Final = 1e-11
"""A change of rates is none below this part of their terms."""
ROUNDED: Final = 1e-15
"""Part of its terms that a bond variable may move by rounding."""
NO_VALUES_AHEAD: Final = -1
"""What stands for the laws that are violated where a moment later nothing has values."""
PARTING: Final = 0
RATES: Final = 1
SIZES: Final = 2
"""What is summed over sources that must agree."""
SEEN: Final = 0.1
"""Part of what counts as zero from which on a guard sees a value."""
ALIKE: Final = 1e-10
"""Part of what one law does at once below which what it does beside others is nothing new."""
LEFT: Final = 1e-6
"""Part of a value that what laws give has to leave of it, where it makes it zero."""


def take_later_rates(e: Engine, r: Laws) -> int:
    """Replace rates of values that are zero, and that turn, by those of the time after the instant.

    Those of a nonlinear graph are differences over a short while already.
    """
    m = e.model
    a = r.response
    if open_mode(e, r.now).agreements.rows > 0:
        if part_ways(e, r) != OK:
            return REFUSED
        if r.parting:
            for k in range(m.ports):
                a.rate[k] = 0.0
            return OK
    if not r.now.linear:
        return OK if rates_at_zero(e, r) == OK else REFUSED
    turns = False
    for k in range(m.ports):
        turns = turns or may_turn(r, k)
    if not turns:
        return OK
    step = AHEAD * max(e.span, math.fabs(r.t))
    if solve_ahead(e, r, step) != OK:
        return REFUSED
    rates_of_linear(e, r, r.later, e.work.w, r.rate_after, r.rate_terms)
    # of one time for all, and for those that do not turn: what adds up to zero, such as currents of
    # diodes that only another one could carry away, or the motions of a row between two walls,
    # would not do so at a time of its own for each
    first = math.inf
    for k in range(m.ports):
        if bends_at(r, k):
            seen = SEEN * LAW_ZERO * r.rounding[k]
            bend = (r.rate_after[k] - a.rate[k]) / step
            first = min(first, math.sqrt(2.0 * seen / math.fabs(bend)))
            if a.rate[k] != 0.0:
                first = min(first, seen / math.fabs(a.rate[k]))
    for k in range(m.ports):
        if first < math.inf and changes_at(r, k):
            a.rate[k] += 0.5 * (r.rate_after[k] - a.rate[k]) / step * first
    return OK


def rates_at_zero(e: Engine, r: Laws) -> int:
    """Replace the rates of a nonlinear graph by those where values that are rounding are zero."""
    m = e.model
    n = m.ports
    a = r.response
    many = 0
    for k in range(n):
        r.l[k] = 0.0
        rounded = a.y[k] != 0.0 and math.fabs(a.y[k]) <= LAW_ZERO * r.rounding[k]
        if rounded and a.d[k * n + k] != 0.0:
            r.tried[many] = k
            many += 1
    if many == 0:
        return OK
    for i in range(many):
        r.row[i] = -a.y[r.tried[i]]
        for j in range(many):
            r.block[i * many + j] = a.d[r.tried[i] * n + r.tried[j]]
    least_squares(r.svd, many, many, r.block, ALIKE, 1, r.row, r.basis)
    if not all_finite(many, r.basis):
        return OK
    for i in range(many):
        left = a.y[r.tried[i]]
        for j in range(many):
            left += a.d[r.tried[i] * n + r.tried[j]] * r.basis[j]
        if not math.fabs(left) <= LEFT * math.fabs(a.y[r.tried[i]]):
            return OK
    for i in range(many):
        r.l[r.tried[i]] = r.basis[i]
    mode = open_mode(e, r.now)
    hold_guess(e, mode)
    found = rates_with(e, r)
    give_back_guess(e, mode)
    return found


def rates_with(e: Engine, r: Laws) -> int:
    """Put the rates there that a nonlinear graph has while laws give `r.l`."""
    m = e.model
    a = r.response
    mode = open_mode(e, r.now)
    step = SHORT_WHILE * min(e.span, 1.0)
    for turn in range(2):
        for k in range(m.storages):
            r.moved[k] = r.x[k] + (step * r.field[k] if turn > 0 else 0.0)
        for k in range(m.integrals):
            rate = value(m, m.integral_rate[k], r.later) if turn > 0 else 0.0
            r.later_s[k] = r.s[k] + step * rate
        set_values(e, mode, r.later, r.t + step * float(turn), r.moved, r.later_s)
        copy_part(m.slots, e.pre, 0, r.later, m.slots)
        if solve_with(e, r.now, r.later, r.l) != OK:
            return REFUSED
        times_partner(m, r.now, e.work.w, r.rate_after if turn > 0 else r.row)
        if turn == 0:
            rates_of_stored(m, e.work.w, 1, 0, r.field)
    for k in range(m.ports):
        a.rate[k] = (r.rate_after[k] - r.row[k]) / step
    return OK


def bends_at(r: Laws, k: int) -> bool:
    """Whether a rate that may turn changes by more than rounding."""
    return may_turn(r, k) and changes_at(r, k)


def changes_at(r: Laws, k: int) -> bool:
    """Whether a rate changes by more than rounding."""
    change = math.fabs(r.rate_after[k] - r.response.rate[k])
    return change > BENT * max(r.rate_terms[k], r.response.rate_size[k])


def solve_ahead(e: Engine, r: Laws, step: float) -> int:
    """Put the values a `step` later, laws giving nothing, into `r.later` and ``e.work.w``."""
    m = e.model
    for k in range(m.storages):
        r.moved[k] = r.x[k] + step * r.field[k]
    for k in range(m.integrals):
        r.later_s[k] = r.s[k] + step * value(m, m.integral_rate[k], r.v)
    set_values(e, open_mode(e, r.now), r.later, r.t + step, r.moved, r.later_s)
    copy_part(m.slots, e.pre, 0, r.later, m.slots)
    for k in range(m.ports):
        r.l[k] = 0.0
    return solve_with(e, r.now, r.later, r.l)


def part_ways(e: Engine, r: Laws) -> int:
    """Find whether sources that must agree, and do so now, part as soon as time passes.

    They do if going on as they begin, for as long as the run is, would take them apart by more than
    they may differ: at their rates, or as these change. The motion is refused then, if any follows.
    """
    mode = open_mode(e, r.now)
    whole = max(e.span, math.fabs(r.t))
    step = AHEAD * whole
    r.parting = False
    if solve_ahead(e, r, step) != OK:
        return REFUSED
    for i in range(mode.agreements.rows):
        size = over_sources(e, mode, i, r.v, SIZES)
        rate = over_sources(e, mode, i, r.v, RATES)
        rate = max(rate, over_sources(e, mode, i, r.later, RATES))
        first = over_sources(e, mode, i, r.v, PARTING)
        change = over_sources(e, mode, i, r.later, PARTING) - first
        if math.fabs(change) <= BENT * (rate + size / whole):
            change = 0.0
        bend = change / step
        most = size + whole * rate
        apart = max(math.fabs(first), 0.5 * whole * math.fabs(bend)) * whole
        r.parting = r.parting or apart > AGREE * most
    return OK


def over_sources(e: Engine, mode: Mode, row: int, v: Floats, what: int) -> float:
    """Return how fast sources that must agree part, or the sizes of their rates, or values."""
    m = e.model
    rows = mode.agreements
    total = 0.0
    for i in range(rows.first.at[row], rows.first.at[row + 1]):
        k = rows.column.at[i] - m.storages
        own = 0.0
        if what == SIZES:
            own = source_of(e, mode, k, v)
        elif mode.source[k] >= 0 and m.source_rate[mode.source[k]] >= 0:
            own = value(m, m.source_rate[mode.source[k]], v)
        term = rows.value.at[i] * own
        total += term if what == PARTING else math.fabs(term)
    return total


def may_turn(r: Laws, k: int) -> bool:
    """Whether a value is zero and its rate small beside the terms of that."""
    a = r.response
    still = math.fabs(a.y[k]) <= LAW_ZERO * r.rounding[k]
    return still and math.fabs(a.rate[k]) <= TURNS * a.rate_size[k]


def turns_at_once(e: Engine, r: Laws, t: float) -> bool:
    """Find the laws of the trial that are violated as soon as time passes, as find_broken does.

    A diode whose current is zero, and whose voltage is, conducts or blocks as its own motion says a
    moment later; what an answer of the laws leaves of that is rounding of far larger currents.
    Where there are no values a moment later `r.broken` says so.
    """
    m = e.model
    mode = e.mode
    step = AHEAD * max(e.span, math.fabs(t))
    r.answered = False
    r.broken = 0
    copy_floats(m.storages, e.trial.x, r.moved)
    copy_floats(m.integrals, e.trial.s, r.later_s)
    copy_floats(2 * m.slots, e.v, r.later)
    hold_guess(e, mode)
    found = OK
    for turn in range(2):
        if found != OK:
            continue
        if turn > 0:
            for a in range(m.atom_first[m.rule_first[m.machines]]):
                r.atom[a] = value(m, m.atom_value[a], r.later)
        copy_part(2 * m.bonds, r.later, m.bond_slot, r.zero, 0)
        rates_of_stored(m, r.zero, 1, 0, r.field)
        for k in range(m.storages):
            r.moved[k] += step * r.field[k]
        for k in range(m.integrals):
            r.later_s[k] += step * value(m, m.integral_rate[k], r.later)
        set_values(e, mode, r.later, t + float(turn + 1) * step, r.moved, r.later_s)
        found = solve_here(e, mode, r.later)
    give_back_guess(e, mode)
    if found != OK:
        r.broken = NO_VALUES_AHEAD
        return False
    for k in range(m.machines if m.laws > 0 else 0):
        if m.is_law[k] != 0 and not strikes_next(e, r, k):
            turn_ahead(e, r, k)
    return r.broken > 0


def strikes_next(e: Engine, r: Laws, k: int) -> bool:
    """Whether what machine k is the law of still approaches, to strike in the next jump."""
    # it carries nothing: OFF, or ON where it is the common variable that approaches zero
    comes = r.comes[k] == e.trial.state[k] + 1
    return comes and not r.unanswered and not r.leaps


def is_at_an_end(e: Engine) -> bool:
    """Whether a law of the trial has come to an end of its branch: to rounding of what it reads."""
    m = e.model
    for k in range(m.machines):
        if m.is_law[k] == 0:
            continue
        for rule in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_source[rule] != e.trial.state[k]:
                continue
            zero = LAW_ZERO * size_of_rule(e, rule, e.v)
            for a in range(m.atom_first[rule], m.atom_first[rule + 1]):
                if math.fabs(value(m, m.atom_value[a], e.v)) <= zero:
                    return True
    return False


def size_of_rule(e: Engine, rule: int, v: Floats) -> float:
    """Return the sizes of the terms of all bond variables that a rule reads."""
    m = e.model
    size = 0.0
    for i in range(m.read_first[rule], m.read_first[rule + 1]):
        b = m.read_slot[i] - m.bond_slot
        if 0 <= b and b < 2 * m.bonds:
            own = size_of(e, e.mode, b, e.work.xi, v)
            size += own
    return size


def turn_ahead(e: Engine, r: Laws, k: int) -> None:
    """Note the rule of a law that does not hold yet, but does so a moment later."""
    m = e.model
    for rule in range(m.rule_first[k], m.rule_first[k + 1]):
        if m.rule_source[rule] != e.trial.state[k] or value(m, m.rule_test[rule], r.later) == 0.0:
            continue
        noise = ROUNDED * size_of_rule(e, rule, r.later)
        turned = True
        for a in range(m.atom_first[rule], m.atom_first[rule + 1]):
            moved = value(m, m.atom_value[a], r.later) - r.atom[a]
            turned = turned and math.fabs(moved) > noise
        if turned:
            r.broken_machine[r.broken] = k
            r.broken_target[r.broken] = m.rule_target[rule]
            r.broken += 1
            return
