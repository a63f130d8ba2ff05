"""What the error of a step leaves in rates, where something exchanges far faster than a step lasts.

A current through a nano-ohm is the difference of two voltages times 1e9: where voltages are right
to eight digits it may have none. So rates are held as well: over a step they may be off by `RATES`
times what the states may. Where nothing is faster than a step the states' own error says more.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.methods.flow_records import Flow
from hybond.engine.words import Floats

RATES: Final = 100.0
"""What rates times a step may be off by, in what states may be."""
FROM_ROUNDING: Final = 256.0 * EPSILON
"""Part of the terms of a rate up to which it is rounding, whatever the step: what the error of a
step is found by multiplies that of the states by as much."""


def rates_off(
    n: int, many: int, h: float, jacobian: Floats, y: Floats, error: Floats, scale: Floats
) -> float:
    """Return the largest error of the rates of the first of n states, in what it may be over `h`.

    Those are what is stored: its rates are efforts and flows, which a run tells.
    """
    most = 0.0
    for i in range(many):
        off = 0.0
        terms = 0.0
        for j in range(n):
            slope = jacobian[i * n + j]
            off += slope * error[j]
            terms += math.fabs(slope * y[j])
        most = max(most, part_of(h, off, terms, scale[i]))
    return most


def rates_off_in_flow(
    f: Flow, states: int, many: int, h: float, z: Floats, error: Floats, scale: Floats
) -> float:
    """Return the same for what is propagated: sources are known, whatever the error."""
    # where nothing is so much faster than the step, states within their tolerance leave less
    if not h * f.norm > RATES:
        return 0.0
    most = 0.0
    for i in range(many):
        off = 0.0
        terms = 0.0
        for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
            j = f.rows.column.at[p]
            slope = f.rows.value.at[p] * f.scale.at[i] / f.scale.at[j]
            terms += math.fabs(slope * z[j])
            if j < states:
                off += slope * error[j]
        most = max(most, part_of(h, off, terms, scale[i]))
    return most


def part_of(h: float, off: float, terms: float, scale: float) -> float:
    """Return how far off a rate is, in what it may be; 0 if none is asked."""
    may = max(RATES * scale, h * FROM_ROUNDING * terms)
    if not may > 0.0:
        return 0.0
    return h * math.fabs(off) / may
