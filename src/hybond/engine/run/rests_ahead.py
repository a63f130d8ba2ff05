"""Steps that end where a root comes to rest, and not behind it.

What a root brings to nothing gets there in a finite time, and stays. A step that passes over that
instant may end within its tolerance all the same; within it, its polynomial swings to the other
side of rest and back, where the root of next to nothing is a flow that there never was: energy
that is lost between two points that are both right. How soon it rests is told by how its speed
falls on the way: that of a square root is twice what is left by the speed there is.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.stepping import by_radau
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.run.roots_reached import (
    STANDS,
    STILL,
    at_state,
    is_far_from_rest,
    is_moved_on,
    leads_to_rest,
    rest_of_guard,
    see_rests,
    speed_of,
    time_to_see,
)
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.values import field

LEAST_POWER: Final = 0.1
"""Of what is left, by which the speed falls: less is a jump; ..."""
MOST_POWER: Final = 0.9
"""... and what falls with all of it never gets there."""


def end_before_rest(e: Engine, r: Run, end: float) -> float:
    """Return where the next step ends at the latest: at `end`, or where a root comes to rest."""
    g = r.locator
    m = e.model
    # a law that has no value behind its root ends steps there by itself
    if m.kinks == 0 or m.edges > 0 or e.slide.k > 0:
        return end
    seen = False
    for k in range(g.guards):
        kink = rest_of_guard(e, g, k)
        if kink < 0:
            continue
        if not seen:
            see_rests(e, r)
            seen = True
        if is_far_from_rest(r, kink):
            continue
        refusal = e.refusal
        asked = e.evaluations
        hold_guess(e, e.mode)
        soon = time_to_rest(e, r, kink)
        give_back_guess(e, e.mode)
        g.looked = math.nan
        e.refusal = refusal
        e.evaluations = asked
        next_size = e.radau.next if by_radau(e) else e.step.h
        if soon > room_of_instant(e, e.t) and soon < next_size:
            end = min(end, e.t + soon)
    return end


def time_to_rest(e: Engine, r: Run, k: int) -> float:
    """Return how soon what is compared at kink k rests, infinity: not that is known."""
    atom = e.model.kink_rest[k]
    kink = e.model.atom_value[e.model.kink_atom + k]
    away = r.rest_here[k]
    if away == 0.0 or not math.isfinite(away):
        return math.inf
    if field(e, e.mode, e.t, e.y, r.rate) != OK:
        return math.inf
    beside = leads_to_rest(e, r, atom, away)
    if beside == 0.0:
        return math.inf
    seen = time_to_see(e, r)
    e.mode.guessed = False
    if field(e, e.mode, e.t, r.after, r.rate) != OK:
        return math.inf
    left = at_state(e, r, atom, r.after)
    most = (STANDS if atom == kink else STILL) * math.fabs(beside)
    if is_moved_on(e, r, atom, left, seen, most):
        return math.inf  # what follows a rest that moves lags behind it, and never gets there
    if not math.fabs(speed_of(e, r, atom, r.after, left)) <= most:
        return math.inf
    for i in range(e.states):
        r.after[i] = 0.5 * (e.y[i] + r.after[i])
    half = at_state(e, r, atom, r.after)
    if not half * away > 0.0 or field(e, e.mode, e.t, r.after, r.rate) != OK:
        return math.inf
    speed = speed_of(e, r, atom, r.after, half)
    if not speed * away < 0.0 or not math.fabs(half) < math.fabs(away):
        return math.inf
    power = math.log(beside / speed) / math.log(away / half)
    if not power > LEAST_POWER or not power < MOST_POWER:
        return math.inf
    return math.fabs(away / beside) / (1.0 - power)
