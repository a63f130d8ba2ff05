"""Guards at an instant, where comparisons that are no more than their digits keep their sides.

What a comparison was, when it was clear of zero last, it still is where all that is left of it is
rounding, or the error of the run. So it is put clear of zero on that side, by one of the signals
that it reads, and the guard is asked once more.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.rest_records import side_of
from hybond.engine.reasons.warned import GUARD_AT_REST, add_about, begin_warning
from hybond.engine.words import Floats

NOT_ASKED: Final = -1
"""No comparison keeps its side, or it has left it."""
ON_ZERO: Final = 2
"""A comparison rests on zero, not clear of it."""
CLEAR: Final = 16.0
"""Times what cannot be told from zero that a comparison is put beside it."""
LITTLE: Final = 1e-6
"""Part of a signal by which it is moved to see what that moves."""


def holds_on_sides(e: Engine, r: int) -> int:
    """Ask the guard of a rule in a trial so, 1 or 0; NOT_ASKED if it is as the trial says.

    Pairs are those of the trial, and measured. Of what was never clear both sides are tried: the
    guard holds if it does with either.
    """
    q = e.rests
    m = e.model
    if e.trial.jumps or not q.some:
        return NOT_ASKED
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if q.atom[a] == 0 and q.creeps[a] != 0:
            see_creep(e, a)
    return ask_kept(e, r, e.v, e.trial.terms, True)


def ask_kept(e: Engine, r: int, v: Floats, terms: Floats, trial: bool) -> int:
    """Ask a guard so at values that pairs are of; in a trial there are others before these."""
    q = e.rests
    m = e.model
    kept = False
    known = True
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if q.atom[a] == 0:
            continue
        if not math.fabs(value(m, m.atom_value[a], v)) <= q.band[a]:
            return NOT_ASKED
        kept = True
        known = known and side_of(q, a) != 0
    if not kept:
        return NOT_ASKED
    true = 1
    for way in range(1 if known else 2):
        held = ask_on_sides(e, r, v, terms, trial, 1 if way == 0 else -1)
        if held == NOT_ASKED:
            return NOT_ASKED
        true = min(true, held)
    return true


def keeps_sides(e: Engine, r: int, v: Floats) -> bool:
    """Whether a comparison of a rule is what it was only, at values of a motion."""
    q = e.rests
    m = e.model
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if q.atom[a] != 0 and math.fabs(value(m, m.atom_value[a], v)) <= q.band[a]:
            return True
    return False


def see_creep(e: Engine, a: int) -> None:
    """Let a comparison that has crept up to zero from instant to instant keep its side there."""
    q = e.rests
    m = e.model
    here = value(m, m.atom_value[a], e.v)
    near = 4.0 * ROUNDING * q.extent[a]
    if math.fabs(here) <= near:
        q.atom[a] = ON_ZERO
        q.band[a] = near
        q.side[a] = 1 if q.last[a] > 0.0 else -1
        q.turns[a] = 0
        q.away[a] = 0


def ask_on_sides(e: Engine, r: int, v: Floats, terms: Floats, trial: bool, other: int) -> int:
    """Ask the guard with comparisons beside zero: where they were, or on the other side given."""
    q = e.rests
    m = e.model
    kept = q.signals
    first = m.read_first[r]
    stop = m.read_first[r + 1]
    for p in range(first, stop):
        kept[2 * (p - first)] = v[m.read_slot[p]]
        kept[2 * (p - first) + 1] = e.pre[m.read_slot[p]]
    put = True
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if q.atom[a] != 0:
            own = side_of(q, a)
            side = own if own != 0 else other
            put = put and put_on_side(e, r, a, float(side) * CLEAR * q.band[a], v, terms, trial)
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if q.atom[a] != 0:
            own = side_of(q, a)
            side = own if own != 0 else other
            put = put and float(side) * value(m, m.atom_value[a], v) > q.band[a]
    stack = e.work.stack
    true = put and holds(m, r, stack)
    put = put and stack.refused == 0
    for p in range(first, stop):
        v[m.read_slot[p]] = kept[2 * (p - first)]
        if trial:
            e.pre[m.read_slot[p]] = kept[2 * (p - first) + 1]
    return NOT_ASKED if not put else 1 if true else 0


def put_on_side(
    e: Engine, r: int, a: int, there: float, v: Floats, terms: Floats, trial: bool
) -> bool:
    """Move the signal that moves a comparison most so that it is `there`; False if none does."""
    m = e.model
    here = value(m, m.atom_value[a], v)
    best = 0.0
    slope = 0.0
    chosen = -1
    for p in range(m.read_first[r], m.read_first[r + 1]):
        slot = m.read_slot[p]
        if slot < m.signal_slot or slot >= m.on_slot:
            continue
        before = v[slot]
        little = LITTLE * max(math.fabs(before), terms[slot])
        little = little if little > 0.0 else LITTLE
        v[slot] = before + little
        moved = value(m, m.atom_value[a], v) - here
        v[slot] = before
        if math.fabs(moved) > best and math.isfinite(moved):
            best = math.fabs(moved)
            slope = moved / little
            chosen = slot
    if chosen < 0 or not best > ROUNDING * e.rests.extent[a]:
        return False
    v[chosen] += (there - here) / slope
    if trial:
        e.pre[chosen] += (there - here) / slope
    return True


def warn_of_kept(e: Engine, r: int, t: float) -> None:
    """Warn once of a guard that holds at an instant by rounding alone, and does not fire."""
    q = e.rests
    m = e.model
    if m.tells == 0 or q.said[r] != 0:
        return
    for a in range(m.atom_first[r], m.atom_first[r + 1]):
        if q.atom[a] == ON_ZERO:
            q.said[r] = 1
            begin_warning(e.warned, GUARD_AT_REST, t)
            add_about(e.warned, float(r))
            add_about(e.warned, 0.0)
            add_about(e.warned, value(m, m.atom_value[a], e.v))
            add_about(e.warned, q.extent[a])
            return
