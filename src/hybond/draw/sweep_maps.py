"""Outcomes of many runs over two factors: cells of a grid, or points."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.measure import shorten
from hybond.draw.plots import new_figure, write_figure
from hybond.errors import UsageError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]
NAMED = 9
"""Texts with a colour of their own; the rest are one."""
INKS = (
    *("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#44bb99"),
    "#994455",
)
"""The hues of P. Tol, which stay apart for colour-blind readers."""
NONE = "#d9d9d9"
"""Where there is no outcome."""


def draw_map(table: Any, x: str, y: str, value: str, *, path: Any = None) -> Figure:
    """Draw a column of a sweep over two of its factors.

    Parameters
    ----------
    table : SweepTable
    x, y, value : str
        Columns.
    path : path, optional
        Write the figure to this file too.

    Returns
    -------
    Figure
    """
    across, up, outcome = table[x], table[y], table[value]
    for name, column in ((x, across), (y, up)):
        if column.dtype == object:
            raise UsageError(
                f"{name!r} is no number",
                code="HB-P113",
                where="table",
                hint="factors that are numbers",
            )
    across, up = np.asarray(across, dtype=float), np.asarray(up, dtype=float)
    figure = new_figure((7.4, 4.4), interactive=path is None)
    ax = figure.add_axes((0.11, 0.12, 0.58, 0.76))
    if any(c.text == value and c.kind == "whole" for c in table.collectors):
        few = np.unique(outcome[np.isfinite(outcome)])
        if len(few) <= NAMED:
            outcome = np.array([f"{v:.0f}" if np.isfinite(v) else "" for v in outcome], object)
    if outcome.dtype == object:
        number, names, inks = _classes(outcome)
        _fill(ax, table, (x, y), across, up, number, _listed(inks))
        _keys(ax, names, inks, value)
    else:
        from matplotlib import colormaps

        colours = colormaps["viridis"].with_extremes(bad=NONE)
        drawn = _fill(ax, table, (x, y), across, up, np.asarray(outcome, dtype=float), colours)
        bar = figure.colorbar(drawn, cax=figure.add_axes((0.72, 0.12, 0.025, 0.76)))
        bar.ax.tick_params(labelsize=8)
        bar.set_label(_named(value, table.unit(value)), fontsize=9.5, parse_math=False)
        if not np.isfinite(np.asarray(outcome, dtype=float)).all():
            ax.plot([], [], "s", color=NONE, label="no value")
            ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.1), frameon=False, fontsize=8.5)
    ax.set_xlabel(_named(x, table.unit(x)), fontsize=9.5, parse_math=False)
    ax.set_ylabel(_named(y, table.unit(y)), fontsize=9.5, parse_math=False)
    ax.tick_params(labelsize=8)
    title = shorten(f"{table.title}: {value}", 10.5, 480.0)
    figure.text(0.11, 0.93, title, fontsize=10.5, fontweight="bold", va="center", parse_math=False)
    return write_figure(figure, path)


def _named(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _listed(inks: list[str]) -> Any:
    from matplotlib.colors import ListedColormap

    return ListedColormap(inks)


def _classes(outcome: NDArray[Any]) -> tuple[Vector, list[str], list[str]]:
    """Return the class of each text, the frequent ones first, their names and colours."""
    counts = Counter(map(str, outcome))
    ranked = sorted(counts, key=lambda n: (-counts[n], n))
    kept, others = ranked[:NAMED], ranked[NAMED:]
    names = [n or "no outcome" for n in kept] + [f"{len(others)} others"] * bool(others)
    inks = [NONE if not n else INKS[k] for k, n in enumerate(kept)] + ["#555555"] * bool(others)
    place = {n: k for k, n in enumerate(kept)}
    number = np.array([float(place.get(str(n), len(kept))) for n in outcome])
    return number, names, inks


def _fill(
    ax: Any,
    table: Any,
    names: tuple[str, str],
    across: Vector,
    up: Vector,
    number: Vector,
    colours: Any,
) -> Any:
    """Fill cells of a grid, else draw points."""
    grid = _grid(table, names, across, up, number)
    listed = colours.N if hasattr(colours, "colors") and colours.N <= NAMED + 1 else 0
    span = {"vmin": -0.5, "vmax": listed - 0.5} if listed else {}
    if grid is None:
        there = np.isfinite(number)
        _scaled(ax, across, up)
        ax.scatter(across[~there], up[~there], s=14, color=NONE, marker="x", linewidths=0.8)
        return ax.scatter(
            *(across[there], up[there]), c=number[there], s=14, cmap=colours, linewidths=0.0, **span
        )
    columns, rows, cells = grid
    _scaled(ax, columns, rows)
    edges = (_edges(columns), _edges(rows))
    ax.set_xlim(edges[0][0], edges[0][-1])
    ax.set_ylim(edges[1][0], edges[1][-1])
    return ax.pcolormesh(*edges, np.ma.masked_invalid(cells), cmap=colours, **span)


def _grid(
    table: Any, names: tuple[str, str], across: Vector, up: Vector, number: Vector
) -> tuple[Vector, Vector, Vector] | None:
    """Return levels of both factors and the outcomes between them, None if it is no such grid."""
    others = [f for f in table.plan.factors if f.path not in names and f.many != 1]
    if table.plan.way != "grid" or others or len(table) < len(table.plan):
        return None
    columns, i = np.unique(across, return_inverse=True)
    rows, j = np.unique(up, return_inverse=True)
    if len(columns) * len(rows) != len(number) or min(len(columns), len(rows)) < 2:
        return None
    cells = np.full((len(rows), len(columns)), np.nan)
    cells[j, i] = number
    return columns, rows, cells


def _is_log(levels: Vector) -> bool:
    """Whether levels are apart by ratios more than by differences."""
    levels = np.unique(levels[np.isfinite(levels)])
    if len(levels) < 3 or levels[0] <= 0.0 or levels[-1] < 20.0 * levels[0]:
        return False
    middle = float(np.median(levels))
    by_ratio = abs(np.log(middle**2 / (levels[0] * levels[-1])))
    return bool(by_ratio < abs(np.log(middle / (0.5 * (levels[0] + levels[-1])))))


def _scaled(ax: Any, across: Vector, up: Vector) -> None:
    if _is_log(across):
        ax.set_xscale("log")
    if _is_log(up):
        ax.set_yscale("log")


def _edges(levels: Vector) -> Vector:
    """Return the edges of the cells around levels."""
    log = _is_log(levels)
    at = np.log(levels) if log else levels
    middle = 0.5 * (at[1:] + at[:-1])
    edges = np.concatenate([[2.0 * at[0] - middle[0]], middle, [2.0 * at[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if log else edges)


def _keys(ax: Any, names: list[str], inks: list[str], value: str) -> None:
    from matplotlib.patches import Patch

    handles = [Patch(facecolor=ink, label=str(k)) for k, ink in enumerate(inks)]
    legend = ax.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(1.02, 1.02),
        frameon=False,
        fontsize=8.5,
        title=shorten(value, 9.0, 150.0),
        title_fontsize=9.0,
        alignment="left",
    )
    for text, name in zip(legend.get_texts(), names, strict=True):
        text.set_parse_math(False)
        text.set_text(shorten(name, 8.5, 170.0))
