"""Equations that share no unknown, solved without each other.

A factorisation of all of them mixes their rows: what is zero in one part comes out as rounding of
the other. A jump at one end of a machine would leave dust in what it has nothing to do with.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Block, Places, fit, fit_places, make_block, make_places
from hybond.engine.algebra.reached import Reached, make_reached, put_zeros
from hybond.engine.algebra.svd import Svd, least_squares
from hybond.engine.words import Floats, Ints, record

NO_PART: Final = -1


@record
class Separate:
    """Room to solve part by part; of each unknown and equation the first unknown of its part."""

    column: Places
    row: Places
    a: Block
    b: Block
    x: Block
    reached: Reached


def make_separate() -> Separate:
    """Return room for no equations."""
    p = Separate()
    p.column = make_places(1)
    p.row = make_places(1)
    p.a = make_block(1)
    p.b = make_block(1)
    p.x = make_block(1)
    p.reached = make_reached()
    return p


def least_squares_separate(
    p: Separate, d: Svd, m: int, n: int, a: Floats, relative: float, b: Floats, x: Floats
) -> None:
    """Solve ``a x = b`` of rank n in the least squares, m equations for n unknowns, part by part.

    An unknown that no value of `b` reaches is zero. `relative` as for `least_squares`, of each
    part.
    """
    find_separate(p, m, n, a)
    fit(p.a, m * n)
    fit(p.b, m)
    fit(p.x, n)
    for part in range(n):
        columns = 0
        rows = 0
        for j in range(n):
            columns += 1 if p.column.at[j] == part else 0
        for i in range(m):
            if p.row.at[i] != part:
                continue
            k = 0
            for j in range(n):
                if p.column.at[j] == part:
                    p.a.at[rows * columns + k] = a[i * n + j]
                    k += 1
            p.b.at[rows] = b[i]
            rows += 1
        if rows > 0:
            least_squares(d, rows, columns, p.a.at, relative, 1, p.b.at, p.x.at)
        if rows == columns:
            put_zeros(p.reached, rows, p.a.at, p.b.at, p.x.at)
        k = 0
        for j in range(n if columns > 0 else 0):
            if p.column.at[j] == part:
                x[j] = p.x.at[k] if rows > 0 else 0.0
                k += 1


def find_separate(p: Separate, m: int, n: int, a: Floats) -> None:
    """Find the part of each unknown, and of each equation; NO_PART if it has no unknown."""
    fit_places(p.column, n)
    fit_places(p.row, m)
    for j in range(n):
        p.column.at[j] = j
    for i in range(m):
        p.row.at[i] = NO_PART
        for j in range(n):
            if a[i * n + j] == 0.0:
                continue
            if p.row.at[i] == NO_PART:
                p.row.at[i] = j
            else:
                unite(p.column.at, p.row.at[i], j)
    for j in range(n):
        p.column.at[j] = first_of(p.column.at, j)
    for i in range(m):
        if p.row.at[i] != NO_PART:
            p.row.at[i] = p.column.at[p.row.at[i]]


def unite(first: Ints, a: int, b: int) -> None:
    """Let two be in one part; the lowest number stands for it."""
    here = first_of(first, a)
    there = first_of(first, b)
    if here < there:
        first[there] = here
    elif there < here:
        first[here] = there


def first_of(first: Ints, k: int) -> int:
    """Return what stands for the part that k is in."""
    at = k
    while first[at] != at:
        first[at] = first[first[at]]
        at = first[at]
    return at
