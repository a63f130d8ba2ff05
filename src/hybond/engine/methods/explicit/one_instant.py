"""How long an instant lasts, and steps that are no longer than one."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.model import Model
from hybond.engine.surfaces.averages import show_part, solve_here
from hybond.engine.surfaces.values import set_motion
from hybond.engine.words import Floats

LEAST: Final = 8.0
"""Units in the last place that an instant lasts at least."""
FAR: Final = 2.0
"""How many times as far as rates at both ends lead a step may go, ..."""
OFF: Final = 1e-3
"""... and by which part of what is stored farther: a rate that is nothing at both ends tells no
way."""
ALL_TOGETHER: Final = -1
"""The motion as it is, not one of the modes that are combined."""
LAST: Final = 2.0
"""Units in the last place that time may be short of a kink, and still be there."""


def room_of_instant(e: Engine, t: float) -> float:
    """Return how long an instant lasts: `event_tol` of the run, eight last places at least."""
    now = math.fabs(t)
    return max(e.model.event_tol * max(e.span, now), LEAST * spacing(now))


def is_one_kink(e: Engine, t0: float, y0: Floats, t1: float, y1: Floats) -> bool:
    """Whether a step tried is within one instant, at which a kink is passed.

    What has never moved has no size: no step over the kink that makes it move is short enough. A
    step that goes where its rates do not lead has passed none: what seems to be beyond a kink there
    is what an explicit step makes of a motion that is faster than the step.
    """
    if e.model.kinks == 0 or t1 - t0 > room_of_instant(e, t0):
        return False
    passed = False
    for part in range(e.slide.parts if e.slide.k > 0 else 1):
        passed = passed or passes_one(e, part, t0, y0, t1, y1)
    show_in_mode(e, ALL_TOGETHER)
    return passed


def passes_one(e: Engine, part: int, t0: float, y0: Floats, t1: float, y1: Floats) -> bool:
    """Whether a step that is no longer than an instant passes a kink: one of a mode combined."""
    m = e.model
    s = e.step
    if not show_motion(e, t0, y0):
        return False
    for k in range(m.storages):
        s.kink_rate[k] = shown_rate(e, k)
    show_in_mode(e, part)
    for k in range(m.kinks):
        s.kink[k] = value(m, m.atom_value[m.kink_atom + k], e.v)
    if not show_motion(e, t1, y1) or not is_led(e, t1 - t0, y0, y1):
        return False
    show_in_mode(e, part)
    passed = False
    for k in range(m.kinks):
        there = value(m, m.atom_value[m.kink_atom + k], e.v)
        way = math.fabs(s.kink[k] - there)
        # a run may end at the kink itself, but for rounding of the time
        reached = math.fabs(there) * (t1 - t0) <= LAST * spacing(t1) * way
        passed = passed or (s.kink[k] != there and (s.kink[k] * there <= 0.0 or reached))
    return passed


def jump_lies_between(e: Engine, t: float, one: Floats, other: Floats) -> bool:
    """Whether two states are on both sides of a kink that is no root: a law may jump there."""
    m = e.model
    s = e.step
    refusal = e.refusal
    hold_guess(e, e.mode)
    known = m.kinks > 0 and e.slide.k == 0 and show_motion(e, t, one)
    for k in range(m.kinks if known else 0):
        s.kink[k] = value(m, m.atom_value[m.kink_atom + k], e.v)
    known = known and show_motion(e, t, other)
    found = False
    for k in range(m.kinks if known else 0):
        there = value(m, m.atom_value[m.kink_atom + k], e.v)
        found = found or (not is_root(m, k) and s.kink[k] * there < 0.0)
    give_back_guess(e, e.mode)
    e.refusal = refusal
    return found


def is_root(m: Model, kink: int) -> bool:
    """Whether a kink is that of a root, which has one value from both sides, however steep."""
    return m.kink_meets[kink] != 0 or m.kink_rooted[kink] != 0


def is_led(e: Engine, h: float, y0: Floats, y1: Floats) -> bool:
    """Whether a step of size `h` leads no farther than its rates at both ends do, which are shown.

    Between them rates may be others, but within an instant not for long: twice as far at the most.
    What neither is nor moves where it begins is led by the kink alone.
    """
    for k in range(e.model.storages):
        if y0[k] == 0.0 and e.step.kink_rate[k] == 0.0:
            continue
        one = FAR * h * e.step.kink_rate[k]
        other = FAR * h * shown_rate(e, k)
        way = y1[k] - y0[k]
        beyond = max(way - max(max(one, other), 0.0), min(min(one, other), 0.0) - way)
        if not beyond <= OFF * max(math.fabs(y0[k]), math.fabs(y1[k])):
            return False
    return True


def shown_rate(e: Engine, k: int) -> float:
    """Return the rate of storage `k` in the motion that is shown."""
    m = e.model
    at = rate_bond(m, k)
    return way_of_rate(m, k) * e.v[m.bond_slot + at]


def show_motion(e: Engine, t: float, y: Floats) -> bool:
    """Put all values of the motion into `e.v`; False if a law has none."""
    if e.slide.k > 0:
        show_part(e, ALL_TOGETHER, e.v)
    set_motion(e, e.v, t, y)
    return solve_here(e, e.mode, e.v) == OK


def show_in_mode(e: Engine, part: int) -> None:
    """Put the values there that the motion has in one of the modes combined, if it slides."""
    if e.slide.k > 0:
        show_part(e, part, e.v)
