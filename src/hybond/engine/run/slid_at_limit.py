"""Machines whose crossings accumulate where their surfaces meet: from there they may slide on all.

Each crosses its own surface again and again, a little nearer to those of the others, as a motion
that winds round the place where two relays switch and gets there in finite time.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_places
from hybond.engine.contacts.accumulation import CHATTERING, crowd_within, restart, since_start
from hybond.engine.contacts.landing import CHATTERS
from hybond.engine.contacts.landing_records import LAST_TIMES
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.instant.instant import ACCUMULATION, Instant, begin_instant
from hybond.engine.laws.branches import choose_anew, choose_own, follow, know_around
from hybond.engine.mode.equations import mode_of
from hybond.engine.sliding.by_means import decide_by_means, first_unheld
from hybond.engine.sliding.chatter import decide_led
from hybond.engine.sliding.filippov import SLIDES
from hybond.engine.sliding.from_edge import slides_on_some
from hybond.engine.sliding.going_on import go_on_sliding
from hybond.engine.sliding.ways_on import A_WAY, CHOSEN, STOPS
from hybond.engine.sliding.ways_told import begin_ways
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.law_means import NONE_PULLS

NONE_SLIDES: Final = 0
SLID: Final = 1


def slide_at_limit(e: Engine, i: Instant) -> int:
    """Slide on all surfaces that are crossed ever faster, where that is the way on.

    SLID, NONE_SLIDES, or -1 if refused. Called where `stuck` has found the limit of such events.
    """
    m = e.model
    s = e.slide
    if m.surfaces == 0 or m.slides == 0 or s.many > 0 or e.landings.stuck_why != CHATTERS:
        return NONE_SLIDES
    find_crossed(e)
    if s.met < 2:
        s.met = 0
        return NONE_SLIDES
    met = s.met
    s.first_many = met
    copy_places(met, s.met_surface, 0, s.first_met, 0)
    for k in range(m.machines):
        s.around[k] = e.state[k]
        s.settled[k] = e.state[k]
    choose_anew(e)
    know_around(e, e.state)
    begin_ways(e)
    decided = decide_led(e)
    if decided == A_WAY and slides_on_some(e) and first_unheld(e) != NONE_PULLS:
        decided = decide_by_means(e, met)
    slid = 0
    for j in range(s.met if decided == A_WAY or decided == CHOSEN else 0):
        if s.best[j] == SLIDES:
            s.chosen[slid] = s.met_surface[j]
            slid += 1
    if decided == STOPS:
        return -1
    if slid < met:
        # they cross, or nobody knows: events go on accumulating
        s.met = 0
        s.k = 0
        s.parts = 1
        choose_anew(e)
        back = mode_of(e, e.state) == OK and combine_here(e, e.state) == OK
        return NONE_SLIDES if back else -1
    for j in range(slid):
        machine = m.surface_machine[s.chosen[j]]
        restart(e.landings, machine, e.t)
        e.landings.other_kept[machine] = 0
    copy_places(m.machines, s.around, 0, s.target, 0)
    begin_instant(i, e.t, ACCUMULATION)
    follow(e, s.around, s.target)
    choose_own(e, s.target)
    return -1 if go_on_sliding(e, i, slid, decided) == REFUSED else SLID


def find_crossed(e: Engine) -> None:
    """Put the surfaces there, one of each machine, whose crossings have a limit now."""
    m = e.model
    g = e.landings
    s = e.slide
    room = CHATTERING * since_start(e.t, e.span)
    s.met = 0
    for surface in range(m.surfaces):
        k = m.surface_machine[surface]
        now = e.state[k]
        beside = now == m.surface_below[surface] or now == m.surface_above[surface]
        known = False
        for j in range(s.met):
            known = known or m.surface_machine[s.met_surface[j]] == k
        few = g.other_kept[k] < LAST_TIMES - 1
        if known or few or not beside or m.is_law[k] != 0:
            continue
        if crowd_within(g, g.others, k, g.other_kept[k], room):
            s.met_surface[s.met] = surface
            s.met += 1
