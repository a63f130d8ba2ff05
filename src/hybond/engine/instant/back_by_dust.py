"""Machines that cross a switching surface and are led back by next to nothing, without an end.

A coil has been led to a reference that is all but zero; a diode takes so little current for none,
and blocks as the switch opens. Without that current the switch closes, and with it opens. What is
stored is not moved by that, so time could not advance; but whether it slides along the surface is
for the motion there to say.
"""

from __future__ import annotations

from hybond.engine.algebra.products import copy_places
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.instant.instant import Instant
from hybond.engine.instant.settling import Settling
from hybond.engine.instant.small_jumps import is_between, vanishes
from hybond.engine.method_numbers import MOREAU
from hybond.engine.model import Model


def may_slide(m: Model) -> bool:
    """Whether there are surfaces to slide on, and laws that may block what leads along them."""
    return m.laws > 0 and m.surfaces > 0 and m.slides != 0 and m.method != MOREAU


def note_dust(e: Engine, g: Settling, many: int) -> None:
    """Note what fires now, if it is the first at this instant, else the jump that leads on from it.

    Machines have fired `many` times before at this instant, each time in another mode.
    """
    m = e.model
    if many == 0:
        g.some_dust = False
        g.only_dust = not e.trial.jumps
        copy_places(m.machines, g.target, 0, g.first_target, 0)
    elif e.trial.jumps and g.only_dust:
        for k in range(m.storages):
            g.moved[k] = e.trial.x[k] - g.x[k]
        g.only_dust = vanishes(e, g.moved, g.x)
        g.some_dust = True


def is_back_by_dust(e: Engine, g: Settling, many: int) -> bool:
    """Whether what fires now is what fired first, in the same state, and only dust lies between."""
    m = e.model
    if many == 0 or e.trial.jumps or not (g.only_dust and g.some_dust):
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
