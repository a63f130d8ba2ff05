"""Accumulation (Zeno): impacts that follow each other ever faster, towards a limit in time.

Each machine is watched on its own: the instants of its pinnacles, and how fast what its impact law
reads is still going. So several contacts may accumulate at once, each by its own ratio. Nothing
here decides what happens at the limit; `landing` does.

Intervals that shrink by a factor r have the limit ``t_n + gap * r / (1 - r)``, and r is the ratio
of the last two of them: this is Aitken's delta-squared. What is left after an impact is known a
second time from the motion itself: the impulse P that would end the rebound at once and the
reaction N that the contact would then carry give the next flight, ``2 P / N`` long and
``v P / (2 N)`` high.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

SHRINKING = 12
"""Intervals in a row that must shrink before a limit is believed without a look at the motion."""
REMAINING = 1e-7
"""Time room: impacts may end at their limit if what is left to it is below this part of the time;
the limit itself is extrapolated."""
CHATTERING = 1e-10
"""The same for events that are not impacts: a dozen of them, and the run stops."""
SOONEST = 1e-6
"""That part is taken of at least this part of the run."""
POSITION = 1e-16
"""Position tolerance: a rebound below this part of the machine's longest flight is none, and never
starts. It is what a position of that size is rounded by; in a flight, height goes with the square
of time, so this is about a tenth of the time room."""
TICKS = 64
"""A flight of so few units in the last place of the time cannot be told from none."""


def aitken(a: float, b: float, c: float) -> float:
    """Return the limit of a sequence by Aitken's delta-squared process.

    Exact for geometric sequences; infinity for one that does not converge. Source: A. C. Aitken,
    *On Bernoulli's numerical solution of algebraic equations*, Proc. R. Soc. Edinburgh 46, 1926.

    Examples
    --------
    >>> aitken(1.0, 1.5, 1.75)
    2.0
    >>> aitken(0.0, 1.0, 2.0)
    inf
    """
    first, second = b - a, c - b
    if abs(second) >= abs(first):
        return c if second == 0.0 else float("inf")
    return c + second * second / (first - second)


@dataclass(frozen=True, slots=True)
class Limit:
    """Where a sequence of instants ends.

    Parameters
    ----------
    t : float
        s.
    ratio : float or None
        Of successive intervals; None if they are too short to tell.
    left : float
        What is left to it after the last instant, s.
    """

    t: float
    ratio: float | None
    left: float


def limit_of(times: Sequence[float]) -> Limit | None:
    """Return the limit of instants whose last intervals shrink; None if they do not.

    Parameters
    ----------
    times : sequence of float
        In order. The limit is Aitken's of the first, middle and last; the ratio is the mean.

    Examples
    --------
    >>> limit_of([0.0, 1.0, 1.5, 1.75])
    Limit(t=2.0, ratio=0.5, left=0.25)
    >>> limit_of([0.0, 1.0, 2.0]) is None
    True
    """
    gaps = np.diff(np.asarray(times, dtype=float))
    if len(gaps) < 2 or not (gaps > 0.0).all() or not (gaps[1:] < gaps[:-1]).all():
        return None
    # three instants far apart, so that their rounding matters least
    stride = (len(times) - 1) // 2
    end = aitken(*(float(times[-1 - k * stride]) for k in (2, 1, 0)))
    ratio = float((gaps[-1] / gaps[0]) ** (1.0 / (len(gaps) - 1)))
    return Limit(end, ratio, end - float(times[-1]))


@dataclass(frozen=True, slots=True)
class Clock:
    """How finely time is told: `until` is the end of the run, s.

    Examples
    --------
    >>> Clock(10.0).room(1.0)
    1e-07
    """

    until: float

    def room(self, t: float) -> float:
        """Return how far impacts may be from their limit to end there, s."""
        return REMAINING * self._since(t)

    def moment(self, t: float) -> float:
        """Return what counts as one moment for events that are not impacts, s."""
        return CHATTERING * self._since(t)

    def tick(self, t: float) -> float:
        """Return how long a flight must be to be told from none, s."""
        return max(TICKS * float(np.spacing(abs(t))), CHATTERING * SOONEST * self.until)

    def _since(self, t: float) -> float:
        return max(abs(t), SOONEST * self.until)


@dataclass(slots=True)
class Series:
    """The impacts of one machine since it was last at rest.

    Parameters
    ----------
    times : list of float
        The last of them, s.
    count : int
        How many there were.
    since : float
        When the flight under way, or the first one, began, s.
    speed : float
        The most that the impact law has read: an approach.
    flight : float
        The longest flight, approach times duration.
    signs : dict
        By canonical name of a reaction: the sign of its impulses.
    """

    times: list[float] = field(default_factory=list)
    count: int = 0
    since: float = 0.0
    speed: float = 0.0
    flight: float = 0.0
    signs: dict[str, int] = field(default_factory=dict)

    def note(self, t: Sequence[float], approach: Sequence[float]) -> None:
        """Note impacts at the instants `t` with what their law read."""
        flights = np.asarray(approach) * np.diff([self.since, *t])
        self.speed = max(self.speed, *approach)
        self.flight = max(self.flight, float(flights.max()))
        self.times = [*self.times, *t][-SHRINKING - 1 :]
        self.count += len(t)
        self.since = t[-1]

    def restart(self, t: float) -> None:
        """Forget the impacts; what they were like is still what is large for this machine."""
        self.times = []
        self.count = 0
        self.since = t

    def limit(self) -> Limit | None:
        """Return where the impacts end, as far as their instants tell."""
        return limit_of(self.times)

    def fell_silent(self, clock: Clock) -> bool:
        """Whether the impacts follow each other faster than the clock can tell."""
        if len(self.times) <= SHRINKING:
            return False
        return self.times[-1] - self.times[0] <= SHRINKING * clock.tick(self.times[-1])


def chatter(times: Sequence[float], clock: Clock) -> Limit | None:
    """Return the limit that the last events of a machine without pinnacles have reached, or None.

    Parameters
    ----------
    times : sequence of float
        More than `SHRINKING` instants, in order.
    """
    if len(times) <= SHRINKING:
        return None
    last = times[-SHRINKING - 1 :]
    room = clock.moment(last[-1])
    if last[-1] - last[0] <= room:
        return Limit(float(last[-1]), None, 0.0)
    found = limit_of(last)
    return found if found is not None and found.left <= room else None
