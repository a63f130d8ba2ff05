"""Which modes are combined while machines slide."""

from __future__ import annotations

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.kept_modes import keep_together
from hybond.engine.surfaces.branch_table import take_branches
from hybond.engine.surfaces.common_space import find_common
from hybond.engine.surfaces.corners import count_corners, put_corner
from hybond.engine.surfaces.followers import let_follow
from hybond.engine.surfaces.slide_records import fit_slide
from hybond.engine.surfaces.surface import is_of_state
from hybond.engine.words import Ints


def take_parts(e: Engine, state: Ints) -> int:
    """Take the modes around the surfaces ``side[0 .. k - 1]`` of a mode.

    They have the branches of junction laws that are known, else those of `state`.
    """
    m = e.model
    s = e.slide
    s.known = False
    s.parts = count_corners(s.k, s.product)
    # one more: a mode that the others are held against
    fit_slide(m, s, s.k, s.parts + 1)
    # trials in between must not make any of them be forgotten
    keep_together(e, 2 * s.parts)
    for part in range(s.parts):
        put_corner(m, state, part, s.k, s.product, s.side, s.corner)
        let_follow(e, state, s.corner)
        take_branches(m, s, s.corner)
        if mode_of(e, s.corner) != OK:
            return REFUSED
        s.part[part] = e.mode_at
    if mode_of(e, state) != OK:
        return REFUSED
    for j in range(s.k):
        s.of_state[j] = 1 if is_of_state(e, s.side[j]) else 0
    return OK


def combine_here(e: Engine, state: Ints) -> int:
    """Take what a mode is combined of while some machines slide; nothing if none does."""
    m = e.model
    s = e.slide
    s.k = 0
    s.parts = 1
    for i in range(s.many):
        surface = s.surface[i]
        now = state[m.surface_machine[surface]]
        if now == m.surface_below[surface] or now == m.surface_above[surface]:
            s.side[s.k] = surface
            s.k += 1
    if s.k == 0:
        return OK
    s.product = s.slid_product
    if take_parts(e, state) != OK:
        return REFUSED
    find_common(e)
    return OK
