"""Whether a law that bends does more within a step than at any place the step has looked at.

A rectifier's capacitor is charged while a sine is near its peak. Elsewhere an exponential lets
nothing through, no rate tells of the peak, and steps grow until it lies between two stages. What
such laws read is smooth, though: where that is largest or smallest within the step, on the way
between its ends, the rates are asked for. If they are far from the rates of the way there, the step
is too long.

Kinks end steps where they are crossed: beyond one nothing is asked.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.radau_factors import solve_real
from hybond.engine.methods.radau_room import Radau
from hybond.engine.methods.scale import tolerance
from hybond.engine.mode.guess import give_back_guess, hold_guess
from hybond.engine.mode.values import field
from hybond.engine.words import Floats

KNOWS: Final = 0.1
"""Error of a step, 1 being what it may be, from which on it is as long as what it has seen lets it
be."""
LONG: Final = 0.25
"""Part of the longest step from which on that holds of no step."""
APART: Final = 0.13
"""Part of the longest step in which samples of what laws read are apart: 0.4 rad of a sine."""
MOST: Final = 16
"""Parts of a step that are looked at, at the most."""
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


def may_hide(e: Engine, h: float, error: float) -> bool:
    """Whether a step is to be looked at."""
    m = e.model
    mode = e.mode
    if m.courses == 0 or e.slide.k > 0 or mode.dynamics == 0 or mode.affine:
        return False
    if not (math.isfinite(e.longest) or mode.moves) or h < SHORTEST * e.span:
        return False
    if error >= KNOWS:
        return h > LONG * e.longest
    return mode.moves or h > SHORT * e.longest


def hidden_at_end(e: Engine, t1: float, error: float) -> float:
    """Return the error of an explicit step that is tried, larger if it hides something."""
    s = e.step
    if not may_hide(e, t1 - s.t0, error):
        return error
    for k in range(e.states):
        s.peak_f1[k] = s.k[6 * e.states + k]
    return HIDES if hides(e, e.radau, False, s.t0, s.y0, s.f0, t1, s.y1) else error


def hidden_in_stages(e: Engine, r: Radau, error: float) -> float:
    """Return the error of an implicit step that is tried, larger if it hides something."""
    s = e.step
    if not may_hide(e, r.t1 - r.t0, error):
        return error
    for k in range(e.states):
        s.peak_f1[k] = r.f[2 * e.states + k]
    return HIDES if hides(e, r, True, r.t0, r.y0, r.f0, r.t1, r.y1) else error


def hides(
    e: Engine,
    r: Radau,
    filtered: bool,
    t0: float,
    y0: Floats,
    f0: Floats,
    t1: float,
    y1: Floats,
) -> bool:
    """Whether rates within a step are far from those of the way between its ends."""
    s = e.step
    h = t1 - t0
    parts = MOST // 4
    if math.isfinite(e.longest):
        wanted = min(math.ceil(h / (APART * e.longest)), float(MOST))
        parts = max(int(wanted), 2)
    refusal = e.refusal
    hold_guess(e, e.mode)
    tolerance(e, y0, y1, s.allowed)
    n = 2 * e.model.bonds
    found = False
    many = 0
    for i in range(parts + 1):
        if found or not rates_at(e, float(i) / float(parts), t0, h, y0, f0, y1):
            many = 0
            continue
        if is_beyond_kink(e, i == 0):
            break
        if i > 0 and i < parts:
            found = is_far(e, r, filtered, h, float(i) / float(parts), y0, f0, y1)
        for k in range(n):
            s.peak_read[(many % 3) * n + k] = e.work.w[k]
        many += 1
        if found or many < 3:
            continue
        apart = 1.0 / float(parts)
        low = 0.0 if i == 2 else (float(i) - 1.5) * apart
        high = 1.0 if i == parts else (float(i) - 0.5) * apart
        found = is_far_at_peaks(e, r, filtered, low, high, i, apart, many, t0, h, y0, f0, y1)
    give_back_guess(e, e.mode)
    e.refusal = refusal
    return found


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
    s = e.step
    n = 2 * m.bonds
    first = ((many - 3) % 3) * n
    second = ((many - 2) % 3) * n
    third = ((many - 1) % 3) * n
    last = math.inf
    for i in range(e.mode.dynamics):
        d = e.mode.dynamic[i]
        if d < 0 or m.dynamic_affine[d] != 0:
            continue
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            k = m.slope_column[p]
            before = s.peak_read[second + k] - s.peak_read[first + k]
            after = s.peak_read[third + k] - s.peak_read[second + k]
            if before == after:
                continue
            place = apart * (float(at) - 1.0 + 0.5 * (before + after) / (before - after))
            if not (place > low and place < high) or math.fabs(place - last) < 0.01 * apart:
                continue
            last = place
            if not rates_at(e, place, t0, h, y0, f0, y1) or is_beyond_kink(e, False):
                continue
            if is_far(e, r, filtered, h, place, y0, f0, y1):
                return True
    return False


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


def rates_at(
    e: Engine, place: float, t0: float, h: float, y0: Floats, f0: Floats, y1: Floats
) -> bool:
    """Put rates at a part of the step into `peak_rate`; whether they are there."""
    s = e.step
    for k in range(e.states):
        s.peak_y[k] = way_at(place, h, y0[k], f0[k], y1[k], s.peak_f1[k])
    if field(e, e.mode, t0 + place * h, s.peak_y, s.peak_rate) != OK:
        return False
    return all_finite(e.states, s.peak_rate)


def way_at(x: float, h: float, y0: float, f0: float, y1: float, f1: float) -> float:
    """Return the cubic between the ends of a step, with the rates there."""
    z = 1.0 - x
    return y0 + x * x * (3.0 - 2.0 * x) * (y1 - y0) + x * z * h * (z * f0 - x * f1)


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
        steep = 6.0 * x * (1.0 - x) * way
        steep += (1.0 - x) * (1.0 - 3.0 * x) * f0[k] + x * (3.0 * x - 2.0) * s.peak_f1[k]
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
