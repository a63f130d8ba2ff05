"""Comparisons that are sums of the state and of time, and so polynomials within a step.

Nothing has to be evaluated to know them anywhere in a step: what is asked of a mode is taken once
when its guards begin to be watched, a row of factors for each comparison.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    Rows,
    fit,
    fit_places,
    grow_block,
    grow_places,
    make_block,
    make_places,
)
from hybond.engine.engine import Engine
from hybond.engine.inputs.interval import CALLED, FREE, take_line
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.sizes import STORED
from hybond.engine.words import record

TERMS: Final = 5
"""Coefficients of a polynomial within a step."""


@record
class Sums:
    """The comparisons that are watched, as sums; and in the last step, as polynomials.

    Comparison a is ``level[a] + drift[a] t`` and a row of factors of the state.
    """

    known: Places
    """Of each comparison: whether it is such a sum."""
    level: Block
    drift: Block
    seen: Block
    """What a unit of energy could make of it; where junctions have laws rounding is of that."""
    entries: int
    first: Places
    column: Places
    factor: Block
    size: Block
    """What rounding of each factor is measured by."""
    step: Block
    """The coefficients of ``x^0 ... x^4`` in the last step, as of its dense output."""
    extent: Block
    """What the magnitudes of its terms add up to there."""
    sign: Places
    """The sign that it has all over the step; 0 where it may be zero."""


def make_sums() -> Sums:
    """Return no sums."""
    s = Sums()
    s.known = make_places(1)
    s.level = make_block(1)
    s.drift = make_block(1)
    s.seen = make_block(1)
    s.first = make_places(2)
    s.column = make_places(1)
    s.factor = make_block(1)
    s.size = make_block(1)
    s.step = make_block(1)
    s.extent = make_block(1)
    s.sign = make_places(1)
    return s


def begin_sums(s: Sums, atoms: int) -> None:
    """Begin to take so many comparisons."""
    fit_places(s.known, atoms)
    fit(s.level, atoms)
    fit(s.drift, atoms)
    fit(s.seen, atoms)
    fit_places(s.first, atoms + 1)
    fit(s.step, TERMS * atoms)
    fit(s.extent, atoms)
    fit_places(s.sign, atoms)
    s.entries = 0


def take_sum(e: Engine, s: Sums, a: int, atom: int) -> None:
    """Take comparison `atom` of the model as number a, in the present mode and interval."""
    m = e.model
    s.first.at[a] = s.entries
    s.known.at[a] = 0
    s.level.at[a] = m.atom_level[atom] if atom >= 0 else 0.0
    s.drift.at[a] = 0.0
    s.seen.at[a] = 0.0
    known = atom >= 0
    if known:
        for p in range(m.term_first[atom], m.term_first[atom + 1]):
            known = known and take_term(e, s, a, m.term_slot[p], m.term_factor[p])
    s.known.at[a] = 1 if known else 0
    s.first.at[a + 1] = s.entries


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
        add_entry(s, m.storages + slot - m.signal_slot, factor, math.fabs(factor))
    elif slot < m.bond_slot:
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
        s.seen.at[a] += math.fabs(factor) * mode.seen[b]
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
    for p in range(rows.first.at[k], rows.first.at[k + 1]):
        known = rows.column.at[p]
        weight = factor * rows.value.at[p]
        size = measured * rows.size.at[p] if measured > 0.0 else 0.0
        source = known - m.storages
        if known < m.storages:
            if m.co_energy[known] >= 0:
                return False
            for i in range(m.stiff_first[known], m.stiff_first[known + 1]):
                stiff = m.stiff_constant[i]
                add_entry(s, m.stiff_other[i], weight * stiff, size * math.fabs(stiff))
        elif source >= mode.sources:
            if mode.rated[source - mode.sources] != 0:
                return False
        elif is_level(e, mode, source):
            s.level.at[a] += weight * mode.source_level[source]
        else:
            return False
    return True


def is_level(e: Engine, mode: Mode, source: int) -> bool:
    """Whether a source of a mode has a constant value."""
    law = mode.source[source]
    return law < 0 or e.model.source_value[law] < 0


def add_entry(s: Sums, column: int, factor: float, size: float) -> None:
    """Add a state with its factor to the sum that is being taken."""
    grow_places(s.column, s.entries + 1)
    grow_block(s.factor, s.entries + 1)
    grow_block(s.size, s.entries + 1)
    s.column.at[s.entries] = column
    s.factor.at[s.entries] = factor
    s.size.at[s.entries] = size
    s.entries += 1


def take_step(e: Engine, s: Sums, atoms: int) -> None:
    """Put all sums there as polynomials of the last step."""
    reach = STORED * math.sqrt(e.energy) if e.model.laws > 0 else 0.0
    for a in range(atoms):
        if s.known.at[a] != 0:
            put_polynomial(e, s, a, reach)


def put_polynomial(e: Engine, s: Sums, a: int, reach: float) -> None:
    """Put the coefficients of a sum in the last step there, and the size of its terms."""
    step = e.step
    n = e.states
    at = TERMS * a
    h = step.t1 - step.t0
    c0 = s.level.at[a] + s.drift.at[a] * step.t0
    c1 = s.drift.at[a] * h
    c2 = 0.0
    c3 = 0.0
    c4 = 0.0
    extent = math.fabs(s.level.at[a]) + math.fabs(s.drift.at[a] * step.t1) + reach * s.seen.at[a]
    for p in range(s.first.at[a], s.first.at[a + 1]):
        k = s.column.at[p]
        factor = s.factor.at[p]
        c0 += factor * step.y0[k]
        c1 += factor * step.dense[k]
        c2 += factor * step.dense[n + k]
        c3 += factor * step.dense[2 * n + k]
        c4 += factor * step.dense[3 * n + k]
        extent += s.size.at[p] * max(math.fabs(step.y0[k]), math.fabs(step.y1[k]))
    s.step.at[at] = c0
    s.step.at[at + 1] = c1
    s.step.at[at + 2] = c2
    s.step.at[at + 3] = c3
    s.step.at[at + 4] = c4
    s.extent.at[a] = extent
