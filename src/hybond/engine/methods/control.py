"""Steps whose size the error controls: those of Dormand and Prince, and of what is propagated.

Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.4, and II, IV.2.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import NOT_FINITE, OK, Engine, say_fault
from hybond.engine.method_numbers import AUTO, EXACT
from hybond.engine.methods.explicit.dopri import (
    SMALLEST_ERROR,
    begin_step,
    dopri_accept,
    dopri_attempt,
    first_step,
    goes_elsewhere,
    not_finite,
    spacing,
)
from hybond.engine.methods.explicit.failed_steps import (
    no_rate,
    note_settling,
    step_too_small,
    worst_of,
)
from hybond.engine.methods.explicit.one_instant import is_one_kink
from hybond.engine.methods.implicit.hidden_peaks import hidden_at_end
from hybond.engine.methods.implicit.stiffness import watch_explicit
from hybond.engine.methods.linear.exact import (
    begin_exact,
    exact_accept,
    exact_attempt,
    first_exact,
)
from hybond.engine.methods.linear.flow import take_flow
from hybond.engine.methods.linear.flow_records import LARGE
from hybond.engine.methods.linear.graded import exchanges_fast
from hybond.engine.methods.linear.propagate import even_length
from hybond.engine.methods.scattered import scattered_at_end
from hybond.engine.methods.tolerances.beside_flat import narrow_beside_flat
from hybond.engine.methods.tolerances.noise_here import measure_here
from hybond.engine.methods.tolerances.onset import foresee_onset
from hybond.engine.methods.tolerances.scale import (
    CREEPS,
    controlled,
    measure_again,
    sum_closely_on,
    tolerance,
)
from hybond.engine.methods.tolerances.signal_sizes import ask_rates
from hybond.engine.methods.tolerances.strayed import strayed
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

BETA: Final = 0.04
EXPONENT: Final = 0.2 - 0.75 * 0.04
SAFETY: Final = 0.9
SHRINK: Final = 0.2
GROW: Final = 10.0
LEAST: Final = 1e-100
"""Part of the run that is next to no time, though near zero there are always shorter ones. What
begins at an edge of its law may grow from there, tenfold with each step, ..."""
TINY_ROW: Final = 1000
"""... but not so many times."""
PRECISE: Final = 1e-14
"""Part of what a step adds to a state up to which its error is next to nothing."""
LONGER: Final = 2.5
"""What a motion may last to what the last one in its mode has: its first step goes no further."""
OF_POWERS: Final = 12.0
"""How many times as far off as the estimate a step from a kink may be: one along t^1.5, as the
force of Hertz from a touch on, is 11.3 times. Its two formulas are nearly alike there."""
LEAST_POWER: Final = 5.0
MOST_POWER: Final = 13.0
"""How many times as far as at a fifth of the step it has gone at four fifths, from t^1.2 to t^1.8.
"""


def is_propagated(e: Engine) -> bool:
    """Whether the present mode is propagated exactly."""
    return (e.model.method == EXACT or e.model.method == AUTO) and e.exact.on


def controlled_start(e: Engine, t: float, y: Floats, t_bound: float, jumped: bool) -> int:
    """Begin, or go on after an event."""
    s = e.step
    n = e.states
    forget = jumped or not s.started
    if goes_elsewhere(e, t, y, forget):
        if field(e, e.mode, t, s.y, s.f) != OK:
            return NOT_FINITE
        if not all_finite(n, s.f):
            if e.model.tells != 0:
                return no_rate(e, n, 0.0, s.f, s.f)
            return say_fault(e, "HB-N202", "the derivative is not finite", "")
    tolerance(e, s.y, s.y, s.scale)
    s.controlled = controlled(n, s.scale)
    if forget:
        s.error_before = SMALLEST_ERROR
        s.began = t
        limit = min(e.model.max_step, t_bound - t) if t_bound > t else e.model.max_step
        choose_first(e, t, limit)
    return OK


def choose_first(e: Engine, t: float, limit: float) -> None:
    """Choose the method in the mode that begins, and the size of the first step."""
    s = e.step
    if e.model.method == EXACT or e.model.method == AUTO:
        e.exact.on = False
        if e.model.method == EXACT or e.states <= LARGE:
            take_flow(e)
        e.exact.on = e.exact.on and begin_exact(e)
        if e.exact.on:
            s.h = first_exact(e, limit)
            if e.exact.alongs > 0:
                # signals are integrated along: their rates may move faster than what is linear
                s.h = min(s.h, first_step(e, limit, 4.0))
            if e.straight and s.pace[e.mode.pace] > 0.0:
                s.h = min(s.h, s.pace[e.mode.pace])
            return
    if not e.mode.closely and e.slide.k == 0 and exchanges_fast(e, e.mode):
        # as `radau` does; rates begin anew with all their digits
        sum_closely_on(e, e.mode)
        if field(e, e.mode, t, s.y, s.rate) == OK:
            copy_floats(e.states, s.rate, s.f)
    if e.straight and s.pace[e.mode.pace] > 0.0:
        s.h = min(s.pace[e.mode.pace], limit)
    else:
        s.h = first_step(e, limit, 4.0)


def is_precise(e: Engine) -> bool:
    """Whether the last step has next to no error beside what it adds to each state.

    Beside the states themselves it would be rounding long before: of a ball that comes to rest it
    is the height of its last flights.
    """
    s = e.step
    for k in range(e.states):
        if not math.fabs(s.error[k]) <= PRECISE * math.fabs(s.y1[k] - s.y0[k]):
            return False
    return True


def keep_pace(e: Engine) -> None:
    """Remember the size that the next step would have, for the next motion in the mode.

    Where rates are sums of the state, error control sees all that a step passes over: the first of
    a motion need not be shorter than the others. What is propagated begins with long ones, and only
    what is a polynomial, whose steps may be of any length, is not to pass far beyond its end.
    """
    if e.straight and (e.step.precise or not is_propagated(e)):
        e.step.pace[e.mode.pace] = e.step.h


def end_pace(e: Engine, t: float) -> None:
    """Remember no longer steps than the motion was that a guard has ended at `t`."""
    s = e.step
    s.pace[e.mode.pace] = min(s.pace[e.mode.pace], LONGER * (t - s.began))


def attempt(e: Engine, t1: float) -> float:
    """Make a step to t1; return the norm of its error, nan if something is not finite."""
    if is_propagated(e):
        return exact_attempt(e, t1)
    error = dopri_attempt(e, t1)
    return OF_POWERS * error if goes_by_power(e) else error


def goes_by_power(e: Engine) -> bool:
    """Whether something goes by a power of the time in a step from a kink, like t^1.5.

    At four fifths of the step its rate has then gone eight times as far as at a fifth; what is
    smooth has gone four times as far.
    """
    s = e.step
    n = e.states
    if s.t0 != s.bent_at:
        return False
    for k in range(n):
        fifth = s.k[n + k] - s.k[k]
        more = s.k[3 * n + k] - s.k[k]
        least = more * fifth > LEAST_POWER * fifth * fifth
        if least and more * more < MOST_POWER * more * fifth:
            return True
    return False


def accept(e: Engine, t1: float) -> None:
    """Keep the step just made, with its dense output."""
    if is_propagated(e):
        exact_accept(e, t1)
    else:
        dopri_accept(e, t1)


def refuse_step(e: Engine, h: float) -> int:
    """Refuse a step of size `h` that is still too large."""
    s = e.step
    k = worst_of(e.states, s.error, s.scale)
    found = step_too_small(e, h, k)
    way = s.y1[k] - s.y0[k] if k >= 0 else 0.0
    if way != 0.0 and field(e, e.mode, s.t0 + h, s.y1, s.rate) == OK:
        note_settling(e, s.t0, (s.rate[k] - s.f0[k]) / way)
    return found


def controlled_step(e: Engine, t_end: float) -> int:
    """Make one step that satisfies the tolerance, not beyond `t_end`."""
    s = e.step
    remaining = t_end - s.t
    begin_step(e)
    measure_here(e, e.mode)
    narrow_beside_flat(e, s.t0, s.y0)
    s.h_asked = s.h
    s.error_asked = s.error_before
    smallest = 10.0 * spacing(s.t0)
    if s.tiny > TINY_ROW:
        smallest = max(smallest, LEAST * e.span)
    most = min(e.model.max_step, e.longest)
    h = max(min(s.h, most), smallest)
    may_land = remaining <= most * (1.0 + 1e-12)
    s.rejected = 0
    s.past_rim = False
    trial = h
    error = 0.0
    t1 = t_end
    while True:
        trial = h
        # a little longer rather than a sliver of a step afterwards
        lands = may_land and remaining <= 1.01 * h
        if not lands and is_propagated(e):
            h = even_length(e.exact.flow, h)
        t1 = t_end if lands else s.t0 + h
        t1 = min(t1, t_end)
        h = t1 - s.t0
        s.tried = h
        error = attempt(e, t1)
        if error <= 1.0 and not is_propagated(e):
            error = max(error, strayed(e, s.t0, s.y0, t1, s.y1))
            error = hidden_at_end(e, t1, error)
            error = scattered_at_end(e, t1, error)
        s.tried = 0.0
        if error <= 1.0 or (error == error and is_one_kink(e, s.t0, s.y0, t1, s.y1)):
            break
        s.rejected += 1
        if s.rejected == 1 and math.isfinite(error):
            ask_rates(e, s.t0, h, s.y0, s.f0)
        if s.rejected == 1 and math.isfinite(error) and h < CREEPS * e.span and e.slide.k == 0:
            measure_again(e, e.mode)
        short = h < CREEPS * e.span
        seen = short and foresee_onset(e, e.mode, s.t0, s.y0, s.f0)
        factor = SAFETY * math.pow(error, -EXPONENT) if math.isfinite(error) else SHRINK
        smaller = h * max(factor, SHRINK)
        if smaller < smallest and seen:
            smaller = smallest
        elif smaller < smallest:
            if e.model.tells != 0 and error == error:
                return refuse_step(e, h)
            if e.model.tells != 0 and not e.refusal:
                return no_rate(e, e.states, h, s.rate, s.y1)
            if error != error:
                return not_finite(e)
            return say_fault(e, "HB-N201", "step size underflow", "")
        h = smaller
    grown = SAFETY * math.pow(max(error, 1e-10), -EXPONENT) * math.pow(s.error_before, BETA)
    grown = min(max(grown, SHRINK), 1.0 if s.rejected > 0 else GROW)
    if h < 0.99 * trial:
        # cut short by t_end: its small error says little about the size after it
        s.h = max(trial, h * grown) if grown >= 1.0 else h * grown
    else:
        s.h = h * grown
        s.error_before = max(error, SMALLEST_ERROR)
    s.tiny = s.tiny + 1 if h < LEAST * e.span else 0
    s.precise = e.straight and is_precise(e)
    keep_pace(e)
    accept(e, t1)
    if e.model.method == AUTO and not e.exact.on and h >= 0.99 * trial:
        watch_explicit(e, h, grown)
    return OK


def controlled_retry(e: Engine, t_end: float) -> int:
    """Repeat the last step with the size that ends it at `t_end`."""
    s = e.step
    s.tried = t_end - s.t0
    error = attempt(e, t_end)
    if error > 1.0 and t_end - s.t0 < CREEPS * e.span:
        if foresee_onset(e, e.mode, s.t0, s.y0, s.f0):
            error = attempt(e, t_end)
    if error <= 1.0 and not is_propagated(e):
        error = hidden_at_end(e, t_end, error)
    s.tried = 0.0
    if error != error:
        if e.model.tells != 0 and not e.refusal:
            return no_rate(e, e.states, t_end - e.step.t0, e.step.rate, e.step.y1)
        return not_finite(e)
    accept(e, t_end)
    e.step.off = error
    return OK
