"""What the power structure leaves free, where sources are no linear functions of it.

Left null vectors take what is free out of rows that are straight in it. A source of large gain that
reads a free effort is not: its row says something of what is stored only where the other rows hold,
as those of two amplifiers one behind the other, the second of which has a capacitor across it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.algebra.svd import least_squares
from hybond.engine.answers import value
from hybond.engine.engine import Engine, svd_room
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import frozen_at
from hybond.engine.mode.nonlinear.newton_system import largest_of
from hybond.engine.words import Floats

STEPS: Final = 60
HALVES: Final = 40
SETTLED: Final = 1e-11
"""A step below this part of what is free is the last one: the next one is its square."""
DEPENDENT: Final = 1e-12
"""What is below this part of the largest counts as dependent."""


def bends_in_free(e: Engine, mode: Mode) -> bool:
    """Whether a source in the power structure is no linear function of what that leaves free."""
    m = e.model
    frees = mode.power_frees
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        if m.dynamic_source[d] == 0 or m.dynamic_affine[d] != 0:
            continue
        for p in range(m.frozen_first[d], m.frozen_first[d + 1]):
            if m.frozen_value[p] < 0:
                continue
            for j in range(frees):
                if mode.power_free.at[m.frozen_column[p] * frees + j] != 0.0:
                    return True
    return False


def reach_free(e: Engine, mode: Mode, v: Floats) -> bool:
    """Put bond variables into `v` at which rows hold as far as what is free reaches them.

    What is known of them is in `e.work.base`; it is begun from those before, in `e.work.kept`.
    Where no such are found, bond variables are what is known, and False.
    """
    m = e.model
    w = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    rank = mode.rank
    fit(w.reach_free, frees)
    fit(w.reach_slope, max(rank * frees, n * frees))
    fit(w.reach_rest, max(rank, n))
    fit(w.reach_step, frees)
    r = w.reach_free.at
    for k in range(n):
        w.reach_rest.at[k] = w.kept[k] - w.base[k]
        copy_part(frees, mode.power_free.at, k * frees, w.reach_slope.at, k * frees)
    finite = all_finite(n, w.reach_rest.at)
    for j in range(frees):
        r[j] = 0.0
    if finite:
        d = svd_room(e, max(n, frees), max(n, frees))
        least_squares(d, n, frees, w.reach_slope.at, DEPENDENT, 1, w.reach_rest.at, r)
    before = math.inf
    for _ in range(STEPS):
        off = rest_at(e, mode, v, 0.0)
        if not off < math.inf:
            break
        slopes_by_free(e, mode, v)
        if not all_finite(rank * frees, w.reach_slope.at):
            break
        room = svd_room(e, max(rank, frees), max(rank, frees))
        rest = w.reach_rest.at
        least_squares(room, rank, frees, w.reach_slope.at, DEPENDENT, 1, rest, w.reach_step.at)
        step = largest_of(frees, w.reach_step.at)
        if step <= SETTLED * largest_of(frees, r):
            rest_at(e, mode, v, 1.0 if step > 0.0 else 0.0)
            return True
        if not off < before:
            break
        before = off
        part = part_ahead(e, mode, v, off)
        for j in range(frees):
            r[j] -= part * w.reach_step.at[j]
    copy_part(n, w.base, 0, v, m.bond_slot)
    return False


def part_ahead(e: Engine, mode: Mode, v: Floats, off: float) -> float:
    """Return the part of the step that leaves less than `off`; next to none if there is no such."""
    part = 1.0
    for _ in range(HALVES):
        if rest_at(e, mode, v, part) < off:
            break
        part *= 0.5
    return part


def rest_at(e: Engine, mode: Mode, v: Floats, part: float) -> float:
    """Put bond variables behind a part of the step into `v`; return the length of what is left."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    for k in range(n):
        total = w.base[k]
        for j in range(frees):
            share = mode.power_free.at[k * frees + j]
            if share != 0.0:
                total += share * (w.reach_free.at[j] - part * w.reach_step.at[j])
        v[m.bond_slot + k] = total
    for j in range(mode.rank):
        w.reach_rest.at[j] = 0.0
    for i in range(mode.structures):
        off = row_at(e, mode, v, i)
        for j in range(mode.rank):
            w.reach_rest.at[j] += w.onto.at[i * mode.rank + j] * off
    total = 0.0
    for j in range(mode.rank):
        total += w.reach_rest.at[j] * w.reach_rest.at[j]
    return math.sqrt(total)


def row_at(e: Engine, mode: Mode, v: Floats, i: int) -> float:
    """Return what row i of the power structure leaves at the bond variables in `v`."""
    m = e.model
    d = mode.dynamic[mode.structure[i]]
    if m.dynamic_source[d] != 0:
        return value(m, m.dynamic_value[d], v)
    n = 2 * m.bonds
    row = mode.structure[i] * n
    total = 0.0
    for k in range(n):
        total += e.work.frozen.at[row + k] * v[m.bond_slot + k]
    return total


def slopes_by_free(e: Engine, mode: Mode, v: Floats) -> None:
    """Put slopes of what is left by what is free there, of sources as they are at `v`."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    rank = mode.rank
    frozen_at(e, mode, v, w.refrozen)
    for a in range(rank * frees):
        w.reach_slope.at[a] = 0.0
    for i in range(mode.structures):
        row = mode.structure[i] * n
        bends = m.dynamic_source[mode.dynamic[mode.structure[i]]] != 0
        for k in range(n):
            slope = w.refrozen.at[row + k] if bends else w.frozen.at[row + k]
            if slope == 0.0:
                continue
            for j in range(frees):
                by_free = slope * mode.power_free.at[k * frees + j]
                if by_free != 0.0:
                    for a in range(rank):
                        share = w.onto.at[i * rank + a]
                        w.reach_slope.at[a * frees + j] += share * by_free
