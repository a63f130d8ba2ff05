"""What rounding of great forces that balance does to what they move, and to what that moves.

A press at rest is held between two chambers of oil, whose pressures are rounding of the bulk
modulus. Its speed is what that leaves, and its way what the speed leaves: no step is short enough
to follow these, and neither has a size of its own.

Only steps that are solved for are let off so: explicit ones are no longer than what swings, and
see how little of it there is.
"""

from __future__ import annotations

import math

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import own_stiffness
from hybond.engine.mode.rows.storage_bonds import rate_bond


def forget_shakes(e: Engine) -> None:
    """Know of nothing that rounding drives off."""
    for k in range(e.model.storages):
        e.rate_shakes[k] = 0.0
        e.shakes_for[k] = 0.0


def find_shakes(e: Engine, mode: Mode) -> None:
    """Learn how fast rounding of the rates of others drives those of stored quantities off."""
    m = e.model
    for k in range(m.storages):
        at = rate_bond(m, k)
        e.rate_shakes[k] = max(e.rate_shakes[k], shakes_of(e, mode, at, k))
        e.shakes_for[k] = max(e.shakes_for[k], shakes_last(e, mode, at, k))


def shakes_of(e: Engine, mode: Mode, b: int, but: int) -> float:
    """Return how fast rounding drives a bond variable off, that of the rate of `but` left out."""
    m = e.model
    rows = mode.finite
    total = 0.0
    for p in range(rows.first.at[mode.same[b]], rows.first.at[mode.same[b] + 1]):
        j = rows.column.at[p]
        if j < m.storages and j != but and e.rate_noise[j] > 0.0:
            total += math.fabs(rows.value.at[p] * own_stiffness(m, j, e.v)) * e.rate_noise[j]
    return total if math.isfinite(total) else 0.0


def shakes_last(e: Engine, mode: Mode, b: int, but: int) -> float:
    """Return for how long it does, at the most."""
    m = e.model
    rows = mode.finite
    most = 0.0
    for p in range(rows.first.at[mode.same[b]], rows.first.at[mode.same[b] + 1]):
        j = rows.column.at[p]
        if j < m.storages and j != but and e.rate_noise[j] > 0.0:
            most = max(most, e.lasts[j])
    return most


def shaken_by(e: Engine, k: int, h: float) -> float:
    """Return what that leaves of state `k` in a step of size `h`."""
    own = e.lasts[k] if k < e.model.storages else math.inf
    return e.rate_shakes[k] * min(h, e.shakes_for[k]) * min(h, own)
