"""The largest energy that each part of the graph has held in the run: what rounding is measured by.

What a part stores has the rounding of what it was computed from: of all that it has ever been
connected with while time passed, or in a jump that was written. What stands beside, connected by
nothing or by what is OFF, has no part in it: a circuit of nanojoules keeps its own digits beside a
flywheel, and beside one that a blocked diode parts from it. Parts that are joined have the
rounding of all of them from then on, and keep it when they come apart.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.engine import Engine
from hybond.engine.mode.comparisons.sum_records import Sums
from hybond.engine.mode.digits.connected import find_connected
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import energy_of, linear_energy
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, some

STORED: Final = 10.0
"""Rounding of a bond variable is measured by this multiple of what the energy of its part would
make of it."""


# -- which parts there are


def join_parts(e: Engine, mode: Mode) -> None:
    """Let what hangs together in a mode, or in all that machines slide between, be one part."""
    m = e.model
    if m.most_parts <= 1:
        return
    w = e.work
    parts = parts_together(e, mode, w.new_part)
    same = parts == e.parts
    for k in range(m.storages if same else 0):
        same = same and w.new_part[k] == e.storage_part[k]
    if same:
        return
    inherit(e, parts, e.part_energy)
    inherit(e, parts, e.scale_energy)
    inherit(e, parts, e.pushed_energy)
    inherit_sizes(e, parts)
    copy_places(m.storages, w.new_part, 0, e.storage_part, 0)
    e.parts = parts
    e.energies_seen += 1.0


def parts_together(e: Engine, mode: Mode, part: Ints) -> int:
    """Put the part of each storage there, as the motion has them; return how many there are."""
    m = e.model
    if e.slide.k == 0:
        find_connected(e, mode)
        for k in range(m.storages):
            part[k] = mode.bond_part[m.storage_bond[k]]
        return mode.parts
    # what slides is in all modes around by turns
    number = e.work.part_number
    for k in range(m.storages):
        part[k] = k
    for at in range(e.slide.parts):
        own = some(e.modes[e.slide.part[at]])
        find_connected(e, own)
        for p in range(own.parts):
            number[p] = -1
        for k in range(m.storages):
            p = own.bond_part[m.storage_bond[k]]
            if number[p] < 0:
                number[p] = k
            unite(part, number[p], k)
    parts = 0
    for k in range(m.storages):
        first = first_of(part, k)
        if first == k:
            number[k] = parts
            parts += 1
        part[k] = first
    for k in range(m.storages):
        part[k] = number[part[k]]
    return parts


def inherit(e: Engine, parts: int, energy: Floats) -> None:
    """Let each part have the most that any of those had that what it holds was in."""
    m = e.model
    most = e.work.part_here
    for p in range(parts):
        most[p] = 0.0
    for k in range(m.storages):
        p = e.work.new_part[k]
        most[p] = max(most[p], energy[e.storage_part[k]])
    copy_floats(parts, most, energy)


def inherit_sizes(e: Engine, parts: int) -> None:
    """Let the size that a part lately had be that of the largest of them, with what it comes of."""
    m = e.model
    n = e.states + m.storages + 1
    s = e.lately
    source = e.work.part_number
    for p in range(parts):
        source[p] = -1
    for k in range(m.storages):
        p = e.work.new_part[k]
        own = e.storage_part[k]
        if source[p] < 0 or s[e.states + own] > s[e.states + source[p]]:
            source[p] = own
    for i in range(5):
        at = i * n + e.states
        for p in range(parts):
            e.work.part_here[p] = s[at + source[p]]
        copy_part(parts, e.work.part_here, 0, s, at)


# -- what they have held


def see_energy(e: Engine, x: Floats) -> None:
    """Learn how large the energy of a state is."""
    see_parts(e, math.fabs(energy_of(e, x)), e.work.counted_of)


def see_linear_energy(e: Engine, x: Floats) -> None:
    """Learn how large that of storages whose laws are linear is."""
    see_parts(e, math.fabs(linear_energy(e.model, x, e.work.linear_of)), e.work.linear_of)


def see_parts(e: Engine, total: float, of: Floats) -> None:
    """Learn an energy, of which each storage has some."""
    m = e.model
    e.energy = max(e.energy, total)
    if m.most_parts <= 1:
        see_part(e, 0, total)
        return
    here = e.work.part_here
    add_parts(m, e.parts, e.storage_part, of, here)
    for p in range(e.parts):
        see_part(e, p, math.fabs(here[p]))


def see_part(e: Engine, p: int, energy: float) -> None:
    """Learn the energy of a part."""
    if energy > e.part_energy[p]:
        e.part_energy[p] = energy
        e.energies_seen += 1.0


def add_parts(m: Model, parts: int, part: Ints, of: Floats, out: Floats) -> None:
    """Put what storages of each part have together there."""
    for p in range(parts):
        out[p] = 0.0
    for k in range(m.storages):
        out[part[k]] += of[k]


def see_energy_after(e: Engine, x: Floats) -> None:
    """Learn how large the energy of a state is into which the mode that is tried leads.

    What it joins is not one part before that is written: mostly it is, in trials it may not be.
    """
    m = e.model
    if m.most_parts <= 1:
        see_energy(e, x)
        return
    total = math.fabs(energy_of(e, x))
    e.energy = max(e.energy, total)
    find_connected(e, e.mode)
    joined = e.work.part_number
    for p in range(e.mode.parts):
        joined[p] = -1
    for k in range(m.storages):
        p = e.mode.bond_part[m.storage_bond[k]]
        own = e.storage_part[k]
        joined[p] = own if joined[p] < 0 or joined[p] == own else e.parts
    here = e.work.part_here
    add_parts(m, e.parts, e.storage_part, e.work.counted_of, here)
    for k in range(m.storages):
        if joined[e.mode.bond_part[m.storage_bond[k]]] == e.parts:
            here[e.storage_part[k]] = 0.0
    for p in range(e.parts):
        see_part(e, p, math.fabs(here[p]))


# -- what that says in a mode


def find_energies(e: Engine, mode: Mode) -> None:
    """Put what rounding is measured by on each part of a mode into ``mode.part_energy``.

    Likewise what ``mode.seen`` is a factor of into ``mode.part_reach``; nothing without laws.
    """
    find_connected(e, mode)
    if mode.floored_at == e.energies_seen:
        return
    m = e.model
    energy = mode.part_energy
    if m.most_parts <= 1:
        energy[0] = e.part_energy[0]
    else:
        for p in range(mode.parts + 1):
            energy[p] = 0.0
        for k in range(m.storages):
            p = mode.bond_part[m.storage_bond[k]]
            energy[p] = max(energy[p], e.part_energy[e.storage_part[k]])
    for p in range(mode.parts + 1):
        mode.part_reach[p] = STORED * math.sqrt(energy[p]) if m.laws > 0 else 0.0
    mode.floored_at = e.energies_seen


def find_energies_at(e: Engine, mode: Mode, x: Floats, out: Floats) -> None:
    """Put the larger of that and what a state has on each part of a mode there."""
    m = e.model
    find_energies(e, mode)
    total = energy_of(e, x)
    out[0] = total
    if m.most_parts > 1:
        for p in range(mode.parts + 1):
            out[p] = 0.0
        for k in range(m.storages):
            out[mode.bond_part[m.storage_bond[k]]] += e.work.counted_of[k]
    for p in range(mode.parts + 1):
        out[p] = max(mode.part_energy[p], math.fabs(out[p]))


def reach_of_bond(e: Engine, mode: Mode, b: int, xi: Floats) -> float:
    """Return how far bond variable `b` of a mode may reach, by what is stored on its part.

    `find_energies` is asked for before, once for all of them.
    """
    reach = mode.part_reach[part_of_bond(e.model, mode, b)] * mode.seen[b]
    return reach + STORED * settled_terms(e.model, mode, b, xi)


def settled_terms(m: Model, mode: Mode, b: int, xi: Floats) -> float:
    """Return the size of what storages give to a bond variable that settle within a moment.

    `mode.seen` says nothing of where sources let them settle.
    """
    total = 0.0
    if mode.any_settles:
        rows = mode.finite
        at = mode.same[b]
        for i in range(rows.first.at[at], rows.first.at[at + 1]):
            k = rows.column.at[i]
            if k < m.storages and mode.settles_with[k] >= 0:
                total += rows.size.at[i] * math.fabs(xi[k])
    return total


def reach_of_sum(mode: Mode, s: Sums, a: int) -> float:
    """Return how far sum `a` may reach likewise, in the mode in which it was taken."""
    total = 0.0
    for i in range(s.reach_first.at[a], s.reach_first.at[a + 1]):
        total += mode.part_reach[s.reach_part.at[i]] * s.reach.at[i]
    return total


def part_of_bond(m: Model, mode: Mode, b: int) -> int:
    """Return the part of bond variable `b` in a mode."""
    return mode.bond_part[b if b < m.bonds else b - m.bonds]
