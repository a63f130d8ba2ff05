"""The rows of a mode that are evaluated each time, solved once where they are linear.

A controlled source, or a law written out as a formula, makes such a row. Where they have forms, the
unknowns that they determine are solved for here; those of other rows stay open, and so do bond
variables that depend on them.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.engine import Engine
from hybond.engine.methods.linear.flow_records import Exact
from hybond.engine.mode.left_free.leakage import project
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton import by_knowns
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import by_free, with_free
from hybond.engine.mode.rows.hidden_rows import add_rates
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.model import Model
from hybond.engine.words import Floats


def open_rows(e: Engine, mode: Mode) -> bool:
    """Find the rows that are solved here, and for what; False if rates of the state stay open."""
    x = e.exact
    rows = mode.dynamics
    frees = mode.finite_frees
    fit_places(x.left, rows)
    fit_places(x.open, frees)
    fit(x.touched, rows * frees)
    any_left = False
    for i in range(rows):
        left = not has_form(e.model, mode, i)
        if left and mode.dynamic[i] < 0:
            return False
        x.left.at[i] = 1 if left else 0
        any_left = any_left or left
        touch_row(e, mode, i)
    for j in range(frees):
        x.open.at[j] = 0
    if not any_left:
        return True
    if mode.leakage.stages > 0:
        return False
    reach(x, rows, frees)
    solved = 0
    for i in range(rows):
        solved += 1 - x.left.at[i]
    for j in range(frees):
        solved -= 1 - x.open.at[j]
    return solved == 0 and not is_rate_open(e, mode)


def has_form(m: Model, mode: Mode, i: int) -> bool:
    """Whether a row is linear."""
    d = mode.dynamic[i]
    if d >= 0:
        return m.form_why[2 * m.sources + d] < 0
    c = -1 - d
    for p in range(mode.constraints.first.at[c], mode.constraints.first.at[c + 1]):
        k = mode.constraints.column.at[p] - m.storages
        if k >= 0 and mode.source[k] >= 0 and m.form_why[m.sources + mode.source[k]] >= 0:
            return False
    return True


def touch_row(e: Engine, mode: Mode, i: int) -> None:
    """Note which free unknowns a row reads: by its slopes, or where it may have some."""
    m = e.model
    x = e.exact
    d = mode.dynamic[i]
    frees = mode.finite_frees
    if x.left.at[i] == 0:
        take_row(e, mode, i, -1)
    else:
        for k in range(2 * m.bonds):
            x.row[k] = 0.0
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            x.row[m.slope_column[p]] = 1.0
    for j in range(frees):
        x.touched.at[i * frees + j] = 0.0
    for k in range(2 * m.bonds if frees > 0 else 0):
        if x.row[k] != 0.0:
            for p in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
                x.touched.at[i * frees + mode.share_of.at[p]] = 1.0


def reach(x: Exact, rows: int, frees: int) -> None:
    """Leave open what rows that are left reach; rows that share an unknown with these are left."""
    more = True
    while more:
        more = False
        for i in range(rows):
            for j in range(frees):
                if x.touched.at[i * frees + j] == 0.0:
                    continue
                if x.left.at[i] != 0 and x.open.at[j] == 0:
                    x.open.at[j] = 1
                    more = True
                elif x.left.at[i] == 0 and x.open.at[j] != 0:
                    x.left.at[i] = 1
                    more = True


def is_rate_open(e: Engine, mode: Mode) -> bool:
    """Whether the rate of a state depends on what stays open, but those integrated along."""
    m = e.model
    for k in range(m.storages):
        if is_open(e, mode, rate_bond(m, k)):
            return True
    first = 2 * m.sources + m.dynamics
    for k in range(m.integrals):
        if e.exact.along[m.storages + k] != 0:
            continue
        for p in range(m.form_first[first + k], m.form_first[first + k + 1]):
            if m.form_column[p] < 2 * m.bonds and is_open(e, mode, m.form_column[p]):
                return True
    return False


def is_open(e: Engine, mode: Mode, b: int) -> bool:
    """Whether a bond variable depends on what stays open."""
    frees = mode.finite_frees
    for j in range(frees):
        if e.exact.open.at[j] != 0 and mode.finite_free.at[b * frees + j] != 0.0:
            return True
    return False


def solve_rows(e: Engine, mode: Mode, column: int) -> None:
    """Put bond variables into ``e.work.w``, for one component of z, the knowns standing there."""
    x = e.exact
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    by_knowns(e, mode, mode.finite, work.base)
    fit(work.residual, mode.dynamics)
    fit(work.jacobian, mode.dynamics * frees)
    fit(work.step, mode.dynamics + frees)
    fit(x.r, frees)
    rows = 0
    many = 0
    for i in range(mode.dynamics):
        if x.left.at[i] != 0:
            continue
        total = take_row(e, mode, i, column)
        for k in range(n):
            total += x.row[k] * work.base[k]
        work.residual.at[rows] = total
        by_free(mode, n, x.row, 0, x.r.at)
        many = 0
        for j in range(frees):
            if x.open.at[j] == 0:
                x.touched.at[many] = x.r.at[j]
                many += 1
        for j in range(many):
            work.jacobian.at[rows * many + j] = x.touched.at[j]
        rows += 1
    if rows > 0:
        newton_step(e, rows, many)
    many = 0
    for j in range(frees):
        x.r.at[j] = 0.0
        if x.open.at[j] == 0 and rows > 0:
            x.r.at[j] = -work.step.at[many]
            many += 1
    with_free(mode, n, work.base, x.r.at, work.w)
    if mode.leakage.stages > 0:
        project(mode.leakage, n, work.w)


def take_row(e: Engine, mode: Mode, i: int, column: int) -> float:
    """Put the slopes of a row by bond variables into `row`; return that by one component of z."""
    m = e.model
    row = e.exact.row
    for k in range(2 * m.bonds):
        row[k] = 0.0
    d = mode.dynamic[i]
    if d >= 0:
        return add_form(m, 2 * m.sources + d, 1.0, column, row)
    c = -1 - d
    total = 0.0
    for p in range(mode.constraints.first.at[c], mode.constraints.first.at[c + 1]):
        k = mode.constraints.column.at[p]
        factor = mode.constraints.value.at[p]
        if k >= m.storages:
            s = mode.source[k - m.storages]
            if s >= 0 and m.source_rate[s] >= 0:
                total += add_form(m, m.sources + s, factor, column, row)
            continue
        add_rates(m, row, k, factor)
    return total


def add_form(m: Model, form: int, factor: float, column: int, row: Floats) -> float:
    """Add a form's slopes by bond variables to `row`; return that by one component of z."""
    total = 0.0
    for p in range(m.form_first[form], m.form_first[form + 1]):
        if m.form_column[p] < 2 * m.bonds:
            row[m.form_column[p]] += factor * m.form_value[p]
        elif m.form_column[p] == column:
            total = factor * m.form_value[p]
    return total
