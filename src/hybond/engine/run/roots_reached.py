"""Roots on both sides of rest: what they bring to nothing in a finite time rests there.

An orifice lets a level difference run out by its root, whichever way it goes. The rate at rest is
zero, and beside it the slope is without bound: a step that passes rest is thrown back, and would go
to and fro as far as the error allows. So where such a step ends at the kink, what would not move at
rest is put there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.mode.values import field
from hybond.engine.run.held_by_kinks import compared
from hybond.engine.run.run_records import Run
from hybond.engine.words import Floats

STANDS: Final = 1e-3
"""Part of the speed beside rest below which nothing moves at rest: a root of rounding is small."""
SHORT: Final = 1e-3
"""Part of the way to rest over which a speed is seen."""
NOTHING: Final = 1e-6
"""Part of what was stored beside rest that is nothing there."""
PASSES: Final = 4
"""Times that the straight way to rest is gone."""


def rest_at_root(e: Engine, r: Run, kink: int) -> bool:
    """Put the end of a step that has passed the kink of a root on it, if the motion rests there."""
    m = e.model
    if kink < 0 or m.kink_root[kink] == 0:
        return False
    atom = m.atom_value[m.kink_atom + kink]
    refusal = e.refusal
    rests = goes_to_rest(e, r, atom)
    if rests:
        for i in range(e.states):
            e.step.y1[i] = r.after[i]
    r.locator.looked = math.nan
    e.refusal = refusal
    return rests


def goes_to_rest(e: Engine, r: Run, atom: int) -> bool:
    """Put the state at rest into `r.after`; whether the motion leads there and stays."""
    n = e.states
    t = e.step.t1
    for i in range(n):
        r.after[i] = e.step.y1[i]
    away = at_state(e, r, atom, r.after)
    if away == 0.0:
        return False
    if not math.isfinite(away) or field(e, e.mode, t, r.after, r.rate) != OK:
        return False
    beside = 0.0
    for _ in range(PASSES):
        left = at_state(e, r, atom, r.after)
        if left == 0.0:
            break
        speed = speed_of(e, r, atom, r.after, left)
        if beside == 0.0:
            beside = speed
        # the rates beyond rest lead back to it
        if not (speed * left < 0.0 and math.isfinite(speed)):
            return False
        h = -left / speed
        for i in range(n):
            r.after[i] += h * r.rate[i]
            if math.fabs(r.after[i]) <= NOTHING * math.fabs(e.step.y1[i]):
                r.after[i] = 0.0
    left = at_state(e, r, atom, r.after)
    if not math.fabs(left) <= NOTHING * math.fabs(away):
        return False
    if field(e, e.mode, t, r.after, r.rate) != OK:
        return False
    at_rest = speed_of(e, r, atom, r.after, left)
    return math.fabs(at_rest) <= STANDS * math.fabs(beside)


def speed_of(e: Engine, r: Run, atom: int, y: Floats, here: float) -> float:
    """Return how fast what is compared moves from a state by the rates in `r.rate`."""
    n = e.states
    most = 0.0
    for i in range(n):
        size = math.fabs(e.step.y1[i]) + math.fabs(e.step.y0[i])
        if r.rate[i] != 0.0 and size > 0.0:
            most = max(most, math.fabs(r.rate[i]) / size)
    if most == 0.0:
        return 0.0
    h = SHORT / most
    for i in range(n):
        r.locator.y[i] = y[i] + h * r.rate[i]
    return (compared(e, r.locator, atom, e.step.t1) - here) / h


def at_state(e: Engine, r: Run, atom: int, y: Floats) -> float:
    """Return what is compared at a state."""
    for i in range(e.states):
        r.locator.y[i] = y[i]
    return compared(e, r.locator, atom, e.step.t1)
