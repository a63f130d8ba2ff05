"""Guards that the motion leads over their thresholds, and that rounding alone keeps from holding.

A comparison counts as equal within rounding of its terms. What moves slowly takes longer through
that than an instant lasts: of ``x < 2.5`` and ``x > 2.5`` the one would end well before the other
begins, and what they switch would be cut off in between. Rounding orders no transitions, so the
instant at which the first is found is one with that at which the motion has left rounding.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.bracket import bracket
from hybond.engine.guards.far_guards import is_idle
from hybond.engine.guards.guard_values import (
    atom_here,
    holds_at,
    look,
    show,
    size_here,
    terms_here,
)
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, Locator
from hybond.engine.guards.together import NEAR_ZERO, ask_done, may_others
from hybond.engine.methods.stepping import retry

SLOWEST: Final = 1e-5
"""Part of the run that rounding may take, at the most: what is slower rests there."""
PAST_IT: Final = 1e-3
"""Part of that by which it is gone beyond."""
UNTOLD: Final = 8.0
"""Times its rounding within which a comparison is not told from equality: what is the edge of one
expression of a quantity is just outside of that of another."""
ASKED: Final = 1
"""A guard that rounding alone keeps from holding, as far as it was looked."""
HELD: Final = 2
"""One that holds where the instant was found."""
FOUND: Final = 3
"""One that holds where it is looked."""
PASSED: Final = 4
"""One of which it is known when it begins to hold, or that it does not."""
FARTHER: Final = 4.0
"""How many times as far it is looked next."""


def past_rounding(e: Engine, g: Locator, t: float, room: float, end: float) -> float:
    """Return the instant, `t` or later, at which guards that are within rounding at `t` hold.

    It is `t` where none does in the motion, where another guard begins to hold before, and where
    one that holds at `t` does so no more. The last step reaches to there.
    """
    top = min(end, t + SLOWEST * e.span)
    if e.slide.k > 0 or not top > t + room or not may_others(e, g, t, t + room):
        return t
    look(e, g, t)
    for k in range(g.guards):
        g.done[k] = ASKED if is_within(e, g, k) and not stays(e, g, k, top) else 0
    ask_done(e, g, t, False)
    found = False
    for k in range(g.guards):
        found = found or g.done[k] != 0
    last = last_within(e, g, t, room, top) if found and not g.failed else t
    show(e, g, ALL_PARTS)
    return last


def last_within(e: Engine, g: Locator, t: float, room: float, top: float) -> float:
    """Return the last instant up to `top` at which one of those in `g.done` begins to hold."""
    longest = e.step.t1
    for k in range(g.guards):
        if g.done[k] == 0 and g.side[k] == NO_KINK and holds_at(e, g, k, t):
            g.done[k] = HELD
    last = t
    away = room
    while away > 0.0 and not g.failed:
        at = min(t + away, top)
        if not reaches(e, g, at):
            break
        last = max(last, last_up_to(e, g, t, at))
        away = FARTHER * away if at < top and any_asked(g) else 0.0
    # the energy that rounding is measured by is not the same to the last digit where it is settled
    last = min(last + PAST_IT * (last - t), max(e.step.t1, last))
    if last > t and not g.failed and not changes_others(e, g, last):
        return last
    if e.step.t1 != longest:
        g.failed = make_to(e, g, longest) != OK or g.failed
    return t


def last_up_to(e: Engine, g: Locator, t: float, at: float) -> float:
    """Return the last instant at which one of those asked begins to hold, of those found at `at`.

    `t` if there is none. All are looked at there before one is looked at elsewhere.
    """
    for k in range(g.guards):
        if g.done[k] == ASKED and not g.failed:
            if holds_at(e, g, k, at):
                g.done[k] = FOUND
            elif not is_within(e, g, k):
                g.done[k] = PASSED
    last = t
    for k in range(g.guards):
        if g.done[k] == FOUND and not g.failed:
            last = max(last, bracket(e, g, k, t, at))
            g.done[k] = PASSED
    return last


def any_asked(g: Locator) -> bool:
    """Whether one is left that rounding alone keeps from holding."""
    found = False
    for k in range(g.guards):
        found = found or g.done[k] == ASKED
    return found


def reaches(e: Engine, g: Locator, at: float) -> bool:
    """Whether steps go on to there, as far as their errors let them, and over no kink."""
    before = e.step.t1
    if at <= before:
        return True
    if e.model.slide_kinks > 0 or make_to(e, g, at) != OK:
        return False
    if e.step.off > 1.0 or passes_kink(e, g, at):
        g.failed = make_to(e, g, before) != OK
        return False
    return not g.failed


def make_to(e: Engine, g: Locator, end: float) -> int:
    """Repeat the step so that it ends there."""
    g.looked = math.nan
    g.found_at = math.nan
    return retry(e, end)


def is_within(e: Engine, g: Locator, k: int) -> bool:
    """Whether no comparison of a guard is told from equality, where it is looked."""
    if g.side[k] != NO_KINK or g.margin[k] >= 0 or g.part[k] >= 0 or g.rule[k] < 0:
        return False
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        here = math.fabs(atom_here(e, g, a))
        size = size_here(e, g, a)
        if not here <= NEAR_ZERO * size:
            return False
        terms = terms_here(e, g, k, a)
        if not here <= UNTOLD * ROUNDING * terms:
            return False
    return g.atom_first[k + 1] > g.atom_first[k]


def stays(e: Engine, g: Locator, k: int, top: float) -> bool:
    """Whether nothing moves of what a guard compares up to there, or next to nothing."""
    return top <= e.step.t1 and g.still[k] != 0 and is_idle(e, g, k)


def passes_kink(e: Engine, g: Locator, t: float) -> bool:
    """Whether a step has led over a kink up to `t`: one is to end there."""
    for k in range(g.guards):
        if g.side[k] != NO_KINK and holds_at(e, g, k, t):
            return True
    return g.failed


def changes_others(e: Engine, g: Locator, last: float) -> bool:
    """Whether a guard that is clear of its threshold begins to hold up to `last`, or one ceases.

    Which of them hold before is known: of a longer step rounding may say something else there.
    """
    for k in range(g.guards):
        if g.side[k] == NO_KINK and (g.done[k] == 0 or g.done[k] == HELD):
            held = holds_at(e, g, k, last)
            if held != (g.done[k] == HELD):
                return True
    return g.failed
