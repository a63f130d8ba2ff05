"""Measurements of a run: means, extremes and instants that ``.meas`` asks for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.circuits.formulas import evaluate
from hybond.model.expressions import Expr
from hybond.result import Result

PIECES = 400
"""Parts of a run between which a mean is integrated, besides its steps."""
BETWEEN = 8
"""Points within each part at which extremes and crossings are looked for."""
Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Instant:
    """A time, or a crossing of zero of a signal."""

    signal: str
    edge: str
    count: int
    after: float
    at: float


@dataclass(frozen=True, slots=True)
class Wanted:
    """A measurement in terms of a model.

    Parameters
    ----------
    name, kind : str
        As written.
    signal : str
        Of the model, without a unit; empty if none is measured.
    begin, end : float
        The stretch of time, s; infinite ends are those of the run.
    when, until : Instant or None
    formula : Expr or None
        Of measurements before it and of `constants`.
    """

    name: str
    kind: str
    signal: str = ""
    begin: float = -math.inf
    end: float = math.inf
    when: Instant | None = None
    until: Instant | None = None
    formula: Expr | None = None
    constants: tuple[tuple[str, float], ...] = ()


def measure(run: Result, wanted: Sequence[Wanted]) -> dict[str, float | None]:
    r"""Return measurements of a run; None where there is nothing to measure.

    Parameters
    ----------
    run : Result
        Of the model of a conversion.
    wanted : sequence of Wanted
        Its ``measures``.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import hybond as hb
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "rc.cir")
    ...     _ = path.write_text(
    ...         "RC\nV1 a 0 1\nR1 a b 1k\nC1 b 0 1u IC=0\n.tran 1u 5m uic\n"
    ...         ".meas tran t50 WHEN v(b)=0.5\n.end\n")
    ...     rc = hb.read_circuit(path)
    >>> round(measure(hb.simulate(rc.model), rc.measures)["t50"], 9)
    0.000693147
    """
    found: dict[str, float | None] = {}
    for one in wanted:
        found[one.name] = _one(run, one, found)
    return found


def _one(run: Result, one: Wanted, known: Mapping[str, float | None]) -> float | None:
    if one.formula is not None:
        values = {**dict(one.constants), **{k: v for k, v in known.items() if v is not None}}
        try:
            return evaluate(one.formula, values)
        except (KeyError, ArithmeticError, ValueError):
            return None
    if one.when is not None:
        first = _instant(run, one.when)
        if one.kind == "when" or first is None:
            return first
        if one.until is not None:
            second = _instant(run, one.until)
            return None if second is None else second - first
        if not run.t_begin <= first <= run.t_end:
            return None
        return (
            _slope(run, one.signal, first) if one.kind == "deriv" else _at(run, one.signal, first)
        )
    begin, end = max(one.begin, run.t_begin), min(one.end, run.t_end)
    if end <= begin:
        return None
    if one.kind in ("avg", "rms", "integ"):
        t, weights = _nodes(run, begin, end)
        y = _values(run, one.signal, t)
        if one.kind == "rms":
            return math.sqrt(float(weights @ y**2) / (end - begin))
        return float(weights @ y) / (1.0 if one.kind == "integ" else end - begin)
    low, high = (_extreme(run, one.signal, begin, end, sign) for sign in (-1.0, 1.0))
    match one.kind:
        case "min":
            return low[1]
        case "max":
            return high[1]
        case "min_at":
            return low[0]
        case "max_at":
            return high[0]
    return high[1] - low[1]


def mean_product(run: Result, signal: str, begin: float, power: int) -> float:
    """Return the integral of a power of a signal from `begin` to the end of a run."""
    t, weights = _nodes(run, begin, run.t_end)
    return float(weights @ _values(run, signal, t) ** power)


def _values(run: Result, signal: str, t: Vector) -> Vector:
    return np.asarray(run[signal].at(t.tolist()), dtype=float)


def _at(run: Result, signal: str, t: float) -> float:
    return float(run[signal].at(t))


def _cuts(run: Result, begin: float, end: float) -> Vector:
    """Return times between which a run is smooth: its steps, which end at events and corners."""
    steps = [s.t for s in run.segments if s.t[-1] >= begin and s.t[0] <= end]
    t = np.concatenate([np.linspace(begin, end, PIECES + 1), *steps])
    return np.unique(t[(t >= begin) & (t <= end)])


def _nodes(run: Result, begin: float, end: float) -> tuple[Vector, Vector]:
    """Return times and weights of an integral by Gauss."""
    cuts = _cuts(run, begin, end)
    middle, half = 0.5 * (cuts[1:] + cuts[:-1]), 0.5 * np.diff(cuts)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    return (middle[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel()


def _points(run: Result, signal: str, begin: float, end: float) -> tuple[Vector, Vector]:
    """Return a signal at its cuts, where it jumps from both sides, and at points between."""
    cuts = _cuts(run, begin, end)
    part = np.arange(1, BETWEEN) / BETWEEN
    inner = (cuts[:-1, None] + np.diff(cuts)[:, None] * part).ravel()
    left = np.asarray(run[signal].at(cuts[1:].tolist(), side="left"), dtype=float)
    right = np.asarray(run[signal].at(cuts[:-1].tolist()), dtype=float)
    t = np.concatenate([cuts[:-1], inner, cuts[1:]])
    y = np.concatenate([right, _values(run, signal, inner), left])
    # of two values at one time the left limit comes first
    order = np.lexsort((np.repeat([1, 0, 0], [len(right), len(inner), len(left)]), t))
    return t[order], y[order]


def _extreme(
    run: Result, signal: str, begin: float, end: float, sign: float
) -> tuple[float, float]:
    """Return time and value of the largest of `sign` times a signal."""
    t, y = _points(run, signal, begin, end)
    k = int(np.argmax(sign * y))
    best = float(t[k]), float(y[k])
    if 0 < k < len(t) - 1 and t[k - 1] < t[k] < t[k + 1]:
        low, high = float(t[k - 1]), float(t[k + 1])
        for _ in range(4):  # a smooth peak, between finer and finer points
            fine = np.linspace(low, high, 33)
            values = _values(run, signal, fine)
            j = int(np.argmax(sign * values))
            low, high = float(fine[max(j - 1, 0)]), float(fine[min(j + 1, 32)])
            if sign * values[j] > sign * best[1]:
                best = float(fine[j]), float(values[j])
    return best


def _instant(run: Result, instant: Instant) -> float | None:
    """Return the time of an instant, None if the run has no such one."""
    if not instant.signal:
        return instant.at
    t, y = _points(run, instant.signal, max(instant.after, run.t_begin), run.t_end)
    up = (y[:-1] < 0.0) & (y[1:] >= 0.0)
    down = (y[:-1] > 0.0) & (y[1:] <= 0.0)
    at = np.flatnonzero({"rise": up, "fall": down}.get(instant.edge, up | down))
    if len(at) < max(instant.count, 1):
        return None
    k = int(at[instant.count - 1])
    low, high, rising = float(t[k]), float(t[k + 1]), bool(up[k])
    for _ in range(60):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        value = _at(run, instant.signal, middle)
        if (value >= 0.0) if rising else (value <= 0.0):
            high = middle
        else:
            low = middle
    return high


def _slope(run: Result, signal: str, t: float) -> float:
    """Return the slope by central differences within the run."""
    h = 1e-5 * (run.t_end - run.t_begin)
    low, high = max(run.t_begin, t - h), min(run.t_end, t + h)
    return (_at(run, signal, high) - _at(run, signal, low)) / (high - low)
