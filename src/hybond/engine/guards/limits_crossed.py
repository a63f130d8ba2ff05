"""Limits that were crossed: what waits just past one has come to it, and no further.

The motion finds a guard `melted > heat` where that is more by more than rounding: a little late. If
what it compares then stands still while other states come and go, and a state is entered whose
guards compare the same, it is at its limit, as it would be in exact arithmetic. So up to there it
counts as zero for as long as that state lasts.

Laws of junctions count more than that as zero, and decide by how it moves. One that stands where
its guard was found, as the error of the steps has led just past zero and the motion leads back,
stands up to there: else it would be asked again in each instant up to where that has come back.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import STANDS, atom_at, holds_at, terms_here
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, Locator
from hybond.engine.methods.explicit.dopri import spacing

WIDE: Final = 16.0
"""Last places of the time between which a guard is found to begin: four, and those around them."""
ALIKE: Final = 16.0
"""Times as far as just before, or just behind, that what crosses may go there: a jump is more."""
NEAR: Final = 4.0
"""Times rounding by which a comparison is past zero where it is found to be so at once."""


def note_limits(e: Engine, g: Locator, t: float) -> None:
    """Note what the guards compare that begin to hold at an instant, where they have crossed."""
    for k in range(g.guards if e.slide.k == 0 else 0):
        r = g.rule[k]
        if r < 0 or g.part[k] != ALL_PARTS or g.pair[k] != r or e.rests.by_hand[r] == 0:
            continue
        if holds_at(e, g, k, t) and crosses_at(e, g, k, t):
            a = g.atom_first[k]
            here = atom_at(e, g, a, t)
            e.rests.crossed[e.model.atom_value[g.atom[a]]] = here
            e.rests.crossed_at[e.model.atom_value[g.atom[a]]] = t
            e.rests.some_crossed = True


def crosses_at(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Whether a comparison is past zero by no more than finding it does.

    One that has jumped over zero, as ``floor(time) > 0.5`` does, is not: it is where it is.
    """
    a = g.atom_first[k]
    here = atom_at(e, g, a, t)
    size = terms_here(e, g, k, a)
    if math.fabs(here) <= NEAR * ROUNDING * size:
        return True
    way = WIDE * spacing(t)
    before = atom_at(e, g, a, max(t - way, e.step.t0))
    if before * here > 0.0:
        return False
    goes = math.fabs(before - atom_at(e, g, a, max(t - 2.0 * way, e.step.t0)))
    goes = max(goes, math.fabs(atom_at(e, g, a, min(t + way, e.step.t1)) - here))
    return math.fabs(here - before) <= ALIKE * goes + NEAR * ROUNDING * size


def level_of(e: Engine, machine: int, r: int) -> float:
    """Return up to where what a rule compares counts as zero, at an instant that is settled."""
    q = e.rests
    m = e.model
    if not q.some_crossed or q.by_hand[r] == 0:
        return 0.0
    if e.state[machine] != m.rule_source[r]:
        # the state is entered
        a = m.atom_value[m.atom_first[r]]
        waits = q.crossed_at[a] < e.t and value(m, a, e.v) == q.crossed[a]
        q.within[r] = q.crossed[a] if waits else 0.0
    return q.within[r]


def see_stood(e: Engine, g: Locator, changed: bool, found: bool) -> None:
    """Let laws stand up to where they did at an instant that is settled.

    A guard was `found` there, and nothing `changed`; if anything did, they are asked from zero on.
    """
    m = e.model
    q = e.rests
    if changed:
        for r in range(m.rule_first[m.machines] if q.some_stand else 0):
            q.within[r] = q.within[r] if q.of_law[r] == 0 else 0.0
        q.some_stand = False
        return
    g.looked = math.nan
    for k in range(g.guards if found and e.slide.k == 0 else 0):
        r = g.rule[k]
        if r < 0 or g.part[k] != ALL_PARTS or g.pair[k] != r or g.side[k] != NO_KINK:
            continue
        if q.of_law[r] == 0 or not holds_at(e, g, k, e.t):
            continue
        a = g.atom_first[k]
        here = atom_at(e, g, a, e.t)
        if math.fabs(here) <= STANDS * terms_here(e, g, k, a):
            q.within[r] = here
            q.some_stand = True
    g.looked = math.nan
