"""What rounding is measured by: the size of the terms that made what a guard reads.

A difference that is no more than rounding of its terms counts as zero. Those of a bond variable are
found where a guard is asked that reads it, not where it is evaluated.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, row_size
from hybond.engine.engine import Engine
from hybond.engine.mode.digits.clusters import bound_settling, find_settling
from hybond.engine.mode.digits.fading import bound_fading, find_fading, may_fade
from hybond.engine.mode.digits.part_energies import find_energies, reach_of_bond
from hybond.engine.mode.digits.reach import reach_at
from hybond.engine.mode.digits.solved_sizes import solved_sizes
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import frozen_at
from hybond.engine.mode.nonlinear.newton_system import by_free, row_terms
from hybond.engine.mode.rows.storage import coupled, own_stiffness, with_stored
from hybond.engine.model import Model
from hybond.engine.words import Floats

TURNS: Final = 2
"""Times that constraints are gone through: each tells of what others have told."""


def size_of(e: Engine, mode: Mode, b: int, xi: Floats, v: Floats) -> float:
    """Return the size of the terms of bond variable `b`, as `solve` found it from the knowns `xi`.

    Those of what is left free count as well, as large as what Newton solved it from, or what least
    leakage made it of, and the value itself.
    """
    first = e.model.bond_slot
    listed = mode.finite_frees > 0
    begin = mode.share_first.at[b] if listed else 0
    end = mode.share_first.at[b + 1] if listed else 0
    if end > begin:
        solved_sizes(e, mode, xi, v)
    size = row_size(mode.finite, mode.same[b], xi) + of_fields(e.model, mode, mode.same[b], v)
    at = b * mode.finite_frees
    for p in range(begin, end):
        j = mode.share_of.at[p]
        size += math.fabs(mode.finite_free.at[at + j]) * mode.free_size.at[j]
    if mode.dynamics == 0 and mode.leakage.stages > 0:
        size = max(size, row_size(mode.direct, mode.same[b], xi))
    return max(size, math.fabs(v[first + b]))


def given_size(e: Engine, mode: Mode, b: int, xi: Floats) -> float:
    """Return the size of those terms that no storage gives, after `size_of`.

    Where discs slip it is what their friction is: as slip begins its direction hangs on rounding,
    by slopes that are large beyond all that it ever gives.
    """
    m = e.model
    frees = mode.finite_frees
    rows = mode.direct if mode.dynamics == 0 and mode.leakage.stages > 0 else mode.finite
    at = mode.same[b]
    total = 0.0
    for i in range(rows.first.at[at], rows.first.at[at + 1]):
        if rows.column.at[i] >= m.storages:
            total += rows.size.at[i] * math.fabs(xi[rows.column.at[i]])
    for j in range(frees):
        share = mode.finite_free.at[b * frees + j]
        if share != 0.0:
            free = math.fabs(e.work.w[mode.free_column[j]]) if m.disks > 0 else mode.free_size.at[j]
            total += math.fabs(share) * free
    return total


def of_fields(m: Model, mode: Mode, b: int, v: Floats) -> float:
    """Return what the ports of fields add to each other in the terms of bond variable `b`.

    The speed of one of two masses that are coupled is a difference of what both have, and no more
    than rounding of that where something holds it.
    """
    total = 0.0
    if m.stiff_first[m.storages] == m.storages:
        return total
    rows = mode.finite
    for i in range(rows.first.at[b], rows.first.at[b + 1]):
        k = rows.column.at[i]
        if k < m.storages:
            total += rows.size.at[i] * coupled(m, k, v)
    return total


def sizes_of(e: Engine, mode: Mode, v: Floats) -> None:
    """Put the sizes of the terms of all bond variables into `e.work.sizes`, after `solve`."""
    for b in range(2 * e.model.bonds):
        size = size_of(e, mode, b, e.work.xi, v)
        e.work.sizes[b] = size


def measure(e: Engine, mode: Mode, pair: int, xi: Floats, v: Floats, terms: Floats) -> None:
    """Put what rounding of each signal that a pair reads is measured by into `terms`.

    Where junctions have laws, bond variables are measured by what is stored as well, of which
    `mode.seen` tells: junction laws count rounding of that as zero, and beside them every guard
    does. While machines slide those of bond variables are there, see `blend.begin_sizes`.
    """
    m = e.model
    find_energies(e, mode)
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        slot = m.read_slot[i]
        b = slot - m.bond_slot
        if b < 0 or b >= 2 * m.bonds:
            terms[slot] = math.fabs(v[slot])
            if m.samples > 0 and slot >= m.signal_slot and slot < m.stored_slot:
                terms[slot] = max(terms[slot], e.sample_terms[slot - m.signal_slot])
        elif e.slide.k == 0:
            size = size_of(e, mode, b, xi, v)
            terms[slot] = max(size, reach_of_bond(e, mode, b, xi))
    if pair < m.rule_first[m.machines] and m.rule_touches[pair] != 0 and e.slide.k == 0:
        measure_as_ever(e, mode, pair, xi, v, terms)


def measure_as_ever(e: Engine, mode: Mode, pair: int, xi: Floats, v: Floats, terms: Floats) -> None:
    """Let signals of a guard that holds at one instant only be as large as they have been.

    What crosses zero is zero there but for rounding of what it came from, which time is told by.
    """
    m = e.model
    as_ever = e.work.as_ever
    for k in range(m.storages):
        largest = max(e.largest_state[k], math.fabs(e.rests.began[k]))
        as_ever[k] = max(math.fabs(xi[k]), math.fabs(own_stiffness(m, k, v)) * largest)
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        slot = m.read_slot[i]
        b = slot - m.bond_slot
        if b >= 0 and b < 2 * m.bonds:
            rows = mode.finite
            total = 0.0
            for p in range(rows.first.at[mode.same[b]], rows.first.at[mode.same[b] + 1]):
                c = rows.column.at[p]
                total += rows.size.at[p] * (as_ever[c] if c < m.storages else math.fabs(xi[c]))
            terms[slot] = max(terms[slot], total)
            continue
        k = slot - m.stored_slot
        if slot >= m.signal_slot and slot < m.signal_slot + m.integrals:
            k = m.storages + slot - m.signal_slot
        elif k < 0 or k >= m.storages:
            continue
        largest = max(e.largest_state[k], math.fabs(e.rests.began[k]))
        terms[slot] = max(terms[slot], largest)


def measure_values(m: Model, pair: int, v: Floats, terms: Floats) -> None:
    """Put the values themselves there as what rounding of the signals of a pair is measured by."""
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        terms[m.read_slot[i]] = math.fabs(v[m.read_slot[i]])


def bound_tied(mode: Mode, i: int, storages: int, reach: Floats) -> None:
    """Let none of what constraint i ties together be more than the others allow.

    A light capacitor beside a heavy one has its voltage, however far its own energy would lift it:
    which of them stands for the voltage in the equations must not matter.
    """
    rows = mode.constraints
    first = rows.first.at[i]
    last = rows.first.at[i + 1]
    for p in range(first, last):
        if rows.column.at[p] >= storages:
            return  # a source has part in it
    for p in range(first, last):
        others = 0.0
        for q in range(first, last):
            if q != p:
                others += math.fabs(rows.value.at[q]) * reach[rows.column.at[q]]
        k = rows.column.at[p]
        reach[k] = min(reach[k], others / math.fabs(rows.value.at[p]))


def seen_of(e: Engine, mode: Mode, values: Floats, x: Floats) -> None:
    """Put what each bond variable would be with a unit of energy in one storage into `mode.seen`.

    Rounding of what is stored shows itself in bond variables in these proportions, times the root
    of the energy. Where laws bend it is that of its part which is put into one storage. Moduli are
    those at `values`.
    """
    m = e.model
    w = e.work
    if mode.saw_at == e.instants:
        return
    v = with_stored(e, x)
    find_energies(e, mode)
    for k in range(m.storages):
        here = mode.part_energy[mode.bond_part[m.storage_bond[k]]]
        energy = here if m.groups > 0 and here > 0.0 else 1.0
        w.reach[k] = reach_at(e, k, x, energy)
        w.reach[k] *= math.fabs(own_stiffness(m, k, v)) / math.sqrt(energy)
        if not math.isfinite(w.reach[k]):
            w.reach[k] = 0.0
    find_settling(e, mode, v)
    modulated = mode.structures > 0 and mode.finite_frees > 0
    fades = may_fade(m, mode)
    if fades:
        if not mode.fading_known:
            find_fading(e, mode, v)
        bound_fading(e, mode, x, w.reach, values)
    for _ in range(TURNS):
        for i in range(mode.constraints.rows):
            bound_tied(mode, i, m.storages, w.reach)
        bound_settling(e, mode, w.reach, v)
    if fades:
        bound_fading(e, mode, x, w.reach, values)
        mode.saw_at = e.instants
        changes = not mode.saw
        for k in range(m.storages):
            changes = changes or mode.reached[k] != w.reach[k]
            mode.reached[k] = w.reach[k]
        mode.saw = True
        if not changes:
            return
    for k in range(2 * m.bonds):
        same = mode.same[k]
        if same < k:
            mode.seen[k] = mode.seen[same]
            continue
        most = 0.0
        for i in range(mode.finite.first.at[k], mode.finite.first.at[k + 1]):
            j = mode.finite.column.at[i]
            if j < m.storages:
                most = max(most, math.fabs(mode.finite.value.at[i]) * w.reach[j])
        mode.seen[k] = most
    mode.seen_taken = False
    if modulated:
        seen_through(e, mode, values)


def seen_through(e: Engine, mode: Mode, v: Floats) -> None:
    """Let what is stored be seen through modulated two-ports as well, moduli as they are now.

    The slip behind a lever whose arms change has the rounding of the speed before it. Unknowns that
    a row of the power structure finds from what is seen are found one after the other, and are no
    more than any row allows: an arm that has no length now says nothing of the lever that it is on.
    Laws that bend are not gone through.
    """
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.finite_frees
    frozen_at(e, mode, v, work.frozen)
    fit(work.row, frees)
    fit(work.free_seen, frees)
    row = work.row.at
    found = work.free_seen.at
    for j in range(frees):
        found[j] = -1.0
    more = True
    turn = 0
    while more and turn < TURNS + 2 * frees:
        more = False
        turn += 1
        for i in range(mode.structures):
            first = mode.structure[i] * n
            if m.dynamic_affine[mode.dynamic[mode.structure[i]]] == 0:
                continue
            by_free(mode, n, work.frozen.at, first, row)
            if count_unfound(frees, row, found) > 1:
                continue
            size = row_terms(n, work.frozen.at, first, mode.seen)
            if bound_by_row(frees, row, size, found):
                more = True
    for k in range(n):
        for j in range(frees):
            if found[j] > 0.0:
                share = math.fabs(mode.finite_free.at[k * frees + j])
                mode.seen[k] = max(mode.seen[k], share * found[j])


def count_unfound(frees: int, row: Floats, found: Floats) -> int:
    """Return how many unknowns of a row no row has told of yet."""
    many = 0
    for j in range(frees):
        if row[j] != 0.0 and found[j] < 0.0:
            many += 1
    return many


def bound_by_row(frees: int, row: Floats, size: float, found: Floats) -> bool:
    """Let no unknown of a row be more than the rest of it, `size` and the others, allows.

    At most one of them is not found yet. Returns whether one is found, or less than half of what it
    was.
    """
    news = False
    unfound = count_unfound(frees, row, found) > 0
    for j in range(frees):
        if row[j] == 0.0 or (unfound and found[j] >= 0.0):
            continue
        others = size
        for k in range(frees):
            if row[k] != 0.0 and k != j:
                others += math.fabs(row[k]) * found[k]
        others /= math.fabs(row[j])
        if found[j] < 0.0 and math.isfinite(others):
            found[j] = others
            news = True
        elif others < found[j]:
            news = news or others < 0.5 * found[j]
            found[j] = others
    return news
