"""Sliding that begins where a diode is at its end, with the branches that it has from there.

A coil without current is held at none by a diode that blocks, and a conducting one is left at once
as its current falls. Where fast switching leads the current up along a reference, the diode
conducts: what is stored now does not tell, what is stored a moment later does. So each of the modes
around is asked where it leads, and with the branches of there, and the machines that follow, the
way on is decided again. It is taken if it leads to where these are the same.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Places, fit, grow_places
from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.engine import OK, Engine
from hybond.engine.laws.branches import choose, choose_ahead, choose_anew, follow
from hybond.engine.sliding.around import take_met
from hybond.engine.sliding.chatter import RETURNS, decide_led, other_after_turns
from hybond.engine.sliding.filippov import SLIDES
from hybond.engine.sliding.ways_on import A_WAY, CHOSEN, NO_WAY, STOPS
from hybond.engine.surfaces.blend import average, solve_part
from hybond.engine.surfaces.branch_table import take_branches
from hybond.engine.surfaces.corners import count_corners, put_coefficients, put_corner
from hybond.engine.surfaces.law_means import NONE_PULLS, first_to_pull
from hybond.engine.surfaces.outputs import show_state, stride
from hybond.engine.words import float_table

LENGTHS: Final = 3
LENGTH: Final = float_table(1e-6, 1e-3, 1.0)
"""How far ahead it is looked, as parts of a step of differences: further where nothing changes."""


def is_held_by_some(e: Engine, decided: int) -> bool:
    """Whether nothing was decided to slide where some mode holds what others would move."""
    m = e.model
    if m.laws == 0 and m.followers == 0:
        return False
    return decided == NO_WAY or (decided == A_WAY and e.slide.common and not slides_on_some(e))


def slides_on_some(e: Engine) -> bool:
    """Whether the way decided on slides."""
    s = e.slide
    for j in range(s.k):
        if s.best[j] == SLIDES:
            return True
    return False


def decide_from_edge(e: Engine, met: int) -> int:
    """Decide how to slide on the surfaces first met: CHOSEN, or what is decided without this."""
    s = e.slide
    n = e.states
    if take_first_met(e, met) != OK:
        return STOPS
    parts = s.parts
    s.common = False
    fit(s.edge_rate, (parts + 1) * n)
    known = True
    for part in range(parts):
        show_state(e, e.t, e.y, s.v)
        if solve_part(e, part, s.v, s.edge_rate.at, part * n, False) != OK:
            known = False
    put_modes(e, s.modes_now)
    for part in range(parts if known else 0):
        for turn in range(LENGTHS):
            if take_first_met(e, met) != OK:
                return STOPS
            if is_same_ahead(e, part * n, LENGTH[turn], s.modes_now):
                continue
            # a trial that is refused is one that leads nowhere
            if decide_led(e) == A_WAY and leads_there(e, parts * n):
                return CHOSEN
    choose_anew(e)
    return decide_led(e) if take_first_met(e, met) == OK else STOPS


def take_first_met(e: Engine, met: int) -> int:
    """Take the surfaces that were met first, with the modes around what was settled."""
    s = e.slide
    copy_places(e.model.machines, s.settled, 0, s.around, 0)
    s.met = met
    copy_places(met, s.first_met, 0, s.met_surface, 0)
    return take_met(e, 0, met, False)


def leads_there(e: Engine, at: int) -> bool:
    """Whether the way decided on slides, and leads to where its modes are those that it is of."""
    s = e.slide
    if not slides_on_some(e):
        return False
    put_coefficients(s, s.best_weight, s.coefficient)
    average(e, e.states, s.part_rate, s.rate)
    s.known = False
    if first_to_pull(e) != NONE_PULLS:
        return False
    copy_part(e.states, s.rate, 0, s.edge_rate.at, at)
    put_modes(e, s.modes_slid)
    for turn in range(LENGTHS):
        if is_same_ahead(e, at, LENGTH[turn], s.modes_slid):
            # what follows may only have stayed where it was: turns of switching tell
            return e.model.followers == 0 or other_after_turns(e) == RETURNS
    return False


def is_same_ahead(e: Engine, at: int, length: float, modes: Places) -> bool:
    """Whether the parts are the same modes where rates, from `at` on, lead.

    Branches are chosen there from now on.
    """
    s = e.slide
    show_state(e, e.t, e.y, s.v)
    choose_ahead(e, length * stride(e, s.v, s.edge_rate.at, at), s.edge_rate.at, at)
    put_modes(e, s.modes_ahead)
    for k in range(count_corners(s.k, s.product) * e.model.machines):
        if s.modes_ahead.at[k] != modes.at[k]:
            return False
    return True


def put_modes(e: Engine, modes: Places) -> None:
    """Put the modes there that the parts are where branches are chosen now."""
    m = e.model
    s = e.slide
    parts = count_corners(s.k, s.product)
    grow_places(modes, parts * m.machines)
    for part in range(parts):
        put_corner(m, s.around, part, s.k, s.product, s.side, s.state)
        follow(e, s.around, s.state)
        if m.laws > 0:
            choose(e, s.state)
            take_branches(m, s, s.state)
        copy_places(m.machines, s.state, 0, modes.at, part * m.machines)
