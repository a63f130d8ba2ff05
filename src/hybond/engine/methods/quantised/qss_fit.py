"""Rates along quantised states in a mode that is not linear: fitted, and confirmed.

The equations say all rates at once. They are asked at Gauss nodes along the quantised states, and
once more at the end of the step: this is also how sources that are functions of time are followed.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.methods.explicit.dopri import not_finite, spacing
from hybond.engine.methods.explicit.failed_steps import no_rate
from hybond.engine.methods.quantised.qss_nodes import node_at, through_nodes
from hybond.engine.methods.quantised.qss_room import Quantised, X, see_quantised, time_ahead
from hybond.engine.surfaces.values import field

FITTED: Final = 0.1
"""Part of a quantum that the error of a fit at the end of a step, if it lasted, may make."""
SAFE: Final = 0.9
SHORTER: Final = 0.1
LONGER: Final = 4.0
AHEAD: Final = 1e-6
"""Part of a time for which all states are moved along their rates."""
ATTEMPTS: Final = 4
LOOKED: Final = 0.01
"""Part of the run that is fitted at once at the most: where nothing moves no event says when a
source begins to, and a few nodes all over the run see no pulse."""


def rate_not_finite(e: Engine, h: float, rate_of_step: bool) -> int:
    """Refuse a step of size `h` on which the rates have no finite value, or the state has none."""
    if e.model.tells != 0 and not e.refusal:
        a = e.quantised
        return no_rate(e, a.states, h, a.rate if rate_of_step else e.step.y1, e.step.y1)
    return not_finite(e)


def fit_rates(e: Engine, a: Quantised, horizon: float) -> int:
    """Fit all rates over a time, or over what of it there are values for."""
    n = a.states
    s = e.step
    t = s.t0
    smallest = 4.0 * spacing(t)
    h = max(min(min(horizon, a.reach), LOOKED * e.span), smallest)
    while not asked_along(e, a, h):
        if h <= smallest:
            return rate_not_finite(e, h, True)
        h = max(SHORTER * h, smallest)
        a.reach = h
    for i in range(n):
        through_nodes(a.order, h, a.rates, i, n, a.placed)
        for k in range(a.order):
            a.x[X * i + k + 1] = a.placed[k] / (float(k) + 1.0)
    # a little further than the events foreseen, but not than a fit that failed
    a.until = t + max(h, min(1.5 * h, a.reach))
    i = a.moved
    if i >= 0 and a.moved_by != 0.0 and a.last_t == t:
        # a secant for nothing: the rate just before and just after the state's own jump
        a.diagonal[i] = (a.x[X * i + 1] - a.last[i]) / a.moved_by
    a.moved = -1
    return OK


def asked_along(e: Engine, a: Quantised, h: float) -> bool:
    """Ask for all rates at the nodes of a time; False if one is not finite."""
    n = a.states
    for node in range(a.order):
        s = node_at(a.order, node) * h
        see_quantised(a, s, a.y)
        found = field(e, e.mode, a.t + s, a.y, a.rate)
        if found != OK or not all_finite(n, a.rate):
            return False
        copy_part(n, a.rate, 0, a.rates, node * n)
    return True


def confirm_fit(e: Engine, a: Quantised, h: float) -> int:
    """Ask whether the fit is right at the end of a step; choose how long the next one may be.

    Afterwards ``a.stale`` says that the step is not to be made.
    """
    smallest = 4.0 * spacing(a.t)
    see_quantised(a, h, a.y)
    found = field(e, e.mode, a.t + h, a.y, a.rate)
    ratio = 0.0
    for i in range(a.states):
        fit = 0.0
        for k in range(a.order - 1, -1, -1):
            fit = fit * h + (float(k) + 1.0) * a.x[X * i + k + 1]
        off = math.fabs(a.rate[i] - fit) * h / (FITTED * a.quantum[i])
        if not off < math.inf:
            # its rate, or what was fitted to it, is beyond all numbers: this is the one to blame
            a.rate[i] = math.nan
            off = math.inf
        ratio = max(ratio, off)
    finite = found == OK and ratio < math.inf
    power = -1.0 / float(a.order + 1)
    if finite and (ratio <= 1.0 or h <= smallest):
        a.last_t = a.t + h
        copy_floats(a.states, a.rate, a.last)
        factor = SAFE * math.pow(max(ratio, 1e-10), power)
        reach = h * min(max(factor, SHORTER), LONGER)
        a.reach = max(a.reach, reach) if factor >= 1.0 else reach
        a.stale = False
        return OK
    if h <= smallest:
        return rate_not_finite(e, h, True)
    factor = SAFE * math.pow(ratio, power) if finite else 0.0
    a.reach = h * max(factor, SHORTER)
    a.stale = True
    return OK


def ask_ahead(e: Engine, a: Quantised) -> int:
    """Put the second derivative of all states into `rate`, their rates being those of the step."""
    s = e.step
    n = a.states
    h = AHEAD * time_ahead(a, s.t)
    for _ in range(ATTEMPTS):
        for i in range(n):
            a.y[i] = s.y[i] + h * s.f[i]
        found = field(e, e.mode, s.t + h, a.y, a.rate)
        if found == OK and all_finite(n, a.rate):
            for i in range(n):
                a.rate[i] = (a.rate[i] - s.f[i]) / h
            return OK
        h *= 1e-3
    return NOT_FINITE


def ask_aside(e: Engine, a: Quantised) -> None:
    """Estimate what each state does to its own rate, by a quantum of it."""
    s = e.step
    copy_floats(a.states, s.y, a.y)
    for i in range(a.states):
        a.y[i] = s.y[i] + a.quantum[i]
        moved = a.y[i] - s.y[i]
        a.diagonal[i] = 0.0
        if moved != 0.0 and field(e, e.mode, s.t, a.y, a.rate) == OK:
            slope = (a.rate[i] - s.f[i]) / moved
            a.diagonal[i] = slope if math.isfinite(slope) else 0.0
        a.y[i] = s.y[i]
