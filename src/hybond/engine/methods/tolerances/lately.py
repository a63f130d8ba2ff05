"""How large each state lately was: what was large once is forgotten when it has stayed small.

Since a state was last about as large as its size, time is cut into pieces, each a part of all that
went before. What dies out loses in each piece as much, of its logarithm, as a piece is of the time
since then: it goes on to be measured by what it died from, however long that takes, and steps grow.
A state that has become small and loses less than half of that stays there: what it is there is its
size from now on. So a voltage of 1 V that was 1 MV once has the digits of 1 V, what rings down to
nothing is not followed forever, and what swings is not measured by its zeros. None of this has a
scale of its own, of time or of size.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.method_numbers import AUTO
from hybond.engine.methods.tolerances.scale import measure_anew
from hybond.engine.mode.rows.storage import own_stiffness

NEAR: Final = 0.9
"""Part of its size from which on a state is about as large as that."""
PIECE: Final = 0.25
"""What a piece of time is to all the time since then that was before it."""
FAR: Final = 0.05
"""Part of its size below which a state has become small."""
SLOWER: Final = 0.5 * PIECE / (1.0 + PIECE)
"""What a state that stays loses in a piece, to what it has lost in all, both as logarithms: half of
that at which it would die out."""
STAGE: Final = 1e-3
"""Part of its size that is left at once, at the least: what is left of a motion that died out
may be no more than the error that steps were allowed, and go on to die out when it is looked at."""
DOUBTFUL: Final = 10.0
"""What is less than so many times the error that steps were allowed may be nothing else, ..."""
BUSY: Final = 0.01
"""... and is taken for that where steps are a smaller part of the time since it was large: they are
bound by stability, or by a root, and would only be shorter."""
SOON: Final = 1e-4
"""Part of the run within which nothing is forgotten: what chatters at a root stays there."""
LEAST: Final = 1e-12
"""Part of the largest value ever below which no size is: what is left there may be rounding."""


def follow_sizes(e: Engine) -> None:
    """Learn from the state at the beginning of a step. Once or twice is the same.

    Quanta stay: they are the steps. What rates cancel from is found again where something large is
    forgotten.
    """
    if e.model.method > AUTO:
        return
    m = e.model
    y = e.step.y
    t = e.step.t
    forgets = False
    for k in range(e.states):
        forgets = follow_size(e, k, t, math.fabs(y[k])) or forgets
    v = e.work.values
    for k in range(m.storages):
        v[m.stored_slot + k] = y[k]
    energy = e.work.part_here
    for i in range(e.parts):
        energy[i] = 0.0
    for k in range(m.storages):
        energy[e.storage_part[k]] += math.fabs(own_stiffness(m, k, v)) * y[k] * y[k]
    for i in range(e.parts):
        if energy[i] < math.inf:
            forgets = follow_size(e, e.states + i, t, math.sqrt(0.5 * energy[i])) or forgets
    if forgets and e.slide.k == 0:
        measure_anew(e, e.mode)


def follow_size(e: Engine, k: int, t: float, now: float) -> bool:
    """Learn from what state `k` is at `t`; behind all states, the roots of energies of parts.

    Whether something larger is forgotten.
    """
    n = e.states + e.model.storages + 1
    s = e.lately
    forgets = False
    if now < NEAR * s[k]:
        most = max(s[n + k], now)
        s[n + k] = most
        if t < s[4 * n + k]:
            return False
        before = s[2 * n + k]
        since = t - s[3 * n + k]
        s[n + k] = now
        s[2 * n + k] = most
        s[4 * n + k] = t + PIECE * since
        if most > FAR * s[k] or most == 0.0 or since < SOON * e.span:
            return False
        if before > most and math.log(before / most) > SLOWER * math.log(s[k] / most):
            return False
        doubtful = k < e.states and most <= DOUBTFUL * e.model.rtol * s[k]
        if doubtful and e.step.t1 - e.step.t0 < BUSY * since:
            return False
        ever = e.largest_state[k] if k < e.states else math.sqrt(e.scale_energy[k - e.states])
        least = max(STAGE * s[k], LEAST * ever)
        if s[k] <= least:
            return False
        s[k] = max(max(before, most), least)
        if s[k] == least:
            return True
        forgets = True
    s[k] = max(s[k], now)
    s[n + k] = now  # the largest in this piece,
    s[2 * n + k] = s[k]  # and in the one before,
    s[3 * n + k] = t  # which are counted from here,
    s[4 * n + k] = t  # and end there
    return forgets
