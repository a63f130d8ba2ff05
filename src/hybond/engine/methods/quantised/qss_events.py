"""Quantum events: quantised states that start anew, whom that concerns, and when the next come."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.methods.quantised.qss_band import leaves_band
from hybond.engine.methods.quantised.qss_fit import ask_ahead
from hybond.engine.methods.quantised.qss_linear import (
    add_column,
    linear_rates,
    take_generators,
    wipe_rounding,
)
from hybond.engine.methods.quantised.qss_place import place_ahead
from hybond.engine.methods.quantised.qss_room import Q, Quantised, X
from hybond.engine.methods.tolerances.scale import tolerance

SWEEPS: Final = 3
"""Times that all linearly implicit quantised states are placed at a start."""


def quantise_all(e: Engine, a: Quantised) -> None:
    """Quantise all states anew where the next step begins, as at an event of all of them.

    In a mode that is not linear ``e.step.f`` are the rates there.
    """
    s = e.step
    a.t = s.t
    a.h = 0.0
    a.moved = -1
    a.crowded = 0
    for i in range(a.states):
        a.x[X * i] = s.y[i]
        a.x[X * i + 1] = s.f[i]
        a.touches[i] = math.inf
        a.marked[i] = 1
    if a.linear:
        # nobody listens yet
        take_generators(e, a, e.exact.flow)
    elif a.order > 2:
        known = ask_ahead(e, a) == OK
        for i in range(a.states):
            a.x[X * i + 2] = 0.5 * a.rate[i] if known else 0.0
    for k in range(a.order):
        for i in range(a.states):
            a.q.at[Q * i + k] = a.x[X * i + k]
        if a.linear:
            linear_rates(a, k)
    a.added = 0
    a.stale = not a.linear
    for _ in range(SWEEPS if a.implicit else 0):
        for i in range(a.states):
            place_quantised(a, i)


def place_quantised(a: Quantised, i: int) -> None:
    """Place the linearly implicit quantised state of `i`."""
    feedback = a.diagonal[i]
    for k in range(a.order):
        a.wanted[k] = (float(k) + 1.0) * a.x[X * i + k + 1] - feedback * a.q.at[Q * i + k]
    h = place_ahead(a.x[X * i], a.order, a.wanted, feedback, a.quantum[i], a.ahead, a.placed)
    a.touches[i] = a.t + h
    for k in range(a.order):
        a.change.at[Q * i + k] = a.placed[k] - a.q.at[Q * i + k]
        a.q.at[Q * i + k] = a.placed[k]
        if not a.linear:
            # what it does to itself; what it does to others is asked before the next step
            a.x[X * i + k + 1] += feedback * a.change.at[Q * i + k] / (float(k) + 1.0)
    if a.linear:
        add_column(a, i)
    a.marked[i] = 1


def let_happen(e: Engine, a: Quantised) -> None:
    """Make the quantum events of the states that are due."""
    many = 0
    scale = e.step.scale
    tolerance(e, e.step.y, e.step.y, scale)
    for i in range(a.states):
        if a.due[i] == 0:
            continue
        many += 1
        a.moved = i
        a.marked[i] = 1
        a.quantum[i] = max(scale[i], a.floor[i])
        if a.implicit:
            place_quantised(a, i)
            continue
        # all of them from where they were before any of them
        for k in range(a.order):
            a.change.at[Q * i + k] = a.x[X * i + k] - a.q.at[Q * i + k]
            a.q.at[Q * i + k] = a.x[X * i + k]
    if many == 1:
        a.moved_by = a.change.at[Q * a.moved]
    else:
        a.moved = -1
    a.stale = not a.linear
    if not a.linear:
        return
    for i in range(a.states):
        if a.due[i] != 0 and not a.implicit:
            add_column(a, i)
    # not between columns: what is computed anew holds all changes, and would take the rest twice
    wipe_rounding(a, many)


def foresee(a: Quantised) -> None:
    """Compute when those states have their next events whose motion or quantum has changed."""
    for i in range(a.states):
        if a.marked[i] == 0:
            continue
        a.marked[i] = 0
        x = X * i
        q = Q * i
        d1 = a.x[x + 1]
        d2 = 0.0
        d3 = 0.0
        if a.order > 1:
            d1 -= a.q.at[q + 1]
            d2 = a.x[x + 2]
        if a.order > 2:
            d2 -= a.q.at[q + 2]
            d3 = a.x[x + 3]
        s = leaves_band(a.x[x] - a.q.at[q], d1, d2, d3, a.quantum[i])
        a.leaves[i] = min(a.t + s, a.touches[i])


def foresee_all(a: Quantised) -> None:
    """Compute when all states have their next events."""
    for i in range(a.states):
        a.marked[i] = 1
    foresee(a)


def next_event(a: Quantised) -> float:
    """Return the time of the next quantum event, infinity if there is none."""
    first = math.inf
    for i in range(a.states):
        first = min(first, a.leaves[i])
    return first
