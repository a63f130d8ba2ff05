"""Whether anything depends on integrals and samples of what the equations leave open.

Such an integral has its value where a mode is entered, and none as soon as time passes there: what
is open may have any course. The ways in which integrals are free are those in which they were
before, those in which their rates are, and those in which rates are that read them. What is stored
may not move by any of it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_block
from hybond.engine.answers import node_name, rule_text, stored_name, value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.guards.in_force import is_asked
from hybond.engine.instant.indeterminate import (
    FAR,
    NEARER,
    POINTS,
    ends_here,
    truths_of,
    turns,
)
from hybond.engine.instant.open_ways import (
    add_way,
    bond_moved,
    follow_signals,
    keep_signals,
    move_signals,
    moved_by,
    put_signals,
    take_kept_ways,
)
from hybond.engine.jumps.trial import measure_trial, show_trial
from hybond.engine.mode.left_free.leakage import MOVED, is_undetermined
from hybond.engine.mode.left_free.undetermined import far_held
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.reasons.facts import add_fact
from hybond.engine.reasons.warned import LEFT_OPEN, add_about, begin_warning
from hybond.engine.words import Text

OPEN_SINCE: Final = 3
OPEN_RATE: Final = 4
OPEN_EARLIER: Final = 5
"""When what is read is open: as soon as time passes, what is stored by its rate, or since it was
so in a mode before. Others are in `indeterminate`."""


def refuse_open_integrals(e: Engine) -> int:
    """Refuse what depends on integrals and samples that are open in the mode of the trial.

    Time is to pass there: the trial is where it has settled. Guards and gaps are refused, and rates
    of what is stored.
    """
    m = e.model
    trial = e.trial
    trial.open_ways = 0
    if m.decided != 0 and m.tells == 0:
        return OK
    if trial.loose == 0 and trial.kept_many == 0:
        return OK
    if trial.loose > 0 and refuse_open_rates(e) != OK:
        return REFUSED
    ways = find_ways(e) if m.integrals > 0 else 0
    trial.open_ways = ways
    if ways == 0:
        return OK
    if see_what_follows(e, ways) != OK:
        return REFUSED
    show_trial(e, e.work.stack)
    for k in range(m.machines):
        if m.is_law[k] != 0:
            continue
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if is_asked(e, k, r, trial.state[k]) and guard_turns(e, r, ways):
                if refuse_guard(e, r, ways) != OK:
                    return REFUSED
    for k in range(m.ports):
        if m.port_gap[k] >= 0 and gap_turns(e, k, ways):
            if m.decided != 0:
                warn(e, -1 - k, when_open(e), ways)
                continue
            why = "a gap reads an integral of what the equations leave open"
            place = node_name(m, m.port_node[k])
            return refuse(e, -1 - k, when_open(e), ways, why, place)
    return OK


def refuse_kept_open(e: Engine, rule: int) -> int:
    """Refuse a rule that is asked at an instant if signals decide it that were left open before."""
    m = e.model
    if e.trial.kept_many == 0 or (m.decided != 0 and m.tells == 0):
        return OK
    ways = take_kept_ways(e)
    e.trial.bonds_follow = follow_signals(e)
    show_trial(e, e.work.stack)
    return refuse_guard(e, rule, ways) if guard_turns(e, rule, ways) else OK


def refuse_guard(e: Engine, rule: int, ways: int) -> int:
    """Refuse a guard that free signals decide; warn of it where the model lets that be."""
    m = e.model
    if m.decided != 0 or m.rule_piece[rule] != 0:
        warn(e, rule, when_open(e), ways)
        return OK
    why = "a guard reads an integral of what the equations leave open"
    return refuse(e, rule, when_open(e), ways, why, rule_text(m, rule))


def refuse_open_rates(e: Engine) -> int:
    """Refuse what is stored if its rate is one of the bond variables that are open."""
    m = e.model
    trial = e.trial
    # storages that are tied have rates by their constraints, also where laws have no slope
    if e.slide.k > 0 or is_constrained(e.mode):
        return OK
    for k in range(m.storages):
        if is_undetermined(2 * m.bonds, trial.loose, trial.freedom.at, rate_bond(m, k)):
            return refuse_rate(e, k, 0)
    return OK


def see_what_follows(e: Engine, ways: int) -> int:
    """See whether bond variables follow signals that are free; refuse what is stored if it does."""
    m = e.model
    trial = e.trial
    if not trial.bonds_follow:
        return OK
    follows = False
    keep_signals(e)
    most = 1.0
    for k in range(m.integrals):
        most = max(most, math.fabs(trial.kept_signals[3 * k]))
    for i in range(ways):
        move_signals(e, i, most, most)
        moved = 0.0
        for k in range(2 * m.bonds):
            moved = max(moved, math.fabs(bond_moved(e, k)))
        follows = follows or moved > 0.0
        for k in range(m.storages):
            if math.fabs(bond_moved(e, rate_bond(m, k))) > MOVED * moved:
                put_signals(e)
                return refuse_rate(e, k, ways)
        put_signals(e)
    trial.bonds_follow = follows
    return OK


# -- the ways in which integrals are free


def find_ways(e: Engine) -> int:
    """Put the ways in which integrals are free into `e.trial.ways`; return how many there are."""
    m = e.model
    n = 2 * m.bonds
    first = m.bond_slot
    loose = e.trial.loose
    freedom = e.trial.freedom.at
    kept = e.work.generic
    most = 1.0
    for k in range(n):
        kept[k] = e.v[first + k]
        most = max(most, math.fabs(e.v[first + k]))
    for k in range(m.integrals):
        e.trial.rates[k] = value(m, m.integral_rate[k], e.v)
    ways = take_kept_ways(e)
    for j in range(loose):
        up = FAR * most
        down = -up
        if ends_here(e):
            held_up = far_held(e, e.mode, kept, e.v, freedom, up)
            held_down = far_held(e, e.mode, kept, e.v, freedom, down)
            if held_up != 0.0 and held_down != 0.0:
                up = held_up
                down = held_down
        for side in range(2):
            far = up if side > 0 else down
            for k in range(n):
                e.v[first + k] = kept[k] + far * freedom[k * loose + j]
            ways += keep_way(e, ways)
        for k in range(n):
            e.v[first + k] = kept[k]
    # an integral that is free moves the rates that read it
    e.trial.bonds_follow = ways > 0 and follow_signals(e)
    begun = 0
    while begun < ways:
        for side in range(1 + e.trial.two_sided.at[begun]):
            keep_signals(e)
            move_signals(e, begun, 1.0 - 2.0 * float(side), 1.0)
            ways += keep_way(e, ways)
            put_signals(e)
        begun += 1
    return ways


def keep_way(e: Engine, ways: int) -> int:
    """Keep how rates at the values `e.v` differ from those of the trial as the next way.

    Returns 1 if any do, and it is new, else 0.
    """
    m = e.model
    grow_block(e.trial.ways, (ways + 1) * m.integrals)
    for k in range(m.integrals):
        rate = value(m, m.integral_rate[k], e.v)
        size = value(m, m.integral_size[k], e.v)
        e.trial.ways.at[ways * m.integrals + k] = moved_by(rate, e.trial.rates[k], size)
    return add_way(e, ways)


# -- what depends on them


def guard_turns(e: Engine, rule: int, ways: int) -> bool:
    """Whether a guard, shown the trial, has another truth if integrals move as they are free to."""
    measure_trial(e, rule)
    keep_signals(e)
    truths = 0
    for i in range(ways):
        most = far_of(e, rule, i)
        reads = e.model.read_first[rule + 1] - e.model.read_first[rule]
        for side in range(2 * POINTS + 1 + reads if most != 0.0 else 0):
            far = 0.0
            if side < 2 * POINTS:
                far = (most if side % 2 == 0 else -most) * math.pow(NEARER, float(side // 2))
            elif side > 2 * POINTS:
                far = way_to_zero(e, rule, side - 2 * POINTS - 1, i)
            if truths != 3 and (far >= 0.0 or e.trial.two_sided.at[i] != 0):
                move_signals(e, i, far, most)
                truths = truths | truths_of(e, rule)
                if side < 2 and turns_as_well(e, rule):
                    truths = 3
    put_signals(e)
    return truths == 3


def way_to_zero(e: Engine, rule: int, i: int, way: int) -> float:
    """Return how far to go along a way for the i-th value that a guard reads to be zero."""
    m = e.model
    k = m.read_slot[m.read_first[rule] + i] - m.signal_slot
    if k < 0 or k >= m.integrals:
        return 0.0
    along = e.trial.ways.at[way * m.integrals + k]
    return -e.trial.kept_signals[3 * k] / along if along != 0.0 else 0.0


def turns_as_well(e: Engine, rule: int) -> bool:
    """Whether what is open now turns a guard where signals are that it does not turn alone."""
    trial = e.trial
    if trial.loose == 0:
        return False
    return turns(e, rule, e.v, 1.0, trial.loose, trial.freedom.at, ends_here(e))


def gap_turns(e: Engine, port: int, ways: int) -> bool:
    """Whether a contact is open or touches as integrals move."""
    m = e.model
    keep_signals(e)
    gap = value(m, m.port_gap[port], e.v)
    turned = False
    for i in range(2 * ways):
        if i % 2 == 1 and e.trial.two_sided.at[i // 2] == 0:
            continue
        far = far_of(e, m.port_gap_pair[port], i // 2)
        move_signals(e, i // 2, far if i % 2 == 0 else -far, far)
        moved = value(m, m.port_gap[port], e.v)
        turned = turned or (moved > 0.0) != (gap > 0.0)
    put_signals(e)
    return turned


def far_of(e: Engine, pair: int, way: int) -> float:
    """Return how far to go along a way: far beyond the largest integral that a pair reads.

    Zero if it reads none that moves there, nor bond variables, which may follow.
    """
    m = e.model
    most = 1.0
    moved = 0.0
    bonds = False
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        k = m.read_slot[i] - m.signal_slot
        if k >= 0 and k < m.integrals:
            most = max(most, math.fabs(e.trial.kept_signals[3 * k]))
            moved = max(moved, math.fabs(e.trial.ways.at[way * m.integrals + k]))
        k = m.read_slot[i] - m.bond_slot
        bonds = bonds or (k >= 0 and k < 2 * m.bonds)
    if moved == 0.0 and bonds and e.trial.bonds_follow:
        return FAR * most
    return FAR * most / moved if moved > 0.0 else 0.0


def is_free(e: Engine, k: int, ways: int) -> bool:
    """Whether any of the ways moves integral k."""
    for i in range(ways):
        if e.trial.ways.at[i * e.model.integrals + k] != 0.0:
            return True
    return False


# -- telling


def when_open(e: Engine) -> int:
    """Return when what is read is open: as soon as time passes, or since it was so before."""
    return OPEN_SINCE if e.trial.loose > 0 else OPEN_EARLIER


def refuse_rate(e: Engine, storage: int, ways: int) -> int:
    """Refuse what is stored by port `storage`, whose rate is open or follows signals that are."""
    m = e.model
    if m.decided != 0:
        warn(e, storage, OPEN_RATE, ways)
        return OK
    why = "what is stored moves by what the equations leave open"
    return refuse(e, storage, OPEN_RATE, ways, why, stored_name(m, storage))


def refuse(e: Engine, reader: int, when: int, ways: int, why: Text, place: Text) -> int:
    """Refuse what reads a free integral: a rule, or ``-1 - k`` for the gap of port k."""
    m = e.model
    say_fault(e, "HB-J102", why, place)
    if m.tells != 0:
        add_fact(e.fault, float(reader))
        add_fact(e.fault, float(when))
        for k in range(m.integrals):
            if is_free(e, k, ways):
                add_fact(e.fault, float(k))
    return REFUSED


def warn(e: Engine, reader: int, when: int, ways: int) -> None:
    """Warn of it, where somebody will read that."""
    m = e.model
    if m.tells == 0:
        return
    begin_warning(e.warned, LEFT_OPEN, e.t)
    add_about(e.warned, float(reader))
    add_about(e.warned, float(when))
    for k in range(m.machines):
        add_about(e.warned, float(e.trial.state[k]))
    for k in range(m.integrals):
        if is_free(e, k, ways):
            add_about(e.warned, float(k))
