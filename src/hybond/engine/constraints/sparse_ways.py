"""Jumps of much that is tied together: what each storage moves by, solved for as it is.

A hundred wheels on one shaft, masses of a train that are coupled one after the other: every
impulse and every constraint has to do with few of them. In place of a basis of what may move, which
has to do with all, the unknowns are what each storage moves by and the free impulses of the power
structure, with an equation for each storage, that it moves by the impulses on it, and one for each
constraint. What is small keeps its digits beside what is large: its change is an unknown of its
own.

Few ways are found by singular values (`impulse_ways`), and so are those that leave shares open,
those of constraints that bend or read laws that are evaluated.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.products import copy_part
from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_sparse,
    solve_sparse,
    solve_transposed,
)
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.rows.storage import own_stiffness, stiff, with_stored
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.words import Floats

FEW: Final = 32
"""Free impulses below which singular values cost next to nothing."""


def find_sparse_ways(e: Engine, mode: Mode, x: Floats) -> bool:
    """Find the jumps of a mode in which much is tied; False if they are not such, or few."""
    m = e.model
    w = e.work
    ways = mode.ways
    count = w.constraints
    if not mode.free_sparse or mode.power_frees < FEW or m.groups > 0 or w.lefts > 0:
        return False
    if count != mode.power_frees or reads_stored(e, mode) or is_curved(e, mode):
        return False
    ways.many = mode.power_frees
    ways.shares = 0
    find_extents(e, x)
    list_moved(e, mode)
    fit(ways.extent, ways.areas + ways.many)
    fit_terms(e, mode)
    give_impulses(e, mode)
    give_constraints(e, mode, x)
    if not factor_sparse(ways.solver, w.factoring):
        return False
    fit(w.nu, ways.areas)
    fit(w.step, ways.areas)
    fit(w.combined, ways.many)
    ways.rank = count
    ways.sparse = True
    ways.known = True
    return True


def reads_stored(e: Engine, mode: Mode) -> bool:
    """Whether a constraint reads a source that moves with what is stored."""
    m = e.model
    for i in range(mode.constraints.first.at[mode.constraints.rows]):
        k = mode.constraints.column.at[i] - m.storages
        if k < 0 or k >= mode.sources or mode.source[k] < 0:
            continue
        s = mode.source[k]
        if m.source_value[s] >= 0 and m.source_timed[s] == 0:
            return True
    return False


def is_curved(e: Engine, mode: Mode) -> bool:
    """Whether a source that constraints may read is no linear function of what is stored."""
    m = e.model
    for k in range(mode.sources):
        s = mode.source[k]
        if s >= 0 and m.source_value[s] >= 0 and m.source_timed[s] == 0:
            if m.reasons == 0 or m.source_bent[s] != 0 or m.groups > 0:
                return True  # without forms slopes are difference quotients
            if e.work.lefts > 0 and mode.structures > 0:
                return True
    for i in range(mode.structures if e.work.lefts > 0 else 0):
        d = mode.dynamic[mode.structure[i]]
        if d >= 0 and m.dynamic_follows[d] != 0:
            return True
        if m.dynamic_source[d] != 0 and m.dynamic_affine[d] == 0:
            return True
    return False


def find_extents(e: Engine, x: Floats) -> None:
    """Find how much each storage may hold, into `e.work.extents`; 1 where nothing is known."""
    m = e.model
    w = e.work
    fit(w.extents, m.storages)
    for k in range(m.storages):
        size = size_held(e, x, k)
        w.extents.at[k] = size if size > 0.0 and math.isfinite(size) else 1.0


def size_held(e: Engine, x: Floats, k: int) -> float:
    """Return how much storage k holds, and would with the energy of its part."""
    own = math.fabs(own_stiffness(e.model, k, with_stored(e, x)))
    size = math.fabs(x[k])
    return size + e.work.reach[k] / own if own > 0.0 and math.isfinite(own) else size


def list_moved(e: Engine, mode: Mode) -> None:
    """List the storages that impulses move: an area each."""
    m = e.model
    ways = mode.ways
    rows = mode.free_rows
    fit_places(ways.moves_first, m.storages + 1)
    fit_places(ways.moves, m.storages)
    fit_places(ways.moved, m.storages)
    fit(ways.moves_by, m.storages)
    ways.areas = 0
    for k in range(m.storages):
        ways.moves_first.at[k] = ways.areas
        row = rate_bond(e.model, k)
        if rows.first.at[row] < rows.first.at[row + 1]:
            ways.moved.at[ways.areas] = k
            ways.moves.at[ways.areas] = ways.areas
            ways.moves_by.at[ways.areas] = 1.0
            ways.areas += 1
    ways.moves_first.at[m.storages] = ways.areas


def fit_terms(e: Engine, mode: Mode) -> None:
    """Begin the system, with room for all of its terms."""
    m = e.model
    ways = mode.ways
    terms = ways.areas
    for a in range(ways.areas):
        row = rate_bond(e.model, ways.moved.at[a])
        terms += mode.free_rows.first.at[row + 1] - mode.free_rows.first.at[row]
    for i in range(mode.constraints.first.at[mode.constraints.rows]):
        k = mode.constraints.column.at[i]
        terms += m.stiff_first[k + 1] - m.stiff_first[k] if k < m.storages else 0
    begin_system(ways.solver, ways.areas + ways.many, terms)


def give_impulses(e: Engine, mode: Mode) -> None:
    """Give the equation of each storage: it moves by the impulses on it.

    An impulse is measured by the largest of what it moves.
    """
    m = e.model
    ways = mode.ways
    rows = mode.free_rows
    for j in range(ways.many):
        ways.extent.at[ways.areas + j] = 0.0
    for a in range(ways.areas):
        k = ways.moved.at[a]
        ways.extent.at[a] = e.work.extents.at[k]
        row = rate_bond(e.model, k)
        for i in range(rows.first.at[row], rows.first.at[row + 1]):
            own = ways.areas + rows.column.at[i]
            size = ways.extent.at[a] / math.fabs(rows.value.at[i])
            ways.extent.at[own] = max(ways.extent.at[own], size)
    for j in range(ways.many):
        if ways.extent.at[ways.areas + j] == 0.0:
            ways.extent.at[ways.areas + j] = 1.0
    for a in range(ways.areas):
        k = ways.moved.at[a]
        row = rate_bond(e.model, k)
        sign = way_of_rate(m, k)
        add_term(ways.solver, a, ways.extent.at[a])
        for i in range(rows.first.at[row], rows.first.at[row + 1]):
            own = ways.areas + rows.column.at[i]
            add_term(ways.solver, own, -sign * rows.value.at[i] * ways.extent.at[own])
        end_equation(ways.solver)


def give_constraints(e: Engine, mode: Mode, x: Floats) -> None:
    """Give the equation of each constraint: what storages move by closes its gap."""
    m = e.model
    ways = mode.ways
    rows = mode.constraints
    values = with_stored(e, x)
    for i in range(rows.rows):
        for p in range(rows.first.at[i], rows.first.at[i + 1]):
            k = rows.column.at[p]
            if k >= m.storages:
                continue
            for q in range(m.stiff_first[k], m.stiff_first[k + 1]):
                s = m.stiff_other[q]
                a = ways.moves_first.at[s]
                if a < ways.moves_first.at[s + 1]:
                    factor = rows.value.at[p] * stiff(m, q, values)
                    add_term(ways.solver, a, factor * ways.extent.at[a])
        end_equation(ways.solver)


def sparse_step(e: Engine, ways: Ways, count: int) -> None:
    """Put Newton's step into `e.work.step`, and of the free impulses into `e.work.sent`."""
    w = e.work
    unknowns = ways.areas + ways.many
    fit(w.sides, unknowns)
    fit(w.found, unknowns)
    fit(w.sent, ways.many)
    for a in range(ways.areas):
        w.sides.at[a] = 0.0
    copy_part(count, w.gap.at, 0, w.sides.at, ways.areas)
    solve_sparse(ways.solver, w.factoring, w.sides.at, w.found.at)
    for a in range(ways.areas):
        w.step.at[a] = ways.extent.at[a] * w.found.at[a]
    for j in range(ways.many):
        own = ways.areas + j
        w.sent.at[j] = ways.extent.at[own] * w.found.at[own]


def sparse_shares(e: Engine, ways: Ways, k: int, count: int) -> None:
    """Put by how much a unit of each gap moves storage k into `e.work.row_size`."""
    w = e.work
    unknowns = ways.areas + ways.many
    fit(w.row_size, count)
    fit(w.sides, unknowns)
    fit(w.found, unknowns)
    for a in range(unknowns):
        w.sides.at[a] = 0.0
    a = ways.moves_first.at[k]
    if a < ways.moves_first.at[k + 1]:
        w.sides.at[a] = ways.extent.at[a]
    solve_transposed(ways.solver, w.factoring, w.sides.at, w.found.at)
    copy_part(count, w.found.at, ways.areas, w.row_size.at, 0)
