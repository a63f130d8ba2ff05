"""What the unknowns of a step are measured by, by what is there, and hangs together."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import OK, Engine
from hybond.engine.laws.law_instant import NO_LAW_VALUE, quantity
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import open_mode, partner_row
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.model import Model
from hybond.engine.timestepping.matrices import NEARBY, rates_at
from hybond.engine.timestepping.step_records import Coupled, Stepping
from hybond.engine.words import Floats

ROUNDED_PART: Final = 1e-14
"""Part of the terms of a law's `w` that rounding leaves of it in a few operations."""

OF_QUOTIENTS: Final = EPSILON / NEARBY
"""Part of what is there that quotients of differences leave of a slope that is none."""


def measure_step(e: Engine, s: Stepping, p: Ports, h: float) -> None:
    """Find what each unknown is measured by: itself, its motion, what the energy would make."""
    m = e.model
    reach_of(e, open_mode(e, p), e.y, s.reach)
    most = e.work.part_here
    for i in range(e.parts):
        most[i] = 0.0
    for k in range(e.states):
        s.weight[k] = math.fabs(e.y[k]) + h * math.fabs(s.rate0[k])
        if k < m.storages:
            i = e.storage_part[k]
            s.weight[k] = max(s.weight[k], s.reach[k])
            most[i] = max(most[i], s.weight[k])
    largest = 0.0
    for k in range(m.storages):
        s.weight[k] = max(s.weight[k], 1e-3 * most[e.storage_part[k]])
        largest = max(largest, s.weight[k])
    # signals move as what is stored would move them by its own measure, though it may be at rest
    for k in range(e.states):
        s.move[k] = e.y[k] + (s.weight[k] if k < m.storages else 0.0)
    if m.integrals > 0 and rates_at(e, s, p, s.move, s.nothing, s.rate) == OK:
        for k in range(m.integrals):
            at = m.storages + k
            s.weight[at] = max(s.weight[at], h * math.fabs(s.rate[at]))
    signals = 0.0
    for k in range(m.integrals):
        signals = max(signals, s.weight[m.storages + k])
    largest = max(largest, signals)
    for k in range(e.states):
        if not s.weight[k] > 0.0:
            beside = signals if k < m.storages else largest
            s.weight[k] = 1e-3 * beside if beside > 0.0 else 1.0
    measure_laws(e, s, p)


def measure_bonds(m: Model, s: Stepping, one: Floats, other: Floats) -> None:
    """Find the largest effort and flow on each island, of two sets of bond variables."""
    for i in range(m.islands):
        s.most_effort[i] = 0.0
        s.most_flow[i] = 0.0
    for b in range(m.bonds):
        i = m.bond_island[b]
        effort = max(math.fabs(one[b]), math.fabs(other[b]))
        flow = max(math.fabs(one[m.bonds + b]), math.fabs(other[m.bonds + b]))
        s.most_effort[i] = max(s.most_effort[i], effort)
        s.most_flow[i] = max(s.most_flow[i], flow)


def gives_effort(m: Model, p: Ports, k: int) -> bool:
    """Whether what the law of port k gives is an effort."""
    return (m.junction_kind[m.port_junction[k]] == 0) == (p.given[k] == COMMON)


def measure_laws(e: Engine, s: Stepping, p: Ports) -> None:
    """Find what that which a law gives is measured by: the largest effort or flow on its island.

    Friction is able to hold its limit. Where everything is at rest what it gives is rounding of
    that, and all else there is no more.
    """
    m = e.model
    measure_bonds(m, s, s.w, s.w)
    for i in range(m.islands):
        s.ever_effort[i] = max(s.ever_effort[i], s.most_effort[i])
        s.ever_flow[i] = max(s.ever_flow[i], s.most_flow[i])
    for k in range(m.ports):
        i = island_of_port(m, k)
        size = s.most_effort[i] if gives_effort(m, p, k) else s.most_flow[i]
        s.unit[k] = size if size > 0.0 else 1.0
        s.able[k] = s.unit[k]
        if m.port_limit[k] != NO_LAW_VALUE and p.given[k] != COMMON:
            limit = math.fabs(quantity(m, m.port_limit, m.port_limit_constant, k, s.v0))
            s.able[k] = max(s.able[k], limit if math.isfinite(limit) else 0.0)


def island_of_port(m: Model, k: int) -> int:
    """Return the island of the junction of port k; of one without bonds the first."""
    at = m.end_first[m.port_junction[k]]
    return m.bond_island[m.end_bond[at]] if at < m.end_first[m.port_junction[k] + 1] else 0


def measure_rounding(m: Model, s: Stepping, p: Ports, c: Coupled) -> None:
    """Find what rounding of its `w` makes of each law's `l`.

    It is all that friction has that carries nothing: what rolls freely is held together by forces
    that are rounding of its speed, over the little by which a force changes that in a step.
    """
    n = m.ports
    for k in range(n):
        size = 0.0
        row = partner_row(p, k)
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            b = m.pair_column[i]
            terms = math.fabs(s.mean[b]) + math.fabs(s.base[b])
            for z in range(c.n):
                terms += math.fabs(c.state.at[b * c.n + z] * s.y[z])
            size += math.fabs(m.pair_value[i]) * terms
        own = math.fabs(c.m.at[k * n + k])
        s.rounded[k] = ROUNDED_PART * size / own if own > 0.0 else 0.0
        i = island_of_port(m, k)
        there = s.most_flow[i] if gives_effort(m, p, k) else s.most_effort[i]
        if own * s.able[k] <= OF_QUOTIENTS * there:
            s.rounded[k] = math.inf
