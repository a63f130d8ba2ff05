"""Comparisons that are sums of the state, as polynomials of the last step."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.locator import COURSE, Locator
from hybond.engine.guards.quartic import COEFFICIENTS, DEGREE
from hybond.engine.mode.digits.part_energies import find_energies, reach_of_sum

MOVES: Final = 2
"""What a state does in a step: it moves, ..."""
STANDS: Final = 1
"""... has one value all over it, ..."""
NOTHING: Final = 0
"""... or is zero all over it."""


def take_step(e: Engine, g: Locator) -> None:
    """Take all comparisons that are sums as polynomials of the last step; of others their part."""
    find_energies(e, e.mode)
    see_motion(e, g)
    for a in range(g.atoms):
        if g.sums.known.at[a] != 0 or g.sums.waved.at[a] != 0:
            put_polynomial(e, g, a)


def see_motion(e: Engine, g: Locator) -> None:
    """See how the step moves each state; terms of those that are zero all over it are none."""
    step = e.step
    n = e.states
    for k in range(n):
        moves = step.dense[k] != 0.0 or step.dense[n + k] != 0.0
        moves = moves or step.dense[2 * n + k] != 0.0 or step.dense[3 * n + k] != 0.0
        there = step.y0[k] != 0.0 or step.y1[k] != 0.0
        g.motion[k] = MOVES if moves else STANDS if there else NOTHING
        at = COURSE * k
        g.course[at] = step.y0[k]
        for i in range(DEGREE):
            g.course[at + 1 + i] = step.dense[i * n + k]
        g.course[at + COEFFICIENTS] = max(math.fabs(step.y0[k]), math.fabs(step.y1[k]))


def put_polynomial(e: Engine, g: Locator, a: int) -> None:
    """Put the coefficients of a comparison there, as of dense output, and the size of its terms."""
    s = g.sums
    step = e.step
    course = g.course
    at = COEFFICIENTS * a
    h = step.t1 - step.t0
    c0 = s.level.at[a] + s.drift.at[a] * step.t0
    c1 = s.drift.at[a] * h
    c2 = 0.0
    c3 = 0.0
    c4 = 0.0
    extent = math.fabs(s.level.at[a]) + math.fabs(s.drift.at[a] * step.t1)
    extent += reach_of_sum(e.mode, s, a)
    astray = 0.0
    for p in range(s.first.at[a], s.first.at[a + 1]):
        k = s.column.at[p]
        if g.drifted and g.drift[k] != 0.0:
            astray += math.fabs(s.factor.at[p]) * g.drift[k]
        if g.motion[k] == NOTHING:
            continue
        factor = s.factor.at[p]
        own = COURSE * k
        c0 += factor * course[own]
        if g.motion[k] == MOVES:
            c1 += factor * course[own + 1]
            c2 += factor * course[own + 2]
            c3 += factor * course[own + 3]
            c4 += factor * course[own + 4]
        extent += s.size.at[p] * course[own + COEFFICIENTS]
    g.step[at] = c0
    g.step[at + 1] = c1
    g.step[at + 2] = c2
    g.step[at + 3] = c3
    g.step[at + 4] = c4
    g.extent[a] = extent
    g.astray[a] = astray
