"""Whether a contact is met again at once: what an impact has put together stays there or leaves.

A plastic impact leaves no rebound, so that nothing tells flights that are none from what moves
away by itself: a sample that is taken of a signal is what the signal is, and drifts from it until
the next one. So the motion behind the impact is followed for a moment. What rests on its contact
falls back into it.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.contacts.accumulation import SOONEST, room_of
from hybond.engine.contacts.landing_records import Landings, in_force
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.guards.guard_values import (
    ask_in_motion,
    begin_sizes_in_motion,
    measure_in_motion,
)
from hybond.engine.mode.equations import mode_of
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import begin_field, evaluate, field

MOMENT: Final = 10.0
"""How long the motion is followed, in the time in which impacts may end."""


def comes_back(e: Engine, g: Landings, k: int) -> bool:
    """Whether an impact follows on this one while all others that are chosen rest.

    Where nothing tells, it does, as of a law's own contact. It does not where no rule leads back,
    as of a switch that has filled a capacitor for good, or only one that waits for an instant.
    """
    m = e.model
    contact = g.touch_contact[k]
    machine = m.contact_machine[contact]
    free = e.state[machine]
    if m.is_law[machine] != 0:
        return True
    some = False
    for p in range(m.back_first[contact], m.back_first[contact + 1]):
        some = some or m.rule_source[m.back_rule[p]] == free
    if not some:
        return False
    rest = g.state[machine]
    g.state[machine] = free
    found = not follow(e, g) or meets(e, g, contact)
    g.state[machine] = rest
    return found


def follow(e: Engine, g: Landings) -> bool:
    """Put where the motion leads in a moment into `g.at_rest`; False if nothing tells."""
    n = e.states
    if mode_of(e, g.state) != OK or combine_here(e, g.state) != OK:
        return False
    begin_field(e, e.mode)
    h = max(MOMENT * room_of(e.t, e.span), SOONEST * e.span)
    if not e.t + h < min(e.next_break, e.until):
        return False
    if field(e, e.mode, e.t, e.y, g.rate1) != OK:
        return False
    for j in range(n):
        g.at_rest[j] = e.y[j] + h * g.rate1[j]
    if field(e, e.mode, e.t + h, g.at_rest, g.rate2) != OK:
        return False
    for j in range(n):
        g.at_rest[j] = e.y[j] + 0.5 * h * (g.rate1[j] + g.rate2[j])
    return evaluate(e, e.mode, e.v, e.t + h, g.at_rest) == OK


def meets(e: Engine, g: Landings, contact: int) -> bool:
    """Whether a rule leads a machine on its way back to a contact at the values ``e.v``.

    What asks for states of other machines alone may hold as soon as one of these goes on.
    """
    m = e.model
    machine = m.contact_machine[contact]
    begin_sizes_in_motion(e)
    ask_in_motion(e)
    for p in range(m.back_first[contact], m.back_first[contact + 1]):
        r = m.back_rule[p]
        if m.rule_source[r] != g.state[machine]:
            continue
        if m.rule_watched[r] == 0:
            if others_go_on(e, g, machine):
                return True
        elif holds_here(e, g, machine, r):
            return True
    return False


def others_go_on(e: Engine, g: Landings, machine: int) -> bool:
    """Whether another machine goes on at the values ``e.v``; of the law of a junction it may be."""
    m = e.model
    for k in range(m.machines):
        if k == machine:
            continue
        if m.is_law[k] != 0:
            return True
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            here = m.rule_source[r] == g.state[k] and m.rule_watched[r] != 0
            if here and holds_here(e, g, k, r):
                return True
    return False


def holds_here(e: Engine, g: Landings, machine: int, rule: int) -> bool:
    """Whether a rule of a machine is in force and holds at the values ``e.v``."""
    if not in_force(e.model, g, machine, rule):
        return False
    measure_in_motion(e, rule)
    return holds(e.model, rule, e.work.stack)
