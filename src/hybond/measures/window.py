"""The stretch of a run that is measured: all of it, from one time to another, or whole periods."""

from __future__ import annotations

import math
from bisect import bisect_left
from numbers import Real
from typing import TYPE_CHECKING

from hybond.errors import UsageError
from hybond.records import dataclass
from hybond.units import parse_unit, try_quantity

if TYPE_CHECKING:
    from hybond.result import Result

Time = float | str
"""A time in s, or a quantity: ``"2 ms"``."""

INSTANT = 1e-12
"""Part of the run, at least 8 units in the last place of a time, within which an end of a window
is the instant of an event: a period that is a decimal fraction ends beside the switch it means."""
TOLERANCE = 1e-10
"""Of an integral, as a part of the integral of the magnitude; of extremes, as a part of the
largest value."""
PERIODS = 1_000_000
"""Periods in a window, at the most."""


@dataclass(frozen=True, slots=True)
class Window:
    """From `start` to `end`, s.

    Jumps and impulses at `end` belong to it, those at `start` do not: windows that follow each
    other share nothing. What happens where a run begins belongs to a window that begins there.
    """

    start: float
    end: float
    first: bool = False
    """Whether it begins where the run begins."""

    @property
    def length(self) -> float:
        """How long it is, s."""
        return self.end - self.start

    def has(self, t: float) -> bool:
        """Whether what happens at an instant belongs to it."""
        return self.start < t <= self.end or (self.first and t == self.start)


def window_of(
    run: Result,
    *,
    start: Time | None = None,
    end: Time | None = None,
    period: Time | None = None,
    periods: int | None = None,
) -> Window:
    """Return the window that is asked for.

    Parameters
    ----------
    start, end : float or str, optional
        Times, s or quantities; by default those of the run.
    period : float or str, optional
        A duration (``"20 us"``), or a frequency (``"50 kHz"``).
    periods : int, optional
        How many, default 1: the last ones before `end`, or the first after `start`.

    Raises
    ------
    UsageError
        HB-R101 what is no time, no period or no number of periods, a window that is empty, or
        said twice; HB-R102 one that the run does not cover.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> window_of(hb.simulate(m, until="1 s"), period="4 Hz", periods=2)
    Window(start=0.5, end=1.0, first=False)
    """
    if not run.segments:
        raise UsageError(
            "the run has no motion to measure",
            code="HB-R102",
            where="run",
            hint="see run.error" if run.error else "it ended where it began: see run.events",
        )
    low, high = run.t_begin, run.t_end
    begin = low if start is None else time_of(start, "start")
    finish = high if end is None else time_of(end, "end")
    if period is not None:
        if start is not None and end is not None:
            raise _refused("start, end and period", "period", "leave one of them out")
        many = count_of(1 if periods is None else periods)
        length = many * duration_of(period)
        if start is None:
            begin = finish - length
        else:
            finish = begin + length
    elif periods is not None:
        raise _refused("periods without a period", "periods", 'period="20 us", periods=5')
    edges = _Edges(run)
    begin, finish = edges.near(begin), edges.near(finish)
    for name, t in (("start", begin), ("end", finish)):
        if not low <= t <= high:
            raise UsageError(
                f"the run goes from {low:.9g} to {high:.9g} s, the window to {t:.9g} s"
                if name == "end"
                else f"the run goes from {low:.9g} to {high:.9g} s, the window from {t:.9g} s",
                code="HB-R102",
                where=name if period is None else "periods",
                hint="measure within it, or let the run go on longer",
            )
    if not begin < finish:
        raise _refused(f"a window from {begin:.9g} to {finish:.9g} s", "end", "an end after start")
    return Window(begin, finish, begin == low and not run.trace.segments.forgotten)


def time_of(value: object, where: str) -> float:
    """Return a time, s.

    Raises
    ------
    UsageError
        HB-R101 for what is none.
    """
    number = _number(value)
    if number is not None:
        return number
    found = try_quantity(value) if isinstance(value, str) else None
    if found is None or found.dimension not in (parse_unit("s")[1], parse_unit("1")[1]):
        raise _refused(f"{value!r} is not a time", where, "write 0.002 or '2 ms'")
    return float(found.value)


def duration_of(value: object) -> float:
    """Return a period, s, given as a duration or as a frequency.

    Examples
    --------
    >>> duration_of("20 us"), duration_of("50 Hz"), duration_of(0.5)
    (2e-05, 0.02, 0.5)
    """
    found = try_quantity(value) if isinstance(value, str) else None
    if found is not None and found.dimension == parse_unit("1/s")[1] and found.value > 0.0:
        return 1.0 / found.value
    length = time_of(value, "period")
    if not length > 0.0:
        raise _refused(f"a period of {value!r}", "period", "write 2e-5, '20 us' or '50 kHz'")
    return length


def frequency_of(value: object) -> float:
    """Return a frequency, Hz, given as one or as a period.

    Examples
    --------
    >>> frequency_of(50), frequency_of("20 ms"), frequency_of("1 kHz")
    (50.0, 50.0, 1000.0)
    """
    number = _number(value)
    if number is not None and number > 0.0:
        return number
    found = try_quantity(value) if isinstance(value, str) else None
    if found is not None and 0.0 < found.value < math.inf:
        if found.dimension in (parse_unit("1/s")[1], parse_unit("1")[1]):
            return float(found.value)
        if found.dimension == parse_unit("s")[1]:
            return 1.0 / float(found.value)
    raise _refused(f"{value!r} is not a frequency", "f", "write 50, '50 Hz' or '20 ms'")


def count_of(value: object) -> int:
    """Return a number of periods."""
    number = _number(value)
    if number is None or not number.is_integer() or not 1 <= number <= PERIODS:
        raise _refused(f"periods = {value!r}", "periods", "a whole number, one or more")
    return int(number)


def _number(value: object) -> float | None:
    """Return a number that is finite, None for what is none."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return None
    return float(value) if math.isfinite(value) else None


def _refused(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-R101", where=where, hint=hint)


class _Edges:
    """The ends of a run's segments."""

    def __init__(self, run: Result) -> None:
        self._times = run.trace.segments.times
        self._ends = (run.t_begin, run.t_end)
        self._span = run.t_end - run.t_begin

    def near(self, t: float) -> float:
        """Return the end that is the same instant as `t`, or `t`."""
        reach = max(INSTANT * self._span, 8.0 * math.ulp(t))
        k = bisect_left(self._times, t)
        around = [*self._times[max(k - 1, 0) : k + 1], *self._ends]
        best = min(around, key=lambda a: abs(a - t))
        return best if abs(best - t) <= reach else t


def instant_near(run: Result, t: float) -> float:
    """Return the event of a run that is the same instant as a time, or the time."""
    return _Edges(run).near(t)
