"""What rounding of the unknowns that Newton finds is measured by: the terms they were solved from.

A current that laws make zero is a difference of others: its own value is but their rounding. To
first order an unknown moves by the inverse of the Jacobian times what rounding leaves in each
residual, which is a part of the sizes of its terms.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places, row_size
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.digits.chords import bound_by_chords
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton_step import CLEAR_PIVOT, least_pivot
from hybond.engine.mode.nonlinear.newton_system import rows_of_system, write_bonds
from hybond.engine.mode.nonlinear.sparse_step import factor_slopes, put_inverse_row
from hybond.engine.words import Floats

LEAST_WAY: Final = 1e-300
"""How far unknowns that are zero are moved by rounding, at the least."""
HALVED: Final = 16
"""How often the orders of magnitude between two ways are halved."""
SAYS_SAME: Final = 4.0
"""Times which two ways may differ that are the same but for rounding of what makes them."""
FLAT_THERE: Final = -1
STEEP_THERE: Final = 0
SLOPES_THERE: Final = 1


def solved_sizes(e: Engine, mode: Mode, xi: Floats, v: Floats) -> None:
    """Put the sizes of the free unknowns into `mode.free_size`, once for the same bond variables.

    At least their own values: those alone where the slopes are singular.
    """
    if is_measured(e, mode, v):
        return
    frees = mode.finite_frees
    fit(mode.free_size, frees)
    first = e.model.bond_slot
    for j in range(frees):
        mode.free_size.at[j] = math.fabs(v[first + mode.free_column[j]])
    if mode.dynamics > 0 and frees > 0:
        by_residuals(e, mode, xi, v)
        if mode.leakage.stages > 0:
            by_leakage(e, mode, xi)


def is_measured(e: Engine, mode: Mode, v: Floats) -> bool:
    """Whether the sizes of a mode are known at these bond variables; they are kept as such."""
    first = e.model.bond_slot
    same = mode.sized
    for b in range(2 * e.model.bonds):
        same = same and mode.sized_at[b] == v[first + b]
        mode.sized_at[b] = v[first + b]
    mode.sized = True
    return same


def by_residuals(e: Engine, mode: Mode, xi: Floats, v: Floats) -> None:
    """Let unknowns be as large as the terms of the residuals would make them."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.finite_frees
    for k in range(n):
        size = row_size(mode.finite, mode.same[k], xi)
        for p in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
            j = mode.share_of.at[p]
            size += math.fabs(mode.finite_free.at[k * frees + j]) * mode.free_size.at[j]
        work.w_size[k] = max(size, math.fabs(mode.sized_at[k]))
        work.w_reach[k] = 0.0
    rows = rows_of_system(e, mode, v, mode.sized_at)
    if rows != frees or not all_finite(rows * frees, work.jacobian.at):
        return
    bound_by_chords(e, mode, v)
    for i in range(rows):
        d = mode.dynamic[i] if mode.rank == mode.structures else -1
        if d >= 0:
            inside = value(m, m.dynamic_rounding[d], v)
            if inside > work.residual_size.at[i]:
                work.residual_size.at[i] = inside
    fit(work.row_size, rows)
    copy_floats(rows, work.residual_size.at, work.row_size.at)
    if not invert(e, rows):
        return
    vague = False
    for j in range(frees):
        size = unknown_size(e, rows, j)
        if math.isfinite(size):
            own = mode.free_size.at[j]
            mode.free_size.at[j] = max(own, size)
            vague = vague or EPSILON * size > own
    if vague:
        where_it_bends(e, mode, v)


def by_leakage(e: Engine, mode: Mode, xi: Floats) -> None:
    """Let unknowns that laws leave open be as large as what least leakage took off them.

    That is a sum of many bond variables, of which nothing is left where least leakage is zero.
    """
    p = mode.leakage
    size = e.work.w_size
    for k in range(2 * e.model.bonds):
        size[k] = max(row_size(mode.finite, mode.same[k], xi), math.fabs(mode.sized_at[k]))
    for stage in range(2):
        many = p.first if stage == 0 else p.second
        basis = p.basis.at if stage == 0 else p.basis2.at
        taken = p.taken.at if stage == 0 else p.taken2.at
        let_taken(e, mode, many, basis, taken)


def let_taken(e: Engine, mode: Mode, many: int, basis: Floats, taken: Floats) -> None:
    """Let unknowns be as large as the terms of ``basis taken w``, of `many` columns."""
    n = 2 * e.model.bonds
    for i in range(many):
        amount = 0.0
        for k in range(n):
            amount += math.fabs(taken[i * n + k]) * e.work.w_size[k]
        for j in range(mode.finite_frees):
            share = math.fabs(basis[mode.free_column[j] * many + i])
            mode.free_size.at[j] = max(mode.free_size.at[j], share * amount)


def invert(e: Engine, rows: int) -> bool:
    """Invert the Jacobian of as many unknowns; False if it is singular."""
    work = e.work
    fit(work.inverse, rows * rows)
    if factor_slopes(e, rows):
        for j in range(rows):
            put_inverse_row(e, rows, j)
        return True
    fit(work.jacobian2, rows * rows)
    fit_places(work.pivots, rows)
    for i in range(rows * rows):
        work.jacobian2.at[i] = work.jacobian.at[i]
        work.inverse.at[i] = 0.0
    if lu_factor(rows, work.jacobian2.at, work.pivots.at) == SINGULAR:
        return False
    if not least_pivot(rows, work.jacobian.at, work.jacobian2.at) >= CLEAR_PIVOT:
        return False
    for i in range(rows):
        work.inverse.at[i * rows + i] = 1.0
    lu_solve(rows, work.jacobian2.at, work.pivots.at, rows, work.inverse.at)
    return True


def unknown_size(e: Engine, rows: int, j: int) -> float:
    """Return the size that the terms of all residuals give to unknown j, to first order."""
    size = 0.0
    for i in range(rows):
        size += math.fabs(e.work.inverse.at[j * rows + i]) * e.work.row_size.at[i]
    return size


def where_it_bends(e: Engine, mode: Mode, v: Floats) -> None:
    """Lessen the sizes of unknowns that are nothing but rounding where their laws are flat.

    A law like ``f*abs(f)`` has no slope at zero, and to first order rounding would move the flow
    beyond all bounds. It does so as far as the slopes there let it: for the square of the unknown
    the mean of what slopes say here and as far away as they say, by their logarithms. For other
    powers that is not where slopes say the same as how far away it is: there it is sought.
    """
    frees = mode.finite_frees
    work = e.work
    fit(work.nearest, frees)
    fit(work.farthest, frees)
    for j in range(frees):
        own = math.fabs(mode.sized_at[mode.free_column[j]])
        way = EPSILON * mode.free_size.at[j]
        work.farthest.at[j] = way if way > own else 0.0
        work.nearest.at[j] = min(max(own, LEAST_WAY), way) if way > own else 0.0
    found = sizes_there(e, mode, v, work.farthest.at) == SLOPES_THERE
    for j in range(frees):
        way = work.farthest.at[j]
        if way == 0.0:
            continue
        own = math.fabs(mode.sized_at[mode.free_column[j]])
        there = unknown_size(e, frees, j) if found else mode.free_size.at[j]
        if there < mode.free_size.at[j]:
            mean = math.sqrt(there) * math.sqrt(mode.free_size.at[j])
            mode.free_size.at[j] = max(mean, own)
    if not is_where_slopes_say(e, mode, v):
        seek_between(e, mode, v)
    write_bonds(e, v, mode.sized_at)


def is_where_slopes_say(e: Engine, mode: Mode, v: Floats) -> bool:
    """Whether slopes as far away as rounding moves unknowns say that it moves them so far."""
    frees = mode.finite_frees
    fit(e.work.between, frees)
    for j in range(frees):
        far = e.work.farthest.at[j]
        e.work.between.at[j] = EPSILON * mode.free_size.at[j] if far > 0.0 else 0.0
    if sizes_there(e, mode, v, e.work.between.at) != SLOPES_THERE:
        return False
    for j in range(frees):
        way = e.work.between.at[j]
        says = EPSILON * unknown_size(e, frees, j)
        if way > 0.0 and (says > SAYS_SAME * way or way > SAYS_SAME * says):
            return False
    return True


def seek_between(e: Engine, mode: Mode, v: Floats) -> None:
    """Seek how far rounding moves unknowns, between what they are and what slopes here say."""
    frees = mode.finite_frees
    near = e.work.nearest.at
    far = e.work.farthest.at
    way = e.work.between.at
    for _ in range(HALVED):
        for j in range(frees):
            way[j] = math.sqrt(near[j]) * math.sqrt(far[j])
        # beyond all numbers laws are steeper than any
        found = sizes_there(e, mode, v, way)
        for j in range(frees):
            says = EPSILON * unknown_size(e, frees, j) if found == SLOPES_THERE else 0.0
            if found == FLAT_THERE or says > way[j]:
                near[j] = way[j]
            else:
                far[j] = way[j]
    for j in range(frees):
        if far[j] > 0.0:
            own = math.fabs(mode.sized_at[mode.free_column[j]])
            mode.free_size.at[j] = max(far[j] / EPSILON, own)


def sizes_there(e: Engine, mode: Mode, v: Floats, way: Floats) -> int:
    """Invert the Jacobian where unknowns are so far away, for `unknown_size`.

    SLOPES_THERE, or else why it cannot be: slopes beyond all numbers, or none.
    """
    work = e.work
    frees = mode.finite_frees
    n = 2 * e.model.bonds
    fit(work.tried, n)
    for k in range(n):
        work.tried.at[k] = mode.sized_at[k]
        for j in range(frees):
            if way[j] > 0.0:
                work.tried.at[k] += mode.finite_free.at[k * frees + j] * way[j]
    if not all_finite(n, work.tried.at):
        return STEEP_THERE
    rows = rows_of_system(e, mode, v, work.tried.at)
    if rows != frees or not all_finite(rows * frees, work.jacobian.at):
        return STEEP_THERE
    return SLOPES_THERE if invert(e, rows) else FLAT_THERE
