"""Rules that wait: what they compare is at its threshold, and on its way off it.

Such a guard holds by rounding alone, and would not a moment later. It waits for as long as each of
its comparisons is where it was found, at its threshold or on that side of it, and no longer than
until that moment: beyond rounding a guard is a level, whichever way it went. Nor does it wait at
another instant at which anything changes, as then the motion is another one.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.words import Floats

EQUAL: Final = 4.0
"""Times its rounding within which a comparison is at its threshold where it was located."""


def wake_all(e: Engine) -> None:
    """Let every rule be asked."""
    q = e.rests
    if q.some_wait:
        for r in range(e.model.rule_first[e.model.machines]):
            wake(e, r)
        q.some_wait = False


def wake(e: Engine, r: int) -> None:
    """Let a rule be asked."""
    e.rests.waits_until[r] = -math.inf


def let_wait(e: Engine, r: int, until: float, v: Floats, terms: Floats) -> None:
    """Let a rule wait with its comparisons where they are, up to when it is known to be over."""
    m = e.model
    q = e.rests
    q.waits_until[r] = until
    q.some_wait = True
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        place = place_of(e, r, a, v, terms)
        q.stands_on[a] = place


def may_wait(e: Engine, r: int, t: float) -> bool:
    """Whether a rule waits at t if its comparisons are where they were."""
    return e.rests.some_wait and t <= e.rests.waits_until[r]


def waits(e: Engine, r: int, t: float, v: Floats, terms: Floats) -> bool:
    """Whether a rule waits still, of the values `v` measured by `terms`."""
    m = e.model
    if not may_wait(e, r, t):
        return False
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        place = place_of(e, r, a, v, terms)
        if place != e.rests.stands_on[a]:
            return False
    return True


def place_of(e: Engine, r: int, a: int, v: Floats, terms: Floats) -> float:
    """Return the sign of comparison a of a rule, 0 if it is not told from equality."""
    m = e.model
    here = value(m, m.atom_value[a], v)
    swap_with_terms(e, r, v, terms)
    size = value(m, m.atom_size[a], v)
    swap_with_terms(e, r, v, terms)
    if math.fabs(here) <= EQUAL * ROUNDING * size:
        return 0.0
    return 1.0 if here > 0.0 else -1.0


def swap_with_terms(e: Engine, r: int, v: Floats, terms: Floats) -> None:
    """Exchange the bond variables that a rule reads for what they are measured by."""
    m = e.model
    for p in range(m.read_first[r], m.read_first[r + 1]):
        slot = m.read_slot[p]
        if slot >= m.bond_slot and slot < m.bond_slot + 2 * m.bonds:
            here = v[slot]
            v[slot] = terms[slot]
            terms[slot] = here
