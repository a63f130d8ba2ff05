"""On which side of each kink a step of Radau IIA is, so that its slopes are those of that side.

A tank runs empty through a check valve: its level nears the place where the valve shuts, and never
comes there. A difference that is longer than the rest of the way has next to nothing but the slope
of the shut valve. Where that is steeper, each correction of the stages is next to nothing, however
much is left of their equations, and looks as if they had converged; where it is less steep they do
not. A step that goes through a kink ends there, and the next one begins behind it: the slopes of
the side on which a step begins are those of all of it.

A step that ended at a kink ends there but for rounding, and may still have the rates of the side
that it left, where those that its differences are taken to are of the side to which it goes. What
jumps between them is no slope. So slopes are made a moment later then, all of them on one side.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.one_instant import room_of_instant, show_motion
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import (
    ENOUGH,
    correct_stages,
    mean_size,
    rate_at,
    stage_rates,
)

NEARER: Final = 12
"""How often a difference is tried that stays on its side, to and fro by turns, ..."""
LESS: Final = 0.5
"""Part of a correction of the stages that the next one is at the most, if they converge."""
NEAR: Final = 1.0 / 16.0
"""... and by how much it is shorter after two."""


def see_sides(e: Engine, r: Radau) -> bool:
    """See on which side of each kink the step begins; False if there are none, or laws no values.

    What is passed within the instant at which it begins is behind. Those of what a law takes the
    root of are not asked: slopes are without bound there.
    """
    m = e.model
    s = e.step
    some = False
    for k in range(m.kinks):
        some = some or m.kink_rooted[k] == 0
    if not some or e.slide.k > 0:
        return False
    h = room_of_instant(e, r.t0)
    for i in range(r.n):
        r.stage[i] = r.y0[i] + h * r.f0[i]
    # behind the instant, or where a law has no value there, where it begins
    if not show_motion(e, r.t0, r.stage) and not show_motion(e, r.t0, r.y0):
        return False
    for k in range(m.kinks):
        s.kink_side[k] = 0.0
        if m.kink_rooted[k] == 0:
            s.kink_side[k] = value(m, m.atom_value[m.kink_atom + k], e.v)
    return True


def go_behind(e: Engine, r: Radau, rtol: float) -> bool:
    """Let slopes be made a moment later, if the step begins at a kink that is then behind.

    Where the moment later is has just been seen, in `r.stage`. Where laws have no values there, or
    what settles within the moment would be led farther than differences reach, they are made where
    the step begins; a signal that begins there has no size yet to tell. Tolerances there are in
    `r.other`.
    """
    m = e.model
    n = r.n
    for i in range(n):
        size = max(math.fabs(r.y0[i]), r.other[i] / rtol)
        moved = math.fabs(r.stage[i] - r.y0[i])
        begins = i >= e.model.storages and math.fabs(r.y0[i]) <= moved
        if moved > math.sqrt(EPSILON) * size and not begins:
            return False
    if not show_motion(e, r.t0, r.y0):
        return False
    at_kink = False
    for k in range(m.kinks):
        here = value(m, m.atom_value[m.kink_atom + k], e.v)
        there = e.step.kink_side[k]
        at_kink = at_kink or (here >= 0.0 and there < 0.0) or (here <= 0.0 and there > 0.0)
    if not at_kink or rate_at(e, n, r.t0, r.stage, r.end) != OK:
        return False
    closely = e.mode.closely and e.slide.k == 0
    for i in range(n):
        r.begin[i] = r.y0[i]
        r.begin_rate[i] = r.f0[i]
        r.begin_rest[i] = r.f0_rest[i]
        r.y0[i] = r.stage[i]
        r.f0[i] = r.end[i]
        r.f0_rest[i] = e.rate_rest[i] if closely else 0.0
    return True


def come_back(r: Radau) -> None:
    """Let the step begin where it does, once slopes are made a moment later."""
    for i in range(r.n):
        r.y0[i] = r.begin[i]
        r.f0[i] = r.begin_rate[i]
        r.f0_rest[i] = r.begin_rest[i]


def is_beyond(e: Engine, r: Radau) -> bool:
    """Whether the state that is shifted is beyond a kink; its rates have just been found."""
    m = e.model
    s = e.step
    if e.mode.dynamics == 0 and not show_motion(e, r.t0, r.shifted):
        return False
    for k in range(m.kinks):
        if s.kink_side[k] != 0.0:
            there = value(m, m.atom_value[m.kink_atom + k], e.v)
            if (there > 0.0 and s.kink_side[k] < 0.0) or (there < 0.0 and s.kink_side[k] > 0.0):
                return True
    return False


def stay_on_side(e: Engine, r: Radau, j: int) -> int:
    """Find the rates with a state shifted the other way, or less far, so that no kink is passed.

    Where each way leads over one, they are those of where it was shifted to.
    """
    far = r.shifted[j]
    way = r.y0[j] - far
    for k in range(NEARER):
        r.shifted[j] = r.y0[j] + way
        if r.shifted[j] != r.y0[j] and rate_at(e, r.n, r.t0, r.shifted, r.end) == OK:
            if not is_beyond(e, r):
                r.sided = True
                return OK
        way *= -NEAR if k % 2 == 0 else -1.0
    r.shifted[j] = far
    return rate_at(e, r.n, r.t0, r.shifted, r.end)


def go_on_converging(e: Engine, r: Radau, rtol: float) -> bool:
    """Whether one more correction of stages that were found is much less than the last.

    What jumps is no slope, however steep the difference is that was taken over it: each correction
    by that is next to nothing, and the next is as large.
    """
    before = r.size
    if stage_rates(e, r) != OK:
        return False
    correct_stages(r)
    r.size = mean_size(r.n, 3, r.last, r.tolerance)
    if r.size == math.inf:
        r.size = mean_size(r.n, 3, r.last, r.other)
    return r.size <= max(LESS * before, max(ENOUGH, 10.0 * EPSILON / rtol))


def leads_beyond(e: Engine, r: Radau) -> bool:
    """Whether the stages that were found end beyond a kink."""
    for i in range(r.n):
        r.shifted[i] = r.y[2 * r.n + i]
    m = e.model
    s = e.step
    if not show_motion(e, r.t1, r.shifted):
        return False
    for k in range(m.kinks):
        if s.kink_side[k] * value(m, m.atom_value[m.kink_atom + k], e.v) < 0.0:
            return True
    return False
