"""Machines that cross a switching surface and are led back by next to nothing, without an end.

A coil has been led to a reference that is all but zero; a diode takes so little current for none,
and blocks as the switch opens. Without that current the switch closes, and with it opens. What is
stored is not moved by that, so time could not advance; but whether it slides along the surface is
for the motion there to say.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_places
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.instant.instant import Instant
from hybond.engine.instant.settling import Settling
from hybond.engine.method_numbers import MOREAU
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


def is_back_by_dust(e: Engine, g: Settling, many: int) -> bool:
    """Whether what fires now has led back here by jumps that are next to nothing.

    It has fired `many` times before at this instant, each time in another mode.
    """
    m = e.model
    if m.laws == 0 or m.surfaces == 0 or m.slides == 0 or m.method == MOREAU:
        return False
    if many == 0:
        g.some_dust = False
        g.by_dust = not e.trial.jumps
        copy_places(m.machines, g.target, 0, g.first_target, 0)
        return False
    if e.trial.jumps and g.by_dust:
        for k in range(m.storages):
            g.moved[k] = e.trial.x[k] - g.x[k]
        g.by_dust = vanishes(e, g.moved, g.x)
        g.some_dust = True
    if not (g.by_dust and g.some_dust) or e.trial.jumps:
        return False
    for k in range(m.machines):
        if e.trial.state[k] != g.state[k] or g.target[k] != g.first_target[k]:
            return False
    for k in range(m.storages):
        if e.trial.x[k] != g.x[k]:
            return False
    for k in range(m.integrals):
        if e.trial.s[k] != g.s[k]:
            return False
    return crosses_with_others(m, g)


def crosses_with_others(m: Model, g: Settling) -> bool:
    """Whether machines that fire all cross surfaces, or follow what does."""
    some = False
    for k in range(m.machines):
        if g.target[k] == g.state[k] or m.is_law[k] != 0:
            continue
        crosses = False
        for surface in range(m.surfaces):
            own = m.surface_machine[surface] == k
            crosses = crosses or (own and is_between(m, surface, g.state[k], g.target[k]))
        if not crosses and (m.followers == 0 or m.machine_follows[k] == 0):
            return False
        some = some or crosses
    return some


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


def refuse_turns(e: Engine, i: Instant) -> int:
    """Refuse modes that follow each other without an end, where no machine slides that crossed."""
    m = e.model
    if not i.by_dust:
        return OK
    for j in range(e.slide.many):
        for f in range(i.fired):
            if i.machine.at[f] == m.surface_machine[e.slide.surface[j]]:
                return OK
    return say_fault(e, "HB-N401", "time cannot advance: modes follow without end", "")
