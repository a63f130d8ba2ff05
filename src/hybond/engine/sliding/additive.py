"""Whether switches act independently of each other."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import largest
from hybond.engine.engine import OK, Engine
from hybond.engine.laws.branches import choose_own, follow
from hybond.engine.mode.equations import mode_of
from hybond.engine.surfaces.blend import solve_part
from hybond.engine.surfaces.corners import put_side
from hybond.engine.surfaces.outputs import show_state
from hybond.engine.words import Floats

ADDITIVE: Final = 1e-9
"""Fields are additive if what they lack is below this part of them."""
ACT_ALONE: Final = 0
ACT_TOGETHER: Final = 1
NO_FIELD: Final = 2


def how_switches_act(e: Engine) -> int:
    """Return how the fields depend on the switches: ACT_ALONE, ACT_TOGETHER or NO_FIELD.

    Those found by `find_speeds` are held against the fields with all machines above, and with
    every other one: what no switch does alone shows there, unless it cancels.
    """
    m = e.model
    s = e.slide
    n = e.states
    for check in range(3 if s.k > 1 else 0):
        for k in range(m.machines):
            s.target[k] = s.around[k]
        for j in range(s.k):
            up = check == 0 or j % 2 == (1 if check == 1 else 0)
            s.trial_side[j] = 1 if up else 0
            put_side(m, s.side[j], up, s.target)
        follow(e, s.around, s.target)
        choose_own(e, s.target)
        if mode_of(e, s.target) != OK:
            return NO_FIELD
        s.part[s.parts] = e.mode_at
        show_state(e, e.t, e.y, s.v)
        if solve_part(e, s.parts, s.v, s.part_rate, s.parts * n, True) != OK:
            return NO_FIELD
        most = largest(2 * m.bonds, e.work.w)
        for k in range(2 * m.bonds):
            off = math.fabs(e.work.w[k] - expected(e, s.solution, 2 * m.bonds, k))
            if off > ADDITIVE * (float(s.k) * column_largest(e, s.solution, 2 * m.bonds, k) + most):
                return ACT_TOGETHER
        for k in range(m.storages, n):
            off = math.fabs(s.part_rate[s.parts * n + k] - expected(e, s.part_rate, n, k))
            if off > ADDITIVE * (float(s.k) * column_largest(e, s.part_rate, n, k) + 1e-300):
                return ACT_TOGETHER
    return ACT_ALONE


def expected(e: Engine, rows: Floats, n: int, k: int) -> float:
    """Return what column k of the parts' rows would be if the switches act alone."""
    s = e.slide
    total = rows[k]
    for j in range(s.k):
        total += float(s.trial_side[j]) * (rows[(j + 1) * n + k] - rows[k])
    return total


def column_largest(e: Engine, rows: Floats, n: int, k: int) -> float:
    """Return the largest of column k of the parts' rows."""
    most = 0.0
    for part in range(e.slide.parts):
        most = max(most, math.fabs(rows[part * n + k]))
    return most
