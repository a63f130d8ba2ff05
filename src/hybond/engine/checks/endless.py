"""Storage whose law has left the numbers: its rates may still be some, and nobody would be told."""

from __future__ import annotations

import math

from hybond.engine.answers import stored_name, value
from hybond.engine.engine import Engine, say_fault


def is_endless(e: Engine) -> bool:
    """Refuse a motion in which what is stored has an infinite effort or flow; whether that is so.

    A law may have no value at zero, as a logarithm: what is empty is not looked at.
    """
    m = e.model
    shown = False
    for k in range(m.storages):
        if m.co_energy[k] < 0 or e.y[k] == 0.0:
            continue
        if not shown:
            for i in range(m.storages):
                e.v[m.stored_slot + i] = e.y[i]
            shown = True
        given = value(m, m.co_energy[k], e.v)
        if math.fabs(given) == math.inf:
            say_fault(
                e, "HB-N203", "what it stores makes no finite effort or flow", stored_name(m, k)
            )
            return True
    return False
