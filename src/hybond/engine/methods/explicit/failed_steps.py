"""Steps that cannot be made, with the state that is to blame."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine, say_fault
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.reasons.facts import add_fact
from hybond.engine.words import Floats

SETTLES: Final = 0.01
"""Part of its motion that is over from one number of the time to the next where that is too soon:
a step is ten of these at least, and is to be a part of the motion."""


def no_rate(e: Engine, n: int, h: float, rate: Floats, y: Floats) -> int:
    """Refuse a step of size `h` whose rates, or the state that they lead to, are not finite."""
    found = say_fault(e, "HB-N202", "the derivative is not finite", "")
    bad = first_not_finite(n, rate)
    add_fact(e.fault, h)
    add_fact(e.fault, float(bad if bad >= 0 else first_not_finite(n, y)))
    return found


def first_not_finite(n: int, values: Floats) -> int:
    """Return the place of the first number that is infinite or none, or -1."""
    for k in range(n):
        if not math.isfinite(values[k]):
            return k
    return -1


def worst_of(n: int, error: Floats, scale: Floats) -> int:
    """Return the state that dominates an error, or -1."""
    worst = -1
    most = 0.0
    for k in range(n):
        size = math.fabs(error[k])
        share = size / scale[k] if scale[k] > 0.0 else math.inf if size > 0.0 else 0.0
        if share > most:
            most = share
            worst = k
    return worst


def step_too_small(e: Engine, h: float, worst: int) -> int:
    """Refuse a step of size `h` that is still too large, with the state that is to blame, or -1."""
    found = say_fault(e, "HB-N201", "step size underflow", "")
    add_fact(e.fault, h)
    add_fact(e.fault, float(worst))
    return found


def note_settling(e: Engine, t: float, rate: float) -> None:
    """Note how soon what dominates the error settles, if it is over before time is another number.

    `rate` is the slope of its own rate. Called after `step_too_small`.
    """
    if -rate * spacing(t) >= SETTLES:
        add_fact(e.fault, -1.0 / rate)
