"""Stages of a step where laws have edges: found with one matrix for all, or with slopes of each.

One matrix serves all stages where slopes are about the same at all of them. Beside an edge they are
not. A matrix that was made where a root has next to no bound on its slope makes the correction next
to nothing, however much is left of the equations, and that looks as if stages had converged; one
that was made farther off leads them beyond the edge. So what is found at once is put back into the
laws, and where either has happened the stages are found by their own slopes.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR
from hybond.engine.algebra.products import copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.implicit.from_edges import (
    DIGITS,
    STALLS,
    leaves_edge,
    stages_by_foreseen,
    stages_from_edge,
)
from hybond.engine.methods.implicit.radau_factors import factorise
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import (
    NO_MATRIX,
    STAGES_BEYOND,
    STAGES_CONVERGED,
    STAGES_FAILED,
    iterate_stages,
    rate_at,
    stage_rates,
)
from hybond.engine.methods.implicit.settled_rates import SHORT_PART, is_beside_edge, settle_rates
from hybond.engine.methods.implicit.whole_stages import put_left, take_all
from hybond.engine.surfaces.values import evaluate

CREEPS_AFTER: Final = 4
"""Attempts that have failed before: steps that are a little shorter serve what lies between their
ends better than stages that are only just found."""
SOONER: Final = 0.1
"""Part of a step for which no stages were found that the next one is at most for which they are
looked for again."""
STAYS: Final = 0.25
"""Part of how far it is from an edge where a step begins that it has at the end, at least."""
LESSENS: Final = 0.5
"""Part of what was left of the equations that a correction may leave of them."""


def begins_at_edge(e: Engine, r: Radau, rtol: float) -> bool:
    """Whether the step that is tried leaves an edge; its stages are found then."""
    if not (leaves_edge(e, r.t0, r.y0, r.f0, r.h) and own_stages(e, r, rtol, 0.0)):
        return False
    e.step.left_edge = True
    e.step.calm = 0
    return True


def own_stages(e: Engine, r: Radau, rtol: float, least: float) -> bool:
    """Find the stages by slopes of their own; where there are none, those serve no step after this.

    They are of places that were tried: at an edge without bound. Where none have been found of a
    step as long as this one, none are: they hang on no matrix.
    """
    vain = r.h == r.vain_h and least >= r.vain_least
    if not vain and stages_from_edge(e, r, rtol, least, DIGITS):
        return True
    r.vain_h = r.h
    r.vain_least = r.vain_least if vain else least
    for i in range(r.n):
        r.made_for[i] = 0.0
    return False


def stages_through_rest(e: Engine, r: Radau, rtol: float) -> bool:
    """Find stages by slopes of their own where one matrix does not serve a flow beside rest.

    The slope of a root is far from that of the next stage there, however smooth the motion is. What
    runs into an edge, or from there, has ways of its own.
    """
    if e.model.begins == 0 or e.slide.k > 0 or r.rejected < CREEPS_AFTER:
        return False
    if r.vain_h > 0.0 and r.h > SOONER * r.vain_h:
        return False
    found = stages_by_foreseen(e, r, rtol, STALLS, SHORT_PART)
    found = found or stages_from_edge(e, r, rtol, STALLS, SHORT_PART)
    if found and not is_beside_edge(e, r):
        copy_part(r.n, r.y, 2 * r.n, r.stage, 0)
        if rate_at(e, r.n, r.t1, r.stage, r.end) == OK:
            settle_rates(e, r, rtol)
        return True
    r.vain_h = r.h
    r.vain_least = STALLS
    r.matrix = NO_MATRIX
    return False


def iterate_beside_edge(e: Engine, r: Radau, rtol: float) -> int:
    """Iterate the stages with one matrix, and with slopes for each where that does not serve.

    Nor does it where stages swing to and fro over an edge that is steep on both sides: within the
    tolerance, but far beside what holds it.
    """
    found = iterate_stages(e, r, rtol)
    if e.model.begins == 0 or e.slide.k > 0:
        return found
    s = e.step
    stuck = False
    swings = False
    if found == STAGES_CONVERGED:
        copy_part(r.n, r.y, 2 * r.n, r.stage, 0)
        within = rate_at(e, r.n, r.t1, r.stage, r.end) == OK
        if within and settle_rates(e, r, rtol):
            return STAGES_CONVERGED if factorise(r) != SINGULAR else STAGES_FAILED
        swings = within and s.left_edge and r.swings
        stuck = within and r.iterations == 1 and not s.left_edge and is_stuck(e, r)
        if within and not (stuck or swings):
            return found
        if not swings:
            found = STAGES_BEYOND
    # a motion that has not begun is led over no kink at which it does
    if (found != STAGES_BEYOND or s.on_edge) and not (stuck or s.left_edge):
        return found
    left = s.left_edge
    led = own_stages(e, r, rtol, 0.0 if left else STALLS)
    served = led and factorise(r) != SINGULAR
    if served and (left or rises(e, r)):
        s.left_edge = True
        s.calm = 0
        return STAGES_CONVERGED
    if served and stuck and not is_beside_edge(e, r):
        # one matrix was slow, and nothing ends near by: the stages are found
        return STAGES_CONVERGED
    # slopes of what was tried serve no step after this
    r.matrix = NO_MATRIX
    if swings and not led:
        # nothing better is found; the factors are still those of before
        return iterate_stages(e, r, rtol)
    if not left:
        # as if nothing had been tried
        r.served = 0.0
    return STAGES_BEYOND if swings else found


def rises(e: Engine, r: Radau) -> bool:
    """Whether a step leads away from all edges: what runs into one ends there by shorter steps.

    A valve that is shut all the time is at none.
    """
    m = e.model
    s = e.step
    n = r.n
    if evaluate(e, e.mode, e.v, r.t0, r.y0) != OK:
        return False
    for k in range(m.edges):
        s.edge_there[k] = value(m, m.edge_value[k], e.v)
    copy_part(n, r.y, 2 * n, r.shifted, 0)
    if evaluate(e, e.mode, e.v, r.t1, r.shifted) != OK:
        return False
    for k in range(m.edges):
        there = value(m, m.edge_value[k], e.v)
        if there < STAYS * s.edge_there[k] and not (there < 0.0 and s.edge_there[k] < 0.0):
            return False
    return True


def is_stuck(e: Engine, r: Radau) -> bool:
    """Whether the only correction has left most of what there was to correct, more than may be.

    Within one instant nothing is: there a motion may begin at a kink.
    """
    n = r.n
    if r.h <= room_of_instant(e, r.t0):
        return False
    for k in range(3 * n):
        r.z[k] -= r.last[k]
    before = most_left(r)
    for k in range(3 * n):
        r.z[k] += r.last[k]
    if not before > 1.0:
        return False
    return stage_rates(e, r) != OK or most_left(r) > LESSENS * before


def most_left(r: Radau) -> float:
    """Return the most that is left of the equations of a stage, over a step, in tolerances."""
    n = r.n
    take_all(r)
    put_left(r, r.swung)
    most = 0.0
    for k in range(3 * n):
        unit = r.tolerance[k % n]
        left = r.h * math.fabs(r.swung[k])
        if left > 0.0:
            most = max(most, left / unit if unit > 0.0 else math.inf)
    return most
