"""Values as they are read from outside, without a trace of the look in the run."""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit
from hybond.engine.engine import OK, Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.values import evaluate
from hybond.engine.words import Floats


def show_at(e: Engine, mode: Mode, t: float, y: Floats) -> bool:
    """Put all values of a motion into `e.checks.v`; False where some law has none."""
    clear_prior(e)
    keep_guess(e, mode)
    found = evaluate(e, mode, e.checks.v, t, y)
    put_guess_back(e, mode)
    return found == OK


def clear_prior(e: Engine) -> None:
    """Let what is a priori be zero: while time passes, a law that reads ``pre()`` gives nothing."""
    m = e.model
    for k in range(m.slots):
        e.checks.v[m.slots + k] = 0.0


def keep_guess(e: Engine, mode: Mode) -> None:
    """Keep where Newton begins next in a mode: that is not to depend on who looks."""
    c = e.checks
    c.guessed = mode.guessed
    if mode.dynamics > 0:
        fit(e.work.kept_guess, mode.finite_frees + 1)
        for k in range(mode.finite_frees):
            e.work.kept_guess.at[k] = mode.guess.at[k]


def put_guess_back(e: Engine, mode: Mode) -> None:
    """Let Newton begin where it would have begun."""
    if mode.dynamics > 0:
        for k in range(mode.finite_frees):
            mode.guess.at[k] = e.work.kept_guess.at[k]
        mode.guessed = e.checks.guessed
