"""Bond variables of a mode at one instant: a product with what is known, or Newton's method.

Newton solves, in the unknowns that elimination left free, the laws, the power structure projected
on its range, and the hidden constraints: the time derivative of what the power structure puts on
co-energy variables, found by its left null vectors. After equations/mode.py.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.export.portable.blocks import Block, fit, fit_places, row_size, row_times
from hybond.export.portable.engine import (
    NOT_FINITE,
    OK,
    REFUSED,
    Engine,
    Mode,
    say_fault,
    svd_room,
)
from hybond.export.portable.leakage import project
from hybond.export.portable.lu import SINGULAR, lu_factor, lu_solve
from hybond.export.portable.model import node_name, value
from hybond.export.portable.products import all_finite
from hybond.export.portable.storage import co_energy, stiff
from hybond.export.portable.svd import least_squares, null_space, svd_of_transpose
from hybond.export.portable.words import Floats, Ints, Text

STEPS: Final = 40
ASIDE: Final = 3
"""Times that Newton leaves a point where the laws are flat."""
TOLERANCE: Final = 1e-13
"""Newton ends when an update is below this part of the bond variables' size."""
RANK_TOLERANCE: Final = 1e-10


def knowns_of(e: Engine, mode: Mode, v: Floats, rates: bool) -> None:
    """Put co-energy variables, values and, if asked for, rates of sources into `e.work.xi`."""
    m = e.model
    xi = e.work.xi
    co_energy(m, v, xi)
    for k in range(mode.sources):
        source = mode.source[k]
        law = m.source_value[source] if source >= 0 else -1
        xi[m.storages + k] = mode.source_level[k] if law < 0 else value(m, law, v)
        at = m.storages + mode.sources + k
        xi[at] = 0.0
        if rates and mode.rated[k] != 0:
            xi[at] = value(m, m.source_rate[source], v)


def by_knowns(e: Engine, mode: Mode, w: Floats) -> None:
    """Put what the knowns give to bond variables into `w`."""
    xi = e.work.xi
    n = 2 * e.model.bonds
    for k in range(n):
        same = mode.same[k]
        w[k] = w[same] if same < k else row_times(mode.finite, k, xi)


def with_free(mode: Mode, n: int, base: Floats, r: Floats, w: Floats) -> None:
    """Add what the free unknowns give."""
    frees = mode.finite_frees
    for k in range(n):
        total = base[k]
        for j in range(frees):
            total += mode.finite_free.at[k * frees + j] * r[j]
        w[k] = total


def write_bonds(e: Engine, v: Floats, w: Floats) -> None:
    """Write bond variables where expressions read them."""
    m = e.model
    for k in range(2 * m.bonds):
        v[m.bond_slot + k] = w[k]


def solve(e: Engine, mode: Mode, v: Floats) -> int:
    """Put the bond variables into `e.work.w` and write them into `v`.

    OK, or NOT_FINITE with a fault noted: HB-N301 if Newton does not converge, HB-N302 if a law has
    no value.
    """
    w = e.work.w
    knowns_of(e, mode, v, True)
    if mode.dynamics == 0:
        by_knowns(e, mode, w)
    elif newton(e, mode, v) != OK:
        return NOT_FINITE
    if mode.leakage.stages > 0:
        project(mode.leakage, 2 * e.model.bonds, w)
    write_bonds(e, v, w)
    return OK


def newton(e: Engine, mode: Mode, v: Floats) -> int:
    """Solve for the free unknowns, from where Newton ended last."""
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    base = work.base
    w = work.w
    by_knowns(e, mode, base)
    fit(work.step, frees + mode.dynamics + 1)
    fit(work.guess, frees + 1)
    r = work.guess.at
    for j in range(frees):
        r[j] = mode.guess.at[j] if mode.guessed else 0.0
    update = math.inf
    aside = 0
    for _ in range(STEPS):
        with_free(mode, n, base, r, w)
        rows = system(e, mode, v, w)
        if not all_finite(rows, work.residual.at):
            return blame(e, mode, v)
        if is_zero(rows, work.residual.at):
            # exact already, even where a law has no slope: a root at zero flow
            keep_guess(mode, r)
            return OK
        if not all_finite(rows * frees, work.jacobian.at):
            return blame(e, mode, v)
        newton_step(e, rows, frees)
        scale = largest_of(n, base) + largest_of(frees, r)
        if aside < ASIDE and stands_still(e, mode, rows, frees):
            # flat here (a quadratic law at zero flow), yet not satisfied: look aside
            aside += 1
            for j in range(frees):
                r[j] += (
                    math.pow(10.0, -3.0 * float(aside)) * max(scale, 1e-6) * (1.0 + 0.1 * float(j))
                )
            update = math.inf
            continue
        previous = update
        update = largest_of(frees, work.step.at)
        for j in range(frees):
            r[j] -= work.step.at[j]
        if mode.affine:
            # one step from anywhere is exact
            update = 0.0
        # rounding keeps a step from vanishing: stop as well when it no longer shrinks
        if update <= TOLERANCE * scale or (update <= 1e-9 * scale and update >= 0.5 * previous):
            with_free(mode, n, base, r, w)
            keep_guess(mode, r)
            return OK
    mode.guessed = False
    say_fault(e, "HB-N301", "laws have no solution near the last one", first_place(e, mode))
    e.fault.t = v[0]
    return NOT_FINITE


def keep_guess(mode: Mode, r: Floats) -> None:
    """Keep where Newton ended."""
    for j in range(mode.finite_frees):
        mode.guess.at[j] = r[j]
    mode.guessed = True


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


def stands_still(e: Engine, mode: Mode, rows: int, frees: int) -> bool:
    """Whether a step leaves a part of the residual that the slopes here cannot reach."""
    if mode.affine:
        return False
    work = e.work
    much = False
    most = 0.0
    for i in range(rows):
        total = work.residual.at[i]
        for j in range(frees):
            total -= work.jacobian.at[i * frees + j] * work.step.at[j]
        rest = math.fabs(total)
        much = much or rest > 0.5 * math.fabs(work.residual.at[i])
        most = max(most, rest)
    return much and most > 0.0


def first_place(e: Engine, mode: Mode) -> Text:
    """Return the first element whose law is evaluated in a mode."""
    m = e.model
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0:
            return node_name(m, m.dynamic_node[mode.dynamic[i]])
    return ""


def blame(e: Engine, mode: Mode, v: Floats) -> int:
    """Name the law whose value or slope is not a number."""
    m = e.model
    n = 2 * m.bonds
    mode.guessed = False
    slopes_at(e, mode, v, e.work.slopes)
    for i in range(mode.dynamics):
        steep = False
        for k in range(n):
            steep = steep or not math.isfinite(e.work.slopes.at[i * n + k])
        if steep or not math.isfinite(dynamic_value(e, mode, i, v)):
            d = mode.dynamic[i]
            place = node_name(m, m.dynamic_node[d]) if d >= 0 else "a constraint's derivative"
            say_fault(e, "HB-N302", "a law has no finite value or slope", place)
            e.fault.t = v[0]
            return NOT_FINITE
    say_fault(e, "HB-N302", "the equations overflow", "")
    e.fault.t = v[0]
    return NOT_FINITE


# -- dynamic rows


def dynamic_value(e: Engine, mode: Mode, i: int, v: Floats) -> float:
    """Return the value of a dynamic row, zero at the solution."""
    m = e.model
    d = mode.dynamic[i]
    if d >= 0:
        return value(m, m.dynamic_value[d], v)
    total = 0.0
    c = -1 - d
    for p in range(mode.constraints.first.at[c], mode.constraints.first.at[c + 1]):
        k = mode.constraints.column.at[p]
        factor = mode.constraints.value.at[p]
        if k >= m.storages:
            source = mode.source[k - m.storages]
            if source >= 0 and m.source_rate[source] >= 0:
                total += factor * value(m, m.source_rate[source], v)
            continue
        for j in range(m.stiff_first[k], m.stiff_first[k + 1]):
            total += factor * stiff(m, j, v) * stored_rate(e, m.stiff_other[j], v)
    return total


def stored_rate(e: Engine, k: int, v: Floats) -> float:
    """Return the rate of a stored quantity: the flow into a C, the effort into an I."""
    m = e.model
    at = m.bond_slot + m.storage_bond[k]
    if m.storage_kind[k] == 1:
        return v[at]
    flow = v[at + m.bonds]
    return flow if m.storage_sign[k] > 0 else -flow


def slopes_at(e: Engine, mode: Mode, v: Floats, block: Block) -> None:
    """Put the derivatives of dynamic rows by bond variables there, a row each."""
    m = e.model
    n = 2 * m.bonds
    fit(block, mode.dynamics * n)
    for i in range(mode.dynamics * n):
        block.at[i] = 0.0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0:
            hidden_slopes(e, mode, -1 - d, v, i * n, block.at)
        else:
            put_slopes(
                e,
                m.slope_first,
                d,
                m.slope_column,
                m.slope_value,
                m.slope_constant,
                v,
                i * n,
                block.at,
            )


def frozen_at(e: Engine, mode: Mode, v: Floats, block: Block) -> None:
    """Put the same there with moduli held."""
    m = e.model
    n = 2 * m.bonds
    fit(block, mode.dynamics * n)
    for i in range(mode.dynamics * n):
        block.at[i] = 0.0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0:
            hidden_slopes(e, mode, -1 - d, v, i * n, block.at)
        else:
            put_slopes(
                e,
                m.frozen_first,
                d,
                m.frozen_column,
                m.frozen_value,
                m.frozen_constant,
                v,
                i * n,
                block.at,
            )


def put_slopes(
    e: Engine,
    first: Ints,
    d: int,
    column: Ints,
    law: Ints,
    constant: Floats,
    v: Floats,
    at: int,
    a: Floats,
) -> None:
    """Put the slopes of row d of a table into `a`, from `at` on."""
    for i in range(first[d], first[d + 1]):
        a[at + column[i]] = constant[i] if law[i] < 0 else value(e.model, law[i], v)


def hidden_slopes(e: Engine, mode: Mode, c: int, v: Floats, at: int, a: Floats) -> None:
    """Put the slopes of the derivative of a constraint into `a`, from `at` on."""
    m = e.model
    for i in range(mode.constraints.first.at[c], mode.constraints.first.at[c + 1]):
        k = mode.constraints.column.at[i]
        factor = mode.constraints.value.at[i]
        if k >= m.storages:
            source = mode.source[k - m.storages]
            if source >= 0:
                for j in range(m.source_first[source], m.source_first[source + 1]):
                    law = m.source_slope[j]
                    slope = m.source_slope_constant[j] if law < 0 else value(m, law, v)
                    a[at + m.source_column[j]] += factor * slope
            continue
        for j in range(m.stiff_first[k], m.stiff_first[k + 1]):
            s = m.stiff_other[j]
            bond = m.storage_bond[s] + (m.bonds if m.storage_kind[s] == 0 else 0)
            way = float(m.storage_sign[s]) if m.storage_kind[s] == 0 else 1.0
            a[at + bond] += factor * stiff(m, j, v) * way


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
        total = 0.0
        for k in range(n):
            if a[first + k] != 0.0:
                total += a[first + k] * mode.finite_free.at[k * frees + j]
        jacobian[at * frees + j] = total


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
            total = 0.0
            for k in range(n):
                entry = work.frozen.at[mode.structure[i] * n + k]
                if entry != 0.0:
                    total += entry * mode.power_free.at[k * frees + j]
            work.c.at[i * frees + j] = total
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


# -- what goes with a solution


def sizes_of(e: Engine, mode: Mode) -> None:
    """Put the sizes of the terms of each bond variable into `e.work.sizes`, after `solve`.

    After equations/mode.py, solution.
    """
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    for k in range(n):
        same = mode.same[k]
        work.sizes[k] = work.base_size[same] if same < k else row_size(mode.finite, k, work.xi)
        work.base_size[k] = work.sizes[k]
        for j in range(frees):
            r = work.w[mode.free_column[j]]
            work.sizes[k] += math.fabs(mode.finite_free.at[k * frees + j]) * math.fabs(r)
        work.sizes[k] = max(work.sizes[k], math.fabs(work.w[k]))


def freedom_at(e: Engine, mode: Mode, v: Floats) -> int:
    """Return in how many directions bond variables are free at this point, into `e.work.freedom`.

    Bond variables in `v` are the solution.
    """
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.finite_frees
    if mode.dynamics == 0 or frees == 0:
        fit(work.freedom, n * max(mode.loose, 1))
        for i in range(n * mode.loose):
            work.freedom.at[i] = mode.freedom.at[i]
        return mode.loose
    for k in range(n):
        work.w[k] = v[m.bond_slot + k]
    rows = system(e, mode, v, work.w)
    size = 0.0
    for i in range(rows * frees):
        if math.isfinite(work.jacobian.at[i]):
            size = max(size, math.fabs(work.jacobian.at[i]))
    for i in range(rows * frees):
        if not math.isfinite(work.jacobian.at[i]):
            # a slope without bound (a root at zero) fixes its variable like any other
            work.jacobian.at[i] = size if size > 0.0 else 1.0
    fit(work.a, frees * frees)
    d = svd_room(e, max(rows, frees), max(rows, frees))
    many = null_space(d, rows, frees, work.jacobian.at, RANK_TOLERANCE, work.a.at)
    fit(work.freedom, n * max(many, 1))
    for k in range(n):
        for j in range(many):
            total = 0.0
            for i in range(frees):
                total += mode.finite_free.at[k * frees + i] * work.a.at[i * many + j]
            work.freedom.at[k * many + j] = total
    return many


def may_refuse(status: int) -> int:
    """Return what a refusal at an instant means: the run stops."""
    return OK if status == OK else REFUSED
