"""Locating guards inside a step, on its dense output.

A guard is a level: none that leaves the current state is true when a step begins. Where
its comparisons are polynomials of the step, it is solved (`solved_guards`). Of others the
comparisons are sampled; where one changes sign, or has an extremum on its way to zero, the
guard itself is asked, so that an even number of crossings or a touch is not lost. The instant found
is the first at which the guard holds, on the comparison that made it true (Illinois method),
confirmed by the test that settling applies.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.at_rest import see_rests
from hybond.engine.guards.blurred import forget_blurred, let_blurred_pass
from hybond.engine.guards.guard_values import (
    atom_at,
    look,
    show,
    terms_here,
    waits_still,
)
from hybond.engine.guards.in_blocks import look_in_blocks
from hybond.engine.guards.kept_rests import forget_rests
from hybond.engine.guards.kinks_on_surfaces import lies_on_surfaces
from hybond.engine.guards.locator import (
    ALL_PARTS,
    NO_KINK,
    Locator,
    begin_looks,
    has_failed,
)
from hybond.engine.guards.moved_off import moves_off
from hybond.engine.guards.rests_asked import see_rests_beside
from hybond.engine.guards.sides_seen import note_sides
from hybond.engine.guards.solved_guards import solve_guards
from hybond.engine.guards.timetable import foresee
from hybond.engine.guards.unresolved import see_borne, see_held_back
from hybond.engine.guards.waiting import may_wait, wake
from hybond.engine.methods.stepping import by_radau

UNCLEAR: Final = 1e-3
"""Part of what steps may be off by within which no side of a root is told, ..."""
LITTLE: Final = 1e-11
"""... and of the terms, where steps may be off by more: a pressure may be high, and what is stored
beside it little."""
SOON: Final = 1e-3
"""Part of a step after which what begins at a kink is on one of its sides."""


def locate(e: Engine, g: Locator) -> int:
    """Find the first instant of the last step at which a guard holds, or infinity, into `g.at`."""
    forget_rests(e)
    forget_blurred(e, g)
    status = search(e, g)
    while status == OK and g.at < math.inf and let_blurred_pass(e, g):
        status = search(e, g)
    if status == OK:
        if note_sides(e, g):
            status = search(e, g)
        if status == OK and see_rests_beside(e, g):
            status = search(e, g)
    while status == OK and g.at < math.inf and see_rests(e, g):
        status = search(e, g)
    if status == OK:
        see_held_back(e, g)
        see_borne(e, g)
        see_waits(e, g)
    show(e, g, ALL_PARTS)
    g.sampled = False
    return status


def see_waits(e: Engine, g: Locator) -> None:
    """Let rules be asked again whose comparisons are elsewhere at the end of the step."""
    for k in range(g.guards if e.rests.some_wait and g.at == math.inf else 0):
        if g.rule[k] >= 0 and may_wait(e, g.rule[k], e.step.t1):
            look(e, g, e.step.t1)
            if not waits_still(e, g, k, e.step.t1):
                wake(e, g.rule[k])


def search(e: Engine, g: Locator) -> int:
    """Look for it."""
    g.at = math.inf
    g.failed = False
    g.about = False
    g.found_at = math.nan
    g.shown_to = math.nan
    begin_looks(e.model, g)
    for k in range(g.guards):
        g.foreseen[k] = 0
    if g.guards == 0:
        return OK
    if e.model.kinks + e.model.slide_kinks > 0:
        take_sides_of_kinks(e, g)
    left = solve_guards(e, g)
    if has_failed(g):
        return REFUSED
    if left and e.timetable.any_alone:
        left = foresee(e, g)
        if has_failed(g):
            return REFUSED
    g.asked_from = 0
    g.asked_until = g.guards
    return look_in_blocks(e, g) if left else OK


def take_sides_of_kinks(e: Engine, g: Locator) -> None:
    """Note on which side of each kink the step begins; of one the motion begins at, where to.

    Of one whose side the error of steps may have made, none.

    All are looked at in one instant before any is in the next: there the motion is solved for.
    """
    begins = False
    for k in range(g.guards):
        g.done[k] = 0
        if g.side[k] == NO_KINK:
            continue
        a = g.atom_first[k]
        here = atom_at(e, g, a, e.step.t0)
        if e.slide.k > 0 and lies_on_surfaces(e, g, k):
            g.side[k] = 0
            g.sleep[k] = max(g.sleep[k], 1)
            continue
        if is_unclear(e, g, k, here):
            g.side[k] = 0
            continue
        if math.isfinite(here) and math.fabs(here) <= ROUNDING * terms_here(e, g, k, a):
            if g.side[k] == 0:
                g.done[k] = 1
                begins = True
            continue  # not passed yet
        g.side[k] = side_of(here)
    if begins:
        take_sides_soon(e, g)


def is_unclear(e: Engine, g: Locator, k: int, here: float) -> bool:
    """Whether the error of implicit steps says on which side of a root that meets a motion is.

    It may be passed to and fro in front of what has not moved yet: each time a step would end there
    for nothing, since what follows the root is as small.
    """
    if not by_radau(e) or not math.isfinite(here):
        return False
    a = g.atom_first[k]
    if e.model.kink_meets[g.atom[a] - e.model.kink_atom] == 0:
        return False
    size = terms_here(e, g, k, a)
    away = math.fabs(here)
    return ROUNDING * size < away and away <= min(UNCLEAR * e.model.rtol, LITTLE) * size


def take_sides_soon(e: Engine, g: Locator) -> None:
    """Note where the motion goes to from the kinks that it begins at, those in `g.done`."""
    soon = SOON * (e.step.t1 - e.step.t0)
    for k in range(g.guards):
        if g.done[k] != 0:
            a = g.atom_first[k]
            here = atom_at(e, g, a, e.step.t0 + soon)
            g.side[k] = side_of(here)
            if math.fabs(here) <= ROUNDING * terms_here(e, g, k, a):
                g.side[k] = 0
    for k in range(g.guards):
        if g.done[k] != 0 and g.side[k] != 0 and not moves_off(e, g, k, soon):
            g.side[k] = 0


def side_of(here: float) -> int:
    """Return on which side of a kink this is."""
    return 1 if here > 0.0 else -1 if here < 0.0 else 0
