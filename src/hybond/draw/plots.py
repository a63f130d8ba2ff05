"""Plots of results: signals over time, with jumps, impulses and a strip of modes.

One axes per unit, more where the signals of a unit differ by a factor of thousands. At a jump the
line is broken: an open circle is the left limit, a filled one the right limit. Where events are too
dense for circles and event lines these are left out, and where points are denser than pixels the
lowest and highest of each column of pixels are drawn.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.doubts import COLOUR as DOUBTED
from hybond.draw.doubts import doubt, draw_doubt
from hybond.draw.impulses import draw_impulses, impulses_of
from hybond.draw.marks import draw_marks
from hybond.draw.measure import abridged, shorten, width
from hybond.draw.mode_strip import draw_strip, lanes, room_beside
from hybond.draw.scales import axis_scale, by_unit, plain_axes, printed, time_scale
from hybond.draw.traces import Trace, Vector, apart, thinned, trace_of
from hybond.errors import UsageError
from hybond.files.whole import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's colours, told apart by everyone; yellow is too light for lines.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")

_DASHES = ("-", "--", ":", "-.")
"""Of curves beyond the colours, so that each has a look of its own."""

Panel = tuple[str, dict[str, Trace]]
"""A unit and the signals that share axes."""
_SMALL = 1e-3
"""Part of the largest signal below which one has axes of its own: it would be a line at zero."""
_FLAT = 1e-4
"""Part of the largest value below which only what values differ is shown."""
_WIDE = 7.4
_TALL = 1.75
_LANE = 0.2
_CIRCLE_GAP = 0.012
"""Least distance of circles, as a part of the time shown."""
_LINE_GAP = 0.006
_COLUMNS = 1800
"""Columns of pixels for which curves are drawn: two for each of a picture of this size."""
_NAMES = 8
"""Names that stand below each other beside axes of the usual height."""


def plot_run(
    result: Any, names: Sequence[str], *, ax: Axes | None = None, path: Any = None
) -> Figure:
    """Plot signals of a run over time.

    Parameters
    ----------
    result : Result
        A run.
    names : sequence of str
        Signals; those of one unit share axes, in the order in which the units first come up. What
        is less than a thousandth of the largest has axes of its own.
    ax : Axes, optional
        Draw on these axes, without a strip of modes; the signals must have one unit.
    path : path, optional
        Write the figure to this file too, in the format of its ending.

    Returns
    -------
    Figure
        With axes for each unit and, if the model has machines, a strip of modes at the bottom.

    Raises
    ------
    UsageError
        HB-D103 nothing to plot; HB-D104 signals of several units for one `ax`.
    """
    groups = by_unit(names, result.unit)
    if not groups:
        known = [f"{n.path}.e" for n in result.graph.nodes if not n.is_junction and not n.implied]
        raise UsageError(
            "no signal to plot",
            code="HB-D103",
            where="signals",
            hint=f"name one: run.plot({known[0]!r}), or --signals {known[0]}"
            if known
            else "the model has no elements",
        )
    factor, time_label = time_scale(result.t_end)
    if ax is not None:
        if len(groups) > 1:
            units = ", ".join(repr(printed(u)) for u in groups)
            raise UsageError(
                f"the signals have different units ({units}) and cannot share axes",
                code="HB-D104",
                where="signals",
                hint="plot one unit per axes, or leave `ax` out",
            )
        ((unit, chosen),) = groups.items()
        _signals(ax, result, {n: trace_of(result.pieces(n)) for n in chosen}, unit, factor)
        _time_axis(ax, result, factor, time_label)
        draw_doubt([ax], result, factor=factor)
        if said := doubt(result):
            ax.set_title(said, fontsize=8.0, color=DOUBTED, parse_math=False)
        figure = ax.get_figure(root=True)
        assert figure is not None
    else:
        panels = _panels(result, groups)
        figure = _stacked(result, panels, factor, time_label, interactive=path is None)
    return write_figure(figure, path)


def _panels(result: Any, groups: Mapping[str, Sequence[str]]) -> list[Panel]:
    """Return what axes there are: the unit of each, and its signals."""
    found: list[Panel] = []
    for unit, names in groups.items():
        traces = {name: trace_of(result.pieces(name)) for name in names}
        peaks = {
            n: float(np.max(np.abs(t.y[np.isfinite(t.y)]), initial=0.0)) for n, t in traces.items()
        }
        rest = list(names)
        while rest:
            most = max(peaks[n] for n in rest)
            own = [n for n in rest if peaks[n] >= _SMALL * most or peaks[n] == 0.0]
            found.append((unit, {n: traces[n] for n in own}))
            rest = [n for n in rest if n not in own]
    return found


def write_figure(figure: Figure, path: str | Path | None) -> Figure:
    """Write a figure to a file, in the format of its ending, if there is one; return the figure."""
    if path is not None:
        file = Path(path) if Path(path).suffix else Path(f"{path}.png")
        if file.suffix[1:].lower() not in figure.canvas.get_supported_filetypes():
            raise UsageError(
                f"cannot draw a {file.suffix!r} file",
                code="HB-D101",
                where=str(file),
                hint="end the name in .png, .svg or .pdf",
            )
        picture = io.BytesIO()
        figure.savefig(picture, format=file.suffix[1:], dpi=150)
        write_whole(file, picture.getvalue())
    return figure


def write_panels(
    figure: Figure, panels: Sequence[Axes], seconds: str, path: str | Path | None
) -> Figure:
    """Do the same with panels one above the other, which have the time below the last one."""
    for ax in panels[:-1]:
        ax.tick_params(axis="x", labelbottom=False)
    panels[-1].set_xlabel(f"time [{seconds}]", fontsize=9.5)
    figure.align_ylabels(list(panels))
    return write_figure(figure, path)


def _stacked(
    result: Any, groups: Sequence[Panel], factor: float, time_label: str, *, interactive: bool
) -> Figure:
    """Make a figure with the axes and the strip of modes below."""
    shown, more = lanes(result)
    machines = [result.graph.machines[m].path for m in shown]
    left = min(2.2, max(0.95, *(0.2 + width(p, 8.0) / 72.0 for p in machines), 0.0))
    strip = _LANE * len(shown)
    gap, top, bottom, right = 0.16, 0.42, 0.5, 0.95 if shown else 0.25
    tall = _TALL if len(groups) < 5 else 1.25
    height = top + len(groups) * (tall + gap) + strip + bottom + (0.16 if more else 0.0)
    # names beside the lanes take room from the lanes, and then more names stand beside them
    for _ in range(2):
        beside = room_beside(result, shown, inches=_WIDE - left - right) + 0.05
        right = max(right, min(beside, _WIDE / 3))
    inches = _WIDE - left - right
    # names of curves that are too many for a row make the figure wider
    own = tall - 0.16  # of axes with several curves
    columns = [_column_of(list(n), own) for _, n in groups if _row_of(list(n)) > inches]
    page = _WIDE + max(0.0, max(columns, default=0.0) + 0.15 - right)
    figure = new_figure((page, height), interactive=interactive)

    def place(y: float, high: float) -> Any:
        box = (left / page, y / height, inches / page, high / height)
        return figure.add_axes(box)

    y = height - top
    panels: list[Any] = []
    for unit, traces in groups:
        y -= tall
        named = len(traces) > 1 or _is_long(next(iter(traces)), unit, tall)
        panel = place(y, tall - (0.16 if named else 0.0))
        panels.append(panel)
        _signals(panel, result, traces, unit, factor)
        y -= gap
    if shown:
        lane_axes = place(y - strip, strip)
        draw_strip(lane_axes, result, shown, factor=factor, inches=inches)
        panels.append(lane_axes)
        if more:
            figure.text(
                (left + inches) / page,
                0.06 / height,
                f"and {more} machines more",
                fontsize=7.5,
                ha="right",
                color="#555555",
            )
    for panel in panels:
        _time_axis(panel, result, factor, time_label if panel is panels[-1] else "")
    draw_marks(panels, result, factor=factor, inches=inches)
    draw_doubt(panels, result, factor=factor)
    figure.align_ylabels(panels[: len(groups)])
    title = shorten(str(result.title), 10.5, 72.0 * inches)
    figure.text(
        left / page,
        1 - 0.2 / height,
        title,
        fontsize=10.5,
        fontweight="bold",
        va="center",
        parse_math=False,
    )
    warnings = len(result.warnings)
    counted = f"{warnings} warning{'s' if warnings > 1 else ''}: see run.warnings"
    if said := "; ".join(filter(None, (doubt(result), counted if warnings else ""))):
        figure.text(0.06 / page, 0.06 / height, said, fontsize=7.5, color=DOUBTED, parse_math=False)
    return figure


def new_figure(size: tuple[float, float], *, interactive: bool) -> Figure:
    """Return a figure that pyplot knows, so that `plt.show()` works; not for a mere file.

    A notebook shows what is returned, and all that pyplot knows: one picture is enough.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    kind = _picture()
    if interactive:
        from matplotlib import get_backend, pyplot

        if "inline" not in get_backend().lower():
            return pyplot.figure(figsize=size, FigureClass=kind)
    figure = kind(figsize=size)
    FigureCanvasAgg(figure)
    return figure


@cache
def _picture() -> type[Figure]:
    from matplotlib.figure import Figure as Plain

    class Picture(Plain):
        """A figure that a notebook shows, whatever has been imported there."""

        def _repr_png_(self) -> bytes:
            file = io.BytesIO()
            self.savefig(file, format="png", dpi=110)
            return file.getvalue()

    return Picture


def _is_long(name: str, unit: str, tall: float) -> bool:
    """Whether a name has no room beside axes that are so many inches high."""
    return width(f"{name} [m{printed(unit)}]", 9.5) > min(72.0 * tall, 126.0)


def _base(values: Vector) -> float:
    """Return a round number in the midst of values that hardly differ, else zero."""
    low, high = (float(f(values)) if values.size else 0.0 for f in (np.min, np.max))
    largest, span = max(abs(low), abs(high)), high - low
    if not 1e-12 * largest < span < _FLAT * largest:
        return 0.0
    digit = 10.0 ** math.ceil(math.log10(span))
    return digit * round(0.5 * (low + high) / digit)


def _signals(ax: Axes, result: Any, of: Mapping[str, Trace], unit: str, factor: float) -> None:
    """Draw the signals of one unit with their jumps and impulses."""
    names, traces = list(of), list(of.values())
    impulses = [impulses_of(result, name) for name in names]
    values = np.concatenate([t.y for t in traces])
    values = values[np.isfinite(values)]
    base = 0.0 if any(len(i) for i in impulses) else _base(values)
    if base:
        traces = [trace.less(base) for trace in traces]
        values = values - base
    largest = float(np.max(np.abs(values), initial=0.0))
    scale, label = axis_scale(unit, largest)
    if base:
        by, of_base = axis_scale(unit, abs(base))
        label = f"{label} from {base * by:.15g} {of_base}".rstrip()
    lines = []
    begin = min((float(t.t[0]) for t in traces if len(t.t)), default=0.0)
    for k, whole in enumerate(traces):
        colour = COLOURS[k % len(COLOURS)]
        trace = thinned(whole, begin, float(result.t_end), columns=_COLUMNS)
        (line,) = ax.plot(
            trace.t * factor,
            trace.y * scale,
            color=colour,
            linewidth=1.4,
            linestyle=_DASHES[k // len(COLOURS) % len(_DASHES)],
            zorder=3,
        )
        lines.append(line)
        _circles(ax, trace, colour, factor, scale, result.t_end)
    _limits(ax, values * scale, np.concatenate([i[:, 1] for i in impulses]))
    for k, table in enumerate(impulses):
        draw_impulses(
            ax,
            table,
            unit=unit,
            colour=COLOURS[k % len(COLOURS)],
            time_factor=factor,
            t_end=result.t_end,
        )
    bracket = f" [{label}]" if label else ""
    if len(names) == 1:
        _name(ax, names[0], bracket)
    else:
        ax.set_ylabel(label, fontsize=9.5, parse_math=False)
        _legend(ax, lines, names)
    ax.ticklabel_format(axis="y", style="plain", useOffset=False)
    plain_axes(ax)


def _name(ax: Axes, name: str, bracket: str) -> None:
    """Write the name of the only signal beside its axes, above them where that has no room."""
    figure = ax.get_figure(root=True)
    box = ax.get_position()
    wide, high = figure.get_size_inches() if figure is not None else (_WIDE, _TALL)
    if width(name + bracket, 9.5) <= min(72.0 * box.height * high + 12.0, 126.0):
        ax.set_ylabel(name + bracket, fontsize=9.5, parse_math=False)
        return
    ax.set_ylabel(bracket.strip(), fontsize=9.5, parse_math=False)
    room = 72.0 * box.width * wide
    ax.text(
        0.0,
        1.0 + 4.0 / (72.0 * box.height * high),
        abridged(name, 8.5, room),
        transform=ax.transAxes,
        fontsize=8.5,
        parse_math=False,
    )


def _circles(
    ax: Axes, trace: Trace, colour: str, factor: float, scale: float, t_end: float
) -> None:
    """Mark both limits of each jump that has room for it."""
    if not len(trace.jumps):
        return
    room = apart(trace.jumps[:, 0], _CIRCLE_GAP * t_end)
    # Too dense for circles: thin uprights, or a fast square wave would look like two levels.
    t, left, right = trace.jumps[~room].T
    if len(t):  # one line with breaks is drawn much faster than as many lines
        gap = np.full(len(t), np.nan)
        across = np.column_stack([t, t, gap]).ravel() * factor
        up = np.column_stack([left, right, gap]).ravel() * scale
        ax.plot(across, up, color=colour, linewidth=0.9, solid_capstyle="butt", zorder=3)
    roomy = trace.jumps[room]
    for column, face in ((1, "white"), (2, colour)):
        ax.plot(
            roomy[:, 0] * factor,
            roomy[:, column] * scale,
            "o",
            markersize=3.8,
            markerfacecolor=face,
            markeredgecolor=colour,
            markeredgewidth=1.0,
            linestyle="none",
            zorder=4,
        )


def _limits(ax: Axes, values: Vector, areas: Vector) -> None:
    """Set the limits of y, with room for arrows from zero."""
    low = float(np.min(values, initial=np.inf)) if values.size else 0.0
    high = float(np.max(values, initial=-np.inf)) if values.size else 1.0
    if areas.size:
        low, high = min(low, 0.0), max(high, 0.0)
    span = high - low
    if span <= 1e-12 * max(abs(low), abs(high)):
        span = abs(high) or 1.0
        low, high = low - 0.4 * span, high + 0.4 * span
    low, high = low - 0.07 * span, high + 0.07 * span
    # The longest arrow is a quarter of the axes, and its area is written beyond it.
    if np.any(areas > 0):
        high = max(high, 0.7 * span)
    if np.any(areas < 0):
        low = min(low, -0.7 * span)
    ax.set_ylim(low, high)


def _row_of(names: Sequence[str]) -> float:
    """Return how wide, in inches, a row of names and their lines is."""
    return sum(width(abridged(n, 8.5, 150.0), 8.5) + 32.0 for n in names) / 72.0


def _column_of(names: Sequence[str], tall: float) -> float:
    """Return how wide, in inches, names below each other are that stand beside their axes."""
    columns = -(-len(names) // max(1, round(_NAMES * tall / _TALL)))
    return columns * (max(width(abridged(n, 8.5, 150.0), 8.5) for n in names) + 34.0) / 72.0


def _legend(ax: Axes, lines: Sequence[Any], names: Sequence[str]) -> None:
    """Name the lines above the axes, or beside them where a row has no room."""
    figure = ax.get_figure(root=True)
    box = ax.get_position()
    wide, high = figure.get_size_inches() if figure is not None else (_WIDE, _TALL)
    inches = box.width * wide
    if _row_of(names) > inches:
        rows = max(1, round(_NAMES * box.height * high / _TALL))
        where: dict[str, Any] = {
            "loc": "upper left",
            "bbox_to_anchor": (1.0 + 0.08 / inches, 1.0),
            "ncols": -(-len(names) // rows),
        }
    else:
        where = {"loc": "lower left", "bbox_to_anchor": (0.0, 0.97), "ncols": len(names)}
    name_lines(ax, lines, names, where)


def name_lines(
    ax: Axes, lines: Sequence[Any], names: Sequence[str], where: Mapping[str, Any]
) -> None:
    """Name lines in a legend; `where` it stands, in matplotlib's words."""
    # Neutral labels first: matplotlib leaves out those that begin with an underscore.
    legend = ax.legend(
        lines,
        [str(k) for k in range(len(lines))],
        **where,
        frameon=False,
        fontsize=8.5,
        borderaxespad=0.0,
        handlelength=1.4,
        columnspacing=1.4,
    )
    for text, name in zip(legend.get_texts(), names, strict=True):
        text.set_parse_math(False)
        text.set_text(abridged(name, 8.5, 150.0))


def event_lines(ax: Axes, times: Vector, end: float) -> None:
    """Draw a dotted line at each event that has room for it; of those in one pixel the first."""
    times = np.unique(times[(times > 0) & (times < end)])
    times = times[np.diff(times, prepend=-np.inf) > 2.0 * end / _COLUMNS]
    for t in times[apart(times, _LINE_GAP * end)]:
        ax.axvline(t, color="#8c8c8c", linewidth=0.8, linestyle=(0, (1, 2)), zorder=1)


def _time_axis(ax: Axes, result: Any, factor: float, label: str) -> None:
    """Set the time axis, with its events."""
    end = (result.t_end or 1.0) * factor
    ax.set_xlim(-0.01 * end, 1.01 * end)
    event_lines(ax, result.events.t * factor, end)
    ax.tick_params(axis="x", labelsize=8, labelbottom=bool(label))
    if label:
        ax.set_xlabel(f"time [{label}]", fontsize=9.5)
