"""The residual that Newton makes zero, its Jacobian, and the step that they ask for.

The residuals are the laws, the power structure projected on its range, and the hidden constraints:
the time derivative of what the power structure puts on co-energy variables, found by its left null
vectors.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite
from hybond.engine.algebra.svd import least_squares, svd_of_transpose
from hybond.engine.engine import Engine, svd_room
from hybond.engine.mode.dynamic_rows import dynamic_value, frozen_at, slopes_at
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.storage import stiff
from hybond.engine.model import value
from hybond.engine.words import Floats


def write_bonds(e: Engine, v: Floats, w: Floats) -> None:
    """Write bond variables where expressions read them."""
    m = e.model
    for k in range(2 * m.bonds):
        v[m.bond_slot + k] = w[k]


def system(e: Engine, mode: Mode, v: Floats, w: Floats) -> int:
    """Put Newton's residual and Jacobian, in the free unknowns, into `e.work`; return the rows."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.finite_frees
    rows = mode.dynamics
    write_bonds(e, v, w)
    fit(work.residual, rows)
    fit(work.jacobian, rows * frees)
    fit(work.step, rows + frees)
    for i in range(rows):
        work.f[i] = dynamic_value(e, mode, i, v)
    slopes_at(e, mode, v, work.slopes)
    if mode.rank == mode.structures:
        # the power structure leaves nothing hidden: its rows stand as they are
        for i in range(rows):
            work.residual.at[i] = work.f[i]
            put_row(mode, n, work.slopes.at, i * n, i, work.jacobian.at)
        return rows
    split(e, mode, v)
    many = mode.structures
    at = 0
    fit(work.row, n)
    row = work.row.at
    for j in range(mode.rank):
        total = 0.0
        for k in range(n):
            row[k] = 0.0
        for i in range(many):
            share = work.onto.at[i * mode.rank + j]
            total += share * work.f[mode.structure[i]]
            for k in range(n):
                row[k] += share * work.slopes.at[mode.structure[i] * n + k]
        work.residual.at[at] = total
        put_row(mode, n, row, 0, at, work.jacobian.at)
        at += 1
    for i in range(rows - many):
        work.residual.at[at] = work.f[mode.other[i]]
        put_row(mode, n, work.slopes.at, mode.other[i] * n, at, work.jacobian.at)
        at += 1
    known_by_left(e, mode)
    for j in range(many - mode.rank):
        work.residual.at[at] = hidden_row(e, mode, j, v, w, row)
        put_row(mode, n, row, 0, at, work.jacobian.at)
        at += 1
    return rows


def put_row(mode: Mode, n: int, a: Floats, first: int, at: int, jacobian: Floats) -> None:
    """Put a row of slopes by bond variables into the Jacobian, by free unknowns."""
    frees = mode.finite_frees
    for j in range(frees):
        jacobian[at * frees + j] = 0.0
    for k in range(n):
        slope = a[first + k]
        if slope != 0.0:
            for j in range(frees):
                jacobian[at * frees + j] += slope * mode.finite_free.at[k * frees + j]


def split(e: Engine, mode: Mode, v: Floats) -> None:
    """Find bases of the range and of the left null space of the structure rows."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    many = mode.structures
    frees = mode.power_frees
    frozen_at(e, mode, v, work.frozen)
    fit(work.c, many * max(frees, 1))
    for i in range(many):
        for j in range(frees):
            work.c.at[i * frees + j] = 0.0
        for k in range(n):
            entry = work.frozen.at[mode.structure[i] * n + k]
            if entry != 0.0:
                for j in range(frees):
                    work.c.at[i * frees + j] += entry * mode.power_free.at[k * frees + j]
    d = svd_room(e, max(many, frees), max(many, frees))
    svd_of_transpose(d, many, frees, work.c.at)
    rank = mode.rank
    fit(work.onto, many * max(rank, 1))
    fit(work.left, many * max(many - rank, 1))
    for i in range(many):
        for j in range(rank):
            work.onto.at[i * rank + j] = d.v[j * many + i]
        for j in range(many - rank):
            work.left.at[i * (many - rank) + j] = d.v[(rank + j) * many + i]


def known_by_left(e: Engine, mode: Mode) -> None:
    """Put ``left' frozen known`` into `e.work.known`: what constraints say of the knowns."""
    work = e.work
    n = 2 * e.model.bonds
    lefts = mode.structures - mode.rank
    fit(work.known, max(lefts, 1) * mode.knowns)
    for i in range(lefts * mode.knowns):
        work.known.at[i] = 0.0
    for i in range(mode.structures):
        for k in range(n):
            entry = work.frozen.at[mode.structure[i] * n + k]
            if entry == 0.0:
                continue
            row = mode.same[k]
            for p in range(mode.power.first.at[row], mode.power.first.at[row + 1]):
                for j in range(lefts):
                    work.known.at[j * mode.knowns + mode.power.column.at[p]] += (
                        work.left.at[i * lefts + j] * entry * mode.power.value.at[p]
                    )


def hidden_row(e: Engine, mode: Mode, j: int, v: Floats, w: Floats, row: Floats) -> float:
    """Put the slopes of a hidden constraint by bond variables into `row`; return its value."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    lefts = mode.structures - mode.rank
    for k in range(n):
        row[k] = 0.0
    total = 0.0
    first = j * mode.knowns
    for k in range(m.storages):
        factor = work.known.at[first + k]
        if factor == 0.0:
            continue
        for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
            s = m.stiff_other[i]
            at = m.storage_bond[s] + (m.bonds if m.storage_kind[s] == 0 else 0)
            way = float(m.storage_sign[s]) if m.storage_kind[s] == 0 else 1.0
            slope = factor * stiff(m, i, v) * way
            row[at] += slope
            total += slope * w[at]
    for k in range(mode.sources):
        source = mode.source[k]
        if source >= 0 and m.source_rate[source] >= 0:
            total += work.known.at[first + m.storages + k] * value(m, m.source_rate[source], v)
    for i in range(mode.structures):
        share = work.left.at[i * lefts + j]
        d = mode.dynamic[mode.structure[i]]
        if m.drift_value[d] >= 0:
            total += share * value(m, m.drift_value[d], v)
        for p in range(m.drift_first[d], m.drift_first[d + 1]):
            law = m.drift_slope[p]
            slope = m.drift_constant[p] if law < 0 else value(m, law, v)
            row[m.drift_column[p]] += share * slope
    return total


def with_free(mode: Mode, n: int, base: Floats, r: Floats, w: Floats) -> None:
    """Add what the free unknowns give."""
    frees = mode.finite_frees
    for k in range(n):
        total = base[k]
        for j in range(frees):
            total += mode.finite_free.at[k * frees + j] * r[j]
        w[k] = total


def newton_step(e: Engine, rows: int, frees: int) -> None:
    """Solve ``jacobian step = residual``; if it is not square and regular in the least squares."""
    work = e.work
    if rows == frees:
        fit(work.jacobian2, rows * frees)
        fit_places(work.pivots, rows)
        for i in range(rows * frees):
            work.jacobian2.at[i] = work.jacobian.at[i]
        for i in range(rows):
            work.step.at[i] = work.residual.at[i]
        if lu_factor(rows, work.jacobian2.at, work.pivots.at) != SINGULAR:
            lu_solve(rows, work.jacobian2.at, work.pivots.at, 1, work.step.at)
            if all_finite(rows, work.step.at):
                return
    d = svd_room(e, max(rows, frees), max(rows, frees))
    least_squares(d, rows, frees, work.jacobian.at, -1.0, 1, work.residual.at, work.step.at)


def is_zero(n: int, a: Floats) -> bool:
    """Whether all of n numbers are zero."""
    for k in range(n):
        if a[k] != 0.0:
            return False
    return True


def largest_of(n: int, a: Floats) -> float:
    """Return the largest magnitude; nan if there is one."""
    most = 0.0
    for k in range(n):
        if not math.fabs(a[k]) <= most:
            most = math.fabs(a[k])
    return most
