"""States between points of a run where a law ends, brought back by what a step may be wrong by.

A tank that runs empty, or fills from nothing, stands on the edge of the law of its outlet: what is
between two points is known to the tolerance of the run, and a cubic through both may lie beyond
the edge by less than that. There the law has no value, though the motion has one.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.methods.scale import NEGLIGIBLE
from hybond.engine.mode.storage import own_stiffness, with_stored
from hybond.engine.words import Floats

WAYS: Final = 2
"""Ways back: between the ends of the step, then towards the straight line between them."""


def lead_back(e: Engine, way: int, x: float, ends: Floats, at: int, y: Floats) -> None:
    """Move a state at the part `x` of a step by no more than the tolerance.

    The states at the ends of the step, for which laws have values, are the first and the third row
    of `ends` from `at` on.
    """
    m = e.model
    v = with_stored(e, y)
    for k in range(e.states):
        first = ends[at + k]
        last = ends[at + 2 * e.states + k]
        size = max(math.fabs(first), math.fabs(last))
        if k < m.storages:
            own = math.fabs(own_stiffness(m, k, v))
            floor = NEGLIGIBLE * math.sqrt(2.0 * e.energy / own) if own > 0.0 else 0.0
            size = max(size, floor if math.isfinite(floor) else 0.0)
        allowed = m.rtol * size + (m.atol if m.atol == m.atol else 0.0)
        goal = first + x * (last - first)
        if way == 0:
            goal = min(max(y[k], min(first, last)), max(first, last))
        if math.fabs(goal - y[k]) <= allowed:
            y[k] = goal
        elif way > 0:
            y[k] += math.copysign(allowed, goal - y[k])
