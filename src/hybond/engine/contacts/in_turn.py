"""Contacts without a rebound that strike in turn: each opens the other, ever faster.

A rope jerks a body off its stop, it falls back, and what pulls the rope goes on until that is taut
again: with each turn a part of the speed is left. No contact rebounds by itself, so the flights are
told by all events of their laws. At their limit all of them are closed, if they then push.
"""

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.contacts.accumulation import CHATTERING, crowd_within, restart, since_start
from hybond.engine.contacts.landing import CHATTERS, lie_down, tell_end
from hybond.engine.contacts.landing_records import Landings
from hybond.engine.contacts.rest import find_rest
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.instant.instant import ACCUMULATION, Instant, begin_instant, note_fired
from hybond.engine.instant.settling import Settling
from hybond.engine.jumps.trial import a_priori
from hybond.engine.laws.law_instant import NO_LAW_VALUE, is_on

TURN: Final = 10.0
"""Contacts that strike in turn have one limit, of which each tells by its own events only: this
many times the time room is what the others may have left, and what their next flights may take."""
SOME: Final = 5
"""Instants that tell of a limit where another contact has told of it by all that are kept."""


NONE_RESTS: Final = 0
LANDED: Final = 1
RESTED: Final = 2
"""What comes of events that accumulate: no rest is known; contacts were put to rest at their limit;
all were, by the last of these events itself."""


def land_in_turn(e: Engine, s: Settling, i: Instant) -> int:
    """Put contacts to rest whose events accumulate; return what came of it, -1 if refused.

    Called where `stuck` has found the limit of the events of one of them.
    """
    m = e.model
    g = e.landings
    if g.stuck_why != CHATTERS:
        return NONE_RESTS
    t = g.limit_t
    ratio = g.limit_ratio
    room = TURN * CHATTERING * since_start(e.t, e.span)
    if not rests(e, g, room, True, LANDED) and not rests(e, g, room, False, LANDED):
        if rests(e, g, room, True, RESTED) or rests(e, g, room, False, RESTED):
            forget_chosen(e, g, t)
            return RESTED
        return NONE_RESTS
    g.found_t = t
    g.found_ratio = ratio
    begin_instant(i, e.t, ACCUMULATION)
    for k in range(m.machines):
        if g.chosen[k] == 0:
            continue
        if g.state[k] != e.state[k]:
            note_fired(i, k, e.state[k], g.state[k])
            tell_end(i, max(g.other_kept[k], g.count[k]), t, ratio)
    forget_chosen(e, g, t)
    return lie_down(e, g, s, i)


def forget_chosen(e: Engine, g: Landings, t: float) -> None:
    """Forget the events of the chosen contacts: they have come to their limit, `t`."""
    for k in range(e.model.machines):
        if g.chosen[k] != 0:
            restart(g, k, t)
            g.other_kept[k] = 0


def rests(e: Engine, g: Landings, room: float, touching: bool, how: int) -> bool:
    """Whether contacts whose events accumulate push when all are closed, LANDED or RESTED."""
    return close_in_turn(e, g, room, touching) == how and would_carry(e, g, room)


def close_in_turn(e: Engine, g: Landings, room: float, touching: bool) -> int:
    """Choose the contacts whose events accumulate, two at least, into `g.state` all closed.

    LANDED if some are open yet, RESTED if none is.

    Or all that are `touching`, whose own events may be those of another: what lies between two of
    them strikes both at one instant.
    """
    m = e.model
    for k in range(m.machines):
        g.state[k] = e.state[k]
        g.chosen[k] = 0
    many = 0
    opened = False
    for p in range(m.ports):
        k = m.port_machine[p]
        if m.port_gap[p] == NO_LAW_VALUE:
            continue
        if not (e.laws.able[p] != 0 if touching else takes_turns(g, k, room)):
            continue
        g.chosen[k] = 1
        many += 1
        if not is_on(m, p, e.state[k]):
            opened = True
            for state in range(m.state_first[k + 1] - m.state_first[k]):
                if state != m.port_bounce[p] and is_on(m, p, state):
                    g.state[k] = state
    if many < 2:
        return NONE_RESTS
    return LANDED if opened else RESTED


def takes_turns(g: Landings, k: int, room: float) -> bool:
    """Whether the events of a contact have a limit, its impacts or those without a rebound."""
    others = g.other_kept[k]
    if others >= SOME and crowd_within(g, g.others, k, others, room):
        return True
    return g.kept[k] >= SOME and crowd_within(g, g.times, k, g.kept[k], room)


def would_carry(e: Engine, g: Landings, room: float) -> bool:
    """Whether all chosen contacts push at rest, and what is left of their flights is none."""
    m = e.model
    copy_floats(m.storages, e.y, g.x)
    copy_part(m.integrals, e.y, m.storages, g.s, 0)
    if a_priori(e, e.t, g.x, g.s, e.state) != OK or find_rest(e, g, e.t, g.state) != OK:
        return False
    for p in range(m.ports):
        if g.chosen[m.port_machine[p]] == 0:
            continue
        force = 0.0
        area = 0.0
        size = 0.0
        for c in range(m.pair_first[2 * p], m.pair_first[2 * p + 1]):
            column = m.pair_column[c]
            for j in range(g.loose):
                if e.trial.freedom.at[column * g.loose + j] != 0.0:
                    return False
            force += m.pair_value[c] * g.force[column]
            area += m.pair_value[c] * g.area[column]
            size += math.fabs(m.pair_value[c]) * g.size[column]
        if not force > ROUNDING * size or 2.0 * math.fabs(area) > room * force:
            return False
    return True
