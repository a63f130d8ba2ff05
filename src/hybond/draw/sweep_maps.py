"""Outcomes of many runs over two factors: cells of a grid, or points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.measure import shorten
from hybond.draw.of_sweeps import NONE, Axis, OutcomeMap
from hybond.draw.plots import new_figure, write_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_map(table: Any, found: OutcomeMap, *, path: Any = None) -> Figure:
    """Draw a column of a sweep over two others.

    Parameters
    ----------
    table : SweepTable
    found : OutcomeMap
        Of it.
    path : path, optional
        Write the figure to this file too.

    Returns
    -------
    Figure
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
