"""Switching functions that read what can jump: bond variables that no storage stands behind.

All modes around must give them one value; how fast they move along a mode's field is found by
differences.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.answers import value
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.reads import READS_BOND
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Floats, float_table

AGREES: Final = 1e-9
"""Parts give a switching function one value up to this part of what it reads."""
POINTS: Final = 3
STENCIL: Final = float_table(0.75, -0.15, 1.0 / 60.0)
"""Central difference of order six: factors of what lies 1, 2, 3 steps ahead."""
BESIDE: Final = float_table(-2.45, 6.0, -7.5, 20.0 / 3.0, -3.75, 1.2, -1.0 / 6.0)
"""The same to one side: factors of what lies 0 to 6 steps ahead."""
STEP: Final = 1e-3
"""The step, as a part of the state."""
HALVED: Final = 30
"""Times that it is halved to lie between two jumps."""


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

    Bond variables of the first part stand for those of all.
    """
    m = e.model
    n = e.states
    speed = 0.0
    size = 0.0
    for k in range(n):
        speed += rate[at + k] * rate[at + k]
        here = v[m.stored_slot + k if k < m.storages else m.signal_slot + k - m.storages]
        size += here * here
    h = STEP
    if speed > 0.0:
        h = STEP * (math.sqrt(size) if size > 0.0 else 1.0) / math.sqrt(speed)
    if m.surface_jump_first[surface] < m.surface_jump_first[surface + 1]:
        return rate_beside_jumps(e, surface, v, rate, at, h)
    total = 0.0
    for p in range(2 * POINTS):
        way = 1.0 if p < POINTS else -1.0
        g = led_value(e, surface, v, rate, at, way * h * float(p % POINTS + 1))
        total += way * STENCIL[p % POINTS] * g
    return total / h


def led_value(e: Engine, surface: int, v: Floats, rate: Floats, at: int, ahead: float) -> float:
    """Return a switching function a time ahead at such rates of the state, values in ``ahead``."""
    m = e.model
    s = e.slide
    copy_floats(2 * m.slots, v, s.ahead)
    set_time(e, s.ahead, v[0] + ahead)
    for k in range(e.states):
        slot = m.stored_slot + k if k < m.storages else m.signal_slot + k - m.storages
        s.ahead[slot] = v[slot] + ahead * rate[at + k]
    return output_value(e, surface, 0, s.ahead)


def rate_beside_jumps(e: Engine, surface: int, v: Floats, rate: Floats, at: int, h: float) -> float:
    """Return how fast a function moves that may jump next to there, by what is on this side of it.

    By differences to one side where there is room, with shorter steps if there is on none.
    """
    m = e.model
    s = e.slide
    first = m.surface_jump_first[surface]
    here = led_value(e, surface, v, rate, at, 0.0)
    for p in range(first, m.surface_jump_first[surface + 1]):
        s.jump_at[p] = value(m, m.atom_value[m.kink_atom + m.surface_jump[p]], s.ahead)
    for _ in range(HALVED):
        for side in range(2):
            way = h if side == 0 else -h
            total = BESIDE[0] * here
            same = True
            for p in range(1, 2 * POINTS + 1):
                g = led_value(e, surface, v, rate, at, way * float(p))
                total += BESIDE[p] * g
                same = same and is_on_side(e, surface)
            if same:
                return total / way
        h *= 0.5
    return math.nan


def is_on_side(e: Engine, surface: int) -> bool:
    """Whether nothing at which a function may jump has another sign at the values in ``ahead``."""
    m = e.model
    s = e.slide
    for p in range(m.surface_jump_first[surface], m.surface_jump_first[surface + 1]):
        there = value(m, m.atom_value[m.kink_atom + m.surface_jump[p]], s.ahead)
        if s.jump_at[p] * there < 0.0:
            return False
    return True


def find_agreeing(e: Engine) -> int:
    """Find for each side whether all parts give its function one value, into `agrees`.

    Where they do not, `own_jump` says whether its own machine makes it jump.
    """
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
        s.own_jump[j] = 0
        first = 0.0
        for part in range(s.parts):
            copy_floats(2 * m.slots, e.shown, s.ahead)
            g = output_value(e, surface, part, s.ahead)
            if part == 0:
                first = g
            elif part == j + 1 and math.fabs(g - first) > AGREES * math.fabs(first):
                s.own_jump[j] = 1
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
