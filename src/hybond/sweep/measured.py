"""Extremes and means of many members at once, of the steps that the library has kept of them.

What `measures.extremes` and `measures.averages` do with one run, for all members of a part: their
pieces stand one after the other, and what is of a member is a number for each. Nothing of it
depends on which members are beside.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.members import Kept, Ran
from hybond.errors import HybondError
from hybond.measures.asked import Asked
from hybond.measures.chebyshev import NODES, WEIGHTS, evaluate, tails, turning_points
from hybond.measures.chebyshev import coefficients_of as coefficients
from hybond.measures.chebyshev import in_order as summed
from hybond.measures.pieces import (
    NOISE,
    PARTS,
    ROUNDS,
    Spans,
    check_tolerance,
    halves,
    within,
)
from hybond.measures.window import INSTANT, TOLERANCE, duration_of, time_of
from hybond.records import dataclass

Vector = NDArray[np.float64]
Whole = NDArray[np.intp]
Mask = NDArray[np.bool_]
Values = Callable[[int, Vector, Whole], Vector]
EXTREMES = ("max", "min", "max_at", "min_at", "peak_to_peak")
LIMIT = 4000
"""Pieces of one member that are looked at beside those of the others."""
AVERAGES = ("mean", "integral", "rms")
OPTIONS = {"start", "end", "period", "periods", "tolerance", "impulses"}


@dataclass(frozen=True, slots=True)
class Measure:
    """A measurement of the members of a sweep.

    Parameters
    ----------
    text : str
    function : str
    signal : str
    start, end : float
        Its window, s.
    tolerance : float
    refuses : bool
        Whether an ordinary run has to say what impulses make of it.
    """

    text: str
    function: str
    signal: str
    start: float
    end: float
    tolerance: float
    refuses: bool

    @property
    def is_extreme(self) -> bool:
        """Whether it asks for the largest or the smallest value."""
        return self.function in EXTREMES


def measure_of(asked: Asked, text: str, until: float) -> Measure | None:
    """Return what the steps of members tell of a measurement; None if a run must be asked.

    Examples
    --------
    >>> from hybond.measures.asked import read_measure
    >>> found = measure_of(read_measure("mean(x, period=0.25, periods=2)"), "m", 2.0)
    >>> found.start, found.end
    (1.5, 2.0)
    >>> measure_of(read_measure("thd(x, 50 Hz)"), "m", 2.0) is None
    True
    """
    given = asked.options
    if asked.function not in (*EXTREMES, *AVERAGES) or not given.keys() <= OPTIONS:
        return None
    try:
        tolerance = given.get("tolerance", TOLERANCE)
        check_tolerance(tolerance)
        start, end = _window(given, until)
    except HybondError:
        return None  # which the run refuses
    impulses = given.get("impulses", "refuse")
    if not 0.0 <= start < end <= until or impulses not in ("refuse", "leave out"):
        return None
    refuses = impulses == "refuse"
    return Measure(text, asked.function, asked.signal, start, end, tolerance, refuses)


def _window(given: Mapping[str, Any], until: float) -> tuple[float, float]:
    """Return the window that options ask for, as `measures.window.window_of`; else an empty one."""
    start = time_of(given["start"], "start") if "start" in given else 0.0
    end = time_of(given["end"], "end") if "end" in given else until
    if "period" not in given:
        return (start, end) if "periods" not in given else (0.0, -1.0)
    periods = given.get("periods", 1)
    if ("start" in given and "end" in given) or not float(periods).is_integer() or periods < 1:
        return 0.0, -1.0
    length = int(periods) * duration_of(given["period"])
    return (start, start + length) if "start" in given else (end - length, end)


@dataclass(frozen=True, slots=True)
class Stretches(Spans):
    """Pieces of the steps of members, one member after the other, in order of time.

    Parameters
    ----------
    member, step : arrays of int, shape (n,)
    low, high : arrays, shape (n,)
        s.
    """

    member: Whole
    step: Whole
    low: Vector
    high: Vector

    def part(self, chosen: Mask | Whole) -> Stretches:
        """Return some of them."""
        return Stretches(
            self.member[chosen], self.step[chosen], self.low[chosen], self.high[chosen]
        )

    def halved(self) -> Stretches:
        """Return the halves of all."""
        return Stretches(
            np.repeat(self.member, 2), np.repeat(self.step, 2), *halves(self.low, self.high)
        )

    @property
    def firsts(self) -> Whole:
        """Where the pieces of each member that has some begin."""
        return np.flatnonzero(np.append(True, self.member[1:] != self.member[:-1]))


class Measuring:
    """Measures members that have just run.

    Parameters
    ----------
    measures : sequence of Measure
    is_name : sequence of bool
        Of each measure, whether its signal is a name: a polynomial in each step.
    reads : sequence of array of int
        Of each measure, which of the slots that are looked at it reads.
    ends : array of int
        Where these slots stand among those that are looked at where a run ends, if extremes are
        asked for.
    """

    def __init__(
        self,
        measures: Sequence[Measure],
        is_name: Sequence[bool],
        reads: Sequence[Whole],
        ends: Whole,
    ) -> None:
        self.measures, self._is_name, self._reads = measures, is_name, reads
        self._ends = ends

    def of(self, ran: Ran, values: Values) -> tuple[Vector, Mask]:
        """Return measurements, shape (measures, members), and of which members all are known.

        Parameters
        ----------
        values : callable
            Values of a measure's signal, by its number, of slots, shape (points, slots), and of
            the members of the points.
        """
        kept = ran.kept
        assert kept is not None
        many = len(ran.plain)
        found = np.full((len(self.measures), many), np.nan)
        known = ran.plain.copy()
        for k, measure in enumerate(self.measures):
            if (measure.refuses or not self._is_name[k]) and len(self._reads[k]):
                known &= ~kept.struck[:, self._reads[k]].any(axis=1)
        firsts: dict[object, tuple[Stretches, Vector]] = {}
        for k, measure in enumerate(self.measures):
            # what a window begins with is the same for all signals of its kind
            asked = (measure.start, measure.end, self._is_name[k])
            one = _One(k, kept, known, values)
            window = _Windows(kept, measure, ran.end, known)
            if asked not in firsts:
                pieces = window.pieces(0 if self._is_name[k] else PARTS)
                firsts[asked] = pieces, one.look(pieces, pieces.times())
            pieces, slots = firsts[asked]
            here = known[pieces.member]
            if not here.all():
                pieces, slots = pieces.part(here), slots[np.repeat(here, len(NODES))]
            if len(pieces):
                last = one.beyond(window, ran, self._ends) if measure.is_extreme else None
                found[k] = one.measured(measure, window, pieces, slots, last)
        found[:, ~known] = np.nan
        return found, known


class _Windows:
    """The window of a measurement in each member: its ends are instants that are beside them."""

    def __init__(self, kept: Kept, measure: Measure, end: Vector, known: Mask) -> None:
        self.kept, self.known = kept, known
        many = len(kept.many)
        self.first = np.cumsum(kept.many) - kept.many
        self._member = np.repeat(np.arange(many), kept.many)
        span = np.where(known, end, 1.0)
        self.start = self._near(measure.start, span)
        self.end = self._near(measure.end, span)
        known &= (self.start < self.end) & (self.end <= end)

    def _near(self, t: float, span: Vector) -> Vector:
        found = np.full(len(span), t)
        reach = np.maximum(INSTANT * span, 8.0 * math.ulp(t))
        best = reach.copy()
        starts = self.kept.time[:, 0]
        near = self.kept.begins & (np.abs(starts - t) <= reach[self._member])
        candidates = [(self._member[k], starts[k]) for k in np.flatnonzero(near).tolist()]
        candidates += [(k, span[k]) for k in np.flatnonzero(np.abs(span - t) <= reach).tolist()]
        candidates += [(k, 0.0) for k in np.flatnonzero(t <= reach).tolist()]
        for member, instant in candidates:
            if abs(instant - t) <= best[member]:
                best[member], found[member] = abs(instant - t), instant
        return found

    def pieces(self, parts: int) -> Stretches:
        """Return the steps of all members within their windows, and even parts of these too."""
        kept, known = self.kept, np.flatnonzero(self.known & (self.kept.many > 0))
        last = self.first[known] + kept.many[known] - 1
        of_steps = self.known[self._member]
        step = np.flatnonzero(of_steps)
        ends = [self.start[known], self.end[known], kept.time[last, 1]]
        if parts:
            even = np.linspace(self.start[known], self.end[known], parts + 1)[1:-1]
            ends.append(even.T.ravel())
        member = np.concatenate(
            [
                *(self._member[step], known, known, known),
                *([np.repeat(known, parts - 1)] if parts else []),
            ]
        )
        t = np.concatenate([kept.time[step, 0], *ends])
        of = np.concatenate([step, np.full(len(t) - len(step), -1)])
        order = np.lexsort((t, member))
        member, t, of = member[order], t[order], np.maximum.accumulate(of[order])
        low, high, own = t[:-1], t[1:], member[:-1]
        inside = (own == member[1:]) & (low < high) & (of[:-1] >= self.first[own])
        inside &= (low >= self.start[own]) & (high <= self.end[own])
        return Stretches(own[inside], of[:-1][inside], low[inside], high[inside])


class _One:
    """One measurement of all members."""

    def __init__(self, number: int, kept: Kept, known: Mask, values: Values) -> None:
        self.number, self.kept, self.known, self.values = number, kept, known, values

    def look(self, pieces: Stretches, t: Vector) -> Vector:
        """Return slots at times of pieces, shape (points, slots)."""
        each = t.size // max(len(pieces), 1)
        member = np.repeat(pieces.member, each)
        slots, blind = self.kept.look(member, np.repeat(pieces.step, each), t.ravel())
        self.known &= ~blind
        return slots

    def read(self, pieces: Stretches, t: Vector, slots: Vector | None = None) -> Vector:
        """Return values at times of pieces, shape (n, ...); who has none is not known."""
        if slots is None:
            slots = self.look(pieces, t)
        each = t.size // max(len(pieces), 1)
        member = np.repeat(pieces.member, each)
        values = self.values(self.number, slots, member)
        bad = ~np.isfinite(values)
        if bad.any():
            self.known[member[bad]] = False
            values = np.where(bad, 0.0, values)
        return values.reshape(t.shape)

    def _few(self, todo: Stretches) -> Stretches:
        """Return pieces without those of members that have too many; a run says these."""
        many = np.bincount(todo.member, minlength=len(self.known)) > LIMIT
        self.known[many] = False
        return todo.part(~many[todo.member])

    def beyond(self, window: _Windows, ran: Ran, ends: Whole) -> tuple[Vector, Vector]:
        """Return when windows end, and what is left where the run does, too; nan elsewhere.

        Parameters
        ----------
        ends : array of int
            Where slots stand among those that the library tells of the end of a run.
        """
        end = window.end
        found = np.full(len(end), np.nan)
        over = np.flatnonzero(self.known & (end == ran.end))
        if len(over):
            found[over] = self.values(self.number, ran.out[over, -1][:, ends], over)
        return end, np.where(np.isfinite(found), found, np.nan)

    def measured(
        self,
        measure: Measure,
        window: _Windows,
        pieces: Stretches,
        slots: Vector,
        last: tuple[Vector, Vector] | None,
    ) -> Vector:
        """Return the measurement of each member."""
        values = self.read(pieces, pieces.times(), slots)
        length = window.end - window.start
        match measure.function:
            case "mean":
                return self.integral(measure, pieces, values) / length
            case "integral":
                return self.integral(measure, pieces, values)
            case "rms":
                square = self.integral(measure, pieces, values, power=2)
                return np.sqrt(np.maximum(square, 0.0) / length)
            case "peak_to_peak":
                low, high = (self.extreme(measure, pieces, values, s, last)[1] for s in (-1.0, 1.0))
                return high - low
        sign = 1.0 if measure.function.startswith("max") else -1.0
        t, best = self.extreme(measure, pieces, values, sign, last)
        return t if measure.function.endswith("_at") else best

    def integral(
        self, measure: Measure, todo: Stretches, first: Vector, *, power: int = 1
    ) -> Vector:
        """Return the integral over each window, as `measures.pieces.resolved`."""
        many = len(self.known)
        length = _sums(todo.member, 2.0 * todo.half, many)
        before, peak, total = np.zeros((3, many))
        for k in range(ROUNDS):
            made = first if k == 0 else self.read(todo, todo.times())
            made = made**power
            own, half = todo.member, todo.half
            tail = tails(coefficients(made))
            passing = summed(np.abs(made), WEIGHTS) * half
            sums = _sums(own, passing, many) + before
            _raise(peak, todo, np.abs(made).max(axis=1))
            tolerance = measure.tolerance
            with np.errstate(divide="ignore", invalid="ignore"):
                fine = tail <= tolerance * (sums / length)[own]
            fine |= tail * half <= 1e-2 * tolerance * sums[own]
            fine |= (tail <= NOISE * peak[own]) | (half <= 8.0 * np.spacing(np.abs(todo.high)))
            total += _sums(own[fine], (summed(made, WEIGHTS) * half)[fine], many)
            before += _sums(own[fine], passing[fine], many)
            todo = todo.part(~fine & self.known[own]).halved()
            todo = self._few(todo)
            if not len(todo):
                break
        self.known[todo.member] = False
        return total

    def extreme(
        self,
        measure: Measure,
        todo: Stretches,
        first: Vector,
        sign: float,
        last: tuple[Vector, Vector] | None,
    ) -> tuple[Vector, Vector]:
        """Return when each has its extreme first, and the extreme, as `measures.extremes`."""
        many = len(self.known)
        best, t, value = np.full(many, -np.inf), np.zeros(many), np.zeros(many)
        peak = np.zeros(many)
        hills: list[tuple[Stretches, Vector]] = []
        for k in range(ROUNDS):
            values = first if k == 0 else self.read(todo, todo.times())
            own = todo.member
            _raise(peak, todo, np.abs(values).max(axis=1))
            node = np.argmax(sign * values, axis=1)
            rows = np.arange(len(todo))
            at, top = todo.times()[rows, node], values[rows, node]
            _better(sign, own, at, top, best, t, value)
            c = coefficients(values)
            tail = tails(c)
            bound = sign * c[:, 0] + np.abs(c[:, 1:]).sum(axis=1) + 10.0 * tail
            hopeful = (bound > best[own] + NOISE * peak[own]) & self.known[own]
            fine = tail <= max(measure.tolerance * 1e-2, NOISE) * peak[own]
            fine |= todo.half <= 8.0 * np.spacing(np.abs(todo.high))
            hills.append((todo.part(hopeful & fine), c[hopeful & fine]))
            todo = todo.part(hopeful & ~fine).halved()
            todo = self._few(todo)
            if not len(todo):
                break
        self.known[todo.member] = False
        for pieces, c in hills:
            which, x = turning_points(c, sign)
            values = sign * evaluate(c[which], x)
            own = pieces.member[which]
            above = values > best[own] + NOISE * peak[own]
            if not above.any():
                continue
            which, x, values, own = which[above], x[above], values[above], own[above]
            order = np.lexsort((-values, own))
            order = order[np.append(True, own[order][1:] != own[order][:-1])]
            low, high = pieces.low[which[order]], pieces.high[which[order]]
            at = within(low, high, x[order])
            exact = self.read(pieces.part(which[order]), at)
            _better(sign, own[order], at, exact, best, t, value)
        if last is not None:
            beyond = sign * last[1] > sign * value + NOISE * np.abs(value)
            t[beyond], value[beyond] = last[0][beyond], last[1][beyond]
        return t, value


def _better(
    sign: float, own: Whole, at: Vector, top: Vector, best: Vector, t: Vector, value: Vector
) -> None:
    """Put down of each member what is beyond its best so far, and of equals the first."""
    order = np.lexsort((at, -sign * top, own))
    order = order[np.append(True, own[order][1:] != own[order][:-1])]
    order = order[sign * top[order] > best[own[order]]]
    which = own[order]
    best[which], t[which], value[which] = sign * top[order], at[order], top[order]


def _raise(peak: Vector, pieces: Stretches, sizes: Vector) -> None:
    firsts = pieces.firsts
    own = pieces.member[firsts]
    peak[own] = np.maximum(peak[own], np.maximum.reduceat(sizes, firsts))


def _sums(own: Whole, values: Vector, many: int) -> Vector:
    return np.asarray(np.bincount(own, weights=values, minlength=many), dtype=float)
