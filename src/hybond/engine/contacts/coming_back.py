"""Whether a contact is met again at once: what an impact has put together stays there or leaves.

A plastic impact leaves no rebound, so that nothing tells flights that are none from what moves
away by itself: a sample that is taken of a signal is what the signal is, and drifts from it until
the next one. So the motion behind the impact is followed for a moment. What rests on its contact
falls back into it.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.contacts.accumulation import SOONEST, room_of, tick_of
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

ANY_STATE: Final = -1
MOMENT: Final = 10.0
"""How long the motion is followed, in the time in which impacts may end."""


def comes_back(e: Engine, g: Landings, k: int) -> bool:
    """Whether an impact follows on this one while all others that are chosen rest.

    Where nothing tells, it does: a law's own contact. One that is entered by way of other states,
    or of other machines, may be if anything happens.
    """
    m = e.model
    contact = g.touch_contact[k]
    machine = m.contact_machine[contact]
    target = m.contact_state[contact]
    free = e.state[machine]
    if m.is_law[machine] != 0:
        return True
    direct = False
    led = False
    for r in range(m.rule_first[machine], m.rule_first[machine + 1]):
        if m.rule_source[r] == free and m.rule_target[r] == target:
            direct = True
            led = led or m.rule_watched[r] == 0
    rest = g.state[machine]
    g.state[machine] = free
    moves = follow(e, g)
    found = not moves
    if direct and not led:
        found = found or meets(e, g, machine, target)
    else:
        for other in range(m.machines):
            found = found or meets(e, g, other, ANY_STATE)
    g.state[machine] = rest
    return found


def follow(e: Engine, g: Landings) -> bool:
    """Put where the motion leads in a moment into `g.at_rest`; False if nothing tells."""
    n = e.states
    if mode_of(e, g.state) != OK or combine_here(e, g.state) != OK:
        return False
    begin_field(e, e.mode)
    h = max(MOMENT * room_of(e.t, e.span), SOONEST * e.span)
    # also beyond the end of the run: what rests there is no matter of where it ends
    if not e.t + h < e.next_break:
        h = 0.5 * (e.next_break - e.t)
    if not h > tick_of(e.t, e.span):
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


def meets(e: Engine, g: Landings, machine: int, target: int) -> bool:
    """Whether a rule of a machine leads to a state, or to any, at the values ``e.v``."""
    m = e.model
    stack = e.work.stack
    begin_sizes_in_motion(e)
    ask_in_motion(e)
    for r in range(m.rule_first[machine], m.rule_first[machine + 1]):
        if m.rule_source[r] != g.state[machine] or m.rule_watched[r] == 0:
            continue
        if target != ANY_STATE and m.rule_target[r] != target:
            continue
        if in_force(m, g, machine, r):
            measure_in_motion(e, r)
            if holds(m, r, stack):
                return True
    return False
