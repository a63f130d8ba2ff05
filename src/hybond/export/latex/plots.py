r"""Signals of a run over time as TikZ: nothing but ``\usepackage{tikz}`` is needed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.draw.doubts import COLOUR, doubt, doubted_from
from hybond.draw.scales import axis_scale, by_unit, time_scale
from hybond.draw.tex import escape
from hybond.draw.traces import trace_of
from hybond.equations.display import latex_number
from hybond.result import Result

Vector = NDArray[np.float64]

WIDTH, HEIGHT = 13.0, 3.4
"""Of one axes, cm."""
DOUBTED = "hbdoubt"
"""The colour of what does not hold."""
POINTS = 500
"""Points of a line: columns in each of which the least and the greatest value are kept."""
COLOURS = ("0072B2", "D55E00", "009E73", "CC79A7", "56B4E9", "E69F00", "000000")
"""Okabe and Ito's, as in the plots of `Result.plot`."""
ARROWS = 60
"""Impulses drawn; more would cover each other."""


def colours() -> str:
    """Return the definitions of the colours."""
    named = {f"hb{k}": c for k, c in enumerate(COLOURS)} | {DOUBTED: COLOUR.removeprefix("#")}
    return "\n".join(rf"\definecolor{{{name}}}{{HTML}}{{{c.upper()}}}" for name, c in named.items())


def plots(run: Result, names: Sequence[str]) -> Iterator[str]:
    """Yield a ``tikzpicture`` per unit; signals of one unit share axes."""
    for unit, signals in by_unit(names, run.unit).items():
        yield "\n".join(_axes(run, signals, unit))


def _axes(run: Result, names: list[str], unit: str) -> Iterator[str]:
    pieces = {name: run.pieces(name) for name in names}
    every = np.concatenate([y for p in pieces.values() for _, y in p] or [np.zeros(1)])
    finite = every[np.isfinite(every)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    factor, label = axis_scale(unit, max(abs(low), abs(high)))
    per_second, seconds = time_scale(run.t_end)
    ticks = nice(low * factor, high * factor)
    begin, end = run.t_begin * per_second, run.t_end * per_second
    bottom, top = ticks[0], ticks[-1]

    def x_of(t: float) -> float:
        return WIDTH * (t * per_second - begin) / max(end - begin, 1e-300)

    def y_of(y: float) -> float:
        return HEIGHT * (y * factor - bottom) / (top - bottom)

    yield r"\begin{tikzpicture}[font=\footnotesize]"
    for tick in ticks:
        y = _n(HEIGHT * (tick - bottom) / (top - bottom))
        yield rf"\draw[black!12] (0,{y}) -- ({WIDTH:g},{y});"
        yield rf"\node[left] at (0,{y}) {{${latex_number(tick)}$}};"
    for tick in nice(begin, end, inside=True):
        x = _n(WIDTH * (tick - begin) / max(end - begin, 1e-300))
        yield rf"\draw ({x},0) -- ({x},-0.08) node[below] {{${latex_number(tick)}$}};"
    yield rf"\draw (0,0) rectangle ({WIDTH:g},{HEIGHT:g});"
    start = doubted_from(run)
    if start is not None:
        x = _n(float(x_of(start)))
        yield rf"\fill[{DOUBTED}, opacity=0.12] ({x},0) rectangle ({WIDTH:g},{HEIGHT:g});"
        yield rf"\draw[{DOUBTED}, dashed] ({x},0) -- ({x},{HEIGHT:g});"
        yield rf"\node[below right, {DOUBTED}] at (0,-0.8) {{{escape(doubt(run))}}};"
    yield rf"\node[below] at ({WIDTH / 2:g},-0.4) {{{escape(seconds)}}};"
    for k, name in enumerate(names):
        colour = f"hb{k % len(COLOURS)}"
        trace = trace_of(pieces[name])
        for ts, ys in _lines(trace.t, trace.y, run):
            points = [f"({_n(float(x_of(a)))},{_n(float(y_of(b)))})" for a, b in zip(ts, ys)]
            for first in range(0, len(points) - 1, 40):
                part = " -- ".join(points[first : first + 41])
                yield rf"\draw[{colour}, line width=0.6pt, line join=round] {part};"
        for at, area in _impulses(run, name):
            sign = 1.0 if area > 0 else -1.0
            origin = min(max(float(y_of(0.0)), 0.0), HEIGHT)
            tip = min(max(origin + sign * 0.9, -0.2), HEIGHT + 0.2)
            x = _n(float(x_of(at)))
            yield rf"\draw[{colour}, ->, line width=0.9pt] ({x},{_n(origin)}) -- ({x},{_n(tip)});"
    shown = r", \ ".join(
        rf"\textcolor{{hb{k % len(COLOURS)}}}{{{escape(name)}}}" for k, name in enumerate(names)
    )
    dimension = f" ({escape(label)})" if label else ""
    yield rf"\node[above right] at (0,{HEIGHT:g}) {{{shown}{dimension}}};"
    yield r"\end{tikzpicture}"


def _impulses(run: Result, name: str) -> list[tuple[float, float]]:
    found = [
        (event.t, step.impulses[name])
        for event in run.events.with_impulses()
        for step in event.steps
        if step.kind != "mythical" and name in step.impulses
    ]
    return found if len(found) <= ARROWS else []


def _lines(t: Vector, y: Vector, run: Result) -> Iterator[tuple[Vector, Vector]]:
    """Yield unbroken lines with at most a few points per column of the picture."""
    span = max(run.t_end - run.t_begin, 1e-300)
    edges = np.flatnonzero(~np.isfinite(y))
    for part in np.split(np.arange(len(t)), edges):
        part = part[np.isfinite(y[part])]
        if len(part) < 2:
            continue
        column = np.floor((t[part] - run.t_begin) / span * POINTS).astype(int)
        chosen = _thinned(part, column, y)
        yield t[chosen], y[chosen]


def _thinned(part: NDArray[np.intp], column: NDArray[np.int_], y: Vector) -> NDArray[np.intp]:
    """Return the first, least, greatest and last point of each column."""
    chosen: list[int] = []
    for chunk in np.split(part, np.flatnonzero(np.diff(column)) + 1):
        values = y[chunk]
        places = {0, int(values.argmin()), int(values.argmax()), len(chunk) - 1}
        chosen += [int(chunk[k]) for k in sorted(places)]
    return np.array(chosen)


def nice(low: float, high: float, *, inside: bool = False) -> list[float]:
    """Return about five round ticks that cover a range, or lie inside it.

    Examples
    --------
    >>> nice(-0.3, 9.1), nice(0.0, 4.0, inside=True)
    ([-2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0], [0.0, 1.0, 2.0, 3.0, 4.0])
    """
    if not high - low > 1e-9 * max(abs(low), abs(high), 1e-300):
        size = max(abs(low), 1.0)
        low, high = low - size, high + size
    power = 10.0 ** math.floor(math.log10((high - low) / 4.0))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if (high - low) / (m * power) <= 6.0)
    slack = 1e-9
    if inside:
        first, last = math.ceil(low / step - slack), math.floor(high / step + slack)
    else:
        first, last = math.floor(low / step + slack), math.ceil(high / step - slack)
    return [k * step for k in range(first, last + 1)]


def _n(value: float) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".")
