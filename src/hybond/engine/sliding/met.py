"""The surfaces that the state is on after an event."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.instant.instant import GUARD, Instant
from hybond.engine.instant.small_jumps import is_between, vanishes, went_and_came
from hybond.engine.mode.equations import mode_of
from hybond.engine.model import Model
from hybond.engine.sliding.around import find_field, take_met
from hybond.engine.sliding.what_happened import fired_once, is_held
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.corners import put_side
from hybond.engine.surfaces.parted import APART, error_of, find_parted
from hybond.engine.surfaces.reads import READS_SWITCH
from hybond.engine.surfaces.surface import put_read, surface_rate
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats

AT_ONCE: Final = 1e-11
"""A state is on a surface if it gets there within this part of the time that has passed."""


def find_met(e: Engine, i: Instant, before: Floats, moved: bool) -> int:
    """Find the surfaces that the state is on, one per machine.

    They are sought anew where the fields may have jumped, else among those just crossed.
    """
    m = e.model
    s = e.slide
    s.met = 0
    anew = i.cause != GUARD or moved
    turns = False
    if find_left(e, (anew or i.steps > 0) and not moved) != OK:
        return REFUSED
    # too little for an impulse may still be a jump: of what is stored, some may count for less
    jumped = moved
    for k in range(m.storages if i.steps > 0 else 0):
        s.x[k] = e.y[k] - before[k]
        jumped = jumped or s.x[k] != 0.0
    if jumped:
        turns = vanishes(e, s.x, e.y)
    shown = False
    for surface in range(m.surfaces):
        machine = m.surface_machine[surface]
        now = e.state[machine]
        if now != m.surface_below[surface] and now != m.surface_above[surface]:
            continue
        known = False
        for j in range(s.met):
            known = known or m.surface_machine[s.met_surface[j]] == machine
        f = fired_once(i, machine)
        crossed = f >= 0 and is_between(m, surface, i.source.at[f], i.target.at[f])
        held = is_held(e, surface)
        # there and back by a pinnacle: towards the surface, if its jumps have vanished
        back = (turns or i.by_dust) and went_and_came(i, machine)
        if known or not (crossed or held or anew or back):
            continue
        if not shown:
            if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
                return REFUSED
            if evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
                return REFUSED
            shown = True
        if not is_allowed(e, surface):
            continue
        # at a timed event a rule may have fired because an input jumped over the surface, and one
        # that asks for more because that has come true
        sure = crossed and not anew and is_alone(e, surface, i.target.at[f])
        if sure and not held and may_jump_over(m, surface):
            shown = False
            if jumps_over(e, surface):
                continue
        sure = (sure or (held and s.parted[surface] == 0)) and not moved
        if sure or back or is_on(e, surface):
            s.met_surface[s.met] = surface
            s.met += 1
    return OK


def find_left(e: Engine, anew: bool) -> int:
    """Find which surfaces slid on have jumped away from the state, where any may have."""
    s = e.slide
    for j in range(s.many):
        s.parted[s.surface[j]] = 0
    if s.many == 0 or not (anew or s.parts_now):
        return OK
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    find_parted(e, e.t, e.y, APART)
    s.parts_now = False
    return OK


def jumps_over(e: Engine, surface: int) -> bool:
    """Whether a surface that was crossed has jumped over the state, which is not on it."""
    s = e.slide
    known = take_one(e, surface) == OK
    jumped = known and find_parted(e, e.t, e.y, error_of(e.model))
    s.parted[surface] = 0
    return jumped or mode_of(e, e.state) != OK or combine_here(e, e.state) != OK


def may_jump_over(m: Model, surface: int) -> bool:
    """Whether a surface may jump between timed events, where nothing that is stored does."""
    may = m.surface_jump_first[surface] < m.surface_jump_first[surface + 1] or m.called > 0
    for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
        may = may or m.surface_kind[i] == READS_SWITCH
    return may


def is_alone(e: Engine, surface: int, target: int) -> bool:
    """Whether the rule that leads over a surface asks for nothing else."""
    m = e.model
    side = 2 * surface + (0 if target == m.surface_above[surface] else 1)
    return m.surface_rest[side] == m.surface_rest[side + 1]


def is_allowed(e: Engine, surface: int) -> bool:
    """Whether what else the rules ask for holds at the values shown."""
    m = e.model
    for i in range(m.surface_rest[2 * surface], m.surface_rest[2 * surface + 2]):
        if value(m, m.rest_value[i], e.shown) == 0.0:
            return False
    return True


def is_on(e: Engine, surface: int) -> bool:
    """Whether the state is on a surface: it was there an instant ago, or will be."""
    m = e.model
    g = value(m, m.surface_value[surface], e.shown)
    if g == 0.0:
        return True
    speed = speed_here(e, surface)
    return speed == speed and math.fabs(g) <= AT_ONCE * math.fabs(e.t) * math.fabs(speed)


def take_one(e: Engine, surface: int) -> int:
    """Combine the two modes at one surface, behind those met, whose machines follow none."""
    s = e.slide
    s.met_surface[s.met] = surface
    s.met += 1
    status = take_met(e, s.met - 1, 1, False)
    s.met -= 1
    return status


def speed_here(e: Engine, surface: int) -> float:
    """Return how fast a function moves in the mode looked at; nan if it reads what can jump.

    The rates of the state are in ``e.slide.rates`` then.
    """
    m = e.model
    s = e.slide
    known = take_one(e, surface) == OK and s.of_state[0] != 0
    speed = math.nan
    if known:
        s.k = 0
        found = mode_of(e, s.around) == OK and find_field(e, s.rates)
        s.k = 1
        if found:
            for k in range(2 * m.slots):
                s.v[k] = e.v[k]
            put_read(e, surface, s.v)
            speed = surface_rate(e, surface, s.v, s.rates, 0, True)
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return math.nan
    return speed


def onto(e: Engine, surface: int) -> int:
    """Put the state back on a surface that it is off by rounding, along the motion."""
    m = e.model
    s = e.slide
    for k in range(m.machines):
        s.around[k] = s.target[k]
        s.mark[k] = s.target[k]
    speed = speed_here(e, surface)
    for k in range(m.machines):
        s.around[k] = s.settled[k]
        s.target[k] = s.mark[k]
    if speed != speed or speed == 0.0:
        return OK
    s.k = 0
    s.known = False
    if mode_of(e, s.target) != OK or evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return REFUSED
    back = value(m, m.surface_value[surface], e.shown) / speed
    for k in range(e.states):
        e.y[k] -= back * s.rates[k]
    return OK


def drop(e: Engine, surface: int) -> None:
    """Give a machine that slides no more the side that its rules, or its function, ask for."""
    m = e.model
    s = e.slide
    if mode_of(e, s.settled) != OK or combine_here(e, s.settled) != OK:
        return
    if evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return
    up = True
    down = True
    for i in range(m.surface_rest[2 * surface], m.surface_rest[2 * surface + 1]):
        up = up and value(m, m.rest_value[i], e.shown) != 0.0
    for i in range(m.surface_rest[2 * surface + 1], m.surface_rest[2 * surface + 2]):
        down = down and value(m, m.rest_value[i], e.shown) != 0.0
    g = value(m, m.surface_value[surface], e.shown)
    if up != down:
        put_side(m, surface, up, s.target)
    elif g != 0.0:
        put_side(m, surface, g > 0.0, s.target)
