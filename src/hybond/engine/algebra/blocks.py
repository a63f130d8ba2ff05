"""Arrays that are made larger where one mode needs more than another, and sparse rows."""

from __future__ import annotations

import math

from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Block:
    """Numbers; there is room for `size` of them."""

    size: int
    at: Floats


@record
class Places:
    """Whole numbers; there is room for `size` of them."""

    size: int
    at: Ints


@record
class Rows:
    """Sparse rows: those of row k are ``first[k] <= i < first[k + 1]``."""

    rows: int
    first: Places
    column: Places
    value: Block
    size: Block
    """What rounding of each value is measured by, at least its magnitude; where somebody asks."""
    rest: Block
    """By what each value is more than it was rounded to; where somebody asks."""


def make_block(n: int) -> Block:
    """Return room for n numbers."""
    b = Block()
    b.size = max(n, 1)
    b.at = floats(b.size)
    return b


def make_places(n: int) -> Places:
    """Return room for n whole numbers."""
    p = Places()
    p.size = max(n, 1)
    p.at = ints(p.size)
    return p


def make_rows() -> Rows:
    """Return no rows."""
    r = Rows()
    r.first = make_places(1)
    r.column = make_places(1)
    r.value = make_block(1)
    r.size = make_block(1)
    r.rest = make_block(1)
    return r


def fit(b: Block, n: int) -> None:
    """Make room for n numbers; what was there may be lost."""
    if n > b.size:
        b.size = n + n // 2
        b.at = floats(b.size)


def grow_block(b: Block, n: int) -> None:
    """Make room for n numbers; what was there is kept."""
    if n <= b.size:
        return
    old = b.at
    have = b.size
    b.size = n + n // 2
    b.at = floats(b.size)
    for k in range(have):
        b.at[k] = old[k]


def fit_places(p: Places, n: int) -> None:
    """Make room for n whole numbers; what was there may be lost."""
    if n > p.size:
        p.size = n + n // 2
        p.at = ints(p.size)


def grow_places(p: Places, n: int) -> None:
    """Make room for n whole numbers; what was there is kept."""
    if n <= p.size:
        return
    old = p.at
    have = p.size
    p.size = n + n // 2
    p.at = ints(p.size)
    for k in range(have):
        p.at[k] = old[k]


def fit_rows(r: Rows, rows: int, entries: int) -> None:
    """Make room for rows and their entries."""
    r.rows = rows
    fit_places(r.first, rows + 1)
    fit_places(r.column, entries)
    fit(r.value, entries)
    fit(r.size, entries)
    fit(r.rest, entries)


def row_times(r: Rows, k: int, x: Floats) -> float:
    """Return the product of row k with a vector."""
    total = 0.0
    for i in range(r.first.at[k], r.first.at[k + 1]):
        total += r.value.at[i] * x[r.column.at[i]]
    return total


def row_size(r: Rows, k: int, x: Floats) -> float:
    """Return the sum of the magnitudes of the terms of that product."""
    total = 0.0
    for i in range(r.first.at[k], r.first.at[k + 1]):
        total += r.size.at[i] * math.fabs(x[r.column.at[i]])
    return total


def spread_rows(r: Rows, columns: int, a: Floats) -> None:
    """Put sparse rows, of so many columns, into `a` row after row."""
    for i in range(r.rows * columns):
        a[i] = 0.0
    for k in range(r.rows):
        for i in range(r.first.at[k], r.first.at[k + 1]):
            a[k * columns + r.column.at[i]] = r.value.at[i]
