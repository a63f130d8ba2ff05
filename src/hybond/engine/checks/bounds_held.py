"""Values that outgrow all bounds: a run that has them ends, whether or not a step reads them.

A step evaluates what rates read and no more. What a storage gives to a source alone, by a law that
grows like ``sinh``, overflows without a trace in it. Such laws are asked at the end of each step;
all values are looked at where laws are.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.mode.rows.storage import co_energy_of
from hybond.engine.mode.rows.storage_bonds import co_energy_bond
from hybond.engine.reasons.facts import add_fact

MOST: Final = 1e150
"""The square of more is no number any more, and so has no energy."""


def hold_bounds(e: Engine) -> int:
    """Refuse the present state of a motion where a value is beyond all bounds."""
    m = e.model
    c = e.checks
    if c.unbounded >= 0:
        return beyond(e, c.unbounded, c.v[m.bond_slot + c.unbounded])
    if e.slide.k > 0:
        return OK
    shown = False
    for k in range(m.storages):
        if m.co_energy[k] < 0 or e.mode.rates.stored[k] != 0:
            continue
        for i in range(0 if shown else m.storages):
            c.v[m.stored_slot + i] = e.y[i]
        shown = True
        level = co_energy_of(m, k, c.v)
        if not math.fabs(level) <= MOST:
            at = co_energy_bond(m, k)
            return beyond(e, at, level)
    return OK


def beyond(e: Engine, k: int, level: float) -> int:
    """Refuse bond variable k, which has that value."""
    say_fault(e, "HB-N203", "a value is beyond all bounds", "")
    if e.model.tells != 0:
        add_fact(e.fault, float(k))
        add_fact(e.fault, level)
    return REFUSED
