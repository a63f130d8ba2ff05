"""How far a step has strayed from the constraints of its mode, which its own error does not see.

A source ties a mass to what it reads: the mass then follows by the rate of that source. Where the
source turns within far less than a step, all stages may stand beside the turn. Its rate was nothing
at any of them, and the mass went on as it did, which all else followed. The constraint itself tells
what they have missed; what a law that jumps does to it is a kink, located elsewhere.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.jumps.jump import on_constraints
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats

ASTRAY: Final = 100.0
"""How many times its tolerance a state may be off its constraints: drift is some of them."""
SHORTEST: Final = 1e-9
"""Part of the run below which a step is no shorter for that: the rest is rounding."""


def strayed(e: Engine, t0: float, y0: Floats, t1: float, y1: Floats) -> float:
    """Return how far the end of a step is off the mode's constraints, 1 being what it may be."""
    s = e.step
    m = e.model
    if m.kinks > 0 or e.slide.k > 0 or not is_led_by_rates(e.mode):
        return 0.0
    if t1 - t0 < SHORTEST * e.span:
        return 0.0
    for k in range(e.states):
        s.tied[k] = y1[k]
    hold_guess(e, e.mode)
    found = evaluate(e, e.mode, e.shown, t1, s.tied)
    if found == OK:
        found = on_constraints(e, e.mode, e.shown, s.tied)
    give_back_guess(e, e.mode)
    tolerance(e, y0, y1, s.allowed)
    most = 0.0
    for k in range(m.storages if found == OK else 0):
        if s.allowed[k] > 0.0:
            most = max(most, math.fabs(s.tied[k] - y1[k]) / (ASTRAY * s.allowed[k]))
    return most if math.isfinite(most) else 0.0


def is_led_by_rates(mode: Mode) -> bool:
    """Whether a constraint of a mode is kept by a rate that is evaluated anew at each stage.

    That of a structure always is: what stands in it bends.
    """
    if mode.structures > 0:
        return True
    for c in range(mode.constraints.rows):
        if mode.constraint_hidden[c] >= 0:
            return True
    return False
