"""What rounding makes of a law where its slope says nothing of that: beside a root at zero.

The pressure over a valve that begins level is a difference of two that are large. Rounding of it
makes a flow of the root of that, and not of a slope without bound times it.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value
from hybond.engine.mode.nonlinear.newton_system import is_given
from hybond.engine.words import Floats


def bound_by_chords(e: Engine, mode: Mode, v: Floats) -> None:
    """Let the terms of laws, as `rows_of_system` has summed them, be no more than chords say.

    Of variables that no unknown has part in, where rounding times the slope is more than all else
    in the row: to first order it would be noise alone.
    """
    m = e.model
    work = e.work
    n = 2 * m.bonds
    for i in range(mode.dynamics if mode.rank == mode.structures else 0):
        d = mode.dynamic[i]
        if d < 0:
            continue
        total = 0.0
        bounded = False
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            k = m.slope_column[p]
            slope = math.fabs(work.slopes.at[i * n + k])
            term = slope * work.w_size[k] if math.isfinite(slope) else 0.0
            if term > 0.0 and is_given(mode, k) and EPSILON * term > beside(e, mode, i, d, k):
                term = min(term, by_chord(e, mode, i, k, v))
                bounded = True
            total += term
        if bounded:
            work.residual_size.at[i] = total


def beside(e: Engine, mode: Mode, i: int, d: int, k: int) -> float:
    """Return what the variables of law d but k have part in row i, as they are."""
    m = e.model
    n = 2 * m.bonds
    total = 0.0
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        other = m.slope_column[p]
        slope = math.fabs(e.work.slopes.at[i * n + other])
        if other != k and math.isfinite(slope):
            total += slope * math.fabs(mode.sized_at[other])
    return total


def by_chord(e: Engine, mode: Mode, i: int, k: int, v: Floats) -> float:
    """Return the size of what makes row i move as far as rounding of variable k does.

    Infinity where the law has no value on either side.
    """
    at = e.model.bond_slot + k
    kept = v[at]
    here = e.work.f[i]
    most = math.inf
    for side in range(2):
        way = EPSILON * e.work.w_size[k]
        v[at] = kept + way if side == 0 else kept - way
        there = math.fabs(dynamic_value(e, mode, i, v) - here)
        if math.isfinite(there):
            most = there if most == math.inf else max(most, there)
    v[at] = kept
    return most / EPSILON
