"""Rules that time alone decides: when each comes to hold next, which no motion changes."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record

TIME_SLOT: Final = 0
"""Where the time stands among the values that expressions read."""


@record
class Timetable:
    """Of each rule: whether time `alone` decides it, and what is known of it.

    It does not hold from `since` to `until`, which is when it comes to, if it `holds` there. A run
    that goes on from a state finds it anew.
    """

    any_alone: bool
    alone: Ints
    since: Floats
    until: Floats
    holds: Ints


def make_timetable(m: Model) -> Timetable:
    """Return a timetable of which nothing is known."""
    q = Timetable()
    rules = m.rule_first[m.machines]
    q.any_alone = False
    q.alone = ints(rules)
    q.since = floats(rules)
    q.until = floats(rules)
    q.holds = ints(rules)
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            alone = m.is_law[k] == 0 and by_time_alone(m, r)
            q.alone[r] = 1 if alone and m.rule_landed[r] == 0 else 0
            q.any_alone = q.any_alone or q.alone[r] != 0
    forget_timetable(q, rules)
    return q


def forget_timetable(q: Timetable, rules: int) -> None:
    """Let nothing be known of the rules, so many."""
    for r in range(rules):
        q.since[r] = math.inf
        q.until[r] = -math.inf
        q.holds[r] = 0


def by_time_alone(m: Model, pair: int) -> bool:
    """Whether time alone decides what is compared, or nothing does."""
    for p in range(m.read_first[pair], m.read_first[pair + 1]):
        if m.read_slot[p] != TIME_SLOT:
            return False
    return True
