"""What plots show of a run: as many points as there are pixels, no spike lost.

Of each pixel the least and the greatest value are given, beside the data; stride sampling would
lose impulses and ripple.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.impulses import impulses_of
from hybond.draw.mode_strip import lanes, shares, stays
from hybond.errors import UsageError
from hybond.model.expressions import Name
from hybond.result import Result
from hybond.studio.levels import Data

Vector = NDArray[np.float64]

WIDEST = 4000
"""Most pixels of a plot."""
MOST_PLOTTED = 32
"""Signals that are plotted at once."""
STAYS = 400
"""Stays in states up to which each is told; beyond, how much of each pixel is spent where."""
PIXELS = 900
"""Of the longer side of the picture."""
POINTS = 20_000
"""Points of one picture; beyond, those that are nearer to each other are left out."""


def curve(run: Result, name: str, t0: float, t1: float, width: int) -> dict[str, Any]:
    """Return one signal between two times.

    Parameters
    ----------
    name : str
        A signal, or an expression of signals.
    t0, t1 : float
        s.
    width : int
        Pixels.

    Returns
    -------
    dict
        ``t`` and ``y``, null for what is not determined and between pieces that do not touch;
        ``impulses``, pairs of time and area; ``unit``.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> seen = curve(hb.simulate(m, until="1 s"), "c.e", 0.0, 1.0, 100)
    >>> seen["unit"], seen["y"][0], round(seen["y"][-1], 3), len(seen["t"]) <= 402
    ('V', 10.0, 3.679, True)
    """
    signal = run[name]
    t, y = signal.t, signal.y
    first = max(int(np.searchsorted(t, t0, side="left")) - 1, 0)
    last = min(int(np.searchsorted(t, t1, side="right")) + 1, len(t))
    t, y = reduced(t[first:last], y[first:last], max(16, min(int(width), WIDEST)))
    areas = impulses_of(run, name)
    inside = areas[(areas[:, 0] >= t0) & (areas[:, 0] <= t1)]
    if len(inside) > width:
        inside = inside[np.argsort(-np.abs(inside[:, 1]))[:width]]
    return {
        "name": name,
        "unit": signal.unit,
        "t": t.tolist(),
        "y": numbers(y),
        "impulses": inside.tolist(),
    }


def reduced(t: Vector, y: Vector, width: int) -> tuple[Vector, Vector]:
    """Return the least and the greatest point of each of `width` pieces, in their order.

    Examples
    --------
    >>> t = np.arange(10000.0)
    >>> y = np.zeros(10000)
    >>> y[4321] = 1.0
    >>> a, b = reduced(t, y, 50)
    >>> len(a) <= 4 * 50 + 2, float(a[b == 1.0][0])
    (True, 4321.0)
    """
    n = len(t)
    if n <= 4 * width or not t[-1] > t[0]:
        return t, y
    edges = np.searchsorted(t, np.linspace(t[0], t[-1], width + 1)[1:-1])
    starts = np.unique(np.concatenate(([0], edges, [n])))
    kept = [np.array([0, n - 1])]
    for a, b in zip(starts[:-1].tolist(), starts[1:].tolist()):
        part = y[a:b]
        if np.isnan(part).all():
            kept.append(np.array([a, b - 1]))
            continue
        kept.append(np.array([a, a + int(np.nanargmin(part)), a + int(np.nanargmax(part)), b - 1]))
    chosen = np.unique(np.concatenate(kept))
    return t[chosen], y[chosen]


def numbers(values: Sequence[float] | Vector) -> list[float | None]:
    """Return values that JSON can hold: null for what is none.

    Examples
    --------
    >>> numbers([1.0, float("nan"), float("inf")])
    [1.0, None, None]
    """
    return [float(v) if math.isfinite(v) else None for v in values]


def strip(run: Result, t0: float, t1: float, width: int) -> list[dict[str, Any]]:
    """Return the lanes of the machines between two times: their stays, or shares of pixels."""
    found = []
    width = max(16, min(int(width), WIDEST))
    for m in lanes(run)[0]:
        machine = run.graph.machines[m]
        all_stays = [s for s in stays(run, m) if s[1] >= t0 and s[0] <= t1]
        lane: dict[str, Any] = {"machine": machine.path, "states": list(machine.states)}
        if len(all_stays) <= STAYS:
            lane["stays"] = [[a, b, k] for a, b, k in all_stays]
        else:
            edges = np.linspace(t0, t1, width + 1)
            lane["shares"] = [
                np.round(shares(all_stays, k, edges), 3).tolist()
                for k in range(len(machine.states))
            ]
        found.append(lane)
    return found


def at_cursor(run: Result, t: float, side: str, bonds: Sequence[int]) -> dict[str, Any]:
    """Return effort and flow of bonds at a time, and the states of the machines there."""
    t = min(max(t, run.t_begin), run.t_end)
    left = side == "left"
    run.sample([t], [], side="left" if left else "right")
    number = run._segment_at(t, "left" if left else "right")
    names = [Name(f"{v}:{b}") for b in bonds for v in "ef"]
    states = dict(zip((m.path for m in run.graph.machines), run.segments[number].mode))
    values = run._of(names, np.array([number], dtype=np.intp), np.array([t]))
    pairs = numbers([float(v[0]) for v in values])
    return {
        "t": t,
        "mode": {m.path: m.states[states[m.path]] for m in run.graph.machines},
        "values": {str(b): [pairs[2 * k], pairs[2 * k + 1]] for k, b in enumerate(bonds)},
    }


def units_of(run: Result, bonds: Sequence[int]) -> Data:
    """Return the units of effort and flow of bonds."""
    domains = {b: run.graph.bonds[b].domain for b in bonds}
    return {str(b): [d.effort_unit, d.flow_unit] for b, d in domains.items()}


def phase(run: Result, x: str, y: str, t0: float, t1: float) -> dict[str, Any]:
    """Return a trajectory in the plane of two signals between two times.

    Returns
    -------
    dict
        ``pieces``, pairs of lists, one per stay in a mode; from one to the next is a jump, which
        may be of no length. ``units`` and ``box`` (x least and greatest, y likewise).

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("lc", domain="electrical")
    >>> m.add(c=hb.C("1 F", e="1 V"), l=hb.I("1 H"), loop=hb.One())
    >>> m.bond("c -> loop", "loop -> l")
    >>> seen = phase(hb.simulate(m, until="7 s"), "l.f", "c.e", 0.0, 7.0)
    >>> len(seen["pieces"]), [round(v, 3) for v in seen["box"]]
    (1, [-1.0, 1.0, -1.0, 1.0])
    """
    if not t1 > t0:
        raise UsageError(
            f"no time between {t0!r} and {t1!r}",
            code="HB-W103",
            where="phase",
            hint="a stretch of the run: its begin, then its end",
        )
    pieces = []
    for (t, a), (_, b) in zip(run.pieces(x), run.pieces(y), strict=True):
        seen = (t >= t0) & (t <= t1) & np.isfinite(a) & np.isfinite(b)
        if seen.any():
            pieces.append((a[seen], b[seen]))
    if not pieces:
        box = [0.0, 1.0, 0.0, 1.0]
    else:
        box = [float(f(np.concatenate(p))) for p in zip(*pieces) for f in (np.min, np.max)]
    apart = 0.5 / PIXELS
    found = _thinned(pieces, box, apart)
    while sum(len(a) for a, _ in found) > POINTS and apart < 0.01:
        apart *= 2.0
        found = _thinned(pieces, box, apart)
    return {
        "pieces": [[numbers(a), numbers(b)] for a, b in found],
        "units": [run.unit(x), run.unit(y)],
        "box": box,
    }


def _thinned(
    pieces: list[tuple[Vector, Vector]], box: list[float], apart: float
) -> list[tuple[Vector, Vector]]:
    """Leave out points that are nearer to the last one kept than `apart` of the picture."""
    wide, high = box[1] - box[0] or 1.0, box[3] - box[2] or 1.0
    found = []
    for a, b in pieces:
        u, v = a / wide, b / high
        way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(u), np.diff(v)))])
        cell = np.floor(way / apart)
        kept = np.concatenate([[True], cell[1:] != cell[:-1]])
        kept[-1] = True
        found.append((a[kept], b[kept]))
    return found
