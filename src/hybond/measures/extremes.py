"""The largest and the smallest value of a signal, and when it is taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.measures.averages import Impulses, without_impulses
from hybond.measures.chebyshev import coefficients, evaluate, tails, turning_points
from hybond.measures.pieces import (
    LIMIT,
    NOISE,
    ROUNDS,
    Pieces,
    Reader,
    check_tolerance,
    pieces_of,
    unknown,
)
from hybond.measures.value import About, Measurement
from hybond.measures.window import TOLERANCE, Window

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]


def extreme_of(
    run: Result,
    name: str,
    window: Window,
    sign: float,
    *,
    impulses: Impulses = "refuse",
    tolerance: float = TOLERANCE,
) -> Measurement:
    """Return the maximum (`sign` = 1) or minimum (-1) of the motion itself, with its time.

    At a jump both limits count; of several times the first is told.

    Raises
    ------
    UsageError
        HB-R106 for a signal with impulses in the window.
    NumericsError
        HB-R103, HB-R104.
    """
    what = "maximum" if sign > 0.0 else "minimum"
    how = without_impulses(run, name, window, impulses, what)
    reader = Reader(run, name)
    segment, t, value = _best(reader, window, sign, tolerance)
    # what the last instant leaves begins no window that would have it
    beyond = reader.beyond(window) if window.end == run.t_end else None
    if beyond is not None and sign * beyond > sign * value + NOISE * abs(value):
        about = About(run.unit(name), window.start, window.end, t=window.end, side="right", how=how)
        return Measurement(beyond, about)
    begins, ends = run.trace.segments.times[segment], t
    at_begin = t == begins and t > run.t_begin
    at_end = segment + 1 < len(run.segments) and ends == run.trace.segments.times[segment + 1]
    side = ""
    beside: float | None = None
    if at_begin or at_end:
        beside = float(
            reader(np.array([segment - 1 if at_begin else segment + 1]), np.array([t]))[0]
        )
    elif t == run.t_end:
        # where the run ends, no segment begins
        beside = reader.beyond(window)
    if beside is not None and abs(beside - value) > tolerance * max(abs(value), abs(beside)):
        side = "right" if at_begin else "left"
    about = About(run.unit(name), window.start, window.end, t=t, side=side, how=how)
    return Measurement(value, about)


def range_of(
    run: Result,
    name: str,
    window: Window,
    *,
    impulses: Impulses = "refuse",
    tolerance: float = TOLERANCE,
) -> Measurement:
    """Return the maximum less the minimum."""
    low, high = (
        extreme_of(run, name, window, sign, impulses=impulses, tolerance=tolerance)
        for sign in (-1.0, 1.0)
    )
    about = About(run.unit(name), window.start, window.end, how=high.how)
    return Measurement(float(high) - float(low), about)


def _best(
    reader: Reader, window: Window, sign: float, tolerance: float
) -> tuple[int, float, float]:
    """Return segment, time and value of the extreme.

    A piece is left out when its polynomial cannot get beyond the best value so far: no Chebyshev
    polynomial does beyond one.
    """
    check_tolerance(tolerance)
    todo = pieces_of(reader, window)
    allowed = len(todo) + LIMIT
    best = -np.inf
    peak = 0.0
    # of each round: segment, time, value, and of them the best at nodes
    found: list[tuple[int, float, float]] = []
    known: list[tuple[Pieces, Vector]] = []
    for _ in range(ROUNDS):
        values = reader.of(todo)
        peak = max(peak, float(np.abs(values).max()))
        piece, node = np.unravel_index(int(np.argmax(sign * values)), values.shape)
        top = float(values[piece, node])
        if sign * top > best:
            best = sign * top
            found.append((int(todo.segment[piece]), float(todo.times()[piece, node]), top))
        c = coefficients(values)
        tail = tails(c)
        bound = sign * c[:, 0] + np.abs(c[:, 1:]).sum(axis=1) + 10.0 * tail
        hopeful = bound > best + NOISE * peak
        fine = tail <= max(tolerance * 1e-2, NOISE) * peak
        fine |= todo.half <= 8.0 * np.spacing(np.abs(todo.high))
        known.append((todo.part(hopeful & fine), c[hopeful & fine]))
        todo = todo.part(hopeful & ~fine).halved()
        if not len(todo):
            break
        if len(todo) > allowed:
            raise unknown(reader.name, tolerance)
    else:
        raise unknown(reader.name, tolerance)
    for pieces, c in known:
        which, x = turning_points(c, sign)
        values = evaluate(c[which], x)
        for k in np.flatnonzero(sign * values > best + NOISE * peak).tolist():
            if sign * values[k] > best + NOISE * peak:
                best = float(sign * values[k])
                t = pieces.at(which[[k]], x[[k]])
                exact = reader(pieces.segment[which[[k]]], t)
                found.append((int(pieces.segment[which[k]]), float(t[0]), float(exact[0])))
    return max(found, key=lambda f: (sign * f[2], -f[1]))
