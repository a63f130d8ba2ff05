"""The rows of a mode that are evaluated anew each time, solved once where they are linear.

A controlled source, or a law written out as a formula, makes a row of a mode's equations dynamic.
Where such rows are linear in bond variables with constant factors, the unknowns that they determine
are solved for here; those of other rows stay open, and so do bond variables that depend on them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables.generators import Found, Terms, of_name, terms_of
from hybond.equations.element_parts import Dynamic
from hybond.equations.mode import ModeEquations
from hybond.model.expressions import posterior_names

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
SINGULAR = 1e-10
"""Part of the largest singular value below which rows do not determine their unknowns."""


@dataclass(frozen=True, slots=True)
class SolvedRows:
    """Bond variables by knowns: ``w = known[row] xi``.

    Parameters
    ----------
    known : array, shape (classes, knowns)
    row : array of int, shape (2 * bonds,)
    open : array of bool, shape (2 * bonds,)
        Whether more than that is in a bond variable.
    rests : list of Terms
        Further knowns, after those of the equations: what linear rows add.
    """

    known: Matrix
    row: NDArray[np.intp]
    open: NDArray[np.bool_]
    rests: list[Found]


def solve_rows(equations: ModeEquations, name: Callable[[str], Found]) -> SolvedRows:
    """Return the bond variables of a mode; `name` gives the terms of what is none."""
    solved = equations.finite
    if not equations.rows:
        nothing = np.zeros(len(solved.row), dtype=bool)
        shown = equations.shown
        return SolvedRows(shown.known.dense(), shown.row, nothing, [])
    n, x = equations.n2, solved.spread()
    read = [_row(d, equations, name) for d in equations.rows]
    slopes = np.array([s for s, _ in read])
    touched = np.abs(slopes) @ np.abs(n) > 0.0
    left = np.array([rest is None for _, rest in read])
    if equations.project is not None or equations.rank != len(equations.structure):
        left[:] = True
    columns = _reached(touched, left)
    linear = np.flatnonzero(~left)
    free = np.flatnonzero(~columns)
    square = slopes[linear] @ n[:, free]
    sound = len(linear) == len(free)
    if sound and len(free):
        sizes = np.linalg.svd(square, compute_uv=False)
        sound = bool(sizes[-1] > SINGULAR * sizes[0])
    if not sound:
        columns[:] = True
        linear, free = linear[:0], free[:0]
        square = square[:0, :0]
    by_rows = n[:, free] @ np.linalg.inv(square)
    known = np.hstack([x - by_rows @ (slopes[linear] @ x), -by_rows])
    rests: list[Found] = [rest for k in linear.tolist() if (rest := read[k][1]) is not None]
    return SolvedRows(known, np.arange(len(known)), np.any(n[:, columns] != 0.0, axis=1), rests)


def _row(
    d: Dynamic, equations: ModeEquations, name: Callable[[str], Found]
) -> tuple[Vector, Terms | None]:
    """Return factors of bond variables and what else is in a row; None if it is not linear."""
    slots = equations.slots
    slopes = np.zeros(slots.w.stop - slots.w.start)
    found = terms_of(d.expression, lambda path: of_name(path) if _is_bond(path) else name(path))
    rest: Terms = {}
    straight = isinstance(found, dict)
    for key, c in found.items() if isinstance(found, dict) else ():
        rate, shift, names = key
        if not any(map(_is_bond, names)):
            rest[key] = c
        elif rate or shift or len(names) > 1:
            straight = False
        else:
            slopes[slots.index[names[0]] - slots.w.start] = c.real
    if straight:
        return slopes, rest
    for path in filter(_is_bond, posterior_names(d.expression)):
        slopes[slots.index[path] - slots.w.start] = 1.0
    return slopes, None


def _is_bond(path: str) -> bool:
    return path.startswith(("e:", "f:"))


def _reached(touched: NDArray[np.bool_], left: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the unknowns that rows which are `left` reach; rows that share one are left too."""
    columns = np.zeros(touched.shape[1], dtype=bool)
    while True:
        columns |= touched[left].any(axis=0)
        more = touched[:, columns].any(axis=1) & ~left
        if not more.any():
            return columns
        left |= more


def is_open(rows: SolvedRows, pairs: Sequence[tuple[int, int]]) -> bool:
    """Whether a power, effort times flow, is open: unless one of the two is always zero."""
    for e, f in pairs:
        nothing = [not rows.open[k] and not rows.known[rows.row[k]].any() for k in (e, f)]
        if not any(nothing) and (rows.open[e] or rows.open[f]):
            return True
    return False
