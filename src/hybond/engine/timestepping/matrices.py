"""The matrices of a step: made once for a configuration and a length where all is linear.

With ``r`` the rates of the state and ``w`` bond variables, both by the state Y and by what the laws
give, ``l``, a step solves::

    Y - Y0 - h [ r(Y, l) - (1 - theta) (r(Y, 0) - r(Y0, 0)) ] = 0

Where only laws are not linear, the slopes are those of the eliminated rows. Elsewhere they are
difference quotients, renewed when Newton is slow.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, fit
from hybond.engine.algebra.lu import SINGULAR, lu_invert
from hybond.engine.algebra.products import copy_floats, copy_part, largest, times_matrix
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import (
    open_mode,
    partner_row,
    partner_way,
    rates_of_stored,
    solve_with,
)
from hybond.engine.laws.response import find_gains
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton import by_knowns
from hybond.engine.model import Model
from hybond.engine.timestepping.ringing import IDLE_PART, loses_laws, turns_back
from hybond.engine.timestepping.step_records import (
    COUPLED_KEPT,
    NOT_LOOKED,
    Coupled,
    Stepping,
    make_coupled,
)
from hybond.engine.words import Floats, Ints, some

DOUBTFUL_PIVOT: Final = 1e-8
"""Part of the largest entry of its row below which a pivot may have lost its sign to rounding."""
NEARBY: Final = 1e-7
"""Difference quotients: part of a variable's size."""


def take_coupled(e: Engine, s: Stepping, p: Ports, h: float) -> Coupled:
    """Return the matrices of steps of length `h`; where the graph is linear they are known then."""
    e.clock += 1
    oldest = 0
    for k in range(s.made):
        c = some(s.couples[k])
        same = c.place == p.place and c.stamp == p.stamp
        if same and c.h == h and c.theta == s.theta:
            c.used = e.clock
            return c
        if c.used < some(s.couples[oldest]).used:
            oldest = k
    if s.made < COUPLED_KEPT:
        oldest = s.made
        s.couples[oldest] = make_coupled(e.model.ports)
        s.made += 1
    c = some(s.couples[oldest])
    c.place = p.place
    c.stamp = p.stamp
    c.h = h
    c.theta = s.theta
    c.used = e.clock
    c.known = False
    c.straight = is_straight(e.model, open_mode(e, p))
    c.n = e.model.storages if c.straight else e.states
    return c


def is_straight(m: Model, mode: Mode) -> bool:
    """Whether a step is linear but for the laws: the state acts through matrices alone."""
    if m.groups > 0 or m.signals_act != 0:
        return False
    if mode.dynamics > 0 and not (mode.affine and mode.rank == mode.structures):
        return False
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0 and m.dynamic_fixed[mode.dynamic[i]] == 0:
            return False
    for k in range(mode.sources):
        source = mode.source[k]
        if source >= 0 and m.source_value[source] >= 0 and m.source_timed[source] == 0:
            return False
    for k in range(m.ports):
        if m.port_affine[k] == 0:
            return False
    return True


def find_straight(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Find the slopes of a linear graph, and what follows."""
    m = e.model
    mode = open_mode(e, p)
    bonds = 2 * m.bonds
    fit(c.state, bonds * max(c.n, 1))
    fit(c.direct, bonds * max(m.ports, 1))
    v = s.v1
    for k in range(2 * m.slots):
        v[k] = 0.0
    if find_gains(e, e.laws, p, v, c.direct.at) != OK:
        return REFUSED
    if mode.dynamics == 0:
        for z in range(mode.knowns):
            e.work.xi[z] = 0.0
        for j in range(c.n):
            for z in range(c.n):
                e.work.xi[z] = 0.0
                for i in range(m.stiff_first[z], m.stiff_first[z + 1]):
                    if m.stiff_other[i] == j:
                        e.work.xi[z] += m.stiff_constant[i]
            by_knowns(e, mode, mode.direct, e.work.w)
            for b in range(bonds):
                c.state.at[b * c.n + j] = e.work.w[b]
    else:
        # constant rows: what storage gives by itself, put through them one quantity at a time
        if solve_with(e, p, v, s.nothing) != OK:
            return REFUSED
        copy_floats(bonds, e.work.w, s.base)
        for j in range(c.n):
            v[m.stored_slot + j] = 1.0
            if solve_with(e, p, v, s.nothing) != OK:
                return REFUSED
            v[m.stored_slot + j] = 0.0
            for b in range(bonds):
                c.state.at[b * c.n + j] = e.work.w[b] - s.base[b]
    fit(s.square, c.n * c.n + c.n * m.ports)
    for j in range(c.n):
        rates_of_stored(m, c.state.at, c.n, j, s.square.at)
    for i in range(c.n * c.n):
        s.square.at[i] *= s.theta
    fit(c.push, c.n * max(m.ports, 1))
    for j in range(m.ports):
        rates_of_stored(m, c.direct.at, m.ports, j, c.push.at)
    return invert_step(e, s, p, c)


def rates_at(e: Engine, s: Stepping, p: Ports, y: Floats, l: Floats, rate: Floats) -> int:
    """Put the rates of the whole state at the end of a step there; values stand in `s.v1`."""
    m = e.model
    copy_part(m.storages, y, 0, s.v1, m.stored_slot)
    copy_part(m.integrals, y, m.storages, s.v1, m.signal_slot)
    if solve_with(e, p, s.v1, l) != OK:
        return REFUSED
    rates_of_stored(m, e.work.w, 1, 0, rate)
    for k in range(m.integrals):
        rate[m.storages + k] = value(m, m.integral_rate[k], s.v1)
    return OK


def implicit(e: Engine, s: Stepping, p: Ports, y: Floats, l: Floats) -> int:
    """Put what the end adds to a step, as a rate, into `s.rate`.

    Bond variables stand in ``e.work.w``, those without `l` in `s.without`.
    """
    if rates_at(e, s, p, y, s.nothing, s.rate) != OK:
        return REFUSED
    acts = False
    copy_floats(2 * e.model.bonds, e.work.w, s.without)
    for k in range(e.model.ports):
        acts = acts or l[k] != 0.0
    if not acts:
        for k in range(e.states):
            s.rate[k] *= s.theta
        return OK
    if rates_at(e, s, p, y, l, s.rate_l) != OK:
        return REFUSED
    for k in range(e.states):
        s.rate[k] = s.rate_l[k] - (1.0 - s.theta) * s.rate[k]
    return OK


def find_slopes(
    e: Engine, s: Stepping, p: Ports, c: Coupled, y: Floats, l: Floats, nearby: float
) -> int:
    """Find the slopes of a nonlinear graph at a point, as difference quotients.

    They are taken over `nearby` as part of a state's size, and no less than `NEARBY` of itself.
    """
    m = e.model
    n = c.n
    bonds = 2 * m.bonds
    fit(c.state, bonds * max(n, 1))
    fit(c.direct, bonds * max(m.ports, 1))
    fit(c.push, n * max(m.ports, 1))
    fit(s.square, n * n + n * m.ports)
    if implicit(e, s, p, y, l) != OK:
        return REFUSED
    copy_floats(bonds, e.work.w, s.base)
    copy_floats(n, s.rate, s.change)
    for j in range(n + m.ports):
        of_state = j < n
        at = j if of_state else j - n
        here = y[at] if of_state else l[at]
        size = s.weight[at] if of_state else 1e3 * s.unit[at]
        # units are of the beginning of the step, when nothing may have pushed
        part = nearby if of_state else NEARBY
        there = here + max(part * size, NEARBY * math.fabs(here))
        if of_state:
            y[at] = there
        else:
            l[at] = there
        found = implicit(e, s, p, y, l)
        if of_state:
            y[at] = here
        else:
            l[at] = here
        if found != OK:
            return REFUSED
        step = there - here
        for k in range(n):
            slope = (s.rate[k] - s.change[k]) / step
            if of_state:
                s.square.at[k * n + at] = slope
            else:
                c.push.at[k * m.ports + at] = slope
        for b in range(bonds):
            slope = (e.work.w[b] - s.base[b]) / step
            if of_state:
                c.state.at[b * n + at] = slope
            else:
                c.direct.at[b * m.ports + at] = slope
    return invert_step(e, s, p, c)


def invert_step(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Solve a step for its end: `s.square` are the rates by the state, `c.push` those by `l`."""
    m = e.model
    n = c.n
    bonds = 2 * m.bonds
    fit(c.inverse, n * n)
    fit(c.gain, bonds * max(m.ports, 1))
    for i in range(n * n):
        s.square.at[i] *= -c.h
    for k in range(n):
        s.square.at[k * n + k] += 1.0
    for k in range(n):
        s.change[k] = 0.0
        for j in range(n):
            s.change[k] = max(s.change[k], math.fabs(s.square.at[k * n + j]))
    if lu_invert(n, s.square.at, s.row, c.inverse.at) == SINGULAR:
        why = "a step of this length has no end: its equations are singular"
        return say_fault(e, "HB-N310", why, "")
    c.outgrown = is_negative(n, s.square.at, s.row, s.change)
    c.rings = turns_back(n, c.inverse.at, 1.0 - c.theta, s.square.at)
    for i in range(n * m.ports):
        s.square.at[n * n + i] = c.h * c.push.at[i]
    for i in range(n):
        for j in range(m.ports):
            total = 0.0
            for k in range(n):
                total += c.inverse.at[i * n + k] * s.square.at[n * n + k * m.ports + j]
            c.push.at[i * m.ports + j] = total
    put_columns(n, n, c.inverse.at, c.inverse_columns)
    put_columns(n, m.ports, c.push.at, c.push_columns)
    times_matrix(bonds, n, m.ports, c.state.at, c.push.at, c.gain.at)
    for i in range(bonds * m.ports):
        c.gain.at[i] += c.direct.at[i]
    couple_laws(m, p, c)
    fit(s.square, m.ports * m.ports)
    c.lost = loses_laws(m, s, p, c)
    s.numbers += 1
    c.number = s.numbers
    c.semidefinite = NOT_LOOKED
    c.still = NOT_LOOKED
    c.known = True
    return OK


def put_columns(m: int, n: int, a: Floats, columns: Block) -> None:
    """Put the n columns of `a`, which has m rows, one after the other."""
    fit(columns, max(m * n, 1))
    for i in range(m):
        for j in range(n):
            columns.at[j * m + i] = a[i * n + j]


def is_negative(n: int, factor: Floats, row: Ints, size: Floats) -> bool:
    """Whether a determinant is negative beyond doubt; `size` are the largest entries of rows.

    Where nothing grows it is one and more. What grows by itself faster than in the length of a step
    makes it pass through zero: backward Euler would let that decay.
    """
    odd = False
    for k in range(n):
        p = row[k]
        if p != k:
            odd = not odd
            kept = size[k]
            size[k] = size[p]
            size[p] = kept
        pivot = factor[k * n + k]
        if pivot < 0.0:
            odd = not odd
        if math.fabs(pivot) <= DOUBTFUL_PIVOT * size[k]:
            return False
    return odd


def couple_laws(m: Model, p: Ports, c: Coupled) -> None:
    """Find how laws feel each other; what cancels, by the size of its terms, is nothing.

    Laws between coils in series cancel; none is to be bought with what is left.
    """
    n = m.ports
    for k in range(n):
        row = partner_row(p, k)
        way = partner_way(p, k)
        for j in range(n):
            total = 0.0
            size = 0.0
            for i in range(m.pair_first[row], m.pair_first[row + 1]):
                b = m.pair_column[i]
                total += m.pair_value[i] * c.gain.at[b * n + j]
                terms = math.fabs(c.direct.at[b * n + j])
                for z in range(c.n):
                    push = c.push.at[z * n + j]
                    terms += math.fabs(c.state.at[b * c.n + z]) * math.fabs(push)
                size += math.fabs(m.pair_value[i]) * terms
            rounded = math.fabs(total) <= CANCELS * size
            c.m.at[k * n + j] = 0.0 if rounded else way * total
    most = largest(n * n, c.m.at)
    for k in range(n):
        idle = True
        for j in range(n):
            idle = idle and math.fabs(c.m.at[k * n + j]) <= IDLE_PART * most
            idle = idle and math.fabs(c.m.at[j * n + k]) <= IDLE_PART * most
        c.idle[k] = 1 if idle else 0
    for k in range(n):
        deaf = True
        for j in range(n):
            if c.idle[k] != 0 or c.idle[j] != 0:
                c.m.at[k * n + j] = 0.0
            deaf = deaf and c.m.at[k * n + j] == 0.0
        c.deaf[k] = 1 if deaf else 0
    for k in range(n):
        feels = c.deaf[k] == 0
        for j in range(n):
            feels = feels or c.m.at[j * n + k] != 0.0
        c.idle[k] = 0 if feels else 1
