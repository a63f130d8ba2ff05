"""What is left of an approach, where what drove it ends at the instant of the impact.

Newton's law reads the approach *before* the instant. Where a machine beside the contact switches
at that instant, or a source jumps back, a part of it may be gone with what brought it about: there
is nothing left of that to throw back, and ``eps`` times it would be energy from nowhere. What
rebounds is a part of the approach that the mode which is entered goes on with, if that is less. Of
one that a source makes larger at the instant nothing more is given back (`jumped_onto`).
"""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.laws.law_instant import NO_LAW_VALUE, is_stored
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import partner_row, partner_way
from hybond.engine.mode.rows.tableau import COMMON

LEFT: Final = 1e-6
"""Part of an approach by which less is left of it, beyond what rounding and storage that is not
linear leave open."""


def leave_approaches(e: Engine, r: Laws) -> None:
    """Let ``pre()`` in the jump of the trial read what is left of the approach of contacts.

    That is put on one bond of each, for as long as the jump is looked for. `r.gone` is by how much
    it is less; `r.y` how contacts approach in the mode that is entered.
    """
    m = e.model
    for k in range(m.ports):
        r.gone[k] = 0.0
        if m.port_restitution[k] == NO_LAW_VALUE or r.now.given[k] != COMMON or r.able[k] == 0:
            continue
        row = partner_row(r.now, k)
        way = partner_way(r.now, k)
        first = m.pair_first[row]
        if first == m.pair_first[row + 1] or not is_stored(m, r, k):
            continue
        before = 0.0
        for i in range(first, m.pair_first[row + 1]):
            before += way * m.pair_value[i] * e.pre[m.bond_slot + m.pair_column[i]]
        gone = min(r.y[k], 0.0) - before
        if before < 0.0 and gone > -LEFT * before:
            r.gone[k] = gone
            at = m.slots + m.bond_slot + m.pair_column[first]
            e.v[at] += gone / (way * m.pair_value[first])
