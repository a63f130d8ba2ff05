"""Edges of where laws have values: a root comes to nothing in a finite time, and stays there.

A tank drains by the root of its level. No step reaches the edge: the steps become shorter as it
comes nearer, and one beyond it has no value. What is no time away from it is put there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.functions import BELOW
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.mode.digits.sizes import sizes_of
from hybond.engine.run.run_records import Run
from hybond.engine.run.within_error import stop_within_error
from hybond.engine.surfaces.values import evaluate, field
from hybond.engine.words import Floats

NEARLY: Final = 1.0 - 1e-10
"""Part of the way that is gone where all of it leads beyond by rounding."""
AT_ONCE: Final = 1e-9
"""Part of the run within which an edge is reached at once, where no step is short enough."""
LEVEL: Final = BELOW
"""What is this near to an edge, as a part of its terms, is there as soon as it comes nearer: of
many tanks that come to rest together no rounding goes to and fro."""
CROWDED: Final = 1e-6
"""Part of the run that is next to none for as many steps, ..."""
STEPS: Final = 16
"""... which are at least so many."""
PASSES: Final = 64
"""Times that it is gone: what is left is 1e-10 of what was, down to nothing."""


def reach_edges(e: Engine, r: Run) -> bool:
    """Put the state on the edges that it reaches within almost no time; whether it is there.

    Only where no step is short enough.
    """
    n = e.states
    refusal = e.refusal
    room = time_at_once(e)
    if e.model.edges == 0 or e.slide.k > 0 or field(e, e.mode, e.t, e.y, r.rate) != OK:
        return False
    r.edge_time = 0.0
    for i in range(n):
        r.edge_from[i] = e.y[i]
        goes = e.y[i] * r.rate[i] <= 0.0 and math.fabs(e.y[i]) <= room * math.fabs(r.rate[i])
        r.beside[n + i] = 0.0 if goes else 1.0
    reached = False
    for k in range(e.model.edges):
        reached = reach_edge(e, r, k, room) or reached
    reached = vanish(e, r) or reached
    reached = reached or stop_within_error(e, r.resting, True)
    e.refusal = refusal and not reached
    return reached


def straight_on(e: Engine, r: Run) -> bool:
    """Let the last step be the way to the edges, a straight line; whether it takes any time."""
    t1 = e.t + r.edge_time
    if not (t1 > e.t and t1 < min(e.next_break, e.stop)):
        return False
    step_straight(e, t1, r.edge_from, e.y)
    return True


def step_straight(e: Engine, t1: float, y0: Floats, y1: Floats) -> None:
    """Let the last step be a straight line from now on."""
    s = e.step
    n = e.states
    s.t0 = e.t
    s.t1 = t1
    e.curved = True
    for k in range(n):
        s.y0[k] = y0[k]
        s.y1[k] = y1[k]
        s.dense[k] = y1[k] - y0[k]
        for p in range(1, 4):
            s.dense[p * n + k] = 0.0


def time_at_once(e: Engine) -> float:
    """Return how long what reaches an edge may still be on its way."""
    return max(room_of_instant(e, e.t), AT_ONCE * e.span)


def vanish(e: Engine, r: Run) -> bool:
    """Let nothing be left of what comes to nothing within no time, if laws have values then.

    Two tanks run empty together: of the upper one no rounding is left to be filled from below.
    """
    n = e.states
    changed = False
    for i in range(n):
        r.beside[i] = e.y[i] if r.beside[n + i] != 0.0 else 0.0
        changed = changed or r.beside[i] != e.y[i]
    for k in range(e.model.edges):
        changed = changed and way_to(e, k, r.beside) >= 0.0
    for i in range(n if changed else 0):
        e.y[i] = r.beside[i]
    return changed


def rest_where_steps_crowd(e: Engine, r: Run) -> bool:
    """Put what is within the error of a step at rest on edges where steps crowd; whether it is.

    Of levels that are nothing within that error, rounding of a step makes flows to and fro. It is
    asked less and less often where they do not rest.
    """
    if e.model.edges == 0 or e.slide.k > 0:
        return False
    s = r.resting
    s.steps += 1
    if s.steps < s.waits:
        return False
    crowded = e.t - s.since <= CROWDED * e.span
    refusal = e.refusal
    rests = crowded and stop_within_error(e, s, False)
    e.refusal = refusal
    r.locator.looked = math.nan
    s.waits = 2 * s.waits if crowded and not rests else STEPS
    s.steps = 0
    s.since = e.t
    return rests


def reach_edge(e: Engine, r: Run, k: int, room: float) -> bool:
    """Put the state on an edge; False where it is too far, or would not rest there."""
    moved = False
    for _ in range(PASSES):
        left = way_to(e, k, e.y)
        if not left > 0.0 or field(e, e.mode, e.t, e.y, r.rate) != OK:
            return moved and left == 0.0
        # seen from where the motion comes from: there it has values
        for i in range(e.states):
            r.beside[i] = e.y[i] - room * r.rate[i]
        speed = (way_to(e, k, r.beside) - left) / room
        if not (speed > 0.0 and (left <= speed * room or left <= rounding_at(e, k, e.y))):
            return False
        whole = left / speed
        moved = go(e, r, k, whole) or go(e, r, k, NEARLY * whole)
        if not moved:
            return False
    return False


def go(e: Engine, r: Run, k: int, h: float) -> bool:
    """Go on by the rates for a time, if laws have values there."""
    for i in range(e.states):
        r.beside[i] = e.y[i] + h * r.rate[i]
    if not way_to(e, k, r.beside) >= 0.0:
        return False
    for i in range(e.states):
        e.y[i] = r.beside[i]
    r.edge_time += h
    return True


def way_to(e: Engine, k: int, y: Floats) -> float:
    """Return how far a state is from an edge; below zero beyond it, where there is no value."""
    if evaluate(e, e.mode, e.v, e.t, y) != OK:
        return -1.0
    return value(e.model, e.model.edge_value[k], e.v)


def rounding_at(e: Engine, k: int, y: Floats) -> float:
    """Return what is rounding of the terms that the way to an edge is a sum of."""
    m = e.model
    if evaluate(e, e.mode, e.v, e.t, y) != OK:
        return 0.0
    sizes_of(e, e.mode, e.v)
    for i in range(m.edge_bonds):
        b = m.edge_bond[i]
        e.v[m.bond_slot + b] = e.work.sizes[b]
    return LEVEL * value(m, m.edge_size[k], e.v)
