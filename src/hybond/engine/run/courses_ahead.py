"""Steps no longer than what time alone does can be seen in: nothing lies hidden between samples.

What depends on time alone is known before it is met. Of sums and products of sines the fastest one
bounds all steps. Of any other course the range of its rate over an interval ahead says how far it
can go there and come back: nowhere, or not much farther than its ends and its middle show, or else
the interval is halved. So a pulse is approached by halves, and what is flat costs nothing. What
phases of the plant do is looked at in the same way from step to step, by how fast they move.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.expressions.course_parts import OTHER, SINES, find_kinds, range_parts
from hybond.engine.expressions.course_ranges import Ranges, farthest
from hybond.engine.method_numbers import EULER, MOREAU, RK4
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.tolerances.scale import FAINT, measure_ahead
from hybond.engine.mode.mode_records import Mode, Reads
from hybond.engine.model import Model
from hybond.engine.reasons.warned import COURSE_UNSEEN, add_about, begin_warning
from hybond.engine.run.courses_kept import keep_courses
from hybond.engine.run.phases import give_back_plant, hold_plant, put_now, put_signals, see_plant
from hybond.engine.run.run_records import bound_of
from hybond.engine.surfaces.values import set_motion

TURN: Final = 3.0
"""How far the fastest sine may turn in a step, rad."""
FLAT: Final = 1e-9
"""What goes no farther than this part of the largest value so far is flat."""
SHOWN: Final = 12.0
"""How many times the way that samples show a course may go: a parabola goes four times as far."""
MONOTONE: Final = 1.02
"""Likewise its range, where it has no bound on its rate at one end, such as a root."""
NOTHING: Final = 1e-30
"""What a course is before a pulse, as a part of that: not what grows into it."""
MIDDLE: Final = 0.5127
"""Where about the middle is, so that nothing symmetrical is met there by chance."""
NEAR: Final = 1e-13
"""Part of the run in which a phase is no longer foreseen: its own digits end there."""
LITTLE: Final = 0.25
"""Part of what it is that a course may go at the most for places to say whether it is even."""
PLACES: Final = 16
"""Into so many parts these cut the interval."""
EVEN: Final = 0.1
"""Part of the way between them that no two parts of the interval differ by: half a sine's 0.04."""
LAST_DIGITS: Final = 4.0
"""How many times what one last digit of a phase makes of a course no samples tell apart."""
USED: Final = 0.5
"""Part of an interval that was looked at: when no more is left of it, the next one is."""
ALWAYS: Final = 0
OF_SOURCE: Final = 1
OF_SWITCH: Final = 2
UNBOUNDED: Final = 0
PASSED_OVER: Final = 1
LOST: Final = 2
"""Why a course is not seen."""


def begin_courses(e: Engine, read: Reads) -> None:
    """Find which courses count in the mode that begins, and how long their sines let steps be.

    Guards read what `read` says.
    """
    c = e.courses
    if not c.known:
        find_kinds(e.model, c.ranges, c.kind, c.fast)
        c.known = True
    if e.slide.k > 0 or e.mode.longest == 0.0:
        count_courses(e, e.mode, read)
    e.longest = e.mode.longest
    if e.slide.k > 0:
        e.mode.longest = 0.0
    c.end = -math.inf
    c.plant_at = -math.inf
    for k in range(e.model.courses if e.mode.moves else 0):
        measure_peak(e, k)


def count_courses(e: Engine, mode: Mode, read: Reads) -> None:
    """Find which courses count in a mode; all do where modes are combined."""
    m = e.model
    c = e.courses
    mode.longest = math.inf
    mode.fastest = -1
    mode.moves = False
    mode.phased = False
    for k in range(m.courses):
        counts = e.slide.k > 0
        pulse = c.kind[m.course_root[k]] == OTHER
        for p in range(m.course_first[k], m.course_first[k + 1]):
            # energies are of all sources
            counts = counts or (pulse and m.course_user[p] == OF_SOURCE)
            counts = counts or is_used(e, mode, read, m.course_user[p], m.course_index[p])
        root = m.course_root[k]
        phase = m.course_phase[k] != 0
        mode.course[k] = 1 if counts and pulse and not (phase and e.slide.k > 0) else 0
        mode.phased = mode.phased or (phase and mode.course[k] != 0)
        mode.moves = mode.moves or (not phase and mode.course[k] != 0)
        if counts and c.kind[root] == SINES and c.fast[root] > 0.0:
            mode.fastest = k if TURN / c.fast[root] < mode.longest else mode.fastest
            mode.longest = min(mode.longest, TURN / c.fast[root])


def watch_courses(e: Engine, end: float) -> None:
    """Tell of what time does between steps of fixed length that locate nothing.

    All of it counts: branches of laws change from step to step, and let through what they blocked.
    """
    m = e.model
    c = e.courses
    mode = e.mode
    if mode.longest == 0.0:
        if not c.known:
            find_kinds(m, c.ranges, c.kind, c.fast)
            c.known = True
        mode.longest = math.inf
        mode.fastest = -1
        mode.moves = False
        for k in range(m.courses):
            root = m.course_root[k]
            mode.course[k] = 1 if c.kind[root] == OTHER and m.course_phase[k] == 0 else 0
            mode.moves = mode.moves or mode.course[k] != 0
            if c.kind[root] == SINES and c.fast[root] > 0.0:
                mode.fastest = k if TURN / c.fast[root] < mode.longest else mode.fastest
                mode.longest = min(mode.longest, TURN / c.fast[root])
        c.end = -math.inf
    e.longest = mode.longest
    end_ahead(e, end)


def is_used(e: Engine, mode: Mode, read: Reads, user: int, which: int) -> bool:
    """Whether a course counts in a mode for one of its reasons."""
    m = e.model
    if user == ALWAYS:
        return True
    if user == OF_SOURCE:
        for k in range(mode.sources):
            if mode.source[k] == which:
                rates = mode.rates.valued[k] != 0 or mode.rates.rated[k] != 0
                return rates or mode.dynamics > 0 or read.valued[k] != 0 or read.rated[k] != 0
        return False
    if user == OF_SWITCH:
        return mode.on[which] != 0
    machine = 0
    while m.rule_first[machine + 1] <= which:
        machine += 1
    return m.rule_source[which] == mode.state[machine]


def end_ahead(e: Engine, end: float) -> float:
    """Return how far the next step may go, at the most to `end`, to see all that courses do.

    Fixed steps are as long as was said: of those that see too little it is told.
    """
    m = e.model
    c = e.courses
    keep_courses(m, c)
    fixed = m.method == RK4 or m.method == EULER or m.method == MOREAU
    if fixed and m.step > e.longest:
        tell_unseen(e, e.mode.fastest, PASSED_OVER)
    if not (e.mode.moves or e.mode.phased):
        return end
    if e.mode.phased:
        see_plant(e, bound_of(e))
    hold_plant(e)
    if e.mode.phased or (c.end < end and not c.end - e.t > USED * c.length):
        find_shown(e, bound_of(e))
        while c.lost >= 0:
            # what is not foreseen however near bounds no step
            e.mode.course[c.lost] = 0
            tell_unseen(e, c.lost, LOST)
            c.length = 0.0
            find_shown(e, bound_of(e))
        if fixed and c.length < m.step and c.end < end:
            tell_unseen(e, c.hidden, PASSED_OVER)
    give_back_plant(e)
    return end if fixed else min(end, c.end)


def tell_unseen(e: Engine, k: int, why: int) -> None:
    """Warn of a course that is not seen, once."""
    c = e.courses
    if e.model.tells != 0 and k >= 0 and c.told[k] == 0:
        begin_warning(e.warned, COURSE_UNSEEN, e.t)
        add_about(e.warned, float(e.model.course_place[k]))
        add_about(e.warned, float(why))
        c.told[k] = 1


def find_shown(e: Engine, bound: float) -> None:
    """Find an interval from now on in which all courses show what they do, into ``c.end``.

    What is hidden in one instant is no longer than that: only what has no bound there is told of.
    """
    m = e.model
    c = e.courses
    left = bound - e.t
    least = room_of_instant(e, e.t)
    length = min(2.0 * c.length, left) if c.length > 0.0 else left
    put_now(e)
    for k in range(m.courses):
        c.last[k] = 0.0
        c.last_length[k] = 0.0
    c.lost = -1
    hidden = find_hidden(e, e.t, e.t + length)
    while hidden >= 0 and length > least:
        c.hidden = hidden
        length *= 0.5
        hidden = find_hidden(e, e.t, e.t + length)
        if hidden >= 0 and m.course_phase[hidden] != 0 and length <= NEAR * e.span:
            c.lost = hidden
            return
    if hidden >= 0:
        # past it, in longer and longer steps
        c.blind = 2.0 * c.blind if c.blind > 0.0 else 4.0 * least
        length = min(c.blind, left)
        range_parts(m, c.ranges, e.v, e.t, e.t + length)
        root = m.course_root[hidden]
        if not math.isfinite(c.ranges.high[root] - c.ranges.low[root]):
            tell_unseen(e, hidden, UNBOUNDED)
    else:
        c.blind = 0.0
        see_peaks(e)
    c.length = length
    c.end = bound if length >= left else e.t + length


def find_hidden(e: Engine, a: float, b: float) -> int:
    """Return a course that samples do not show in ``[a, b]``, -1 if all of them are."""
    m = e.model
    c = e.courses
    r = c.ranges
    range_parts(m, r, e.v, a, b)
    for k in range(m.courses):
        if e.mode.course[k] == 0 or is_settled(m, r, m.course_whole[k]):
            continue
        root = m.course_root[k]
        size = farthest(r.low[root], r.high[root])
        size = size if math.isfinite(size) else 0.0
        least = max(c.size[m.course_group[k]], c.peak[k])
        way = farthest(r.low_rate[root], r.high_rate[root]) * (b - a)
        if way <= max(FLAT * max(size, least), FAINT):
            continue
        steep = not math.isfinite(way)
        if steep and m.course_phase[k] != 0:
            continue
        shown = spread_of(e, k, a, b, not steep)
        range_ = r.high[root] - r.low[root]
        seen = way <= SHOWN * shown or (steep and range_ <= MONOTONE * shown)
        seen = seen or (m.course_phase[k] != 0 and is_within_digits(e, k, way))
        if not seen and not is_even(e, k, a, b, way, least):
            for i in range(m.courses):
                most = farthest(r.low[m.course_root[i]], r.high[m.course_root[i]])
                if math.isfinite(most) and most > c.last[i]:
                    c.last[i] = most
                    c.last_length[i] = b - a
            return k
    for k in range(m.courses):
        size = farthest(r.low[m.course_root[k]], r.high[m.course_root[k]])
        if e.mode.course[k] != 0 and math.isfinite(size):
            c.size[m.course_group[k]] = max(c.size[m.course_group[k]], size)
    return -1


def is_settled(m: Model, r: Ranges, whole: int) -> bool:
    """Whether a comparison is clear of zero all over an interval: its terms do nothing there."""
    return whole >= 0 and (r.low[whole] > 0.0 or r.high[whole] < 0.0)


def see_peaks(e: Engine) -> None:
    """See which courses are nothing in the interval ahead, and not so in a longer one that hid."""
    m = e.model
    c = e.courses
    for k in range(m.courses):
        root = m.course_root[k]
        here = farthest(c.ranges.low[root], c.ranges.high[root])
        if e.mode.course[k] == 0 or m.course_phase[k] != 0 or not c.last[k] > c.peak[k]:
            continue
        if here > NOTHING * c.last[k]:
            continue
        c.peak[k] = c.last[k]
        c.peak_at[k] = top_of(e, k, e.t, e.t + c.last_length[k])
        measure_peak(e, k)


def top_of(e: Engine, k: int, a: float, b: float) -> float:
    """Return about when a course is largest in ``[a, b]``."""
    r = e.courses.ranges
    root = e.model.course_root[k]
    least = room_of_instant(e, a)
    put_now(e)
    while b - a > least:
        middle = 0.5 * (a + b)
        range_parts(e.model, r, e.v, a, middle)
        first = farthest(r.low[root], r.high[root])
        range_parts(e.model, r, e.v, middle, b)
        second = farthest(r.low[root], r.high[root])
        a = a if first >= second else middle
        b = middle if first >= second else b
    return 0.5 * (a + b)


def measure_peak(e: Engine, k: int) -> None:
    """Let a pulse that is still to come say what is measured before it."""
    if e.slide.k == 0 and e.model.method != MOREAU and e.courses.peak_at[k] > e.t:
        measure_ahead(e, e.mode, e.courses.peak_at[k])
        set_motion(e, e.v, e.t, e.y)


def spread_of(e: Engine, k: int, a: float, b: float, inside: bool) -> float:
    """Return how far apart a course is at the ends of ``[a, b]``, and about its middle as well."""
    m = e.model
    low = math.inf
    high = -math.inf
    for i in range(3 if inside else 2):
        t = a if i == 0 else b if i == 1 else a + MIDDLE * (b - a)
        put_signals(e, a, t)
        here = value(m, m.course_value[k], e.v)
        low = min(low, here)
        high = max(high, here)
    put_now(e)
    return high - low if math.isfinite(high - low) else 0.0


def is_within_digits(e: Engine, k: int, way: float) -> bool:
    """Whether a course goes no farther than the last digits of its phases make it, as it is now.

    An angle that has hardly begun to turn is the same number at both ends of an interval, and a
    crank that stands at its dead centre has an arm that is nothing but the rounding of that angle.
    """
    m = e.model
    here = value(m, m.course_value[k], e.v)
    digits = 0.0
    for i in range(m.course_signals):
        slot = m.signal_slot + m.course_signal[i]
        kept = e.v[slot]
        e.v[slot] = kept + EPSILON * math.fabs(kept)
        digits += math.fabs(value(m, m.course_value[k], e.v) - here)
        e.v[slot] = kept
    return way <= LAST_DIGITS * digits


def is_even(e: Engine, k: int, a: float, b: float, way: float, least: float) -> bool:
    """Whether a course that goes a little way at the most is even at all of some places.

    What cancels, such as the sum of the squares of a sine and a cosine, has a bound on its rate
    that is far from it, however short the interval.
    """
    if not math.isfinite(way):
        return False
    m = e.model
    low = math.inf
    high = -math.inf
    before = 0.0
    change = 0.0
    bend = 0.0
    for i in range(PLACES + 1):
        t = a + (b - a) * float(i) / float(PLACES)
        put_signals(e, a, t)
        here = value(m, m.course_value[k], e.v)
        low = min(low, here)
        high = max(high, here)
        if i > 1:
            bend = max(bend, math.fabs(here - before - change))
        change = here - before
        before = here
    put_now(e)
    size = max(math.fabs(low), math.fabs(high))
    if not (math.isfinite(size) and way <= LITTLE * max(size, least)):
        return False
    return bend <= max(EVEN * (high - low), FLAT * max(size, least))
