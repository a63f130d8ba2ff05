"""Whether a law that bends does more within a step than at any place the step has looked at.

A rectifier's capacitor is charged while a sine is near its peak. Elsewhere an exponential lets
nothing through, no rate tells of the peak, and steps grow until it lies between two stages. What
such laws read is smooth, though: where that is largest or smallest within the step, on the way
between its ends, the rates are asked for. If they are far from the rates of the way there, the step
is too long. So it is of functions that turn in next to no time in sources and laws: what they read
is what ``tables/arguments`` names.

The place is sought closely, as a comparator just below the top of a sine is on for a hundredth of
its turn. Kinks end steps where they are crossed: beyond one nothing is asked.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.radau_factors import solve_real
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

KNOWS: Final = 0.1
"""Error of a step, 1 being what it may be, from which on it is as long as what it has seen lets it
be."""
LONG: Final = 0.25
"""Part of the longest step from which on that holds of no step."""
APART: Final = 0.13
"""Part of the longest step in which samples of what laws read are apart: 0.4 rad of a sine."""
MOST: Final = 16
"""Parts of a step that are looked at, at the most; ..."""
FEWEST: Final = 2
"""... and at the least."""
CLOSER: Final = 3
"""How often the place where something is largest is looked at, each time more closely; ..."""
NEARER: Final = 1.0 / 16.0
"""... each time between places that are this part as far apart."""
NOISE: Final = 1e-10
"""Part of a quantity by which samples bend that are next to even."""
ABOUT: Final = 0.25
"""By so much of how far places are apart that place may be elsewhere at first."""
SHORT: Final = 0.01
"""Part of the longest step that hides no peak."""
FAR: Final = 0.5
"""Part of the rates that a step knows by which others are far from them."""
COUNTS: Final = 10.0
"""How many times its tolerance a state may be off by what is hidden."""
FILTERED: Final = 30.0
"""The same where it is off by as much as a stiff mode leaves of it."""
HIDES: Final = 32.0
"""The error of a step that hides a peak: the next one tried is about half as long."""
SHORTEST: Final = 1e-9
"""Part of the run below which a step is no shorter for that."""


def parts_looked_at(e: Engine, t0: float, h: float, error: float) -> int:
    """Return into how many parts a step is to be cut and looked at; 0: it is not.

    Within one that has hidden something shorter ones are looked at whatever their error: it may be
    that of a stage at the foot of a peak. Friction in the plane is led along by the step itself: a
    look elsewhere would turn its directions.
    """
    m = e.model
    mode = e.mode
    if e.slide.k > 0 or m.disks > 0 or h < SHORTEST * e.span:
        return 0
    timed = m.courses > 0 and (math.isfinite(e.longest) or mode.moves)
    bent = timed and mode.dynamics > 0 and not mode.affine
    if bent and not t0 < e.step.hid_until:
        bent = h > LONG * e.longest if error >= KNOWS else mode.moves or h > SHORT * e.longest
    if not bent and m.arguments == 0:
        return 0
    parts = MOST // 4 if bent else FEWEST
    if math.isfinite(e.longest):
        wanted = min(math.ceil(h / (APART * e.longest)), float(MOST))
        parts = max(int(wanted), FEWEST)
    return parts


def hidden_at_end(e: Engine, t1: float, error: float) -> float:
    """Return the error of an explicit step that is tried, larger if it hides something."""
    s = e.step
    parts = parts_looked_at(e, s.t0, t1 - s.t0, error)
    if parts == 0:
        return error
    copy_part(e.states, s.k, 6 * e.states, s.peak_f1, 0)
    return HIDES if hides(e, e.radau, False, parts, s.t0, s.y0, s.f0, t1, s.y1) else error


def hidden_in_stages(e: Engine, r: Radau, error: float) -> float:
    """Return the error of an implicit step that is tried, larger if it hides something."""
    s = e.step
    parts = parts_looked_at(e, r.t0, r.t1 - r.t0, error)
    if parts == 0:
        return error
    copy_part(e.states, r.f, 2 * e.states, s.peak_f1, 0)
    return HIDES if hides(e, r, True, parts, r.t0, r.y0, r.f0, r.t1, r.y1) else error


def hides(
    e: Engine,
    r: Radau,
    filtered: bool,
    parts: int,
    t0: float,
    y0: Floats,
    f0: Floats,
    t1: float,
    y1: Floats,
) -> bool:
    """Whether rates within a step are far from those of the way between its ends."""
    s = e.step
    h = t1 - t0
    for k in range(e.states):
        if filtered:
            # rates of what is stiff are rounding: the way is that through the stages
            for j in range(3):
                s.peak_way[j * e.states + k] = r.coefficients[j * e.states + k]
        else:
            along = y1[k] - y0[k]
            s.peak_way[k] = h * f0[k]
            s.peak_way[e.states + k] = 3.0 * along - h * (2.0 * f0[k] + s.peak_f1[k])
            s.peak_way[2 * e.states + k] = h * (f0[k] + s.peak_f1[k]) - 2.0 * along
    refusal = e.refusal
    hold_guess(e, e.mode)
    tolerance(e, y0, y1, s.allowed)
    found = False
    many = 0
    for i in range(parts + 1):
        if found or not rates_at(e, float(i) / float(parts), t0, h, y0):
            many = 0
            continue
        if is_beyond_kink(e, i == 0):
            break
        if i > 0 and i < parts:
            found = is_far(e, r, filtered, h, float(i) / float(parts), y0, f0, y1)
        sample_reads(e, many % 3)
        many += 1
        if found or many < 3:
            continue
        apart = 1.0 / float(parts)
        low = 0.0 if i == 2 else (float(i) - 1.5) * apart
        high = 1.0 if i == parts else (float(i) - 0.5) * apart
        found = is_far_at_peaks(e, r, filtered, low, high, i, apart, many, t0, h, y0, f0, y1)
    give_back_guess(e, e.mode)
    e.refusal = refusal
    if found and not t1 <= s.hid_until:
        s.hid_until = t1
    return found


def sample_reads(e: Engine, row: int) -> None:
    """Keep what laws and functions read at the place looked at."""
    m = e.model
    n = 2 * m.bonds
    first = row * (n + m.arguments)
    for k in range(n + m.arguments):
        e.step.peak_read[first + k] = read_of(e, k)


def is_far_at_peaks(
    e: Engine,
    r: Radau,
    filtered: bool,
    low: float,
    high: float,
    at: int,
    apart: float,
    many: int,
    t0: float,
    h: float,
    y0: Floats,
    f0: Floats,
    y1: Floats,
) -> bool:
    """Whether rates are far off where what a bent law reads is largest between two places.

    It is a parabola through the last three samples, of which the last is at part `at`.
    """
    m = e.model
    last = math.nan
    for i in range(e.mode.dynamics):
        d = e.mode.dynamic[i]
        if d < 0 or m.dynamic_affine[d] != 0:
            continue
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            k = m.slope_column[p]
            place = peak_between(e, k, at, apart, many)
            if not is_within(place, low, high, apart, last):
                continue
            last = place
            if is_far_at_top(e, r, filtered, k, place, apart, t0, h, y0, f0, y1):
                return True
    last = math.nan
    for a in range(m.arguments):
        k = 2 * m.bonds + a
        place = peak_between(e, k, at, apart, many)
        if not is_within(place, low, high, apart, last):
            continue
        last = place
        if is_far_at_top(e, r, filtered, k, place, apart, t0, h, y0, f0, y1):
            return True
    return False


def is_within(place: float, low: float, high: float, apart: float, last: float) -> bool:
    """Whether a place is to be looked at: not one just looked at; a parabola may miss the ends."""
    if math.fabs(place - last) < 0.01 * apart:
        return False
    return place > low - ABOUT * apart and place < high + ABOUT * apart


def peak_between(e: Engine, k: int, at: int, apart: float, many: int) -> float:
    """Return where the parabola through the last three samples of something has its peak."""
    read = e.step.peak_read
    row = 2 * e.model.bonds + e.model.arguments
    first = read[((many - 3) % 3) * row + k]
    second = read[((many - 2) % 3) * row + k]
    third = read[((many - 1) % 3) * row + k]
    before = second - first
    after = third - second
    if math.fabs(before - after) <= NOISE * math.fabs(second):
        return math.nan
    return apart * (float(at) - 1.0 + 0.5 * (before + after) / (before - after))


def is_far_at_top(
    e: Engine,
    r: Radau,
    filtered: bool,
    k: int,
    place: float,
    apart: float,
    t0: float,
    h: float,
    y0: Floats,
    f0: Floats,
    y1: Floats,
) -> bool:
    """Whether rates are far off where what is read is largest.

    What a function makes of it may be nothing as close to that as a parabola through three samples
    comes. So it is laid through others closer by, again and again.
    """
    for closer in range(CLOSER):
        place = max(min(place, 1.0), 0.0)
        if not rates_at(e, place, t0, h, y0) or is_beyond_kink(e, False):
            return False
        if is_far(e, r, filtered, h, place, y0, f0, y1):
            return True
        if closer == CLOSER - 1:
            break
        apart *= NEARER
        here = read_of(e, k)
        inside = max(min(place, 1.0 - apart), apart)
        if inside != place:
            place = inside
            if not rates_at(e, place, t0, h, y0):
                return False
            here = read_of(e, k)
        if not rates_at(e, place - apart, t0, h, y0):
            return False
        before = here - read_of(e, k)
        if not rates_at(e, place + apart, t0, h, y0):
            return False
        after = read_of(e, k) - here
        if math.fabs(before - after) <= NOISE * math.fabs(here):
            return False
        place += max(min(0.5 * (before + after) / (before - after), 2.0), -2.0) * apart
    return False


def read_of(e: Engine, k: int) -> float:
    """Return a bond variable, or an argument behind them, at the place looked at."""
    n = 2 * e.model.bonds
    return e.work.w[k] if k < n else value(e.model, e.model.argument_value[k - n], e.v)


def is_beyond_kink(e: Engine, first: bool) -> bool:
    """Whether a kink lies between the place looked at and where the step begins, the `first`."""
    m = e.model
    s = e.step
    beyond = False
    for k in range(m.kinks):
        there = value(m, m.atom_value[m.kink_atom + k], e.v)
        if first or s.kink[k] == 0.0:
            s.kink[k] = there
        beyond = beyond or s.kink[k] * there < 0.0
    return beyond


def rates_at(e: Engine, place: float, t0: float, h: float, y0: Floats) -> bool:
    """Put rates at a part of the step into `peak_rate`; whether they are there."""
    s = e.step
    n = e.states
    for k in range(n):
        bent = s.peak_way[n + k] + place * s.peak_way[2 * n + k]
        s.peak_y[k] = y0[k] + place * (s.peak_way[k] + place * bent)
    if field(e, e.mode, t0 + place * h, s.peak_y, s.peak_rate) != OK:
        return False
    return all_finite(n, s.peak_rate)


def is_far(
    e: Engine,
    r: Radau,
    filtered: bool,
    h: float,
    x: float,
    y0: Floats,
    f0: Floats,
    y1: Floats,
) -> bool:
    """Whether the rates found there are far from those of the way, by what counts."""
    s = e.step
    far = False
    for k in range(e.states):
        way = (y1[k] - y0[k]) / h
        bent = 2.0 * s.peak_way[e.states + k] + 3.0 * x * s.peak_way[2 * e.states + k]
        steep = (s.peak_way[k] + x * bent) / h
        off = s.peak_rate[k] - steep
        s.peak_y[k] = -steep
        most = max(math.fabs(way), max(math.fabs(f0[k]), math.fabs(s.peak_f1[k])))
        far = far or (math.fabs(off) > FAR * most and h * math.fabs(off) > COUNTS * s.allowed[k])
    if not far or not filtered:
        return far
    far = False
    solve_real(r, s.peak_rate, e.rate_rest, s.peak_y)
    for k in range(e.states):
        far = far or math.fabs(s.peak_y[k]) > FILTERED * s.allowed[k]
    return far
