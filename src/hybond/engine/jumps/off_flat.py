"""Slopes beside a place at which laws of storage have none, as ``q^3`` has at zero.

A source drives what is stored off such a place, however small a resistance the mode leaves out. How
far is not known from there: as far as the law alone would have to go to give what is missing.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.constraints.constraints import constraint_by_co_energy
from hybond.engine.constraints.impulse_ways import slope_of
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.rows.storage import co_energy_of, own_stiffness, with_stored
from hybond.engine.words import Floats

DOUBLED: Final = 200
"""Times that a distance is doubled, or halved."""
FAR: Final = 2.0 ** (DOUBLED - 1)
"""As far as that."""


def off_flat(e: Engine, mode: Mode, v: Floats, ways: Ways) -> bool:
    """Put the slopes of the residuals beside the place in `e.work.here` into `ways.slope`.

    False if no law of storage is flat there. What is missing is in ``e.work.gap``.
    """
    m = e.model
    w = e.work
    values = with_stored(e, w.here)
    fit(w.by_stored, m.storages)
    found = False
    for k in range(m.storages):
        w.beside[k] = w.here[k]
        if m.co_energy[k] >= 0 and own_stiffness(m, k, values) == 0.0:
            asked = asked_of(e, mode, k)
            if asked != 0.0:
                far = distance(e, k, asked)
                w.beside[k] += far
                found = found or w.beside[k] != w.here[k]
    if found:
        slope_of(e, mode, v, w.beside, ways)
    return found


def asked_of(e: Engine, mode: Mode, k: int) -> float:
    """Return by how much a storage's effort or flow would have to be another, if it alone were."""
    w = e.work
    asked = 0.0
    for i in range(w.constraints):
        constraint_by_co_energy(e, mode, i, 2 * e.model.bonds)
        factor = w.by_stored.at[k]
        if factor != 0.0 and math.fabs(w.gap.at[i]) > math.fabs(asked * factor):
            asked = -w.gap.at[i] / factor
    return asked


def distance(e: Engine, k: int, asked: float) -> float:
    """Return how far what is stored goes until its law gives nearly that; 1 if it never does."""
    way = 1.0 if asked > 0.0 else -1.0
    for side in range(2):
        # a law that falls goes the other way
        way = way if side == 0 else -way
        far = way
        reached = change_at(e, k, far) / asked
        for _ in range(DOUBLED if reached < 1.0 else 0):
            far *= 2.0
            reached = change_at(e, k, far) / asked
            if not reached < 1.0:
                break
        for _ in range(DOUBLED if not reached < 1.0 else 0):
            far *= 0.5
            reached = change_at(e, k, far) / asked
            if reached < 1.0:
                break
        if reached > 0.0 and reached < 1.0 and math.fabs(far) < FAR:
            return far
    return 1.0


def change_at(e: Engine, k: int, far: float) -> float:
    """Return what a storage's effort or flow changes by with so much more stored."""
    m = e.model
    values = e.work.values
    at = m.stored_slot + k
    kept = values[at]
    here = co_energy_of(m, k, values)
    values[at] = kept + far
    there = co_energy_of(m, k, values)
    values[at] = kept
    return there - here
