"""What the table of a sweep is looked at as: the methods of `SweepTable` that count and draw.

`spread_of` has a curve of many runs ready to be drawn: some of them, and bands of quantiles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from hybond.draw.of_sweeps import Spread
from hybond.errors import UsageError
from hybond.names import did_you_mean
from hybond.sweep.indices import SobolIndices, sobol_indices
from hybond.sweep.maps import map_of

if TYPE_CHECKING:
    from pathlib import Path

    from hybond.sweep.table import SweepTable


SHOWN = 40
"""Members that are drawn."""
Vector = NDArray[np.float64]
BANDS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Quantiles that a family shows."""
BLOCK = 20_000_000
"""Numbers of a curve that are looked at together."""


def spread_of(table: SweepTable, curve: str) -> Spread:
    """Return a curve, ``curve(x, 101)`` as it was collected, of members spread over all of them.

    Raises
    ------
    UsageError
        HB-P113 for what is no curve.
    """
    t, bands = table.quantiles(curve)
    many = len(table)
    shown = np.unique(np.linspace(0, max(many - 1, 0), min(SHOWN, many)).astype(np.intp))
    rows = [np.zeros((0, len(t)))]
    for part in table.parts():
        own = shown[(shown >= part.first) & (shown < part.last)]
        rows.append(part.columns[curve][own - part.first])
    signal = next(c for c in table.collectors if c.text == curve)
    return Spread(signal.signal, signal.unit, t, bands, shown, np.concatenate(rows))


class Views:
    """Maps, families, tornados and indices; `SweepTable` is the only one that has them."""

    def plot_map(self, x: str, y: str, value: str, *, path: str | Path | None = None) -> Any:
        """Draw an outcome, a number or a text such as ``sequence``, over two columns.

        A grid of two factors is drawn as cells, anything else, as two outcomes, as points.

        Raises
        ------
        UsageError
            HB-P109 for a column that there is not; HB-P113 for columns that are no numbers.
        """
        from hybond.draw.sweep_plots import draw_map

        return draw_map(_table(self), map_of(_table(self), x, y, value), path=path)

    def quantiles(self, curve: str, at: tuple[float, ...] = BANDS) -> tuple[Vector, Vector]:
        """Return times, and quantiles of a curve over the members, shape (quantiles, times).

        Members whose run had ended before a time are no part of the quantiles there.

        Raises
        ------
        UsageError
            HB-P113 for what is no curve.
        """
        table = _table(self)
        points = _curve(table, curve)
        t = np.linspace(0.0, table.job.until, points)
        found = np.full((len(at), points), np.nan)
        step = max(BLOCK // max(len(table), 1), 1)
        for first in range(0, points, step):
            here = slice(first, first + step)
            values = np.concatenate([part.columns[curve][:, here] for part in table.parts()])
            some = np.isfinite(values).any(axis=0)
            if some.any():
                found[:, here][:, some] = np.nanquantile(values[:, some], at, axis=0)
        return t, found

    def plot_family(self, curve: str, *, path: str | Path | None = None) -> Any:
        """Draw a family of curves, ``curve(x, 101)``: some members, and bands of quantiles."""
        from hybond.draw.sweep_plots import draw_family

        return draw_family(_table(self), spread_of(_table(self), curve), path=path)

    def tornado(self, value: str) -> list[tuple[str, float, float, float, float]]:
        """Return of each factor its ends and the outcomes there, the largest swing first.

        Raises
        ------
        UsageError
            HB-P113 for a plan that is not of ``sample="ends"``, or what is no number.
        """
        table = _table(self)
        _sampled(table, "ends", "a tornado")
        y = _numbers(table, value)
        rows = table.plan.rows(0, len(table.plan))
        found = [
            (p, float(rows[p][2 * k + 1]), float(rows[p][2 * k + 2]), *y[2 * k + 1 : 2 * k + 3])
            for k, p in enumerate(table.plan.paths)
        ]

        def swing(row: tuple[str, float, float, float, float]) -> float:
            width = abs(row[4] - row[3])
            return width if np.isfinite(width) else -1.0

        return sorted(
            [(p, a, b, float(ya), float(yb)) for p, a, b, ya, yb in found],
            key=lambda row: (-swing(row), row[0]),
        )

    def plot_tornado(self, value: str, *, path: str | Path | None = None) -> Any:
        """Draw a tornado: how far each factor by itself moves an outcome."""
        from hybond.draw.sweep_plots import draw_tornado

        return draw_tornado(_table(self), value, self.tornado(value), path=path)

    def sobol(self, value: str) -> SobolIndices:
        """Return Sobol indices of an outcome; the plan is of ``sample="saltelli:N"``.

        The members are in the order in which SALib has them (without the second order), so that
        ``SALib.analyze.sobol.analyze(problem, table[value], calc_second_order=False)`` tells the
        same.

        Raises
        ------
        UsageError
            HB-P113.
        """
        table = _table(self)
        _sampled(table, "saltelli", "Sobol indices")
        return sobol_indices(table.plan.paths, _numbers(table, value), table.plan.seed)

    def plot_sobol(self, value: str, *, path: str | Path | None = None) -> Any:
        """Draw Sobol indices as bars, first order and total."""
        from hybond.draw.sweep_plots import draw_sobol

        return draw_sobol(_table(self), value, self.sobol(value), path=path)


def _table(views: Views) -> SweepTable:
    return cast("SweepTable", views)


def _curve(table: SweepTable, name: str) -> int:
    """Return the number of points of a curve that was collected."""
    known = {c.text: c.points for c in table.collectors if c.kind == "curve"}
    if name not in known:
        hint = did_you_mean(name, known) or "collect one: curve(height, 101)"
        raise refusal(f"{name!r} is no curve of the table", hint)
    return known[name]


def _numbers(table: SweepTable, value: str) -> Vector:
    column = table[value]
    if column.dtype == object:
        raise refusal(f"{value!r} is no number", "a column of numbers")
    return np.asarray(column, dtype=float)


def _sampled(table: SweepTable, way: str, what: str) -> None:
    if table.plan.way.partition(":")[0] != way:
        number = "" if way == "ends" else ":256"
        raise refusal(f"{what} cannot be told from {table.plan.way}", f'sample="{way}{number}"')
    if len(table) < len(table.plan):
        raise refusal(f"{len(table)} of {len(table.plan)} members are there", "let it end")


def refusal(why: str, hint: str) -> UsageError:
    """Return the refusal of a view."""
    return UsageError(why, code="HB-P113", where="table", hint=hint)
