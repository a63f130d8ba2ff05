"""Laws at a corner beside which they are flat: `max(e - 1, 0)` at 1.

Newton comes to rest at such a corner, where the slope is that of one side. What the other side
leaves free is free there too: which of the two is taken would depend on how the law is written.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Floats

BESIDE: Final = 2.0**-30
"""Part of the largest variable of its kind by which one is moved to be beside a corner."""
LEAST: Final = 1e-150
"""The same where all of them are zero."""


def is_at_flat_side(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether the slope of any law at `w` is not zero, but is so beside it.

    Bond variables in `v` are those of `w`.
    """
    m = e.model
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0:
            for p in range(m.slope_first[d], m.slope_first[d + 1]):
                if m.slope_flat[p] != 0 and ends_beside(e, p, v, w):
                    return True
    return False


def take_flat_sides(e: Engine, mode: Mode, v: Floats, w: Floats) -> None:
    """Let these slopes be zero among those of the rows in `e.work.slopes`."""
    m = e.model
    n = 2 * m.bonds
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0:
            for p in range(m.slope_first[d], m.slope_first[d + 1]):
                if m.slope_flat[p] != 0 and ends_beside(e, p, v, w):
                    e.work.slopes.at[i * n + m.slope_column[p]] = 0.0


def ends_beside(e: Engine, p: int, v: Floats, w: Floats) -> bool:
    """Whether slope p, which is not zero, is so just beside the bond variable that it is by."""
    m = e.model
    if value(m, m.slope_value[p], v) == 0.0:
        return False
    k = m.slope_column[p]
    most = 0.0
    for j in range(2 * m.bonds):
        if m.bond_class[j] == m.bond_class[k]:
            most = max(most, math.fabs(w[j]))
    near = max(BESIDE * most, LEAST)
    ends = False
    for side in range(2):
        v[m.bond_slot + k] = w[k] + near if side == 0 else w[k] - near
        ends = ends or value(m, m.slope_value[p], v) == 0.0
    v[m.bond_slot + k] = w[k]
    return ends
