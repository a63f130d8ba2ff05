"""Trying a mode with the laws of junctions: jump first, then what lasts."""

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.answers import machine_name, node_name
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.impacts.impact_records import NEWTON, NEWTON_SIMULTANEOUS
from hybond.engine.jumps.jump import JUMPS
from hybond.engine.jumps.trial import (
    begin_trial,
    jump_into,
    take_factors,
)
from hybond.engine.laws.approach_left import leave_approaches
from hybond.engine.laws.impacts_held import hold_impact
from hybond.engine.laws.law_branches import (
    NO_DUST,
    TRIES,
    begin_lasting,
    next_lasting,
    no_branches,
)
from hybond.engine.laws.law_candidates import (
    BROKEN,
    STANDS,
    STOPS,
    try_candidate,
)
from hybond.engine.laws.law_instant import NO_LAW_VALUE, make_consistent, quantity, take_instant
from hybond.engine.laws.law_jumping import find_breaking, find_jumping, sweep_dust
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.law_trials import by_trial
from hybond.engine.laws.strike import NOTHING_STRIKES, REFUSES, strike_at_once
from hybond.engine.mode.digits.fading import remember
from hybond.engine.mode.digits.part_energies import see_energy, see_linear_energy
from hybond.engine.model import Model
from hybond.engine.reasons.facts import add_fact, tell_ports
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats, Ints

LIMIT_ROUNDING: Final = 1e-6
"""Part of the largest limit so far up to which a limit below zero is one that ends there."""


def enter_with_laws(
    e: Engine, t: float, x: Floats, s: Floats, state: Ints, jump: bool, stay: bool
) -> int:
    """Enter a mode with the branches that complementarity chooses; without `jump`, stay on `x`.

    With `stay` junction laws keep the branches of `state`, which were just chosen, unless an
    impulse or a violation asks for others. HB-J110 if there are no branches, HB-J111 if none stands
    up to its own conditions.
    """
    m = e.model
    r = e.laws
    see_energy(e, x)
    take_instant(e, r, t, s, state)
    r.jumping = jump
    r.struck = False
    r.unanswered = False
    r.some_valueless = False
    if m.tells != 0:
        r.rules_held = 0
    if jump and strike(e, r, x) != OK:
        if not r.unanswered and (r.now.linear or not r.undecided):
            return REFUSED
        linearised = not r.unanswered
        copy_floats(m.storages, x, r.here)
        if by_trial(e, r, x) == STANDS:
            r.undecided = False
            return OK
        # what is said of a graph that answers is said by its answers
        return strike(e, r, x) if linearised else REFUSED
    if not r.struck:
        copy_floats(m.storages, x, r.landed)
        if jump:
            # the last question of `strike` has put the state there, unless all strike at once
            if not r.answered and make_consistent(e, r, x) != OK:
                return REFUSED
            copy_floats(m.storages, r.x, r.landed)
    copy_floats(m.storages, r.landed, r.begin)
    if jump and not r.struck and r.sweep and sweep_dust(e, r, r.begin, r.landed) != OK:
        return REFUSED
    r.swept_first = False
    for k in range(m.storages):
        r.state_at[k] = r.landed[k]
        r.swept_first = r.swept_first or r.landed[k] != r.begin[k]
    for ahead in range(2):
        r.looks_ahead = ahead == 0
        r.saw_ahead = False
        r.states = 1
        turn = 0
        while turn < r.states:
            found = from_state(e, r, x, turn, stay)
            if found == STANDS:
                return OK
            if found == STOPS:
                return REFUSED
            turn += 1
        if not r.saw_ahead:
            break
    r.undecided = True
    why = "no branches of the junction laws stand: several answers may fit, or values lie too far"
    say_fault(e, "HB-J111", why, machine_name(m, m.port_machine[0]))
    if m.tells != 0:
        for k in range(r.rules_held):
            add_fact(e.fault, float(r.rule_held.at[k]))
    e.fault.t = t
    return REFUSED


def strike(e: Engine, r: Laws, x: Floats) -> int:
    """Make the jump that laws ask for, if what is stored violates any."""
    r.at_once = e.model.impact == NEWTON_SIMULTANEOUS and rubs_in_impacts(e.model)
    if e.model.impact != NEWTON and not r.at_once:
        struck = strike_at_once(e, r, x)
        if struck != NOTHING_STRIKES:
            if struck == REFUSES:
                return REFUSED
            hold_impact(e, r, False)
            return OK
    for k in range(e.model.ports):
        r.loose[k] = 0
    found = find_jumping(e, r, x)
    if found == 0:
        found = find_breaking(e, r, x)
        if found > 0:
            found = find_jumping(e, r, x)
    if found <= 0:
        return REFUSED if found < 0 else OK
    if strike_branches(e, r, x) != OK:
        return REFUSED
    hold_impact(e, r, True)
    return OK


def rubs_in_impacts(m: Model) -> bool:
    """Whether any friction is an impulse in an impact: then all are one problem of branches."""
    found = False
    for k in range(m.ports):
        found = found or (m.port_two_sided[k] != 0 and m.port_impulsive[k] != 0)
    return found


def strike_branches(e: Engine, r: Laws, x: Floats) -> int:
    """Make the jump of the branches that carry impulses: Newton's law contact after contact."""
    m = e.model
    copy_places(m.machines, r.candidate, 0, r.through, 0)
    if begin_trial(e, r.t, x, r.s, r.through) != OK:
        return REFUSED
    take_factors(e, e.mode, e.v)
    leave_approaches(e, r)
    if jump_into(e, x, r.landed) != OK:
        return REFUSED
    r.struck = True
    r.struck_moved = e.moved
    r.factors = e.trial.factors
    copy_floats(2 * m.bonds, e.impulses, r.struck_impulses)
    return OK


def from_state(e: Engine, r: Laws, x: Floats, turn: int, stay: bool) -> int:
    """Look for branches that last from one of the states that differ by rounding."""
    m = e.model
    copy_part(m.storages, r.state_at, turn * m.storages, r.here, 0)
    r.asked = 0
    r.shifted = turn > 0 or r.swept_first
    still = not r.struck or r.struck_moved != JUMPS
    if stay and still and turn == 0:
        copy_places(m.machines, r.state, 0, r.candidate, 0)
        found = try_candidate(e, r, x, False)
        if found == STANDS or found == STOPS:
            return found
    if begin_lasting(e, r, r.here) != OK:
        return by_trial(e, r, x) if r.unanswered else STOPS
    at = 0
    for part in range(2):
        while next_lasting(e, r, NO_DUST if part == 0 else TRIES):
            first = r.asked
            found = try_candidate(e, r, x, r.candidate_kept)
            if found == BROKEN and r.shared and r.asked > first:
                # what a machine switches has a share as well, which may ask a law for less than
                # nothing: others beside it then do without it
                copy_places(m.machines, r.asked_at, first * m.machines, r.candidate, 0)
                found = try_candidate(e, r, x, False)
            if found == STANDS or found == STOPS:
                return found
        if part == 1 and not r.solved:
            no_branches(e, r, 0)
            if m.tells != 0:
                tell_ports(e, r, False)
            return STOPS
        # what is violated is turned, which is accepted only if it stands as well: a law at its end
        # is known to rounding there, and to less where rates are differences. Dust comes after it
        while at < r.asked:
            copy_places(m.machines, r.asked_at, at * m.machines, r.candidate, 0)
            at += 1
            found = try_candidate(e, r, x, False)
            if found == STANDS or found == STOPS:
                return found
    return by_trial(e, r, x) if r.some_valueless else BROKEN


def observe(e: Engine, v: Floats) -> None:
    """Learn how large gaps and energy are in this run, which rounding is measured by.

    That of bent storages is a quadrature, and seen at instants: what moves beside them counts here.
    """
    m = e.model
    r = e.laws
    for k in range(m.ports):
        if m.port_gap[k] != NO_LAW_VALUE:
            gap = math.fabs(quantity(m, m.port_gap, m.port_gap_constant, k, v))
            if math.isfinite(gap):
                r.largest[k] = max(r.largest[k], gap)
    copy_part(m.storages, v, m.stored_slot, r.moved, 0)
    see_linear_energy(e, r.moved)
    remember(e, e.mode, v[0] - e.t, r.moved)


def look_at_limits(e: Engine) -> int:
    """Look at limits of friction at the present point of the motion."""
    if evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return REFUSED
    return check_limits(e, e.t, e.shown)


def check_limits(e: Engine, t: float, v: Floats) -> int:
    """Look at limits of friction that vary: they must stay what friction can have.

    HB-N407 for a limit below zero, or above that of breaking loose.
    """
    m = e.model
    r = e.laws
    for k in range(m.ports):
        if m.port_limit[k] < 0 and m.port_breakaway[k] < 0:
            continue
        limit = quantity(m, m.port_limit, m.port_limit_constant, k, v)
        most = limit
        if m.port_breakaway[k] != NO_LAW_VALUE:
            most = quantity(m, m.port_breakaway, m.port_breakaway_constant, k, v)
        size = max(max(math.fabs(limit), math.fabs(most)), r.largest_limit[k])
        r.largest_limit[k] = size
        why = ""
        if min(limit, most) < -LIMIT_ROUNDING * size:
            why = "the limit of the friction is below zero: it would push"
        elif most < limit - LIMIT_ROUNDING * size:
            why = "friction breaks loose at less than it slides with"
        if min(limit, most) < -LIMIT_ROUNDING * size or most < limit - LIMIT_ROUNDING * size:
            say_fault(e, "HB-N407", why, node_name(m, m.port_node[k]))
            if m.tells != 0:
                add_fact(e.fault, float(m.port_machine[k]))
                add_fact(e.fault, limit)
                add_fact(e.fault, most)
            e.fault.t = t
            return REFUSED
    return OK


def limits_vary(m: Model) -> bool:
    """Whether any limit of friction is no constant."""
    found = False
    for k in range(m.ports):
        found = found or m.port_limit[k] >= 0 or m.port_breakaway[k] >= 0
    return found
