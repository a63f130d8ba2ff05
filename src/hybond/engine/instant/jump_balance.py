"""The energy of a jump: what its impulses store is what sources gave by them, or less."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.laws.law_candidates import impulse_of
from hybond.engine.mode.equations import is_fieldless
from hybond.engine.mode.rows.storage import co_energy, with_stored
from hybond.engine.reasons.noting import CREATED, note_violation
from hybond.engine.words import Floats

PART: Final = 0.01
"""Part of the energy that moved by which a run may be off: a hundred thousand steps of the usual
tolerance add up to a tenth of that, and what is wrong is off by as much as moves."""
ROUNDED: Final = 1e-9
"""Part of the impulses at a junction down to which their sum is none."""


def hold_jump(e: Engine, x: Floats, given: float, may_create: bool) -> None:
    """Hold what the impulses of a jump from `x` have stored against what sources gave by them.

    A law of impacts may give some, as declared: that is a warning in joules.
    """
    c = e.checks
    before = e.trial.energy_before
    after = e.trial.energy_struck
    c.moved += math.fabs(after - before) + math.fabs(given)
    made = after - before - given - between(e)
    size = max(max(math.fabs(before), math.fabs(after)), math.fabs(given))
    if may_create or made <= PART * size:
        return
    c.unbalanced += made
    k = most_by_jump(e, x)
    note_violation(e, e.mode, e.t, CREATED, k, made, size)


def between(e: Engine) -> float:
    """Return the energy that sources may have given beside what they give by their last values.

    One that follows what the jump moves has had all values from the one before, while its impulse
    lasted.
    """
    m = e.model
    total = 0.0
    for k in range(m.givers):
        if m.giver_follows[k] == 0:
            continue
        own = m.bond_slot + m.giver_own[k]
        moved = math.fabs(e.impulses[m.giver_other[k]] * (e.v[own] - e.pre[own]))
        total += moved if math.isfinite(moved) else 0.0
    return total


def most_by_jump(e: Engine, x: Floats) -> int:
    """Return the storage into which the jump has brought most energy."""
    m = e.model
    co_energy(m, with_stored(e, e.trial.x), e.checks.rate)
    most = -math.inf
    found = 0
    for k in range(m.storages):
        moved = e.checks.rate[k] * (e.trial.x[k] - x[k])
        if m.storage_pseudo[k] == 0 and moved > most:
            most = moved
            found = k
    return found


def jump_may_create(e: Engine) -> bool:
    """Whether a law that is declared for impacts may create energy in the jump of the trial.

    One that reads ``pre()``; of the contacts that are struck, friction of an impact, restitution
    that varies or is above one.
    """
    m = e.model
    may = e.trial.factors > 0 or is_fieldless(e, e.mode)
    for k in range(m.ports):
        varies = m.port_restitution[k] >= 0 or m.port_limit[k] >= 0
        declared = varies or m.port_restitution_constant[k] > 1.0
        may = may or (declared and carries_impulse(e, k))
    return may


def carries_impulse(e: Engine, k: int) -> bool:
    """Whether law `k` has an impulse in the jump of the trial: what it carries, or what it takes.

    A body that is struck elsewhere hands impulses on through its junction, and friction there may
    have none.
    """
    return impulse_of(e, k, 0, ROUNDED) != 0.0 or impulse_of(e, k, 1, ROUNDED) != 0.0
