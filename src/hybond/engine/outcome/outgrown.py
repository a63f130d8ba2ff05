"""Fixed steps that are too long: what a mode lets die out grows from step to step.

The rates of a mode near its motion are linear in what is stored. An eigenvalue of theirs that does
not grow is multiplied by the method's function of stability in each step, and where that is more
than one, a run shows an instability that the model does not have, in finite numbers.

Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.2.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.signals import Signals
from hybond.engine.tables.options import METHODS
from hybond.errors import HybondError
from hybond.model.expressions import Expr, Name
from hybond.model.graph import FlatGraph
from hybond.runs.trace import Segment, Trace
from hybond.units import format_quantity

Vector = NDArray[np.float64]

MODES = 16
"""Modes that are looked at, ..."""
SEGMENTS = 64
"""... among the first segments of a run, ..."""
STATES = 128
"""... with so many states at the most."""
FEW = 16
"""States up to which a motion is looked at in many places, ..."""
PLACES = 17
"""... which are so many, along the longest motion in a mode, ..."""
ENDS = 3
"""... and so many with more states."""
TOLD = 2.0
"""What grows by less over the longest motion in a mode is not told."""
STILL = 1e-9
"""Real part that counts as none, as a part of an eigenvalue: differences leave some."""
SHIFT = 1e-6
"""Part of a state that it is shifted by for a slope."""
PART = 1e-9
"""Part of a motion that is none."""
HALVINGS = 60

STABILITY: dict[str, tuple[float, ...]] = {
    "euler": (1.0, 1.0),
    "rk4": (1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0),
}
"""What a step multiplies by, as coefficients of powers of the step times an eigenvalue."""


def outgrown(graph: FlatGraph, trace: Trace, method: int, step: float) -> Iterator[str]:
    """Yield a warning for each mode of a run whose motion a fixed step lets grow.

    Parameters
    ----------
    method : int
        As in the tables.
    step : float
        s.
    """
    solver = next((name for name in STABILITY if METHODS[name] == method), None)
    signals = trace.signals
    if solver is None or not isinstance(signals, Signals):
        return
    for segment in _longest(trace):
        found = _grows(graph, signals, segment, solver, step)
        if found is not None:
            yield _said(graph, segment, solver, step, found)


def _grows(
    graph: FlatGraph, signals: Signals, segment: Segment, solver: str, step: float
) -> complex | None:
    """Return the eigenvalue of what a motion lets grow most; None if nothing grows for long.

    What grows at one of two neighbouring places alone has no time to: a body that is braked hard
    where it begins. What is zero all along has nothing to grow from.
    """
    n = len(graph.storages) + len(graph.integrals)
    if not 0 < n <= STATES:
        return None
    many = PLACES if n <= FEW else ENDS
    places = np.unique(np.linspace(0, len(segment.t) - 1, many).astype(int))
    is_zero = ~np.asarray(segment.y, dtype=float)[:, :n].any(axis=0)
    growths, worst = [], []
    for k in places.tolist():
        slopes = _slopes(graph, signals, segment, k)
        found: list[complex] = []
        if slopes is not None:
            values, vectors = np.linalg.eig(slopes)
            moves = (np.abs(vectors[~is_zero]) > PART * np.abs(vectors).max(axis=0)).any(axis=0)
            found = values[moves].tolist()
        worst.append(max(found, key=lambda a: _growth(solver, step, a), default=0.0j))
        growths.append(math.log(max(_growth(solver, step, worst[-1]), 1.0)))
    steps = np.diff(np.asarray(segment.t, dtype=float)[places]) / step
    grown = float(np.sum(steps * np.minimum(growths[1:], growths[:-1])))
    return worst[int(np.argmax(growths))] if grown > math.log(TOLD) else None


def _growth(solver: str, step: float, eigenvalue: complex) -> float:
    """Return by what a step multiplies something that does not grow; 0 for what does."""
    if eigenvalue.real > STILL * abs(eigenvalue):
        return 0.0
    return float(abs(np.polynomial.polynomial.polyval(step * eigenvalue, STABILITY[solver])))


def _longest(trace: Trace) -> list[Segment]:
    """Return the longest segment of each mode, where one mode holds."""
    found: dict[tuple[object, ...], Segment] = {}
    for k in range(min(len(trace.segments), SEGMENTS)):
        segment = trace.segments[k]
        if segment.sliding is not None or len(segment.t) < 2:
            continue
        key = (segment.mode, segment.landed)
        if key not in found or np.ptp(segment.t) > np.ptp(found[key].t):
            found[key] = segment
    return list(found.values())[:MODES]


def _slopes(graph: FlatGraph, signals: Signals, segment: Segment, at: int) -> Vector | None:
    """Return how rates change with states at a point; None if they have no values."""
    names: list[Expr] = []
    signs = []
    for s in graph.storages:
        names.append(Name(f"{'f' if s.kind == 'C' else 'e'}:{s.bond}"))
        signs.append(float(s.sign) if s.kind == "C" else 1.0)
    names += [i.rate for i in graph.integrals]
    signs += [1.0] * len(graph.integrals)
    n = len(names)
    begin = np.asarray(segment.y[at], dtype=float)[:n]
    seen = np.abs(np.asarray(segment.y, dtype=float)[:, :n])
    least = np.where(seen > 0.0, seen, np.inf).min(axis=0)
    size = np.where(begin != 0.0, np.abs(begin), np.where(np.isfinite(least), least, 1.0))
    shifts = SHIFT * size
    points = np.concatenate([begin[None], begin + np.diag(shifts), begin - np.diag(shifts)])
    try:
        found = signals.at(segment, names, np.full(len(points), segment.t[at]), points)
    except HybondError:
        return None  # beyond an edge of a law
    rates = np.array(found).T
    rates = rates * np.array(signs)
    slopes = (rates[1 : n + 1] - rates[n + 1 :]) / (2.0 * shifts[:, None])
    return slopes.T if np.isfinite(slopes).all() else None


def _said(graph: FlatGraph, segment: Segment, solver: str, step: float, worst: complex) -> str:
    """Return a step that is too long in words, with one that is not."""
    name = {"euler": "Euler's method", "rk4": "rk4"}[solver]
    lasts = -1.0 / worst.real if worst.real < -STILL * abs(worst) else math.inf
    swings = abs(worst.imag) > STILL * abs(worst)
    what = "what swings without growing"
    if math.isfinite(lasts):
        what = f"what dies out with a time constant of {format_quantity(lasts, 's', 3)}"
    if swings and math.isfinite(lasts):
        turn = 2.0 * math.pi / abs(worst.imag)
        what = f"a swing of {format_quantity(turn, 's', 3)} a turn that dies out"
    grown = _growth(solver, step, worst)
    longest = _largest_stable(lambda h: _growth(solver, h, worst), step)
    remedy = "take solver = 'rk4' with a short step, or solver = 'auto'"
    if longest > 0.0:
        remedy = f"take step = {format_quantity(0.5 * longest, 's', 2)}, or solver = 'auto'"
    return (
        f"step = {format_quantity(step, 's')} is too long for {name} in mode "
        f"({graph.mode_text(segment.mode)}): {what} grows by {100.0 * (grown - 1.0):.3g} % with "
        f"each step, and the values are wrong; {remedy}"
    )


def _largest_stable(growth: Callable[[float], float], step: float) -> float:
    """Return the largest step with which something does not grow; 0 if it always does."""
    low, high = 0.0, step
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if growth(middle) <= 1.0 else (low, middle)
    return low if low > 1e-6 * step else 0.0
