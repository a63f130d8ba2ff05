"""Whether a difference for the Jacobian of a step reaches over a kink of a law.

A tank runs empty through a check valve: its level nears the place where the valve shuts, and never
comes there. A difference that is longer than the rest of the way has next to nothing but the slope
of the shut valve, and stages that are led by that do not converge in any step.
"""

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.methods.one_instant import room_of_instant, show_motion
from hybond.engine.methods.radau_room import Radau

AT_KINK: Final = 64.0 * EPSILON
"""Part of a state by which it may be off a kink at which a step has ended."""


def see_kinks(e: Engine, r: Radau) -> bool:
    """See on which side of each kink a step begins; False if there are none, or laws no values."""
    m = e.model
    if m.kinks == 0 or e.slide.k > 0 or not show_motion(e, r.t0, r.y0):
        return False
    for k in range(m.kinks):
        e.step.kink[k] = value(m, m.atom_value[m.kink_atom + k], e.v)
    return True


def passes_kink(e: Engine, r: Radau, j: int) -> bool:
    """Whether a state is shifted over a kink at which it is not where the step begins.

    A step that has ended at a kink goes on beyond it, on whichever side rounding has left it.
    """
    m = e.model
    if not show_motion(e, r.t0, r.shifted):
        return False
    way = math.fabs(r.shifted[j] - r.y0[j])
    at = max(AT_KINK * math.fabs(r.y0[j]), room_of_instant(e, r.t0) * math.fabs(r.f0[j]))
    for k in range(m.kinks):
        here = math.fabs(e.step.kink[k])
        there = value(m, m.atom_value[m.kink_atom + k], e.v)
        passed = (there > 0.0 and e.step.kink[k] < 0.0) or (there < 0.0 and e.step.kink[k] > 0.0)
        if passed and way * here > at * (here + math.fabs(there)):
            return True
    return False
