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


def is_any_at_corner(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether any law is at such a corner; bond variables in `v` are those of `w`.

    The last step of Newton, which ends there, has had the slopes of where it began.
    """
    found = False
    for i in range(mode.dynamics):
        found = found or is_at_corner(e, mode, i, v, w)
    return found


def take_flat_sides(e: Engine, mode: Mode, v: Floats, w: Floats) -> None:
    """Let these slopes be zero among those of the rows in `e.work.slopes`.

    Those of rows that are kept at their corner are what they are on the other side.
    """
    m = e.model
    n = 2 * m.bonds
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0:
            for p in range(m.slope_first[d], m.slope_first[d + 1]):
                if m.slope_flat[p] != 0:
                    at = i * n + m.slope_column[p]
                    if e.work.kept_at_corner.at[i] != 0:
                        e.work.slopes.at[at] = steepest_beside(e, p, v, w)
                    elif ends_beside(e, p, v, w):
                        e.work.slopes.at[at] = 0.0


def is_at_corner(e: Engine, mode: Mode, i: int, v: Floats, w: Floats) -> bool:
    """Whether row i is a law at such a corner."""
    m = e.model
    d = mode.dynamic[i]
    if d < 0:
        return False
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        if m.slope_flat[p] != 0 and is_flat_beside(e, p, v, w):
            return steepest_beside(e, p, v, w) != 0.0
    return False


def ends_beside(e: Engine, p: int, v: Floats, w: Floats) -> bool:
    """Whether slope p, which is not zero, is so just beside the bond variable that it is by."""
    return value(e.model, e.model.slope_value[p], v) != 0.0 and is_flat_beside(e, p, v, w)


def is_flat_beside(e: Engine, p: int, v: Floats, w: Floats) -> bool:
    """Whether slope p is zero on either side."""
    ends = False
    for side in range(2):
        ends = ends or slope_beside(e, p, side, v, w) == 0.0
    return ends


def steepest_beside(e: Engine, p: int, v: Floats, w: Floats) -> float:
    """Return slope p on the side where there is more of it."""
    most = value(e.model, e.model.slope_value[p], v)
    for side in range(2):
        slope = slope_beside(e, p, side, v, w)
        if math.fabs(slope) > math.fabs(most):
            most = slope
    return most


def slope_beside(e: Engine, p: int, side: int, v: Floats, w: Floats) -> float:
    """Return slope p on one side of the bond variable that it is by."""
    m = e.model
    k = m.slope_column[p]
    most = 0.0
    for j in range(2 * m.bonds):
        if m.bond_class[j] == m.bond_class[k]:
            most = max(most, math.fabs(w[j]))
    near = max(BESIDE * most, LEAST)
    v[m.bond_slot + k] = w[k] + near if side == 0 else w[k] - near
    slope = value(m, m.slope_value[p], v)
    v[m.bond_slot + k] = w[k]
    return slope
