"""What a jump does not reach keeps what it stores, bit for bit.

Bonds that no junction which is ON joins, no element or storage, and no source that reads them, have
nothing to do with each other: a jump is solved in each of these parts by itself. Where all
constraints of a part hold already, nothing in it moves; what moves nevertheless is dust of another
part, on which a guard may fire that has nothing to do with it.

The parts are found from the graph, not from the elimination that the jump was made by.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit_places
from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.tableau import part_of
from hybond.engine.reasons.noting import UNTOUCHED, note_violation
from hybond.engine.words import Floats, Ints


def find_parts(e: Engine, mode: Mode) -> None:
    """Find the part of the graph that each bond is in, in a mode: the first of its bonds."""
    m = e.model
    root = e.checks.root
    for b in range(m.bonds):
        root[b] = b
    for j in range(m.junctions):
        switch = m.junction_switch[j]
        if switch >= 0 and mode.on[switch] == 0:
            continue  # it gives each of its bonds zero, and tells none of the others
        for i in range(m.end_first[j] + 1, m.end_first[j + 1]):
            unite(root, m.end_bond[m.end_first[j]], m.end_bond[i])
    for element in range(m.elements):
        join_element(e, mode, element)
    for k in range(m.storages):
        for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
            unite(root, m.storage_bond[k], m.storage_bond[m.stiff_other[i]])
    for i in range(mode.sources):
        s = mode.source[i]
        for p in range(m.look_first[s] if s >= 0 else 0, m.look_first[s + 1] if s >= 0 else 0):
            unite(root, m.source_bond[s], m.look_bond[p])
    fit_places(mode.ways.part, m.bonds)
    for b in range(m.bonds):
        mode.ways.part.at[b] = first_of(root, b)
    mode.ways.parted = True


def join_element(e: Engine, mode: Mode, element: int) -> None:
    """Join the bonds that an element speaks of."""
    m = e.model
    root = e.checks.root
    part = part_of(m, mode, element)
    first = -1
    for row in range(m.part_power[part], m.part_power[part + 1]):
        for i in range(m.row_first[row], m.row_first[row + 1]):
            first = joined(m.bonds, root, first, m.row_column[i])
    for d in range(m.part_dynamic[part], m.part_dynamic[part + 1]):
        for i in range(m.slope_first[d], m.slope_first[d + 1]):
            first = joined(m.bonds, root, first, m.slope_column[i])


def joined(bonds: int, root: Ints, first: int, column: int) -> int:
    """Join the bond of a column to the first one of an element; return that."""
    b = column % bonds
    if first < 0:
        return b
    unite(root, first, b)
    return first


def note_reached(e: Engine, mode: Mode) -> None:
    """Note the parts in which what is stored misses a constraint, by however little.

    The residuals are in `e.work.gap`. Where laws of junctions are left open, or a source is solved
    for with the structure, all is reached.
    """
    m = e.model
    c = e.checks
    c.all_reached = mode.opened
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        if d < 0 or m.dynamic_source[d] != 0:
            c.all_reached = True
    if c.all_reached:
        return
    if not mode.ways.parted:
        find_parts(e, mode)
    for b in range(m.bonds):
        c.reached[b] = 0
    rows = mode.constraints.rows
    for i in range(rows):
        if e.work.gap.at[i] == 0.0:
            continue
        for p in range(mode.constraints.first.at[i], mode.constraints.first.at[i + 1]):
            k = mode.constraints.column.at[p]
            if k < m.storages:
                c.reached[mode.ways.part.at[m.storage_bond[k]]] = 1
    for j in range(e.work.lefts):
        for i in range(mode.structures if e.work.gap.at[rows + j] != 0.0 else 0):
            if e.work.left.at[i * e.work.lefts + j] != 0.0:
                reach_structure(e, mode, mode.dynamic[mode.structure[i]])


def reach_structure(e: Engine, mode: Mode, d: int) -> None:
    """Note the part that a two-port with a modulus is in."""
    m = e.model
    for i in range(m.slope_first[d], m.slope_first[d + 1]):
        e.checks.reached[mode.ways.part.at[m.slope_column[i] % m.bonds]] = 1


def hold_untouched(e: Engine, mode: Mode, t: float, x: Floats, after: Floats) -> None:
    """Hold what a jump made of `x` against what it may reach, as noted before it."""
    m = e.model
    c = e.checks
    if c.all_reached:
        return
    for k in range(m.storages):
        if after[k] != x[k] and c.reached[mode.ways.part.at[m.storage_bond[k]]] == 0:
            off = abs(after[k] - x[k])
            note_violation(e, mode, t, UNTOUCHED, k, off, max(abs(after[k]), abs(x[k])))
