"""Signals that are set at instants and held between them: what they are set to, differentiated.

At ``phase + n*every`` a sampled signal becomes the value of its expression just before, where the
state is varied by d + f- dtau: dtau is zero, unless the instants themselves follow a parameter. All
signals of one instant read what there was before any of them was set.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.tangent import Read
from hybond.model.graph import Sample

Vector = NDArray[np.float64]

TOGETHER = 1e-12
"""Part of a time within which instants are one."""


def due(fields: Fields, t: float) -> list[tuple[Sample, Vector]]:
    """Return what is sampled at a time, and the derivatives of that instant by parameters."""
    found = []
    if t >= fields.values.run.t_end:
        return []  # nobody would see it held
    for sample in fields.graph.samples:
        n = round((t - float(sample.phase)) / float(sample.every))
        instant = sample.phase + n * sample.every
        if n >= 0 and abs(float(instant) - t) <= TOGETHER * max(t, float(sample.every)):
            found.append((sample, fields.values.slope(instant)))
    return found


def sampled(end: Field, samples: Sequence[Sample], x: Vector, dtau: Vector, p: Vector) -> Vector:
    """Return how the state is varied once signals are set.

    Parameters
    ----------
    end : Field
        Just before.
    x : array, shape (states, basis)
        How the state is varied at the instant.
    dtau : array, shape (basis,)
    p : array, shape (parameters, basis)
    """
    rows = end.tangent.rows
    stored = len(rows.graph.storages)
    found = x.copy()
    known = np.vstack([x, dtau[None], p])
    for sample in samples:
        made = [rows.moving(e) for e in sample.values]
        slopes = Read(end.tangent, made).at(end.at, end.bonds)[0]
        for signal, row in zip(sample.signals, slopes, strict=True):
            found[stored + signal] = row @ known
    return found
