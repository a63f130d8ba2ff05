"""Phases of the plant, foreseen by how fast they move: the angle of a flywheel that drives a cam.

What time alone does is known (`run/courses_ahead`), what the plant moves is not. It has a value and
a rate, and over a step it is taken to go on with a rate between none and twice that: a phase that
is the integral of a speed turns as the speed, and the speed goes on as it did of late.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import evaluate, field, set_motion

AHEAD: Final = 1e-8
"""Part of the time left over which a rate is measured at the start: digits enough of both."""


def see_plant(e: Engine, bound: float) -> None:
    """Note what the plant has here, and how fast it moves: from the last look, or by its rates."""
    m = e.model
    c = e.courses
    first = not c.plant_at > -math.inf
    if m.course_plants == 0 or e.t == c.plant_at:
        return
    refused = e.refusal
    evaluations = e.evaluations
    hold_guess(e, e.mode)
    for k in range(2 * m.slots):
        c.seen[k] = e.v[k]
    if evaluate(e, e.mode, c.seen, e.t, e.y) == OK:
        span = AHEAD * (bound - e.t) if first else e.t - c.plant_at
        for p in range(m.course_plants):
            here = c.seen[m.course_plant[p]]
            c.ranges.late[p] = 0.0 if first else (here - c.plant[p]) / span
            c.plant[p] = here
        c.plant_at = e.t
        if first and field(e, e.mode, e.t, e.y, c.rate) == OK:
            for k in range(e.states):
                c.state[k] = e.y[k] + span * c.rate[k]
            if evaluate(e, e.mode, c.seen, e.t + span, c.state) == OK:
                for p in range(m.course_plants):
                    c.ranges.late[p] = (c.seen[m.course_plant[p]] - c.plant[p]) / span
        for p in range(m.course_plants):
            if not math.isfinite(c.ranges.late[p]):
                c.ranges.late[p] = 0.0
    give_back_guess(e, e.mode)
    e.refusal = refused
    e.evaluations = evaluations


def hold_plant(e: Engine) -> None:
    """Keep what the motion has found last of what is foreseen."""
    for p in range(e.model.course_plants):
        e.courses.held[p] = e.v[e.model.course_plant[p]]


def give_back_plant(e: Engine) -> None:
    """Let the motion go on from what it has found, not from what was foreseen."""
    for p in range(e.model.course_plants):
        e.v[e.model.course_plant[p]] = e.courses.held[p]


def put_now(e: Engine) -> None:
    """Write what is there now: time, what is stored, signals, what the plant has."""
    set_motion(e, e.v, e.t, e.y)
    put_plant(e, e.t)


def put_plant(e: Engine, t: float) -> None:
    """Write what the plant has at a time, if it goes on as it did of late."""
    m = e.model
    c = e.courses
    for p in range(m.course_plants):
        e.v[m.course_plant[p]] = c.plant[p] + c.ranges.late[p] * (t - e.t)


def put_signals(e: Engine, now: float, t: float) -> None:
    """Write what courses read as it will be at `t`: time, what the plant has, integrated signals.

    These by their rates at the middle, of those that they read as well.
    """
    m = e.model
    half = now + 0.5 * (t - now)
    set_time(e, e.v, half)
    put_plant(e, half)
    for i in range(m.course_signals):
        put_signal(e, m.course_signal[i], half - now)
    for i in range(m.course_signals):
        put_signal(e, m.course_signal[m.course_signals - 1 - i], t - now)
    set_time(e, e.v, t)
    put_plant(e, t)


def put_signal(e: Engine, k: int, length: float) -> None:
    """Write what an integrated signal is after some time, by its rate at the values that hold."""
    m = e.model
    rate = value(m, m.integral_rate[k], e.v)
    e.v[m.signal_slot + k] = e.y[m.storages + k] + rate * length
