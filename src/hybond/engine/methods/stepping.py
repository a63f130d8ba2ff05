"""One step of the method that the run was asked for, and what is between its ends."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.method_numbers import AUTO, EXACT, QSS1, RADAU, RK4
from hybond.engine.methods.control import (
    controlled_retry,
    controlled_start,
    controlled_step,
    is_propagated,
)
from hybond.engine.methods.explicit.failed_steps import step_too_small, worst_of
from hybond.engine.methods.explicit.fixed import fixed_retry, fixed_start, fixed_step
from hybond.engine.methods.implicit.from_edges import EXPLICIT, leaves_edge, may_turn, see_edges
from hybond.engine.methods.implicit.radau import begin_radau, radau_between
from hybond.engine.methods.implicit.radau_method import (
    radau_retry,
    radau_start,
    radau_step,
    radau_too_small,
)
from hybond.engine.methods.implicit.stiffness import turn
from hybond.engine.methods.quantised.qss import qss_retry, qss_step
from hybond.engine.methods.quantised.qss_start import qss_start
from hybond.engine.methods.tolerances.lately import follow_sizes
from hybond.engine.methods.tolerances.signal_sizes import follow_rates
from hybond.engine.words import Floats

FARTHER: Final = 2.0
"""Times as long as a step at the most that its polynomial is taken for."""


def no_shorter(e: Engine) -> int:
    """Refuse the last step, the error of which is too large, where there is no shorter one."""
    if e.model.tells == 0:
        return say_fault(e, "HB-N201", "step size underflow", "")
    if by_radau(e):
        return radau_too_small(e, e.radau)
    worst = worst_of(e.states, e.step.error, e.step.scale)
    return step_too_small(e, e.step.t1 - e.step.t0, worst)


def by_radau(e: Engine) -> bool:
    """Whether steps in the present mode are those of ``radau``."""
    if e.model.method == EXPLICIT:
        return e.step.implicit
    if e.model.method == AUTO or e.model.method == EXACT:
        return e.step.implicit and not e.exact.on
    return e.model.method == RADAU


def start_fitting(e: Engine, t: float, y: Floats, t_bound: float, jumped: bool) -> int:
    """Begin, or go on after an event, by the method that fits the mode and what was seen of it."""
    if by_radau(e) and not jumped:
        return radau_start(e, t, y, t_bound, False)
    found = controlled_start(e, t, y, t_bound, jumped)
    if found == OK and jumped and by_radau(e):
        begin_radau(e.radau, True)
    return found


def start(e: Engine, t: float, y: Floats, t_bound: float, jumped: bool) -> int:
    """Begin, or go on after an event, in the mode ``e.mode``."""
    if jumped:
        e.step.onset_end = -math.inf
    if jumped and e.model.begins > 0:
        e.step.left_edge = False
        e.step.calm = 0
        see_edges(e, t, y)
    if may_turn(e):
        return start_fitting(e, t, y, t_bound, jumped)
    if e.model.method == RADAU:
        return radau_start(e, t, y, t_bound, jumped)
    if e.model.method >= QSS1:
        return qss_start(e, t, y, t_bound, jumped)
    if e.model.method >= RK4:
        return fixed_start(e, t, y, jumped)
    return controlled_start(e, t, y, t_bound, jumped)


def step(e: Engine, t_end: float) -> int:
    """Make one step that satisfies the tolerance, not beyond `t_end`."""
    e.refusal = False
    e.curved = False
    e.step.precise = False
    follow_sizes(e)
    follow_rates(e)
    if may_turn(e) and not is_propagated(e):
        turn_in_time(e)
    if by_radau(e):
        return radau_step(e, t_end)
    if e.model.method >= QSS1:
        return qss_step(e, t_end)
    if e.model.method >= RK4:
        return fixed_step(e, t_end)
    h = e.step.h
    found = controlled_step(e, t_end)
    if found == OK or not may_be_beside_edge(e):
        return found
    e.refusal = False
    e.step.h = h
    turn(e)
    return radau_step(e, t_end)


def may_be_beside_edge(e: Engine) -> bool:
    """Whether a step that failed was explicit, and may have led beyond an edge, however short."""
    beside = e.model.edges > 0 and e.slide.k == 0 and may_turn(e)
    return beside and not e.step.implicit and not is_propagated(e)


def turn_in_time(e: Engine) -> None:
    """Go over to ``radau``, or back, if the last step says so, or if the next leaves an edge."""
    s = e.step
    if e.model.bends > 0.0:
        s.turns = not s.implicit
    elif e.model.begins > 0 and not s.implicit and leaves_edge(e, s.t, s.y, s.f, s.h):
        s.turns = True
    if s.turns:
        turn(e)


def retry(e: Engine, t_end: float) -> int:
    """Repeat the last step with the size that ends it at `t_end`; its error is ``e.step.off``."""
    e.refusal = False
    e.step.off = 0.0
    e.curved = False
    if by_radau(e):
        return radau_retry(e, t_end)
    if e.model.method >= QSS1:
        return qss_retry(e, t_end)
    if e.model.method >= RK4:
        return fixed_retry(e, t_end)
    return controlled_retry(e, t_end)


def reach(e: Engine, t: float) -> None:
    """Let the last step end at `t`, which is one instant with where it ends, and what is there.

    What is between its ends stays where it is in time: of what moves fast, a few last places of
    the time are more than rounding. A step that is next to no time itself says nothing of what is
    so many times as far: that way is straight.
    """
    s = e.step
    n = e.states
    if by_radau(e) and not e.curved:
        r = e.radau
        k = r.pieces - 1
        factor = stretched(r.piece_t0[k], r.piece_t1[k], t)
        stretch(n, factor, r.piece_polynomial, 4 * k * n)
        copy_part(n, s.y1, 0, r.piece_y1, k * n)
        if factor > FARTHER:
            for i in range(n):
                r.piece_polynomial[4 * k * n + i] = s.y1[i] - r.piece_y0[k * n + i]
        r.piece_t1[k] = t
    else:
        factor = stretched(s.t0, s.t1, t)
        stretch(n, factor, s.dense, 0)
        if factor > FARTHER:
            for i in range(n):
                s.dense[i] = s.y1[i] - s.y0[i]
    s.t1 = t


def go_straight(e: Engine, way: float, rate: Floats) -> None:
    """Let the last step be one that takes that time from where it began, at one rate."""
    s = e.step
    n = e.states
    s.t = s.t0  # rates are known where it begins, and are no others' where it ends
    s.t1 = s.t0 + way
    for i in range(n):
        s.y1[i] = s.y0[i] + way * rate[i]
    if by_radau(e) and not e.curved:
        r = e.radau
        r.pieces = 1
        r.piece_t0[0] = s.t0
        r.piece_t1[0] = s.t1
        copy_part(n, s.y0, 0, r.piece_y0, 0)
        copy_part(n, s.y1, 0, r.piece_y1, 0)
        for k in range(4 * n):
            r.piece_polynomial[k] = way * rate[k] if k < n else 0.0
        s.apart = 0.0
        s.defect = 0.0
        return
    for k in range(4 * n):
        s.dense[k] = way * rate[k] if k < n else 0.0


def stretched(t0: float, t1: float, t: float) -> float:
    """Return how many times as long a step is that ends at `t`; 1 if it takes no time."""
    return (t - t0) / (t1 - t0) if t1 > t0 else 1.0


def stretch(n: int, factor: float, dense: Floats, at: int) -> None:
    """Write coefficients of powers of the part of a step for one so many times as long.

    Only a few times: farther off they are rounding, and zero.
    """
    power = 1.0 if factor <= FARTHER else 0.0
    for row in range(4):
        power *= factor
        for i in range(n):
            dense[at + row * n + i] *= power


def between(e: Engine, t: float, y: Floats) -> None:
    """Put the state at a time within the last step into `y`, at its ends bit for bit."""
    s = e.step
    n = e.states
    if by_radau(e) and not e.curved:
        radau_between(e.radau, t, y)
        return
    if t == s.t0 or t == s.t1:
        for k in range(n):
            y[k] = s.y0[k] if t == s.t0 else s.y1[k]
        return
    x = (t - s.t0) / (s.t1 - s.t0)
    # one product after the other: a touch is decided by the last bits
    x2 = x * x
    x3 = x2 * x
    x4 = x3 * x
    for k in range(n):
        y[k] = s.y0[k] + (
            x * s.dense[k] + x2 * s.dense[n + k] + x3 * s.dense[2 * n + k] + x4 * s.dense[3 * n + k]
        )
