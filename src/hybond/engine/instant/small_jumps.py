"""Jumps that are next to nothing, and transitions that lead over a surface and back."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.instant.instant import Instant
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.model import Model
from hybond.engine.words import Floats

VANISHED: Final = 1e-9
"""A jump below this part of what may be stored has vanished."""


def vanishes(e: Engine, moved: Floats, y: Floats) -> bool:
    """Whether a jump of what is stored is next to nothing."""
    m = e.model
    reach_of(e, e.mode, y, e.work.reach)
    for k in range(m.storages):
        if not math.fabs(moved[k]) <= VANISHED * (math.fabs(y[k]) + e.work.reach[k]):
            return False
    return True


def is_between(m: Model, surface: int, source: int, target: int) -> bool:
    """Whether a transition leads over a surface."""
    up = source == m.surface_below[surface] and target == m.surface_above[surface]
    down = source == m.surface_above[surface] and target == m.surface_below[surface]
    return up or down


def went_and_came(i: Instant, machine: int) -> bool:
    """Whether a machine made a transition and its reverse, and no other."""
    many = 0
    first = -1
    back = False
    for f in range(i.fired):
        if i.machine.at[f] != machine:
            continue
        many += 1
        if many == 1:
            first = f
        else:
            back = i.source.at[f] == i.target.at[first] and i.target.at[f] == i.source.at[first]
    return many == 2 and back
