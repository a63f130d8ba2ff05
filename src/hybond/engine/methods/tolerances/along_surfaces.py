"""What rates cancel from along surfaces: those of the modes combined.

The mean of fast switching may move by next to nothing of what either mode would: by a part that is
rounding of these rates, and no step is short enough to make less of an error.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.tolerances.scale import SHORT, start_scale
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.blend import ROUNDING
from hybond.engine.surfaces.values import field


def begin_scale(e: Engine, mode: Mode) -> None:
    """Learn what rates cancel from where motion starts, in a mode or along surfaces."""
    if e.slide.k == 0:
        start_scale(e, mode)
    else:
        start_along_surfaces(e, mode)


def start_along_surfaces(e: Engine, mode: Mode) -> None:
    """Learn what the mean rates of stored quantities cancel from, where sliding starts.

    Beside what they cancel from in a mode: that is known from the one that was left.
    """
    s = e.slide
    refusal = e.refusal
    asked = e.evaluations
    hold_guess(e, mode)
    known = field(e, mode, e.t, e.y, e.step.rate) == OK
    for k in range(e.model.storages if known else 0):
        most = 0.0
        for part in range(s.parts):
            most = max(most, math.fabs(s.part_rate[part * e.states + k]))
        e.rate_noise[k] = max(e.rate_noise[k], ROUNDING * most)
        # an average is rounding up to there, but what it adds up to is less: signs of it change
        e.rounding[k] = max(e.rounding[k], SHORT * e.span * EPSILON * most)
    give_back_guess(e, mode)
    e.evaluations = asked
    e.refusal = refusal
