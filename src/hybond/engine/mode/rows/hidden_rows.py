"""Time derivatives of constraints on what is stored, as rows: what a dependent storage needs."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.elimination import give
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.model import Model
from hybond.engine.words import Floats


def is_source_timed(m: Model, mode: Mode, k: int) -> bool:
    """Whether the value of source k of a mode depends on time and inputs only."""
    return mode.source[k] < 0 or m.source_timed[mode.source[k]] != 0


def is_linear(m: Model, k: int) -> bool:
    """Whether the co-energy variable of a storage is linear, as far as its stiffness tells."""
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        if m.stiff_value[i] >= 0:
            return False
    return True


def is_constant(e: Engine, mode: Mode, pivot: int) -> bool:
    """Whether the time derivative of a constraint has constant coefficients."""
    m = e.model
    table = e.work.table
    constant = is_linear(m, pivot)
    for i in range(table.first[pivot], table.first[pivot] + table.count[pivot]):
        k = table.column.at[i]
        if k < m.storages:
            constant = constant and is_linear(m, k)
        elif mode.source[k - m.storages] >= 0:
            constant = constant and m.source_linear[mode.source[k - m.storages]] != 0
    return constant


def give_hidden(e: Engine, mode: Mode, pivot: int, value0: int) -> None:
    """Give the time derivative of a constraint with constant coefficients."""
    m = e.model
    table = e.work.table
    finite = e.work.finite
    row = e.work.base
    for k in range(2 * m.bonds):
        row[k] = 0.0
    add_rates(m, row, pivot, 1.0)
    for i in range(table.first[pivot], table.first[pivot] + table.count[pivot]):
        k = table.column.at[i]
        c = table.entry.at[i]
        if k < m.storages:
            add_rates(m, row, k, c)
        elif has_rate(m, mode, k - m.storages):
            give(finite, value0 + (k - m.storages) + mode.sources, c)
    for k in range(2 * m.bonds):
        if row[k] != 0.0:
            give(finite, k, row[k])


def has_rate(m: Model, mode: Mode, k: int) -> bool:
    """Whether the value of source k of a mode moves with time."""
    return mode.source[k] >= 0 and m.source_rate[mode.source[k]] >= 0


def add_rates(m: Model, row: Floats, k: int, c: float) -> None:
    """Add c times the rate of a co-energy variable, by bond variables."""
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        s = m.stiff_other[i]
        at = rate_bond(m, s)
        row[at] += c * m.stiff_constant[i] * way_of_rate(m, s)
