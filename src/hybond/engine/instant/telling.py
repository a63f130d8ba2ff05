"""Writing down, beside what happens at an instant, what explains it.

Only where somebody will read it: `tells` of the model.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.products import largest, largest_part
from hybond.engine.engine import Engine
from hybond.engine.expressions.paired import evaluate_pair, holds
from hybond.engine.expressions.pairs import Stack, clear, is_impulsive
from hybond.engine.guards.in_force import is_asked
from hybond.engine.instant.instant import Instant, add_energy, add_open
from hybond.engine.instant.told import add_over, add_read, say_why
from hybond.engine.jumps.trial import measure_trial, show_trial
from hybond.engine.mode.left_free.leakage import MOVED
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.words import Floats, Ints


def tell_fired(e: Engine, i: Instant, machine: int) -> None:
    """Tell which rule the last transition noted followed, and which others it went before."""
    m = e.model
    if m.tells == 0:
        return
    stack = e.work.stack
    show_trial(e, stack)
    found = False
    for r in range(m.rule_first[machine], m.rule_first[machine + 1]):
        if not is_asked(e, machine, r, e.trial.state[machine]):
            continue
        measure_trial(e, r)
        if not holds(m, r, stack) or stack.refused != 0:
            continue
        if found:
            add_over(i.told, r)
        else:
            tell_rule(e, i, r)
            found = True


def tell_found(e: Engine, i: Instant, machine: int, held: Ints) -> None:
    """Tell the same where it is known of each rule that is asked whether it holds."""
    m = e.model
    if m.tells == 0:
        return
    show_trial(e, e.work.stack)
    found = False
    for r in range(m.rule_first[machine], m.rule_first[machine + 1]):
        if held[r] != 0 and found:
            add_over(i.told, r)
        elif held[r] != 0:
            tell_rule(e, i, r)
            found = True


def tell_branch(e: Engine, i: Instant, machine: int, source: int) -> None:
    """Tell which rule of a junction law the last transition noted followed, a priori or after."""
    m = e.model
    if m.tells == 0:
        return
    stack = e.work.stack
    show_trial(e, stack)
    for turn in range(2):
        if turn == 0:
            stack.now = e.pre
            stack.jumps = False
        else:
            show_trial(e, stack)
        for r in range(m.rule_first[machine], m.rule_first[machine + 1]):
            if m.rule_source[r] != source or m.rule_landed[r] != 0:
                continue
            measure_trial(e, r)
            if holds(m, r, stack) and stack.refused == 0:
                tell_rule(e, i, r)
                show_trial(e, stack)
                return


def tell_rule(e: Engine, i: Instant, rule: int) -> None:
    """Tell the rule of the last transition noted, with what it reads of the signals shown."""
    m = e.model
    stack = e.work.stack
    say_why(i.told, rule)
    for k in range(m.told_first[rule], m.told_first[rule + 1]):
        tell_value(e, i, stack, m.told_pair[k])


def tell_value(e: Engine, i: Instant, stack: Stack, pair: int) -> None:
    """Tell the value of a pair."""
    clear(stack)
    measure_trial(e, pair)
    evaluate_pair(e.model, pair, stack)
    top = stack.top
    if stack.refused != 0 or top < 0:
        add_read(i.told, math.nan, 0.0, False)
        return
    strikes = is_impulsive(stack, top)
    add_read(i.told, stack.finite[top], stack.impulse[top] if strikes else 0.0, strikes)


def tell_trial(e: Engine, i: Instant, x: Floats, written: bool) -> None:
    """Tell of the step noted last, the trial from `x`, its energy and what is open in it."""
    m = e.model
    if m.tells == 0:
        return
    if e.trial.jumps:
        add_energy(i, e.trial.energy_before, e.trial.energy_after, supplied_by_jump(e))
    elif written:
        here = energy_of(e, x)
        add_energy(i, here, here, 0.0)
    tell_open(e, i, e.trial.loose, e.trial.freedom.at)
    if e.trial.jumps:
        tell_open(e, i, e.mode.ways.shares, e.mode.ways.share.at)


def tell_kept(e: Engine, i: Instant) -> None:
    """Tell of the step noted last, which follows a jump without another, its energy."""
    if e.model.tells == 0:
        return
    here = energy_of(e, e.trial.x)
    add_energy(i, here, here, 0.0)
    tell_open(e, i, e.trial.loose, e.trial.freedom.at)


def tell_open(e: Engine, i: Instant, many: int, directions: Floats) -> None:
    """Tell the bond variables that some directions, the columns, move."""
    if many == 0:
        return
    n = 2 * e.model.bonds
    most = largest(n * many, directions)
    for k in range(n):
        size = largest_part(many, directions, k * many)
        if size > MOVED * most:
            add_open(i, k)


def supplied_by_jump(e: Engine) -> float:
    """Return the energy that sources give at a jump: impulse times the value at the right limit.

    A source that follows what it reads may have an impulse itself, of what the other variable of
    its bond is then.
    """
    m = e.model
    total = 0.0
    for k in range(m.givers):
        own = e.v[m.bond_slot + m.giver_own[k]]
        total -= m.giver_sign[k] * own * e.impulses[m.giver_other[k]]
        area = e.impulses[m.giver_own[k]]
        if area != 0.0:
            total -= m.giver_sign[k] * e.v[m.bond_slot + m.giver_other[k]] * area
    return total


def supplied_now(e: Engine) -> float:
    """Return the power that sources give by the values at present."""
    m = e.model
    total = 0.0
    for k in range(m.givers):
        own = e.v[m.bond_slot + m.giver_own[k]]
        total -= m.giver_sign[k] * own * e.v[m.bond_slot + m.giver_other[k]]
    return total
