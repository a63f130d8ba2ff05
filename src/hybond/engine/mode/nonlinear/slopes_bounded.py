"""Slopes without bound, as of a root at zero: what stands for them in Newton's system."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value
from hybond.engine.model import Model
from hybond.engine.words import Floats

LONGEST: Final = 1000
"""The power of two up to which, and down to whose inverse, a way is looked for on which a law comes
to hold."""
BESIDE: Final = 1e-150
"""A way that is next to none, for the sign of a slope."""
BESIDE_PART: Final = 2.0**-20
"""Part of a variable that is as near beside it as a slope has to be known."""
STEEP: Final = 1e8
"""What stands for a slope without bound, as a multiple of the others in its row."""


def bound_slopes(e: Engine, mode: Mode, v: Floats) -> None:
    """Let slopes without bound, of a root at zero, be those of chords to where the law holds.

    A steep slope that stands for them would lead too far by powers of ten: a root that gives little
    is reached by the square of that. Where the law holds already, steep ones lead away from there.
    Rows say what an element gives less its law, which grows.
    """
    for i in range(mode.dynamics):
        if not is_bounded(e.model, mode, i, e.work.slopes.at):
            bound_row(e, mode, i, v)


def bound_row(e: Engine, mode: Mode, i: int, v: Floats) -> None:
    """Do so in row i."""
    n = 2 * e.model.bonds
    a = e.work.slopes.at
    most = 1.0
    bounded = True
    for k in range(n):
        if math.isfinite(a[i * n + k]):
            most = max(most, math.fabs(a[i * n + k]))
        else:
            bounded = False
    for k in range(n if not bounded else 0):
        if not math.isfinite(a[i * n + k]):
            steep = chord(e, mode, i, k, v)
            if steep == 0.0:
                way = way_to_slope(e, mode, i, k, v)
                if way > 0.0:
                    steep = STEEP * most if rises(e, mode, i, k, v, way) else -STEEP * most
            if steep != 0.0:
                a[i * n + k] = steep


def is_bounded(m: Model, mode: Mode, i: int, a: Floats) -> bool:
    """Whether it is seen at once that all slopes of row i have bounds: none is but those listed."""
    d = mode.dynamic[i]
    if d < 0:
        return False
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        if not math.isfinite(a[i * 2 * m.bonds + m.slope_column[p]]):
            return False
    return True


def way_to_slope(e: Engine, mode: Mode, i: int, k: int, v: Floats) -> float:
    """Return how far beside here row i is asked on which side it rises by variable k.

    Zero where it has no slope beside here, on either side. A root has one beside its end. Where a
    law has none there either, its numbers are beyond all bounds, as those of ``f/(1 + f^2)`` far
    behind its top: no slope stands for that. A law may see the variable beside another one of its
    kind alone: the pressure ``p - e`` behind an orifice is p for all that is less than rounding of
    p.
    """
    m = e.model
    d = mode.dynamic[i]
    if d < 0:
        return BESIDE
    size = math.fabs(v[m.bond_slot + k])
    way = max(BESIDE, BESIDE_PART * size)
    if has_slope_beside(e, d, k, v, way):
        return BESIDE
    reach = size
    for p in range(m.law_reads[d], m.law_reads[d + 1]):
        other = m.law_column[p]
        if m.bond_class[other] == m.bond_class[k] and math.isfinite(v[m.bond_slot + other]):
            reach = max(reach, math.fabs(v[m.bond_slot + other]))
    way = BESIDE_PART * reach
    if reach > size and has_slope_beside(e, d, k, v, way):
        return way
    return 0.0


def has_slope_beside(e: Engine, d: int, k: int, v: Floats, way: float) -> bool:
    """Whether law d has a slope by variable k so far beside here, on a side at least."""
    m = e.model
    at = m.bond_slot + k
    kept = v[at]
    found = False
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        if m.slope_column[p] == k and m.slope_value[p] >= 0:
            for side in range(2):
                v[at] = kept + way if side == 0 else kept - way
                found = found or math.isfinite(value(m, m.slope_value[p], v))
    v[at] = kept
    return found


def rises(e: Engine, mode: Mode, i: int, k: int, v: Floats, way: float) -> bool:
    """Whether row i becomes more as variable k does, so far beside where it has no slope."""
    at = e.model.bond_slot + k
    kept = v[at]
    v[at] = kept + way
    there = dynamic_value(e, mode, i, v)
    v[at] = kept
    return there > e.work.f[i]


def chord(e: Engine, mode: Mode, i: int, k: int, v: Floats) -> float:
    """Return the slope of row i from here to where variable k alone would make it zero.

    To a factor of two; 0 where it is zero here, or where there is none on either side.
    """
    here = e.work.f[i]
    if here == 0.0 or not math.isfinite(here):
        return 0.0
    at = e.model.bond_slot + k
    kept = v[at]
    slope = 0.0
    for side in range(2):
        way = 1.0 if side == 0 else -1.0
        low = -LONGEST
        high = LONGEST
        while slope == 0.0 and high - low > 1:
            middle = low + (high - low) // 2
            v[at] = kept + way * math.pow(2.0, float(middle))
            there = dynamic_value(e, mode, i, v)
            if math.isfinite(there) and there * here > 0.0:
                low = middle
            else:
                high = middle
        if slope == 0.0 and high < LONGEST and low > -LONGEST:
            slope = -here / (way * math.pow(2.0, float(high)))
    v[at] = kept
    return slope
