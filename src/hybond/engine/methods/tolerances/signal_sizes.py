"""What integrated signals are measured by: their own size, and the rounding of their rates.

A signal has no energy, and nothing beside it says how large it is. It is measured by what it has
been; where it has not begun, by what its rate makes of it in the rounding of time, which no pulse
is narrower than. A rate that is a difference is as right as its terms: where these are found, and
for as long as they matter, they are found again at each step, since they may be gone by the next.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import evaluate_pair
from hybond.engine.expressions.pairs import clear
from hybond.engine.methods.tolerances.moment_later import come_back, look_later
from hybond.engine.mode.digits.sizes import measure
from hybond.engine.mode.mode_records import Mode, is_constrained
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.values import field, set_state
from hybond.engine.words import Floats

UNITS: Final = 10.0 * EPSILON
"""Part of its terms that a rate may be off by."""
MATTERS: Final = 0.01
"""Part of the tolerance of a rate below which its rounding is none of a step's matter."""
SOON: Final = 0.01
"""Part of a step after which terms that are nothing where it begins are seen."""
FAINT: Final = 1e-150
"""A signal is measured against no less, in SI, as what is stored is."""


SHORTER: Final = 32
"""Quarters of a time that is too long for what moves."""
FARTHER: Final = 4.0
"""Times its size, and what it moves by, that other rates there may move a state by."""


def forget_rounding(e: Engine) -> None:
    """Know nothing of the rounding of these rates."""
    for k in range(e.model.integrals):
        e.rate_rounding[k] = 0.0


def measure_rates(e: Engine, mode: Mode, t: float) -> None:
    """Learn from rates of integrated signals at `t`, where bond variables have been solved for."""
    m = e.model
    stack = e.work.stack
    for k in range(m.integrals):
        pair = m.rule_first[m.machines] + k
        stack.now = e.v
        stack.was = e.v
        stack.was_first = 0
        stack.jump = e.trial.jump
        stack.jumps = False
        stack.terms = e.work.terms
        stack.prior_terms = e.work.terms
        clear(stack)
        measure(e, mode, pair, e.work.xi, e.v, e.work.terms)
        for i in range(m.read_first[pair], m.read_first[pair + 1]):
            j = m.read_slot[i] - m.stored_slot
            if j >= 0 and j < m.storages:
                # what is stored is known no better than its own rate is: from rest that is rounding
                terms = e.work.terms
                terms[m.read_slot[i]] = max(terms[m.read_slot[i]], e.rounding[j] / UNITS)
        evaluate_pair(m, pair, stack)
        if stack.refused != 0:
            continue
        rate = math.fabs(stack.finite[stack.top])
        size = stack.size[stack.top]
        # of functions of differences the signals say nothing, and of signals the functions
        own = value(m, m.integral_size[k], e.v)
        if math.isfinite(own):
            size = max(size, own)
        if not math.isfinite(size) or not math.isfinite(rate):
            continue
        e.least_signal[k] = max(e.least_signal[k], EPSILON * math.fabs(t) * rate)
        if is_constrained(mode) and rate <= UNITS * size:
            # constraints hold what it would measure: stages are off them by the error of the step
            e.rate_rounding[k] = max(e.rate_rounding[k], m.rtol * size)
        if UNITS * size > MATTERS * m.rtol * rate:
            e.rate_rounding[k] = max(e.rate_rounding[k], UNITS * size)


def measure_rates_at(e: Engine, mode: Mode, t: float, y: Floats) -> None:
    """Learn from rates of integrated signals in a state."""
    set_state(e, mode, e.v, t, y)
    if solve(e, mode, e.v) == OK:
        measure_rates(e, mode, t)


def begin_signals(e: Engine, mode: Mode, soon: float) -> None:
    """Learn how large signals will be from their rates a moment after motion starts."""
    if e.model.integrals == 0 or e.slide.k > 0:
        return
    look_later(e, mode)
    refusal = e.refusal
    asked = e.evaluations
    if field(e, mode, e.t, e.y, e.step.rate) == OK:
        lead_on(e, soon)
        for _ in range(SHORTER):
            if goes_so_far(e, mode, soon):
                break
            soon *= 0.25
            lead_on(e, soon)
        measure_rates_at(e, mode, e.t + soon, e.step.trial)
    e.evaluations = asked
    e.refusal = refusal
    come_back(e, mode)


def lead_on(e: Engine, h: float) -> None:
    """Put the state there that the rates of the start lead to in a time."""
    for k in range(e.states):
        e.step.trial[k] = e.y[k] + h * e.step.rate[k]


def goes_so_far(e: Engine, mode: Mode, h: float) -> bool:
    """Whether rates of the start lead where a motion gets in a time, and not far beyond.

    What comes to rest long before is no longer moved by what is left of its rate; of a bent rate
    such a state would make any number. What has not begun is moved by what others come to.
    """
    x = e.step.allowed
    if field(e, mode, e.t + h, e.y, x) != OK:
        return True
    for k in range(e.states):
        e.step.k[k] = x[k]
    if field(e, mode, e.t + h, e.step.trial, x) != OK:
        return False
    for k in range(e.states):
        moved = math.fabs(h * e.step.rate[k])
        size = math.fabs(e.y[k]) + moved
        if moved > 0.0 and h * math.fabs(x[k] - e.step.k[k]) > FARTHER * size:
            return False
    return True


def follow_rates(e: Engine) -> None:
    """Find the terms of rates again where a step begins, if they mattered to the last one."""
    matters = False
    for k in range(e.model.integrals):
        matters = matters or e.rate_rounding[k] > 0.0
    if not matters or e.slide.k > 0:
        return
    refusal = e.refusal
    forget_rounding(e)
    hold_guess(e, e.mode)
    measure_rates_at(e, e.mode, e.step.t, e.step.y)
    give_back_guess(e, e.mode)
    e.refusal = refusal


def ask_rates(e: Engine, t: float, h: float, y: Floats, rate: Floats) -> None:
    """Find the terms of rates where a step of size `h` begins that was too long, and in it.

    From rest they are nothing yet. How large a rate is at its end in the state as it is says what
    there will be of a signal that has not begun.
    """
    if e.model.integrals == 0 or e.slide.k > 0:
        return
    x = e.step.allowed
    refusal = e.refusal
    forget_rounding(e)
    hold_guess(e, e.mode)
    measure_rates_at(e, e.mode, t + h, y)
    forget_rounding(e)
    measure_rates_at(e, e.mode, t, y)
    for k in range(e.states):
        x[k] = y[k] + SOON * h * rate[k]
    measure_rates_at(e, e.mode, t + SOON * h, x)
    give_back_guess(e, e.mode)
    e.refusal = refusal


def allowed_signal(e: Engine, k: int, added: float, size: float) -> float:
    """Return the error that a step may make of state `k`, a signal that has a size.

    A step adds no less than rounding leaves of it: of the time, by which its rate changes, and of
    the terms of its rate. It has the size at least that it would have if this step were as long as
    what the end of the run is rounded to: what begins as a power of time begins there.
    """
    i = k - e.model.storages
    rtol = e.model.rtol
    h = e.step.tried
    size = max(max(size, added), max(e.least_signal[i], FAINT))
    if not h > 0.0:
        return rtol * size
    size = max(size, added * (EPSILON * e.span / h))
    return rtol * size + rounded(e, i, h, added)


def rounded(e: Engine, i: int, h: float, added: float) -> float:
    """Return what rounding leaves of signal `i` in a step of size `h` that adds so much to it."""
    return e.rate_rounding[i] * h + EPSILON * math.fabs(e.step.t0) / h * added


def allow_rounding(e: Engine, h: float, y0: Floats, y1: Floats, out: Floats) -> None:
    """Let stages of a step of size `h` be found no better than rounding lets them."""
    for i in range(e.model.integrals):
        k = e.model.storages + i
        out[k] = max(out[k], rounded(e, i, h, math.fabs(y1[k] - y0[k])))


def allow_begun(e: Engine, h: float, y0: Floats, rate: Floats, out: Floats) -> None:
    """Likewise before there are stages; they say how large a signal is that has not begun."""
    for i in range(e.model.integrals):
        k = e.model.storages + i
        least = rounded(e, i, h, h * math.fabs(rate[k]))
        out[k] = max(out[k], least) if y0[k] != 0.0 else 0.0
