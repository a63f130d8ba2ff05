"""A motion that begins on a kink: its rates are those of the side to which it goes.

Where a law jumps at what is zero just now, as ``if x >= 0 then 1 else -1`` does as a body starts
from zero to the left, the number that it has there is not what it has a moment later. An explicit
step reads its rates first of all where it begins: it would go a part of the way by a law of the
other side, as far as the control of its error lets it. So what jumps there is read a moment later.
Where that would lead back, nobody gets off the kink, and rates are as they were.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.method_numbers import QSS1
from hybond.engine.methods.control import is_propagated
from hybond.engine.methods.explicit.one_instant import room_of_instant, show_motion
from hybond.engine.methods.stepping import by_radau
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import field

SOONEST: Final = 1.0 / 1024.0
"""Part of an instant that a moment is, or else four times as long, until a side is clear."""
LONGER: Final = 4.0
JUMPS: Final = 4.0
"""How many times as far apart rates are as they move in three such moments; of what only moves it
is a third."""


def lead_off_kinks(e: Engine) -> None:
    """Let rates that jump where a step begins be what they are a moment later, in ``e.step.f``."""
    m = e.model
    s = e.step
    explicit = m.method < QSS1 and not by_radau(e) and not is_propagated(e)
    if m.kinks == 0 or e.slide.k > 0 or not explicit:
        return
    refusal = e.refusal
    hold_guess(e, e.mode)
    if show_motion(e, s.t, s.y) and note_kinks(e):
        room = room_of_instant(e, s.t)
        h = SOONEST * room
        while h < room and not goes_off(e, h):
            h *= LONGER
        if h < room:
            take_rates_behind(e, h)
    give_back_guess(e, e.mode)
    e.refusal = refusal


def note_kinks(e: Engine) -> bool:
    """Note which kinks the step begins on; whether there is any."""
    m = e.model
    some = False
    for k in range(m.kinks):
        here = math.fabs(value(m, m.atom_value[m.kink_atom + k], e.v))
        size = math.fabs(value(m, m.atom_size[m.kink_atom + k], e.v))
        on = here <= ROUNDING * size and m.kink_rooted[k] == 0 and m.kink_meets[k] == 0
        e.step.kink_side[k] = 1.0 if on else 0.0
        some = some or on
    return some


def goes_off(e: Engine, h: float) -> bool:
    """Whether the rates lead off a kink within `h`; then its side is in `kink`, else zero."""
    m = e.model
    s = e.step
    for i in range(e.states):
        s.trial[i] = s.y[i] + h * s.f[i]
    if not show_motion(e, s.t + h, s.trial):
        return False
    off = False
    for k in range(m.kinks):
        s.kink[k] = 0.0
        if s.kink_side[k] != 0.0:
            there = value(m, m.atom_value[m.kink_atom + k], e.v)
            size = math.fabs(value(m, m.atom_size[m.kink_atom + k], e.v))
            if math.fabs(there) > ROUNDING * size:
                s.kink[k] = there
                off = True
    return off


def take_rates_behind(e: Engine, h: float) -> None:
    """Take rates that jump from `h` behind the kink, if these lead to the same side."""
    m = e.model
    s = e.step
    n = e.states
    if field(e, e.mode, s.t + h, s.trial, s.k) != OK:
        return
    for i in range(n):
        s.rate[i] = s.k[i]
        s.trial[i] = s.y[i] + LONGER * h * s.rate[i]
    if field(e, e.mode, s.t + LONGER * h, s.trial, s.k) != OK:
        return
    jumps = False
    for i in range(n):
        if math.fabs(s.rate[i] - s.f[i]) <= JUMPS * math.fabs(s.k[i] - s.rate[i]):
            s.rate[i] = s.f[i]
        jumps = jumps or s.rate[i] != s.f[i]
    if not jumps or not show_motion(e, s.t + LONGER * h, s.trial):
        return
    for k in range(m.kinks):
        if s.kink[k] * value(m, m.atom_value[m.kink_atom + k], e.v) < 0.0:
            return
    for i in range(n):
        s.f[i] = s.rate[i]
