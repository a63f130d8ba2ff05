"""Where Newton's method begins, kept while another time is looked at.

What is found a moment later is the better beginning for what comes after it, but not for now: where
nothing moves yet, it would leave its rounding in values that are zero.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode


def hold_guess(e: Engine, mode: Mode) -> None:
    """Keep what Newton begins from in a mode, until `give_back_guess`; one mode at a time."""
    e.work.had_guess = mode.guessed
    fit(e.work.kept_guess, mode.finite_frees + 1)
    for k in range(mode.finite_frees if mode.dynamics > 0 else 0):
        e.work.kept_guess.at[k] = mode.guess.at[k]


def give_back_guess(e: Engine, mode: Mode) -> None:
    """Let Newton begin from what was kept."""
    for k in range(mode.finite_frees if mode.dynamics > 0 else 0):
        mode.guess.at[k] = e.work.kept_guess.at[k]
    mode.guessed = e.work.had_guess
