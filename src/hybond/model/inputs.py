"""Inputs: what the surroundings impose as functions of time.

An input is smooth between its breakpoints. At a breakpoint it has a left and a right limit;
`value` takes the side by the piece that is asked for: a caller fixes ``piece`` for the whole
interval between two timed events, so that an interval's last instant still reads its own piece.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable
from dataclasses import field
from typing import Protocol

from hybond.model.rate_of_function import CELLS, longest_near, rate_of
from hybond.records import dataclass
from hybond.units import Dimension

INSTANT = 1e-9
"""Part of the time of a run within which its last instant ends: nothing is asked beyond it."""


class Waveform(Protocol):
    """A function of time in pieces."""

    def piece(self, t: float) -> int:
        """Return the number of the piece that begins at or contains `t` (right limit)."""

    def value(self, t: float, piece: int) -> float:
        """Return the value of piece number `piece`, extended to `t` if need be."""

    def rate(self, t: float, piece: int) -> float:
        """Return the time derivative within the piece."""


@dataclass(frozen=True, slots=True)
class _Level:
    level: float
    """Where it starts, and stays in a run."""

    def piece(self, t: float) -> int:
        """Return 0: there is one piece."""
        return 0

    def value(self, t: float, piece: int) -> float:
        """Return the level."""
        return self.level

    def rate(self, t: float, piece: int) -> float:
        """Return 0: inputs are held between the instants at which they are set."""
        return 0.0


@dataclass(frozen=True, slots=True)
class Constant(_Level):
    """A constant input."""


@dataclass(frozen=True, slots=True)
class Free(_Level):
    """An input that is set from outside while the model runs, in an exported program only."""


@dataclass(frozen=True, slots=True)
class Timetable:
    """A table of (time, value): held from each time on, or joined by straight lines.

    Before the first time the first value holds, and after the last time the last one. Two rows
    with the same time in a linear table are a jump. With a `period` the table begins anew that long
    after its first time, and so on: its last row then leads to the first row of the next round,
    unless it is itself a period after the first.

    Row j of round k is at ``times[j] + k * period``, never the sum of many periods, so that rounds
    do not drift.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]
    linear: bool = False
    period: float = 0.0
    """Time after which the table repeats, s; 0 if it does not."""

    def rows(self) -> int:
        """Return how many rows a round has: one at its very end is the beginning of the next."""
        closed = len(self.times) > 1 and self.times[-1] >= self.times[0] + self.period
        return len(self.times) - 1 if closed else len(self.times)

    def begin(self, piece: int) -> float:
        """Return the time at which a piece begins, minus infinity for the first."""
        if piece == 0:
            return -math.inf
        if not self.period:
            return self.times[piece - 1]
        turn, row = divmod(piece - 1, self.rows())
        return self.times[row] + turn * self.period

    def piece(self, t: float) -> int:
        """Return how many of the times are at or before `t`."""
        if not self.period or t < self.times[0]:
            return bisect.bisect_right(self.times, t)
        guess = max(0, math.floor((t - self.times[0]) / self.period) - 1) * self.rows()
        while self.begin(guess + 1) <= t:
            guess += 1
        return guess

    def value(self, t: float, piece: int) -> float:
        """Return the held or interpolated value of a piece."""
        if piece == 0:
            return self.values[0]
        row = (piece - 1) % self.rows() if self.period else piece - 1
        rate = self.rate(t, piece)
        return self.values[row] + rate * (t - self.begin(piece)) if rate else self.values[row]

    def rate(self, t: float, piece: int) -> float:
        """Return the slope of a piece, 0 where the value is held."""
        if not self.linear or piece == 0:
            return 0.0
        if not self.period:
            if piece == len(self.times):
                return 0.0
            rise = self.values[piece] - self.values[piece - 1]
            return rise / (self.times[piece] - self.times[piece - 1])
        row = (piece - 1) % self.rows()
        last = row + 1 == len(self.times)
        rise = self.values[0 if last else row + 1] - self.values[row]
        end = self.times[0] + self.period if last else self.times[row + 1]
        return rise / (end - self.times[row])


@dataclass(frozen=True, slots=True)
class Pwm:
    """Pulse-width modulation: `high` for the first ``duty * period`` of each period.

    Edge n is computed from n, never by adding periods up, so that edges do not drift.
    """

    period: float
    duty: float
    high: float = 1.0
    low: float = 0.0
    phase: float = 0.0
    """Time of the first rising edge, s."""

    def _edge(self, piece: int) -> float:
        cycle, falling = divmod(piece, 2)
        return self.phase + (cycle + (self.duty if falling else 0.0)) * self.period

    def piece(self, t: float) -> int:
        """Return ``2 n`` while high in cycle n, ``2 n + 1`` while low."""
        guess = 2 * math.floor((t - self.phase) / self.period) - 2
        while self._edge(guess + 1) <= t:
            guess += 1
        return guess

    def value(self, t: float, piece: int) -> float:
        """Return `high` or `low`."""
        return self.low if piece % 2 else self.high

    def rate(self, t: float, piece: int) -> float:
        """Return 0."""
        return 0.0


@dataclass(frozen=True, slots=True)
class Called:
    """A Python callable of time, smooth except at the listed breaks (API only, never from a file).

    At a break the callable is asked just right of it; the left limit is asked just left.
    """

    function: Callable[[float], float]
    breaks: tuple[float, ...] = ()
    end: float = math.inf
    """The end of the run that asks, s, where one does."""
    spans: dict[tuple[int, int], float] = field(
        default_factory=dict, init=False, compare=False, repr=False
    )
    """The longest span that rates are taken over, s, by the piece and the part of the run.

    They are those of one `end`: of a copy for another there are none yet."""

    def piece(self, t: float) -> int:
        """Return how many breaks are at or before `t`."""
        return bisect.bisect_right(self.breaks, t)

    def value(self, t: float, piece: int) -> float:
        """Call the function, from inside the piece."""
        return float(self.function(self._inside(t, piece)))

    def rate(self, t: float, piece: int) -> float:
        """Return the rate by differences: a callable has no derivative of its own.

        It is asked within the piece, never before t = 0, and not beyond the end of the run.
        """
        low, high = self._ends(piece)
        t = self._inside(t, piece)
        end = self.end if t <= self.end else math.inf
        first = max(low, 0.0) if t >= 0.0 else low
        if math.isinf(self.end):
            return rate_of(self._number, t, first, high, max(1.0, abs(t)))
        high = min(high, end)
        part = (piece, math.floor(t / (self.end / CELLS)))
        if not 0.0 <= t < high or part[1] >= CELLS:
            return rate_of(self._number, t, first, high, self.end)
        if part not in self.spans:
            self.spans[part] = longest_near(self._number, t, first, high, self.end)
        return rate_of(self._number, t, first, high, self.end, self.spans[part])

    def _number(self, t: float) -> float:
        return float(self.function(t))

    def _ends(self, piece: int) -> tuple[float, float]:
        low = self.breaks[piece - 1] if piece else -math.inf
        return low, self.breaks[piece] if piece < len(self.breaks) else math.inf

    def _inside(self, t: float, piece: int) -> float:
        low, high = self._ends(piece)
        if self.end < t <= self.end * (1.0 + INSTANT):
            t = self.end
        return max(math.nextafter(high, -math.inf) if t >= high else t, low)


@dataclass(frozen=True, slots=True)
class Input:
    """A named input of a model."""

    index: int
    path: str
    waveform: Waveform
    dimension: Dimension | None = field(default=None)
