"""Whether guards and gaps depend on integrals of what the equations leave open.

Such an integral has its value where a mode is entered, and none as soon as time passes there: what
is open may have any course. The ways in which integrals are free are those in which their rates
are, and those in which rates are that read them.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_block
from hybond.engine.answers import node_name, rule_text, value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.guards.in_force import is_asked
from hybond.engine.instant.indeterminate import FAR, ends_here, truths_of
from hybond.engine.jumps.trial import measure_trial, show_trial
from hybond.engine.mode.left_free.undetermined import far_held
from hybond.engine.reasons.facts import add_fact
from hybond.engine.reasons.warned import LEFT_OPEN, add_about, begin_warning
from hybond.engine.words import Text

OPEN_SINCE: Final = 3
"""When what is read is open: as soon as time passes. Others are in `indeterminate`."""
STEADY: Final = 1e-9
"""Part of its terms by which a rate may change along a way that does not move it."""


def refuse_open_integrals(e: Engine) -> int:
    """Refuse guards and gaps that integrals decide which are open in the mode of the trial.

    Time is to pass there: the trial is where it has settled.
    """
    m = e.model
    if m.integrals == 0 or e.trial.loose == 0 or (m.decided != 0 and m.tells == 0):
        return OK
    ways = find_ways(e)
    if ways == 0:
        return OK
    show_trial(e, e.work.stack)
    for k in range(m.machines):
        if m.is_law[k] != 0:
            continue
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if is_asked(e, k, r, e.trial.state[k]) and guard_turns(e, r, ways):
                shared = m.rule_piece[r] != 0
                if m.decided != 0 or shared:
                    warn(e, r, ways)
                    continue
                why = "a guard reads an integral of what the equations leave open"
                return refuse(e, r, ways, why)
    for k in range(m.ports):
        if m.port_gap[k] >= 0 and gap_turns(e, k, ways):
            if m.decided != 0:
                warn(e, -1 - k, ways)
                continue
            why = "a gap reads an integral of what the equations leave open"
            return refuse(e, -1 - k, ways, why)
    return OK


# -- the ways in which integrals are free


def find_ways(e: Engine) -> int:
    """Put the ways in which integrals are free into `e.trial.ways`; return how many there are.

    Each is what moves all of them together, the farthest by 1.
    """
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
    ways = 0
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
    begun = 0
    for _ in range(m.integrals - 1):
        end = ways
        for i in range(begun, end):
            keep_signals(e)
            move_signals(e, i, 1.0, 1.0)
            ways += keep_way(e, ways)
            put_signals(e)
        begun = end
    return ways


def keep_way(e: Engine, ways: int) -> int:
    """Keep how rates at the values `e.v` differ from those of the trial as the next way, if any do.

    Returns 1 then, else 0.
    """
    m = e.model
    grow_block(e.trial.ways, (ways + 1) * m.integrals)
    at = ways * m.integrals
    most = 0.0
    for k in range(m.integrals):
        rate = value(m, m.integral_rate[k], e.v)
        moved = rate - e.trial.rates[k]
        size = value(m, m.integral_size[k], e.v)
        size = max(size if math.isfinite(size) else 0.0, math.fabs(rate))
        if not math.fabs(moved) > STEADY * size or not math.isfinite(moved):
            moved = 0.0
        e.trial.ways.at[at + k] = moved
        most = max(most, math.fabs(moved))
    if most == 0.0:
        return 0
    for k in range(m.integrals):
        e.trial.ways.at[at + k] /= most
    return 1


def keep_signals(e: Engine) -> None:
    """Keep what integrals are, now and a priori, with what their rounding is measured by."""
    m = e.model
    kept = e.trial.kept_signals
    for k in range(m.integrals):
        kept[3 * k] = e.v[m.signal_slot + k]
        kept[3 * k + 1] = e.pre[m.signal_slot + k]
        kept[3 * k + 2] = e.trial.terms[m.signal_slot + k]


def put_signals(e: Engine) -> None:
    """Put that back."""
    m = e.model
    kept = e.trial.kept_signals
    for k in range(m.integrals):
        e.v[m.signal_slot + k] = kept[3 * k]
        e.pre[m.signal_slot + k] = kept[3 * k + 1]
        e.trial.terms[m.signal_slot + k] = kept[3 * k + 2]


def move_signals(e: Engine, way: int, far: float, most: float) -> None:
    """Move integrals along a way from where they were kept: as time passes, a priori as well.

    What is moved by up to `most` is known no better than that, wherever it is.
    """
    m = e.model
    kept = e.trial.kept_signals
    for k in range(m.integrals):
        along = e.trial.ways.at[way * m.integrals + k]
        moved = far * along
        e.v[m.signal_slot + k] = kept[3 * k] + moved
        e.pre[m.signal_slot + k] = kept[3 * k + 1] + moved
        e.trial.terms[m.signal_slot + k] = kept[3 * k + 2] + math.fabs(most * along)


# -- what depends on them


def guard_turns(e: Engine, rule: int, ways: int) -> bool:
    """Whether a guard, shown the trial, has another truth if integrals move as they are free to."""
    measure_trial(e, rule)
    keep_signals(e)
    truths = 0
    for i in range(ways):
        far = far_of(e, rule, i)
        if far != 0.0:
            move_signals(e, i, 0.0, far)
            truths = truths | truths_of(e, rule)
            move_signals(e, i, far, far)
            truths = truths | truths_of(e, rule)
    put_signals(e)
    return truths == 3


def gap_turns(e: Engine, port: int, ways: int) -> bool:
    """Whether a contact is open or touches as integrals move."""
    m = e.model
    keep_signals(e)
    gap = value(m, m.port_gap[port], e.v)
    turned = False
    for i in range(ways):
        far = far_of(e, m.port_gap_pair[port], i)
        move_signals(e, i, far, far)
        moved = value(m, m.port_gap[port], e.v)
        turned = turned or (moved > 0.0) != (gap > 0.0)
    put_signals(e)
    return turned


def far_of(e: Engine, pair: int, way: int) -> float:
    """Return how far to go along a way: far beyond the largest integral that a pair reads.

    Zero if it reads none that moves there.
    """
    m = e.model
    most = 1.0
    moved = 0.0
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        k = m.read_slot[i] - m.signal_slot
        if k >= 0 and k < m.integrals:
            most = max(most, math.fabs(e.trial.kept_signals[3 * k]))
            moved = max(moved, math.fabs(e.trial.ways.at[way * m.integrals + k]))
    return FAR * most / moved if moved > 0.0 else 0.0


def is_free(e: Engine, k: int, ways: int) -> bool:
    """Whether any of the ways moves integral k."""
    for i in range(ways):
        if e.trial.ways.at[i * e.model.integrals + k] != 0.0:
            return True
    return False


# -- telling


def refuse(e: Engine, reader: int, ways: int, why: Text) -> int:
    """Refuse what reads a free integral: a rule, or ``-1 - k`` for the gap of port k."""
    m = e.model
    place = rule_text(m, reader) if reader >= 0 else node_name(m, m.port_node[-1 - reader])
    say_fault(e, "HB-J102", why, place)
    if m.tells != 0:
        add_fact(e.fault, float(reader))
        add_fact(e.fault, float(OPEN_SINCE))
        for k in range(m.integrals):
            if is_free(e, k, ways):
                add_fact(e.fault, float(k))
    return REFUSED


def warn(e: Engine, reader: int, ways: int) -> None:
    """Warn of it, where somebody will read that."""
    m = e.model
    if m.tells == 0:
        return
    begin_warning(e.warned, LEFT_OPEN, e.t)
    add_about(e.warned, float(reader))
    add_about(e.warned, float(OPEN_SINCE))
    for k in range(m.machines):
        add_about(e.warned, float(e.trial.state[k]))
    for k in range(m.integrals):
        if is_free(e, k, ways):
            add_about(e.warned, float(k))
