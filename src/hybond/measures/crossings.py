"""Where a signal crosses a level: instants, the period between them, the time spent above."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.measures.chebyshev import coefficients, evaluate, tails, turning_points
from hybond.measures.pieces import (
    LIMIT,
    NOISE,
    ROUNDS,
    Pieces,
    Reader,
    Whole,
    check_tolerance,
    pieces_of,
    unknown,
)
from hybond.measures.value import About, Measurement
from hybond.measures.window import TOLERANCE, Window
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]
Edge = Literal["rise", "fall", "both"]


@dataclass(frozen=True, slots=True)
class Crossing:
    """An instant at which a signal gets to a level.

    Parameters
    ----------
    t : float
        s.
    edge : {"rise", "fall"}
    jump : bool
        Whether it jumps across.
    """

    t: float
    edge: Literal["rise", "fall"]
    jump: bool = False


def crossings_of(
    run: Result,
    name: str,
    level: float,
    window: Window,
    *,
    edge: Edge = "both",
    tolerance: float = TOLERANCE,
) -> tuple[Crossing, ...]:
    """Return where a signal crosses a level, in order.

    It rises when it gets from below the level to it or beyond, and falls when it gets from above
    to it or beyond. Impulses cross nothing: what counts is beside them.

    Raises
    ------
    NumericsError
        HB-R103, HB-R104.
    UsageError
        HB-R101 for an edge that is none.
    """
    if edge not in ("rise", "fall", "both"):
        raise UsageError(
            f"edge = {edge!r}", code="HB-R101", where="edge", hint='"rise", "fall" or "both"'
        )
    reader = Reader(run, name)
    points = _points(reader, level, window, tolerance)
    above = points.y - level
    up = (above[:-1] < 0.0) & (above[1:] >= 0.0)
    down = (above[:-1] > 0.0) & (above[1:] <= 0.0)
    at = np.flatnonzero({"rise": up, "fall": down}.get(edge, up | down))
    rising = up[at]
    segment = points.segment[at + 1]
    jump = segment != points.segment[at]

    def there(t: Vector) -> NDArray[np.bool_]:
        value = reader(segment, t) - level
        return np.where(rising, value >= 0.0, value <= 0.0)

    high = _bisected(points.t[at], points.t[at + 1], there)
    found = [
        Crossing(t, "rise" if r else "fall", j)
        for t, r, j in zip(high.tolist(), rising.tolist(), jump.tolist(), strict=True)
        if t > window.start or window.first
    ]
    return (*found, *_at_end(reader, window, level, float(above[-1]), edge))


def _at_end(
    reader: Reader, window: Window, level: float, above: float, edge: Edge
) -> list[Crossing]:
    """Return the crossing by a jump at the end of a window, if any: it belongs to the window.

    Parameters
    ----------
    above : float
        The limit from the left there, less the level.
    """
    beyond = reader.beyond(window)
    if beyond is None:
        return []
    if above < 0.0 <= beyond - level and edge != "fall":
        return [Crossing(window.end, "rise", True)]
    if above > 0.0 >= beyond - level and edge != "rise":
        return [Crossing(window.end, "fall", True)]
    return []


@dataclass(frozen=True, slots=True)
class _Points:
    """Points between which a signal crosses a level at most once."""

    segment: Whole
    t: Vector
    y: Vector


def _points(reader: Reader, level: float, window: Window, tolerance: float) -> _Points:
    """Return ends of pieces, and extremes within those that may get to the level."""
    check_tolerance(tolerance)
    todo = pieces_of(reader, window)
    allowed = len(todo) + LIMIT
    peak = abs(level)
    kept: list[tuple[Pieces, Vector, Vector]] = []
    for _ in range(ROUNDS):
        values = reader.of(todo)
        peak = max(peak, float(np.abs(values).max()))
        c = coefficients(values)
        tail = tails(c)
        near = np.abs(c[:, 0] - level) <= np.abs(c[:, 1:]).sum(axis=1) + 10.0 * tail
        fine = ~near | (tail <= max(tolerance, NOISE) * peak)
        fine |= todo.half <= 8.0 * np.spacing(np.abs(todo.high))
        kept.append((todo.part(fine), values[fine], c[fine]))
        todo = todo.part(~fine).halved()
        if not len(todo):
            break
        if len(todo) > allowed:
            raise unknown(reader.name, tolerance)
    else:
        raise unknown(reader.name, tolerance)
    pieces, order = Pieces.joined([p for p, _, _ in kept])
    values = np.concatenate([v for _, v, _ in kept])[order]
    c = np.concatenate([k for _, _, k in kept])[order]
    # the bound says of most pieces that there is no crossing within
    near = np.abs(c[:, 0] - level) <= np.abs(c[:, 1:]).sum(axis=1) + 10.0 * tails(c)
    few = np.flatnonzero(near)
    rows: list[tuple[Whole, Vector, Vector]] = [
        (np.arange(len(pieces)), pieces.low, values[:, 0]),
        (np.arange(len(pieces)), pieces.high, values[:, -1]),
    ]
    for sign in (-1.0, 1.0):
        which, x = turning_points(c[few], sign)
        rows.append((few[which], pieces.at(few[which], x), evaluate(c[few][which], x)))
    piece = np.concatenate([r[0] for r in rows])
    t = np.concatenate([r[1] for r in rows])
    y = np.concatenate([r[2] for r in rows])
    # within a piece by time; a piece that ends comes before the one that begins there
    sort = np.lexsort((t, piece))
    return _Points(pieces.segment[piece[sort]], t[sort], y[sort])


def period_of(
    run: Result,
    name: str,
    level: float,
    window: Window,
    *,
    edge: Edge = "rise",
    tolerance: float = TOLERANCE,
) -> Measurement:
    """Return the mean time from one crossing to the next of the same kind, s.

    Raises
    ------
    UsageError
        HB-R107 if there are less than two.
    """
    found = crossings_of(run, name, level, window, edge=edge, tolerance=tolerance)
    if edge == "both":
        raise UsageError(
            "a period goes from one kind of crossing to the next of the same kind",
            code="HB-R101",
            where="edge",
            hint='"rise" or "fall"',
        )
    if len(found) < 2:
        raise too_few(name, level, found)
    length = (found[-1].t - found[0].t) / (len(found) - 1)
    how = f"{len(found) - 1} periods from t = {found[0].t:.9g} s to {found[-1].t:.9g} s"
    return Measurement(length, About("s", window.start, window.end, how=how))


def duty_of(
    run: Result, name: str, level: float, window: Window, *, tolerance: float = TOLERANCE
) -> Measurement:
    """Return the part of a window in which a signal is above a level."""
    reader = Reader(run, name)
    points = _points(reader, level, window, tolerance)
    # not between crossings: what rests at the level, as the current of a diode at zero, and then
    # rises has crossed nothing; rounding is not above it
    least = level + NOISE * max(abs(level), float(np.abs(points.y).max()))
    above = points.y > least
    at = np.flatnonzero(above[:-1] != above[1:])
    segment, before = points.segment[at + 1], above[at]
    turns = _bisected(
        points.t[at], points.t[at + 1], lambda t: (reader(segment, t) > least) != before
    )
    edges = np.array([window.start, *turns.tolist(), window.end])
    held = np.concatenate([above[:1], above[at + 1]])
    part = float(np.diff(edges)[held].sum()) / window.length
    return Measurement(part, About("", window.start, window.end))


def _bisected(low: Vector, high: Vector, is_there: Callable[[Vector], NDArray[np.bool_]]) -> Vector:
    """Return the first instants at which something holds that does at `high` and not at `low`."""
    low, high = low.copy(), high.copy()
    for _ in range(64):
        middle = 0.5 * (low + high)
        if not ((low < middle) & (middle < high)).any():
            break
        there = is_there(middle)
        low, high = np.where(there, low, middle), np.where(there, middle, high)
    return high


def too_few(name: str, level: float, found: Sequence[Crossing]) -> UsageError:
    """Return the refusal of a period where fewer than two crossings are found."""
    return UsageError(
        f"{name} crosses {level:.6g} {len(found)} times in the window, 2 are wanted",
        code="HB-R107",
        where=name,
        hint="give another level, or a longer window",
    )
