"""The noise of rates where a step begins, where it was measured elsewhere and a law bends.

A law that is flat at rest passes on what differences are rounded to by a slope without bound there,
and by an ordinary one as soon as something flows. What was measured at rest, or as the motion went
through it, would be a tolerance that hides all errors of the steps behind. So it is measured anew
where a step begins whose last tolerance came of it, for explicit steps and implicit ones.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import Engine
from hybond.engine.methods.tolerances.scale import measure_anew
from hybond.engine.mode.mode_records import Mode


def measure_here(e: Engine, mode: Mode) -> None:
    """Measure the noise where a step begins, if it mattered and was measured elsewhere.

    Where there is nothing to measure, what is known stays: rates that are zero say nothing.
    """
    s = e.step
    matters = e.noise_matters
    e.noise_matters = False
    if not matters or mode.dynamics == 0 or e.slide.k > 0 or s.t == e.noise_at:
        return
    m = e.model
    e.noise_at = s.t
    rounding = e.work.reach
    noise = s.allowed
    copy_floats(m.storages, e.rounding, rounding)
    copy_floats(m.storages, e.rate_noise, noise)
    for k in range(m.storages):
        e.rate_noise[k] = 0.0
    measure_anew(e, mode)
    for k in range(m.storages):
        known = e.rate_noise[k] > 0.0 and math.isfinite(e.rate_noise[k])
        if not known or not e.rounding[k] > 0.0 or not math.isfinite(e.rounding[k]):
            e.rounding[k] = rounding[k]
            e.rate_noise[k] = max(noise[k], e.rate_noise[k] if known else 0.0)
