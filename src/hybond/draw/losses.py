"""Energy over time: losses stacked by element, under what was supplied."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.measure import shorten
from hybond.draw.plots import COLOURS, new_figure, write_figure
from hybond.draw.scales import axis_scale, plain_axes, time_scale
from hybond.measures.energy_curves import energy_curves
from hybond.measures.window import window_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SHOWN = 6
"""Elements with a colour of their own; the rest is one band."""


def plot_losses(result: Any, *, path: Any = None, depth: int | None = None) -> Figure:
    """Plot what was supplied and where it went, over time.

    The bands are what elements dissipated and lost in jumps up to each time; between the bands and
    the line of what was supplied lies what is stored.

    Parameters
    ----------
    result : Result
    path : path, optional
        Write the figure to this file too.
    depth : int, optional
        Add up submodels.
    """
    curves = energy_curves(result, window_of(result), depth=depth)
    ranked = sorted(curves.losses, key=lambda n: -float(np.max(np.abs(curves.losses[n]))))
    most = max((float(np.max(np.abs(v))) for v in curves.losses.values()), default=0.0)
    ranked = [n for n in ranked if np.max(np.abs(curves.losses[n])) > 1e-6 * most]
    shown, rest = ranked[:_SHOWN], ranked[_SHOWN:]
    bands = [curves.losses[n] for n in shown]
    labels = list(shown)
    if rest:
        bands.append(sum((curves.losses[n] for n in rest), np.zeros(len(curves.t))))
        labels.append(f"{len(rest)} more")
    factor, time_label = time_scale(result.t_end)
    high = max(
        float(np.max(np.abs(curves.supplied))), float(np.max(np.abs(sum(bands, np.zeros(1)))))
    )
    scale, unit = axis_scale("J", high)
    figure = new_figure((7.4, 3.4), interactive=path is None)
    ax = figure.add_axes((0.1, 0.15, 0.64, 0.72))
    t = curves.t * factor
    low = np.zeros(len(t))
    for k, band in enumerate(bands):
        colour = "#bdbdbd" if rest and k == len(shown) else COLOURS[k % len(COLOURS)]
        top = low + band * scale
        ax.fill_between(t, low, top, color=colour, alpha=0.75, linewidth=0.0, label=f"x{k}")
        low = top
    ax.plot(t, curves.supplied * scale, color="#000000", linewidth=1.4, label="s")
    ax.fill_between(
        t,
        low,
        curves.supplied * scale,
        facecolor="none",
        edgecolor="#9a9a9a",
        hatch="///",
        linewidth=0.0,
        label="h",
    )
    ax.set_xlim(t[0], t[-1])
    ax.set_xlabel(f"time [{time_label}]", fontsize=9.5)
    ax.set_ylabel(f"energy from the start [{unit}]", fontsize=9.5)
    plain_axes(ax)
    ax.set_axisbelow(True)
    handles, _ = ax.get_legend_handles_labels()
    names = [*labels, "supplied", "stored since the start"]
    order = [len(labels), len(labels) + 1, *reversed(range(len(labels)))]
    legend = ax.legend(
        [handles[k] for k in order],
        [str(k) for k in order],
        loc="upper left",
        bbox_to_anchor=(1.01, 1.02),
        frameon=False,
        fontsize=8.5,
    )
    for text, k in zip(legend.get_texts(), order, strict=True):
        text.set_parse_math(False)
        text.set_text(shorten(names[k], 8.5, 120.0))
    figure.text(
        0.1,
        0.93,
        shorten(str(result.title), 10.5, 460.0),
        fontsize=10.5,
        fontweight="bold",
        va="center",
        parse_math=False,
    )
    return write_figure(figure, path)
