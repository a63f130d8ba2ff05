"""Whether a mode stands up to the laws of its junctions; branches found by trying all of them.

What the graph answers to its laws is a linearisation. Where that has no values, as a resistor that
saturates has none for a current that no branch asks of it, few laws are tried branch by branch:
each is a mode of its own, and stands if none of its laws is violated.
"""

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_places
from hybond.engine.answers import machine_name
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.expressions.paired import holds
from hybond.engine.instant.constraints import check_agreement
from hybond.engine.instant.jump import JUMPS, STAYS
from hybond.engine.instant.trial import (
    begin_trial,
    finish_trial,
    jump_into,
    measure_trial,
    write_entry,
)
from hybond.engine.laws.law_instant import NO_LAW_VALUE
from hybond.engine.laws.law_parallel import add_left
from hybond.engine.laws.law_rates import turns_at_once
from hybond.engine.laws.law_records import AGAIN, TURNED, Laws
from hybond.engine.laws.ports import open_mode
from hybond.engine.mode.newton import no_values
from hybond.engine.mode.reach import reach_of
from hybond.engine.model import Model
from hybond.engine.planar.planar import put_headings
from hybond.engine.reasons.facts import add_fact
from hybond.engine.words import Floats

MANY_BRANCHES: Final = 729
"""Branches of all laws together up to which all are tried."""
DUST_OF_STATE: Final = 1e-9
"""A change of what is stored below this part of what it may be is no impulse."""

STANDS: Final = 0
BROKEN: Final = 1
NO_ENTRY: Final = 2
"""A mode that would need an impulse, whose sources contradict each other, or without values."""
STOPS: Final = 3


def by_trial(e: Engine, r: Laws, x: Floats) -> int:
    """Try all branches from the state in r.here, those of the mode first, without impulses.

    STANDS, or STOPS with the fault that there are no values at which the laws hold.
    """
    m = e.model
    many = tried_at_most(m)
    if many == 0:
        return STOPS
    begin_trials(r)
    for ahead in range(2):
        r.looks_ahead = ahead == 0
        r.saw_ahead = False
        for turn in range(many):
            nth_branches(m, r, turn)
            if try_candidate(e, r, x, False) == STANDS:
                return STANDS
        if not r.saw_ahead:
            break
    no_values(e, open_mode(e, r.now))
    e.fault.t = r.t
    return STOPS


def begin_trials(r: Laws) -> None:
    """Make ready to try all branches: none of them is known to have one answer only."""
    r.asked = 0
    r.states = AGAIN
    r.shifted = False
    r.problem.doubtful = True


def tried_at_most(m: Model) -> int:
    """Return how many branches all laws have together; 0 if they are too many, or ask for more.

    A gate, a gap or a limit may follow from what has no values yet, and so may a direction of slip.
    """
    many = 1
    for k in range(m.ports):
        if m.port_gate[k] != NO_LAW_VALUE or m.port_gap[k] != NO_LAW_VALUE:
            return 0
        if m.port_planar[k] != 0 or m.port_limit[k] >= 0 or m.port_breakaway[k] >= 0:
            return 0
        many *= 3 if m.port_two_sided[k] != 0 else 2
        if many > MANY_BRANCHES:
            return 0
    return many


def nth_branches(m: Model, r: Laws, turn: int) -> None:
    """Put the branches of that number, counted from those of the mode, into `r.candidate`."""
    left = turn
    for k in range(m.machines):
        r.candidate[k] = r.state[k]
    for k in range(m.ports):
        machine = m.port_machine[k]
        ways = 3 if m.port_two_sided[k] != 0 else 2
        now = r.state[machine] if r.state[machine] < ways else 0
        r.candidate[machine] = (now + left % ways) % ways
        left //= ways


def try_candidate(e: Engine, r: Laws, x: Floats, kept: bool) -> int:
    """Try the mode in r.candidate from the state in r.here; what follows is in `e.trial`."""
    m = e.model
    signals = e.planar.signals
    put_headings(m, e.planar, r.s, r.candidate)
    if begin_trial(e, r.t, x, signals, r.candidate) != OK:
        return STOPS
    e.trial.factors = 0
    for k in range(m.storages):
        r.swept[k] = r.here[k]
    if r.jumping:
        found = sweep_candidate(e, r)
        if found != STANDS:
            return found
    write_entry(e, r.t, x, signals)
    e.moved = STAYS
    if r.struck:
        e.trial.factors = r.factors
        e.moved = r.struck_moved
        for b in range(2 * m.bonds):
            e.impulses[b] = r.struck_impulses[b]
        for k in range(m.storages):
            e.trial.x[k] = r.swept[k]
    elif r.jumping:
        if jump_into(e, x, e.trial.x) != OK:
            return STOPS
        if r.shifted:
            # what an earlier answer swept up was dust, and stays swept
            for k in range(m.storages):
                e.trial.x[k] = r.swept[k]
    else:
        for k in range(m.storages):
            e.trial.x[k] = x[k]
    e.trial.struck = False
    e.trial.dusted = False
    e.trial.valueless = False
    if finish_trial(e, r.t, x, signals) != OK:
        r.some_valueless = r.some_valueless or e.trial.valueless
        return NO_ENTRY if e.trial.valueless else STOPS
    if kept and e.trial.loose > 0:
        return BROKEN  # two that share a current at will: let one of them have it
    found = find_broken(e, r)
    looks = r.problem.doubtful and r.looks_ahead and not r.parting
    if found == STANDS and looks and turns_at_once(e, r, r.t):
        r.saw_ahead = True
        found = BROKEN
    if found != BROKEN:
        e.trial.dusted = r.shifted
        if found == STANDS and r.left > 0:
            add_left(e, r)
        if found == STANDS and r.struck and e.trial.jumps:
            for k in range(m.machines):
                e.trial.through[k] = r.through[k]
                e.trial.struck = e.trial.struck or r.through[k] != r.candidate[k]
        return found
    note_state(m, r)
    note_turned(m, r)
    return BROKEN


def sweep_candidate(e: Engine, r: Laws) -> int:
    """Put the state on the constraints of the mode tried, unless that takes more than dust.

    Impulses of laws were decided before; what remains would be an impulse of dry friction.
    """
    m = e.model
    if e.mode.agreements.rows > 0:
        for k in range(m.storages):
            e.v[m.stored_slot + k] = r.here[k]
        if check_agreement(e, e.mode, e.v) != OK:
            return NO_ENTRY
    if jump_into(e, r.here, r.swept) != OK:
        return STOPS
    if e.moved != JUMPS:
        # no more than rounding of the constraint's own terms, however little is stored yet
        return STANDS
    reach_of(e, r.here, e.energy, e.work.reach)
    for k in range(m.storages):
        change = math.fabs(r.swept[k] - r.here[k])
        if not change <= DUST_OF_STATE * (math.fabs(r.here[k]) + e.work.reach[k]):
            return NO_ENTRY
    return STANDS


def find_broken(e: Engine, r: Laws) -> int:
    """Find the rules of laws that hold in their own branches, with finite values.

    Rounding of what is stored is not a violation: it was counted as zero.
    """
    m = e.model
    stack = e.work.stack
    stack.now = e.v
    stack.was = e.v
    stack.was_first = 0
    stack.jumps = False
    stack.terms = e.trial.terms
    r.broken = 0
    for k in range(m.machines):
        if m.is_law[k] == 0:
            continue
        state = e.trial.state[k]
        if state == 0 and r.comes[k] != 0 and not r.unanswered:
            continue  # what still approaches strikes in the next jump of this instant
        for rule in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_source[rule] != state:
                continue
            measure_trial(e, rule)
            true = holds(m, rule, stack)
            if stack.refused != 0:
                say_fault(e, "HB-J101", "a value is not a number", machine_name(m, k))
                if m.tells != 0:
                    add_fact(e.fault, float(rule))
                return STOPS
            if true:
                if m.tells != 0:
                    note_held(r, rule)
                r.broken_machine[r.broken] = k
                r.broken_target[r.broken] = m.rule_target[rule]
                r.broken += 1
    return BROKEN if r.broken > 0 else STANDS


def note_held(r: Laws, rule: int) -> None:
    """Note a rule of a law that held, once."""
    for k in range(r.rules_held):
        if r.rule_held.at[k] == rule:
            return
    grow_places(r.rule_held, r.rules_held + 1)
    r.rule_held.at[r.rules_held] = rule
    r.rules_held += 1


def note_state(m: Model, r: Laws) -> None:
    """Note the state that these branches hold: rounding may have spoken, so ask again on it."""
    if r.states == AGAIN:
        return
    for turn in range(r.states):
        same = True
        for k in range(m.storages):
            same = same and r.state_at[turn * m.storages + k] == r.swept[k]
        if same:
            return
    for k in range(m.storages):
        r.state_at[r.states * m.storages + k] = r.swept[k]
    r.states += 1


def note_turned(m: Model, r: Laws) -> None:
    """Note the mode with what is violated turned."""
    if r.asked == TURNED:
        return
    for i in range(r.broken):
        r.candidate[r.broken_machine[i]] = r.broken_target[i]
    for turn in range(r.asked):
        same = True
        for k in range(m.machines):
            same = same and r.asked_at[turn * m.machines + k] == r.candidate[k]
        if same:
            return
    for k in range(m.machines):
        r.asked_at[r.asked * m.machines + k] = r.candidate[k]
    r.asked += 1
