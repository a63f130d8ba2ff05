"""Whether a contact is met again at once: what an impact has put together stays there or leaves.

A plastic impact leaves no rebound, so that nothing tells flights that are none from what moves
away by itself: a sample that is taken of a signal is what the signal is, and drifts from it until
the next one. So the motion behind the impact is followed for a moment. What rests on its contact
falls back into it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_places
from hybond.engine.answers import value
from hybond.engine.contacts.accumulation import SOONEST, room_of, tick_of
from hybond.engine.contacts.landing_records import LAST_TIMES, Landings, in_force
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import (
    ask_in_motion,
    begin_sizes_in_motion,
    measure_in_motion,
)
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import begin_field, evaluate, field
from hybond.engine.words import Floats

IN_VAIN: Final = 3
"""Impacts at one instant behind which another one follows, if nothing tells."""
AT_FLOOR: Final = 2.0
"""Roundings off its bound at which what is compared is there: it is located one beyond."""
OWN: Final = 0.5
"""Part of its motion that a comparison has from the impact, if that moves it."""
MOMENT: Final = 10.0
"""How long the motion is followed, in the time in which impacts may end."""


def comes_back(e: Engine, g: Landings, k: int) -> bool:
    """Whether an impact follows on this one while all others that are chosen rest.

    It does for a law's own contact. Where nothing tells, as what is stored would change on the way
    back, it does if some have followed each other at this instant already.
    """
    m = e.model
    contact = g.touch_contact[k]
    machine = m.contact_machine[contact]
    target = m.contact_state[contact]
    g.touch_hidden[k] = 0.0
    if m.is_law[machine] != 0:
        return True
    look_ahead(e, g, machine)
    if not follow(e, g):
        return struck_in_vain(e, g, machine)
    if not leads_to(e, g, machine, target):
        return False
    g.touch_hidden[k] = hidden_flight(e, g, machine)
    return True


def struck_in_vain(e: Engine, g: Landings, machine: int) -> bool:
    """Whether a machine has been struck several times at this instant."""
    if g.kept[machine] < IN_VAIN:
        return False
    first = g.times[LAST_TIMES * machine + g.kept[machine] - IN_VAIN]
    return e.t - first <= float(IN_VAIN) * room_of_instant(e, e.t)


def look_ahead(e: Engine, g: Landings, machine: int) -> None:
    """Let the mode that is looked at be the one at rest, but for a machine that is as it is now."""
    copy_places(e.model.machines, g.state, 0, g.ahead, 0)
    g.ahead[machine] = e.state[machine]


def follow(e: Engine, g: Landings) -> bool:
    """Put where the motion leads in a moment into `g.at_rest`; False if nothing tells.

    Nothing does where there is no moment before a timed event. The end of the run is none: what
    rests there is no matter of where it ends.
    """
    n = e.states
    if mode_of(e, g.ahead) != OK or combine_here(e, g.ahead) != OK:
        return False
    begin_field(e, e.mode)
    h = max(MOMENT * room_of(e.t, e.span), SOONEST * e.span)
    if not e.t + h < e.next_break:
        h = 0.5 * (e.next_break - e.t)
    if not h > tick_of(e.t, e.span):
        return False
    g.ahead_t = e.t + h
    if field(e, e.mode, e.t, e.y, g.rate1) != OK:
        return False
    for j in range(n):
        g.at_rest[j] = e.y[j] + h * g.rate1[j]
    if field(e, e.mode, g.ahead_t, g.at_rest, g.rate2) != OK:
        return False
    for j in range(n):
        g.at_rest[j] = e.y[j] + 0.5 * h * (g.rate1[j] + g.rate2[j])
    return evaluate(e, e.mode, e.v, g.ahead_t, g.at_rest) == OK


def leads_to(e: Engine, g: Landings, machine: int, target: int) -> bool:
    """Whether rules lead a machine to a state there, by way of others as well.

    What is stored is as it is there: where a state on the way would change that, nothing tells.
    """
    m = e.model
    for _ in range(m.state_first[m.machines]):
        if not take_rules(e, g):
            return False
        if g.ahead[machine] == target:
            return True
        told = mode_of(e, g.ahead) == OK and combine_here(e, g.ahead) == OK
        told = told and not is_constrained(e.mode)
        if not (told and evaluate(e, e.mode, e.v, g.ahead_t, g.at_rest) == OK):
            return struck_in_vain(e, g, machine)
    return struck_in_vain(e, g, machine)


def hidden_flight(e: Engine, g: Landings, machine: int) -> float:
    """Return how long a flight is that rounding hides from the rules of the machines as they are.

    Where something is, is compared with where the floor is, and has the rounding of that: at 5 m a
    rebound of 1e-15 m is none, however high those before have been. A flight rises by a quarter of
    what it would if it went on as it begins.
    """
    m = e.model
    look_ahead(e, g, machine)
    if mode_of(e, g.ahead) != OK or combine_here(e, g.ahead) != OK:
        return 0.0
    shortest = math.inf
    known = False
    for k in range(m.machines):
        # another machine may be the one that looks where the contact is
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_source[r] != e.state[k]:
                continue
            for a in range(m.atom_first[r], m.atom_first[r + 1]):
                known = known or evaluate(e, e.mode, g.v, e.t, e.y) == OK
                if not known:
                    return 0.0
                near = ROUNDING * math.fabs(value(m, m.atom_size[a], g.v))
                if math.fabs(value(m, m.atom_value[a], g.v)) <= AT_FLOOR * near:
                    # to and fro between where it is located and where it is seen to leave
                    shortest = min(shortest, hidden_from(e, g, a, AT_FLOOR * near))
                    known = False
    return shortest if shortest < math.inf else 0.0


def hidden_from(e: Engine, g: Landings, atom: int, near: float) -> float:
    """Return how long a flight is that is no farther than the rounding of a comparison; inf: none.

    What moves alike before the impact and behind it is moved by something else.
    """
    h = g.ahead_t - e.t
    moved = moved_from(e, g, e.y, atom, h)
    before = moved_from(e, g, g.before, atom, h)
    own = math.fabs(moved - before) > OWN * math.fabs(moved)
    return 4.0 * near * h / math.fabs(moved) if own and moved != 0.0 else math.inf


def moved_from(e: Engine, g: Landings, y: Floats, atom: int, h: float) -> float:
    """Return how far a comparison moves in a time, as its motion begins at a state; nan: unknown.

    In the mode that is looked at.
    """
    m = e.model
    begin_field(e, e.mode)
    if field(e, e.mode, e.t, y, g.rate1) != OK:
        return math.nan
    for j in range(e.states):
        g.at_rest[j] = y[j] + h * g.rate1[j]
    if evaluate(e, e.mode, g.v, e.t, y) != OK:
        return math.nan
    if evaluate(e, e.mode, e.v, e.t + h, g.at_rest) != OK:
        return math.nan
    return value(m, m.atom_value[atom], e.v) - value(m, m.atom_value[atom], g.v)


def take_rules(e: Engine, g: Landings) -> bool:
    """Take the first rule of each machine that holds at the values ``e.v``; whether any does.

    Machines that are put to rest stay there, and laws go on as they are.
    """
    m = e.model
    stack = e.work.stack
    begin_sizes_in_motion(e)
    ask_in_motion(e)
    some = False
    for k in range(m.machines):
        g.led_to[k] = -1
        if m.is_law[k] != 0 or (g.ahead[k] == g.state[k] and g.state[k] != e.state[k]):
            continue
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if g.led_to[k] >= 0 or m.rule_source[r] != g.ahead[k] or not in_force(m, g, k, r):
                continue
            measure_in_motion(e, r)
            if holds(m, r, stack):
                g.led_to[k] = m.rule_target[r]
                some = True
    for k in range(m.machines):
        if g.led_to[k] >= 0:
            g.ahead[k] = g.led_to[k]
    return some
