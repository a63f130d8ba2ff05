"""Gaps of closed contacts, held against zero as the motion goes on.

Whether a gap is the distance that its bonds close is asked once. Behind a kink it may be another: a
floor that begins to slope. Then a contact that is closed goes apart, or comes to overlap, and what
it is made of is asked again.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.laws.gaps import NO_GAP, check_gaps
from hybond.engine.laws.law_instant import evaluate_gap, is_on
from hybond.engine.laws.ports import open_mode, ports_of
from hybond.engine.methods.stepping import between
from hybond.engine.surfaces.values import set_state, set_values
from hybond.engine.words import Floats

APART: Final = 1e-6
"""Part of its terms, and of the largest in the run, up to which a closed gap is that by error."""
HALVINGS: Final = 60
"""Of a step: then its halves are no numbers between."""
EVEN: Final = 0.25
"""Part by which a gap may move more in one half of a time than in the other, and moves evenly."""


def hold_gaps(e: Engine, v: Floats) -> int:
    """Refuse a closed contact that is apart, or overlaps, as its gap moves otherwise: HB-M205.

    `v` are the values at the present instant, in the mode `e.mode`. It is asked there, and where in
    the step the gap moved: a floor that falls away within a step is level again at its end.
    """
    m = e.model
    r = e.laws
    asked = False
    led = e.step.t0 < e.t and e.t <= e.step.t1
    for k in range(m.ports):
        if m.port_gap_rate[k] == NO_GAP or m.port_gap_pair[k] < 0:
            continue
        if not is_on(m, k, e.state[m.port_machine[k]]) or not is_farther(e, k, v):
            continue
        if not asked and ask(e, e.t, e.y) != OK:
            return REFUSED
        asked = True
        if led and ask(e, where_it_moved(e, k), r.kept_state) != OK:
            return REFUSED
    return OK


def is_farther(e: Engine, k: int, v: Floats) -> bool:
    """Whether the gap of port k is farther from zero than by the error that it was known to have.

    What is apart by error is so a few times, as that grows.
    """
    r = e.laws
    gap = math.fabs(value(e.model, e.model.port_gap[k], v))
    if not (gap > r.furthest[k] and gap < math.inf):
        return False
    evaluate_gap(e, r, k, v)
    if not gap > APART * max(r.largest[k], e.work.stack.size[e.work.stack.top]):
        return False
    r.furthest[k] = 2.0 * gap
    return True


def where_it_moved(e: Engine, k: int) -> float:
    """Return where in the last step the gap of port k moved most; the state is in `kept_state`."""
    low = e.step.t0
    high = e.t
    first = gap_at(e, k, low)
    last = gap_at(e, k, high)
    middle = high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        there = gap_at(e, k, middle)
        before = math.fabs(there - first)
        after = math.fabs(last - there)
        if math.fabs(after - before) <= EVEN * (before + after):
            break
        if before > after:
            high = middle
            last = there
        else:
            low = middle
            first = there
    return middle


def gap_at(e: Engine, k: int, t: float) -> float:
    """Return the gap of port k at a time of the last step, whose state is put in `kept_state`."""
    m = e.model
    r = e.laws
    between(e, t, r.kept_state)
    set_state(e, e.mode, r.v, t, r.kept_state)
    return value(m, m.port_gap[k], r.v)


def ask(e: Engine, t: float, y: Floats) -> int:
    """Ask in a state whether gaps move as their bonds close."""
    m = e.model
    r = e.laws
    r.answered = False
    if ports_of(e, r, e.state) != OK:
        return OK
    copy_part(m.integrals, y, m.storages, r.s, 0)
    copy_floats(m.storages, y, r.kept_state)
    set_values(e, open_mode(e, r.now), r.v, t, r.kept_state, r.s)
    for k in range(2 * m.bonds):
        r.v[m.bond_slot + k] = 0.0
    energy = e.energy
    copy_floats(e.parts, e.part_energy, r.kept_energy)
    found = check_gaps(e, r, r.kept_state)
    e.energy = energy
    copy_floats(e.parts, r.kept_energy, e.part_energy)
    if found != OK:
        e.fault.t = t
    return found
