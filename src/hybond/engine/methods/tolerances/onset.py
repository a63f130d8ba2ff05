"""What a state that has never moved will be a moment later: the size that it has until then.

What grows from nothing as a power of time is, after any step, as far from what the step makes of it
as it is large: a part of that is no tolerance, and a shorter step is in the same case. So it is
where a mass begins to move behind springs with play, at the edge of which there is no stiffness yet
that energy could measure by; and there the force itself, a difference, begins as rounding. What a
state will have become after a short part of the run has no such trouble, whatever the power is: an
error that is small beside that shifts the beginning by a part of that time.

The moment is passed in three ways, with steps more and more. Where they disagree something is
faster than they are, and a shorter moment is tried.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.tolerances.scale import SHORT, tolerance, within_bent
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

WAYS: Final = 3
FEWEST: Final = 4
"""Steps of the first way, of Runge and Kutta's; each of the others has twice those of the last."""
AGREE: Final = 1e3
"""How many times as large as by one way a state may be by another."""
TRIES: Final = 4
CHAIN: Final = 2
"""States at the least, of which one moves another: filters in a row are signals."""
AT_ONCE: Final = 1e-6
"""Part of the moment in which what begins to move does so."""
DISTINCT: Final = 0.6180339887498949
"""The golden section, whose multiples are as far from each other as can be."""
SHORTER: Final = 1.0 / 16.0
"""What a moment is to the last one, in which something was too fast."""


def foresee_onset(e: Engine, mode: Mode, t: float, y: Floats, f: Floats) -> bool:
    """Learn what states that have not moved until `t` will be soon; whether there is anything.

    `f` are the rates there. What was learned holds until then. What is one state alone
    stands behind time at the most, and what leaves an edge has its own measure.
    """
    s = e.step
    if s.on_edge or t < s.onset_end:
        return False
    soon = SHORT * e.span
    if e.next_break < math.inf:
        soon = min(soon, 0.5 * (e.next_break - t))
    s.onset_end = t + soon
    refusal = e.refusal
    hold_guess(e, mode)
    if not some_young(e, mode, t, y, f, soon):
        give_back_guess(e, mode)
        e.refusal = refusal
        return False
    s.onset_end = -math.inf
    tolerance(e, y, y, s.began_at)
    s.onset_end = t + soon
    for k in range(e.states):
        least = 0.0
        if k < e.model.storages and s.onset[k] == 0.0:
            # behind a law that is flat there energy says nothing of how far it may have moved
            least = within_bent(e, k, y, s.began_at[k] / e.model.rtol)
            # no two alike: nothing is between what moves alike
            least *= 0.5 + 0.5 * math.fmod(DISTINCT * float(k + 1), 1.0)
        s.began_at[k] = y[k] + math.copysign(least, f[k])
    found = stirs(e, mode, t, y, f, soon)
    if not found:
        s.onset_end = -math.inf  # what begins within the moment is asked again once it has
    for _ in range(TRIES if found else 0):
        if t + soon <= t:
            break
        found = pass_moment(e, mode, t, soon)
        if found:
            break
        soon *= SHORTER
    give_back_guess(e, mode)
    e.refusal = refusal
    for k in range(e.states):
        s.onset[k] = s.onset[k] if found else 0.0
    return found


def some_young(e: Engine, mode: Mode, t: float, y: Floats, f: Floats, soon: float) -> bool:
    """Note which states have not moved, in ``e.step.onset``; whether one stands behind others.

    Where there are too few storages for that, a signal that has a rate, or has one by time alone,
    begins with that and is measured by itself.
    A storage that time alone soon moves much faster has hardly begun: it stands behind a power of
    time, of which a late time has no digits yet.
    """
    m = e.model
    s = e.step
    few = m.storages < CHAIN
    young = False
    behind = 0
    hardly = False
    for k in range(e.states):
        s.onset[k] = -1.0
        old = max(e.largest_state[k], math.fabs(y[k])) > soon * math.fabs(f[k])
        if not old and (not few or k < m.storages or f[k] == 0.0):
            s.onset[k] = 0.0
            young = True
            behind += 1 if k >= m.storages else 0
    for way in range(2 if young and few else 0):
        at = t + (soon if way == 0 else AT_ONCE * soon)
        known = field(e, mode, at, y, s.rate) == OK
        for k in range(m.storages if way == 0 and known else 0):
            late = s.onset[k] == 0.0 and math.fabs(s.rate[k]) > AGREE * math.fabs(f[k])
            hardly = hardly or late
        for k in range(m.storages, e.states):
            if s.onset[k] == 0.0 and not (known and s.rate[k] == 0.0):
                s.onset[k] = -1.0
                behind -= 1
    return young and (not few or behind > 0 or hardly)


def pass_moment(e: Engine, mode: Mode, t: float, soon: float) -> bool:
    """Find what young states will be, by all ways; False where these disagree."""
    s = e.step
    n = e.states
    steps = FEWEST
    for way in range(WAYS):
        copy_floats(n, s.began_at, s.passed)
        h = soon / float(steps)
        for i in range(steps):
            if not pass_part(e, mode, t + float(i) * h, h):
                return False
        for k in range(n):
            now = math.fabs(s.passed[k])
            before = s.passed_before[k]
            if way > 0 and now > 0.0 and before > 0.0:
                if now > AGREE * before or before > AGREE * now:
                    return False
            s.passed_before[k] = now
        steps *= 2
    some = False
    for k in range(e.states):
        if s.onset[k] >= 0.0:
            s.onset[k] = s.passed_before[k]
            some = some or s.onset[k] > 0.0
    return some


def stirs(e: Engine, mode: Mode, t: float, y: Floats, f: Floats, soon: float) -> bool:
    """Whether anything moves, or does at once.

    Where nothing does, something jumps at a time of its own, and is not to be stepped over.
    """
    for k in range(e.states):
        if f[k] != 0.0:
            return True
    if field(e, mode, t + AT_ONCE * soon, y, e.step.rate) != OK:
        return False
    for k in range(e.states):
        if e.step.rate[k] != 0.0:
            return True
    return False


def pass_part(e: Engine, mode: Mode, t: float, h: float) -> bool:
    """Move ``e.step.passed`` on by the classical method of Runge and Kutta; False without rates."""
    s = e.step
    n = e.states
    for k in range(n):
        s.passed_next[k] = s.passed[k]
        s.trial[k] = s.passed[k]
    for stage in range(4):
        at = t if stage == 0 else t + h if stage == 3 else t + 0.5 * h
        if field(e, mode, at, s.trial, s.rate) != OK or not all_finite(n, s.rate):
            return False
        part = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
        ahead = h if stage == 2 else 0.5 * h
        for k in range(n):
            s.passed_next[k] += part * s.rate[k]
            s.trial[k] = s.passed[k] + ahead * s.rate[k]
    copy_floats(n, s.passed_next, s.passed)
    return all_finite(n, s.passed)
