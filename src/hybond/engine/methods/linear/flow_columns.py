"""The matrix of a linear mode, column after column, by the rows of the mode.

Stored quantities, signals and generators stand for themselves; bond variables follow from them as
they do at any instant.
"""

from __future__ import annotations

from hybond.engine.algebra.products import all_finite
from hybond.engine.algebra.twofold import product_rest, sum_rest
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.methods.linear.flow_records import Exact, Flow
from hybond.engine.methods.linear.linear_rows import solve_rows
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.reading import read_by_knowns
from hybond.engine.mode.rows.storage import is_alone
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.model import Model


def stands_alone(m: Model, mode: Mode) -> bool:
    """Whether rates are rows of a mode in which each storage stands for itself and in no source."""
    if mode.dynamics > 0 or m.integrals > 0:
        return False
    for k in range(m.storages):
        if not is_alone(m, k):
            return False
    for k in range(mode.sources):
        s = mode.source[k]
        if s >= 0 and m.source_value[s] >= 0 and reads_state(m, s):
            return False
        if s >= 0 and mode.rated[k] != 0 and reads_state(m, m.sources + s):
            return False
    return True


def reads_state(m: Model, form: int) -> bool:
    """Whether a form has terms with bond variables or with what is stored, which are its first."""
    first = m.form_first[form]
    return first < m.form_first[form + 1] and m.form_column[first] < 2 * m.bonds + m.storages


def put_stored(e: Engine, mode: Mode, n: int) -> None:
    """Put what the rates are by each stored quantity alone there: entries of rows as they are."""
    m = e.model
    rows = mode.direct
    for k in range(m.storages):
        way = way_of_rate(m, k)
        for i in range(rows.first.at[mode.rate_row[k]], rows.first.at[mode.rate_row[k] + 1]):
            c = rows.column.at[i]
            if c < m.storages:
                rate = rows.value.at[i] * m.stiff_constant[m.stiff_first[c]]
                e.exact.dense.at[k * n + c] = way * rate


def put_column(e: Engine, mode: Mode, f: Flow, n: int, c: int) -> int:
    """Put what the states' rates are, where all but component c of z is zero."""
    m = e.model
    x = e.exact
    w = e.work.w
    column = 2 * m.bonds + (c if c < e.states else e.states + f.gen[c - e.states])
    put_knowns(e, mode, column, c)
    if mode.dynamics == 0:
        read_by_knowns(mode, mode.rates, e.work.xi, w)
    else:
        solve_rows(e, mode, column)
        if not all_finite(2 * m.bonds, w):
            return NOT_FINITE
    for k in range(m.storages):
        at = rate_bond(m, k)
        x.dense.at[k * n + c] = way_of_rate(m, k) * w[at]
    first = 2 * m.sources + m.dynamics
    for k in range(m.integrals):
        if x.along[m.storages + k] != 0:
            continue
        total = form_at(m, first + k, column)
        for p in range(m.form_first[first + k], m.form_first[first + k + 1]):
            if m.form_column[p] < 2 * m.bonds:
                total += m.form_value[p] * w[m.form_column[p]]
        x.dense.at[(m.storages + k) * n + c] = total
    return OK


def put_column_twofold(e: Engine, mode: Mode, f: Flow, n: int, c: int) -> bool:
    """Put the same there in units of the flow, with twice the digits; False if it has not them."""
    m = e.model
    x = e.exact
    if mode.dynamics > 0 and mode.leakage.stages > 0:
        return False
    column = 2 * m.bonds + (c if c < e.states else e.states + f.gen[c - e.states])
    put_knowns(e, mode, column, c)
    if mode.dynamics > 0:
        solve_rows(e, mode, column)
    for k in range(m.storages):
        at = rate_bond(m, k)
        x.total = 0.0
        x.over = 0.0
        add_bond_twofold(e, mode, at, way_of_rate(m, k))
        put_twofold(x, f, n, k, c)
    first = 2 * m.sources + m.dynamics
    for k in range(m.integrals):
        x.total = 0.0
        x.over = 0.0
        if x.along[m.storages + k] == 0:
            x.total = form_at(m, first + k, column)
            for p in range(m.form_first[first + k], m.form_first[first + k + 1]):
                if m.form_column[p] < 2 * m.bonds:
                    add_bond_twofold(e, mode, m.form_column[p], m.form_value[p])
        put_twofold(x, f, n, m.storages + k, c)
    return True


def add_bond_twofold(e: Engine, mode: Mode, b: int, factor: float) -> None:
    """Add a bond variable with a factor to the sum with twice the digits."""
    rows = mode.finite if mode.dynamics > 0 else mode.direct
    for i in range(rows.first.at[mode.same[b]], rows.first.at[mode.same[b] + 1]):
        known = e.work.xi[rows.column.at[i]]
        if known != 0.0:
            add_twofold(e.exact, rows.value.at[i], rows.rest.at[i], known, factor)
    if mode.dynamics == 0:
        return
    for j in range(mode.finite_frees):
        at = b * mode.finite_frees + j
        free = e.work.w[mode.free_column[j]]
        if mode.finite_free.at[at] != 0.0 and free != 0.0:
            add_twofold(e.exact, mode.finite_free.at[at], mode.free_rest.at[at], free, factor)


def add_twofold(x: Exact, value: float, rest: float, known: float, factor: float) -> None:
    """Add a product of three, the first of which has a rest."""
    product = value * known
    over = product_rest(value, known, product) + rest * known
    term = product * factor
    over = product_rest(product, factor, term) + over * factor
    before = x.total
    x.total = before + term
    x.over += sum_rest(before, term, x.total) + over


def put_twofold(x: Exact, f: Flow, n: int, i: int, c: int) -> None:
    """Put the sum into the matrix, and by what it is more than it is rounded to."""
    unit = f.scale.at[c] / f.scale.at[i]
    total = x.total + x.over
    x.dense.at[i * n + c] = total * unit
    x.rest.at[i * n + c] = sum_rest(x.total, x.over, total) * unit


def form_at(m: Model, form: int, column: int) -> float:
    """Return the factor of one column in a form."""
    for p in range(m.form_first[form], m.form_first[form + 1]):
        if m.form_column[p] == column:
            return m.form_value[p]
    return 0.0


def put_knowns(e: Engine, mode: Mode, column: int, c: int) -> None:
    """Put the knowns where all but one component is zero into ``e.work.xi``."""
    m = e.model
    xi = e.work.xi
    one = 2 * m.bonds + e.states + m.generator_one
    for k in range(m.storages):
        xi[k] = 0.0
        for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
            if m.stiff_other[i] == c:
                xi[k] += m.stiff_constant[i]
    for k in range(mode.sources):
        s = mode.source[k]
        at = m.storages + k
        xi[at + mode.sources] = 0.0
        if s < 0 or m.source_value[s] < 0:
            xi[at] = mode.source_level[k] if column == one else 0.0
        else:
            xi[at] = form_at(m, s, column)
        if s >= 0 and mode.rated[k] != 0:
            xi[at + mode.sources] = form_at(m, m.sources + s, column)
