"""What is known of what time and phases do: `run/courses_ahead` looks ahead."""

from __future__ import annotations

import math

from hybond.engine.expressions.course_ranges import Ranges, make_ranges
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Courses:
    """What time and phases of the plant do, and how far ahead it is known to show.

    `kind` and `fast` are of its parts, `size` the largest value so far of each sum, `peak` that of
    a pulse, which is nothing before, `peak_at` about when that is, and `told` whether it was said
    that a course is not seen. Up to `end` all is, `length` from where that was found; `blind` is
    the last step into what is not, 0: there was none.
    """

    known: bool
    kind: Ints
    fast: Floats
    ranges: Ranges
    size: Floats
    peak: Floats
    last: Floats
    last_length: Floats
    """The largest value of each in the intervals looked at last that were too long, and how long
    the one with it was."""
    peak_at: Floats
    told: Ints
    plant: Floats
    plant_at: float
    """What the plant had at the last look, and when that was; -infinity: in another mode."""
    held: Floats
    """What the motion has found of it."""
    seen: Floats
    state: Floats
    rate: Floats
    """Room for values, a state and its rate."""
    end: float
    length: float
    blind: float
    lost: int
    """A course of a phase that is not seen however near, -1: there is none."""
    hidden: int
    """The last course that was not seen in an interval."""
    memory: Floats
    """What was known where the last step began, before it was looked ahead from there: see
    `run/courses_kept`."""


def make_courses(m: Model) -> Courses:
    """Return courses of which nothing is known."""
    c = Courses()
    c.kind = ints(m.course_nodes)
    c.fast = floats(m.course_nodes)
    c.ranges = make_ranges(m.course_nodes, m.course_plants)
    c.size = floats(m.courses)
    c.peak = floats(m.courses)
    c.last = floats(m.courses)
    c.last_length = floats(m.courses)
    c.peak_at = floats(m.courses)
    c.told = ints(m.courses)
    c.plant = floats(m.course_plants)
    c.plant_at = -math.inf
    c.held = floats(m.course_plants)
    c.lost = -1
    c.seen = floats(2 * m.slots)
    c.state = floats(m.storages + m.integrals)
    c.rate = floats(m.storages + m.integrals)
    c.end = -math.inf
    c.memory = floats(many_kept(m))
    return c


def many_kept(m: Model) -> int:
    """Return how many numbers courses are remembered by."""
    return 4 * m.courses + 2 * m.course_plants + 4
