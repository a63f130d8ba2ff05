"""Which rules hold in a trial: the transitions that all machines take at once."""

from __future__ import annotations

from hybond.engine.answers import rule_text
from hybond.engine.engine import Engine, say_fault
from hybond.engine.expressions.paired import holds_from
from hybond.engine.guards.in_force import is_asked
from hybond.engine.guards.kept_sides import NOT_ASKED, holds_on_sides, warn_of_kept
from hybond.engine.guards.limits_crossed import level_of
from hybond.engine.guards.waiting import waits
from hybond.engine.instant.indeterminate import (
    DECIDED,
    is_indeterminate,
    tell_open_rule,
    warn_of_open,
)
from hybond.engine.instant.settling import Settling
from hybond.engine.jumps.trial import measure_trial, refuse_pair, show_trial
from hybond.engine.reasons.facts import add_fact


def find_enabled(e: Engine, g: Settling, t: float) -> int:
    """Find the transitions of all machines at once; return how many fire, -1 if one has no truth.

    Each machine takes the first of its rules that hold.
    """
    m = e.model
    fired = 0
    show_trial(e, e.work.stack)
    for k in range(m.machines):
        g.target[k] = e.trial.state[k]
        if m.is_law[k] != 0:
            continue
        chosen = False
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            g.held[r] = 0
            if e.slide.many == 0 and m.rule_source[r] != e.trial.state[k]:
                continue  # most of them
            if not is_asked(e, k, r, e.trial.state[k]):
                continue
            true = rule_holds(e, t, k, r)
            if true < 0:
                return -1
            if true > 0 and waits_in_trial(e, g, r, t):
                true = 0
            g.held[r] = true
            if true > 0 and not chosen:
                chosen = True
                fired += 1
                g.target[k] = m.rule_target[r]
    return fired


def waits_in_trial(e: Engine, g: Settling, r: int, t: float) -> bool:
    """Whether a rule that holds waits, as the trial is the mode that was found to stand."""
    if not e.rests.some_wait or is_struck(e, r) or not is_standing(e, g):
        return False
    return waits(e, r, t, e.v, e.trial.terms)


def is_standing(e: Engine, g: Settling) -> bool:
    """Whether the trial is of the mode that was found to stand."""
    for k in range(e.model.machines):
        if e.trial.state[k] != g.stand_state[k]:
            return False
    return True


def is_struck(e: Engine, r: int) -> bool:
    """Whether what a rule reads carries an impulse in the trial."""
    m = e.model
    for p in range(m.read_first[r], m.read_first[r + 1] if e.trial.jumps else 0):
        if e.trial.jump[m.read_slot[p]] != 0.0:
            return True
    return False


def rule_holds(e: Engine, t: float, k: int, r: int) -> int:
    """Return whether rule r of machine k holds in the trial, 1 or 0; -1 if it has no truth."""
    m = e.model
    open_at = is_indeterminate(e, r)
    if open_at != DECIDED:
        # how diodes in a row share what they block is nobody's choice
        shared = m.rule_piece[r] != 0
        if m.tells != 0 and (m.decided != 0 or shared):
            warn_of_open(e, r, open_at)
        elif not shared:
            why = "a guard reads what the equations leave open"
            say_fault(e, "HB-J102", why, rule_text(m, r))
            if m.tells != 0:
                tell_open_rule(e, r, open_at)
            return -1
    stack = e.work.stack
    measure_trial(e, r)
    true = holds_from(m, r, stack, level_of(e, k, r))
    if stack.refused != 0:
        refuse_pair(e, t, rule_text(m, r))
        if m.tells != 0:
            add_fact(e.fault, float(r))
        return -1
    kept = holds_on_sides(e, r)
    if kept == NOT_ASKED:
        return 1 if true else 0
    if true and kept == 0:
        warn_of_kept(e, r, t)
    return kept
