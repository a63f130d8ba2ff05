"""Rates along quantised states in a linear mode: an event of one costs what depends on that one.

The flow of the mode knows what depends on what. Its generators, which drive it, are not
quantised: they are known at all times, and are replaced by polynomials through their values at
Gauss nodes, for as long as what that does to a state is a small part of its quantum.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit_places, fit_rows, row_times
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.methods.linear.flow_records import Flow
from hybond.engine.methods.quantised.qss_nodes import node_at, through_nodes
from hybond.engine.methods.quantised.qss_room import Q, Quantised, X, take_size, time_ahead
from hybond.engine.surfaces.values import set_motion
from hybond.engine.words import Floats, float_table

REFRESH: Final = 64
"""Events, at least, after which rounding of what was added to rates is wiped out."""
DRIVEN: Final = 0.5
"""Part of its quantum that the polynomials of generators may move a state by."""
OFF: Final = float_table(1.0, 0.5, 0.25, 0.125)
"""How far a power is from its polynomial through 0 to 3 nodes, at the most."""
HALVINGS: Final = 1100
GROW: Final = 4.0
"""How much longer than the time before one may be."""
NEAR: Final = 100.0
"""What a time may be too long by for its lowest power to say by how much."""


def take_columns(a: Quantised, f: Flow) -> None:
    """Take the matrix of a flow, by rows and by columns, in the units of the states."""
    n = a.states
    take_size(a, f.n)
    entries = f.rows.first.at[f.n]
    fit_rows(a.rows, f.n, entries)
    fit_rows(a.columns, f.n, f.rows.first.at[n])
    fit_places(a.driven, n)
    for j in range(f.n + 1):
        a.rows.first.at[j] = f.rows.first.at[j]
        a.columns.first.at[j] = 0
    for i in range(f.n):
        for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
            j = f.rows.column.at[p]
            a.rows.column.at[p] = j
            a.rows.value.at[p] = f.rows.value.at[p] * f.scale.at[i] / f.scale.at[j]
    for i in range(n):
        a.diagonal[i] = 0.0
        a.driven.at[i] = a.rows.first.at[i]
        for p in range(a.rows.first.at[i], a.rows.first.at[i + 1]):
            j = a.rows.column.at[p]
            a.columns.first.at[j + 1] += 1
            if j < n:
                a.driven.at[i] = p + 1
            if j == i:
                a.diagonal[i] = a.rows.value.at[p]
    for j in range(f.n):
        a.columns.first.at[j + 1] += a.columns.first.at[j]
    for i in range(n):
        for p in range(a.rows.first.at[i], a.rows.first.at[i + 1]):
            j = a.rows.column.at[p]
            at = a.columns.first.at[j]
            a.columns.column.at[at] = i
            a.columns.value.at[at] = a.rows.value.at[p]
            a.columns.first.at[j] = at + 1
    # each now begins where the next one did
    for j in range(f.n, 0, -1):
        a.columns.first.at[j] = a.columns.first.at[j - 1]
    a.columns.first.at[0] = 0
    a.moving = entries > f.rows.first.at[n]


def add_column(a: Quantised, j: int) -> None:
    """Let what depends on a quantised state know that it has changed."""
    for p in range(a.columns.first.at[j], a.columns.first.at[j + 1]):
        i = a.columns.column.at[p]
        c = a.columns.value.at[p]
        for k in range(a.order):
            a.x[X * i + k + 1] += c * a.change.at[Q * j + k] / (float(k) + 1.0)
        a.marked[i] = 1


def wipe_rounding(a: Quantised, many: int) -> None:
    """Compute all rates anew, every so many events, of which `many` have been added."""
    a.added += many
    if a.added >= max(REFRESH, a.size):
        a.added = 0
        for k in range(a.order):
            linear_rates(a, k)


def linear_rates(a: Quantised, k: int) -> None:
    """Compute coefficient k of all rates from that of the quantised states."""
    for j in range(a.size):
        a.term.at[j] = a.q.at[Q * j + k]
    for i in range(a.states):
        a.x[X * i + k + 1] = row_times(a.rows, i, a.term.at) / (float(k) + 1.0)


def take_generators(e: Engine, a: Quantised, f: Flow) -> None:
    """Put the polynomials of generators there, for as long as they will do."""
    n = a.states
    read_generators(e, f, a.t, a.term.at, n, 1)
    h = time_of_generators(a, e.step.error) if a.moving else math.inf
    a.until = a.t + h
    for node in range(a.order if a.moving else 0):
        read_generators(e, f, a.t + node_at(a.order, node) * h, a.change.at, Q * n + node, Q)
    for j in range(n, a.size):
        moves = a.rows.first.at[j] < a.rows.first.at[j + 1]
        if moves:
            through_nodes(a.order, h, a.change.at, Q * j, 1, a.placed)
        for k in range(a.order):
            c = a.placed[k] if moves else a.term.at[j] if k == 0 else 0.0
            a.change.at[Q * j + k] = c - a.q.at[Q * j + k]
            a.q.at[Q * j + k] = c
        if moves:
            add_column(a, j)


def read_generators(e: Engine, f: Flow, t: float, out: Floats, at: int, width: int) -> None:
    """Put the values of generators at a time there, in columns of that width."""
    set_motion(e, e.v, t, e.step.y)
    for k in range(f.gens):
        out[at + width * k] = value(e.model, e.model.generator_value[f.gen[k]], e.v)


def time_of_generators(a: Quantised, total: Floats) -> float:
    """Return for how long polynomials of generators will do, their values being in `term`."""
    h = min(time_ahead(a, a.t), GROW * a.reach)
    for _ in range(HALVINGS):
        share = off_by_generators(a, h, total)
        if share <= 1.0:
            break
        h *= 0.9 * math.pow(share, -1.0 / float(a.order + 1)) if share < NEAR else 0.5
    a.reach = h
    return h


def off_by_generators(a: Quantised, h: float, total: Floats) -> float:
    """Return how far polynomials for a time `h` may move a state, in what they may.

    From the derivatives of what drives each state: so many that they cannot all be zero where
    generators leave their polynomials at all.
    """
    n = a.states
    c = a.power.at
    for i in range(n):
        total[i] = 0.0
    for j in range(n, a.size):
        c[j] = a.term.at[j]
    for order in range(1, a.order + a.size - n):
        for j in range(n, a.size):
            a.change.at[j] = h / float(order) * row_times(a.rows, j, c)
        for j in range(n, a.size):
            c[j] = a.change.at[j]
        if order < a.order:
            continue
        for i in range(n):
            driven = 0.0
            for p in range(a.driven.at[i], a.rows.first.at[i + 1]):
                driven += a.rows.value.at[p] * c[a.rows.column.at[p]]
            total[i] += OFF[a.order] * h * math.fabs(driven)
    share = 0.0
    for i in range(n):
        allowed = DRIVEN * a.quantum[i]
        if not total[i] <= share * allowed:
            share = total[i] / allowed if total[i] < math.inf else math.inf
    return share
