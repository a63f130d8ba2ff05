"""Sliding that begins where a junction law is at its end, with the branches that it has from there.

A coil without current is held at none by a diode that blocks, and a conducting one is left at once
as its current falls. Where fast switching leads the current up along a reference, the diode
conducts: what is stored now does not tell, what is stored a moment later does. So each of the modes
around is asked where it leads, and with the branches of there the way on is decided again. It is
taken if it leads to where the same branches hold.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Places, fit, grow_places
from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.engine import OK, Engine
from hybond.engine.laws.branches import choose, choose_ahead, choose_anew
from hybond.engine.sliding.around import take_met
from hybond.engine.sliding.chatter import decide_led
from hybond.engine.sliding.filippov import SLIDES
from hybond.engine.sliding.ways_on import A_WAY, NO_WAY, STOPS
from hybond.engine.surfaces.blend import average, solve_part
from hybond.engine.surfaces.branch_table import find_branches
from hybond.engine.surfaces.corners import put_coefficients
from hybond.engine.surfaces.outputs import show_state, stride
from hybond.engine.words import float_table

LENGTHS: Final = 3
LENGTH: Final = float_table(1e-6, 1e-3, 1.0)
"""How far ahead it is looked, as parts of a step of differences: further where nothing changes."""


def is_held_by_some(e: Engine, decided: int) -> bool:
    """Whether nothing was decided to slide where some mode holds what others would move."""
    return decided == NO_WAY or (decided == A_WAY and e.slide.common and not slides_on_some(e))


def slides_on_some(e: Engine) -> bool:
    """Whether the way decided on slides."""
    s = e.slide
    for j in range(s.k):
        if s.best[j] == SLIDES:
            return True
    return False


def decide_from_edge(e: Engine, met: int, decided: int) -> int:
    """Decide how to slide on the surfaces first met; what was decided before if it does not."""
    s = e.slide
    n = e.states
    put_first_met(e, met)
    if take_met(e, 0, met, False) != OK:
        return STOPS
    parts = s.parts
    s.common = False
    fit(s.edge_rate, (parts + 1) * n)
    known = True
    for part in range(parts):
        show_state(e, e.t, e.y, s.v)
        solved = solve_part(e, part, s.v, s.edge_rate.at, part * n, False) == OK
        known = known and solved
    now = keep_branches(e, s.branch_now)
    for part in range(parts if known else 0):
        for turn in range(LENGTHS):
            if is_same_ahead(e, part * n, LENGTH[turn], now, s.branch_now):
                continue
            put_first_met(e, met)
            ahead = decide_led(e)
            if ahead == STOPS:
                return STOPS
            if ahead == A_WAY and leads_there(e, parts * n):
                s.from_edge = True
                return A_WAY
    choose_anew(e)
    put_first_met(e, met)
    return decide_led(e) if decided == A_WAY else NO_WAY


def put_first_met(e: Engine, met: int) -> None:
    """Put the surfaces there that were met first."""
    e.slide.met = met
    copy_places(met, e.slide.first_met, 0, e.slide.met_surface, 0)


def leads_there(e: Engine, at: int) -> bool:
    """Whether the way decided on slides, and leads to where its branches hold."""
    s = e.slide
    n = e.states
    if not slides_on_some(e):
        return False
    put_coefficients(s, s.best_weight, s.coefficient)
    average(e, n, s.part_rate, s.rate)
    s.known = False
    copy_part(n, s.rate, 0, s.edge_rate.at, at)
    chosen = keep_branches(e, s.branch_ahead)
    for turn in range(LENGTHS):
        if is_same_ahead(e, at, LENGTH[turn], chosen, s.branch_ahead):
            return True
    return False


def keep_branches(e: Engine, kept: Places) -> int:
    """Keep the branches that are known; return of how many modes."""
    s = e.slide
    grow_places(kept, s.branches * e.model.machines)
    copy_places(s.branches * e.model.machines, s.branch.at, 0, kept.at, 0)
    return s.branches


def is_same_ahead(e: Engine, at: int, length: float, rows: int, kept: Places) -> bool:
    """Whether so many modes have the branches kept of them where rates, from `at` on, lead.

    Branches are chosen there from now on.
    """
    m = e.model
    s = e.slide
    show_state(e, e.t, e.y, s.v)
    choose_ahead(e, length * stride(e, s.v, s.edge_rate.at, at), s.edge_rate.at, at)
    same = True
    for row in range(rows):
        copy_places(m.machines, kept.at, row * m.machines, s.state, 0)
        choose(e, s.state)
        there = find_branches(m, s, s.state)
        for k in range(m.machines):
            if s.branch.at[there * m.machines + k] != kept.at[row * m.machines + k]:
                same = False
    return same
