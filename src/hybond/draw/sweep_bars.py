"""Which factor moves an outcome: tornados, and Sobol indices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.measure import shorten
from hybond.draw.plots import new_figure, write_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOW, HIGH = "#66a0d4", "#d96b00"


def draw_tornado(
    table: Any,
    value: str,
    rows: list[tuple[str, float, float, float, float]],
    *,
    path: Any = None,
) -> Figure:
    """Draw how far each factor by itself moves an outcome from its middle.

    Parameters
    ----------
    table : SweepTable
    value : str
    rows : list of tuple
        Factor, its lower and upper end, the outcomes there.
    path : path, optional

    Returns
    -------
    Figure
    """
    middle = float(np.asarray(table[value], dtype=float)[0])
    figure, ax = _bars(table, f"{value}, from {middle:.5g}", len(rows), path)
    for k, (_, a, b, low, high) in enumerate(rows):
        for end, outcome, ink in ((a, low, LOW), (b, high, HIGH)):
            if not np.isfinite(outcome):
                ax.text(middle, k, "no value", fontsize=8, va="center")
                continue
            ax.barh(k, outcome - middle, left=middle, height=0.62, color=ink)
            rightwards = outcome > middle or (outcome == middle and end == b)
            ax.annotate(
                f"{end:.4g}",
                (outcome, k),
                textcoords="offset points",
                xytext=(3 if rightwards else -3, 0),
                ha="left" if rightwards else "right",
                va="center",
                fontsize=7.5,
                color="#444444",
            )
    ax.axvline(middle, color="#000000", linewidth=0.8)
    ax.margins(x=0.2)
    _names(ax, [_named(table, row[0]) for row in rows])
    unit = table.unit(value)
    ax.set_xlabel(f"{value} [{unit}]" if unit else value, fontsize=9.5, parse_math=False)
    from matplotlib.patches import Patch

    ax.legend(
        handles=[Patch(color=LOW, label="lower end"), Patch(color=HIGH, label="upper end")],
        **{"loc": "upper left", "bbox_to_anchor": (1.01, 1.02), "frameon": False, "fontsize": 8.5},
    )
    return write_figure(figure, path)


def draw_sobol(table: Any, value: str, found: Any, *, path: Any = None) -> Figure:
    """Draw Sobol indices with their intervals, the largest total first.

    Parameters
    ----------
    table : SweepTable
    value : str
    found : SobolIndices
    path : path, optional

    Returns
    -------
    Figure
    """
    order = np.argsort(-np.nan_to_num(found.total), kind="stable")
    figure, ax = _bars(table, f"variance of {value}", len(order), path)
    at = np.arange(len(order))
    whiskers = {"ecolor": "#444444", "error_kw": {"elinewidth": 0.9}, "capsize": 2.0}
    ax.barh(
        *(at - 0.18, found.first[order], 0.34),
        xerr=found.first_error[order],
        color=LOW,
        label="alone",
        **whiskers,
    )
    ax.barh(
        *(at + 0.18, found.total[order], 0.34),
        xerr=found.total_error[order],
        color=HIGH,
        label="with others",
        **whiskers,
    )
    ax.set_xlim(left=min(0.0, float(np.nanmin(found.first - found.first_error)) - 0.02))
    _names(ax, [found.names[k] for k in order])
    ax.set_xlabel("part of the variance", fontsize=9.5)
    ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=8.5)
    return write_figure(figure, path)


def _bars(table: Any, said: str, many: int, path: Any) -> tuple[Figure, Any]:
    height = 1.4 + 0.42 * many
    figure = new_figure((7.4, height), interactive=path is None)
    ax = figure.add_axes((0.2, 0.6 / height, 0.58, (height - 1.15) / height))
    ax.tick_params(labelsize=8)
    ax.grid(visible=True, axis="x", color="#e6e6e6", linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)
    title = shorten(f"{table.title}: {said}", 10.5, 480.0)
    figure.text(
        *(0.03, 1.0 - 0.28 / height, title),
        fontsize=10.5,
        fontweight="bold",
        va="center",
        parse_math=False,
    )
    return figure, ax


def _names(ax: Any, names: list[str]) -> None:
    ax.set_yticks(range(len(names)))
    labels = ax.set_yticklabels(names, fontsize=9)
    for label in labels:
        label.set_parse_math(False)
    ax.tick_params(axis="y", length=0.0)
    ax.invert_yaxis()


def _named(table: Any, name: str) -> str:
    unit = table.unit(name)
    return f"{name} [{unit}]" if unit else name
