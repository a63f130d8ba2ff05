"""Switching functions: their values and how fast they move.

Efforts of C and flows of I stand for what is stored, along the junctions that are ON in all modes
concerned; then a function is one of state and time alone, the same in every mode.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import co_energy, stiff
from hybond.engine.model import Model
from hybond.engine.surfaces.reads import (
    READS_BOND,
    READS_INPUT,
    READS_SIGNAL,
    READS_STORED,
    READS_SWITCH,
    READS_TIME,
)
from hybond.engine.words import Floats, some

NO_STORAGE: Final = -1


def part_mode(e: Engine, k: int) -> Mode:
    """Return the mode of part k of the combination."""
    return some(e.modes[e.slide.part[k]])


def is_joined(e: Engine, switch: int) -> bool:
    """Whether a switch is ON in all parts; -1 is none."""
    if switch < 0:
        return True
    for k in range(e.slide.parts):
        if part_mode(e, k).on[switch] == 0:
            return False
    return True


def storage_behind(e: Engine, column: int) -> int:
    """Return the storage that gives a bond variable its value in all parts, or NO_STORAGE."""
    m = e.model
    s = e.slide
    flow = column >= m.bonds
    for b in range(m.bonds):
        s.seen[b] = 0
    s.number[0] = column - m.bonds if flow else column
    s.seen[s.number[0]] = 1
    left = 1
    while left > 0:
        left -= 1
        bond = s.number[left]
        for k in range(m.storages):
            if m.storage_bond[k] == bond and (m.storage_kind[k] == 1) == flow:
                return k
        for j in range(m.junctions):
            if (m.junction_kind[j] == 1) != flow or not is_joined(e, m.junction_switch[j]):
                continue
            touches = False
            for i in range(m.end_first[j], m.end_first[j + 1]):
                touches = touches or m.end_bond[i] == bond
            if not touches:
                continue
            for i in range(m.end_first[j], m.end_first[j + 1]):
                if s.seen[m.end_bond[i]] == 0:
                    s.seen[m.end_bond[i]] = 1
                    s.number[left] = m.end_bond[i]
                    left += 1
    return NO_STORAGE


def is_of_state(e: Engine, surface: int) -> bool:
    """Whether a switching function reads nothing that can jump."""
    m = e.model
    for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
        index = m.surface_index[i]
        if m.surface_kind[i] == READS_BOND and storage_behind(e, index) == NO_STORAGE:
            return False
        if m.surface_kind[i] != READS_SWITCH:
            continue
        for part in range(1, e.slide.parts):
            here = part_mode(e, part)
            if here.flags[index] != part_mode(e, 0).flags[index]:
                return False
    return True


def put_read(e: Engine, surface: int, v: Floats) -> None:
    """Write the bond variables that a function reads, by what is stored."""
    m = e.model
    z = e.work.here
    co_energy(m, v, z)
    for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
        if m.surface_kind[i] == READS_BOND:
            k = storage_behind(e, m.surface_index[i])
            if k != NO_STORAGE:
                way = float(m.storage_sign[k]) if m.storage_kind[k] == 1 else 1.0
                v[m.bond_slot + m.surface_index[i]] = way * z[k]


def surface_value(e: Engine, surface: int, v: Floats) -> float:
    """Return a switching function at the time and state in `v`, whose bond variables change."""
    put_read(e, surface, v)
    return value(e.model, e.model.surface_value[surface], v)


def surface_slope(m: Model, i: int, v: Floats) -> float:
    """Return entry i of the slopes of switching functions."""
    return m.surface_constant[i] if m.surface_slope[i] < 0 else value(m, m.surface_slope[i], v)


def surface_rate(e: Engine, surface: int, v: Floats, rate: Floats, at: int, timed: bool) -> float:
    """Return how fast a function moves at the rates of the state in `rate`, from `at` on.

    The bond variables that it reads are in `v`; without `timed`, time stands still.
    """
    m = e.model
    total = 0.0
    for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
        slope = surface_slope(m, i, v)
        index = m.surface_index[i]
        kind = m.surface_kind[i]
        if kind == READS_STORED:
            total += slope * rate[at + index]
        elif kind == READS_SIGNAL:
            total += slope * rate[at + m.storages + index]
        elif kind == READS_TIME:
            total += slope if timed else 0.0
        elif kind == READS_INPUT:
            total += slope * v[m.input_rate_slot + index] if timed else 0.0
        elif kind == READS_BOND:
            k = storage_behind(e, index)
            way = float(m.storage_sign[k]) if m.storage_kind[k] == 1 else 1.0
            for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
                total += slope * way * stiff(m, p, v) * rate[at + m.stiff_other[p]]
    return total
