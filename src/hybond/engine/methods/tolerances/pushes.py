"""The energy that what pushes would give in a moment: what rounding is measured by at rest.

Bodies at rest have no energy to measure rounding by, though great forces may hold them there. What
storages give to each other is no push: it is counted where it is stored, and as much of it comes
back. Nor is more given than what is stored takes in that moment: a capacitor behind a nano-ohm is
at the voltage of its source long before, and no further, while a current through it would be that
of a short circuit. So is one behind an amplifier that is led its voltage back.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.tolerances.moment_later import come_back, look_later
from hybond.engine.mode.digits.clusters import (
    MOMENT,
    SLOW,
    find_settling,
    open_cluster,
    settle_by_one,
)
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import own_stiffness
from hybond.engine.surfaces.values import field


def forget_pushes(e: Engine) -> None:
    """Know of no push."""
    for k in range(e.model.storages):
        e.push_alone[k] = 0.0


def see_pushes(e: Engine, mode: Mode) -> None:
    """Learn the energy that what pushes would give in a moment, each as if it were alone.

    That of each part is then in `e.work.part_here`.
    """
    m = e.model
    most = e.work.part_here
    for p in range(e.parts):
        most[p] = 0.0
    find_settling(e, mode, e.v)
    for k in range(m.storages):
        if mode.settles_with[k] == k:
            see_cluster(e, mode, k)
        elif mode.settles_with[k] == SLOW:
            see_push(e, k, alone_there(e, mode, k))
    for p in range(e.parts):
        e.pushed_energy[p] = max(e.pushed_energy[p], most[p])


def alone_there(e: Engine, mode: Mode, k: int) -> float:
    """Return what one storage has been given after the moment, no others having changed.

    Laws and sources that read what it stores may bring it back: rows of the mode do not tell, its
    rate with all of that there does. Asked only where it would be more than has been seen.
    """
    push = e.push_alone[k]
    seen = e.part_energy[e.storage_part[k]]
    if mode.finite_frees == 0 or e.slide.k > 0 or mode.constraints.rows > 0:
        return push
    if not energy_of_push(e, k, push) > seen:
        return push
    refusal = e.refusal
    asked = e.evaluations
    back = 0.0
    look_later(e, mode)
    if field(e, mode, e.t, e.y, e.step.rate) == OK:
        here = e.step.rate[k]
        copy_floats(e.states, e.y, e.step.trial)
        e.step.trial[k] += push
        if field(e, mode, e.t, e.step.trial, e.step.rate) == OK:
            back = MOMENT * e.span * (here - e.step.rate[k]) / push
    come_back(e, mode)
    e.evaluations = asked
    e.refusal = refusal
    return push / (1.0 + back) if back > 0.0 else push


def see_push(e: Engine, k: int, stored: float) -> None:
    """Learn of what one storage is given, which keeps it for longer."""
    energy = energy_of_push(e, k, stored)
    p = e.storage_part[k]
    if math.isfinite(energy):
        e.work.part_here[p] = max(e.work.part_here[p], energy)


def energy_of_push(e: Engine, k: int, stored: float) -> float:
    """Return the energy of so much in storage k."""
    return 0.5 * math.fabs(own_stiffness(e.model, k, e.v)) * stored * stored


def see_cluster(e: Engine, mode: Mode, first: int) -> None:
    """Learn of what is given to storages that settle together within the moment."""
    c = e.work.cluster
    known = open_cluster(e, mode, c, first, e.v)
    for j in range(c.many):
        k = c.member.at[j]
        if e.push_alone[k] == 0.0:
            continue
        if not known or not settle_by_one(c, j):
            see_push(e, k, e.push_alone[k])
            continue
        for i in range(c.many):
            stored = c.solved.at[i] * e.push_alone[k] / (MOMENT * e.span)
            see_push(e, c.member.at[i], stored)
