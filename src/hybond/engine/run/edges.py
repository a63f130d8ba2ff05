"""Edges of where laws have values: a root comes to nothing in a finite time, and stays there.

A tank drains by the root of its level. Where steps may try what is beyond, they end at the edge as
at a kink. Else no step reaches it: the steps become shorter as it comes nearer, and one beyond it
has no value. What is no time away from the edge is put there, and what no step can tell from it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.methods.one_instant import room_of_instant
from hybond.engine.mode.beyond import STEPS_ERR, size_of_edge
from hybond.engine.mode.values import evaluate, field
from hybond.engine.model import value
from hybond.engine.run.run_records import Run
from hybond.engine.words import Floats

NEARLY: Final = 1.0 - 1e-10
"""Part of the way that is gone where all of it leads beyond by rounding."""
ROUNDED: Final = 1e-15
"""Part of its terms that a difference of levels may be off by."""
LITTLE: Final = 0.1
"""Part of what a step may err by that is nothing beside it."""
AT_ONCE: Final = 1e-9
"""Part of the run within which an edge is reached at once, where no step is short enough."""
SOON: Final = 1e-4
"""Part of the run within which an edge is reached that is nearer than a step may err, likewise."""
PASSES: Final = 64
"""Times that it is gone: what is left is 1e-10 of what was, down to nothing."""


def reach_edges(e: Engine, r: Run) -> bool:
    """Put the state on the edges that it reaches within no time; whether it is there.

    Only where no step is short enough.
    """
    n = e.states
    refusal = e.refusal
    room = max(room_of_instant(e, e.t), AT_ONCE * e.until)
    if e.model.edges == 0 or e.slide.k > 0 or field(e, e.mode, e.t, e.y, r.rate) != OK:
        return False
    for i in range(n):
        r.beside[n + i] = 1.0 if math.fabs(e.y[i]) > room * math.fabs(r.rate[i]) else 0.0
    reached = False
    for k in range(e.model.edges):
        reached = reach_edge(e, r, k, room, False) or reached
    reached = vanish(e, r) or reached
    e.refusal = refusal and not reached
    return reached


def reach_near(e: Engine, r: Run, h: float) -> bool:
    """Put the state on edges that are nearer than a step may err, and less than such a step away.

    Implicit methods come ever nearer, by steps that grow ever shorter. Whether it is on one.
    """
    refusal = e.refusal
    reached = False
    for k in range(e.model.edges if e.slide.k == 0 else 0):
        left = way_to(e, k, e.y)
        if left > 0.0 and left <= e.model.rtol * e.edge_largest[k]:
            reached = reach_edge(e, r, k, h, True) or reached
            reached = reached or way_to(e, k, e.y) != left
            step_over(e, r, k)
    if reached:
        leave_nothing(e, r)
    e.refusal = refusal
    return reached


def leave_nothing(e: Engine, r: Run) -> None:
    """Let nothing be left of what is little beside what a step may err, on an edge."""
    refusal = e.refusal
    room = max(room_of_instant(e, e.t), AT_ONCE * e.until)
    if e.slide.k == 0 and field(e, e.mode, e.t, e.y, r.rate) == OK:
        for i in range(e.states):
            own = math.fabs(e.y[i])
            keeps = own > room * math.fabs(r.rate[i])
            if keeps and own <= LITTLE * e.model.rtol * e.largest_state[i]:
                keeps = not decides_edge(e, r, i)
            r.beside[e.states + i] = 1.0 if keeps else 0.0
        vanish(e, r)
        for k in range(e.model.edges):
            step_over(e, r, k)
    e.refusal = refusal


def decides_edge(e: Engine, r: Run, i: int) -> bool:
    """Whether an edge that the state is on, as far as steps can tell, is one of that quantity."""
    for k in range(e.states):
        r.beside[k] = e.y[k] if k != i else 0.0
    found = False
    for k in range(e.model.edges):
        here = way_to(e, k, e.y)
        near = math.fabs(here) <= e.model.rtol * e.edge_largest[k]
        found = found or (near and way_to(e, k, r.beside) != here)
    return found


def step_over(e: Engine, r: Run, k: int) -> None:
    """Go on to just behind an edge that only rounding of larger values keeps the state before.

    Two tanks are level but for their last digit, the root of which would flow to and fro for ever.
    """
    left = way_to(e, k, e.y)
    least = ROUNDED * size_of_edge(e, e.mode, k, e.v)
    if left <= 0.0 or left > least or field(e, e.mode, e.t, e.y, r.rate) != OK:
        return
    h = room_of_instant(e, e.t)
    for _ in range(PASSES):
        for i in range(e.states):
            r.beside[i] = e.y[i] + h * r.rate[i]
        there = way_to(e, k, r.beside)
        if not math.fabs(there) <= least:
            return
        if there <= 0.0:
            for i in range(e.states):
                e.y[i] = r.beside[i]
            return
        h = 2.0 * h


def vanish(e: Engine, r: Run) -> bool:
    """Let nothing be left of what comes to nothing within no time, if laws have values then.

    Two tanks run empty together: of the upper one no rounding is left to be filled from below.
    """
    n = e.states
    changed = False
    for i in range(n):
        r.beside[i] = e.y[i] if r.beside[n + i] != 0.0 else 0.0
        changed = changed or r.beside[i] != e.y[i]
    changed = changed and is_inside(e, r.beside)
    if changed and field(e, e.mode, e.t, r.beside, r.rate) == OK:
        # what is drawn on from there is not put there again and again
        room = max(room_of_instant(e, e.t), AT_ONCE * e.until)
        for i in range(n):
            r.rate[i] = r.beside[i] + room * r.rate[i]
        changed = is_inside(e, r.rate)
    for i in range(n if changed else 0):
        e.y[i] = r.beside[i]
    return changed


def is_inside(e: Engine, y: Floats) -> bool:
    """Whether a state is beyond no edge."""
    for k in range(e.model.edges):
        if not way_to(e, k, y) >= 0.0:
            return False
    return True


def reach_edge(e: Engine, r: Run, k: int, room: float, near: bool) -> bool:
    """Put the state on an edge; False where it is too far, or would not rest there.

    With `near` no stored quantity moves by more than some steps may err.
    """
    moved = False
    for _ in range(PASSES):
        left = way_to(e, k, e.y)
        if not left > 0.0 or field(e, e.mode, e.t, e.y, r.rate) != OK:
            return moved and left == 0.0
        # seen from where the motion comes from: there it has values
        for i in range(e.states):
            r.beside[i] = e.y[i] - room * r.rate[i]
        speed = (way_to(e, k, r.beside) - left) / room
        if not (speed > 0.0 and left <= speed * room):
            return False
        whole = left / speed
        for i in range(e.states if near else 0):
            if math.fabs(whole * r.rate[i]) > STEPS_ERR * e.model.rtol * e.largest_state[i]:
                return moved
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
    return True


def way_to(e: Engine, k: int, y: Floats) -> float:
    """Return how far a state is from an edge; below zero beyond it, where there is no value."""
    if evaluate(e, e.mode, e.v, e.t, y) != OK:
        return -1.0
    return value(e.model, e.model.edge_value[k], e.v)
