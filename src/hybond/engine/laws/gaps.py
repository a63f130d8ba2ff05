"""Whether the gap of a contact is the distance that its bonds close.

The law of a contact acts on velocities, its gap is a signal that the modeller wrote. If the gap
does not open at the speed at which the bonds separate, the contact closes at the wrong place, or
never. The two are compared at velocities of no meaning, always the same ones. Where a modulated
two-port ties storages together, velocities that it allows are made of them by a jump.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import node_name, value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import open_mode, solve_with
from hybond.engine.laws.response import size_of_terms
from hybond.engine.mode.mode_records import Mode
from hybond.engine.model import Model
from hybond.engine.reasons.facts import add_fact
from hybond.engine.words import Floats

PROBES: Final = 3
"""Velocities at which the two speeds are compared."""
GAP_APART: Final = 1e-6
"""Part of the larger of them by which they may differ."""
GAP_ROUNDED: Final = 1e-12
"""Part of the terms of a speed that is rounding of it."""
NO_GAP: Final = -2
"""What stands for a gap that is none, or that is constant: its sides touch at all times."""
LEHMER: Final = 16807.0
MERSENNE: Final = 2147483647.0
"""The generator of Park and Miller: numbers without pattern, the same wherever they are made."""


def check_gaps(e: Engine, r: Laws, x: Floats) -> int:
    """Refuse a gap that does not change as fast as the bonds of its contact say: HB-M205.

    `r.now` are the ports of the mode, `r.v` and `x` values and state there. What a jump leaves is
    lost: impulses, `e.moved`, the state `r.x`.
    """
    m = e.model
    if not has_gaps(m):
        return OK
    mode = open_mode(e, r.now)
    seed = 1.0
    found = OK
    for _ in range(PROBES):
        copy_floats(2 * m.slots, r.v, r.later)
        for k in range(m.storages):
            seed = math.fmod(LEHMER * seed, MERSENNE)
            r.moved[k] = x[k]
            if m.storage_kind[k] == 1:
                r.moved[k] += max(math.fabs(x[k]), 1.0) * (2.0 * seed / MERSENNE - 1.0)
        for k in range(m.ports):
            seed = math.fmod(LEHMER * seed, MERSENNE)
            r.l[k] = 2.0 * seed / MERSENNE - 1.0
        mode.guessed = False
        if found != OK:
            break
        # where laws have no value there is nothing to compare
        if allow(e, r, mode) == OK and solve_with(e, r.now, r.later, r.l) == OK:
            found = compare_gaps(e, mode, e.work.w, r.later)
    mode.guessed = False
    return found


def allow(e: Engine, r: Laws, mode: Mode) -> int:
    """Put the state `r.moved`, or what a modulated structure allows of it, among `r.later`."""
    m = e.model
    found = OK
    copy_floats(m.storages, r.moved, r.x)
    if mode.dynamics != 0:
        copy_part(m.storages, r.moved, 0, r.later, m.stored_slot)
        for k in range(m.ports):
            mode.source_level[r.now.column[k]] = r.now.sign[k] * r.l[k]
        found = enter_mode(e, mode, r.later, r.moved, r.x)
        for k in range(m.ports):
            mode.source_level[r.now.column[k]] = 0.0
    copy_part(m.storages, r.x, 0, r.later, m.stored_slot)
    return found


def has_gaps(m: Model) -> bool:
    """Whether any contact has a gap that may change."""
    found = False
    for k in range(m.ports):
        found = found or m.port_gap_rate[k] != NO_GAP
    return found


def compare_gaps(e: Engine, mode: Mode, w: Floats, v: Floats) -> int:
    """Compare how fast gaps open with how fast their contacts close, at values `v`.

    Two points of one body have no speed apart but what rounding leaves of it.
    """
    m = e.model
    for k in range(m.ports):
        if m.port_gap_rate[k] == NO_GAP:
            continue
        law = m.port_gap_rate[k]
        opening = m.port_gap_rate_constant[k] if law < 0 else value(m, law, v)
        closing = 0.0
        terms = 0.0
        for i in range(m.pair_first[2 * k + 1], m.pair_first[2 * k + 2]):
            closing += m.pair_value[i] * w[m.pair_column[i]]
            terms += math.fabs(m.pair_value[i]) * size_of_terms(e, mode, m.pair_column[i])
        most = max(math.fabs(opening), math.fabs(closing))
        apart = math.fabs(opening + closing)
        if math.isfinite(most) and apart > GAP_APART * most and apart > GAP_ROUNDED * terms:
            why = "the gap of a contact is not the distance that its bonds close"
            say_fault(e, "HB-M205", why, node_name(m, m.port_node[k]))
            if m.tells != 0:
                add_fact(e.fault, float(k))
                add_fact(e.fault, opening)
                add_fact(e.fault, closing)
            return REFUSED
    return OK
