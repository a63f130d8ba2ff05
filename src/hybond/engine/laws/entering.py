"""Entering a mode, with or without laws of junctions."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.jumps.trial import try_mode
from hybond.engine.laws.laws import enter_with_laws
from hybond.engine.words import Floats, Ints


def enter(e: Engine, t: float, x: Floats, s: Floats, state: Ints, jump: bool, stay: bool) -> int:
    """Enter a mode from the state `x`; without `jump`, stay on it.

    Junction laws choose their branches; with `stay` they keep those of `state`, which were just
    chosen, unless an impulse or a violation asks for others.
    """
    if e.model.laws > 0:
        return enter_with_laws(e, t, x, s, state, jump, stay)
    return try_mode(e, t, x, s, state, jump)
