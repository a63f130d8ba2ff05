"""Whether friction is at its limit, or only bears so much by one of many ways to share a load.

Where several hold one thing at rest, how much each of them bears is open, and an answer of their
laws takes one at its limit though others could bear more. Then it has not broken loose. Two trade
their shares so far that it is inside of its limit: half of what is there between two that break
loose, all that the other bears in motion as well as at rest.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.complementarity.law_roles import ONE_SIDED, SHUT, TWO_SIDED, LawProblem
from hybond.engine.engine import Engine
from hybond.engine.laws.law_friction import may_rest
from hybond.engine.laws.law_records import Laws

UNMOVED: Final = 1e-10
"""Part of what each of two forces does to a speed, up to which what both do cancels."""
WORTH: Final = 1e-9
"""Part of its limit by which friction comes inside of it at the least."""
NO_ROOM: Final = -1
ALONE: Final = -1


def bears_less(e: Engine, r: Laws, k: int) -> bool:
    """Bring friction at rest and at its limit inside of it, if the others can bear the rest."""
    p = r.problem
    if not is_at_rest(p, k):
        return False
    for one in range(p.n):
        if not gives_force(p, one):
            continue
        if one != k and p.common[k] == 0:
            continue
        if trade(e, r, k, one, ALONE):
            return True
        for other in range(p.n):
            if other != one and gives_force(p, other) and trade(e, r, k, one, other):
                return True
    return False


def is_at_rest(p: LawProblem, k: int) -> bool:
    """Whether a port is friction that does not move in the answer."""
    return p.role[k] == TWO_SIDED and (p.branch[k] == 0 or p.open[k] != 0)


def gives_force(p: LawProblem, k: int) -> bool:
    """Whether what a port gives is a force that may be another: at rest, carrying, or held."""
    return (p.common[k] == 0 and is_at_rest(p, k)) or carries(p, k) or p.role[k] == SHUT


def carries(p: LawProblem, k: int) -> bool:
    """Whether a port is a one-sided law in the branch in which its `l` is anything but negative."""
    return p.role[k] == ONE_SIDED and (p.branch[k] != 0) == (p.common[k] != 0)


def force_of(p: LawProblem, k: int) -> float:
    """Return the force of friction in the answer."""
    if p.common[k] == 0:
        return -p.l[k]
    total = p.q[k]
    for j in range(p.n):
        total += p.m[k * p.n + j] * p.l[j]
    return -total


def room_of(p: LawProblem, k: int, turn: float) -> float:
    """Return how far the force of a port may change, per unit that it changes by."""
    if p.role[k] == SHUT:
        return math.inf
    if p.role[k] == ONE_SIDED:
        return math.inf if turn < 0.0 else p.l[k] / turn
    force = force_of(p, k)
    return (limit_here(p, k) - math.copysign(force, force * turn)) / math.fabs(turn)


def limit_here(p: LawProblem, k: int) -> float:
    """Return the limit of friction in the answer."""
    total = p.limit[k]
    for j in range(p.n):
        total += p.slope[k * p.n + j] * p.l[j]
    return total


def trade(e: Engine, r: Laws, k: int, one: int, other: int) -> bool:
    """Let two ports give more and less so that no speed changes, and k comes inside."""
    p = r.problem
    n = p.n
    share = 0.0
    if other != ALONE:
        share = counterpart(p, one, other)
        if share == 0.0:
            return False
    # what each force becomes per unit of what `one` gives
    for j in range(n):
        moved = p.m[j * n + one]
        size = math.fabs(moved)
        if other != ALONE:
            moved += share * p.m[j * n + other]
            size += math.fabs(share * p.m[j * n + other])
        if math.fabs(moved) <= UNMOVED * size:
            moved = 0.0
        r.tilt[j] = 0.0
        if p.common[j] != 0 and is_at_rest(p, j):
            r.tilt[j] = -moved
        elif moved != 0.0:
            return False
        slope = p.slope[j * n + one] + (share * p.slope[j * n + other] if other != ALONE else 0.0)
        if slope != 0.0:
            return False
    r.tilt[one] = -1.0
    if other != ALONE:
        r.tilt[other] = -share
    if r.tilt[k] == 0.0:
        return False
    way = -float(p.branch[k]) * math.copysign(1.0, r.tilt[k])
    far = math.inf
    first = NO_ROOM
    for j in range(n):
        if r.tilt[j] == 0.0:
            continue
        turn = way * r.tilt[j]
        if p.role[j] == TWO_SIDED and float(p.branch[j]) * turn > 0.0:
            return False
        room = room_of(p, j, turn)
        if room < far:
            far = room
            first = j
    if first == NO_ROOM or not far * math.fabs(r.tilt[k]) > WORTH * limit_here(p, k):
        return False
    breaks = r.resting[first] != 0 or may_rest(e.model, first) or first == k
    far *= 0.5 if breaks else 1.0
    p.l[one] += way * far
    if other != ALONE:
        p.l[other] += way * far * share
    for j in range(n):
        if r.tilt[j] != 0.0 and p.role[j] == TWO_SIDED:
            p.branch[j] = 0
            p.open[j] = 0
    if p.role[first] == ONE_SIDED:
        # it gives nothing any more, and lets nothing through yet
        p.l[first] = 0.0
        p.branch[first] = 0 if p.common[first] != 0 else 1
        p.open[first] = 1
    elif not breaks:
        p.branch[first] = 1 if way * r.tilt[first] > 0.0 else -1
        p.open[first] = 1
    return True


def counterpart(p: LawProblem, one: int, other: int) -> float:
    """Return what `other` gives for a unit of `one` so that their own speeds stay; 0: nothing."""
    n = p.n
    at = one if math.fabs(p.m[one * n + other]) > 0.0 else other
    across = p.m[at * n + other]
    return -p.m[at * n + one] / across if across != 0.0 else 0.0
