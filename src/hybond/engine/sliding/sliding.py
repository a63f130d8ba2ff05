"""Sliding: motion along switching surfaces into which the modes on both sides push.

When a machine's rule fires without a jump, its reverse rule may push the state straight back. At
the first such event the fields around decide: through the surface, or along it in the combined
motion. While machines slide, their two rules rest, their weights are watched, and after each event
the fields decide anew. After modes/sliding/motion.py.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.instant.instant import (
    CONTINUOUS,
    GUARD,
    MYTHICAL,
    PINNACLE,
    Instant,
    add_energy,
    append_fired,
    is_struck,
    note_fired,
    note_step,
)
from hybond.engine.instant.told import (
    PUSHED_BACK,
    SLIDES_OFF,
    SLIDES_ON,
    THROWN_BACK,
    add_read,
    say_why,
)
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.values import evaluate
from hybond.engine.model import value
from hybond.engine.sliding.blend import combine_here, onto_surfaces
from hybond.engine.sliding.filippov import ABOVE, SLIDES
from hybond.engine.sliding.surface import is_of_state, put_read, surface_rate, surface_value
from hybond.engine.sliding.ways_on import (
    A_WAY,
    STOPS,
    decide,
    find_field,
    no_time,
    take_met,
    vanishes,
)
from hybond.engine.words import Floats

AT_ONCE: Final = 1e-11
"""A state is on a surface if it gets there within this part of the time that has passed."""
NOTHING: Final = 0
SLIDING: Final = -1
"""The state of a machine that slides, in what is written down."""


def slide_after(e: Engine, i: Instant, before: Floats) -> int:
    """Decide which machines slide from now on; change the state and mode, and what is written.

    `before` is the state before the instant. After Slider.after.
    """
    m = e.model
    s = e.slide
    happened = i.steps > 0
    if m.surfaces == 0 or m.slides == 0:
        return OK
    if not happened and s.many == 0 and i.cause == GUARD:
        return OK
    for k in range(m.machines):
        s.around[k] = e.state[k]
        s.settled[k] = e.state[k]
    moved = happened and has_moved(i)
    if find_met(e, i, before, moved) != OK:
        return REFUSED
    if s.met == 0 and s.many == 0:
        return show_again(e)
    held = s.many
    decided = NOTHING
    first = s.met_surface[0]
    met = s.met
    if met > 0:
        # whether they slide now tells the sides on which they are
        decided = decide(e)
        if decided == STOPS:
            return REFUSED
    if decided != A_WAY and met == 1 and moved and held == 0:
        if no_time(e, first):
            why = "jumps back and forth over a surface in no time are not part of an export"
            return say_fault(e, "HB-E635", why, "")
        s.met = 0
    slid = 0
    for k in range(m.machines):
        s.target[k] = s.settled[k]
    for j in range(s.met if decided == A_WAY else 0):
        if s.best[j] == SLIDES:
            slid += 1
    joint = held > 0 or slid > 0
    slid = 0
    for j in range(s.met if decided == A_WAY else 0):
        surface = s.met_surface[j]
        machine = m.surface_machine[surface]
        here = m.surface_above[surface] if s.best[j] == ABOVE else m.surface_below[surface]
        if s.best[j] == SLIDES:
            s.chosen[slid] = surface
            slid += 1
        elif fired_once(i, machine) >= 0 and moved and not joint:
            # thrown back by its own jump: it stays for no time, and is a pinnacle
            if s.target[machine] != here:
                s.target[machine] = here
                if onto(e, surface) != OK:
                    return REFUSED
        elif joint and (is_held(e, surface) or fired_once(i, machine) >= 0):
            s.target[machine] = here
    for j in range(held):
        surface = s.surface[j]
        machine = m.surface_machine[surface]
        known = False
        for p in range(s.met if decided == A_WAY else 0):
            known = known or s.met_surface[p] == surface
        now = s.settled[machine]
        if not known and (now == m.surface_below[surface] or now == m.surface_above[surface]):
            drop(e, surface)
    if slid > 0 and m.laws > 0:
        return say_fault(e, "HB-E635", "sliding beside junction laws is not part of an export", "")
    return go_on_sliding(e, i, slid)


def show_again(e: Engine) -> int:
    """Take the equations of the present mode again."""
    e.slide.k = 0
    return mode_of(e, e.state)


# -- what an event was


def has_moved(i: Instant) -> bool:
    """Whether what is stored jumped."""
    for k in range(i.steps):
        if i.kind.at[k] != MYTHICAL and is_struck(i, k):
            return True
    return False


def fired_once(i: Instant, machine: int) -> int:
    """Return the number of the only transition that a machine made, -1 if it is not one."""
    found = -1
    for f in range(i.fired if i.steps > 0 else 0):
        if i.machine.at[f] == machine:
            if found >= 0:
                return -1
            found = f
    return found


def went_and_came(i: Instant, machine: int) -> bool:
    """Whether a machine made a transition and its reverse, and no other."""
    many = 0
    first = -1
    back = False
    for f in range(i.fired):
        if i.machine.at[f] != machine:
            continue
        many += 1
        if many == 1:
            first = f
        else:
            back = i.source.at[f] == i.target.at[first] and i.target.at[f] == i.source.at[first]
    return many == 2 and back


def is_held(e: Engine, surface: int) -> bool:
    """Whether a surface is slid on."""
    for j in range(e.slide.many):
        if e.slide.surface[j] == surface:
            return True
    return False


# -- the surfaces that the state is on


def find_met(e: Engine, i: Instant, before: Floats, moved: bool) -> int:
    """Find the surfaces that the state is on, one per machine. After Slider._met.

    They are sought anew where the fields may have jumped, else among those just crossed.
    """
    m = e.model
    s = e.slide
    s.met = 0
    anew = i.cause != GUARD or moved
    turns = False
    if moved:
        for k in range(m.storages):
            s.x[k] = e.y[k] - before[k]
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
        crossed = f >= 0 and is_between(e, surface, i.source.at[f], i.target.at[f])
        held = is_held(e, surface)
        if known or not (crossed or held or anew):
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
        sure = held or (crossed and not anew and is_alone(e, surface, i.target.at[f]))
        sure = sure and not moved
        if turns and i.steps > 0 and went_and_came(i, machine):
            # there and back by a pinnacle: towards the surface, if its jumps have vanished
            sure = True
        if sure or is_on(e, surface):
            s.met_surface[s.met] = surface
            s.met += 1
    return OK


def is_between(e: Engine, surface: int, source: int, target: int) -> bool:
    """Whether a transition leads over a surface."""
    m = e.model
    up = source == m.surface_below[surface] and target == m.surface_above[surface]
    down = source == m.surface_above[surface] and target == m.surface_below[surface]
    return up or down


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


def speed_here(e: Engine, surface: int) -> float:
    """Return how fast a function moves in the mode looked at; nan if it reads what can jump.

    The rates of the state are in ``e.slide.rates`` then.
    """
    m = e.model
    s = e.slide
    for j in range(s.met):
        s.kept_met[j] = s.met_surface[j]
    kept = s.met
    s.met_surface[0] = surface
    status = take_met(e, 0, 1)
    known = status == OK and is_of_state(e, surface)
    for j in range(kept):
        s.met_surface[j] = s.kept_met[j]
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
    machine = m.surface_machine[surface]
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
    g = surface_value(e, surface, e.shown)
    if up != down:
        s.target[machine] = m.surface_above[surface] if up else m.surface_below[surface]
    elif g > 0.0:
        s.target[machine] = m.surface_above[surface]
    elif g < 0.0:
        s.target[machine] = m.surface_below[surface]


# -- going on


def go_on_sliding(e: Engine, i: Instant, slid: int) -> int:
    """Go on along the surfaces chosen, and write down what became of machines.

    After Slider._go_on and Slider._write.
    """
    m = e.model
    s = e.slide
    for k in range(m.machines):
        s.mark[k] = s.target[k]
    waiting = note_transitions(e, i, slid)
    s.many = slid
    for j in range(slid):
        s.surface[j] = s.chosen[j]
        for p in range(m.surface_rest[2 * s.chosen[j]], m.surface_rest[2 * s.chosen[j] + 2]):
            if m.rest_moves[p] != 0:
                why = "sliding that something else must allow is not part of an export"
                return say_fault(e, "HB-E635", why, "")
    for k in range(m.machines):
        e.state[k] = s.mark[k]
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    if s.k > 0 and onto_surfaces(e, e.t, e.y) != OK:
        return REFUSED
    s.known = False
    if waiting == 0:
        return OK
    if i.steps == 0:
        note_step(i, CONTINUOUS)
        return OK
    last = i.steps - 1
    differs = False
    for k in range(m.machines):
        differs = differs or s.settled[k] != e.state[k]
    if is_struck(i, last) and differs and s.many == 0:
        i.kind.at[last] = PINNACLE
        note_step(i, CONTINUOUS)
        if i.energies.at[last] != 0:
            left = i.energy.at[3 * last + 1]
            add_energy(i, left, left, 0.0)
    else:
        append_fired(i)
    return OK


def note_transitions(e: Engine, i: Instant, slid: int) -> int:
    """Note what the decision did to machines; return how many transitions there are."""
    m = e.model
    s = e.slide
    i.waiting = 0
    for j in range(s.many + slid):
        surface = s.surface[j] if j < s.many else s.chosen[j - s.many]
        machine = m.surface_machine[surface]
        stays = False
        for p in range(slid):
            stays = stays or s.chosen[p] == surface
        if is_held(e, surface) and stays:
            continue
        now = s.mark[machine]
        if stays:
            note_fired(i, machine, s.settled[machine], SLIDING)
            say_why(i.told, SLIDES_ON)
            add_read(i.told, float(surface), 0.0, False)
        elif now == m.surface_below[surface] or now == m.surface_above[surface]:
            note_fired(i, machine, SLIDING, now)
            say_why(i.told, SLIDES_OFF)
            add_read(i.told, float(surface), 0.0, False)
    for machine in range(m.machines):
        if s.settled[machine] == s.mark[machine]:
            continue
        known = False
        for j in range(s.many + slid):
            surface = s.surface[j] if j < s.many else s.chosen[j - s.many]
            known = known or m.surface_machine[surface] == machine
        if not known:
            note_fired(i, machine, s.settled[machine], s.mark[machine])
            if m.is_law[machine] == 0:
                say_why(i.told, PUSHED_BACK if s.many + slid > 0 else THROWN_BACK)
    return i.waiting
