"""Comparisons, and rates of the state, that are sums of the state and of time in a mode.

A row of factors for each of them is taken once, when time begins to pass in the mode. Neither bond
variables nor expressions have to be evaluated then to know them at any state.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import Rows
from hybond.engine.engine import Engine
from hybond.engine.inputs.calls import CALLED, FREE
from hybond.engine.inputs.interval import take_line
from hybond.engine.mode.comparisons.sum_records import (
    Sums,
    add_entry,
    add_reach,
    add_wave,
    begin_sum,
    end_sum,
    make_room,
)
from hybond.engine.mode.digits.connected import find_connected
from hybond.engine.mode.digits.part_energies import STORED, part_of_bond
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import co_energy_of, stiff


def take_sum(e: Engine, s: Sums, a: int, terms: int) -> None:
    """Take what has these terms in the model as number a, in the present mode and interval."""
    m = e.model
    begin_sum(s, a)
    known = terms >= 0
    if known:
        s.level.at[a] = m.atom_level[terms]
        for p in range(m.term_first[terms], m.term_first[terms + 1]):
            known = known and take_term(e, s, a, m.term_slot[p], m.term_factor[p])
    end_sum(s, a, known)


def take_term(e: Engine, s: Sums, a: int, slot: int, factor: float) -> bool:
    """Add a signal with its factor to a sum; False if it is no sum of the state and of time."""
    m = e.model
    if slot < 0:
        return False
    if slot == 0:
        s.drift.at[a] += factor
    elif slot < m.input_rate_slot:
        return take_input(e, s, a, slot - m.input_slot, factor)
    elif slot < m.signal_slot:
        i = slot - m.input_rate_slot
        take_line(e, i)
        s.level.at[a] += factor * e.line_rate[i]
        return m.input_kind[i] != CALLED
    elif slot < m.stored_slot:
        make_room(s, 1)
        add_entry(s, m.storages + slot - m.signal_slot, factor, math.fabs(factor))
    elif slot < m.bond_slot:
        make_room(s, 1)
        add_entry(s, slot - m.stored_slot, factor, math.fabs(factor))
    elif slot < m.on_slot:
        return take_bond(e, s, a, slot - m.bond_slot, factor)
    elif slot < m.at_slot:
        s.level.at[a] += factor * e.mode.flags[slot - m.on_slot]
    else:
        s.level.at[a] += factor * float(e.at[slot - m.at_slot])
    return True


def take_input(e: Engine, s: Sums, a: int, i: int, factor: float) -> bool:
    """Add an input, a line within the interval unless it is called."""
    if e.model.input_kind[i] == CALLED:
        return False
    if e.model.input_kind[i] == FREE:
        s.level.at[a] += factor * e.level[i]
        return True
    take_line(e, i)
    begin = e.line_value[i] - e.line_rate[i] * e.line_begin[i]
    s.level.at[a] += factor * begin
    s.drift.at[a] += factor * e.line_rate[i]
    return True


def take_bond(e: Engine, s: Sums, a: int, b: int, factor: float) -> bool:
    """Add a bond variable: a sum where neither Newton nor laws of storages have a part in it."""
    mode = e.mode
    if mode.dynamics > 0:
        for j in range(mode.finite_frees):
            if mode.finite_free.at[b * mode.finite_frees + j] != 0.0:
                return False
    if e.model.laws > 0:
        find_connected(e, mode)
        mode.seen_taken = True
        add_reach(s, a, part_of_bond(e.model, mode, b), math.fabs(factor) * mode.seen[b])
    k = mode.same[b]
    if mode.dynamics > 0 or mode.leakage.stages == 0:
        return take_row(e, s, a, mode.finite, k, factor, math.fabs(factor))
    # rounding is that of the terms before least leakage has taken anything off
    return take_row(e, s, a, mode.direct, k, factor, 0.0) and take_row(
        e, s, a, mode.finite, k, 0.0, math.fabs(factor)
    )


def take_row(
    e: Engine, s: Sums, a: int, rows: Rows, k: int, factor: float, measured: float
) -> bool:
    """Add a row of knowns with a factor, and another one for the sizes of its terms."""
    m = e.model
    mode = e.mode
    stop = rows.first.at[k + 1]
    make_room(s, stop - rows.first.at[k])
    for p in range(rows.first.at[k], stop):
        known = rows.column.at[p]
        weight = factor * rows.value.at[p]
        size = measured * rows.size.at[p] if measured > 0.0 else 0.0
        source = known - m.storages
        if known < m.storages:
            bent = m.co_energy[known] >= 0
            if bent and not s.bent:
                return False
            if bent:
                s.level.at[a] += weight * co_energy_of(m, known, e.v)
            ports = m.stiff_first[known + 1] - m.stiff_first[known]
            if ports > 1:
                make_room(s, ports + stop - p)
            for i in range(m.stiff_first[known], m.stiff_first[known + 1]):
                other = m.stiff_other[i]
                slope = stiff(m, i, e.v) if bent else m.stiff_constant[i]
                if bent and slope == 0.0:
                    return False  # it gives something as soon as that moves, but how much
                if bent:
                    s.level.at[a] -= weight * slope * e.v[m.stored_slot + other]
                more = STORED if mode.settles_with[known] >= 0 and m.laws > 0 else 1.0
                add_entry(s, other, weight * slope, more * size * math.fabs(slope))
        elif source >= mode.sources:
            if mode.rated[source - mode.sources] != 0 and not take_wave(e, s, source, weight):
                return False
        elif is_level(e, mode, source):
            s.level.at[a] += weight * mode.source_level[source]
        elif not take_wave(e, s, source, weight):
            return False
    return True


def take_wave(e: Engine, s: Sums, source: int, weight: float) -> bool:
    """Add a source, or the rate of one, that moves by a law of time alone; False for others."""
    mode = e.mode
    own = source - mode.sources if source >= mode.sources else source
    if not s.waving or e.model.source_timed[mode.source[own]] == 0:
        return False
    if weight != 0.0:
        add_wave(s, source, weight)
    return True


def is_level(e: Engine, mode: Mode, source: int) -> bool:
    """Whether a source of a mode has a constant value."""
    law = mode.source[source]
    return law < 0 or e.model.source_value[law] < 0
