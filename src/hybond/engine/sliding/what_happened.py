"""What an event was, to who decides whether machines slide."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.instant.instant import MYTHICAL, Instant, is_struck
from hybond.engine.model import Model


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


def is_between(m: Model, surface: int, source: int, target: int) -> bool:
    """Whether a transition leads over a surface."""
    up = source == m.surface_below[surface] and target == m.surface_above[surface]
    down = source == m.surface_above[surface] and target == m.surface_below[surface]
    return up or down


def is_held(e: Engine, surface: int) -> bool:
    """Whether a surface is slid on."""
    for j in range(e.slide.many):
        if e.slide.surface[j] == surface:
            return True
    return False
