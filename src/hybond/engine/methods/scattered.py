"""Explicit steps whose stages scatter about their motion: whether they are as right as they say.

The error of a step is known from two formulas that see the same stages. It is the error where the
step is short beside all that turns in its rates, so that each order adds less than the one before.
The oil behind a valve that just begins to open hardly moves in a step beside what is stored there,
so that steps may be as long as it takes to let go: then stages are far from the motion that comes
of them, and the two formulas may agree by chance. So where stages scatter the motion itself is put
back into the rates: what it stores beyond what they bring is energy from nowhere, or lost, and may
be no more than what the tolerance lets states be off by.

Source: W. H. Enright, "A new error-control for initial value solvers", Appl. Math. Comput. 31,
1989 (the defect of the interpolant; here in joules).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.dopri import STAGE_AT, weigh
from hybond.engine.methods.tolerances.defects import end_levels
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import field
from hybond.engine.words import float_table

DOUBTED: Final = 0.25
"""Error of a step, 1 being what it may be, from which on several times that were too much."""
SCATTERS: Final = 0.05
"""Part of how far the rates of a step are apart by which stages are off its motion, ..."""
WEIGHTY: Final = 10.0
"""... and times the energy that it may be off by: where less, the step is short enough."""
BRIEF: Final = 1e-9
"""Part of the run below which a step is no shorter for that: the rest is rounding."""
PLACES: Final = 3
GAUSS_PLACE: Final = float_table(0.1127016653792583, 0.5, 0.8872983346207417)
GAUSS_WEIGHT: Final = float_table(5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0)


def scattered_at_end(e: Engine, t1: float, error: float) -> float:
    """Return the error of an explicit step that is tried, larger if it makes or loses energy."""
    s = e.step
    m = e.model
    h = t1 - s.t0
    if error < DOUBTED or error > 1.0 or m.storages == 0 or e.straight or e.curved:
        return error
    if e.slide.k > 0 or h < BRIEF * e.span:
        return error
    for row in range(4):
        weigh(e.states, 7, h, 7 * (8 + row), s, s.motion, row * e.states)
    end_levels(e)
    may = allowed_energy(e)
    if not may > 0.0 or not scatters(e, h, may):
        return error
    refusal = e.refusal
    hold_guess(e, e.mode)
    off = math.fabs(left_open(e, h))
    give_back_guess(e, e.mode)
    e.refusal = refusal
    return max(error, off / may) if off < math.inf else error


def allowed_energy(e: Engine) -> float:
    """Return what a step may be off by, J: each state by its tolerance, at its level."""
    s = e.step
    m = e.model
    total = 0.0
    for k in range(m.storages):
        if m.storage_pseudo[k] == 0 and s.scale[k] < math.inf:
            share = s.scale[k] * max(math.fabs(s.level0[k]), math.fabs(s.level1[k]))
            total += share * share
    return math.sqrt(float(s.controlled) * total)


def slope_at(e: Engine, k: int, x: float) -> float:
    """Return by how much the motion of the step moves a state there, in units of the step."""
    n = e.states
    w = e.step.motion
    bent = 3.0 * w[2 * n + k] + x * 4.0 * w[3 * n + k]
    return w[k] + x * (2.0 * w[n + k] + x * bent)


def scatters(e: Engine, h: float, may: float) -> bool:
    """Whether stages are off the motion of the step by more than is next to nothing."""
    s = e.step
    m = e.model
    n = e.states
    most = 0.0
    apart = 0.0
    for k in range(m.storages):
        if m.storage_pseudo[k] != 0:
            continue
        level = h * max(math.fabs(s.level0[k]), math.fabs(s.level1[k]))
        low = s.k[k]
        high = low
        for stage in range(2, 7):
            rate = s.k[stage * n + k]
            low = min(low, rate)
            high = max(high, rate)
            if stage < 5:
                off = math.fabs(rate - slope_at(e, k, STAGE_AT[stage]) / h)
                most = max(most, level * off)
        apart = max(apart, level * (high - low))
    return most > WEIGHTY * may and most > SCATTERS * apart


def left_open(e: Engine, h: float) -> float:
    """Return what the motion of a step stores less than rates bring along it, J.

    Infinite if that is not known. A kink on the way is no excuse: behind it the step is no longer.
    """
    s = e.step
    m = e.model
    n = e.states
    w = s.motion
    total = 0.0
    for i in range(PLACES):
        x = GAUSS_PLACE[i]
        for k in range(n):
            bent = w[n + k] + x * (w[2 * n + k] + x * w[3 * n + k])
            s.peak_y[k] = s.y0[k] + x * (w[k] + x * bent)
        if field(e, e.mode, s.t0 + x * h, s.peak_y, s.peak_rate) != OK:
            return math.inf
        if not all_finite(n, s.peak_rate):
            return math.inf
        for k in range(m.storages):
            if m.storage_pseudo[k] == 0:
                level = s.level0[k] + x * (s.level1[k] - s.level0[k])
                off = h * s.peak_rate[k] - slope_at(e, k, x)
                total += GAUSS_WEIGHT[i] * level * off
    return total
