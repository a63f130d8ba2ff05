"""The residual that Newton makes zero, and its Jacobian.

The residuals are the laws, the power structure projected on its range, and the hidden constraints:
the time derivative of what the power structure puts on co-energy variables, found by its left null
vectors.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, row_size
from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.algebra.svd import svd_of_transpose
from hybond.engine.answers import value
from hybond.engine.engine import Engine, count_work, svd_room
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value, frozen_at, slopes_at
from hybond.engine.mode.nonlinear.flat_sides import take_flat_sides
from hybond.engine.mode.nonlinear.freedom import rank_here
from hybond.engine.mode.nonlinear.slopes_bounded import bound_slopes
from hybond.engine.mode.rows.storage import stiff
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.words import Floats

LAST_PLACES: Final = 2.0 * EPSILON
"""Part of its terms that is the rounding of a sum."""
ISOLATED: Final = 1.0
"""What stands for a slope that is zero at one point: that of the variable which a row gives."""


def write_bonds(e: Engine, v: Floats, w: Floats) -> None:
    """Write bond variables where expressions read them."""
    copy_part(2 * e.model.bonds, w, 0, v, e.model.bond_slot)


def system(e: Engine, mode: Mode, v: Floats, w: Floats) -> int:
    """Put Newton's residual and Jacobian, in the free unknowns, into `e.work`; return the rows."""
    for k in range(2 * e.model.bonds):
        e.work.w_size[k] = math.fabs(w[k])
    return rows_of_system(e, mode, v, w)


def measured_system(e: Engine, mode: Mode, v: Floats, w: Floats) -> int:
    """Do the same, residuals being measured by all terms that bond variables are sums of."""
    measure_terms(e, mode, w)
    return rows_of_system(e, mode, v, w)


def measure_terms(e: Engine, mode: Mode, w: Floats) -> None:
    """Put the sizes of the terms of bond variables there: of what is known, of what is free."""
    frees = mode.finite_frees
    shares = mode.share_of.at
    stop = 0
    for k in range(2 * e.model.bonds):
        known = w[k]
        size = 0.0
        begin = stop
        stop = mode.share_first.at[k + 1] if frees > 0 else 0
        for p in range(begin, stop):
            term = mode.finite_free.at[k * frees + shares[p]] * w[mode.free_column[shares[p]]]
            known -= term
            size += math.fabs(term)
        e.work.w_size[k] = size + math.fabs(known)
    reach_of_kinds(e, mode, w)


def reach_of_kinds(e: Engine, mode: Mode, w: Floats) -> None:
    """Put the largest magnitude among variables of its kind beside each.

    What is known without Newton has the rounding of its own terms alone, however large an unknown
    has become in vain: that of a law that has all but ended in its limit.
    """
    m = e.model
    work = e.work
    for c in range(m.classes):
        work.kind_reach[c] = 0.0
    for k in range(2 * m.bonds):
        c = m.bond_class[k]
        work.kind_reach[c] = max(work.kind_reach[c], math.fabs(w[k]))
    for k in range(2 * m.bonds):
        work.w_reach[k] = work.kind_reach[m.bond_class[k]]
        if is_given(mode, k):
            own = row_size(mode.finite, mode.same[k], work.xi)
            work.w_reach[k] = min(work.w_reach[k], max(own, math.fabs(w[k])))


def is_given(mode: Mode, k: int) -> bool:
    """Whether no unknown has part in a bond variable."""
    return mode.finite_frees == 0 or mode.share_first.at[k] == mode.share_first.at[k + 1]


def rows_of_system(e: Engine, mode: Mode, v: Floats, w: Floats) -> int:
    """Put residuals, the sizes of their terms and the Jacobian there; return the rows."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.finite_frees
    rows = mode.dynamics
    count_work(e, rows * (n + frees * frees))
    write_bonds(e, v, w)
    work.reluctant = mode.reluctant
    work.bends = mode.bent
    fit(work.residual, rows)
    fit(work.residual_size, rows)
    fit(work.residual_reach, rows)
    fit(work.jacobian, rows * frees)
    fit(work.step, rows + frees)
    for i in range(rows):
        work.f[i] = dynamic_value(e, mode, i, v)
    slopes_at(e, mode, v, work.slopes)
    bound_slopes(e, mode, v)
    if work.held_jump > 0:
        hold_jump(e, mode, work.held_jump - 1, w)
    if work.flat_sides:
        take_flat_sides(e, mode, v, w)
    if work.aid > 0.0:
        add_aid(e, mode, w)
    if mode.rank == mode.structures:
        # the power structure leaves nothing hidden: its rows stand as they are
        for i in range(rows):
            work.residual.at[i] = work.f[i]
            put_law(e, mode, i, i)
        return rows
    if not work.holds_rows:
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
        put_row(e, mode, row, 0, at)
        at += 1
    for i in range(rows - many):
        work.residual.at[at] = work.f[mode.other[i]]
        put_law(e, mode, mode.other[i], at)
        at += 1
    known_by_left(e, mode)
    for j in range(many - mode.rank):
        work.residual.at[at] = hidden_row(e, mode, j, v, w, row)
        put_row(e, mode, row, 0, at)
        at += 1
    return rows


def put_row(e: Engine, mode: Mode, a: Floats, first: int, at: int) -> None:
    """Put a row of slopes by bond variables into the Jacobian, by free unknowns.

    The sizes of its terms are summed as well.
    """
    # all three in one pass: most slopes of a long row are zero
    work = e.work
    frees = mode.finite_frees
    begin = at * frees
    work.residual_size.at[at] = 0.0
    work.residual_reach.at[at] = 0.0
    for j in range(frees):
        work.jacobian.at[begin + j] = 0.0
    for k in range(2 * e.model.bonds):
        if a[first + k] != 0.0:
            put_slope(e, mode, a[first + k], k, at)


def put_law(e: Engine, mode: Mode, i: int, at: int) -> None:
    """Do the same for the slopes of row i as they are, of which the table lists the columns."""
    m = e.model
    work = e.work
    first = i * 2 * m.bonds
    d = mode.dynamic[i]
    if d < 0:
        put_row(e, mode, work.slopes.at, first, at)
        return
    # a resistance beside the law has its slope by one variable more, in the order of variables
    beside = m.dynamic_partner[d] if work.aid > 0.0 else -1
    work.residual_size.at[at] = 0.0
    work.residual_reach.at[at] = 0.0
    for j in range(mode.finite_frees):
        work.jacobian.at[at * mode.finite_frees + j] = 0.0
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        k = m.slope_column[p]
        if beside >= 0 and beside <= k:
            if beside < k and work.slopes.at[first + beside] != 0.0:
                put_slope(e, mode, work.slopes.at[first + beside], beside, at)
            beside = -1
        if work.slopes.at[first + k] != 0.0:
            put_slope(e, mode, work.slopes.at[first + k], k, at)
    if beside >= 0 and work.slopes.at[first + beside] != 0.0:
        put_slope(e, mode, work.slopes.at[first + beside], beside, at)


def put_slope(e: Engine, mode: Mode, slope: float, k: int, at: int) -> None:
    """Add the slope by bond variable k to a row of the Jacobian and to the sizes of its terms."""
    work = e.work
    frees = mode.finite_frees
    if math.isfinite(slope):
        work.residual_size.at[at] += math.fabs(slope) * work.w_size[k]
        work.residual_reach.at[at] += math.fabs(slope) * work.w_reach[k]
    for p in range(
        mode.share_first.at[k] if frees > 0 else 0, mode.share_first.at[k + 1] if frees > 0 else 0
    ):
        j = mode.share_of.at[p]
        work.jacobian.at[at * frees + j] += slope * mode.finite_free.at[k * frees + j]


def row_terms(n: int, a: Floats, first: int, size: Floats) -> float:
    """Return the sum of the sizes of the terms of a row of slopes, of those that are finite."""
    total = 0.0
    for k in range(n):
        if a[first + k] != 0.0 and math.isfinite(a[first + k]):
            total += math.fabs(a[first + k]) * size[k]
    return total


def by_free(mode: Mode, n: int, a: Floats, first: int, row: Floats) -> None:
    """Put a row of slopes by bond variables there, by free unknowns.

    What is not free has no part in it, not even with a slope without bound: a root at zero.
    """
    frees = mode.finite_frees
    for j in range(frees):
        row[j] = 0.0
    for k in range(n):
        slope = a[first + k]
        if slope != 0.0:
            for j in range(frees):
                share = mode.finite_free.at[k * frees + j]
                if share != 0.0:
                    row[j] += slope * share


def hold_jump(e: Engine, mode: Mode, i: int, w: Floats) -> None:
    """Let row i say that what its law jumps with is zero, in place of its law."""
    m = e.model
    d = mode.dynamic[i]
    first = i * 2 * m.bonds
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        e.work.slopes.at[first + m.slope_column[p]] = 0.0
    k = m.dynamic_partner[d]
    e.work.f[i] = -m.dynamic_way[d] * w[k]
    e.work.slopes.at[first + k] = -m.dynamic_way[d]


def add_aid(e: Engine, mode: Mode, w: Floats) -> None:
    """Put a resistance beside each law that gives one variable of a bond."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0 and m.dynamic_partner[d] >= 0:
            k = m.dynamic_partner[d]
            work.f[i] -= work.aid * m.dynamic_way[d] * w[k]
            work.slopes.at[i * n + k] -= work.aid * m.dynamic_way[d]


def take_rank(e: Engine, mode: Mode, v: Floats) -> None:
    """Find the rank of the power structure's rows at the values `v`, moduli held."""
    work = e.work
    many = mode.structures
    frees = mode.power_frees
    if many == 0:
        return
    put_structure(e, mode, v)
    mode.rank = (
        rank_here(e, many, frees, work.c.at) if all_finite(many * frees, work.c.at) else many
    )


def split(e: Engine, mode: Mode, v: Floats) -> None:
    """Find bases of the range and of the left null space of the structure rows."""
    work = e.work
    many = mode.structures
    frees = mode.power_frees
    put_structure(e, mode, v)
    d = svd_room(e, max(many, frees), max(many, frees))
    svd_of_transpose(d, many, frees, work.c.at)
    rank = mode.rank
    fit(work.onto, many * max(rank, 1))
    fit(work.left, many * max(many - rank, 1))
    for i in range(many):
        for j in range(rank):
            work.onto.at[i * rank + j] = d.v[j * many + i]
        for j in range(many - rank):
            share = d.v[(rank + j) * many + i]
            work.left.at[i * (many - rank) + j] = part_of_unit(many, share)


def part_of_unit(many: int, share: float) -> float:
    """Return an entry of a null vector of `many` rows, of length one; what is rounding is zero.

    Left as an entry, it would count the effort of a weight as a part of a speed.
    """
    return share if math.fabs(share) > many * EPSILON else 0.0


def put_structure(e: Engine, mode: Mode, v: Floats) -> None:
    """Put the power structure's rows by what it leaves free into ``e.work.c``."""
    frozen_at(e, mode, v, e.work.frozen)
    count_isolated(e, mode)
    by_power(e, mode)


def count_isolated(e: Engine, mode: Mode) -> None:
    """Let slopes that are zero here and not beside here count in ``e.work.frozen``.

    What a law determines does not hang on whether its slope is zero at one point. Slopes by what is
    known already are left as they are: they say how a constraint follows what is stored.
    """
    m = e.model
    n = 2 * m.bonds
    frees = mode.power_frees
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        for p in range(m.frozen_first[d], m.frozen_first[d + 1]):
            at = mode.structure[i] * n + m.frozen_column[p]
            if m.frozen_isolated[p] != 0 and e.work.frozen.at[at] == 0.0:
                for j in range(frees):
                    if mode.power_free.at[m.frozen_column[p] * frees + j] != 0.0:
                        e.work.frozen.at[at] = ISOLATED


def by_power(e: Engine, mode: Mode) -> None:
    """Put the rows in ``e.work.frozen`` by what the power structure leaves free there."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    fit(work.c, mode.structures * max(frees, 1))
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        for j in range(frees):
            work.c.at[i * frees + j] = 0.0
        for p in range(m.frozen_first[d], m.frozen_first[d + 1]):
            k = m.frozen_column[p]
            entry = work.frozen.at[mode.structure[i] * n + k]
            if entry != 0.0:
                for j in range(frees):
                    work.c.at[i * frees + j] += entry * mode.power_free.at[k * frees + j]


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
            at = rate_bond(m, s)
            slope = factor * stiff(m, i, v) * way_of_rate(m, s)
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
    """Add what the free unknowns give; where laws bend, a sum that is its rounding is zero.

    A law would take the sign of that rounding for one, or its root.
    """
    most = LAST_PLACES if mode.bent else 0.0
    frees = mode.finite_frees
    # what is beyond all bounds leaves nothing with a value
    finite = all_finite(frees, r)
    for k in range(n):
        if finite:
            part = frees > 0 and mode.share_first.at[k] < mode.share_first.at[k + 1]
            # what no unknown has part in is what it is
            w[k] = with_free_one(mode, base, r, k) if part else base[k] + 0.0
            continue
        total = base[k]
        size = math.fabs(base[k])
        for j in range(frees):
            term = mode.finite_free.at[k * frees + j] * r[j]
            total += term
            size += math.fabs(term)
        rounded = math.fabs(total) <= most * size and size < math.inf
        w[k] = 0.0 if rounded else total


def with_free_one(mode: Mode, base: Floats, r: Floats, k: int) -> float:
    """Return bond variable k likewise, where all free unknowns that have part in it are finite."""
    frees = mode.finite_frees
    total = base[k]
    size = math.fabs(base[k])
    first = mode.share_first.at[k] if frees > 0 else 0
    behind = mode.share_first.at[k + 1] if frees > 0 else 0
    for p in range(first, behind):
        j = mode.share_of.at[p]
        term = mode.finite_free.at[k * frees + j] * r[j]
        total += term
        size += math.fabs(term)
    most = LAST_PLACES if mode.bent else 0.0
    rounded = math.fabs(total) <= most * size and size < math.inf
    return 0.0 if rounded else total


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
