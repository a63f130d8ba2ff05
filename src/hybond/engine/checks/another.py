"""Whether laws have another solution than the one that the motion came along.

A comparator that is fed back, written as a steep ``tanh``, has three: which of them holds is not a
matter of the laws, and what is read of a run, where Newton's method begins anew, may be another one
than that by which it moved.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.nonlinear.newton_system import measured_system
from hybond.engine.mode.nonlinear.put_back import HOLDS, all_hold
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.reasons.noting import MANY, note_violation
from hybond.engine.surfaces.values import evaluate

APART: Final = 1e-3
"""How far apart two solutions are, as a part of the largest variable of the kind: less may be what
Newton's method leaves where a law is flat."""

BETWEEN: Final = 0.3
"""Where between two solutions laws are asked."""


def look_for_another(e: Engine, mode: Mode) -> None:
    """Solve once more, from zero, and note laws by which what is stored would move otherwise.

    Where the laws leave something open, that is told elsewhere; of several solutions that move
    nothing any may be read.
    """
    m = e.model
    c = e.checks
    if not mode.regular:
        return
    for k in range(2 * m.slots):
        c.other[k] = 0.0
    for k in range(m.switches + m.state_first[m.machines]):
        c.other[m.on_slot + k] = mode.flags[k]
    hold_guess(e, mode)
    mode.guessed = False
    found = evaluate(e, mode, c.other, e.t, e.y)
    give_back_guess(e, mode)
    if found != OK or not mode.regular:
        return
    off = 0.0
    size = 0.0
    for k in range(m.storages):
        b = rate_bond(m, k)
        apart = math.fabs(c.other[m.bond_slot + b] - c.v[m.bond_slot + b])
        if apart > APART * c.largest[m.bond_class[b]] and apart > off:
            off = apart
            size = c.largest[m.bond_class[b]]
    if off > 0.0 and not is_one_answer(e, mode):
        note_violation(e, mode, e.t, MANY, element_of(e, mode), off, size)


def is_one_answer(e: Engine, mode: Mode) -> bool:
    """Whether laws hold between the two as well: where they are flat, both are one to rounding.

    Of three that lie evenly the third is not asked.
    """
    n = 2 * e.model.bonds
    c = e.checks
    at = e.model.bond_slot
    for k in range(n):
        e.work.w[k] = c.v[at + k] + BETWEEN * (c.other[at + k] - c.v[at + k])
    return all_hold(e, measured_system(e, mode, c.other, e.work.w), HOLDS)


def element_of(e: Engine, mode: Mode) -> int:
    """Return the first element whose law is not linear in a mode."""
    m = e.model
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        for element in range(m.elements):
            if d >= 0 and m.element_node[element] == m.dynamic_node[d]:
                return element
    return 0
