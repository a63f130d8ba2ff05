"""Events that come ever faster, and would be far too many long before the end of the run.

A comparator that is felt by what it reads only through two lags has the rate of its events grow as
``exp(t)``: by the same amount over each thousand of them. How many there would be up to the end
follows from that. A run that would have more than a thousand times its limit is not asked to try:
not where anything hangs on the time, which may end the growth. Nor is one in which thousands follow
each other within an instant each: what is put back onto its threshold passes it at once again.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine, say_fault
from hybond.engine.expressions.functions import exp_less_one
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.reasons.facts import add_fact
from hybond.engine.run.run_records import PACES_KEPT, Run

PACED: Final = 1024
"""Events of which the time is taken together."""
USUAL: Final = 1000000
"""A limit above this one was asked for: it is reached."""
MOST_FORESEEN: Final = 1e300
OUTRUN: Final = 1e3
"""Times the limit that would be reached."""
GROWN: Final = 1.5
"""By how much the rate of events has grown over all that are looked at, at least."""
STEADY: Final = 0.8
"""Part of its earlier growth by event that it has of late, at least: else it comes to a limit."""


def outruns(e: Engine, r: Run) -> bool:
    """Whether events would be too many long before the end, at the rate at which they grow."""
    if r.events % PACED != 0:
        return False
    if r.paced > PACES_KEPT:
        for k in range(PACES_KEPT):
            r.pace_at[k] = r.pace_at[k + 1]
        r.paced = PACES_KEPT
    r.pace_at[r.paced] = e.t
    r.paced += 1
    if r.paced <= PACES_KEPT or e.model.max_events > USUAL or tells_time(e):
        return False
    before = math.inf
    faster = True
    instants = True
    for k in range(PACES_KEPT):
        span = r.pace_at[k + 1] - r.pace_at[k]
        if not span > 0.0:
            return False
        faster = faster and span < before
        before = span
        instants = instants and span <= float(PACED) * room_of_instant(e, e.t)
    if instants:
        r.foreseen = min(rate_in(r, PACES_KEPT - 1) * (e.until - e.t), MOST_FORESEEN)
        return True
    if not faster:
        return False
    first = rate_in(r, 0)
    middle = rate_in(r, PACES_KEPT // 2)
    last = rate_in(r, PACES_KEPT - 1)
    early = (middle - first) / float(PACES_KEPT // 2)
    late = (last - middle) / float(PACES_KEPT - 1 - PACES_KEPT // 2)
    if last < GROWN * first or late < STEADY * early:
        return False
    # by event: the rate grows with time as the exponential of that
    growth = late / float(PACED)
    more = last / growth * exp_less_one(growth * (e.until - e.t))
    r.foreseen = min(more, MOST_FORESEEN)
    return more > OUTRUN * float(e.model.max_events)


def tells_time(e: Engine) -> bool:
    """Whether a source or a law goes on by the time: a sweep grows as long as it is told to."""
    m = e.model
    told = m.courses > 0 or m.timed_jumps > 0
    for k in range(m.generators):
        told = told or m.generator_moving[k] != 0
    return told


def rate_in(r: Run, k: int) -> float:
    """Return how many events there were in a second, of those taken together."""
    return float(PACED) / (r.pace_at[k + 1] - r.pace_at[k])


def refuse_outrun(e: Engine, r: Run) -> int:
    """Refuse to go on to as many events."""
    refused = say_fault(e, "HB-N404", "ever more events", "")
    if e.model.tells != 0:
        add_fact(e.fault, float(r.events))
        add_fact(e.fault, r.foreseen)
    return refused
