"""What the error of a step leaves in rates, where something exchanges far faster than a step lasts.

A current through a nano-ohm is the difference of two voltages times 1e9: where voltages are right
to eight digits it may have none. So rates are held as well: over a step they may be off by `RATES`
times what the states may. Where nothing is faster than a step the states' own error says more.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.methods.linear.flow_records import Exact
from hybond.engine.words import Floats

RATES: Final = 100.0
"""What rates times a step may be off by, in what states may be."""
FROM_ROUNDING: Final = 256.0 * EPSILON
"""Part of the terms of a rate up to which it is rounding, whatever the step: what the error of a
step is found by multiplies that of the states by as much."""
ALWAYS: Final = 16.0 * EPSILON
"""The same in what is propagated: there it is the fifth difference of six values, times 0.15, each
of which is off by some units. That is no reason for short steps, ..."""
TWICE: Final = 1e-3
"""... and no more of it is told than lets the next step be tried at twice the length. ..."""
FOUND: Final = 8.0
"""... So many times as much is let in: what is more is of the step, and would grow with it."""


def rates_off_in_flow(
    x: Exact, many: int, h: float, error: Floats, scale: Floats, lately: Floats
) -> float:
    """Return the largest error of the rates of what is stored, in what it may be over `h`.

    Those are efforts and flows, which a run tells; `many` states are stored, and `error` is theirs.
    Sources are known, whatever the error. Rounding of a rate is measured by the sizes that states
    and sources lately had: where a sine passes zero it is that of its amplitude. What a state may
    be off by is no such size: of a picofarad it is what a source would leave there in a moment.
    """
    f = x.flow
    # where nothing is so much faster than the step, states within their tolerance leave less
    if not h * f.norm > RATES:
        return 0.0
    size = x.b2.at
    for j in range(f.n):
        size[j] = math.fabs(x.parts.at[j])
        if j < many:
            size[j] = max(size[j], lately[j])
        if f.shares > 0:
            # a difference of what others hold is no more exact than these
            size[j] = max(size[j], x.shared.at[j] * f.scale.at[j])
    for k in range(f.watches):
        j = f.watched.at[k]
        size[j] = max(size[j], x.amplitude.at[k])
    most = 0.0
    for i in range(many):
        off = 0.0
        terms = 0.0
        for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
            j = f.rows.column.at[p]
            slope = f.rows.value.at[p] * f.scale.at[i] / f.scale.at[j]
            terms += math.fabs(slope * size[j])
            if j < many:
                off += slope * error[j]
        may = max(RATES * scale[i], h * FOUND * ALWAYS * terms)
        if may > 0.0:
            left = h * math.fabs(off) / may
            if math.fabs(off) <= ALWAYS * terms:
                left = min(left, TWICE)
            most = max(most, left)
    return most
