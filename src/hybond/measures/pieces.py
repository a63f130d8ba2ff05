"""A signal over a window as polynomials: as short as it takes to know it to a tolerance.

Between two jumps a run is smooth, and each of its steps is a polynomial. What is asked of it may
be less smooth (``abs(L.f)``): pieces are halved until their polynomial says what the signal is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError, UsageError
from hybond.measures.chebyshev import NODES, WEIGHTS, coefficients, tails
from hybond.measures.window import TOLERANCE, Window
from hybond.model.expressions import Expr, Name
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]
Whole = NDArray[np.intp]
Functions = Callable[[Vector, Vector], Vector]
"""Of values and times, shape (pieces, nodes), to rows of functions, shape (k, pieces, nodes)."""

NOISE = 1e-14
"""Part of the largest value that counts as rounding."""
ROUNDS = 64
"""How often a piece is halved."""
LIMIT = 1_000_000
"""Pieces more than the run has steps, at the most."""


def times_between(low: Vector, high: Vector) -> Vector:
    """Return Chebyshev's points from `low` to `high`, shape (n, 11), the ends exactly."""
    t = 0.5 * (low + high)[:, None] + (0.5 * (high - low))[:, None] * NODES
    t[:, 0], t[:, -1] = low, high
    return np.asarray(t)


def within(low: Vector, high: Vector, x: Vector) -> Vector:
    """Return the times of points between -1 and 1."""
    return np.clip(0.5 * (low + high) + 0.5 * (high - low) * x, low, high)


def halves(low: Vector, high: Vector) -> tuple[Vector, Vector]:
    """Return where the halves of stretches begin and end, in the order of time."""
    middle = 0.5 * (low + high)
    return np.column_stack([low, middle]).ravel(), np.column_stack([middle, high]).ravel()


class Spans:
    """Stretches of time, each with Chebyshev's points; `low` and `high` are their ends, s."""

    __slots__ = ()
    low: Vector
    high: Vector

    def __len__(self) -> int:
        return len(self.low)

    @property
    def half(self) -> Vector:
        """Half the length of each, s."""
        return np.asarray(0.5 * (self.high - self.low))

    def times(self) -> Vector:
        """Return Chebyshev's points of each, shape (n, 11)."""
        return times_between(self.low, self.high)


@dataclass(frozen=True, slots=True)
class Pieces(Spans):
    """Stretches of time within segments of a run, in order.

    Parameters
    ----------
    segment : array of int, shape (n,)
    low, high : arrays, shape (n,)
        Where each begins and ends, s.
    """

    segment: Whole
    low: Vector
    high: Vector

    def at(self, which: Whole, x: Vector) -> Vector:
        """Return the times of points between -1 and 1 in some of the pieces."""
        return within(self.low[which], self.high[which], x)

    def part(self, chosen: NDArray[np.bool_]) -> Pieces:
        """Return some of them."""
        return Pieces(self.segment[chosen], self.low[chosen], self.high[chosen])

    def halved(self) -> Pieces:
        """Return the halves of all."""
        return Pieces(np.repeat(self.segment, 2), *halves(self.low, self.high))

    @staticmethod
    def joined(parts: list[Pieces]) -> tuple[Pieces, Whole]:
        """Return all in the order of time, and the places that they had one after the other."""
        segment = np.concatenate([p.segment for p in parts])
        low = np.concatenate([p.low for p in parts])
        high = np.concatenate([p.high for p in parts])
        order = np.lexsort((low, segment))
        return Pieces(segment[order], low[order], high[order]), order


PARTS = 400
"""Parts of a window in which an expression is looked at, besides the steps of the run: between
them it might be what no point of a step shows."""


def pieces_of(reader: Reader, window: Window) -> Pieces:
    """Return the steps of a run within a window, and those of an expression in even parts too."""
    return steps_of(reader.run, window, 0 if isinstance(reader.expression, Name) else PARTS)


def steps_of(run: Result, window: Window, parts: int = 0) -> Pieces:
    """Return the steps of a run within a window; where impacts come to rest, what lies between.

    Parameters
    ----------
    parts : int
        Even parts of the window that are cut as well.
    """
    segments = run.segments
    even = np.linspace(window.start, window.end, max(parts, 1) + 1)[1:-1]
    starts = run.trace.segments.times
    first = max(int(np.searchsorted(starts, window.start, side="right")) - 1, 0)
    last = int(np.searchsorted(starts, window.end, side="left"))
    which, low, high = [], [], []
    for k in range(first, last):
        until = starts[k + 1] if k + 1 < len(starts) else math.inf
        t = segments[k].t
        if t[-1] < until < math.inf:
            t = np.append(t, until)
        begin, end = max(starts[k], window.start), min(until, run.t_end, window.end)
        own = slice(*np.searchsorted(even, [begin, end]).tolist())
        t = np.concatenate([t[(t > begin) & (t < end)], even[own]])
        cuts = np.unique(np.concatenate([[begin], t, [end]]))
        which.append(np.full(len(cuts) - 1, k, dtype=np.intp))
        low.append(cuts[:-1])
        high.append(cuts[1:])
    return Pieces(np.concatenate(which), np.concatenate(low), np.concatenate(high))


class Reader:
    """Reads an expression of a run at points of its segments.

    Parameters
    ----------
    name : str or Expr
        As written, or in canonical names.
    """

    def __init__(self, run: Result, name: str | Expr) -> None:
        self.run = run
        self.name = name if isinstance(name, str) else "signal"
        self.expression = run.expression(name) if isinstance(name, str) else name
        self._asked = name

    def __call__(self, segment: Whole, t: Vector) -> Vector:
        """Return values at times of segments whose numbers are in order, shape (n,)."""
        if not len(t):
            return np.zeros(0)
        run = self.run
        (found,) = run._of([self._asked], segment, t)
        bad = np.flatnonzero(~np.isfinite(found))
        if len(bad):
            raise NumericsError(
                f"{self.name} is {found[bad[0]]} at t = {t[bad[0]]:.9g} s",
                code="HB-R103",
                where=self.name,
                hint="measure a window, or an expression, in which it has values",
            )
        return found

    def beyond(self, window: Window) -> float | None:
        """Return the limit from the right at the end of a window; None if nothing begins there.

        What happens there belongs to the window; where it leaves no value, there is none.
        """
        t = window.end
        starts = self.run.trace.segments.times
        k = int(np.searchsorted(starts, t, side="right")) - 1
        if k > 0 and starts[k] == t:
            (found,) = self.run._of([self._asked], np.array([k]), np.array([t]))
            value = float(found[0])
        elif t == self.run.t_end and self.run._settled_at_end:
            (value,) = self.run._after_last_event([self._asked])
        else:
            return None
        return value if math.isfinite(value) else None

    def of(self, pieces: Pieces) -> Vector:
        """Return values at Chebyshev's points of pieces, shape (n, 11)."""
        t = pieces.times()
        return self(np.repeat(pieces.segment, t.shape[1]), t.ravel()).reshape(t.shape)


@dataclass(frozen=True, slots=True)
class Known:
    """Functions of time over pieces on which they are polynomials, to a tolerance.

    Parameters
    ----------
    functions : array, shape (functions, pieces, 11)
        Values at Chebyshev's points.
    """

    pieces: Pieces
    functions: Vector

    def integral(self, values: Vector) -> float:
        """Return the integral of values at the points of the pieces."""
        return float((values @ WEIGHTS) @ self.pieces.half)

    def integrals(self) -> list[float]:
        """Return the integrals of the functions."""
        return [self.integral(f) for f in self.functions]

    def of_pieces(self) -> Vector:
        """Return the integrals over each piece, shape (functions, pieces)."""
        return np.asarray((self.functions @ WEIGHTS) * self.pieces.half)


def integrable(
    reader: Reader,
    window: Window,
    functions: Functions,
    *,
    shared: int = 1,
    tolerance: float = TOLERANCE,
) -> Known:
    """Return functions of a signal over a window in pieces on which they can be integrated.

    Parameters
    ----------
    shared : int
        The first of them are measured against the largest of them.
    tolerance : float
        Of each integral, as a part of the integral of the function's magnitude.

    Raises
    ------
    NumericsError
        HB-R103 for a signal without value, HB-R104 for one that cannot be known so well.
    """
    check_tolerance(tolerance)

    def rows(pieces: Pieces) -> Vector:
        return functions(reader.of(pieces), pieces.times())

    return resolved(
        rows, pieces_of(reader, window), name=reader.name, shared=shared, tolerance=tolerance
    )


def resolved(
    rows: Callable[[Pieces], Vector],
    todo: Pieces,
    *,
    name: str,
    shared: int,
    tolerance: float = TOLERANCE,
    beside: Callable[[], Size | None] | None = None,
) -> Known:
    """Return rows of functions in pieces as short as it takes; arguments as `integrable`.

    Parameters
    ----------
    rows : callable
        Functions at Chebyshev's points of pieces, shape (functions, pieces, 11).
    beside : callable, optional
        Returns what the functions have elsewhere: these pieces are a part of what is integrated. It
        is asked where they are not known well enough by what they have themselves.
    """
    allowed = len(todo) + LIMIT
    length = float(2.0 * todo.half.sum())
    done: list[tuple[Pieces, Vector]] = []
    before: Vector = np.zeros(1)
    peak: Vector = np.zeros(1)
    count = 0
    for _ in range(ROUNDS):
        made = rows(todo)
        tail = tails(coefficients(made))
        passing = (np.abs(made) @ WEIGHTS) * todo.half
        here = passing.sum(axis=1)
        peak = np.maximum(np.abs(made).max(axis=(1, 2)), peak)
        ok = _are_known(todo, tail, here + before, peak, length, shared, tolerance)
        if beside is not None and not ok.all():
            if (more := beside()) is not None:
                length, before = length + more.length, before + more.sums
                peak = np.maximum(peak, more.peak)
                ok = _are_known(todo, tail, here + before, peak, length, shared, tolerance)
            beside = None
        done.append((todo.part(ok), made[:, ok]))
        before = before + passing[:, ok].sum(axis=1)
        count += int(ok.sum())
        todo = todo.part(~ok).halved()
        if not len(todo) or len(todo) + count > allowed:
            break
    if len(todo):
        raise unknown(name, tolerance)
    pieces, order = Pieces.joined([p for p, _ in done])
    return Known(pieces, np.concatenate([f for _, f in done], axis=1)[:, order])


def _are_known(
    pieces: Pieces,
    tail: Vector,
    sums: Vector,
    peak: Vector,
    length: float,
    shared: int,
    tolerance: float,
) -> NDArray[np.bool_]:
    """Return which pieces are short enough, of what their polynomials leave of the functions."""
    sums, peak = sums.copy(), peak.copy()
    sums[:shared] = sums[:shared].max()
    peak[:shared] = peak[:shared].max()
    fine = tail <= tolerance * (sums / length)[:, None]
    fine |= tail * pieces.half <= 1e-2 * tolerance * sums[:, None]
    fine |= tail <= NOISE * peak[:, None]
    short = pieces.half <= 8.0 * np.spacing(np.abs(pieces.high))
    return np.asarray(fine.all(axis=0) | short)


@dataclass(frozen=True, slots=True)
class Size:
    """How large functions are in some pieces.

    Parameters
    ----------
    sums, peak : arrays, shape (functions,)
        Integrals of their magnitudes, and their largest ones.
    length : float
        Of the pieces, s.
    """

    sums: Vector
    peak: Vector
    length: float

    @staticmethod
    def of(rows: Callable[[Pieces], Vector], pieces: Pieces) -> Size:
        """Return that in pieces that are not cut."""
        made = np.abs(rows(pieces))
        length = float(2.0 * pieces.half.sum())
        return Size(made @ WEIGHTS @ pieces.half, made.max(axis=(1, 2)), length)

    @staticmethod
    def joined(sizes: Sequence[Size]) -> Size | None:
        """Return that of several together."""
        if not sizes:
            return None
        return Size(
            np.sum([s.sums for s in sizes], axis=0),
            np.max([s.peak for s in sizes], axis=0),
            sum(s.length for s in sizes),
        )


def unknown(name: str, tolerance: float) -> NumericsError:
    """Return the refusal of a signal that is too rough."""
    return NumericsError(
        f"{name} is too rough to be known to {tolerance:g}",
        code="HB-R104",
        where=name,
        hint="give tolerance=1e-6, or measure a shorter window",
    )


def check_tolerance(tolerance: object) -> None:
    """Refuse what is no tolerance.

    Raises
    ------
    UsageError
        HB-R101.
    """
    if not isinstance(tolerance, float) or not 1e-13 <= tolerance <= 0.1:
        raise UsageError(
            f"tolerance = {tolerance!r}",
            code="HB-R101",
            where="tolerance",
            hint="from 1e-13 to 0.1; 1e-10 if it is left out",
        )
