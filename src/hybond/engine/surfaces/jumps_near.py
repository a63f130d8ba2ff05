"""Where a surface that is slid on just jumps: on which side of it one is, is rounding."""

from __future__ import annotations

import math

from hybond.engine.algebra.rounding import AT_KINK
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats


def note_jumps(e: Engine, t: float, y: Floats) -> bool:
    """Note where surfaces just jump, into ``jump_near``; whether any does."""
    m = e.model
    s = e.slide
    may = False
    for j in range(s.k):
        may = may or m.surface_jump_first[s.side[j]] < m.surface_jump_first[s.side[j] + 1]
    if not may or evaluate(e, e.mode, e.shown, t, y) != OK:
        return False
    some = False
    for j in range(s.k):
        for p in range(m.surface_jump_first[s.side[j]], m.surface_jump_first[s.side[j] + 1]):
            atom = m.kink_atom + m.surface_jump[p]
            s.jump_at[p] = value(m, m.atom_value[atom], e.shown)
            size = math.fabs(value(m, m.atom_size[atom], e.shown))
            s.jump_near[p] = 1 if math.fabs(s.jump_at[p]) <= AT_KINK * size else 0
            some = some or s.jump_near[p] != 0
    return some


def none_has_jumped(e: Engine) -> bool:
    """Whether all that was noted is on its other side at the values shown."""
    m = e.model
    s = e.slide
    for j in range(s.k):
        for p in range(m.surface_jump_first[s.side[j]], m.surface_jump_first[s.side[j] + 1]):
            there = value(m, m.atom_value[m.kink_atom + m.surface_jump[p]], e.shown)
            other = s.jump_at[p] * there < 0.0 or (s.jump_at[p] == 0.0 and there != 0.0)
            if s.jump_near[p] != 0 and not other:
                return False
    return True
