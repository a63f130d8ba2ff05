"""States between points of a run where a law ends, brought back by what a step may be wrong by.

A tank that runs empty, or fills from nothing, stands on the edge of the law of its outlet: what is
between two points is known to the tolerance of the run, and a polynomial through both may lie
beyond the edge by less than that, or turn there. There the law has no value, though the motion has
one.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.methods.tolerances.scale import NEGLIGIBLE
from hybond.engine.mode.mode_records import Ways
from hybond.engine.mode.rows.storage import own_stiffness, with_stored
from hybond.engine.words import Floats

FEW: Final = 64
"""States up to which each is led back alone."""
TURNS: Final = 0.5
"""Part of its way in a step that a state alone may be led back by: what turns where it may not."""


def ways_back(e: Engine) -> int:
    """Return how many ways back there are: each state alone, all, all towards a straight line."""
    return 2 + (e.states if e.states <= FEW else 0)


def lead_back(e: Engine, way: int, x: float, ends: Floats, at: int, y: Floats) -> None:
    """Move a state at the part `x` of a step back between the ends of the step, one way or another.

    The states at the ends, for which laws have values, are the first and the third row of `ends`
    from `at` on. What is moved with others, which may swing, is moved by the tolerance at the most.
    """
    m = e.model
    v = with_stored(e, y)
    alone = e.states if e.states <= FEW else 0
    for k in range(e.states):
        if way < alone and way != k:
            continue
        first = ends[at + k]
        last = ends[at + 2 * e.states + k]
        size = max(math.fabs(first), math.fabs(last))
        if k < m.storages:
            own = math.fabs(own_stiffness(m, k, v))
            energy = e.part_energy[e.storage_part[k]]
            floor = NEGLIGIBLE * math.sqrt(2.0 * energy / own) if own > 0.0 else 0.0
            size = max(size, floor if math.isfinite(floor) else 0.0)
        allowed = m.rtol * size + (m.atol if m.atol == m.atol else 0.0)
        goal = min(max(y[k], min(first, last)), max(first, last))
        if way < alone:
            allowed = max(allowed, TURNS * math.fabs(last - first))
        elif way > alone:
            goal = first + x * (last - first)
        if math.fabs(goal - y[k]) <= allowed:
            y[k] = goal
        elif way > alone:
            y[k] += math.copysign(allowed, goal - y[k])


def lead_between(e: Engine, ways: Ways, ends: Floats, at: int, y: Floats) -> None:
    """Move what constraints alone hold back between the ends of the step: they find it from there.

    What a source leads through a law such as a `sinh` jumps from one side to the other where the
    source passes zero. A polynomial over that leads to where the law is beyond all numbers.
    """
    for k in range(e.model.storages):
        if ways.moves_first.at[k] < ways.moves_first.at[k + 1]:
            first = ends[at + k]
            last = ends[at + 2 * e.states + k]
            y[k] = min(max(y[k], min(first, last)), max(first, last))
