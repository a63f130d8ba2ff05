"""Signals of a run of time-stepping: what its steps found, not what the mode's equations would say.

An impulse and a force are one in a step, so a bond variable is that of the step's end; between two
points everything is linear.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.equations.storage import StorageLaws
from hybond.model.interval import Interval
from hybond.programs.program import Program
from hybond.trace import Segment

Vector = NDArray[np.float64]


def values_of_steps(program: Program, segment: Segment, t: Sequence[float] | Vector) -> Vector:
    """Return all values at times within a segment, shape (2 * slots, len(t))."""
    assert segment.bonds is not None
    assert isinstance(segment.interval, Interval)
    slots = program.slots
    nx, ns = program.nx, program.ns
    rows = np.zeros((len(t), 2 * slots.size))
    for row, a in zip(rows, t, strict=True):
        y = segment.at(float(a))
        row[:] = program.values(float(a), segment.interval, segment.mode, y[:nx], y[nx : nx + ns])
        row[slots.w] = segment.bonds_at(float(a))
        row[slots.size :] = row[: slots.size]
    return rows.T


def created_by_steps(
    program: Program, storage: StorageLaws, segment: Segment
) -> tuple[float, float]:
    """Return what the steps of a segment created, and the largest energy in it, J.

    A step loses energy in impacts, and by damping if theta is above 1/2. It should not have more at
    its end than what it began with and was supplied. It may, where a law lets go or takes hold
    within it, the less the shorter it is.
    """
    stored = np.array([storage.energy(y[: program.nx]) for y in segment.y])
    supplied, dissipated = segment.y[:, -2], segment.y[:, -1]
    created = np.maximum(np.diff(stored - supplied), 0.0)
    passed = float(np.abs(np.diff(supplied)).sum() + np.abs(np.diff(dissipated)).sum())
    return float(created.sum()), max(float(np.abs(stored).max()), passed)
