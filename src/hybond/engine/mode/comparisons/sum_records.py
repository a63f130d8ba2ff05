"""Sums of the state and of time: rows of factors, taken when time begins to pass in a mode.

Beside them may stand sources that move by a law of time, where whoever takes the sums knows what to
do with these: waves.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    fit,
    fit_places,
    grow_block,
    grow_places,
    make_block,
    make_places,
)
from hybond.engine.words import record


@record
class Sums:
    """Sums: number a is ``level[a] + drift[a] t`` and a row of factors of the state."""

    known: Places
    """Whether each is such a sum."""
    level: Block
    drift: Block
    reaches: int
    reach_first: Places
    reach_part: Places
    """Of each sum: parts of the mode whose energy could make something of it; ..."""
    reach: Block
    """... what a unit of that could make: where junctions have laws rounding is of that."""
    entries: int
    first: Places
    column: Places
    factor: Block
    size: Block
    """What rounding of each factor is measured by."""
    bent: bool
    """Whether what bent storages give is taken as it is for what they hold now, by its slope."""
    waving: bool
    """Whether waves are taken, and for which sums there are any: those are not `known`."""
    waved: Places
    terms: int
    wave_first: Places
    wave_source: Places
    """Of each wave in a sum: a source of the mode, or behind all of them the rate of one."""
    wave_factor: Block


def make_sums() -> Sums:
    """Return no sums."""
    s = Sums()
    s.known = make_places(1)
    s.level = make_block(1)
    s.drift = make_block(1)
    s.reach_first = make_places(2)
    s.reach_part = make_places(1)
    s.reach = make_block(1)
    s.first = make_places(2)
    s.column = make_places(1)
    s.factor = make_block(1)
    s.size = make_block(1)
    s.waved = make_places(1)
    s.wave_first = make_places(2)
    s.wave_source = make_places(1)
    s.wave_factor = make_block(1)
    return s


def begin_sums(s: Sums, many: int) -> None:
    """Begin to take so many sums."""
    fit_places(s.known, many)
    fit(s.level, many)
    fit(s.drift, many)
    fit_places(s.first, many + 1)
    fit_places(s.waved, many)
    fit_places(s.wave_first, many + 1)
    fit_places(s.reach_first, many + 1)
    s.entries = 0
    s.terms = 0
    s.reaches = 0


def begin_as_large(s: Sums, other: Sums) -> None:
    """Make room for as many entries as other sums have."""
    fit_places(s.column, other.entries)
    fit(s.factor, other.entries)
    fit(s.size, other.entries)


def begin_sum(s: Sums, a: int) -> None:
    """Begin with sum a: nothing so far."""
    s.first.at[a] = s.entries
    s.wave_first.at[a] = s.terms
    s.level.at[a] = 0.0
    s.drift.at[a] = 0.0
    s.reach_first.at[a] = s.reaches


def end_sum(s: Sums, a: int, known: bool) -> None:
    """End sum a, if it is one."""
    waves = s.terms > s.wave_first.at[a]
    s.known.at[a] = 1 if known and not waves else 0
    s.waved.at[a] = 1 if known and waves else 0
    s.first.at[a + 1] = s.entries
    s.wave_first.at[a + 1] = s.terms
    s.reach_first.at[a + 1] = s.reaches


def make_room(s: Sums, more: int) -> None:
    """Make room for so many more entries."""
    grow_places(s.column, s.entries + more)
    grow_block(s.factor, s.entries + more)
    grow_block(s.size, s.entries + more)


def add_entry(s: Sums, column: int, factor: float, size: float) -> None:
    """Add a state with its factor to the sum that is being taken, where there is room for it."""
    s.column.at[s.entries] = column
    s.factor.at[s.entries] = factor
    s.size.at[s.entries] = size
    s.entries += 1


def add_reach(s: Sums, a: int, part: int, reach: float) -> None:
    """Add what a unit of energy on a part could make of sum a, which is being taken."""
    for i in range(s.reach_first.at[a], s.reaches):
        if s.reach_part.at[i] == part:
            s.reach.at[i] += reach
            return
    grow_places(s.reach_part, s.reaches + 1)
    grow_block(s.reach, s.reaches + 1)
    s.reach_part.at[s.reaches] = part
    s.reach.at[s.reaches] = reach
    s.reaches += 1


def add_wave(s: Sums, source: int, factor: float) -> None:
    """Add a wave with its factor to the sum that is being taken."""
    grow_places(s.wave_source, s.terms + 1)
    grow_block(s.wave_factor, s.terms + 1)
    s.wave_source.at[s.terms] = source
    s.wave_factor.at[s.terms] = factor
    s.terms += 1
