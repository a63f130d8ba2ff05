"""Rows whose laws are evaluated: their values, and their slopes by bond variables.

A row is a law of the model or the time derivative of a constraint.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import Block, fit
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import stiff
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.words import Floats, Ints


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
    return way_of_rate(m, k) * v[m.bond_slot + rate_bond(m, k)]


def slopes_at(e: Engine, mode: Mode, v: Floats, block: Block) -> None:
    """Put the derivatives of dynamic rows by bond variables there, a row each."""
    m = e.model
    laws = m.slope_value
    put_slopes(e, mode, v, m.slope_first, m.slope_column, laws, m.slope_constant, block)


def frozen_at(e: Engine, mode: Mode, v: Floats, block: Block) -> None:
    """Put the same there with moduli held."""
    m = e.model
    laws = m.frozen_value
    put_slopes(e, mode, v, m.frozen_first, m.frozen_column, laws, m.frozen_constant, block)


def put_slopes(
    e: Engine,
    mode: Mode,
    v: Floats,
    first: Ints,
    column: Ints,
    law: Ints,
    constant: Floats,
    block: Block,
) -> None:
    """Put the slopes of dynamic rows into `block`, those of laws by a table of slopes."""
    n = 2 * e.model.bonds
    fit(block, mode.dynamics * n)
    for i in range(mode.dynamics * n):
        block.at[i] = 0.0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0:
            hidden_slopes(e, mode, -1 - d, v, i * n, block.at)
            continue
        for p in range(first[d], first[d + 1]):
            slope = constant[p] if law[p] < 0 else value(e.model, law[p], v)
            block.at[i * n + column[p]] = slope


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
            bond = rate_bond(m, s)
            a[at + bond] += factor * stiff(m, j, v) * way_of_rate(m, s)
