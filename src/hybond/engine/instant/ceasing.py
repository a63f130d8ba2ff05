"""A cycle of modes that is left where time goes on: what ceases within one instant does not hold.

Two switches fall off their thresholds together. One is located a last place sooner than the other,
whose comparison is not told from equality there: so its guard holds still, and leads back, and
time could not advance. It would not hold a moment later. So where modes come back at an instant
it is asked of each whether what leads out of it would hold if time went on there. A mode out of
which nothing leads then is the one that stands, and its guards wait as long as what they compare
is not told from its threshold.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds_from
from hybond.engine.guards.waiting import let_wait, place_of, wake_all
from hybond.engine.instant.enabled import find_enabled, is_standing, is_struck
from hybond.engine.instant.settling import Settling, comes_back
from hybond.engine.laws.entering import enter
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.mode.equations import is_fieldless
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import evaluate, field

MODES: Final = 64
"""Of a cycle of which it is asked whether one of them stands, and so many cycles of an instant."""
FARTHEST: Final = 1e3
"""Times the run after which it is looked at the last: a run may be shorter than an instant is."""
BESIDE: Final = 1e-9
"""Part of its terms by which a comparison has left its threshold then, and no more."""
SOONER: Final = 8.0
"""Last places of the time after which it is looked first, ..."""
LATER: Final = 4.0
"""... and times as long each time after that."""


def is_over(e: Engine, g: Settling, fired: int) -> bool:
    """Whether anything changes at the instant, and rules wait since another: the motion is over."""
    if not e.rests.some_wait or g.stands > 0 or fired < 0:
        return False
    return fired > 0 or e.trial.jumps or not is_standing(e, g)


def find_standing(e: Engine, g: Settling) -> bool:
    """Find a mode that stands among those that have come back; its guards wait for a moment.

    The trial is the one that has come back, and is so again.
    """
    g.stands += 1
    if e.slide.many > 0 or g.stands > MODES:
        return False
    found = False
    for _ in range(MODES):
        if not is_held_by_impulse(e, g) and not is_fieldless(e, e.mode):
            found = stands_on(e, g)
        for k in range(e.model.machines):
            g.entered[k] = g.target[k]
        if found or enter(e, e.t, g.x, g.s, g.entered, True, False) != OK:
            break
        if comes_back(e, g):
            break
        fired = find_enabled(e, g, e.t)
        found = fired == 0  # rounding has led out of it, and does not again
        if fired <= 0:
            break
    for k in range(e.model.machines):
        g.entered[k] = g.mark_state[k]
    if enter(e, e.t, g.x, g.s, g.entered, True, False) != OK:
        return False
    if found:
        g.marked = False
        g.tries = 0
        g.turn = 1
    return found


def is_held_by_impulse(e: Engine, g: Settling) -> bool:
    """Whether what holds in the trial reads an impulse: that is over a moment later anyhow."""
    for r in range(e.model.rule_first[e.model.machines]):
        if g.held[r] != 0 and is_struck(e, r):
            return True
    return False


def stands_on(e: Engine, g: Settling) -> bool:
    """Whether nothing that holds in the trial does so a moment later; if so, it waits for that."""
    m = e.model
    refused = e.refusal
    evaluations = e.evaluations
    stood = e.standing.some
    e.standing.some = False
    hold_guess(e, e.mode)
    copy_floats(2 * m.slots, e.v, g.moment_values)
    copy_floats(2 * m.bonds, e.work.w, g.moment_bonds)
    moment = moment_after(e, g)
    copy_floats(2 * m.slots, g.moment_values, e.v)
    copy_floats(2 * m.bonds, g.moment_bonds, e.work.w)
    give_back_guess(e, e.mode)
    e.standing.some = stood
    e.evaluations = evaluations
    e.refusal = refused
    if moment == math.inf:
        return False
    wake_all(e)
    for k in range(m.machines):
        g.stand_state[k] = e.trial.state[k]
    for r in range(m.rule_first[m.machines]):
        if g.held[r] != 0:
            let_wait(e, r, moment, e.v, e.trial.terms)
    return True


def moment_after(e: Engine, g: Settling) -> float:
    """Return an instant at which nothing that holds in the trial does so any more, or infinity."""
    m = e.model
    instant = room_of_instant(e, e.t)
    longest = max(FARTHEST * e.span, instant)
    for r in range(m.rule_first[m.machines]):
        if g.held[r] != 0 and not is_at_threshold(e, g, r):
            longest = instant
    later = SOONER * spacing(e.t)
    while later <= longest:
        if not move_on(e, g, e.t, later):
            return math.inf
        left = True
        for r in range(m.rule_first[m.machines]):
            left = left and (g.held[r] == 0 or ceases(e, g, r, later > instant))
        if left:
            return e.t + later
        later = LATER * later
    return math.inf


def is_at_threshold(e: Engine, g: Settling, r: int) -> bool:
    """Whether a comparison of a rule is not told from equality in the trial."""
    m = e.model
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if place_of(e, r, a, g.moment_values, e.trial.terms) == 0.0:
            return True
    return False


def ceases(e: Engine, g: Settling, r: int, beside: bool) -> bool:
    """Whether a rule does not hold at the values a moment later, by what was at its threshold.

    That is `beside` it still, if more than an instant is gone. What was before stays what it was:
    a guard that holds by that does so for all of the instant.
    """
    m = e.model
    stack = e.work.stack
    stack.now = e.v
    stack.was = e.pre
    stack.was_first = 0
    stack.jump = e.v
    stack.jumps = False
    stack.terms = e.trial.terms
    stack.prior_terms = e.trial.prior_terms
    true = holds_from(m, r, stack, 0.0)
    if true or stack.refused != 0:
        return False
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        before = value(m, m.atom_value[a], g.moment_values)
        here = value(m, m.atom_value[a], e.v)
        equal = place_of(e, r, a, g.moment_values, e.trial.terms) == 0.0
        # nothing jumps between pieces of a law: which of them it is in an instant changes nothing
        if before * here < 0.0 and not equal and m.rule_piece[r] == 0:
            return False
        size = value(m, m.atom_size[a], g.moment_values)
        if beside and equal and not math.fabs(here) <= BESIDE * size:
            return False
    return True


def move_on(e: Engine, g: Settling, t: float, h: float) -> bool:
    """Put the values there that the trial leads to in its own mode after `h`: a step of order 4."""
    n = e.states
    copy_part(e.model.storages, e.trial.x, 0, g.moment_from, 0)
    copy_part(e.model.integrals, e.trial.s, 0, g.moment_from, e.model.storages)
    for k in range(n):
        g.moment_sum[k] = 0.0
    copy_floats(n, g.moment_from, g.moment)
    at = t
    for stage in range(4):
        if field(e, e.mode, at, g.moment, g.moment_rate) != OK:
            return False
        weight = 1.0 if stage == 0 or stage == 3 else 2.0
        part = 0.5 * h if stage < 2 else h
        at = t + part
        for k in range(n):
            g.moment_sum[k] += weight * g.moment_rate[k]
            g.moment[k] = g.moment_from[k] + part * g.moment_rate[k]
    for k in range(n):
        g.moment[k] = g.moment_from[k] + h * g.moment_sum[k] / 6.0
        if not math.isfinite(g.moment[k]):
            return False
    return evaluate(e, e.mode, e.v, t + h, g.moment) == OK
