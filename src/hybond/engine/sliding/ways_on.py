"""How a state on switching surfaces goes on."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.laws.branches import choose_own, follow
from hybond.engine.mode.equations import mode_of
from hybond.engine.sliding.additive import ACT_TOGETHER, NO_FIELD, how_switches_act
from hybond.engine.sliding.around import find_field, take_met
from hybond.engine.sliding.crossings import do_meet
from hybond.engine.sliding.filippov import ABOVE, BELOW, SLIDES, find_ways
from hybond.engine.sliding.ways_told import (
    forget_ways,
    warn_of_no_way,
    warn_of_strokes,
    warn_of_twins,
    warn_of_ways,
)
from hybond.engine.surfaces.blend import blend, find_speeds
from hybond.engine.surfaces.common_space import find_common
from hybond.engine.surfaces.corners import MOST_PRODUCT, cross_as_one
from hybond.engine.surfaces.outputs import find_agreeing, show_state

MOVES_ALIKE: Final = 1e-12
"""Two states of a machine move what is stored alike if their rates differ by less: rounding."""
NO_WAY: Final = 0
A_WAY: Final = 1
STOPS: Final = 2
COLLAPSES: Final = 3
"""There is a way on, from where infinitely many jumps of this instant end."""
CHOSEN: Final = 4
"""There is a way on, with branches of laws that are not those of the state, but of the way."""
NONE_HOLDS: Final = 5
"""There is a way on, but no choice of laws that push only holds on it."""


def decide(e: Engine) -> int:
    """Decide how the state goes on from the surfaces met: NO_WAY, A_WAY or STOPS.

    What was warned of other decisions of this instant is forgotten: they are given up for this one.
    The way is in ``best``, for the surfaces that are left in ``met_surface``, and whether it is one
    of a product combination.
    """
    s = e.slide
    met = s.met
    if e.model.tells != 0:
        forget_ways(e)
    one_each(e)
    if leave_agreeing(e) != OK:
        return STOPS
    if s.met == 0:
        return NO_WAY
    if take_speeds(e, False) != OK:
        return STOPS
    found = how_switches_act(e)
    if found == NO_FIELD:
        return STOPS
    s.best_product = found == ACT_TOGETHER
    if s.best_product and s.met > MOST_PRODUCT:
        if e.model.tells != 0:
            warn_of_no_way(e)
        return NO_WAY
    if s.best_product and take_speeds(e, True) != OK:
        return STOPS
    note_sides(e)
    if find_ways(e) == 0:
        if e.model.tells != 0:
            warn_of_no_way(e)
        return NO_WAY
    if e.model.tells != 0:
        warn_of_ways(e)
    slides = 0
    for j in range(s.k):
        slides += 1 if s.best[j] == SLIDES else 0
    if s.common and slides > 0 and not s.product and push(e, slides) != A_WAY:
        return STOPS
    if e.model.tells != 0:
        warn_of_twins(e, met)
    if e.model.tells != 0 and s.common and slides == 0 and s.k == 1:
        warn_of_strokes(e)
    return A_WAY


def take_speeds(e: Engine, product: bool) -> int:
    """Take the modes around all surfaces met, and how fast the functions move in them."""
    s = e.slide
    if take_met(e, 0, s.met, product) != OK:
        return STOPS
    find_common(e)
    show_state(e, e.t, e.y, s.v)
    return find_speeds(e, True)


def note_sides(e: Engine) -> None:
    """Note on which side of each surface the state is now, or that it slides on it."""
    m = e.model
    s = e.slide
    for j in range(s.k):
        surface = s.side[j]
        state = s.around[m.surface_machine[surface]]
        slid = False
        for i in range(s.many):
            slid = slid or s.surface[i] == surface
        s.sides[j] = SLIDES if slid else ABOVE if state == m.surface_above[surface] else BELOW


def push(e: Engine, slides: int) -> int:
    """Leave out surfaces that a mode leads away from before any jump.

    On the mean a mode may be led back by its jumps alone; but there are none if it never returns.
    """
    s = e.slide
    show_state(e, e.t, e.y, e.shown)
    s.known = False
    if blend(e, e.shown) != OK:
        return STOPS
    away = False
    for j in range(s.k):
        away = away or s.margin[2 * j] < 0.0 or s.margin[2 * j + 1] < 0.0
    if slides < s.k or not away:
        return A_WAY
    for j in range(s.k):
        low = s.margin[2 * j]
        high = s.margin[2 * j + 1]
        if min(low, high) < 0.0:
            s.best[j] = BELOW if low <= high else ABOVE
    return A_WAY


def one_each(e: Engine) -> None:
    """Keep one surface of those that coincide: that whose machine moves something alone.

    It takes the others along, if nothing else is asked of any.
    """
    m = e.model
    s = e.slide
    kept = 0
    for i in range(s.met):
        surface = s.met_surface[i]
        s.twin[surface] = 0
        twin = -1
        for j in range(kept):
            if m.surface_twin[surface * m.surfaces + s.met_surface[j]] != 0:
                twin = j
        if twin < 0:
            s.met_surface[kept] = surface
            kept += 1
        elif acts(e, surface) and not acts(e, s.met_surface[twin]):
            s.met_surface[twin] = surface
        elif m.tells != 0 and not cross_as_one(m, surface, s.met_surface[twin]):
            if acts(e, surface):
                s.twin[surface] = 1 + s.met_surface[twin]
    s.met = kept


def acts(e: Engine, surface: int) -> bool:
    """Whether a machine's two states move the stored quantities differently."""
    m = e.model
    s = e.slide
    k = s.k
    s.k = 0
    different = False
    for side in range(2):
        for machine in range(m.machines):
            s.target[machine] = s.around[machine]
        s.target[m.surface_machine[surface]] = (
            m.surface_above[surface] if side == 1 else m.surface_below[surface]
        )
        follow(e, s.around, s.target)
        choose_own(e, s.target)
        if mode_of(e, s.target) != OK or not find_field(e, s.rates if side == 0 else s.rate):
            s.k = k
            return True
    for i in range(e.states):
        size = math.fabs(s.rates[i]) + math.fabs(s.rate[i])
        different = different or math.fabs(s.rates[i] - s.rate[i]) > MOVES_ALIKE * size
    s.k = k
    return different


def leave_agreeing(e: Engine) -> int:
    """Leave the surfaces around which all modes can keep the state, with one function."""
    s = e.slide
    while s.met > 0:
        if take_met(e, 0, s.met, False) != OK:
            return STOPS
        if do_meet(e):
            break
        kept = 0
        for i in range(s.met):
            if take_met(e, i, 1, False) != OK:
                return STOPS
            if do_meet(e):
                s.met_surface[kept] = s.met_surface[i]
                kept += 1
        s.met = kept if kept < s.met else 0
    if s.met == 0:
        return OK
    # where a switch itself makes a function jump, there is no surface to slide on
    show_state(e, e.t, e.y, e.shown)
    if find_agreeing(e) != OK:
        return STOPS
    kept = 0
    for i in range(s.met):
        if s.agrees[i] != 0:
            s.met_surface[kept] = s.met_surface[i]
            kept += 1
    s.met = kept
    return OK
