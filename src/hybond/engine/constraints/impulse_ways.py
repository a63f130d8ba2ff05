"""The impulses that a mode allows, what they move, and how constraints answer to that."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places, spread_rows
from hybond.engine.algebra.products import (
    copy_floats,
    copy_part,
    largest,
    largest_part,
    times_matrix,
    times_orthonormal,
)
from hybond.engine.algebra.qr import complement
from hybond.engine.algebra.svd import null_space, pseudo_inverse, rank_above, svd
from hybond.engine.constraints.constraints import constraint_by_co_energy, residual
from hybond.engine.constraints.own_ways import give_own
from hybond.engine.constraints.sparse_ways import (
    find_extents,
    find_sparse_ways,
    is_curved,
    size_held,
)
from hybond.engine.engine import Engine, svd_room
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.nonlinear.dynamic_rows import frozen_at
from hybond.engine.mode.rows.storage import own_stiffness, stiff, with_stored
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.words import Floats

SEEN: Final = 1e-3
"""Part of a constraint's terms that a storage is to move, of which differences are a small part."""


def impulse_directions(e: Engine, mode: Mode, v: Floats, ways: Ways) -> None:
    """Find all impulses that the power structure allows."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    rows = 0
    if mode.dynamics > 0:
        frozen_at(e, mode, v, w.frozen)
    most = 0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0:
            most += max(1, m.dynamic_free[d + 1] - m.dynamic_free[d])
    fit(w.row, most * frees)
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0:
            continue
        for p in range(m.dynamic_free[d], m.dynamic_free[d + 1]):
            copy_part(frees, mode.power_free.at, m.free_column[p] * frees, w.row.at, rows * frees)
            rows += 1
        if m.dynamic_free[d] == m.dynamic_free[d + 1]:
            for j in range(frees):
                total = 0.0
                for k in range(n):
                    total += w.frozen.at[i * n + k] * mode.power_free.at[k * frees + j]
                w.row.at[rows * frees + j] = total
            rows += 1
    if rows == 0:
        ways.many = frees
        fit(ways.directions, n * frees)
        if mode.free_sparse:
            spread_rows(mode.free_rows, frees, ways.directions.at)
            return
        copy_floats(n * frees, mode.power_free.at, ways.directions.at)
        return
    room = svd_room(e, max(rows, frees), max(rows, frees))
    fit(w.c, frees * frees)
    ways.many = null_space(room, rows, frees, w.row.at, 1e-10, w.c.at)
    fit(ways.directions, n * ways.many)
    times_orthonormal(n, frees, ways.many, mode.power_free.at, w.c.at, ways.directions.at)


def find_ways(e: Engine, mode: Mode, v: Floats, x: Floats) -> None:
    """Find the impulses of a mode and what they move; in a linear mode once."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    ways = mode.ways
    if ways.known or find_sparse_ways(e, mode, x):
        return
    ways.sparse = False
    impulse_directions(e, mode, v, ways)
    many = ways.many
    fit(w.rate_part, m.storages * many)
    for k in range(m.storages):
        at = rate_bond(m, k)
        sign = way_of_rate(m, k)
        for j in range(many):
            w.rate_part.at[k * many + j] = sign * ways.directions.at[at * many + j]
    # the combinations of impulses that move the state
    ways.areas = 0
    fit(ways.moving, many * many)
    if many > 0:
        d = svd_room(e, max(m.storages, many), max(m.storages, many))
        svd(d, m.storages, many, w.rate_part.at)
        ways.areas = min(rank_above(d, many, 1e-10 * max(d.s[0], 1e-300)), m.storages)
        first_of_v(many, ways.areas, d.v, ways.moving.at)
    fit(ways.d, m.storages * ways.areas)
    times_matrix(m.storages, many, ways.areas, w.rate_part.at, ways.moving.at, ways.d.at)
    find_shares(e, ways, n)
    find_extents(e, x)
    give_own(e, ways, w.extents.at)
    list_moves(m.storages, ways)
    fit(w.nu, ways.areas)
    fit(w.step, ways.areas)
    fit(w.combined, many)
    if mode.dynamics > 0 or m.groups > 0:
        return
    count = w.constraints
    slope_of(e, mode, v, x, ways)
    fit(ways.inverse, ways.areas * count)
    ways.rank = rank_of(e, count, ways.areas, ways.slope.at)
    invert_slope(e, ways, count)
    ways.known = True


def list_moves(storages: int, ways: Ways) -> None:
    """List which areas move each storage: few, where there are many of both."""
    areas = ways.areas
    fit_places(ways.moves_first, storages + 1)
    many = 0
    for i in range(storages * areas):
        many += 1 if ways.d.at[i] != 0.0 else 0
    fit_places(ways.moves, many)
    fit(ways.moves_by, many)
    many = 0
    for k in range(storages):
        ways.moves_first.at[k] = many
        for a in range(areas):
            if ways.d.at[k * areas + a] != 0.0:
                ways.moves.at[many] = a
                ways.moves_by.at[many] = ways.d.at[k * areas + a]
                many += 1
    ways.moves_first.at[storages] = many


def invert_slope(e: Engine, ways: Ways, count: int) -> None:
    """Put the pseudo-inverse of the slope into `ways.inverse`."""
    w = e.work
    areas = ways.areas
    d = svd_room(e, max(count, areas), max(count, areas))
    if ways.rank < areas and count > 0:
        fit(w.row_size, count)
        for i in range(count):
            size_by_entries(w.row_size.at, ways, i)
        if scale_slope(e, ways, count, w.row_size.at) == areas:
            pseudo_inverse(d, count, areas, w.scaled.at, 1e-12, ways.inverse.at)
            for a in range(areas):
                for i in range(count):
                    own = ways.inverse.at[a * count + i]
                    ways.inverse.at[a * count + i] = own / w.column_size.at[a] / w.row_size.at[i]
            ways.rank = areas
            return
    pseudo_inverse(d, count, areas, ways.slope.at, 1e-12, ways.inverse.at)


def size_by_entries(size: Floats, ways: Ways, i: int) -> None:
    """Let row i of the slope be measured by its largest entry."""
    most = largest_part(ways.areas, ways.slope.at, i * ways.areas)
    size[i] = most if most > 0.0 else 1.0


def scale_slope(e: Engine, ways: Ways, count: int, size: Floats) -> int:
    """Measure rows of the slope by `size` and columns by their largest entries; return its rank.

    It goes into `e.work.scaled`, the sizes of columns into `e.work.column_size`.
    """
    w = e.work
    areas = ways.areas
    fit(w.scaled, count * areas)
    fit(w.column_size, areas)
    for a in range(areas):
        most = 0.0
        for i in range(count):
            here = ways.slope.at[i * areas + a] / (size[i] if size[i] > 0.0 else 1.0)
            w.scaled.at[i * areas + a] = here
            most = max(most, math.fabs(here))
        w.column_size.at[a] = most if most > 0.0 else 1.0
        for i in range(count):
            w.scaled.at[i * areas + a] = w.scaled.at[i * areas + a] / w.column_size.at[a]
    return rank_of(e, count, areas, w.scaled.at)


def first_of_v(n: int, many: int, v: Floats, basis: Floats) -> None:
    """Put the first columns of V into the columns of `basis`."""
    for j in range(many):
        for i in range(n):
            basis[i * many + j] = v[j * n + i]


def find_shares(e: Engine, ways: Ways, n: int) -> None:
    """Find the impulses that move nothing: what is left to least leakage."""
    w = e.work
    many = ways.many
    ways.shares = 0
    if many == ways.areas:
        return
    fit(w.a, many * many)
    fit(w.b, many * many)
    fit(w.c, many)
    fit_columns(e, many)
    copy_floats(many * ways.areas, ways.moving.at, w.a.at)
    ways.shares = complement(many, ways.areas, w.a.at, w.c.at, w.column.at, w.b.at)
    fit(ways.share, n * ways.shares)
    times_orthonormal(n, many, ways.shares, ways.directions.at, w.b.at, ways.share.at)


def fit_columns(e: Engine, n: int) -> None:
    """Make room for the columns of a factorisation."""
    fit_places(e.work.column, n)


def rank_of(e: Engine, rows: int, columns: int, a: Floats) -> int:
    """Return the rank of a matrix, measured by its largest entry."""
    if rows == 0 or columns == 0:
        return 0
    d = svd_room(e, max(rows, columns), max(rows, columns))
    svd(d, rows, columns, a)
    return min(rank_above(d, columns, 1e-10 * largest(rows * columns, a)), rows)


def slope_of(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> None:
    """Put the derivative of the residuals by the areas into `ways.slope`."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    count = w.constraints
    areas = ways.areas
    fit(ways.slope, count * areas)
    if is_curved(e, mode):
        difference_slope(e, mode, v, x, ways)
        return
    values = with_stored(e, x)
    # rows by co-energy variables and sources, then by what is stored
    fit(w.by_stored, m.storages)
    for i in range(count):
        constraint_by_co_energy(e, mode, i, n)
        for a in range(areas):
            total = 0.0
            for k in range(m.storages):
                factor = w.by_stored.at[k]
                if factor == 0.0:
                    continue
                for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
                    s = m.stiff_other[p]
                    total += factor * stiff(m, p, values) * ways.d.at[s * areas + a]
            ways.slope.at[i * areas + a] = total + by_sources(e, mode, i, ways, a)


def by_sources(e: Engine, mode: Mode, i: int, ways: Ways, a: int) -> float:
    """Return what sources add to the derivative of residual i by an area, by their forms."""
    m = e.model
    total = 0.0
    if i >= mode.constraints.rows:
        return total
    for p in range(mode.constraints.first.at[i], mode.constraints.first.at[i + 1]):
        k = mode.constraints.column.at[p] - m.storages
        s = mode.source[k] if k >= 0 else -1
        if s < 0 or m.source_value[s] < 0 or m.source_timed[s] != 0:
            continue
        for q in range(m.form_first[s], m.form_first[s + 1]):
            stored = m.form_column[q] - 2 * m.bonds
            if stored >= 0 and stored < m.storages:
                change = ways.d.at[stored * ways.areas + a]
                total += mode.constraints.value.at[p] * m.form_value[q] * change
    return total


def difference_slope(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> None:
    """Put difference quotients there: the residual decides when Newton ends.

    They are taken storage by storage, and ways made of them: along a way that moves a heavy mass
    alone, what the light one beside it would do cancels to the last digit.
    """
    m = e.model
    w = e.work
    count = w.constraints
    areas = ways.areas
    residual(e, mode, v, x)
    seen_by_constraints(e, mode)
    for i in range(count):
        w.base_gap.at[i] = w.gap.at[i]
        for a in range(areas):
            ways.slope.at[i * areas + a] = 0.0
    fit(w.co_energy, m.storages)
    for k in range(m.storages):
        w.ahead[k] = x[k]
        w.co_energy.at[k] = w.xi[k]
    for k in range(m.storages):
        if not is_moved(ways, k):
            continue
        step = 1e-7 * extent(e, x, k)
        w.ahead[k] = x[k] + step
        step = w.ahead[k] - x[k]
        residual(e, mode, v, w.ahead)
        w.ahead[k] = x[k]
        values = with_stored(e, x)
        for i in range(count):
            rate = (w.gap.at[i] - w.base_gap.at[i]) / step
            rate += beside_corners(e, mode, values, i, k, step)
            for a in range(areas):
                ways.slope.at[i * areas + a] += rate * ways.d.at[k * areas + a]


def beside_corners(e: Engine, mode: Mode, values: Floats, i: int, k: int, step: float) -> float:
    """Return by how much a difference misses the slope of residual i by what storage k holds.

    As far as it is laws of storages that bend between its ends, where they have `w.co_energy` and
    `w.xi`: their slopes are known.
    """
    m = e.model
    w = e.work
    constraint_by_co_energy(e, mode, i, 2 * m.bonds)
    total = 0.0
    for s in range(m.storages):
        change = w.xi[s] - w.co_energy.at[s]
        if w.by_stored.at[s] == 0.0 or change == 0.0:
            continue
        slope = 0.0
        for p in range(m.stiff_first[s], m.stiff_first[s + 1]):
            if m.stiff_other[p] == k:
                slope += stiff(m, p, values)
        if math.isfinite(slope):
            total += w.by_stored.at[s] * (slope - change / step)
    return total


def seen_by_constraints(e: Engine, mode: Mode) -> None:
    """Find what co-energy each storage must move by for constraints to see it, into `seen_by`.

    Where nothing is stored yet a source may be the only size there is: beside it a difference has
    no digit.
    """
    m = e.model
    w = e.work
    fit(w.by_stored, m.storages)
    fit(w.seen_by, m.storages)
    for k in range(m.storages):
        w.seen_by.at[k] = 0.0
    for i in range(w.constraints):
        constraint_by_co_energy(e, mode, i, 2 * m.bonds)
        for k in range(m.storages):
            factor = math.fabs(w.by_stored.at[k])
            if factor > 0.0:
                w.seen_by.at[k] = max(w.seen_by.at[k], SEEN * w.gap_size.at[i] / factor)


def is_moved(ways: Ways, k: int) -> bool:
    """Whether a way moves what storage k holds."""
    for a in range(ways.areas):
        if ways.d.at[k * ways.areas + a] != 0.0:
            return True
    return False


def extent(e: Engine, x: Floats, k: int) -> float:
    """Return the size of what storage k holds or may be given; a millionth where nothing is.

    It is no less than what constraints see of it.
    """
    own = math.fabs(own_stiffness(e.model, k, with_stored(e, x)))
    size = size_held(e, x, k)
    if own > 0.0 and math.isfinite(own):
        size = max(size, e.work.seen_by.at[k] / own)
    return size if size > 0.0 and math.isfinite(size) else 1e-6
