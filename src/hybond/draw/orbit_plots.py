"""Plots of motions that repeat: one period beside its multipliers, and branches of orbits.

They look as the plots of runs do (`plots`): the same colours, widths and letters.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.measure import shorten
from hybond.draw.plots import COLOURS, new_figure, plot_run, write_figure
from hybond.draw.scales import axis_scale, by_unit, plain_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]

_WIDE, _TALL, _CIRCLE = 7.4, 1.75, 2.55
_LEFT, _RIGHT, _TOP, _BOTTOM, _GAP, _BESIDE = 0.95, 0.2, 0.62, 0.5, 0.3, 0.75
_GREY = "#8c8c8c"
_MARKS = {
    "fold": ("o", COLOURS[1]),
    "branching": ("P", COLOURS[3]),
    "period doubling": ("s", COLOURS[2]),
    "Neimark-Sacker": ("D", COLOURS[4]),
    "grazing": ("v", COLOURS[5]),
    "border collision": ("X", COLOURS[6]),
}
WHAT = {"begin": "at the beginning", "max": "largest", "min": "least", "mean": "mean"}


def plot_orbit(orbit: Any, names: Sequence[str], *, path: str | Path | None = None) -> Figure:
    """Plot signals over one period, and the multipliers beside the unit circle.

    Parameters
    ----------
    orbit : PeriodicOrbit
    names : sequence of str
        Signals; those of one unit share axes.
    path : path, optional
        Write the figure there too, in the format of its ending.
    """
    run = orbit.run
    groups = by_unit(names, run.unit)
    high = max(len(groups) * _TALL + (len(groups) - 1) * _GAP, _CIRCLE)
    tall = (high - (len(groups) - 1) * _GAP) / len(groups)
    height, page = _TOP + high + _BOTTOM, _WIDE + _BESIDE + _CIRCLE
    figure = new_figure((page, height), interactive=path is None)
    inches = _WIDE - _LEFT - _RIGHT
    panels: list[Axes] = []
    y = height - _TOP
    for own in groups.values():
        y -= tall
        ax = figure.add_axes((_LEFT / page, y / height, inches / page, tall / height))
        plot_run(run, own, ax=ax)
        panels.append(ax)
        y -= _GAP
    for ax in panels[:-1]:
        ax.set_xlabel("")
        ax.tick_params(axis="x", labelbottom=False)
    figure.align_ylabels(list(panels))
    left = _WIDE - _RIGHT + _BESIDE
    low = height - _TOP - high + 0.5 * (high - _CIRCLE)
    circle = figure.add_axes((left / page, low / height, _CIRCLE / page, _CIRCLE / height))
    _circle(circle, orbit)
    said = "stable" if orbit.stable else "neutral" if orbit.neutral else "not stable"
    title = shorten(f"{run.title}: one period, {said}", 10.5, 72.0 * (page - _LEFT - _RIGHT))
    figure.text(
        _LEFT / page, 1.0 - 0.2 / height, title, fontsize=10.5, fontweight="bold", va="center",
        parse_math=False,
    )  # fmt: skip
    return write_figure(figure, path)


def _circle(ax: Axes, orbit: Any) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    ax.plot(np.cos(angle), np.sin(angle), color=_GREY, linewidth=1.0, zorder=1)
    ax.fill(np.cos(angle), np.sin(angle), color="#f3f7f3", zorder=0)
    ax.axhline(0.0, color="#e0e0e0", linewidth=0.7, zorder=0.5)
    ax.axvline(0.0, color="#e0e0e0", linewidth=0.7, zorder=0.5)
    reach = 1.25
    for m in orbit.multipliers:
        inside = abs(m.value) < 1.0 or m.kind == "neutral"
        colour = COLOURS[0] if inside or not m.counts else COLOURS[1]
        face = colour if m.counts else "white"
        ax.plot(
            m.value.real, m.value.imag, "o", color=colour, markerfacecolor=face, markersize=6,
            zorder=3,
        )  # fmt: skip
        reach = max(reach, 1.12 * max(abs(m.value.real), abs(m.value.imag)))
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    ax.set_aspect("equal")
    ax.tick_params(labelsize=8)
    ax.set_title("multipliers", fontsize=9.5)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _turns(branch: Any, what: str) -> int:
    """Return how many values of an orbit are shown: one for each period of what drives it."""
    return int(branch.multiple) if what == "begin" else 1


def _curve(
    branch: Any, signal: str, what: Any, value_of: Callable[..., float]
) -> tuple[Any, Vector, list[Vector], NDArray[np.bool_]]:
    """Return a branch with its curves and where it is stable, from the orbit that it is born at."""
    x, stable = branch.values, branch.stable
    ys = [branch.of(signal, what, turn=k) for k in range(_turns(branch, what))]
    if branch.born is not None:
        once = branch.multiple // 2
        first = [value_of(branch.born.orbit, signal, what, k % once / once) for k in range(len(ys))]
        ys = [np.append(a, y) for a, y in zip(first, ys, strict=True)]
        x, stable = np.append(branch.born.value, x), np.append(stable[0], stable)
    return branch, x, ys, stable


def plot_continuation(
    found: Any,
    signal: str,
    what: Any,
    value_of: Callable[..., float],
    *,
    path: str | Path | None = None,
) -> Figure:
    """Plot a signal of orbits over the parameter, dashed where they are not stable.

    Parameters
    ----------
    found : Continuation
    what : str
        One of `WHAT`.
    value_of : callable
        Of an orbit, a signal and `what`: where on the axis it stands; and a part of a period later.
    path : path, optional
        Write the figure there too, in the format of its ending.

    Raises
    ------
    UsageError
        HB-A544 for what is no value of an orbit, HB-S109 for a signal that there is not.
    """
    top = _TOP + 0.2
    height, page = top + 3.6 + _BOTTOM, _WIDE
    figure = new_figure((page, height), interactive=path is None)
    inches = page - _LEFT - _RIGHT
    ax = figure.add_axes((_LEFT / page, _BOTTOM / height, inches / page, 3.6 / height))
    curves = [_curve(b, signal, what, value_of) for b in found.branches]
    marks = [
        (s.kind, s.value, value_of(s.orbit, signal, what))
        for b in found.branches
        for s in b.special
    ]
    run = found.branches[0].points[0].run
    largest = max(float(np.abs(y).max(initial=0.0)) for _, _, ys, _ in curves for y in ys)
    by_y, unit = axis_scale(run.unit(signal), largest)
    ends = max(float(np.abs(x).max(initial=0.0)) for _, x, _, _ in curves)
    by_x, of = axis_scale(found.unit, ends)
    for k, (branch, x, ys, stable) in enumerate(curves):
        colour = COLOURS[k % len(COLOURS)]
        times = f", {branch.multiple} periods" if branch.multiple > 1 else ""
        for chosen, style, word in ((True, "-", "stable"), (False, (0, (4, 2)), "not stable")):
            own = stable if chosen else ~stable
            if not own.any():
                continue
            # a stretch goes on to the next point, where the other one begins
            wide = own | np.append(False, own[:-1]) if chosen else own
            for turn, y in enumerate(ys):
                ax.plot(
                    np.where(wide, x, np.nan) * by_x, np.where(wide, y, np.nan) * by_y,
                    color=colour, linewidth=1.4, linestyle=style, zorder=3,
                    label="" if turn else f"{word}{times}",
                )  # fmt: skip
    for kind, (mark, colour) in _MARKS.items():
        own_marks = [(x, y) for name, x, y in marks if name == kind]
        if own_marks:
            xs, ys = np.array(own_marks).T
            ax.plot(
                xs * by_x, ys * by_y, mark, color=colour, markersize=6, markeredgecolor="white",
                markeredgewidth=0.6, linestyle="none", zorder=4, label=kind,
            )  # fmt: skip
    ax.set_xlabel(
        f"{found.parameter} [{of}]" if of else found.parameter, fontsize=9.5, parse_math=False
    )
    named = shorten(f"{signal}, {WHAT[what]}", 9.5, 240.0)
    ax.set_ylabel(f"{named} [{unit}]" if unit else named, fontsize=9.5, parse_math=False)
    plain_axes(ax, "both")
    ax.legend(
        loc="lower left", bbox_to_anchor=(0.0, 0.99), ncols=4, frameon=False, fontsize=8.0,
        borderaxespad=0.0, handlelength=1.8, columnspacing=1.2,
    )  # fmt: skip
    figure.text(
        _LEFT / page, 1.0 - 0.2 / height, shorten(f"{found.title}: orbits", 10.5, 72.0 * inches),
        fontsize=10.5, fontweight="bold", va="center", parse_math=False,
    )  # fmt: skip
    return write_figure(figure, path)
