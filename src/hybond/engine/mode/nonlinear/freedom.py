"""Directions in which a linear system leaves its unknowns free.

Whether a sum vanishes is measured by the terms it was made of, and which entry is large by those of
its row and column: neither depends on units. What no free unknown is coupled to is exactly zero in
every direction.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.algebra.scaling import balance_sides
from hybond.engine.engine import Engine
from hybond.engine.words import Floats
from hybond.engine.work import Work

VANISHES: Final = 1e-10
"""A sum below this part of its terms is zero: slopes are known no better."""
RELUCTANT: Final = 1e-3
"""Part of what an entry counts with in the choice of what is moved, if a bent law reads that."""
NO_ROW: Final = -1


def directions_left(e: Engine, rows: int, columns: int, a: Floats, free: Floats) -> int:
    """Put a basis of what ``a x = 0`` leaves free into the columns of `free`; return how many.

    `a` has so many rows and columns, all finite, and is kept. Each direction moves one unknown by
    1 that the others do not move.
    """
    w = e.work
    wide = columns + 1
    left = columns - eliminate_fully(w, rows, columns, a, False)
    at = 0
    for j in range(columns):
        if w.pivot_row.at[j] != NO_ROW:
            continue
        for k in range(columns):
            row = w.pivot_row.at[k]
            move = 0.0
            if k == j:
                move = 1.0
            elif row != NO_ROW:
                ratio = -w.reduced.at[row * wide + j] / w.reduced.at[row * wide + k]
                move = ratio * w.column_scale.at[k] / w.column_scale.at[j]
            free[k * left + at] = move
        at += 1
    return left


def rank_here(e: Engine, rows: int, columns: int, a: Floats) -> int:
    """Return the rank of a matrix with finite entries."""
    return eliminate_fully(e.work, rows, columns, a, False)


def step_of_singular(e: Engine, rows: int, columns: int) -> None:
    """Solve ``jacobian step = residual``, what is left free being zero, as far as there is one.

    What cancels is exactly zero in the step as well. What bent laws read is rather left than moved:
    a law without a slope, as a sign at zero, promises nothing of what is beside it.
    """
    w = e.work
    wide = columns + 1
    eliminate_fully(w, rows, columns, w.jacobian.at, True)
    for k in range(columns):
        row = w.pivot_row.at[k]
        w.step.at[k] = 0.0
        if row != NO_ROW:
            ratio = w.reduced.at[row * wide + columns] / w.reduced.at[row * wide + k]
            w.step.at[k] = ratio * w.column_scale.at[k]


def eliminate_fully(w: Work, rows: int, columns: int, a: Floats, with_residual: bool) -> int:
    """Reduce a matrix by its largest entries, into ``w.reduced``; return its rank.

    ``w.pivot_row`` says which row determines each unknown, or NO_ROW. A column behind the others is
    reduced with them: the residual, or zero.
    """
    wide = columns + 1
    fit(w.reduced, rows * wide)
    fit(w.reduced_size, rows * wide)
    fit(w.row_scale, rows)
    fit(w.column_scale, columns)
    fit(w.across, rows)
    fit(w.down, columns)
    fit_places(w.pivot_row, columns)
    fit_places(w.row_taken, rows)
    balance_sides(rows, columns, a, w.row_scale.at, w.column_scale.at, w.across.at, w.down.at)
    for i in range(rows):
        w.row_taken.at[i] = 0
        for j in range(columns):
            scaled = a[i * columns + j] * w.row_scale.at[i] * w.column_scale.at[j]
            w.reduced.at[i * wide + j] = scaled
            w.reduced_size.at[i * wide + j] = math.fabs(scaled)
        own = w.residual.at[i] * w.row_scale.at[i] if with_residual else 0.0
        w.reduced.at[i * wide + columns] = own
        w.reduced_size.at[i * wide + columns] = math.fabs(own)
    for j in range(columns):
        w.pivot_row.at[j] = NO_ROW
    rank = 0
    while rank < rows and rank < columns:
        row = NO_ROW
        column = 0
        most = 0.0
        for i in range(rows):
            if w.row_taken.at[i] != 0:
                continue
            for j in range(columns):
                size = math.fabs(w.reduced.at[i * wide + j])
                if with_residual and w.reluctant[j] != 0:
                    size *= RELUCTANT
                if w.pivot_row.at[j] == NO_ROW and size > most:
                    most = size
                    row = i
                    column = j
        if row == NO_ROW:
            break
        w.row_taken.at[row] = 1
        w.pivot_row.at[column] = row
        take_off_others(w, rows, columns, row, column)
        rank += 1
    return rank


def take_off_others(w: Work, rows: int, columns: int, row: int, column: int) -> None:
    """Take a row off all others such that their entries in a column vanish."""
    wide = columns + 1
    pivot = w.reduced.at[row * wide + column]
    for i in range(rows):
        entry = w.reduced.at[i * wide + column]
        if i == row or entry == 0.0:
            continue
        factor = entry / pivot
        w.reduced.at[i * wide + column] = 0.0
        for j in range(wide):
            if j < columns and w.pivot_row.at[j] != NO_ROW:
                continue
            at = i * wide + j
            part = math.fabs(factor) * w.reduced_size.at[row * wide + j]
            w.reduced_size.at[at] = max(w.reduced_size.at[at], part)
            total = w.reduced.at[at] - factor * w.reduced.at[row * wide + j]
            least = VANISHES if j < columns else CANCELS
            zero = math.fabs(total) <= least * w.reduced_size.at[at]
            w.reduced.at[at] = 0.0 if zero else total
