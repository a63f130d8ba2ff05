"""The energy that what pushes would give in a moment: what rounding is measured by at rest.

Bodies at rest have no energy to measure rounding by, though great forces may hold them there. What
storages give to each other is no push: it is counted where it is stored, and as much of it comes
back. Nor is more given than what is stored takes in that moment: a capacitor behind a nano-ohm is
at the voltage of its source long before, and no further, while a current through it would be that
of a short circuit.
"""

from __future__ import annotations

import math

from hybond.engine.engine import Engine
from hybond.engine.mode.digits.clusters import (
    MOMENT,
    SLOW,
    find_settling,
    open_cluster,
    settle_by_one,
)
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import own_stiffness


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
            see_push(e, k)
    for p in range(e.parts):
        e.pushed_energy[p] = max(e.pushed_energy[p], most[p])


def see_push(e: Engine, k: int) -> None:
    """Learn of what one storage is given, which keeps it for longer."""
    add_energy(e, k, e.push_alone[k])


def add_energy(e: Engine, k: int, stored: float) -> None:
    """Learn the energy of so much in storage k."""
    p = e.storage_part[k]
    energy = 0.5 * math.fabs(own_stiffness(e.model, k, e.v)) * stored * stored
    if math.isfinite(energy):
        e.work.part_here[p] = max(e.work.part_here[p], energy)


def see_cluster(e: Engine, mode: Mode, first: int) -> None:
    """Learn of what is given to storages that settle together within the moment."""
    c = e.work.cluster
    known = open_cluster(e, mode, c, first, e.v)
    for j in range(c.many):
        k = c.member.at[j]
        if e.push_alone[k] == 0.0:
            continue
        if not known or not settle_by_one(c, j):
            see_push(e, k)
            continue
        for i in range(c.many):
            stored = c.solved.at[i] * e.push_alone[k] / (MOMENT * e.span)
            add_energy(e, c.member.at[i], stored)
