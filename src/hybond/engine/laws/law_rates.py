"""How fast what laws decide on moves, at an instant and a moment after it.

Where a finite value and its rate are both zero, rounding must not decide: an instant is located to
its last place only, and at the peak of a sine the sign of a rate is that of what location left.
Then the rate that counts is the mean of the shortest time in which the value becomes more than
rounding.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.laws.law_instant import LAW_ZERO
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import open_mode, rates_of_stored, solve_with
from hybond.engine.laws.response import rates_of_linear
from hybond.engine.mode.guess import give_back_guess, hold_guess
from hybond.engine.mode.sizes import size_of
from hybond.engine.mode.values import set_values
from hybond.engine.sliding.averages import solve_here

AHEAD: Final = 1e-9
"""The time over which a change of rates is looked at, as a part of the run."""
TURNS: Final = 1e-3
"""A rate below this part of its terms may be about to change its sign."""
BENT: Final = 1e-11
"""A change of rates is none below this part of their terms."""
ROUNDED: Final = 1e-15
"""Part of its terms that a bond variable may move by rounding."""
SEEN: Final = 0.1
"""Part of what counts as zero from which on a guard sees a value."""


def look_ahead(e: Engine, r: Laws) -> int:
    """Replace rates of values that are zero, and that turn, by those of the time after the instant.

    Those of a nonlinear graph are differences over a short while already.
    """
    m = e.model
    a = r.response
    if not r.now.linear:
        return OK
    turns = False
    for k in range(m.ports):
        turns = turns or may_turn(r, k)
    if not turns:
        return OK
    step = AHEAD * max(e.span, math.fabs(r.t))
    for k in range(m.storages):
        r.moved[k] = r.x[k] + step * r.field[k]
    for k in range(m.integrals):
        r.later_s[k] = r.s[k] + step * value(m, m.integral_rate[k], r.v)
    set_values(e, open_mode(e, r.now), r.later, r.t + step, r.moved, r.later_s)
    for k in range(m.slots):
        r.later[m.slots + k] = e.pre[k]
    for k in range(m.ports):
        r.l[k] = 0.0
    if solve_with(e, r.now, r.later, r.l) != OK:
        return REFUSED
    rates_of_linear(e, r, r.later, e.work.w, r.rate_after, r.rate_terms)
    for k in range(m.ports):
        change = r.rate_after[k] - a.rate[k]
        if not may_turn(r, k) or math.fabs(change) <= BENT * max(r.rate_terms[k], a.rate_size[k]):
            continue
        seen = SEEN * LAW_ZERO * r.rounding[k]
        bend = change / step
        h = math.sqrt(2.0 * seen / math.fabs(bend))
        if a.rate[k] != 0.0:
            h = min(h, seen / math.fabs(a.rate[k]))
        a.rate[k] += 0.5 * bend * h
    return OK


def may_turn(r: Laws, k: int) -> bool:
    """Whether a value is zero and its rate small beside the terms of that."""
    a = r.response
    still = math.fabs(a.y[k]) <= LAW_ZERO * r.rounding[k]
    return still and math.fabs(a.rate[k]) <= TURNS * a.rate_size[k]


def turns_at_once(e: Engine, r: Laws, t: float) -> bool:
    """Find the laws of the trial that are violated as soon as time passes, as find_broken does.

    A diode whose current is zero, and whose voltage is, conducts or blocks as its own motion says a
    moment later; what an answer of the laws leaves of that is rounding of far larger currents.
    """
    m = e.model
    mode = e.mode
    step = AHEAD * max(e.span, math.fabs(t))
    r.answered = False
    r.broken = 0
    for k in range(m.storages):
        r.moved[k] = e.trial.x[k]
    for k in range(m.integrals):
        r.later_s[k] = e.trial.s[k]
    for i in range(2 * m.slots):
        r.later[i] = e.v[i]
    hold_guess(e, mode)
    found = OK
    for turn in range(2):
        if found != OK:
            continue
        if turn > 0:
            for a in range(m.atom_first[m.rule_first[m.machines]]):
                r.atom[a] = value(m, m.atom_value[a], r.later)
        for b in range(2 * m.bonds):
            r.zero[b] = r.later[m.bond_slot + b]
        rates_of_stored(m, r.zero, 1, 0, r.field)
        for k in range(m.storages):
            r.moved[k] += step * r.field[k]
        for k in range(m.integrals):
            r.later_s[k] += step * value(m, m.integral_rate[k], r.later)
        set_values(e, mode, r.later, t + float(turn + 1) * step, r.moved, r.later_s)
        found = solve_here(e, mode, r.later)
    give_back_guess(e, mode)
    if found != OK:
        return False
    for k in range(m.machines if m.laws > 0 else 0):
        if m.is_law[k] != 0:
            turn_ahead(e, r, k)
    return r.broken > 0


def turn_ahead(e: Engine, r: Laws, k: int) -> None:
    """Note the rule of a law that does not hold yet, but does so a moment later."""
    m = e.model
    for rule in range(m.rule_first[k], m.rule_first[k + 1]):
        if m.rule_source[rule] != e.trial.state[k] or value(m, m.rule_test[rule], r.later) == 0.0:
            continue
        noise = 0.0
        for i in range(m.read_first[rule], m.read_first[rule + 1]):
            b = m.read_slot[i] - m.bond_slot
            if 0 <= b and b < 2 * m.bonds:
                size = size_of(e, e.mode, b, e.work.xi, r.later)
                noise += ROUNDED * size
        turned = True
        for a in range(m.atom_first[rule], m.atom_first[rule + 1]):
            moved = value(m, m.atom_value[a], r.later) - r.atom[a]
            turned = turned and math.fabs(moved) > noise
        if turned:
            r.broken_machine[r.broken] = k
            r.broken_target[r.broken] = m.rule_target[rule]
            r.broken += 1
            return
