"""How much memory the equations of a mode take."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Rows
from hybond.engine.algebra.sparse_lu import SparseLu
from hybond.engine.mode.comparisons.sum_records import Sums
from hybond.engine.mode.mode_records import Mode
from hybond.engine.model import Model

PER_BOND: Final = 18
PER_STORAGE: Final = 8
PER_SOURCE: Final = 4
"""Numbers for each bond, storage and source in the arrays of a mode that are as long as there are
of these."""


def numbers_of(m: Model, mode: Mode) -> float:
    """Return about how many numbers there is room for in a mode; two whole ones count as one."""
    total = float(PER_BOND * m.bonds + PER_STORAGE * m.storages + PER_SOURCE * m.most_sources)
    total += rows_numbers(mode.finite) + rows_numbers(mode.shared)
    total += rows_numbers(mode.own_power) + rows_numbers(mode.free_rows)
    total += rows_numbers(mode.constraints) + rows_numbers(mode.agreements)
    total += float(mode.finite_free.size + mode.free_rest.size + mode.own_power_free.size)
    total += float(mode.freedom.size + mode.free_size.size)
    total += 0.5 * float(mode.share_first.size + mode.share_of.size)
    a = mode.apart
    total += 0.5 * float(3 * a.begins.size + a.row.size + a.unknown.size + a.read.size)
    b = mode.branch
    total += float(b.when.size + b.root.size + b.own.size) + 0.5 * float(b.open_unknown.size)
    p = mode.leakage
    total += float(p.basis.size + p.taken.size + p.basis2.size + p.taken2.size)
    total += float(p.ways.size + p.leak.size + mode.unseen_ways.size)
    ways = mode.ways
    total += float(ways.directions.size + ways.moving.size + ways.d.size + ways.share.size)
    total += float(ways.slope.size + ways.inverse.size + ways.moves_by.size)
    total += 0.5 * float(ways.moves.size) + solver_numbers(ways.solver)
    t = mode.ties
    total += float(t.factor.size + t.size.size + t.rest.size + t.level.size)
    return total + sums_numbers(mode.summed)


def rows_numbers(r: Rows) -> float:
    """Return how many numbers sparse rows have room for."""
    total = float(r.value.size + r.size.size + r.rest.size)
    return total + 0.5 * float(r.first.size + r.column.size)


def solver_numbers(f: SparseLu) -> float:
    """Return how many numbers a sparse system has room for, with its factors."""
    total = 1.5 * float(f.term.size + f.lower.size + f.upper.size)
    return total + 3.0 * float(f.begins.size)


def sums_numbers(s: Sums) -> float:
    """Return how many numbers sums have room for."""
    total = float(s.factor.size + s.size.size + s.reach.size + s.wave_factor.size)
    return total + 0.5 * float(s.column.size + s.reach_part.size + s.wave_source.size)
