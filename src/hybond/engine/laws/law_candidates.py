"""Whether a mode stands up to the laws of its junctions, with what it does on being entered."""

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_places
from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import machine_name
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.expressions.paired import holds
from hybond.engine.jumps.jump import JUMPS, STAYS
from hybond.engine.jumps.trial import (
    begin_trial,
    finish_trial,
    jump_into,
    measure_trial,
    take_factors,
    write_entry,
)
from hybond.engine.laws.law_instant import NO_LAW_VALUE, slides_within
from hybond.engine.laws.law_parallel import add_left
from hybond.engine.laws.law_rates import (
    NO_VALUES_AHEAD,
    is_at_an_end,
    strikes_next,
    turns_at_once,
)
from hybond.engine.laws.law_records import AGAIN, TURNED, Laws
from hybond.engine.laws.ports import open_mode
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.mode_records import Mode, is_constrained
from hybond.engine.mode.nonlinear.agreement import check_agreement
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.model import Model
from hybond.engine.planar.planar import put_headings
from hybond.engine.reasons.facts import add_fact
from hybond.engine.surfaces.averages import show_part
from hybond.engine.surfaces.law_means import FORWARD, RESTS, rests_on_mean
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Floats

CARRIES: Final = 1e-12
"""Part of its terms below which what a law carries in a jump is rounding."""
DUST_OF_STATE: Final = 1e-9
"""A change of what is stored below this part of what it may be is no impulse."""

STANDS: Final = 0
BROKEN: Final = 1
NO_ENTRY: Final = 2
"""A mode that would need an impulse, whose sources contradict each other, or without values."""
STOPS: Final = 3
NO_PART: Final = -1


def try_candidate(e: Engine, r: Laws, x: Floats, kept: bool) -> int:
    """Try the mode in r.candidate from the state in r.here; what follows is in `e.trial`."""
    m = e.model
    signals = e.planar.signals
    put_headings(m, e.planar, r.s, r.candidate)
    if begin_trial(e, r.t, x, signals, r.candidate) != OK:
        return STOPS
    e.trial.factors = 0
    copy_floats(m.storages, r.here, r.swept)
    if r.leaps:
        found = leap_candidate(e, r, x, signals)
        if found != STANDS:
            return found
    elif r.jumping:
        found = sweep_candidate(e, r)
        if found != STANDS:
            return found
    if r.leaps or (r.jumping and is_constrained(e.mode)):
        # what it takes to enter was tried with them
        write_entry(e, r.t, x, signals)
    e.moved = STAYS
    if r.struck:
        e.trial.factors = r.factors
        e.moved = r.struck_moved
        copy_floats(2 * m.bonds, r.struck_impulses, e.impulses)
        copy_floats(m.storages, r.swept, e.trial.x)
    elif r.jumping:
        if r.leaps:
            take_factors(e, e.mode, e.v)
        if jump_into(e, x, e.trial.x) != OK:
            return STOPS
        if r.shifted:
            # what an earlier answer swept up was dust, and stays swept
            copy_floats(m.storages, r.swept, e.trial.x)
    else:
        copy_floats(m.storages, x, e.trial.x)
    e.trial.struck = False
    e.trial.dusted = False
    e.trial.valueless = False
    if finish_trial(e, r.t, x, signals) != OK:
        r.some_valueless = r.some_valueless or e.trial.valueless
        return NO_ENTRY if e.trial.valueless else STOPS
    if r.struck and e.trial.jumps:
        # what these branches sweep up is rounding, and no part of the jump of those that struck
        e.trial.energy_struck = energy_of(e, r.landed)
    if r.leaps and e.trial.jumps and not carries_as_it_may(e, r):
        return NO_ENTRY
    if kept and e.trial.loose > 0:
        return BROKEN  # two that share a current at will: let one of them have it
    found = find_broken(e, r)
    looks = found == STANDS and r.looks_ahead and not r.parting
    if looks and is_in_doubt(e, r):
        turned = turns_at_once(e, r, r.t)
        if r.broken == NO_VALUES_AHEAD:
            r.broken = 0
            # what cannot go on as it is: all branches are tried
            turned = holds_in_vain(e, r)
            r.some_valueless = r.some_valueless or turned
        if turned:
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


def is_in_doubt(e: Engine, r: Laws) -> bool:
    """Whether it is for the motion to say which branches last, since values are zero.

    Where the graph is linear its answer has told. Where laws bend it has told of a slope, and the
    branches found by that are at their ends, or not, by what holds in them. It has told nothing of
    friction that holds what no force of it moves, as behind an arm that has no length yet.
    """
    return r.problem.doubtful or (not r.now.linear and (is_at_an_end(e) or holds_in_vain(e, r)))


def holds_in_vain(e: Engine, r: Laws) -> bool:
    """Whether any friction of the trial rests on what neither its force nor its impulse moves."""
    m = e.model
    for k in range(m.ports):
        own = k * m.ports + k
        rests = m.port_two_sided[k] != 0 and e.trial.state[m.port_machine[k]] == RESTS
        if rests and r.response.d[own] == 0.0 and r.response.ce[own] == 0.0:
            return True
    return False


def sweep_candidate(e: Engine, r: Laws) -> int:
    """Put the state on the constraints of the mode tried, unless that takes more than dust.

    Impulses of laws were decided before; what remains would be an impulse of dry friction.
    """
    m = e.model
    if e.mode.agreements.rows > 0:
        copy_part(m.storages, r.here, 0, e.v, m.stored_slot)
        if check_agreement(e, e.mode, e.v) != OK:
            return NO_ENTRY
    if jump_into(e, r.here, r.swept) != OK:
        return STOPS
    if e.moved != JUMPS:
        # no more than rounding of the constraint's own terms, however little is stored yet
        return STANDS
    if sweeps_dust(e, r, e.mode, DUST_OF_STATE):
        return STANDS
    # what is stored was put on what the machines' mode asks for, with all laws open: what they
    # connect there has got rounding of all of that, and what they part holds none of it alone
    return STANDS if sweeps_dust(e, r, open_mode(e, r.now), EPSILON) else NO_ENTRY


def sweeps_dust(e: Engine, r: Laws, mode: Mode, part: float) -> bool:
    """Whether what is swept up is no more than that part of what a mode's parts may hold."""
    m = e.model
    reach_of(e, mode, r.here, e.work.reach)
    for k in range(m.storages):
        change = math.fabs(r.swept[k] - r.here[k])
        dust = part * (math.fabs(r.here[k]) + e.work.reach[k])
        for j in range(m.ports):
            dust += math.fabs(r.response.e[k * m.ports + j]) * slides_within(e, r, j)
        if not change <= dust:
            return False
    return True


def leap_candidate(e: Engine, r: Laws, x: Floats, signals: Floats) -> int:
    """See whether the mode tried can be entered at all, by whatever impulses."""
    write_entry(e, r.t, x, signals)
    return STANDS if jump_into(e, x, r.swept) == OK else NO_ENTRY


def carries_as_it_may(e: Engine, r: Laws) -> bool:
    """Whether the impulses of the trial are such as its laws carry in the branches tried.

    A contact pushes; what is open stops nothing that closes it; dry friction pushes with none, and
    is dragged the way it slips only (in the plane it is not tried by this); what rebounds has an
    impact of its own.
    """
    m = e.model
    for k in range(m.ports):
        slips = r.candidate[m.port_machine[k]]
        for part in range(2):
            total = impulse_of(e, k, part, CARRIES)
            if total == 0.0:
                continue
            if part == 0 and (m.port_restitution[k] != NO_LAW_VALUE or total < 0.0):
                if m.port_two_sided[k] == 0:
                    return False
            if part == 0 and m.port_two_sided[k] != 0:
                if slips == RESTS or (total > 0.0) != (slips == FORWARD):
                    return False
            if part == 1 and (m.port_two_sided[k] != 0 or (total > 0.0 and r.able[k] != 0)):
                return False
    return True


def impulse_of(e: Engine, port: int, part: int, rounding: float) -> float:
    """Return what a law carries (`part` 0) or takes in the jump of the trial; zero for rounding."""
    m = e.model
    total = 0.0
    size = 0.0
    for i in range(m.pair_first[2 * port + part], m.pair_first[2 * port + part + 1]):
        own = m.pair_value[i] * e.trial.jump[m.bond_slot + m.pair_column[i]]
        total += own
        size += math.fabs(own)
    return 0.0 if math.fabs(total) <= rounding * size else total


def find_broken(e: Engine, r: Laws) -> int:
    """Find the rules of laws that hold in their own branches, with finite values.

    Rounding of what is stored is not a violation: it was counted as zero. While machines slide each
    of the modes combined has branches of its own, and values that they are held against.
    """
    m = e.model
    stack = e.work.stack
    stack.now = e.v
    part = part_tried(e)
    if part >= 0:
        copy_floats(2 * m.slots, e.v, e.slide.ahead)
        show_part(e, part, e.slide.ahead)
        stack.now = e.slide.ahead
    stack.was = stack.now
    stack.was_first = 0
    stack.jumps = False
    stack.terms = e.trial.terms
    stack.prior_terms = e.trial.terms
    r.broken = 0
    for k in range(m.machines):
        if m.is_law[k] == 0:
            continue
        state = e.trial.state[k]
        if strikes_next(e, r, k) or (part >= 0 and rests_on_mean(e, k)):
            continue
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


def part_tried(e: Engine) -> int:
    """Return which of the modes combined is the one tried, branches and all; NO_PART if none is."""
    s = e.slide
    for part in range(s.parts if s.k > 0 else 0):
        same = True
        for k in range(e.model.machines):
            same = same and part_mode(e, part).state[k] == e.trial.state[k]
        if same:
            return part
    return NO_PART


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
    copy_part(m.storages, r.swept, 0, r.state_at, r.states * m.storages)
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
    copy_places(m.machines, r.candidate, 0, r.asked_at, r.asked * m.machines)
    r.asked += 1
