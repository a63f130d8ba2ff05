"""`map_of`: an outcome of many runs over two columns, ready to be drawn on paper or on a page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.of_sweeps import NONE, Axis, OutcomeMap
from hybond.errors import UsageError

if TYPE_CHECKING:
    from hybond.sweep.table import SweepTable

Vector = NDArray[np.float64]
Numbers = NDArray[np.intp]
NAMED = 9
"""Texts with a colour of their own; the rest are one."""
INKS = (
    *("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#44bb99"),
    "#994455",
)
"""The hues of P. Tol, which stay apart for colour-blind readers."""
OTHERS = "#555555"
"""Of texts that have no colour of their own."""


def map_of(
    table: SweepTable, x: str, y: str, value: str, *, at: Mapping[str, int] | None = None
) -> OutcomeMap:
    """Return a column of a table over two others: cells of a grid of two factors, else points.

    Parameters
    ----------
    x, y, value : str
        Columns; the first two hold numbers.
    at : mapping of path to int
        Of a grid of more factors, at which level of each of the others: that slice alone.

    Raises
    ------
    UsageError
        HB-P109 for a column that there is not; HB-P113 for one that holds no numbers.
    """
    across, up, outcome = _numbers(table, x), _numbers(table, y), table[value]
    number, names, inks = _told(table, value, outcome)
    members = np.arange(len(table))
    own = _slice(table, {x, y}, at or {})
    grid = _grid(table, x, y, own)
    if grid is None:
        kept = members if own is None else members[own[members]]
        return OutcomeMap(
            Axis(x, table.unit(x), is_log(across[kept]), None),
            Axis(y, table.unit(y), is_log(up[kept]), None),
            *(value, table.unit(value), kept, across[kept], up[kept], number[kept], names, inks),
        )
    columns, rows, cells = grid
    there = cells >= 0
    found = np.full(cells.shape, np.nan)
    found[there] = number[cells[there]]
    return OutcomeMap(
        Axis(x, table.unit(x), is_log(columns), edges_of(columns)),
        Axis(y, table.unit(y), is_log(rows), edges_of(rows)),
        *(value, table.unit(value), cells.ravel(), columns, rows, found.ravel(), names, inks),
    )


def _numbers(table: SweepTable, name: str) -> Vector:
    column = table[name]
    if column.dtype == object:
        raise UsageError(
            f"{name!r} is no number",
            code="HB-P113",
            where="table",
            hint="factors and outcomes that are numbers",
        )
    if column.ndim > 1:
        raise UsageError(
            f"{name!r} is a curve", code="HB-P113", where="table", hint="one number of each run"
        )
    return np.asarray(column, dtype=float)


def _told(
    table: SweepTable, value: str, outcome: NDArray[Any]
) -> tuple[Vector, tuple[str, ...], tuple[str, ...]]:
    """Return an outcome as numbers; of texts, and of few whole numbers, which of which names."""
    if outcome.dtype != object and outcome.ndim > 1:
        _numbers(table, value)
    if any(c.text == value and c.kind == "whole" for c in table.collectors):
        few = np.unique(outcome[np.isfinite(outcome)])
        if len(few) <= NAMED:
            outcome = np.array([f"{v:.0f}" if np.isfinite(v) else "" for v in outcome], object)
    if outcome.dtype != object:
        return np.asarray(outcome, dtype=float), (), ()
    counts = Counter(map(str, outcome))
    ranked = sorted(counts, key=lambda n: (-counts[n], n))
    others = ranked[NAMED:]
    kept = [n for n in counts if n not in others]  # as they come: more members keep the colours
    names = [n or "no outcome" for n in kept] + [f"{len(others)} others"] * bool(others)
    inks = [NONE if not n else INKS[k] for k, n in enumerate(kept)] + [OTHERS] * bool(others)
    place = {n: k for k, n in enumerate(kept)}
    number = np.array([float(place.get(str(n), len(kept))) for n in outcome])
    return number, tuple(names), tuple(inks)


def _slice(table: SweepTable, names: set[str], at: Mapping[str, int]) -> NDArray[np.bool_] | None:
    """Return which members of the plan have the levels `at` of the factors beside two."""
    others = [f for f in table.plan.factors if f.path not in names and f.many != 1]
    if table.plan.way != "grid" or not others or not all(f.path in at for f in others):
        return None
    left, kept = np.arange(len(table.plan)), np.ones(len(table.plan), dtype=bool)
    for factor in reversed(table.plan.factors):
        left, level = np.divmod(left, factor.many)
        if factor in others:
            kept &= level == at[factor.path]
    return kept


def _grid(
    table: SweepTable, x: str, y: str, own: NDArray[np.bool_] | None
) -> tuple[Vector, Vector, Numbers] | None:
    """Return levels of both factors and the members between them, None if it is no such grid."""
    others = [f for f in table.plan.factors if f.path not in (x, y) and f.many != 1]
    factors = {f.path: f for f in table.plan.factors if f.many > 1}
    if table.plan.way != "grid" or x not in factors or y not in factors or x == y:
        return None
    if others and own is None:
        return None
    members = np.arange(len(table.plan)) if own is None else np.flatnonzero(own)
    level: dict[str, Numbers] = {}
    left = members
    for factor in reversed(table.plan.factors):
        left, level[factor.path] = np.divmod(left, factor.many)
    columns, i = np.unique(np.asarray(factors[x].levels, dtype=float), return_inverse=True)
    rows, j = np.unique(np.asarray(factors[y].levels, dtype=float), return_inverse=True)
    if len(columns) * len(rows) != len(members):
        return None
    cells = np.full((len(rows), len(columns)), -1, dtype=np.intp)
    cells[j[level[y]], i[level[x]]] = np.where(members < len(table), members, -1)
    return columns, rows, cells


def is_log(levels: Vector) -> bool:
    """Whether levels are apart by ratios more than by differences."""
    levels = np.unique(levels[np.isfinite(levels)])
    if len(levels) < 3 or levels[0] <= 0.0 or levels[-1] < 20.0 * levels[0]:
        return False
    middle = float(np.median(levels))
    by_ratio = abs(np.log(middle**2 / (levels[0] * levels[-1])))
    return bool(by_ratio < abs(np.log(middle / (0.5 * (levels[0] + levels[-1])))))


def edges_of(levels: Vector) -> Vector:
    """Return the edges of the cells around levels.

    Examples
    --------
    >>> edges_of(np.array([0.0, 1.0, 2.0])).tolist()
    [-0.5, 0.5, 1.5, 2.5]
    """
    log = is_log(levels)
    at = np.log(levels) if log else levels
    middle = 0.5 * (at[1:] + at[:-1])
    edges = np.concatenate([[2.0 * at[0] - middle[0]], middle, [2.0 * at[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if log else edges)
