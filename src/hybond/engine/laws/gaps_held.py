"""Gaps of closed contacts, held against zero as the motion goes on.

Whether a gap is the distance that its bonds close is asked once. Behind a kink it may be another: a
floor that begins to slope. Then a contact that is closed goes apart, or comes to overlap, and what
it is made of is asked again.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.laws.gaps import NO_GAP, check_gaps
from hybond.engine.laws.law_instant import evaluate_gap, is_on
from hybond.engine.laws.ports import open_mode, ports_of
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats

APART: Final = 1e-6
"""Part of its terms, and of the largest in the run, up to which a closed gap is that by error."""


def hold_gaps(e: Engine, v: Floats) -> int:
    """Refuse a closed contact that is apart, or overlaps, as its gap moves otherwise: HB-M205.

    `v` are the values at the present instant, in the mode `e.mode`.
    """
    m = e.model
    r = e.laws
    farther = False
    for k in range(m.ports):
        if m.port_gap_rate[k] == NO_GAP or m.port_gap_pair[k] < 0:
            continue
        if not is_on(m, k, e.state[m.port_machine[k]]):
            continue
        gap = math.fabs(value(m, m.port_gap[k], v))
        if gap > r.furthest[k] and gap < math.inf:
            evaluate_gap(e, r, k, v)
            if gap > APART * max(r.largest[k], e.work.stack.size[e.work.stack.top]):
                # what is apart by error is asked for a few times, as that grows
                r.furthest[k] = 2.0 * gap
                farther = True
    if not farther:
        return OK
    found = ask(e)
    if found != OK:
        e.fault.t = e.t
    return found


def ask(e: Engine) -> int:
    """Ask at the present state whether gaps move as their bonds close."""
    m = e.model
    r = e.laws
    r.answered = False
    if ports_of(e, r, e.state) != OK:
        return OK
    for k in range(m.storages):
        r.kept_state[k] = e.y[k]
    for k in range(m.integrals):
        r.s[k] = e.y[m.storages + k]
    set_values(e, open_mode(e, r.now), r.v, e.t, r.kept_state, r.s)
    for k in range(2 * m.bonds):
        r.v[m.bond_slot + k] = 0.0
    energy = e.energy
    for p in range(e.parts):
        r.kept_energy[p] = e.part_energy[p]
    found = check_gaps(e, r, r.kept_state)
    e.energy = energy
    for p in range(e.parts):
        e.part_energy[p] = r.kept_energy[p]
    return found
