"""Modes without a solution that are left whatever it would be.

Gates that follow one signal through chains of different lengths change in different modes of one
instant: for a moment both switches of a leg are closed. That mode is mythical, and nothing is asked
of it that has no answer there, where machines leave it by what does not depend on its solution: the
time, inputs, states of machines, values before the instant.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_places
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.guards.in_force import is_asked
from hybond.engine.instant.instant import MYTHICAL, Instant, drop_fired, note_fired, note_step
from hybond.engine.instant.telling import tell_fired
from hybond.engine.jumps.trial import forget_jump, show_trial, write_entry
from hybond.engine.laws.entering import enter
from hybond.engine.mode.digits.sizes import measure_values
from hybond.engine.mode.equations import mode_of
from hybond.engine.words import Floats, Ints

MOST: Final = 64
"""Modes passed over one after another, at the most."""


def enter_or_pass(
    e: Engine, i: Instant, t: float, x: Floats, s: Floats, state: Ints, target: Ints
) -> int:
    """Enter a mode from the state `x`, or the first behind it that has a solution.

    `state` is then that of the mode entered; `target` is room for another.
    """
    found = enter(e, t, x, s, state, True, False)
    for _ in range(MOST):
        if found == OK or not leave(e, i, t, x, s, state, target):
            break
        found = enter(e, t, x, s, state, True, False)
    return found


def leave(e: Engine, i: Instant, t: float, x: Floats, s: Floats, state: Ints, target: Ints) -> bool:
    """Let machines leave a mode that was refused by what is known of it; whether any does."""
    m = e.model
    if e.slide.k > 0 or mode_of(e, state) != OK:
        return False
    write_entry(e, t, x, s)
    forget_jump(e)
    fires = False
    for k in range(m.machines):
        target[k] = e.trial.state[k]
        e.trial.state[k] = state[k]
    for k in range(m.machines):
        fires = fires or (m.is_law[k] == 0 and first_rule(e, k) >= 0)
    if not fires:
        # it is refused in the branches that laws have tried
        copy_places(m.machines, target, 0, e.trial.state, 0)
        return False
    for k in range(m.machines):
        target[k] = state[k]
        leads = first_rule(e, k) if m.is_law[k] == 0 else -1
        if leads >= 0:
            target[k] = m.rule_target[leads]
    note_step(i, MYTHICAL)
    drop_fired(i)
    for k in range(m.machines):
        if target[k] != state[k]:
            note_fired(i, k, state[k], target[k])
            tell_fired(e, i, k)
    copy_places(m.machines, target, 0, state, 0)
    return True


def first_rule(e: Engine, machine: int) -> int:
    """Return the first rule of a machine that holds, -1 if none does or that is not known."""
    m = e.model
    stack = e.work.stack
    for r in range(m.rule_first[machine], m.rule_first[machine + 1]):
        if not is_asked(e, machine, r, e.trial.state[machine]):
            continue
        if not is_known(e, r):
            return -1
        show_trial(e, stack)
        measure_values(m, r, e.v, e.trial.terms)
        true = holds(m, r, stack)
        if stack.refused != 0:
            return -1
        if true:
            return r
    return -1


def is_known(e: Engine, rule: int) -> bool:
    """Whether a guard reads nothing that the mode would have to be solved for."""
    m = e.model
    for p in range(m.read_first[rule], m.read_first[rule + 1]):
        k = m.read_slot[p]
        solved = m.bond_slot <= k and k < m.bond_slot + 2 * m.bonds
        stored = m.stored_slot <= k and k < m.stored_slot + m.storages
        if solved or stored or (m.signal_slot <= k and k < m.signal_slot + m.integrals):
            return False
    return True
