"""Roots on both sides of rest: what they bring to nothing in a finite time rests there.

An orifice lets a level difference run out by its root, whichever way it goes. The rate at rest is
zero, and beside it the slope is without bound: steps that pass rest are thrown back, and would go
to and fro as far as the error allows, without end. So what is no more than the error of a step away
from rest, is led there, and would not move there, is put there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, Locator
from hybond.engine.methods.stepping import by_radau
from hybond.engine.methods.tolerances.scale import widest_tolerance
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.run.held_by_kinks import compared, has_values
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

STANDS: Final = 1e-3
"""Part of the speed beside rest below which nothing moves at rest: a root of rounding is small."""
STILL: Final = 1e-6
"""The same where Newton finds the root: at rest it begins at zero, and leaves no rounding."""
SHORT: Final = 1e-3
"""Part of what is stored that moves while a speed is seen."""
NOTHING: Final = 1e-6
"""Part of what was stored beside rest that is nothing there."""
FAR: Final = 1e4
"""Times what the error of a step moves it from which on what is compared is far from rest."""
NEARER: Final = 0.25
"""Part of what it was then from which on it is looked at anew, ..."""
LOOKED: Final = 32
"""... or after so many steps: how much it moves is another where laws bend."""
PASSES: Final = 4
"""Times that the straight way to rest is gone."""


def rest_at_roots(e: Engine, r: Run) -> None:
    """Put the present state at rest where the roots of laws have all but brought it there."""
    g = r.locator
    seen = False
    for k in range(g.guards if e.model.kinks > 0 and e.slide.k == 0 else 0):
        kink = rest_of_guard(e, g, k)
        if kink < 0:
            continue
        if not seen:
            see_rests(e, r)
            seen = True
        if is_far_from_rest(r, kink):
            continue
        refusal = e.refusal
        # the straight way leads far beyond where a storage bends: nothing of that is to be kept
        hold_guess(e, e.mode)
        if not goes_to_rest(e, r, kink):
            give_back_guess(e, e.mode)
        else:
            copy_floats(e.states, r.after, e.y)
            if by_radau(e):
                e.radau.known = False  # stages that go on from the last ones leave rest
            seen = False
        g.looked = math.nan
        e.refusal = refusal


def rest_of_guard(e: Engine, g: Locator, k: int) -> int:
    """Return the kink that is watched as guard k, if it has a rest; else -1."""
    kink = g.atom[g.atom_first[k]] - e.model.kink_atom
    return -1 if g.side[k] == NO_KINK or e.model.kink_rest[kink] < 0 else kink


def see_rests(e: Engine, r: Run) -> None:
    """Find how far all that is compared is from rest, and now and then what steps leave open of it.

    That is looked at anew in another mode, after some steps, or where one is nearer by or farther
    off: laws bend. One solution at a state tells of all of them.
    """
    g = r.locator
    refusal = e.refusal
    hold_guess(e, e.mode)
    copy_floats(e.states, e.y, g.y)
    known = has_values(e, g, e.t)
    due = False
    for k in range(e.model.kinks):
        r.rest_due[k] = 0
    for k in range(g.guards):
        kink = rest_of_guard(e, g, k)
        if kink < 0:
            continue
        r.rest_here[kink] = value(e.model, e.model.kink_rest[kink], e.v) if known else math.nan
        size = math.fabs(r.rest_here[kink])
        counts = size > 0.0 and math.isfinite(size)
        lately = r.rest_mode[kink] == e.mode.made and r.rest_asked[kink] < LOOKED
        lately = lately and size > NEARER * r.rest_away[kink]
        lately = lately and NEARER * size < r.rest_away[kink]
        r.rest_due[kink] = 1 if counts else 0
        r.rest_asked[kink] += 1
        due = due or (counts and not lately)
    if due:
        see_errors(e, r)
    give_back_guess(e, e.mode)
    g.looked = math.nan
    e.refusal = refusal


def see_errors(e: Engine, r: Run) -> None:
    """See by how much all that is compared moves with all states, each moved by a step's error."""
    g = r.locator
    for k in range(e.model.kinks):
        if r.rest_due[k] != 0:
            r.rest_moved[k] = 0.0
            r.rest_away[k] = math.fabs(r.rest_here[k])
            r.rest_mode[k] = e.mode.made
            r.rest_asked[k] = 1
    widest_tolerance(e, e.y, r.beside)
    for i in range(e.states):
        copy_floats(e.states, e.y, g.y)
        g.y[i] += r.beside[i]
        known = has_values(e, g, e.t)
        for k in range(e.model.kinks):
            if r.rest_due[k] != 0:
                there = value(e.model, e.model.kink_rest[k], e.v) if known else math.nan
                r.rest_moved[k] += math.fabs(there - r.rest_here[k])


def is_far_from_rest(r: Run, k: int) -> bool:
    """Whether the error of a step is next to nothing of what is away from rest at kink k."""
    return math.fabs(r.rest_here[k]) > FAR * r.rest_moved[k]


def goes_to_rest(e: Engine, r: Run, k: int) -> bool:
    """Put the state at rest into `r.after`; whether the motion leads there and stays.

    Of what is compared at kink k a law takes the root; the two are one if it is the law that is
    flat.
    """
    atom = e.model.kink_rest[k]
    kink = e.model.atom_value[e.model.kink_atom + k]
    away = r.rest_here[k]
    if away == 0.0 or not math.isfinite(away):
        return False
    if field(e, e.mode, e.t, e.y, r.rate) != OK:
        return False
    beside = leads_to_rest(e, r, atom, away)
    if beside == 0.0:
        return False
    if not is_within_error(e, r):
        # what moves beside the root goes on doing so at rest, and has no part in the way there
        copy_part(e.states, r.rate, 0, r.beside, e.states)
        if field(e, e.mode, e.t, r.after, r.rate) != OK:
            return False
        for i in range(e.states):
            r.rate[i] = r.beside[e.states + i] - r.rate[i]
        beside = leads_to_rest(e, r, atom, away)
        if beside == 0.0 or not is_within_error(e, r):
            return False
    seen = time_to_see(e, r)
    stands = STANDS if atom == kink else STILL
    # a law that is flat at rest has many roots there but for rounding, beside it the last one
    e.mode.guessed = False
    rests = field(e, e.mode, e.t, r.after, r.rate) == OK
    left = at_state(e, r, atom, r.after)
    most = stands * math.fabs(beside)
    # explicit steps would go to and fro about it all the same: put at rest, they are seen as stiff
    if rests and by_radau(e) and is_moved_on(e, r, atom, left, seen, most):
        return False
    return rests and math.fabs(speed_of(e, r, atom, r.after, left)) <= most


def is_moved_on(e: Engine, r: Run, atom: int, left: float, h: float, most: float) -> bool:
    """Whether what is compared leaves rest with time alone, in `h`, faster than `most`.

    A source moves such a rest: what follows it lags behind by what moves it on, and put at rest
    would begin anew with each step.
    """
    for i in range(e.states):
        r.locator.y[i] = r.after[i]
    return math.fabs(compared(e, r.locator, atom, ALL_PARTS, e.t + h) - left) > most * h


def leads_to_rest(e: Engine, r: Run, atom: int, away: float) -> float:
    """Put the state at rest straight on by `r.rate` into `r.after`; return the speed, or 0."""
    n = e.states
    copy_floats(n, e.y, r.after)
    beside = 0.0
    left = away
    for turn in range(PASSES):
        speed = speed_of(e, r, atom, r.after, left)
        # where a storage bends the straight way leads a little beyond rest: the next one leads back
        if not (speed * away < 0.0 and math.isfinite(speed)):
            return 0.0
        if turn == 0:
            beside = speed
        for i in range(n):
            r.after[i] -= left / speed * r.rate[i]
            if math.fabs(r.after[i]) <= NOTHING * math.fabs(e.y[i]):
                r.after[i] = 0.0
        left = at_state(e, r, atom, r.after)
        if left == 0.0:
            break
    return beside if math.fabs(left) <= NOTHING * math.fabs(away) else 0.0


def is_within_error(e: Engine, r: Run) -> bool:
    """Whether what is left of the way to rest is less than the error of a step."""
    widest_tolerance(e, e.y, r.beside)
    for i in range(e.states):
        if not math.fabs(r.after[i] - e.y[i]) <= r.beside[i]:
            return False
    return True


def speed_of(e: Engine, r: Run, atom: int, y: Floats, here: float) -> float:
    """Return how fast what is compared moves from a state by the rates in `r.rate`."""
    h = time_to_see(e, r)
    if h == math.inf:
        return 0.0
    if h == 0.0:
        return math.nan  # what is next to nothing moves at once
    for i in range(e.states):
        r.locator.y[i] = y[i] + h * r.rate[i]
    return (compared(e, r.locator, atom, ALL_PARTS, e.t) - here) / h


def time_to_see(e: Engine, r: Run) -> float:
    """Return the time in which the rates in `r.rate` move a small part of what is stored."""
    most = 0.0
    for i in range(e.states):
        if r.rate[i] != 0.0 and e.y[i] != 0.0:
            most = max(most, math.fabs(r.rate[i]) / math.fabs(e.y[i]))
    return SHORT / most if most > 0.0 else math.inf


def at_state(e: Engine, r: Run, atom: int, y: Floats) -> float:
    """Return what is compared at a state."""
    copy_floats(e.states, y, r.locator.y)
    return compared(e, r.locator, atom, ALL_PARTS, e.t)
