"""Slow motions of a linear mode beside fast ones: coordinates in which their rates are small.

Two capacitors joined by next to nothing exchange what they hold a billion times while both empty by
a leak. Each rate is a difference of large terms, and the slow one is their sum: of the leak nothing
is left beside the rounding of these. So rows are taken off each other, with twice the digits of a
number, until what is slow has a row of small entries: the sum of both charges. That is Gauss's
elimination with full pivoting as a similarity, ``b = T z``, ``b' = T M T^-1 b``. Each row of that
matrix is as right as its own size, which series and squares leave as it is.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places, grow_block, grow_places
from hybond.engine.algebra.products import largest_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.algebra.twofold import add_product, product_rest
from hybond.engine.engine import Engine
from hybond.engine.methods.linear.balance import even_unread, put_rows, take_unit
from hybond.engine.methods.linear.flow_columns import put_column_twofold
from hybond.engine.methods.linear.flow_records import Exact, Flow
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import is_alone
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.model import Model
from hybond.engine.words import Floats

ROUNDED_AWAY: Final = 0.1
"""Part of `rtol` that rounding of fast terms may move a slow motion by, over the whole run."""
RANGE: Final = 2.0**-90
"""Part of the norm below which no entry counts as fast, however long a run is."""
LESS: Final = 0.5
"""Part of its largest entry that a row is left with where something large has gone."""
SINGLE: Final = 2.0**-44
"""Part of it above which fast entries are told from others without twice the digits."""


def fast_from(rtol: float, span: float) -> float:
    """Return the rate from which on rounding of what goes so fast tells in such a time."""
    return ROUNDED_AWAY * rtol / (EPSILON * span) if span > 0.0 else math.inf


def fast_between_ports(rtol: float, span: float) -> float:
    """Return the same for what ports of one field have of each other.

    Two windings that are all but one have large entries which nothing decays by. Where one of them
    carries no current, rounding moves its flux off that of the other at such a rate, and what it is
    off by moves both at that rate once more.
    """
    return math.sqrt(ROUNDED_AWAY * rtol / EPSILON) / span if span > 0.0 else math.inf


def exchanges_fast(e: Engine, mode: Mode) -> bool:
    """Whether a rate reads what another storage holds so fast that rounding of it tells in the run.

    What laws that are solved make of it is left out.
    """
    m = e.model
    apart = fast_from(m.rtol, e.span)
    between = fast_between_ports(m.rtol, e.span)
    rows = mode.finite
    for k in range(m.storages):
        own = mode.same[rate_bond(m, k)]
        for i in range(rows.first.at[own], rows.first.at[own + 1]):
            port = rows.column.at[i]
            if port >= m.storages:
                continue
            most = apart if is_alone(m, port) else min(apart, between)
            for p in range(m.stiff_first[port], m.stiff_first[port + 1]):
                fast = math.fabs(rows.value.at[i] * m.stiff_constant[p]) > most
                if fast and m.stiff_other[p] != k:
                    return True
    return False


def grade(e: Engine, mode: Mode, f: Flow) -> None:
    """Find such coordinates for the flow of a mode, if it has slow motions beside fast ones.

    Its balanced matrix is in ``e.exact.dense``. Whether there are any is seen there at first.
    """
    x = e.exact
    n = f.n
    f.own = f.rows
    f.shares = 0
    fit_places(f.standing, e.states)
    fit_places(f.pivoted, e.states)
    fast = fast_from(e.model.rtol, e.span)
    if has_fields(e.model):
        fast = min(fast, fast_between_ports(e.model.rtol, e.span))
    fast = max(fast, RANGE * f.norm)
    if not f.norm > fast:
        return
    even_unread(f, x.dense.at, e.model.storages, e.states, f.standing)
    if not share_fast(f, e.states, fast):
        return
    fit(x.rest, n * n)
    fit(x.largest, n)
    for i in range(n * n):
        x.rest.at[i] = 0.0
    if fast >= SINGLE * f.norm and not take_off(x, f, e.states, fast):
        f.shares = 0
        return
    f.shares = 0
    for c in range(n):
        if not put_column_twofold(e, mode, f, n, c):
            return
    if not take_off(x, f, e.states, fast):
        f.shares = 0
        return
    put_back(x, f)
    f.own = f.apart
    f.norm = max(f.norm, put_rows(f.own, n, x.dense.at))
    take_unit(f)


def has_fields(m: Model) -> bool:
    """Whether any storage has part in the co-energy variable of another."""
    for k in range(m.storages):
        if not is_alone(m, k):
            return True
    return False


def share_fast(f: Flow, states: int, fast: float) -> bool:
    """Whether two rows have fast entries in one column: else there is nothing to be taken off."""
    for j in range(states):
        f.pivoted.at[j] = 0
    for i in range(states):
        for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
            j = f.rows.column.at[p]
            if j < states and math.fabs(f.rows.value.at[p]) >= fast:
                f.pivoted.at[j] += 1
                if f.pivoted.at[j] > 1:
                    return True
    return False


def take_off(x: Exact, f: Flow, states: int, fast: float) -> bool:
    """Take rows with fast entries off each other; whether one that had some is left with less.

    A row stands for the others by the largest entry that is left. States that no rate reads, such
    as signals, do not: what they have grown to would hide what they were taken off.
    """
    n = f.n
    a = x.dense.at
    for i in range(states):
        x.largest.at[i] = largest_part(states, a, i * n)
        f.pivoted.at[i] = 0
        f.standing.at[i] = 0 if is_read(a, n, i, states) else -1
    while True:
        row = -1
        column = -1
        most = 0.0
        for i in range(states):
            for j in range(states if f.standing.at[i] == 0 else 0):
                if f.pivoted.at[j] == 0 and math.fabs(a[i * n + j]) > most:
                    most = math.fabs(a[i * n + j])
                    row = i
                    column = j
        if most < fast or row < 0:
            break
        f.standing.at[row] = 1
        f.pivoted.at[column] = 1
        for k in range(states):
            if f.standing.at[k] != 1 and math.fabs(a[k * n + column]) >= fast:
                take_row_off(x, f, row, k, column)
    for i in range(states):
        if x.largest.at[i] >= fast and largest_part(states, a, i * n) < LESS * x.largest.at[i]:
            return True
    return False


def is_read(a: Floats, n: int, j: int, states: int) -> bool:
    """Whether a rate reads a state."""
    for i in range(states):
        if a[i * n + j] != 0.0:
            return True
    return False


def take_row_off(x: Exact, f: Flow, row: int, other: int, column: int) -> None:
    """Take so much of a row off another one that nothing is left in a column."""
    n = f.n
    a = x.dense.at
    r = x.rest.at
    top = row * n
    at = other * n
    pivot = a[top + column]
    share = a[at + column] / pivot
    product = share * pivot
    rest = (a[at + column] - product) - product_rest(share, pivot, product)
    rest = (rest + r[at + column] - share * r[top + column]) / pivot
    for j in range(n):
        if a[top + j] != 0.0:
            add_product(a, r, at + j, -share, -rest, top + j)
    a[at + column] = 0.0
    r[at + column] = 0.0
    grow_places(f.row, f.shares + 1)
    grow_places(f.other, f.shares + 1)
    grow_block(f.share, f.shares + 1)
    grow_block(f.share_rest, f.shares + 1)
    f.row.at[f.shares] = row
    f.other.at[f.shares] = other
    f.share.at[f.shares] = share
    f.share_rest.at[f.shares] = rest
    f.shares += 1


def put_back(x: Exact, f: Flow) -> None:
    """Make of ``T M``, which stands there, ``T M T^-1``."""
    n = f.n
    for p in range(f.shares):
        row = f.row.at[p]
        other = f.other.at[p]
        for i in range(n):
            if x.dense.at[i * n + other] != 0.0:
                add_product(
                    x.dense.at,
                    x.rest.at,
                    i * n + row,
                    f.share.at[p],
                    f.share_rest.at[p],
                    i * n + other,
                )
