"""What is said of events without end: whose they are, and whether they come ever faster.

A comparator that a signal passes only after two lags, or two integrators, has no classical sliding:
what it switches does not act on the slope of what it reads. With damping such a loop oscillates
with an amplitude that shrinks for ever, and the intervals with it: n events after the beginning
they are as 1/n, so that the events come as ``exp(t)``, and no step gets past them.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.chronicle import Chronicle
from hybond.engine.outcome.refusals import Said
from hybond.runs.trace import Event, Fired

SEEN: Final = 16
"""Events at the end that are looked at, and as many half as late."""
SHRUNK: Final = 0.75
"""Part of the mean interval then that the last are at the most: as 1/n they are a half."""
BAND = (
    "a comparator that is felt by what it reads only through two lags or more never comes to rest: "
    "give it a band, y > 0.01 and y < -0.01 (VH of a switch of a netlist), or run with sliding = "
    "'hysteresis' and half its width, hysteresis = 0.01, or sample what it reads; or raise "
    "max_events above 1,000,000"
)


def said_of_many(events: Chronicle[Event], why: str, where: str, until: float) -> Said:
    """Return what is said of too many events, with their machine if all the last are of one.

    How many more it would take until the end is said where they come at one pace.
    """
    many = len(events)
    if many < 4 * SEEN:
        return Said(why, where)
    last = _mean(events, many - SEEN)
    if not last > 0.0:
        return Said(why, where)
    machines = {f.machine for k in range(many - SEEN, many) for f in _fired(events[k])}
    if len(machines) != 1:
        return Said(why, where)
    (machine,) = machines
    if last <= SHRUNK * _mean(events, many // 2 - SEEN // 2):
        return Said(
            f"{why}: {machine} switches ever faster, {last:.3g} s apart at last", where, BAND
        )
    told = f"{why}: {machine} switches every {last:.3g} s at last"
    more = (until - events[-1].t) / last
    if 1.0 <= more < math.inf:
        told += f", and would {more:.3g} times more until t = {until:.9g} s"
    return Said(told, where)


def _fired(event: Event) -> list[Fired]:
    return [f for visit in event.steps for f in visit.fired]


def _mean(events: Chronicle[Event], first: int) -> float:
    """Return the mean interval of `SEEN` events from the first on."""
    return (events[first + SEEN - 1].t - events[first].t) / (SEEN - 1)
