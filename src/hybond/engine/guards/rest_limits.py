"""Where a motion comes to rest, by the slopes of its rates.

A linear motion from rates ``r`` adds up to ``S r``, with S the integral of the exponential of the
slopes. Both are found for a time that is short, and for twice the time from that, again and again,
until nothing changes any more. So what is conserved stays, and a ramp has no end: rates that this
leaves as they are go on.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, times_matrix
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import atom_here, look_at_state
from hybond.engine.guards.locator import Locator
from hybond.engine.guards.rest_records import Rests
from hybond.engine.surfaces.values import field

UNSOLVED: Final = 1e-2
"""Part of the rates that slopes may leave to go on for good where all is rounding, ..."""
ROUNDED: Final = 1e-6
"""... or of what can be told, in the time of the fastest motion."""
STEPS: Final = 3
"""Of a method for bent laws; ..."""
FAR: Final = 1e6
"""... times what can be told that it goes at the most."""
PART: Final = 0.25
"""Of the time of the fastest motion: for so long its exponential is a few terms of a series."""
STILL: Final = 0.5
"""Part of a slow motion that is left when it has moved what can be told: it then rests near by."""
TERMS: Final = 8
DOUBLINGS: Final = 40
SETTLED: Final = 1e-6
"""Part of a state that is left when all has settled: more than what differences are off by."""


def put_slopes(q: Rests, n: int, many: int) -> float:
    """Put the slopes there in units of what can be told; return the rate of the fastest motion."""
    fast = 0.0
    for i in range(many):
        total = 0.0
        for j in range(many):
            slope = q.jacobian[q.place[i] * n + q.place[j]] * q.tell[q.place[j]]
            q.matrix[i * many + j] = slope / q.tell[q.place[i]]
            total += math.fabs(q.matrix[i * many + j])
        fast = max(fast, total)
    return fast


def begin_flow_of(q: Rests, many: int, h: float) -> None:
    """Put what a linear motion leaves of a state after `h` there, by the first terms of a series.

    What rates add up to by then is `inverse`.
    """
    for i in range(many * many):
        q.power[i] = h * q.matrix[i]
        q.flow[i] = 0.0
    for term in range(TERMS):
        # ... (1 + hM/4 (1 + hM/5 (...))), once with the last factor and once without
        for i in range(many):
            q.flow[i * many + i] += 1.0
        if term < TERMS - 1:
            for i in range(many * many):
                q.flow[i] /= float(TERMS - term)
            times_matrix(many, many, many, q.power, q.flow, q.twice)
            copy_floats(many * many, q.twice, q.flow)
    for i in range(many * many):
        q.inverse[i] = h * q.flow[i]
    times_matrix(many, many, many, q.power, q.flow, q.twice)
    copy_floats(many * many, q.twice, q.flow)
    for i in range(many):
        q.flow[i * many + i] += 1.0


def find_felt(e: Engine, g: Locator, a: int, size: float) -> None:
    """Put the states there that atom a of a guard is moved by if they move by their own size.

    For one that has no slope where it is zero, as a cube has none where it crosses.
    """
    q = e.rests
    level = q.level[a - g.atom_first[g.atom_guard[a]]]
    copy_floats(e.states, q.y, q.shifted)
    for j in range(e.states):
        own = max(math.fabs(q.y[j]), math.fabs(q.began[j]))
        own = max(own, e.largest_state[j])
        for way in range(2):
            q.shifted[j] = q.y[j] + (own if way == 0 else -own)
            look_at_state(e, g, g.at, q.shifted)
            there = atom_here(e, g, a)
            if not math.fabs(there - level) <= ROUNDING * size:
                q.inside[j] = 1
        q.shifted[j] = q.y[j]


def find_limit(e: Engine, many: int) -> bool:
    """Find what rates add up to for good, and what is left of a state then: what is conserved.

    Of a motion over twice the time: what the first half adds up to, and that led on by the second.
    False if it does not come to rest.
    """
    q = e.rests
    n = many * many
    q.fast = put_slopes(q, e.states, many)
    if many == 0:
        return True
    if not (q.fast > 0.0 and q.fast < math.inf):
        return False
    begin_flow_of(q, many, PART / q.fast)
    for _ in range(DOUBLINGS):
        times_matrix(many, many, many, q.flow, q.inverse, q.twice)
        for i in range(n):
            q.inverse[i] += q.twice[i]
        times_matrix(many, many, many, q.flow, q.flow, q.twice)
        change = 0.0
        most = 0.0
        for i in range(n):
            change = max(change, math.fabs(q.twice[i] - q.flow[i]))
            most = max(most, math.fabs(q.twice[i]))
        copy_floats(n, q.twice, q.flow)
        if not all_finite(n, q.flow):
            return False
        if change <= SETTLED * most or most <= SETTLED:
            return all_finite(n, q.inverse)
    return False


def lead_to_rest(e: Engine, many: int, t: float) -> bool:
    """Put the state into `shifted` that the slopes lead to, and how far that is into `other`.

    As often as it takes where laws are bent; False if there is no such place.
    """
    q = e.rests
    copy_floats(e.states, q.y, q.shifted)
    for i in range(many):
        q.other[i] = 0.0
    far = math.inf
    for _ in range(STEPS if many > 0 else 0):
        if field(e, e.mode, t, q.shifted, q.rate) != OK or not all_finite(e.states, q.rate):
            return False
        if not is_explained(q, many):
            return False
        most = 0.0
        for i in range(many):
            q.left[i] = 0.0
            for j in range(many):
                rate = q.rate[q.place[j]] / q.tell[q.place[j]]
                q.left[i] += q.inverse[i * many + j] * rate
            most = max(most, math.fabs(q.left[i]))
        if not most <= min(far, FAR):
            return far <= 1.0
        for i in range(many):
            q.other[i] += q.left[i]
            q.shifted[q.place[i]] += q.left[i] * q.tell[q.place[i]]
        far = most
    return True


def is_explained(q: Rests, many: int) -> bool:
    """Whether rates move nothing of what slopes leave as it is: there is a place to rest at."""
    most = 0.0
    left = 0.0
    for i in range(many):
        rest = 0.0
        for j in range(many):
            rate = q.rate[q.place[j]] / q.tell[q.place[j]]
            rest += q.flow[i * many + j] * rate
            most = max(most, math.fabs(rate))
        left = max(left, math.fabs(rest))
    return left <= UNSOLVED * most + ROUNDED * q.fast


def stays_near(e: Engine, a: int, many: int) -> bool:
    """Whether a comparison cannot be told from its limit on all the way there.

    What swings about it has times at which it crosses clearly. The motion is looked at after times
    that are twice as long each.
    """
    q = e.rests
    n = e.states
    if many == 0:
        return True
    near = True
    copy_floats(many * many, q.inverse, q.kept_inverse)
    copy_floats(many * many, q.flow, q.kept_flow)
    begin_flow_of(q, many, PART / q.fast)
    for _ in range(DOUBLINGS):
        moved = 0.0
        most = 0.0
        for i in range(many):
            left = 0.0
            for j in range(many):
                left += q.flow[i * many + j] * q.other[j]
            moved += q.slope[a * n + q.place[i]] * q.tell[q.place[i]] * left
            most = max(most, math.fabs(left))
        near = near and math.fabs(moved) <= q.near[a]
        if most <= SETTLED or not near:
            break
        times_matrix(many, many, many, q.flow, q.flow, q.twice)
        copy_floats(many * many, q.twice, q.flow)
    copy_floats(many * many, q.kept_inverse, q.inverse)
    copy_floats(many * many, q.kept_flow, q.flow)
    return near


def moves_on(e: Engine, many: int, t: float, end: float) -> bool:
    """Whether what slopes leave as it is goes on from `shifted` until it can be told from that.

    Beside a motion that is by far faster a slow one looks as if nothing moved it. If it is as fast
    where it has moved what can be told, it does not rest.
    """
    q = e.rests
    n = e.states
    if many == 0 or field(e, e.mode, t, q.shifted, q.rate) != OK:
        return False
    most = 0.0
    for i in range(many):
        q.left[i] = 0.0
        dust = 0.0
        for j in range(many):
            q.left[i] += q.flow[i * many + j] * q.rate[q.place[j]] / q.tell[q.place[j]]
            own = 0.0
            for k in range(many):
                size = size_in_tells(e, q.place[k])
                own += math.fabs(q.matrix[j * many + k]) * size
            dust += math.fabs(q.flow[i * many + j]) * own
        if math.fabs(q.left[i]) <= ROUNDING * dust:
            q.left[i] = 0.0
        most = max(most, math.fabs(q.left[i]))
    if not most * (end - t) > 1.0:
        return False
    copy_floats(n, q.shifted, q.beyond)
    for i in range(many):
        q.beyond[q.place[i]] += q.left[i] / most * q.tell[q.place[i]]
    if field(e, e.mode, t, q.beyond, q.rate) != OK or not all_finite(n, q.rate):
        return False
    for i in range(many):
        there = 0.0
        for j in range(many):
            there += q.flow[i * many + j] * q.rate[q.place[j]] / q.tell[q.place[j]]
        if math.fabs(q.left[i]) == most and there / q.left[i] > STILL:
            return True
    return False


def size_in_tells(e: Engine, j: int) -> float:
    """Return the size of a state in units of what can be told of it."""
    q = e.rests
    return max(math.fabs(q.y[j]), e.largest_state[j]) / q.tell[j]
