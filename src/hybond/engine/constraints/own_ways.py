"""Ways to jump of which each has a storage of its own.

The impulses that move what is stored are found by an orthonormal basis, in which each of them moves
a little of everything. By such ways a charge of 1e-10 C beside one of 1 C is a difference of two
numbers of the size of 1, and rounding leaves no digit of it. In echelon form each way is the change
of one storage, exact, and what that brings about in others; small storages come first.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Ways
from hybond.engine.words import Floats

NO_PART: Final = 1e-10
"""A way takes no part in what it moves by less than this part of the others."""


def give_own(e: Engine, ways: Ways, extents: Floats) -> None:
    """Put `ways.d` into echelon form, a storage for each column, and `ways.moving` with it.

    `extents` say how much each storage may hold.
    """
    storages = e.model.storages
    areas = ways.areas
    w = e.work
    fit(w.row_size, storages)
    fit_places(w.column, storages)
    for k in range(storages):
        w.column.at[k] = 0
        w.row_size.at[k] = 0.0
        for a in range(areas):
            w.row_size.at[k] = max(w.row_size.at[k], math.fabs(ways.d.at[k * areas + a]))
        for a in range(areas):
            if math.fabs(ways.d.at[k * areas + a]) <= CANCELS * w.row_size.at[k]:
                ways.d.at[k * areas + a] = 0.0
    for a in range(areas):
        own = -1
        column = a
        most = 0.0
        for k in range(storages):
            if w.column.at[k] != 0:
                continue
            for j in range(a, areas):
                entry = math.fabs(ways.d.at[k * areas + j])
                if entry > NO_PART * w.row_size.at[k] and entry / extents[k] > most:
                    most = entry / extents[k]
                    own = k
                    column = j
        if own < 0:
            return
        w.column.at[own] = 1
        swap_columns(storages, areas, a, column, ways.d.at)
        swap_columns(ways.many, areas, a, column, ways.moving.at)
        pivot = ways.d.at[own * areas + a]
        scale_column(storages, areas, a, pivot, ways.d.at)
        scale_column(ways.many, areas, a, pivot, ways.moving.at)
        ways.d.at[own * areas + a] = 1.0
        for j in range(areas):
            part = ways.d.at[own * areas + j]
            if j != a and part != 0.0:
                take_column(storages, areas, a, j, part, ways.d.at)
                take_column(ways.many, areas, a, j, part, ways.moving.at)
                ways.d.at[own * areas + j] = 0.0


def swap_columns(rows: int, columns: int, a: int, b: int, x: Floats) -> None:
    """Exchange two columns."""
    if a == b:
        return
    for i in range(rows):
        kept = x[i * columns + a]
        x[i * columns + a] = x[i * columns + b]
        x[i * columns + b] = kept


def scale_column(rows: int, columns: int, a: int, by: float, x: Floats) -> None:
    """Divide a column."""
    for i in range(rows):
        x[i * columns + a] = x[i * columns + a] / by


def take_column(rows: int, columns: int, a: int, j: int, part: float, x: Floats) -> None:
    """Take a part of column `a` off column `j`."""
    for i in range(rows):
        before = x[i * columns + j]
        taken = part * x[i * columns + a]
        after = before - taken
        dust = math.fabs(after) <= CANCELS * (math.fabs(before) + math.fabs(taken))
        x[i * columns + j] = 0.0 if dust else after
