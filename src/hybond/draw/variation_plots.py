"""Plots of derivatives of runs, and of runs beside the data that they were fitted to.

They look as the plots of runs do (`plots`): one axes per signal, lines broken at jumps.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.measure import shorten
from hybond.draw.plots import COLOURS, event_lines, name_lines, new_figure, write_panels
from hybond.draw.scales import axis_scale, plain_axes
from hybond.model.unit_words import unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]

_WIDE, _TALL = 7.4, 1.75
_LEFT, _RIGHT, _TOP, _BOTTOM, _GAP = 0.95, 0.25, 0.78, 0.5, 0.16


def plot_sensitivities(
    found: Any, names: Sequence[str], *, path: str | Path | None = None
) -> Figure:
    """Plot derivatives of signals, each times its parameter, in the signal's unit.

    Parameters
    ----------
    found : Sensitivities
    path : path, optional
        Write the figure there too, in the format of its ending.
    """
    title = f"{found.run.title}: what 1 % of each makes"
    figure, panels = _panels(len(names), title, interactive=path is None)
    end = float(found.run.t_end) or 1.0
    factor, seconds = axis_scale("s", end, least=0.5)
    weights = np.where(found.values == 0.0, 1.0, np.abs(found.values)) * 0.01
    for ax, name in zip(panels, names, strict=True):
        i = found.of.index(name)
        values = found.derivatives[:, i] * weights
        scale, label = axis_scale(found.of_units[i], float(np.abs(values).max(initial=0.0)))
        t, rows = _broken(found.t, values)
        lines = [
            ax.plot(t * factor, rows[:, j] * scale, color=COLOURS[j % 7], linewidth=1.4, zorder=3)[
                0
            ]
            for j in range(len(found.wrt))
        ]
        _label(ax, name, label)
        if ax is panels[0]:
            said = [w if v else f"{w}, by 0.01" for w, v in zip(found.wrt, found.values.tolist())]
            _legend(ax, lines, said)
        _finish(ax, end * factor)
        event_lines(ax, found.run.events.t * factor, end * factor)
        if found.ends is not None:
            ax.axvspan(found.ends * factor, 1.01 * end * factor, color="#f3f3f3", zorder=0)
    if found.ends is not None:
        _say(figure, f"no derivatives from {found.ends:.6g} s on: {found.why}")
    return write_panels(figure, panels, seconds, path)


def plot_fit(found: Any, *, path: str | Path | None = None) -> Figure:
    """Plot data as dots, and the runs with the values that were found as lines.

    Parameters
    ----------
    found : Fit
    path : path, optional
        Write the figure there too, in the format of its ending.
    """
    names = list(dict.fromkeys(name for d in found.data for name in d.columns))
    graph = found.runs[0].graph
    figure, panels = _panels(len(names), f"{found.runs[0].title}: fitted", interactive=path is None)
    end = max(float(run.t_end) for run in found.runs) or 1.0
    factor, seconds = axis_scale("s", end, least=0.5)
    several = len(found.data) > 1
    for ax, name in zip(panels, names, strict=True):
        columns = [d.columns[name] for d in found.data if name in d.columns]
        whole = np.concatenate(columns)
        unit = unit_of(graph.signals.get(name) or graph.read(name), graph)
        scale, label = axis_scale(unit, float(np.nanmax(np.abs(whole), initial=0.0)))
        lines, said = [], []
        for k, (run, data) in enumerate(zip(found.runs, found.data, strict=True)):
            if name not in data.columns:
                continue
            colour = COLOURS[k % 7]
            ax.plot(
                data.t * factor,
                data.columns[name] * scale,
                "o",
                color=colour,
                markersize=2.6,
                markerfacecolor="none",
                markeredgewidth=0.7,
                alpha=0.55,
                zorder=2,
            )
            t, rows = _curve(run, name)
            shown = colour if several else COLOURS[1]
            (line,) = ax.plot(t * factor, rows * scale, color=shown, linewidth=1.4, zorder=3)
            lines.append(line)
            said.append(data.name)
        _label(ax, name, label)
        if several and ax is panels[0]:
            _legend(ax, lines, said)
        _finish(ax, end * factor)
    _say(figure, "   ".join(_values(found)))
    return write_panels(figure, panels, seconds, path)


def _values(found: Any) -> list[str]:
    texts = []
    for k, name in enumerate(found.names):
        half = 0.5 * (found.high[k] - found.low[k])
        error = f" ± {half:.2g}" if np.isfinite(half) else ""
        unit = f" {found.units[k]}" if found.units[k] else ""
        texts.append(f"{name} = {found.values[k]:.5g}{error}{unit}")
    return texts


def _curve(run: Any, name: str) -> tuple[Vector, Vector]:
    """Return a signal of a run, broken at its events."""
    parts_t: list[Vector] = []
    parts_y: list[Vector] = []
    gap = np.array([np.nan])
    for segment in run.segments:
        t = np.linspace(segment.t[0], segment.t[-1], 60)
        inside = run.sample(t[:-1], [name])[name]
        last = run.sample(t[-1:], [name], side="left")[name]
        parts_t += [t, gap]
        parts_y += [inside, last, gap]
    return np.concatenate(parts_t), np.concatenate(parts_y)


def _broken(t: Vector, rows: Vector) -> tuple[Vector, Vector]:
    """Return a table with a gap wherever a time comes twice."""
    twice = np.flatnonzero(np.diff(t) <= 0.0) + 1
    return np.insert(t, twice, np.nan), np.insert(rows, twice, np.nan, axis=0)


def _panels(many: int, title: str, *, interactive: bool) -> tuple[Figure, list[Axes]]:
    height = _TOP + many * _TALL + (many - 1) * _GAP + _BOTTOM
    figure = new_figure((_WIDE, height), interactive=interactive)
    wide = 1.0 - (_LEFT + _RIGHT) / _WIDE
    panels = []
    for k in range(many):
        bottom = (height - _TOP - (k + 1) * _TALL - k * _GAP) / height
        panels.append(figure.add_axes((_LEFT / _WIDE, bottom, wide, _TALL / height)))
    figure.text(
        _LEFT / _WIDE, 1.0 - 0.24 / height, shorten(title, 10.5, 66.0 * (_WIDE - _LEFT - _RIGHT)),
        fontsize=10.5, fontweight="bold", parse_math=False,
    )  # fmt: skip
    return figure, panels


def _label(ax: Axes, name: str, unit: str) -> None:
    bracket = f" [{unit}]" if unit else ""
    ax.set_ylabel(shorten(name, 9.5, 95.0) + bracket, fontsize=9.5, parse_math=False)


def _legend(ax: Axes, lines: Sequence[Any], names: Sequence[str]) -> None:
    above = {"loc": "lower left", "bbox_to_anchor": (0.0, 0.985), "ncols": min(len(lines), 6)}
    name_lines(ax, lines, names, above)


def _finish(ax: Axes, end: float) -> None:
    ax.set_xlim(-0.01 * end, 1.01 * end)
    plain_axes(ax)


def _say(figure: Figure, text: str) -> None:
    height = figure.get_size_inches()[1]
    figure.text(
        _LEFT / _WIDE, 1.0 - 0.45 / height, shorten(text, 8.0, 470.0), fontsize=8.0,
        color="#555555", parse_math=False,
    )  # fmt: skip
