"""The Jacobian of a step of Radau IIA by differences, and tolerances of states that laws hold.

A coil behind a diode that blocks has next to no current, but what is across the diode hangs on how
much: the exponential turned round is a logarithm, and beside its end that has a slope of its own
within a part of the way there. Differences begin so near, and tolerances are no more than the law
can tell apart.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.algebra.twofold import sum_rest
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.methods.implicit.beside_kinks import (
    come_back,
    go_behind,
    is_beyond,
    see_sides,
    stay_on_side,
)
from hybond.engine.methods.implicit.columns_together import put_slope, take_together
from hybond.engine.methods.implicit.near_roots import shorten_near_roots
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import FRESH_MATRIX, rate_at
from hybond.engine.methods.linear.graded import fast_from
from hybond.engine.methods.tolerances.scale import (
    FAINT,
    ROUNDED,
    SHORT,
    know_settling,
    sum_closely_on,
    tolerance,
    within_bent,
)
from hybond.engine.words import Floats

GROWN: Final = 10.0
"""How much larger a state may be than when the Jacobian was made."""
NEARER: Final = 6
"""How often a difference is tried for the Jacobian where laws have edges."""
RADAU_NEAR: Final = 1.0 / 16.0
"""By how much it is then smaller each time."""
NEAREST: Final = 64.0 * EPSILON
"""The least part of a state that it is shifted by where its law may be steep, ..."""
FIRST_PART: Final = 2.0**-40
"""... or of how far it is shifted else, from zero; ..."""
NEAREST_GROWS: Final = 64.0
"""... how much farther it is shifted next, ..."""
CLEARLY: Final = 1e-7
"""... and the part of rates by which they are to differ."""
NOTHING: Final = 10.0 * FAINT
"""A state that is no larger than that, in SI, is nothing yet; ..."""
LAST_PLACES: Final = 4.0 * EPSILON
"""... then rates that differ by no more than this part of themselves do not hang on it."""
DIGITS_LEFT: Final = 1e4 * EPSILON
"""Part of a state that its tolerance is at least where a law that holds it asks for less."""


def differences(e: Engine, r: Radau, rtol: float, across: bool) -> None:
    """Make the Jacobian where the step starts; with closer rates if slow motions ask for them.

    Where states exchange what they store so fast that rounding of it moves their sum, rates of the
    mode are from now on summed with all digits. `across` kinks that a step goes through, slopes may
    be those of beyond.
    """
    r.twofold_from = math.inf
    if e.mode.closely and e.slide.k == 0:
        begin_closely(e, r)
    make_slopes(e, r, rtol, across)
    if e.slide.k > 0:
        return
    fastest = exchange_rate(e, r)
    if not e.mode.closely and fastest > fast_from(rtol, e.span):
        sum_closely_on(e, e.mode)
        if begin_closely(e, r):
            make_slopes(e, r, rtol, across)
    if e.mode.closely and fastest > 0.0:
        r.twofold_from = fast_from(rtol, fastest)


def begin_closely(e: Engine, r: Radau) -> bool:
    """Find rates with twice the digits where the step begins; False where there are none."""
    refusal = e.refusal
    found = rate_at(e, r.n, r.t0, r.y0, r.end) == OK
    for i in range(r.n):
        r.f0_rest[i] = 0.0
        if found:
            r.f0[i] = r.end[i]
            r.f0_rest[i] = e.rate_rest[i]
    e.refusal = refusal
    r.f0_closely = True
    return found


def exchange_rate(e: Engine, r: Radau) -> float:
    """Return the rate of the two states that act on each other fastest."""
    most = 0.0
    for i in range(e.model.storages):
        for j in range(i):
            one = math.fabs(r.jacobian[i * r.n + j])
            other = math.fabs(r.jacobian[j * r.n + i])
            most = max(most, math.sqrt(one) * math.sqrt(other))
    return most


def make_slopes(e: Engine, r: Radau, rtol: float, across: bool) -> None:
    """Make the Jacobian by forward differences where the step starts, in the direction of motion.

    A state at the edge of where its law is defined is more likely to have come from there than to
    go there. Between two edges that are near, differences are as small as the room is; on both at
    once there are none, and no slope: steps are then those of an iteration without it. So are
    those from rest where laws say nothing of what is beside it, as where friction holds a body.
    A signal that no rate reads has no slopes: what rates differ by is their rounding then, and over
    a difference that is next to nothing, as where it has not begun, that is beyond all bounds. What
    was tried here alone is no step's matter: it refuses none.
    """
    n = r.n
    refusal = e.refusal
    tolerance(e, r.y0, r.y0, r.other)
    r.sided = False
    closely = e.mode.closely and e.slide.k == 0
    fit(r.jacobian_rest, n * n if closely else 1)
    one_side = not across and see_sides(e, r)
    behind = one_side and go_behind(e, r, rtol)
    for i in range(n):
        r.shifted[i] = r.y0[i]
    for j in range(n):
        r.delta[j] = way_of_shift(e, r, j, rtol)
    shorten_near_roots(e, r)
    for j in range(n):
        r.together[j] = 0
    if e.model.bends == 0.0:
        take_together(e, r, r.t0, r.y0, 0, r.f0, closely, one_side)
    for j in range(n):
        if r.together[j] == 0:
            take_alone(e, r, j, one_side, closely)
    for j in range(n):
        if r.delta[j] != 0.0 and r.made_for[j] <= NOTHING and not closely:
            leave_out_rounding(r, j)
    if behind:
        come_back(r)
    know_settling(e, r.jacobian)
    e.refusal = refusal
    r.matrix = FRESH_MATRIX
    r.served = 0.0
    r.made += 1


def way_of_shift(e: Engine, r: Radau, j: int, rtol: float) -> float:
    """Return what a state is shifted by, in the direction of its motion; 0: no rate reads it."""
    size = max(math.fabs(r.y0[j]), r.other[j] / rtol)
    if size == 0.0 and j < e.model.storages:
        # at rest: as far as rates move it in a moment; a unit may be far beyond what laws see
        size = e.rounding[j] / ROUNDED
    if j >= e.model.storages:
        # as large as it is in a moment: what has just begun is next to nothing beside that
        size = max(size, SHORT * e.span * math.fabs(r.f0[j]))
    if j < e.model.storages:
        size = within_bent(e, j, r.y0, size)
    r.made_for[j] = size
    if only_shown(e, j):
        return 0.0
    if size == 0.0:
        size = 1.0
    way = r.nearer * math.sqrt(EPSILON) * size
    if j < e.model.storages:
        # beside its flat end a law is another one farther off
        way = min(way, e.step.narrow[j])
    return math.copysign(way, r.f0[j])


def take_alone(e: Engine, r: Radau, j: int, one_side: bool, closely: bool) -> None:
    """Put the slopes by one state into the Jacobian, with nothing else shifted."""
    n = r.n
    delta = r.delta[j]
    if delta == 0.0:
        for i in range(n):
            put_slope(r, i * n + j, 0.0, 0.0, 1.0, closely)
        return
    found = nearest(e, r, j, delta) if e.model.bends > 0.0 else NOT_FINITE
    for _ in range(NEARER if e.model.edges > 0 else 1):
        if found == OK:
            break
        found = beside(e, r, j, delta)
        delta *= RADAU_NEAR
    if one_side and found == OK and is_beyond(e, r):
        found = stay_on_side(e, r, j)
    width = r.shifted[j] - r.y0[j]
    for i in range(n):
        # off its constraints, or where laws end or jump, a state may have no rates; nothing
        # moves it there
        change = r.end[i] - r.f0[i] if found == OK else 0.0
        rest = 0.0
        if closely and found == OK:
            rest = sum_rest(r.end[i], -r.f0[i], change) + (e.rate_rest[i] - r.f0_rest[i])
        put_slope(r, i * n + j, change, rest, width, closely)
    r.shifted[j] = r.y0[j]


def leave_out_rounding(r: Radau, j: int) -> None:
    """Take slopes by a state that is nothing yet for none where rates differ by their rounding.

    Over a difference that is next to nothing the last place of a rate is a slope beyond all bounds.
    """
    n = r.n
    for i in range(n):
        if math.fabs(r.jacobian[i * n + j] * r.delta[j]) <= LAST_PLACES * math.fabs(r.f0[i]):
            r.jacobian[i * n + j] = 0.0


def only_shown(e: Engine, j: int) -> bool:
    """Whether a state is a signal that no rate reads; where a motion slides, its surface may."""
    m = e.model
    return j >= m.storages and e.slide.k == 0 and m.signal_acts[j - m.storages] == 0


def beside(e: Engine, r: Radau, j: int, delta: float) -> int:
    """Find the rates in ``r.end`` with one state shifted, against the motion if not with it."""
    found = NOT_FINITE
    for way in range(2):
        r.shifted[j] = r.y0[j] + (delta if way == 0 else -delta)
        found = rate_at(e, r.n, r.t0, r.shifted, r.end)
        if found == OK:
            break
    return found


def nearest(e: Engine, r: Radau, j: int, farthest: float) -> int:
    """Find the rates as near beside a state as they differ clearly, at `farthest` at most.

    A logarithm beside its end is straight only within part of the way there, and beyond its end a
    line is no slope of it.
    """
    size = math.fabs(r.y0[j])
    part = min(NEAREST * size / math.fabs(farthest), 1.0) if size > 0.0 else FIRST_PART
    while True:
        found = beside(e, r, j, part * farthest)
        if part >= 1.0:
            return found
        clear = False
        for i in range(r.n):
            terms = max(math.fabs(r.f0[i]), e.model.bends)
            clear = clear or math.fabs(r.end[i] - r.f0[i]) > CLEARLY * terms
        if found == OK and clear:
            return found
        part = min(part * NEAREST_GROWS, 1.0)


def has_grown(r: Radau) -> bool:
    """Whether a state is no longer of the size at which the Jacobian was made.

    From rest its differences are rounding. Such a Jacobian is stiff by chance: stages that hardly
    move seem to have converged, and the error that it filters is small.
    """
    for j in range(r.n):
        if math.fabs(r.y0[j]) > GROWN * r.made_for[j]:
            return True
    return False


def held_by_law(e: Engine, r: Radau, unit: Floats) -> None:
    """Let the tolerance of a state be no more than the law that holds it can tell apart.

    A coil behind a diode that blocks has next to no current; but what is across the diode hangs on
    how much. Only what is held so within the step: of others the law follows.
    """
    for i in range(e.model.storages):
        slope = math.fabs(r.jacobian[i * r.n + i])
        if r.h * slope > 1.0 and slope < math.inf:
            least = max(e.model.rtol * e.model.bends / slope, DIGITS_LEFT * math.fabs(r.y0[i]))
            unit[i] = min(unit[i], least)
