"""Values as they are read from outside, without a trace of the look in the run."""

from __future__ import annotations

from hybond.engine.engine import OK, Engine
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats


def show_at(e: Engine, mode: Mode, t: float, y: Floats) -> bool:
    """Put all values of a motion into `e.checks.v`; False where some law has none."""
    clear_prior(e)
    # where Newton begins next is not to depend on who looks
    hold_guess(e, mode)
    found = evaluate(e, mode, e.checks.v, t, y)
    give_back_guess(e, mode)
    return found == OK


def clear_prior(e: Engine) -> None:
    """Let what is a priori be zero, and what laws read of it at its limit: time passes."""
    m = e.model
    for k in range(m.slots):
        e.checks.v[m.slots + k] = 0.0
    put_limits(e, e.mode, e.checks.v)
