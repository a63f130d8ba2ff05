"""What entering a mode asks of what is stored: constraints, and how far the state is from them."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, row_size, row_times
from hybond.engine.algebra.products import all_finite, copy_floats, copy_part, largest_part
from hybond.engine.algebra.rounding import SMALLEST
from hybond.engine.algebra.svd import svd_of_transpose
from hybond.engine.answers import value
from hybond.engine.constraints.bent_sources import bends_in_free, reach_free, row_at
from hybond.engine.engine import Engine, svd_room
from hybond.engine.mode.digits.part_energies import find_energies
from hybond.engine.mode.digits.reach import reach_at
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import frozen_at
from hybond.engine.mode.nonlinear.newton import known_of
from hybond.engine.mode.nonlinear.newton_system import by_power, part_of_unit, split, take_rank
from hybond.engine.mode.rows.storage import coupled, own_stiffness, with_stored
from hybond.engine.model import Model
from hybond.engine.words import Floats

TINY: Final = 1e12 * SMALLEST
"""A term is not smaller than this: the last bit of what is denormal is no small part of it."""


def begin_constraints(e: Engine, mode: Mode, v: Floats, x: Floats) -> None:
    """Make ready ``G z(x) - c``, the constraints as a function of the state, at a priori values."""
    m = e.model
    w = e.work
    w.lefts = 0
    keep_bonds(e, mode, v)
    if mode.structures > 0:
        # frozen rows stay in `frozen`, left null vectors in `left`
        take_rank(e, mode, v)
        split(e, mode, v)
        w.lefts = mode.structures - mode.rank
        many = mode.structures * w.lefts
        fit(w.left_before, max(many, 1))
        copy_floats(many, w.left.at, w.left_before.at)
    w.constraints = mode.constraints.rows + w.lefts
    fit(w.gap, w.constraints)
    fit(w.gap_size, w.constraints)
    fit(w.base_gap, w.constraints)
    fit(w.two_port, 2 * mode.structures + 1)
    values = with_stored(e, x)
    find_energies(e, mode)
    for i in range(mode.bounds):
        k = mode.bound[i]
        if k < m.storages:
            # what is taken off what is stored leaves rounding of it, however little is left
            own = math.fabs(own_stiffness(m, k, values))
            held = reach_at(e, k, x, mode.part_energy[mode.bond_part[m.storage_bond[k]]])
            w.reach[k] = (held + math.fabs(x[k])) * own


def keep_bonds(e: Engine, mode: Mode, v: Floats) -> None:
    """Keep the a priori bond variables; where no law is evaluated, nothing writes others."""
    m = e.model
    for k in range(2 * m.bonds if mode.dynamics > 0 else 0):
        e.work.kept[k] = v[m.bond_slot + k]


def restore_bonds(e: Engine, mode: Mode, v: Floats) -> None:
    """Write the a priori bond variables back."""
    m = e.model
    for k in range(2 * m.bonds if mode.dynamics > 0 else 0):
        v[m.bond_slot + k] = e.work.kept[k]


def gaps(e: Engine, mode: Mode, v: Floats, x: Floats, again: bool) -> None:
    """Put the residuals at the state `x` into `e.work`, of a mode in which no law is evaluated.

    Nothing is found of their sizes. What is of time alone is there if it is asked `again`.
    """
    m = e.model
    w = e.work
    w.lefts = 0
    w.constraints = mode.constraints.rows
    fit(w.gap, w.constraints)
    copy_part(m.storages, x, 0, v, m.stored_slot)
    for i in range(mode.bounds):
        k = mode.bound[i]
        if mode.bound_alone[i] != 0:
            w.xi[k] = m.stiff_constant[m.stiff_first[k]] * x[k]
        elif not (again and is_of_time(m, mode, k)):
            w.xi[k] = known_of(e, mode, v, k)
    for i in range(w.constraints):
        w.gap.at[i] = row_times(mode.constraints, i, w.xi)


def is_of_time(m: Model, mode: Mode, k: int) -> bool:
    """Whether known k is a source that reads nothing that is stored."""
    if k < m.storages or k >= m.storages + mode.sources:
        return False
    s = mode.source[k - m.storages]
    return s < 0 or m.source_value[s] < 0 or m.source_timed[s] != 0


def residual(e: Engine, mode: Mode, v: Floats, x: Floats) -> None:
    """Put the residuals at the state `x` and the sizes of their terms into `e.work`."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    copy_part(m.storages, x, 0, v, m.stored_slot)
    restore_bonds(e, mode, v)
    for i in range(mode.bounds):
        k = mode.bound[i]
        if mode.bound_alone[i] != 0:
            w.xi[k] = m.stiff_constant[m.stiff_first[k]] * v[m.stored_slot + k]
            w.known_size[k] = math.fabs(w.xi[k]) + TINY + w.reach[k]
            continue
        w.xi[k] = known_of(e, mode, v, k)
        w.known_size[k] = math.fabs(w.xi[k]) + TINY
        if k < m.storages:
            w.known_size[k] += w.reach[k] + coupled(m, k, v)
    rows = mode.constraints.rows
    for i in range(rows):
        w.gap.at[i] = row_times(mode.constraints, i, w.xi)
        w.gap_size.at[i] = row_size(mode.constraints, i, w.known_size)
    if w.lefts == 0:
        return
    for k in range(n):
        same = mode.same[k]
        w.base[k] = w.base[same] if same < k else row_times(mode.power, k, w.xi)
        w.base_size[k] = w.base_size[same] if same < k else row_size(mode.power, k, w.known_size)
    if follows(m, mode):
        follow_moduli(e, mode, v)
    for i in range(mode.structures):
        total = 0.0
        size = 0.0
        row = mode.structure[i] * n
        for k in range(n):
            total += w.frozen.at[row + k] * w.base[k]
            size += math.fabs(w.frozen.at[row + k]) * w.base_size[k]
        w.two_port.at[2 * i] = total
        w.two_port.at[2 * i + 1] = size
    # a controlled source is read at the state tried
    copy_part(n, w.base, 0, v, m.bond_slot)
    if bends_in_free(e, mode) and reach_free(e, mode, v):
        for i in range(mode.structures):
            w.two_port.at[2 * i] = row_at(e, mode, v, i)
            for k in range(n):
                term = w.frozen.at[mode.structure[i] * n + k] * (v[m.bond_slot + k] - w.base[k])
                w.two_port.at[2 * i + 1] += math.fabs(term)
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        if m.dynamic_source[d] != 0:
            f = value(m, m.dynamic_value[d], v)
            w.two_port.at[2 * i] = f
            w.two_port.at[2 * i + 1] += math.fabs(f)
    for j in range(w.lefts):
        total = 0.0
        size = 0.0
        for i in range(mode.structures):
            share = w.left.at[i * w.lefts + j]
            total += share * w.two_port.at[2 * i]
            size += math.fabs(share) * w.two_port.at[2 * i + 1]
        w.gap.at[rows + j] = total
        w.gap_size.at[rows + j] = size


def follows(m: Model, mode: Mode) -> bool:
    """Whether a two-port of the mode has a modulus that may jump with what is stored."""
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        if d >= 0 and m.dynamic_follows[d] != 0:
            return True
    return False


def follow_moduli(e: Engine, mode: Mode, v: Floats) -> None:
    """Read moduli at the state tried, and turn what they leave of the constraints with them.

    What is stored is in `v`, bond variables that it determines in `e.work.base`. Impulses are those
    of the moduli before: this is the law that is to hold behind the jump.
    """
    m = e.model
    w = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    for k in range(n):
        if largest_part(frees, mode.power_free.at, mode.same[k] * frees) == 0.0:
            v[m.bond_slot + k] = w.base[k]
    frozen_at(e, mode, v, w.refrozen)
    moved = False
    for i in range(mode.structures):
        row = mode.structure[i] * n
        if m.dynamic_follows[mode.dynamic[mode.structure[i]]] != 0:
            for k in range(n):
                moved = moved or w.refrozen.at[row + k] != w.frozen.at[row + k]
                w.frozen.at[row + k] = w.refrozen.at[row + k]
    if moved:
        turn_left(e, mode)


def turn_left(e: Engine, mode: Mode) -> None:
    """Take out of the left null vectors before what the rows reach with the moduli there are now.

    So they turn with the moduli and never change places.
    """
    w = e.work
    many = mode.structures
    frees = mode.power_frees
    rank = mode.rank
    by_power(e, mode)
    copy_floats(many * w.lefts, w.left_before.at, w.left.at)
    if not all_finite(many * frees, w.c.at):
        return
    d = svd_room(e, max(many, frees), max(many, frees))
    svd_of_transpose(d, many, frees, w.c.at)
    for j in range(w.lefts):
        for a in range(rank):
            share = 0.0
            for i in range(many):
                share += d.v[a * many + i] * w.left_before.at[i * w.lefts + j]
            for i in range(many):
                w.left.at[i * w.lefts + j] -= share * d.v[a * many + i]
        for i in range(many):
            w.left.at[i * w.lefts + j] = part_of_unit(many, w.left.at[i * w.lefts + j])


def constraint_by_co_energy(e: Engine, mode: Mode, i: int, n: int) -> None:
    """Put a constraint's coefficients of co-energy variables into `e.work.by_stored`."""
    m = e.model
    w = e.work
    for k in range(m.storages):
        w.by_stored.at[k] = 0.0
    rows = mode.constraints.rows
    if i < rows:
        for p in range(mode.constraints.first.at[i], mode.constraints.first.at[i + 1]):
            k = mode.constraints.column.at[p]
            if k < m.storages:
                w.by_stored.at[k] = mode.constraints.value.at[p]
        return
    j = i - rows
    for s in range(mode.structures):
        share = w.left.at[s * w.lefts + j]
        for k in range(n):
            entry = w.frozen.at[mode.structure[s] * n + k]
            if entry == 0.0:
                continue
            row = mode.same[k]
            for p in range(mode.power.first.at[row], mode.power.first.at[row + 1]):
                column = mode.power.column.at[p]
                if column < m.storages:
                    w.by_stored.at[column] += share * entry * mode.power.value.at[p]
