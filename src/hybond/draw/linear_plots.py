"""Plots of linear models: Bode, Nyquist, step responses, poles and zeros.

They look as the plots of runs do (`plots`): the same colours, widths and letters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.measure import shorten
from hybond.draw.plots import COLOURS, new_figure, write_figure, write_panels
from hybond.draw.scales import axis_scale, plain_axes, printed, time_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDE = 7.4
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.95, 0.25, 0.42, 0.5
_GAP = 0.16
_GREY = "#8c8c8c"
_SOFT = "#555555"
_DOTTED = (0, (1, 2))
_LARGE, _NEAR = 12.0, 4.0
"""Of a Nyquist plot: a response larger than the first is shown up to the second."""


def plot_bode(
    curves: Sequence[Any],
    *,
    title: str,
    margins: Any = None,
    dots: Sequence[Any] = (),
    path: str | Path | None = None,
) -> Figure:
    """Plot magnitude and phase over frequency.

    Parameters
    ----------
    curves : sequence of Bode
        Drawn as lines; several ones are named.
    margins : Margins, optional
        Marked where there are any.
    dots : sequence of (Bode, label, filled)
        Drawn as circles, open where they are not filled.
    path : path, optional
        Write the figure there too, in the format of its ending.
    """
    figure, (upper, lower) = _stack((2.3, 1.75), title, interactive=path is None)
    whole = [*curves, *(d[0] for d in dots)]
    ends = np.concatenate([c.frequencies for c in whole])
    factor, hertz = axis_scale("Hz", float(np.sqrt(ends.min() * ends.max())), least=1.0)
    for k, curve in enumerate(curves):
        colour = COLOURS[k % len(COLOURS)]
        for ax, y in ((upper, curve.decibels), (lower, curve.phase)):
            ax.plot(curve.frequencies * factor, y, color=colour, linewidth=1.4, zorder=3)
    for k, (found, label, filled) in enumerate(dots):
        colour = COLOURS[(k + len(curves)) % len(COLOURS)]
        for ax, y in ((upper, found.decibels), (lower, _near(found, curves))):
            open_ = ~np.asarray(filled, dtype=bool)
            for chosen, face in ((~open_, colour), (open_, "white")):
                ax.plot(
                    found.frequencies[chosen] * factor,
                    y[chosen],
                    "o",
                    markersize=4.2,
                    markerfacecolor=face,
                    markeredgecolor=colour,
                    linestyle="none",
                    zorder=4,
                    label=label if face == colour else "",
                )
    upper.set_ylabel(_of_what(whole), fontsize=9.5, parse_math=False)
    if len(curves) > 1:
        _name_curves(upper, curves)
    lower.set_ylabel("phase [°]", fontsize=9.5)
    for ax in (upper, lower):
        ax.set_xscale("log")
        low, high = ends.min() * factor, ends.max() * factor
        if dots or low == high:
            low, high = low / 1.15, high * 1.15
        ax.set_xlim(low, high)
        _plain_frequencies(ax, low, high)
        ax.grid(visible=True, axis="x", which="both", color="#f0f0f0", linewidth=0.5)
        plain_axes(ax)
    _degrees(lower)
    upper.tick_params(axis="x", labelbottom=False)
    lower.set_xlabel(f"frequency [{hertz}]", fontsize=9.5)
    if margins is not None:
        _mark_margins(upper, lower, margins, curves[0], factor)
    figure.align_ylabels([upper, lower])
    return write_figure(figure, path)


def plot_nyquist(
    curve: Any, *, title: str, margins: Any = None, path: str | Path | None = None
) -> Figure:
    """Plot a response in the complex plane, for positive and (dashed) negative frequencies."""
    figure, (ax,) = _stack((4.6,), title, interactive=path is None, wide=5.8)
    z = curve.response[np.isfinite(curve.response)]
    for values, line in ((z, "solid"), (z.conj(), (0, (4, 2)))):
        ax.plot(values.real, values.imag, color=COLOURS[0], linewidth=1.4, linestyle=line, zorder=3)
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 361))
    ax.plot(turn.real, turn.imag, color=_GREY, linewidth=0.8, linestyle=_DOTTED, zorder=1)
    ax.plot([-1.0], [0.0], "+", color=COLOURS[1], markersize=9, markeredgewidth=1.6, zorder=4)
    # a pole at the origin goes out of sight: then what is around the critical point is shown
    size = np.abs(z)
    reach = float(size.max(initial=0.0))
    reach = reach if reach <= _LARGE else _NEAR
    inside = size <= 1.0001 * reach
    shown = z[inside]
    corners = np.concatenate([shown, shown.conj(), [-1.0, 0.0]])
    middle = 0.5 * float(corners.real.max() + corners.real.min())
    half = 0.54 * float(max(np.ptp(corners.real), np.ptp(corners.imag), 0.4))
    ax.set_xlim(middle - half, middle + half)
    ax.set_ylim(-half, half)
    _arrow(ax, z, inside)
    unit = f" [{printed(curve.unit)}]" if curve.unit else ""
    ax.set_xlabel(f"real part of {curve.output} / {curve.input}{unit}", fontsize=9.5)
    ax.set_ylabel("imaginary part", fontsize=9.5)
    ax.grid(visible=True, axis="x", color="#e6e6e6", linewidth=0.6)
    plain_axes(ax)
    if margins is not None:
        _say(ax, str(margins))
    return write_figure(figure, path)


def plot_step(step: Any, *, title: str, path: str | Path | None = None) -> Figure:
    """Plot step responses: axes for each output, a line for each input."""
    many = max(len(step.outputs), 1)
    figure, panels = _stack((1.75,) * many, title, interactive=path is None)
    factor, seconds = time_scale(float(step.t[-1]))
    for i, ax in enumerate(panels[: len(step.outputs)]):
        y = step.y[:, i, :]
        unit = step.output_units[i]
        largest = float(np.abs(y[np.isfinite(y)]).max(initial=0.0))
        scale, label = axis_scale(unit, largest)
        lines = [
            ax.plot(step.t * factor, y[:, j] * scale, color=COLOURS[j % 7], linewidth=1.4)[0]
            for j in range(len(step.inputs))
        ]
        bracket = f" [{label}]" if label else ""
        ax.set_ylabel(shorten(step.outputs[i], 9.5, 95.0) + bracket, fontsize=9.5, parse_math=False)
        ax.set_xlim(0.0, step.t[-1] * factor)
        plain_axes(ax)
        if i == 0 and lines:
            units = [f"{n}: 1 {printed(u)}".rstrip() for n, u in zip(step.inputs, step.input_units)]
            legend = ax.legend(
                lines,
                [str(k) for k in range(len(lines))],
                loc="lower right",
                frameon=False,
                fontsize=8.5,
                ncols=min(len(lines), 4),
                handlelength=1.4,
            )
            for text, name in zip(legend.get_texts(), units, strict=True):
                text.set_parse_math(False)
                text.set_text(shorten(f"step of {name}", 8.5, 150.0))
    return write_panels(figure, panels, seconds, path)


def plot_poles(
    poles: NDArray[Any],
    zeros: NDArray[Any],
    *,
    title: str,
    path: str | Path | None = None,
) -> Figure:
    """Plot poles as crosses and zeros as circles; what lies right of zero grows."""
    figure, (ax,) = _stack((4.2,), title, interactive=path is None, wide=5.8)
    found = np.concatenate([poles, zeros, [0.0]]).astype(complex)
    x = float(np.abs(found.real).max()) or float(np.abs(found.imag).max()) or 1.0
    y = float(np.abs(found.imag).max()) or x
    ax.axvspan(0.0, 1e3 * x, color="#fdeeee", zorder=0)
    ax.axvline(0.0, color=_GREY, linewidth=0.8, zorder=1)
    ax.axhline(0.0, color=_GREY, linewidth=0.8, zorder=1)
    ax.plot(
        np.real(poles), np.imag(poles), "x", color=COLOURS[0], markersize=8, markeredgewidth=1.6,
        linestyle="none", zorder=3, label=f"{len(poles)} poles" if len(poles) != 1 else "1 pole",
    )  # fmt: skip
    if len(zeros):
        ax.plot(
            np.real(zeros), np.imag(zeros), "o", color=COLOURS[1], markersize=7,
            markerfacecolor="none", markeredgewidth=1.4, linestyle="none", zorder=3,
            label=f"{len(zeros)} zeros" if len(zeros) != 1 else "1 zero",
        )  # fmt: skip
    right = max(float(found.real.max()), 0.0)
    ax.set_xlim(min(float(found.real.min()), 0.0) - 0.12 * x, right + (0.12 if right else 0.25) * x)
    ax.set_ylim(-1.15 * y, 1.15 * y)
    ax.set_xlabel("real part of s [1/s]", fontsize=9.5)
    ax.set_ylabel("imaginary part of s [1/s]", fontsize=9.5)
    ax.grid(visible=True, axis="x", color="#e6e6e6", linewidth=0.6)
    plain_axes(ax)
    ax.legend(
        loc="lower left", bbox_to_anchor=(0.0, 0.99), ncols=2, frameon=False, fontsize=8.5,
        borderaxespad=0.0, handlelength=1.4,
    )  # fmt: skip
    return write_figure(figure, path)


# -- pieces


def _stack(
    heights: Sequence[float], title: str, *, interactive: bool, wide: float = _WIDE
) -> tuple[Figure, list[Any]]:
    """Return a figure with axes of these heights, in inches, and a title over them."""
    height = _TOP + sum(heights) + _GAP * (len(heights) - 1) + _BOTTOM
    figure = new_figure((wide, height), interactive=interactive)
    panels = []
    y = height - _TOP
    for tall in heights:
        y -= tall
        box = (_LEFT / wide, y / height, (wide - _LEFT - _RIGHT) / wide, tall / height)
        panels.append(figure.add_axes(box))
        y -= _GAP
    figure.text(
        _LEFT / wide,
        1 - (0.16 if wide < _WIDE else 0.2) / height,
        shorten(title, 10.5, 72.0 * (wide - _LEFT - _RIGHT)),
        fontsize=10.5,
        fontweight="bold",
        va="center",
        parse_math=False,
    )
    return figure, panels


def _of_what(curves: Sequence[Any]) -> str:
    """Return what the magnitudes are of, as far as it is the same in all."""
    first = curves[0]
    units = {printed(c.unit) if c.unit else "" for c in curves}
    unit = next(iter(units)) if len(units) == 1 else ""
    same = all((c.output, c.input) == (first.output, first.input) for c in curves)
    named = shorten(f"{first.output} / {first.input}", 9.5, 110.0) if same else "magnitude"
    return f"{named} [dB of {unit}]" if unit else f"{named} [dB]"


def _name_curves(ax: Axes, curves: Sequence[Any]) -> None:
    """Put a legend where the least of the curves is below it."""
    legend = ax.legend(
        ax.get_lines()[: len(curves)],
        [str(k) for k in range(len(curves))],
        loc="best",
        frameon=True,
        edgecolor="none",
        framealpha=0.8,
        fontsize=8.0,
        handlelength=1.2,
    )
    units = {c.unit for c in curves}
    for text, curve in zip(legend.get_texts(), curves, strict=True):
        unit = f" [{printed(curve.unit)}]" if curve.unit and len(units) > 1 else ""
        text.set_parse_math(False)
        text.set_text(shorten(f"{curve.output} / {curve.input}{unit}", 8.0, 130.0))


def _degrees(ax: Axes) -> None:
    """Put ticks of the phase at parts of a turn."""
    low, high = ax.get_ylim()
    step = next((s for s in (15.0, 45.0, 90.0, 180.0, 360.0) if (high - low) / s <= 5.0), 720.0)
    low, high = math.floor(low / step) * step, math.ceil(high / step) * step
    ax.set_ylim(low - 0.06 * step, high + 0.06 * step)
    ax.set_yticks(np.arange(low, high + 0.5 * step, step))


def _near(found: Any, curves: Sequence[Any]) -> NDArray[np.float64]:
    """Return the phase of single values, each on the turn of the curve that it is compared with."""
    own = np.asarray(found.phase, dtype=float)
    if not curves:
        return own
    along = np.interp(np.log(found.frequencies), np.log(curves[0].frequencies), curves[0].phase)
    return np.asarray(own + 360.0 * np.round((along - own) / 360.0))


def _mark_margins(upper: Axes, lower: Axes, margins: Any, curve: Any, factor: float) -> None:
    """Draw where the loop crosses, and say by how much it may change."""
    low, high = curve.frequencies[0], curve.frequencies[-1]
    marked = []
    if margins.phase is not None and low <= margins.phase_at <= high:
        upper.axhline(0.0, color=_GREY, linewidth=0.8, linestyle=_DOTTED, zorder=1)
        marked.append(margins.phase_at)
    if margins.gain is not None and low <= margins.gain_at <= high:
        marked.append(margins.gain_at)
    for at in marked:
        for ax in (upper, lower):
            ax.axvline(at * factor, color=_GREY, linewidth=0.8, linestyle=_DOTTED, zorder=1)
    if marked:
        _say(upper, str(margins))


def _say(ax: Axes, text: str) -> None:
    ax.text(
        1.0, 1.01, text, transform=ax.transAxes, ha="right", va="bottom", fontsize=8, color=_SOFT
    )


def _arrow(ax: Axes, z: NDArray[np.complex128], inside: NDArray[np.bool_]) -> None:
    """Draw an arrow halfway along what is shown, in the direction of rising frequency."""
    steps = np.where(inside[1:] & inside[:-1], np.abs(np.diff(z)), 0.0)
    length = np.cumsum(steps)
    if not len(length) or not length[-1]:
        return
    k = int(np.searchsorted(length, 0.5 * length[-1]))
    way = {"arrowstyle": "-|>", "color": COLOURS[0], "linewidth": 1.2, "mutation_scale": 13}
    # as long as the head at the least, or its direction would be that of rounding
    tail = k
    while tail > 0 and abs(z[k + 1] - z[tail]) < 0.01 * np.ptp(ax.get_xlim()) and inside[tail - 1]:
        tail -= 1
    ax.annotate(
        "",
        (z[k + 1].real, z[k + 1].imag),
        (z[tail].real, z[tail].imag),
        arrowprops=way,
        zorder=4,
    )


def _plain_frequencies(ax: Axes, low: float, high: float) -> None:
    """Write frequencies as plain numbers: each decade, and 2 and 5 where there are few decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    plain = FuncFormatter(lambda x, _: f"{x:g}")
    few = high / low < 500.0
    ax.xaxis.set_major_locator(LogLocator(10.0, subs=(1.0, 2.0, 5.0) if few else (1.0,)))
    ax.xaxis.set_minor_locator(LogLocator(10.0, subs=tuple(range(2, 10))))
    ax.xaxis.set_major_formatter(plain)
    ax.xaxis.set_minor_formatter(NullFormatter())
