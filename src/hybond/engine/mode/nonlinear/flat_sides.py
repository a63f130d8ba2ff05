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
    measure_kinds(e, w)
    for i in range(mode.dynamics):
        if is_at_corner(e, mode, i, v, w):
            return True
    return False


def measure_kinds(e: Engine, w: Floats) -> None:
    """Put how far a variable is moved to be beside a corner into `e.work.kind_beside`, by kinds."""
    m = e.model
    near = e.work.kind_beside
    for c in range(m.classes):
        near[c] = LEAST
    for k in range(2 * m.bonds):
        c = m.bond_class[k]
        near[c] = max(near[c], BESIDE * math.fabs(w[k]))


def take_flat_sides(e: Engine, mode: Mode, v: Floats, w: Floats) -> None:
    """Let these slopes be zero among those of the rows in `e.work.slopes`.

    Those of rows that are kept at their corner are what they are on the other side.
    """
    m = e.model
    n = 2 * m.bonds
    measure_kinds(e, w)
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0:
            for p in range(m.slope_first[d], m.slope_first[d + 1]):
                if m.slope_flat[p] != 0:
                    most = steepest_about(e, p, v, w)
                    if e.work.flat_about:
                        kept = e.work.kept_at_corner.at[i] != 0
                        e.work.slopes.at[i * n + m.slope_column[p]] = most if kept else 0.0


def is_at_corner(e: Engine, mode: Mode, i: int, v: Floats, w: Floats) -> bool:
    """Whether row i is a law at such a corner, after `measure_kinds`."""
    m = e.model
    d = mode.dynamic[i]
    if d < 0:
        return False
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        if m.slope_flat[p] != 0 and steepest_about(e, p, v, w) != 0.0 and e.work.flat_about:
            return True
    return False


def steepest_about(e: Engine, p: int, v: Floats, w: Floats) -> float:
    """Return slope p here or just beside, where there is most of it.

    Whether it is zero on one side is in `e.work.flat_about`: one that is zero here alone, as of a
    square at rest, is no flat side.
    """
    m = e.model
    k = m.slope_column[p]
    most = value(m, m.slope_value[p], v)
    e.work.flat_about = False
    near = e.work.kind_beside[m.bond_class[k]]
    for side in range(2):
        v[m.bond_slot + k] = w[k] + near if side == 0 else w[k] - near
        slope = value(m, m.slope_value[p], v)
        if slope == 0.0:
            e.work.flat_about = True
        if math.fabs(slope) > math.fabs(most):
            most = slope
    v[m.bond_slot + k] = w[k]
    return most
