"""Sources that prescribe one variable: whether they agree."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import node_name
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton import knowns_of
from hybond.engine.reasons.facts import disagree
from hybond.engine.words import Floats

AGREE: Final = 1e-9
"""Contradicting sources agree if they differ by less than this part of their values."""


def check_agreement(e: Engine, mode: Mode, v: Floats) -> int:
    """Refuse sources that prescribe one variable differently."""
    m = e.model
    knowns_of(e, mode, v, False)
    for r in range(mode.agreements.rows):
        total = 0.0
        size = 0.0
        place = -1
        for i in range(mode.agreements.first.at[r], mode.agreements.first.at[r + 1]):
            at = mode.agreements.column.at[i]
            term = mode.agreements.value.at[i] * e.work.xi[at]
            total += term
            size += math.fabs(term)
            source = mode.source[at - m.storages]
            if source >= 0:
                place = m.source_node[source]
        if math.fabs(total) <= AGREE * size:
            continue
        why = "sources prescribe the same variable and differ"
        if m.tells != 0:
            disagree(e, mode, r, total, why)
        else:
            say_fault(e, "HB-C101", why, node_name(m, place) if place >= 0 else "")
        # a step may have come to where they differ: what is said is so then
        e.fault.t = v[0]
        return REFUSED
    return OK
