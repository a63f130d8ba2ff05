"""Fixed steps on a grid: forward Euler, and the classical Runge-Kutta method of order 4.

Steps go to the grid ``t + k step``, which is laid anew where a motion starts and computed by
multiplication, so that it does not drift. The last step before a `t_end` is shortened to it; the
one after goes to the next point of the grid. Source:
Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.1 and II.6.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.engine import NOT_FINITE, OK, Engine, say_fault
from hybond.engine.method_numbers import EULER, RK4
from hybond.engine.methods.explicit.dopri import begin_step, goes_elsewhere, not_finite
from hybond.engine.methods.tolerances.defects import defect_of_fixed
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

SLACK: Final = 1e-9
"""Part of a step within which a time counts as a point of the grid."""


def fixed_start(e: Engine, t: float, y: Floats, jumped: bool) -> int:
    """Begin, or go on after an event: the grid begins here."""
    s = e.step
    forget = jumped or not s.started
    if goes_elsewhere(e, t, y, forget):
        s.rated = False
    s.grid = t
    s.grid_next = 1.0
    return OK if s.rated else find_rate(e)


def find_rate(e: Engine) -> int:
    """Find the derivative where the next step starts."""
    s = e.step
    if field(e, e.mode, s.t, s.y, s.f) != OK or not all_finite(e.states, s.f):
        return not_finite(e)
    s.rated = True
    return OK


def fixed_step(e: Engine, t_end: float) -> int:
    """Make one step, to the next point of the grid or to `t_end`."""
    s = e.step
    h = e.model.step
    point = s.grid + s.grid_next * h
    t1 = t_end if t_end <= point + SLACK * h else point
    if t1 <= s.t:
        return say_fault(e, "HB-N201", "step size underflow", "")
    if not s.rated and find_rate(e) != OK:
        return NOT_FINITE
    begin_step(e)
    s.grid_asked = s.grid_next
    s.rejected = 0
    if advance_fixed(e, t1) != OK:
        return not_finite(e)
    if t1 >= point - SLACK * h:
        s.grid_next += 1.0
    return OK


def fixed_retry(e: Engine, t_end: float) -> int:
    """Repeat the last step, ending at `t_end`; the grid goes on behind it."""
    s = e.step
    h = e.model.step
    if advance_fixed(e, t_end) != OK:
        return not_finite(e)
    passed = t_end + SLACK * h
    while s.grid_next > 1.0 and s.grid + (s.grid_next - 1.0) * h > passed:
        s.grid_next -= 1.0
    while s.grid + s.grid_next * h <= passed:
        s.grid_next += 1.0
    return OK


def advance_fixed(e: Engine, t1: float) -> int:
    """Go on from the start of the step to t1, with dense output."""
    s = e.step
    n = e.states
    for k in range(4 * n):
        s.dense[k] = 0.0
    if e.model.method == EULER:
        for k in range(n):
            s.dense[k] = (t1 - s.t0) * s.f0[k]
            s.y1[k] = s.y0[k] + s.dense[k]
    elif stages(e, t1) != OK:
        return NOT_FINITE
    if not all_finite(n, s.y1):
        return NOT_FINITE
    s.t1 = t1
    s.t = t1
    copy_floats(n, s.y1, s.y)
    # the derivative at the end of a step of Euler is that of the next one, if there is one
    s.rated = e.model.method == RK4
    defect_of_fixed(e, t1 - s.t0, s.rated)
    return OK


def stages(e: Engine, t1: float) -> int:
    """Make the stages of the classical method; a cubic through both ends and their derivatives."""
    s = e.step
    n = e.states
    h = t1 - s.t0
    middle = s.t0 + 0.5 * h
    copy_floats(n, s.f0, s.rate)
    copy_floats(n, s.f0, s.k)
    for stage in range(1, 4):
        part = h if stage == 3 else 0.5 * h
        for k in range(n):
            s.trial[k] = s.y0[k] + part * s.rate[k]
        if field(e, e.mode, t1 if stage == 3 else middle, s.trial, s.rate) != OK:
            return NOT_FINITE
        copy_part(n, s.rate, 0, s.k, stage * n)
    for k in range(n):
        total = s.f0[k] + 2.0 * (s.k[n + k] + s.k[2 * n + k]) + s.k[3 * n + k]
        s.error[k] = h / 6.0 * total
        s.y1[k] = s.y0[k] + s.error[k]
    if field(e, e.mode, t1, s.y1, s.f) != OK or not all_finite(n, s.f):
        return NOT_FINITE
    for k in range(n):
        a = h * s.f0[k]
        b = h * s.f[k]
        change = s.error[k]
        s.dense[k] = a
        s.dense[n + k] = 3.0 * change - 2.0 * a - b
        s.dense[2 * n + k] = a + b - 2.0 * change
    return OK
