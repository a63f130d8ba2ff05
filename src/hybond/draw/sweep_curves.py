"""Families of curves of many runs: some of them, the median, and bands of quantiles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hybond.draw.measure import shorten
from hybond.draw.of_sweeps import Spread
from hybond.draw.plots import new_figure, write_figure
from hybond.draw.scales import axis_scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK = "#1f5fa8"


def draw_family(table: Any, found: Spread, *, path: Any = None) -> Figure:
    """Draw a curve of all members of a sweep.

    Parameters
    ----------
    table : SweepTable
    found : Spread
        Of one of its curves.
    path : path, optional
        Write the figure to this file too.

    Returns
    -------
    Figure
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
    ax.tick_params(labelsize=8)
    ax.grid(visible=True, axis="y", color="#e6e6e6", linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=8.5)
    title = shorten(str(table.title), 10.5, 480.0)
    figure.text(0.11, 0.93, title, fontsize=10.5, fontweight="bold", va="center", parse_math=False)
    return write_figure(figure, path)
