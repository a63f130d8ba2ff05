"""What is left of a jump's constraints where Newton's method comes no nearer: rounding, or not.

A storage that holds next to nothing has next to no rounding of its own. But areas that are found
together have the rounding of all the constraints that they are found from: an amplifier passes the
last digit of a volt on to a stage at rest, and there it is all that the constraints are about.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import Engine
from hybond.engine.jumps.jump_steps import find_step
from hybond.engine.mode.mode_records import Ways

TIMES: Final = 16.0
"""How many times the rounding of the constraints may be left of one."""
MOST: Final = 64
"""Constraints up to which that is asked: a system is solved for each of them."""


def is_rounding(e: Engine, ways: Ways) -> bool:
    """Whether what is left of each constraint is no more than what rounding of all leaves there.

    By how much rounding of each constraint moves the areas, and by how much all of that moves the
    constraint. The residuals are in ``e.work.gap``, and are left there.
    """
    w = e.work
    count = w.constraints
    areas = ways.areas
    if ways.known or ways.sparse or count > MOST:
        return False
    fit(w.left_gap, count)
    fit(w.left_area, areas)
    for i in range(count):
        w.left_gap.at[i] = w.gap.at[i]
    for a in range(areas):
        w.left_area.at[a] = 0.0
    for i in range(count):
        for j in range(count):
            w.gap.at[j] = EPSILON * w.gap_size.at[i] if j == i else 0.0
        find_step(e, ways, count)
        for a in range(areas):
            w.left_area.at[a] += math.fabs(w.step.at[a])
    rounding = True
    for i in range(count):
        known = 0.0
        for a in range(areas):
            known += math.fabs(ways.slope.at[i * areas + a]) * w.left_area.at[a]
        w.gap.at[i] = w.left_gap.at[i]
        rounding = rounding and math.fabs(w.gap.at[i]) <= TIMES * known
    return rounding
