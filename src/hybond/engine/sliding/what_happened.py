"""What an event was, to who decides whether machines slide."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.instant.instant import MYTHICAL, Instant, is_struck


def has_moved(i: Instant) -> bool:
    """Whether what is stored jumped."""
    for k in range(i.steps):
        if i.kind.at[k] != MYTHICAL and is_struck(i, k):
            return True
    return False


def fired_once(i: Instant, machine: int) -> int:
    """Return the number of the only transition that a machine made, -1 if it is not one."""
    found = -1
    for f in range(i.fired if i.steps > 0 else 0):
        if i.machine.at[f] == machine:
            if found >= 0:
                return -1
            found = f
    return found


def is_held(e: Engine, surface: int) -> bool:
    """Whether a surface is slid on."""
    for j in range(e.slide.many):
        if e.slide.surface[j] == surface:
            return True
    return False
