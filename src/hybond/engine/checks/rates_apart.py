"""Flows of storages that are shown as others than those by which the steps have moved them.

A law may be so steep that what it reads is known far better than its tolerance, and what it says
is not known at all: two tanks that a rough pipe has made level differ by next to nothing, and the
flow is the root of that. The stages of an implicit step move by the right flow all the same. Of
each rate it is counted how long the two were apart, and told at the end of the run if that is much.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.reasons.warned import RATES_APART, add_about, begin_warning

OF_ITSELF: Final = 0.01
"""Part of itself that a rate may be apart without a word."""
OF_LASTING: Final = 25.0
"""Likewise of the largest of its kind, in tolerances: implicit steps ask no more of rates."""
LONG: Final = 1e-3
"""Part of the run that is long."""
NOTHING: Final = 0.1
"""What was apart by less than this part of it was nothing yet, and is forgotten."""


def count_rates_apart(e: Engine) -> None:
    """Count the step just noted for each rate that was apart at its end.

    And at that of the step before: over one alone, in which a law has bent, its stages tell less of
    its end than the law.
    """
    m = e.model
    c = e.checks
    s = e.step
    if m.tells == 0 or e.t != s.t1:
        return
    for k in range(m.storages):
        off = math.fabs(s.f[k] - s.moves[k]) if s.rates_known else 0.0
        is_apart = off > OF_ITSELF * max(math.fabs(s.f[k]), math.fabs(s.moves[k]))
        if is_apart:
            is_apart = off > most_unseen(e, k)
        if is_apart and c.was_apart[k] != 0:
            if c.most_apart[k] < NOTHING * off:
                c.apart_for[k] = 0.0
                c.apart_since[k] = s.t0
            c.apart_for[k] += s.t1 - s.t0
            if off > c.most_apart[k]:
                c.most_apart[k] = off
                c.apart_from[k] = s.moves[k]
                c.most_at[k] = s.t1
        c.was_apart[k] = 1 if is_apart else 0


def most_unseen(e: Engine, k: int) -> float:
    """Return how far a rate may be apart beside the largest of its kind that was not gone at once.

    Steps that are about to be found too long may have led to far larger ones, for a moment.
    """
    m = e.model
    return OF_LASTING * m.rtol * e.checks.lasting[m.bond_class[rate_bond(m, k)]]


def tell_rates_apart(e: Engine) -> None:
    """Warn of the rate that was apart for longest, where that is a part of the run that counts."""
    m = e.model
    c = e.checks
    which = -1
    longest = LONG * e.span
    for k in range(m.storages if m.tells != 0 else 0):
        # what is nothing beside what came later is no matter
        if c.apart_for[k] > longest and c.most_apart[k] > most_unseen(e, k):
            longest = c.apart_for[k]
            which = k
    if which < 0:
        return
    begin_warning(e.warned, RATES_APART, c.apart_since[which])
    add_about(e.warned, float(which))
    add_about(e.warned, longest)
    add_about(e.warned, c.most_apart[which])
    add_about(e.warned, c.apart_from[which])
    add_about(e.warned, c.most_at[which])
    for k in range(m.storages):
        c.apart_for[k] = 0.0
        c.most_apart[k] = 0.0
