"""Where a switching function and its rate come to rest together.

Behind a filter the rate is the same on both sides of a surface, and pushed back from both: the
switch acts ever faster, with ever smaller swings. When these are next to nothing, the machine goes
on along the surface of the rate, on which its function stays at zero.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.mode.equations import mode_of
from hybond.engine.sliding.around import take_met
from hybond.engine.sliding.what_happened import is_held
from hybond.engine.surfaces.blend import find_speeds
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.common_space import find_common
from hybond.engine.surfaces.onto import side_value
from hybond.engine.surfaces.outputs import find_agreeing, show_state
from hybond.engine.surfaces.surface import put_read, surface_slope, surface_value
from hybond.engine.words import Floats

SWING: Final = 1e-8
"""A swing of a function below this part of what it is made of is over: guards hold a little beyond
their surface, by rounding, and below some 1e-9 that keeps swings up for ever."""
KEPT_UP: Final = 1e-5
"""So is one below this part that does not fade: beside large energies rounding is more."""
FADES: Final = 1e-3
"""It does if a swing begins at a speed that is less by this part than the one before."""


def counts(e: Engine, surface: int) -> bool:
    """Whether a surface may be met: one of a rate is, if it is slid on, in the other's place."""
    m = e.model
    if m.surface_rate_of[surface] >= 0:
        return is_held(e, surface)
    return not is_held_by_rate(e, surface)


def is_held_by_rate(e: Engine, surface: int) -> bool:
    """Whether the surface of a function's rate is slid on."""
    s = e.slide
    for j in range(s.many):
        if e.model.surface_rate_of[s.surface[j]] == surface:
            return True
    return False


def comes_to_rest(e: Engine, surface: int) -> int:
    """Return the surface of the rate of a function that was crossed, if it rests there, or its own.

    The mode and what is combined are those of the run again.
    """
    m = e.model
    s = e.slide
    rate = -1
    for other in range(m.surfaces):
        if m.surface_rate_of[other] == surface:
            rate = other
    if rate < 0:
        return surface
    for j in range(s.met):
        s.kept_met[j] = s.met_surface[j]
    kept = s.met
    s.met_surface[0] = rate
    rests = take_met(e, 0, 1, False) == OK and is_pushed_back(e, surface)
    for j in range(kept):
        s.met_surface[j] = s.kept_met[j]
    s.known = False
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return surface
    return rate if rests else surface


def is_pushed_back(e: Engine, surface: int) -> bool:
    """Whether the rate, taken in the modes around, is pushed back and swings by next to nothing."""
    s = e.slide
    if find_agreeing(e) != OK or s.agrees[0] == 0:
        return False
    find_common(e)
    show_state(e, e.t, e.y, s.v)
    if find_speeds(e, True) != OK:
        return False
    push = min(s.part_speed[0], -s.part_speed[1])
    if not push > 0.0:
        return False
    show_state(e, e.t, e.y, s.v)
    speed = side_value(e, 0, s.v)
    here = surface_value(e, surface, s.v)
    at = 2 * surface + (1 if speed > 0.0 else 0)
    change = math.fabs(speed - s.swing[at])
    s.swing[at] = speed
    small = SWING if change > FADES * math.fabs(speed) else KEPT_UP
    most = small * size_of(e, surface, s.v)
    # one that an input has taken over its surface is far from it, though its rate may be zero
    return speed * speed <= 2.0 * push * most and math.fabs(here) <= most


def size_of(e: Engine, surface: int, v: Floats) -> float:
    """Return what the terms of a function add up to."""
    m = e.model
    put_read(e, surface, v)
    total = 0.0
    for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
        slot = m.surface_index[i]
        kind = m.surface_kind[i]
        if kind == 0:
            slot += m.stored_slot
        elif kind == 1:
            slot += m.signal_slot
        elif kind == 4:
            slot += m.bond_slot
        if kind == 0 or kind == 1 or kind == 4:
            total += math.fabs(surface_slope(m, i, v) * v[slot])
    return total
