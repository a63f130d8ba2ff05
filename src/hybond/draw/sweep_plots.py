"""Outcomes of many runs drawn: over two factors, as a family of curves, as bars of shares."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.measure import shorten
from hybond.draw.of_sweeps import NONE, Axis, OutcomeMap, Spread
from hybond.draw.plots import new_figure, write_figure
from hybond.draw.scales import axis_scale, plain_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK = "#1f5fa8"
LOW, HIGH = "#66a0d4", "#d96b00"


def draw_map(table: Any, found: OutcomeMap, *, path: Any = None) -> Figure:
    """Draw a column of a sweep over two others.

    Parameters
    ----------
    table : SweepTable
    path : path, optional
        Write the figure to this file too.
    """
    figure = new_figure((7.4, 4.4), interactive=path is None)
    ax = figure.add_axes((0.11, 0.12, 0.58, 0.76))
    if found.names:
        from matplotlib.colors import ListedColormap

        _fill(ax, found, ListedColormap(list(found.inks)))
        _keys(ax, found)
    else:
        from matplotlib import colormaps

        drawn = _fill(ax, found, colormaps["viridis"].with_extremes(bad=NONE))
        bar = figure.colorbar(drawn, cax=figure.add_axes((0.72, 0.12, 0.025, 0.76)))
        bar.ax.tick_params(labelsize=8)
        bar.set_label(_named(found.value, found.unit), fontsize=9.5, parse_math=False)
        if not np.isfinite(found.number).all():
            ax.plot([], [], "s", color=NONE, label="no value")
            ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.1), frameon=False, fontsize=8.5)
    ax.set_xlabel(_labelled(found.x), fontsize=9.5, parse_math=False)
    ax.set_ylabel(_labelled(found.y), fontsize=9.5, parse_math=False)
    ax.tick_params(labelsize=8)
    title = shorten(f"{table.title}: {found.value}", 10.5, 480.0)
    figure.text(0.11, 0.93, title, fontsize=10.5, fontweight="bold", va="center", parse_math=False)
    return write_figure(figure, path)


def _named(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _labelled(axis: Axis) -> str:
    return _named(axis.name, axis.unit)


def _fill(ax: Any, found: OutcomeMap, colours: Any) -> Any:
    """Fill cells of a grid, else draw points."""
    span = {"vmin": -0.5, "vmax": len(found.names) - 0.5} if found.names else {}
    if found.x.log:
        ax.set_xscale("log")
    if found.y.log:
        ax.set_yscale("log")
    number = found.number
    if found.x.edges is None or found.y.edges is None:
        there = np.isfinite(number)
        across, up = found.across, found.up
        ax.scatter(across[~there], up[~there], s=14, color=NONE, marker="x", linewidths=0.8)
        return ax.scatter(
            *(across[there], up[there]), c=number[there], s=14, cmap=colours, linewidths=0.0, **span
        )
    edges = (found.x.edges, found.y.edges)
    ax.set_xlim(edges[0][0], edges[0][-1])
    ax.set_ylim(edges[1][0], edges[1][-1])
    cells = np.ma.masked_invalid(number.reshape(len(found.up), len(found.across)))
    return ax.pcolormesh(*edges, cells, cmap=colours, **span)


def _keys(ax: Any, found: OutcomeMap) -> None:
    from matplotlib.patches import Patch

    handles = [Patch(facecolor=ink, label=str(k)) for k, ink in enumerate(found.inks)]
    legend = ax.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(1.02, 1.02),
        frameon=False,
        fontsize=8.5,
        title=shorten(found.value, 9.0, 150.0),
        title_fontsize=9.0,
        alignment="left",
    )
    for text, name in zip(legend.get_texts(), found.names, strict=True):
        text.set_parse_math(False)
        text.set_text(shorten(name, 8.5, 170.0))


def draw_family(table: Any, found: Spread, *, path: Any = None) -> Figure:
    """Draw a curve of all members of a sweep.

    Parameters
    ----------
    table : SweepTable
    found : Spread
        Of one of its curves.
    path : path, optional
        Write the figure to this file too.
    """
    low, lower, median, upper, high = found.bands
    factor, time_label = axis_scale("s", table.job.until, least=0.5)
    x = found.t * factor
    figure = new_figure((7.4, 3.6), interactive=path is None)
    ax = figure.add_axes((0.11, 0.14, 0.66, 0.74))
    for row in found.curves:
        ax.plot(x, row, color="#8a8a8a", lw=0.5, alpha=0.5)
    ax.fill_between(x, low, high, color=INK, alpha=0.18, lw=0.0, label="5 to 95 %")
    ax.fill_between(x, lower, upper, color=INK, alpha=0.3, lw=0.0, label="25 to 75 %")
    ax.plot(x, median, color=INK, lw=1.6, label="median")
    ax.plot([], [], color="#8a8a8a", lw=0.5, label=f"{len(found.members)} of {len(table)} runs")
    ax.set_xlim(x[0], x[-1])
    ax.set_xlabel(f"time [{time_label}]", fontsize=9.5)
    named = f"{found.signal} [{found.unit}]" if found.unit else found.signal
    ax.set_ylabel(shorten(named, 9.5, 240.0), fontsize=9.5, parse_math=False)
    plain_axes(ax)
    ax.set_axisbelow(True)
    ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=8.5)
    title = shorten(str(table.title), 10.5, 480.0)
    figure.text(0.11, 0.93, title, fontsize=10.5, fontweight="bold", va="center", parse_math=False)
    return write_figure(figure, path)


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
    rows : list of tuple
        Factor, its lower and upper end, the outcomes there.
    path : path, optional
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
    _names(ax, [_named(row[0], table.unit(row[0])) for row in rows])
    ax.set_xlabel(_named(value, table.unit(value)), fontsize=9.5, parse_math=False)
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
    found : SobolIndices
    path : path, optional
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
