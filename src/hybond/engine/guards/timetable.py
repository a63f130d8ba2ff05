"""When rules that time alone decides come to hold next: looked for once, and kept.

What a clock compares is the same whatever the motion does. Where a hundred carriers switch as many
legs an event of one of them is none of the others: each is looked for alone, from where it is asked
first to the end of the step that it is asked in, which may be far beyond the next event.
"""

from __future__ import annotations

import math

from hybond.engine.engine import OK, Engine
from hybond.engine.guards.in_blocks import look_in_blocks
from hybond.engine.guards.locator import ALL_PARTS, Locator
from hybond.engine.guards.waiting import may_wait


def foresee(e: Engine, g: Locator) -> bool:
    """Take what is known of guards that time alone decides; whether others are left.

    The first instant at which one of them holds is in `g.at` then, if it is before that.
    """
    left = False
    for k in range(g.guards):
        if g.solved[k] != 0:
            continue
        if not is_of_clock(e, g, k) or not is_known_ahead(e, g, k):
            left = True
            continue
        g.foreseen[k] = 1
        r = g.rule[k]
        at = e.timetable.until[r]
        if e.timetable.holds[r] != 0 and at <= e.step.t1 and at < g.at:
            g.at = at
            g.about = False
    return left


def is_of_clock(e: Engine, g: Locator, k: int) -> bool:
    """Whether time alone decides guard k, here as well: it neither waits nor is kept at rest."""
    r = g.rule[k]
    if r < 0 or g.part[k] != ALL_PARTS or e.slide.k > 0 or e.timetable.alone[r] == 0:
        return False
    return e.rests.rule[r] == 0 and not may_wait(e, r, e.step.t1)


def is_known_ahead(e: Engine, g: Locator, k: int) -> bool:
    """Whether it is known when guard k holds next, or can be found."""
    q = e.timetable
    r = g.rule[k]
    ahead = q.since[r] <= e.step.t0 and e.step.t0 < q.until[r]
    if ahead and (q.holds[r] != 0 or e.step.t1 <= q.until[r]):
        return True
    return find_next(e, g, k)


def find_next(e: Engine, g: Locator, k: int) -> bool:
    """Look in all of the step for guard k alone; False if that has no value somewhere."""
    q = e.timetable
    r = g.rule[k]
    at = g.at
    about = g.about
    rough = g.rough
    g.at = math.inf
    g.rough = False
    g.asked_from = k
    g.asked_until = k + 1
    found = look_in_blocks(e, g) == OK
    if found:
        q.since[r] = e.step.t0
        q.until[r] = min(g.at, e.step.t1)
        q.holds[r] = 1 if g.at <= e.step.t1 else 0
    g.at = at
    g.about = about
    g.rough = rough
    # what has no value somewhere is asked again with the others, where that is told
    g.failed = False
    return found
