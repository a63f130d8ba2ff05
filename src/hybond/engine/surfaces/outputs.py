"""Switching functions that read what can jump: bond variables that no storage stands behind.

All modes around must give them one value; how fast those bond variables move along a mode's field
is found by differences.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import AT_KINK, CANCELS
from hybond.engine.answers import value
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.reads import (
    READS_BOND,
    READS_INPUT,
    READS_SIGNAL,
    READS_STORED,
    READS_TIME,
)
from hybond.engine.surfaces.surface import part_mode, surface_slope
from hybond.engine.words import Floats, float_table

AGREES: Final = 1e-9
"""Parts give a switching function one value up to this part of what it reads."""
POINTS: Final = 3
STENCIL: Final = float_table(0.75, -0.15, 1.0 / 60.0)
"""Central difference of order six: factors of what lies 1, 2, 3 steps ahead."""
BESIDE: Final = float_table(-2.45, 6.0, -7.5, 20.0 / 3.0, -3.75, 1.2, -1.0 / 6.0)
"""The same to one side: factors of what lies 0 to 6 steps ahead."""
STEP: Final = 1e-3
"""The step, as a part of the time in which a state is another."""
HALVED: Final = 30
"""Times that it is halved to lie between two kinks."""


def show_state(e: Engine, t: float, y: Floats, v: Floats) -> None:
    """Write time and state, as the combination asks for."""
    m = e.model
    set_time(e, v, t)
    for k in range(m.slots):
        v[m.slots + k] = 0.0
    copy_part(m.storages, y, 0, v, m.stored_slot)
    copy_part(m.integrals, y, m.storages, v, m.signal_slot)


def solve_plain(e: Engine, part: int, v: Floats) -> int:
    """Write the Booleans and bond variables of a part, not kept to what others hold."""
    m = e.model
    mode = part_mode(e, part)
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, v, m.on_slot)
    put_limits(e, mode, v)
    return solve(e, mode, v)


def output_value(e: Engine, surface: int, part: int, v: Floats) -> float:
    """Return a switching function as a part gives it at the values `v`, which change; or nan."""
    if solve_plain(e, part, v) != OK:
        return math.nan
    return value(e.model, e.model.surface_value[surface], v)


def output_rate(e: Engine, surface: int, v: Floats, rate: Floats, at: int) -> float:
    """Return how fast a function moves at the rates of the state in `rate`, from `at` on.

    By its own slopes, at what it reads: a carrier has kinks closer than any difference may reach.
    Only how fast bond variables move is found by differences; those of the first part stand for
    those of all.
    """
    m = e.model
    s = e.slide
    if put_ahead(e, v, rate, at, 0.0) != OK:
        return math.nan
    first = m.surface_first[surface]
    for i in range(first, m.surface_first[surface + 1]):
        s.read_slope[i - first] = surface_slope(m, i, s.ahead)
    for p in range(m.kinks):
        atom = m.kink_atom + p
        size = math.fabs(value(m, m.atom_size[atom], s.ahead))
        there = value(m, m.atom_value[atom], s.ahead)
        # on which side of one that stays at zero it is, is rounding
        s.kink_at[p] = there if math.fabs(there) > AT_KINK * size else 0.0
    total = 0.0
    for i in range(first, m.surface_first[surface + 1]):
        index = m.surface_index[i]
        kind = m.surface_kind[i]
        if kind == READS_STORED:
            total += s.read_slope[i - first] * rate[at + index]
        elif kind == READS_SIGNAL:
            total += s.read_slope[i - first] * rate[at + m.storages + index]
        elif kind == READS_TIME:
            total += s.read_slope[i - first]
        elif kind == READS_INPUT:
            total += s.read_slope[i - first] * v[m.input_rate_slot + index]
    by_bonds = bonds_rate(e, surface, v, rate, at)
    return total + by_bonds


def bonds_rate(e: Engine, surface: int, v: Floats, rate: Floats, at: int) -> float:
    """Return how fast a function moves by the bond variables that it reads, or nan.

    By central differences where no law or source has a kink there, else by those to one side, with
    shorter steps if there is room on none.
    """
    h = stride(e, v, rate, at)
    for _ in range(HALVED):
        total = 0.0
        same = True
        for p in range(2 * POINTS):
            way = 1.0 if p < POINTS else -1.0
            g = bonds_led(e, surface, v, rate, at, way * h * float(p % POINTS + 1))
            total += way * STENCIL[p % POINTS] * g
            same = same and is_on_side(e, False)
        if same:
            return total / h
        for side in range(2):
            way = h if side == 0 else -h
            total = 0.0
            same = True
            for p in range(2 * POINTS + 1):
                g = bonds_led(e, surface, v, rate, at, way * float(p))
                total += BESIDE[p] * g
                same = same and is_on_side(e, side == 0)
            if same:
                return total / way
        h *= 0.5
    return math.nan


def stride(e: Engine, v: Floats, rate: Floats, at: int) -> float:
    """Return the step of differences: a part of the time in which the first state is another."""
    m = e.model
    y = states_in(e, v)
    reach_of(e, part_mode(e, 0), y, e.work.reach)
    h = STEP * m.span
    for k in range(e.states):
        here = v[m.stored_slot + k if k < m.storages else m.signal_slot + k - m.storages]
        size = max(math.fabs(here), e.lately[k])
        if k < m.storages:
            size = max(size, e.work.reach[k])
        speed = math.fabs(rate[at + k])
        if size > 0.0 and speed > 0.0:
            h = min(h, STEP * size / speed)
    return h


def states_in(e: Engine, v: Floats) -> Floats:
    """Return the state that stands in `v`."""
    m = e.model
    s = e.slide
    copy_part(m.storages, v, m.stored_slot, s.put_state, 0)
    copy_part(m.integrals, v, m.signal_slot, s.put_state, m.storages)
    return s.put_state


def bonds_led(e: Engine, surface: int, v: Floats, rate: Floats, at: int, ahead: float) -> float:
    """Return what bond variables give to a function a time ahead, by its slopes here; or nan."""
    m = e.model
    s = e.slide
    if put_ahead(e, v, rate, at, ahead) != OK:
        return math.nan
    first = m.surface_first[surface]
    total = 0.0
    for i in range(first, m.surface_first[surface + 1]):
        if m.surface_kind[i] == READS_BOND:
            total += s.read_slope[i - first] * s.ahead[m.bond_slot + m.surface_index[i]]
    return total


def put_ahead(e: Engine, v: Floats, rate: Floats, at: int, ahead: float) -> int:
    """Put the values of the first part a time ahead there, at such rates of the state."""
    m = e.model
    s = e.slide
    copy_floats(2 * m.slots, v, s.ahead)
    set_time(e, s.ahead, v[0] + ahead)
    for k in range(e.states):
        slot = m.stored_slot + k if k < m.storages else m.signal_slot + k - m.storages
        s.ahead[slot] = v[slot] + ahead * rate[at + k]
    return solve_plain(e, 0, s.ahead)


def is_on_side(e: Engine, onwards: bool) -> bool:
    """Whether no law, source or rate has passed a kink at the values in ``ahead``.

    Away from one that is just there the motion goes `onwards`, whatever was before.
    """
    m = e.model
    s = e.slide
    for p in range(m.kinks):
        atom = m.kink_atom + p
        there = value(m, m.atom_value[atom], s.ahead)
        if s.kink_at[p] * there < 0.0:
            return False
        if s.kink_at[p] == 0.0 and there != 0.0 and not onwards:
            if math.fabs(there) > AT_KINK * math.fabs(value(m, m.atom_size[atom], s.ahead)):
                return False
    return True


def find_agreeing(e: Engine) -> int:
    """Find for each side whether all parts give its function one value, into `agrees`."""
    m = e.model
    s = e.slide
    for j in range(s.k):
        s.agrees[j] = 1
        if s.of_state[j] != 0:
            continue
        surface = s.side[j]
        least = math.inf
        most = -math.inf
        size = 0.0
        largest = 0.0
        beside = 0.0
        for part in range(s.parts):
            copy_floats(2 * m.slots, e.shown, s.ahead)
            g = output_value(e, surface, part, s.ahead)
            if not math.isfinite(g):
                return NOT_FINITE
            least = min(least, g)
            most = max(most, g)
            largest = max(largest, math.fabs(g))
            for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
                if m.surface_kind[i] == READS_BOND:
                    size = max(size, math.fabs(s.ahead[m.bond_slot + m.surface_index[i]]))
                    beside = max(beside, solved_beside(e, part, m.surface_index[i], s.ahead))
        rounding = AGREES * (size + largest) + CANCELS * beside
        s.agrees[j] = 1 if most - least <= rounding else 0
    return OK


def solved_beside(e: Engine, part: int, b: int, v: Floats) -> float:
    """Return the largest of the efforts, or flows, that Newton's method has found together.

    A small one has the rounding of those: the output of a filter that has only just begun.
    """
    m = e.model
    if part_mode(e, part).dynamics == 0:
        return 0.0
    first = m.bond_slot + (0 if b < m.bonds else m.bonds)
    most = 0.0
    for k in range(m.bonds):
        most = max(most, math.fabs(v[first + k]))
    return most
