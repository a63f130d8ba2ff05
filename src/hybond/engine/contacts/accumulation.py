"""Accumulation (Zeno): impacts that follow each other ever faster, towards a limit in time.

Intervals that shrink by a factor r have the limit ``t_n + gap r / (1 - r)``, and r is the ratio of
the last two of them: Aitken's delta-squared.
"""

import math
from typing import Final

from hybond.engine.contacts.landing_records import LAST_TIMES, Landings
from hybond.engine.expressions.functions import power
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.words import Floats

REMAINING: Final = 1e-7
"""Impacts may end at their limit if what is left to it is below this part of the time."""
CHATTERING: Final = 1e-10
"""The same for events that are not impacts."""
WIDER: Final = 10.0
"""Times that the last intervals may tell of a limit later than all do: they are not just alike."""
SOONEST: Final = 1e-6
"""That part is taken of at least this part of the run."""
POSITION: Final = 1e-16
"""A rebound below this part of the machine's longest flight is none, and never starts."""
TICKS: Final = 64.0
"""A flight of so few units in the last place of the time cannot be told from none."""


def aitken(a: float, b: float, c: float) -> float:
    """Return the limit of a sequence; infinity for one that does not converge.

    Source: A. C. Aitken, Proc. R. Soc. Edinburgh 46, 1926.
    """
    first = b - a
    second = c - b
    if math.fabs(second) >= math.fabs(first):
        return c if second == 0.0 else math.inf
    return c + second * second / (first - second)


def limit_of(g: Landings, times: Floats, machine: int, n: int) -> bool:
    """Put the limit of n instants of a machine into `g`; False if their intervals do not shrink."""
    first = LAST_TIMES * machine
    if n < 3:
        return False
    before = math.inf
    for k in range(1, n):
        gap = times[first + k] - times[first + k - 1]
        if not (gap > 0.0 and gap < before):
            return False
        before = gap
    # three instants far apart, so that their rounding matters least
    stride = (n - 1) // 2
    middle = first + n - 1 - stride
    last = times[first + n - 1]
    end = aitken(times[middle - stride], times[middle], last)
    g.limit_t = end
    g.limit_left = end - last
    # spans, not single intervals: those of the last flights are mostly rounding
    shrunk = (last - times[middle]) / (times[middle] - times[middle - stride])
    g.limit_ratio = power(shrunk, 1.0 / float(stride))
    return True


def since_start(t: float, until: float) -> float:
    """Return what parts of the time are taken of."""
    return max(math.fabs(t), SOONEST * until)


def room_of(t: float, until: float) -> float:
    """Return how far impacts may be from their limit to end there, s."""
    return REMAINING * since_start(t, until)


def tick_of(t: float, until: float) -> float:
    """Return how long a flight must be to be told from none, s."""
    return max(TICKS * spacing(math.fabs(t)), CHATTERING * SOONEST * until)


def push_time(times: Floats, kept: int, machine: int, t: float) -> int:
    """Add an instant to those of a machine, the oldest going; return how many there are."""
    first = LAST_TIMES * machine
    if kept == LAST_TIMES:
        for k in range(1, LAST_TIMES):
            times[first + k - 1] = times[first + k]
        kept -= 1
    times[first + kept] = t
    return kept + 1


def note_impact(g: Landings, machine: int, t: float, approach: float) -> None:
    """Note an impact with what its law read."""
    flight = approach * (t - g.since[machine])
    g.known[machine] = 1
    g.speed[machine] = max(g.speed[machine], approach)
    g.flight[machine] = max(g.flight[machine], flight)
    g.kept[machine] = push_time(g.times, g.kept[machine], machine, t)
    g.count[machine] += 1
    g.since[machine] = t


def restart(g: Landings, machine: int, t: float) -> None:
    """Forget the impacts; what they were like is still what is large for this machine."""
    g.kept[machine] = 0
    g.count[machine] = 0
    g.since[machine] = t


def fell_silent(g: Landings, machine: int, until: float) -> bool:
    """Whether the impacts follow each other faster than the clock can tell."""
    if g.kept[machine] < LAST_TIMES:
        return False
    first = LAST_TIMES * machine
    last = g.times[first + LAST_TIMES - 1]
    return last - g.times[first] <= float(LAST_TIMES - 1) * tick_of(last, until)


def chatters(g: Landings, machine: int, until: float, now: float) -> bool:
    """Whether the events of a machine without impacts have reached a limit, as it is `now`.

    What went on beyond that was the rebounds of another one, which the machine was struck by at the
    same instants, and which is at rest by now.
    """
    if g.other_kept[machine] < LAST_TIMES:
        return False
    first = LAST_TIMES * machine
    last = g.others[first + LAST_TIMES - 1]
    room = CHATTERING * since_start(last, until)
    return crowd_within(g, g.others, machine, LAST_TIMES, room) and now <= g.limit_t + room


def crowd_within(g: Landings, times: Floats, machine: int, n: int, room: float) -> bool:
    """Whether n instants of a machine lie within a time, or what is left to their limit does.

    The limit is put into `g`.
    """
    first = LAST_TIMES * machine
    last = times[first + n - 1]
    if n == LAST_TIMES and last - times[first] <= room:
        g.limit_t = last
        g.limit_ratio = math.nan
        return True
    if not limit_of(g, times, machine, n) or g.limit_left > room:
        return False
    # the same by the last three alone: far apart, the first may be from before it all began
    before = times[first + n - 2]
    return aitken(times[first + n - 3], before, last) - last <= WIDER * room
