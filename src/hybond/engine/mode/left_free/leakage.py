"""Undetermined variables: the member of the admissible set with the least leakage power.

First the leaks of controlled junctions, then those of the undetermined bonds.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, Rows, fit, fit_places, grow_block, grow_places
from hybond.engine.algebra.products import (
    copy_floats,
    copy_part,
    largest,
    largest_part,
    times_cancelling,
    times_orthonormal,
)
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.algebra.svd import null_space, pseudo_inverse
from hybond.engine.engine import Engine, svd_room
from hybond.engine.mode.mode_records import Leakage, Mode
from hybond.engine.model import Model
from hybond.engine.words import Floats

MOVED: Final = 1e-9
"""A variable is undetermined if a unit of freedom moves it by more than this."""
RANK: Final = 1e-10


def junction_rows(m: Model, mode: Mode, rows: Floats) -> int:
    """Put the rows there whose squares are the leakage power of controlled junctions.

    Blocked effort of an OFF 1-junction, shorted flow of an OFF 0-junction, through flow of an ON
    1-junction, common effort of an ON 0-junction. Returns how many there are.
    """
    n = 2 * m.bonds
    many = 0
    for j in range(m.junctions):
        if m.junction_switch[j] < 0 or m.end_first[j] == m.end_first[j + 1]:
            continue
        for k in range(n):
            rows[many * n + k] = 0.0
        common = 0 if m.junction_kind[j] == 0 else m.bonds
        if mode.on[m.junction_switch[j]] == 0:
            for i in range(m.end_first[j], m.end_first[j + 1]):
                rows[many * n + m.bonds - common + m.end_bond[i]] += float(m.end_sign[i])
        else:
            rows[many * n + common + m.end_bond[m.end_first[j]]] = 1.0
        many += 1
    return many


def is_undetermined(n: int, many: int, freedom: Floats, k: int) -> bool:
    """Whether the columns of `freedom`, of n rows, move bond variable k."""
    return largest_part(many, freedom, k * many) > MOVED * largest(n * many, freedom)


def least_leakage(e: Engine, mode: Mode, many: int, freedom: Floats, p: Leakage) -> None:
    """Find the projection of any solution onto the one of least leakage.

    `freedom` has a row for each bond variable and `many` columns: directions in which they are
    free. Where these, and what leaks, are what they were, so is the projection: what a loop of
    junctions leaves free is so at every instant.
    """
    m = e.model
    w = e.work
    n = 2 * m.bonds
    if many == 0:
        forget_leakage(p)
        return
    fit(w.a, (m.junctions + 1) * n)
    rows = junction_rows(m, mode, w.a.at)
    if mode.dynamics > 0 and many == p.many and rows == p.leaks:
        if is_same(n * many, freedom, p.ways.at) and is_same(rows * n, w.a.at, p.leak.at):
            p.stages = p.found
            return
    find_leakage(e, n, rows, many, freedom, p)
    if mode.dynamics == 0:
        return  # nothing is asked for again
    fit(p.ways, n * many)
    fit(p.leak, max(rows, 1) * n)
    copy_floats(n * many, freedom, p.ways.at)
    copy_floats(rows * n, w.a.at, p.leak.at)
    p.many = many
    p.leaks = rows
    p.found = p.stages


def forget_leakage(p: Leakage) -> None:
    """Let nothing be taken off."""
    p.stages = 0
    p.first = 0
    p.second = 0
    p.many = 0


def is_same(n: int, a: Floats, b: Floats) -> bool:
    """Whether n numbers are the same."""
    for i in range(n):
        if a[i] != b[i]:
            return False
    return True


def find_leakage(e: Engine, n: int, rows: int, many: int, freedom: Floats, p: Leakage) -> None:
    """Find it, `rows` rows of what leaks being in ``e.work.a``."""
    w = e.work
    forget_leakage(p)
    fit(w.b, max(rows, n) * many)
    fit(w.c, many * max(rows, n) + many * many)
    fit(p.amount, many)
    d = svd_room(e, max(rows, n), max(many, n))
    left = many
    fit(p.basis2, n * many)
    if rows > 0:
        fit(p.basis, n * many)
        fit(p.taken, many * n)
        copy_floats(n * many, freedom, p.basis.at)
        times_cancelling(rows, n, many, w.a.at, freedom, w.b.at)
        pseudo_inverse(d, rows, many, w.b.at, MOVED, w.c.at)
        clear_rounding(many * rows, w.c.at)
        times_cancelling(many, rows, n, w.c.at, w.a.at, p.taken.at)
        p.first = many
        p.stages = 1
        left = null_space(d, rows, many, w.b.at, RANK, w.c.at)
        times_orthonormal(n, many, left, freedom, w.c.at, p.basis2.at)
    else:
        copy_floats(n * many, freedom, p.basis2.at)
    if left == 0:
        return
    # second stage: the undetermined bonds
    fit(p.taken2, left * n)
    bonds = 0
    for k in range(n):
        if is_undetermined(n, many, freedom, k):
            copy_part(left, p.basis2.at, k * left, w.b.at, bonds * left)
            bonds += 1
    if bonds == 0:
        return
    pseudo_inverse(d, bonds, left, w.b.at, MOVED, w.c.at)
    clear_rounding(left * bonds, w.c.at)
    row = 0
    for k in range(n):
        moved = is_undetermined(n, many, freedom, k)
        for i in range(left):
            p.taken2.at[i * n + k] = w.c.at[i * bonds + row] if moved else 0.0
        if moved:
            row += 1
    p.second = left
    p.stages = 2


def clear_rounding(n: int, a: Floats) -> None:
    """Make zero what rounding leaves of it in a pseudo-inverse: a small part of its largest."""
    most = largest(n, a)
    for i in range(n):
        if math.fabs(a[i]) <= CANCELS * most:
            a[i] = 0.0


def project(p: Leakage, n: int, w: Floats) -> None:
    """Replace bond variables by those of least leakage."""
    if p.first > 0:
        take_off(n, p.first, p.basis.at, p.taken.at, p.amount.at, w)
    if p.second > 0:
        take_off(n, p.second, p.basis2.at, p.taken2.at, p.amount.at, w)


def take_off(n: int, many: int, basis: Floats, taken: Floats, amount: Floats, w: Floats) -> None:
    """Take ``basis taken w`` off `w`; what is left of a variable as rounding is zero."""
    for i in range(many):
        total = 0.0
        for k in range(n):
            total += taken[i * n + k] * w[k]
        amount[i] = total
    for k in range(n):
        total = 0.0
        size = math.fabs(w[k])
        for i in range(many):
            term = basis[k * many + i] * amount[i]
            total += term
            size += math.fabs(term)
        if total != 0.0:
            left = w[k] - total
            w[k] = left if math.fabs(left) > CANCELS * size else 0.0


def fold(e: Engine, mode: Mode) -> None:
    """Take least leakage off the rows of a mode in which nothing is left to Newton.

    It is the same at every instant there: ``direct = (1 - basis2 taken2)(1 - basis taken) finite``.
    """
    p = mode.leakage
    w = e.work
    n = 2 * e.model.bonds
    first = p.first * mode.knowns
    # what each projection takes off the rows, and the sizes of the terms of that
    fit(w.a, 2 * first)
    times_rows(mode, p.first, n, p.taken.at, w.a)
    fit(w.b, 2 * p.second * mode.knowns)
    times_rows(mode, p.second, n, p.taken2.at, w.b)
    after_first(p, n, mode.knowns, w.a.at, w.b.at)
    mode.direct = mode.shared
    fit_places(mode.direct.first, n + 1)
    mode.direct.rows = n
    fit(w.row, 3 * mode.knowns)
    entries = 0
    for k in range(n):
        mode.direct.first.at[k] = entries
        if mode.same[k] == k:
            put_finite(mode, k, w.row.at)
            less_share(p.first, mode.knowns, p.basis.at, k * p.first, w.a.at, w.row.at)
            less_share(p.second, mode.knowns, p.basis2.at, k * p.second, w.b.at, w.row.at)
            entries = keep_entries(mode.direct, entries, mode.knowns, w.row.at)
    mode.direct.first.at[n] = entries


def times_rows(mode: Mode, many: int, n: int, taken: Floats, out: Block) -> None:
    """Put ``taken finite`` into `out`, of `many` rows, and below it the sizes of its terms."""
    rows = mode.finite
    sizes = many * mode.knowns
    for i in range(2 * sizes):
        out.at[i] = 0.0
    for i in range(many):
        for k in range(n):
            factor = taken[i * n + k]
            if factor == 0.0:
                continue
            for j in range(rows.first.at[mode.same[k]], rows.first.at[mode.same[k] + 1]):
                at = i * mode.knowns + rows.column.at[j]
                term = factor * rows.value.at[j]
                out.at[at] += term
                out.at[sizes + at] += math.fabs(term)


def after_first(p: Leakage, n: int, knowns: int, first: Floats, second: Floats) -> None:
    """Make what the second projection takes off what it takes off after the first."""
    for i in range(p.second):
        for j in range(p.first):
            factor = 0.0
            for k in range(n):
                factor += p.taken2.at[i * n + k] * p.basis.at[k * p.first + j]
            for c in range(knowns):
                second[i * knowns + c] -= factor * first[j * knowns + c]
                at = p.second * knowns + i * knowns + c
                second[at] += math.fabs(factor) * first[p.first * knowns + j * knowns + c]


def put_finite(mode: Mode, k: int, row: Floats) -> None:
    """Put row k of what knowns give there, behind it the sizes of its terms and their rests."""
    for j in range(3 * mode.knowns):
        row[j] = 0.0
    for i in range(mode.finite.first.at[k], mode.finite.first.at[k + 1]):
        row[mode.finite.column.at[i]] = mode.finite.value.at[i]
        row[mode.knowns + mode.finite.column.at[i]] = math.fabs(mode.finite.value.at[i])
        row[2 * mode.knowns + mode.finite.column.at[i]] = mode.finite.rest.at[i]


def less_share(many: int, knowns: int, basis: Floats, at: int, taken: Floats, row: Floats) -> None:
    """Take ``basis taken`` off a row, whose part of `basis` begins at `at`; add to the sizes.

    What a projection takes off has the digits of one number, and so has what it leaves.
    """
    for i in range(many):
        factor = basis[at + i]
        if factor == 0.0:
            continue
        for j in range(knowns):
            row[j] -= factor * taken[i * knowns + j]
            row[knowns + j] += math.fabs(factor) * taken[(many + i) * knowns + j]
            row[2 * knowns + j] = 0.0


def keep_entries(rows: Rows, entries: int, knowns: int, row: Floats) -> int:
    """Keep what is more than rounding of a row as the next of `rows`; return where it ends."""
    for j in range(knowns):
        if math.fabs(row[j]) > CANCELS * row[knowns + j]:
            grow_places(rows.column, entries + 1)
            grow_block(rows.value, entries + 1)
            grow_block(rows.size, entries + 1)
            grow_block(rows.rest, entries + 1)
            rows.column.at[entries] = j
            rows.value.at[entries] = row[j]
            rows.size.at[entries] = row[knowns + j]
            rows.rest.at[entries] = row[2 * knowns + j]
            entries += 1
    return entries
