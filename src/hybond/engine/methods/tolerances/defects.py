"""What a step leaves open between what is stored by it and what its rates bring, J.

Each storage on its own is taken for linear over a step, along the chord of its law: then the work
of rates at the stages of a method is a sum of products of these, and right to the order of the
method. That of steps which were right is next to nothing, whatever tolerance they were held to.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.mode.rows.storage import (
    co_energy,
    co_energy_of,
    is_alone,
    own_stiffness,
    stiff,
    with_stored,
)
from hybond.engine.words import Floats, float_table

SHORT_CHORD: Final = 1e-6
"""Part of what is stored below which a change of it tells no slope."""
SURE: Final = 1e-4
"""Part of the energy that a step has moved up to which its own error leaves nothing open."""
STAGES: Final = 4
"""Stages of Dormand and Prince with a weight, but for the first and those at the end."""
WEIGHT: Final = float_table(500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0)
PLACE: Final = float_table(
    3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0,
    44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0,
    19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0,
    9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0,
)  # fmt: skip
"""Their weights in the solution, and where they stand: rows of five stages before them."""


def begin_levels(e: Engine) -> None:
    """Find the co-energy variables where a step begins: those of the last one's end, if there."""
    s = e.step
    same = True
    for k in range(e.model.storages):
        same = same and s.level_at[k] == s.y0[k]
    s.defect = 0.0
    s.apart = 0.0
    s.rates_known = False
    if same:
        for k in range(e.model.storages):
            s.level0[k] = s.level1[k]
        return
    co_energy(e.model, with_stored(e, s.y0), s.level0)


def end_levels(e: Engine) -> None:
    """Find the co-energy variables where the step just made ends."""
    m = e.model
    s = e.step
    written = False
    for k in range(m.storages):
        s.level_at[k] = s.y1[k]
        if is_alone(m, k):
            s.level1[k] = m.stiff_constant[m.stiff_first[k]] * s.y1[k]
            continue
        if not written:
            with_stored(e, s.y1)
            written = True
        s.level1[k] = co_energy_of(m, k, e.work.values)


def chord(e: Engine, k: int) -> float:
    """Return the slope of a storage of one port over the step just made."""
    m = e.model
    s = e.step
    if m.co_energy[k] < 0:
        return m.stiff_constant[m.stiff_first[k]]
    way = s.y1[k] - s.y0[k]
    if math.fabs(way) > SHORT_CHORD * math.fabs(s.y0[k]):
        return (s.level1[k] - s.level0[k]) / way
    return own_stiffness(m, k, with_stored(e, s.y0))


def has_ports(e: Engine, k: int) -> bool:
    """Whether port k is one of several of its storage."""
    m = e.model
    return m.stiff_first[k + 1] - m.stiff_first[k] > 1


def stored_by_step(e: Engine, k: int) -> float:
    """Return what the step has stored at port k beyond its first level times the change."""
    m = e.model
    s = e.step
    way = s.y1[k] - s.y0[k]
    if not has_ports(e, k):
        return 0.5 * chord(e, k) * way * way
    lift = 0.0
    v = with_stored(e, s.y0)
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        j = m.stiff_other[i]
        lift += stiff(m, i, v) * (s.y1[j] - s.y0[j])
    return 0.5 * lift * way


def place_of_stage(n: int, k: int, rates: Floats, stage: int) -> float:
    """Return how far a stage is from where the step begins, in steps."""
    at = 5 * stage
    total = PLACE[at] * rates[k] + PLACE[at + 1] * rates[n + k]
    for j in range(2, stage + 2):
        total += PLACE[at + j] * rates[j * n + k]
    return total


def defect_of_stages(e: Engine, h: float) -> None:
    """Find that of a step of Dormand and Prince, of its stages in `k`."""
    m = e.model
    s = e.step
    n = e.states
    end_levels(e)
    total = 0.0
    sure = 0.0
    moved = 0.0
    for k in range(m.storages):
        sure += math.fabs(s.level1[k] * s.error[k])
        moved += math.fabs(s.level1[k] * (s.y1[k] - s.y0[k]))
    s.defect = 0.0
    if sure <= SURE * moved:
        return
    for k in range(m.storages):
        if m.storage_pseudo[k] != 0:
            continue
        work = 0.0
        if has_ports(e, k):
            v = with_stored(e, s.y0)
            for stage in range(STAGES):
                lift = 0.0
                for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
                    way = place_of_stage(n, m.stiff_other[i], s.k, stage)
                    lift += stiff(m, i, v) * way
                work += WEIGHT[stage] * s.k[(stage + 2) * n + k] * lift
        else:
            for stage in range(STAGES):
                way = place_of_stage(n, k, s.k, stage)
                work += WEIGHT[stage] * s.k[(stage + 2) * n + k] * way
            work *= chord(e, k)
        stored = stored_by_step(e, k)
        total += stored - h * h * work
    s.defect = total


def defect_of_fixed(e: Engine, h: float, classical: bool) -> None:
    """Find that of a step of Euler's method, or of the classical one with its stages in `k`."""
    m = e.model
    s = e.step
    n = e.states
    end_levels(e)
    total = 0.0
    for k in range(m.storages):
        if m.storage_pseudo[k] != 0:
            continue
        work = 0.0
        if classical:
            for stage in range(3):
                lift = lifted(e, k, stage)
                work += s.k[(stage + 1) * n + k] * lift / 6.0
        stored = stored_by_step(e, k)
        total += stored - h * h * work
    s.defect = total


def lifted(e: Engine, k: int, stage: int) -> float:
    """Return what the rates of a stage make of the level of port k in a second."""
    m = e.model
    s = e.step
    at = stage * e.states
    if not has_ports(e, k):
        slope = chord(e, k)
        return slope * s.k[at + k]
    total = 0.0
    v = with_stored(e, s.y0)
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        total += stiff(m, i, v) * s.k[at + m.stiff_other[i]]
    return total


def apart_at_end(e: Engine, k: int, moved: float) -> None:
    """Count port k, which the motion of a step moves by so much at its end, in units of the step.

    The rates there, as they are shown, may be others.
    """
    s = e.step
    if e.model.storage_pseudo[k] == 0:
        s.apart += 0.5 * s.level1[k] * (moved - (s.t1 - s.t0) * s.f[k])
