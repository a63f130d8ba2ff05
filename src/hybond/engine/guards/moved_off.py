"""Whether a motion that begins at a kink moves off it at once, by its own rates.

The polynomial of a step that reaches over another kink is moved by what is behind that from its
beginning on: a tank that stays empty until water comes over a weir seems to fill and to fall below
its bottom long before. What rates make of the state is zero until then.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import atom_here, look_at_state, terms_here
from hybond.engine.guards.locator import Locator
from hybond.engine.methods.tolerances.onset import pass_part
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess

STEPS: Final = 2
"""Of Runge and Kutta's method, in which what pushes something that moves something else does so."""


def moves_off(e: Engine, g: Locator, k: int, soon: float) -> bool:
    """Whether what kink k compares leaves zero within `soon`, or rates do not tell."""
    if e.slide.k > 0 or g.tied or not soon > 0.0:
        return True
    s = e.step
    a = g.atom_first[k]
    refusal = e.refusal
    failed = g.failed
    hold_guess(e, e.mode)
    copy_floats(e.states, s.y0, s.passed)
    h = soon / float(STEPS)
    known = True
    for i in range(STEPS):
        known = known and pass_part(e, e.mode, s.t0 + float(i) * h, h)
    moves = True
    if known:
        look_at_state(e, g, s.t0 + soon, s.passed)
        here = atom_here(e, g, a)
        moves = math.fabs(here) > ROUNDING * terms_here(e, g, k, a)
        moves = moves or g.failed
    give_back_guess(e, e.mode)
    e.refusal = refusal
    g.failed = failed
    g.looked = math.nan
    return moves
