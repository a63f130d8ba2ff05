"""Sliding: motion along switching surfaces into which the modes on both sides push.

When a machine's rule fires without a jump, its reverse rule may push the state straight back. At
the first such event the fields around decide: through the surface, or along it in the combined
motion. While machines slide,

* their two rules rest; every other rule is watched as ever, on the averaged signals;
* their weights are watched: at 0 or 1 a machine leaves the surface on that side;
* so is whatever else their rules ask for, and the branches of junction laws in the modes around;

after each event the fields decide anew.
"""

from __future__ import annotations

from hybond.engine.algebra.products import copy_places
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.instant.back_by_dust import refuse_turns
from hybond.engine.instant.instant import GUARD, Instant
from hybond.engine.laws.branches import choose_anew, choose_own, follow, know_around
from hybond.engine.mode.equations import mode_of
from hybond.engine.sliding.by_means import decide_by_means, first_unheld, refuse_pull
from hybond.engine.sliding.chatter import decide_led
from hybond.engine.sliding.crossings import collapse, take_back
from hybond.engine.sliding.filippov import ABOVE, SLIDES
from hybond.engine.sliding.from_edge import (
    decide_from_edge,
    is_held_by_some,
    slides_on_some,
    take_first_met,
)
from hybond.engine.sliding.going_on import go_on_sliding
from hybond.engine.sliding.met import drop, find_met, onto
from hybond.engine.sliding.ways_on import (
    A_WAY,
    CHOSEN,
    COLLAPSES,
    NO_WAY,
    NONE_HOLDS,
    STOPS,
    decide,
)
from hybond.engine.sliding.ways_told import begin_ways
from hybond.engine.sliding.what_happened import fired_once, has_moved, is_held
from hybond.engine.surfaces.corners import put_side
from hybond.engine.surfaces.law_means import NONE_PULLS, first_to_pull
from hybond.engine.words import Floats


def slide_after(e: Engine, i: Instant, before: Floats) -> int:
    """Decide which machines slide from now on; change the state and mode, and what is written.

    `before` is the state before the instant.
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
    choose_anew(e)
    know_around(e, e.state)
    if find_met(e, i, before, moved) != OK:
        return REFUSED
    if s.met == 0 and s.many == 0:
        return refuse_turns(e, i) if show_again(e) == OK else REFUSED
    part_from(e)
    met = s.met
    s.first_many = met
    copy_places(met, s.met_surface, 0, s.first_met, 0)
    decided = NO_WAY
    if met > 0:
        begin_ways(e)
        s.strikes = False
        decided = decide_met(e, met, moved)
    if decided == NO_WAY and s.strikes:
        met = leave_struck(e)
        decided = decide_met(e, met, moved) if met > 0 else NO_WAY
    if decided == STOPS:
        return REFUSED
    if decided == NO_WAY:
        # nothing is said of those met: what they were, they are
        s.met = met
        copy_places(met, s.first_met, 0, s.met_surface, 0)
    led = False
    for k in range(m.machines):
        s.target[k] = s.around[k]
        led = led or s.around[k] != s.settled[k]
    slid = 0
    if decided != NO_WAY:
        slid = take_sides(e, i, moved)
        if slid < 0:
            return REFUSED
    held = s.many
    for j in range(held):
        if is_done_with(e, s.surface[j]):
            drop(e, s.surface[j])
    follow(e, s.around, s.target)
    if held > 0 or slid > 0 or led:
        # what is shown, and what goes on alone, has the branches of its own laws
        choose_own(e, s.target)
    if go_on_sliding(e, i, slid, decided) != OK:
        return REFUSED
    return refuse_turns(e, i)


def decide_met(e: Engine, met: int, moved: bool) -> int:
    """Decide how the state goes on from the surfaces first met."""
    decided = decide_first(e, met, moved)
    if (decided == A_WAY or decided == CHOSEN) and slides_on_some(e):
        unheld = first_unheld(e)
        pulls = first_to_pull(e)
        if unheld != NONE_PULLS:
            decided = decide_by_means(e, met)
        if decided == NONE_HOLDS and pulls != NONE_PULLS:
            return refuse_pull(e, pulls)
        if decided == NONE_HOLDS:
            # friction that is torn carries no more than it can: it leaves its rest, or is met again
            decided = decide_first(e, met, moved) if take_first_met(e, met) == OK else STOPS
    if decided == NO_WAY and met == 1 and moved and e.slide.many == 0:
        return decide_collapsed(e)
    return decided


def leave_struck(e: Engine) -> int:
    """Leave those of the surfaces first met that are slid on; return how many there are.

    What has just been met would strike a contact after each turn: it goes on by events.
    """
    s = e.slide
    held = 0
    for j in range(s.first_many):
        if is_held(e, s.first_met[j]):
            s.first_met[held] = s.first_met[j]
            held += 1
    s.first_many = held
    choose_anew(e)
    return held if held == 0 or take_first_met(e, held) == OK else 0


def decide_first(e: Engine, met: int, moved: bool) -> int:
    """Decide how the state goes on whatever laws would have to carry on the mean."""
    decided = decide_led(e)
    if not moved and is_held_by_some(e, decided):
        decided = decide_from_edge(e, met)
    return decided


def part_from(e: Engine) -> None:
    """Put the machines of surfaces that have jumped away on their sides: the fields are those."""
    s = e.slide
    some = False
    copy_places(e.model.machines, s.settled, 0, s.target, 0)
    for j in range(s.many):
        if s.parted[s.surface[j]] != 0 and is_done_with(e, s.surface[j]):
            drop(e, s.surface[j])
            some = True
    if some:
        follow(e, s.settled, s.target)
        copy_places(e.model.machines, s.target, 0, s.around, 0)


def is_done_with(e: Engine, surface: int) -> bool:
    """Whether a surface that was slid on is none of those met, and its machine still beside it."""
    m = e.model
    s = e.slide
    for p in range(s.met):
        if s.met_surface[p] == surface:
            return False
    now = s.settled[m.surface_machine[surface]]
    return now == m.surface_below[surface] or now == m.surface_above[surface]


def decide_collapsed(e: Engine) -> int:
    """Decide from where switching back and forth over the surface met ends in no time."""
    s = e.slide
    surface = s.first_met[0]
    if not collapse(e, surface):
        return NO_WAY
    choose_anew(e)
    s.met = 1
    s.met_surface[0] = surface
    decided = decide(e)
    if decided == A_WAY and s.best[0] == SLIDES and first_unheld(e) != NONE_PULLS:
        decided = decide_by_means(e, 1)
    if (decided == A_WAY or decided == CHOSEN) and s.best[0] == SLIDES:
        return COLLAPSES
    take_back(e)
    choose_anew(e)
    if decided == STOPS:
        return STOPS
    # what is warned of is the decision that stays
    if take_first_met(e, 1) != OK or decide_led(e) == STOPS:
        return STOPS
    copy_places(e.model.machines, s.settled, 0, s.around, 0)
    return NO_WAY


def take_sides(e: Engine, i: Instant, moved: bool) -> int:
    """Give machines the sides decided on; return how many slide, -1 if the run stops.

    A crossing is what its own rule said, unless another surface has a say in it.
    """
    m = e.model
    s = e.slide
    slid = 0
    for j in range(s.met):
        if s.best[j] == SLIDES:
            s.chosen[slid] = s.met_surface[j]
            slid += 1
    joint = s.many > 0 or slid > 0
    for j in range(s.met):
        if s.best[j] == SLIDES:
            continue
        surface = s.met_surface[j]
        machine = m.surface_machine[surface]
        here = m.surface_above[surface] if s.best[j] == ABOVE else m.surface_below[surface]
        fired = fired_once(i, machine) >= 0
        if fired and moved and not joint:
            # thrown back by its own jump: it stays for no time, and is a pinnacle
            if s.target[machine] != here:
                s.target[machine] = here
                if onto(e, surface) != OK:
                    return -1
        elif joint and (fired or is_held(e, surface)):
            put_side(m, surface, s.best[j] == ABOVE, s.target)
    return slid


def show_again(e: Engine) -> int:
    """Take the equations of the present mode again."""
    e.slide.k = 0
    e.slide.parts = 1
    return mode_of(e, e.state)
