"""Bifurcation diagrams: a small dot for each sample, windows named above."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond.draw.measure import shorten
from hybond.draw.plots import new_figure, write_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK = {"fresh": "#222222", "up": "#4477aa", "down": "#ee6677"}
"""Two hues of P. Tol, which stay apart for colour-blind readers."""
SPAN = 0.035
"""Part of the width that a window takes at the least to be named."""
EDGE = 0.012
"""Part of the width that is left free on both sides, so that no dot is cut."""
SOFT = "#f1f1f4"


def draw_bifurcation(
    diagram: Any, signal: str, *, windows: bool = True, path: str | Path | None = None
) -> Figure:
    """Draw the samples of a signal over the parameter.

    Parameters
    ----------
    diagram : Bifurcation
    windows : bool
        Whether the windows of the first branch are named, and every second one is shaded.
    path : path, optional
        Write the figure to this file too.
    """
    figure = new_figure((7.4, 4.6), interactive=path is None)
    ax = figure.add_axes((0.11, 0.12, 0.86, 0.72))
    many = sum(int(b.samples[signal].size) for b in diagram.branches)
    size = min(max(4.0e4 / max(many, 1), 0.25), 3.0)
    for b in reversed(diagram.branches):
        x, y = diagram.points(signal, b.direction)
        ax.plot(
            x,
            y,
            linestyle="none",
            marker="o",
            markersize=math.sqrt(size),
            markeredgewidth=0,
            color=INK[b.direction],
            alpha=0.75,
            label=b.direction,
            rasterized=True,
            zorder=3,
        )
    low, high = float(diagram.values[0]), float(diagram.values[-1])
    ax.set_xlim(low - EDGE * (high - low), high + EDGE * (high - low))
    if windows:
        _name_windows(ax, diagram, low, high)
    if len(diagram.branches) > 1:
        ax.legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.06), ncols=2, fontsize=8.5, markerscale=4,
            frameon=False, borderaxespad=0.0, handletextpad=0.2,
        )  # fmt: skip
    ax.set_xlabel(_named(diagram.parameter, diagram.unit), fontsize=9.5, parse_math=False)
    ax.set_ylabel(_named(signal, diagram.units[signal]), fontsize=9.5, parse_math=False)
    ax.tick_params(labelsize=8)
    title, below = shorten(diagram.title, 10.5, 440.0), shorten(diagram.section, 8.5, 440.0)
    figure.text(0.11, 0.96, title, fontsize=10.5, fontweight="bold", va="center", parse_math=False)
    figure.text(0.11, 0.92, below, fontsize=8.5, color="#777777", va="center", parse_math=False)
    if path is not None:
        write_figure(figure, path)
    return figure


def _name_windows(ax: Any, diagram: Any, low: float, high: float) -> None:
    """Shade every second window, and write periods above those that are wide enough."""
    own = [w for w in diagram.windows() if w.direction == diagram.branches[0].direction]
    above = ax.get_xaxis_transform()
    for k, w in enumerate(own):
        if k % 2:
            ax.axvspan(w.low, w.high, color=SOFT, zorder=0, linewidth=0)
        if w.high - w.low < SPAN * (high - low):
            continue
        name = {0: "–", -1: "stopped"}.get(w.period, str(w.period))
        ax.text(
            0.5 * (w.low + w.high),
            1.015,
            name,
            transform=above,
            ha="center",
            va="bottom",
            fontsize=8.5,
            color="#555555",
        )
    ax.text(
        -0.015, 1.015, "period", transform=ax.transAxes, fontsize=8, color="#777777", ha="right"
    )


def _named(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name
