"""Laws put back into themselves: whether a solution that Newton offers is one."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import (
    measure_terms,
    measured_system,
    system,
    write_bonds,
)
from hybond.engine.words import Floats

HOLDS: Final = 1e-10
"""A law holds if its residual is below this part of its terms."""
UNIT: Final = 2.0**-52
ROUNDINGS: Final = 16.0
"""Units of rounding, of all that a law is made of, by which its residual may be off."""
HIDDEN: Final = 1e-9
"""Part of a law that rounding of what was eliminated may hide: if more, it is done anew."""
NEAR: Final = 1e-6
"""Part of the largest variable of its kind by which another step may still move one."""
ANSWERS: Final = 1e-3
"""Part of what its slopes promise by which a law has to answer, on either side: at a corner it does
so by less than there."""


def put_back(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether all laws hold at the bond variables `w`, after `system` near them.

    What part of a law rounding of its variables hides is noted, and where that is so.
    """
    work = e.work
    n = 2 * e.model.bonds
    work.lost = 0.0
    if mode.rank != mode.structures:
        rows = measured_system(e, mode, v, w)
    else:
        rows = mode.dynamics
        measure_terms(e, mode, w)
        write_bonds(e, v, w)
        for i in range(rows):
            f = dynamic_value(e, mode, i, v)
            d = mode.dynamic[i]
            if work.aid > 0.0 and d >= 0 and e.model.dynamic_partner[d] >= 0:
                f -= work.aid * e.model.dynamic_way[d] * w[e.model.dynamic_partner[d]]
            work.residual.at[i] = f
            work.residual_size.at[i] = terms_of(e, d, i * n, work.w_size)
            work.residual_reach.at[i] = terms_of(e, d, i * n, work.w_reach)
            if d >= 0 and e.model.dynamic_kind[d] != 0:
                work.lost = max(work.lost, hidden_part(e, d, i * n, w))
            if d >= 0 and not math.fabs(f) <= HOLDS * work.residual_size.at[i]:
                moved = moved_by_rounding(e, mode, i, v, w) / (ROUNDINGS * UNIT)
                work.residual_reach.at[i] = min(work.residual_reach.at[i], moved)
    if work.lost > HIDDEN:
        copy_floats(n, w, work.lost_at)
    if all_hold(e, rows, HOLDS):
        return is_near(e, mode, v, w, rows)
    return mode.rank == mode.structures and is_rounding(e, mode, v, w)


def slopes_of(e: Engine, d: int) -> int:
    """Return how many slopes a row may have that are not zero: those that the table lists, ...

    ... or where it may have others, all.
    """
    m = e.model
    return 2 * m.bonds if has_others(e, d) else m.slope_first[d + 1] - m.slope_first[d]


def has_others(e: Engine, d: int) -> bool:
    """Whether a row has slopes that the table does not list: of a constraint, or with an aid."""
    return d < 0 or e.work.aid > 0.0


def column_of(e: Engine, d: int, p: int) -> int:
    """Return by which bond variable slope p of these is."""
    return p if has_others(e, d) else e.model.slope_column[e.model.slope_first[d] + p]


def terms_of(e: Engine, d: int, first: int, size: Floats) -> float:
    """Return the sum of the sizes of the terms of a row of slopes, of those that are finite."""
    total = 0.0
    for p in range(slopes_of(e, d)):
        k = column_of(e, d, p)
        slope = math.fabs(e.work.slopes.at[first + k])
        if slope != 0.0 and math.isfinite(slope):
            total += slope * size[k]
    return total


def hidden_part(e: Engine, d: int, first: int, w: Floats) -> float:
    """Return what part of a law, by its row of slopes, rounding of its variables hides.

    As a part of those terms whose digits are known, since where there are none nothing tells that
    the others are more than rounding. What is next to nothing beside others of its kind may be
    rounding itself, whatever it is a sum of.
    """
    work = e.work
    known = 0.0
    hidden = 0.0
    for p in range(slopes_of(e, d)):
        k = column_of(e, d, p)
        slope = math.fabs(work.slopes.at[first + k])
        if slope != 0.0 and math.isfinite(slope):
            lost = UNIT * work.w_size[k]
            hidden += slope * lost
            if is_known(lost, work.w_reach[k], w[k]):
                known += slope * math.fabs(w[k])
    return hidden / known if known > 0.0 else 0.0


def is_known(lost: float, reach: float, own: float) -> bool:
    """Whether a bond variable has digits, of which rounding leaves so much."""
    return lost <= HIDDEN * math.fabs(own) and math.fabs(own) > HIDDEN * reach


def moved_by_rounding(e: Engine, mode: Mode, i: int, v: Floats, w: Floats) -> float:
    """Return how far a law moves as its variables move by rounding of what is beside them.

    Beside a root at zero its slope promises far more than it keeps.
    """
    m = e.model
    work = e.work
    n = 2 * m.bonds
    d = mode.dynamic[i]
    here = dynamic_value(e, mode, i, v)
    most = 0.0
    for side in range(2):
        way = ROUNDINGS * UNIT if side == 0 else -ROUNDINGS * UNIT
        for p in range(slopes_of(e, d)):
            k = column_of(e, d, p)
            slope = work.slopes.at[i * n + k]
            if slope != 0.0:
                v[m.bond_slot + k] = w[k] + math.copysign(way, way * slope) * work.w_reach[k]
        off = math.fabs(dynamic_value(e, mode, i, v) - here)
        most = max(most, off) if math.isfinite(off) else most
    write_bonds(e, v, w)
    return most


def all_hold(e: Engine, rows: int, part: float) -> bool:
    """Whether residuals are no more than a part of their terms, or rounding of what is beside.

    Forces that cancel, as of a block at rest on two corners, leave a rate that is their rounding.
    """
    for i in range(rows):
        if not excess(e, i, part) <= 0.0:
            return False
    return True


def excess(e: Engine, i: int, part: float) -> float:
    """Return by how much residual `i` is more than that; terms beyond all numbers allow nothing."""
    allowed = part * e.work.residual_size.at[i]
    allowed += ROUNDINGS * UNIT * e.work.residual_reach.at[i]
    return math.fabs(e.work.residual.at[i]) - (allowed if allowed < math.inf else 0.0)


def is_near(e: Engine, mode: Mode, v: Floats, w: Floats, rows: int) -> bool:
    """Whether residuals that are small parts of their terms also leave the solution near.

    Where a law has all but ended in its limit they are small far away from a solution, and where
    there is none.
    """
    if is_exact(e, mode, v, rows):
        return True
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    rows = measured_system(e, mode, v, w)
    newton_step(e, rows, frees)
    for i in range(rows):
        rest = work.residual.at[i]
        for j in range(frees):
            rest -= work.jacobian.at[i * frees + j] * work.step.at[j]
        # slopes that are zero, or rounding, promise nothing
        if math.fabs(rest) > 0.5 * math.fabs(work.residual.at[i]) and not is_lost(e, mode, v, i):
            return False
    for k in range(n):
        moved = 0.0
        for j in range(frees):
            moved += mode.finite_free.at[k * frees + j] * work.step.at[j]
        if not math.fabs(moved) <= NEAR * work.w_reach[k]:
            return False
    return True


def is_exact(e: Engine, mode: Mode, v: Floats, rows: int) -> bool:
    """Whether all residuals are rounding."""
    for i in range(rows):
        if not is_lost(e, mode, v, i):
            return False
    return True


def is_lost(e: Engine, mode: Mode, v: Floats, i: int) -> bool:
    """Whether a residual is rounding of its terms, or of all that its law is made of."""
    m = e.model
    terms = e.work.residual_size.at[i] + e.work.residual_reach.at[i]
    d = mode.dynamic[i] if mode.rank == mode.structures else -1
    if d >= 0:
        terms = max(terms, value(m, m.dynamic_rounding[d], v))
    if not terms < math.inf:
        return e.work.residual.at[i] == 0.0
    return math.fabs(e.work.residual.at[i]) <= ROUNDINGS * UNIT * terms


def is_rounding(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether residuals are what rounding inside of the laws leaves, and a solution is near.

    Where laws cancel, values that are no solution may round to one: the laws have to answer, on
    either side, to what rounding may have moved the solution by.
    """
    m = e.model
    work = e.work
    frees = mode.finite_frees
    n = 2 * m.bonds
    rows = measured_system(e, mode, v, w)
    if rows != frees:
        return False
    offs = work.reduced
    bounds = work.reduced_size
    fit(offs, rows * (frees + 1))
    fit(bounds, rows * (frees + 1))
    for i in range(rows):
        d = mode.dynamic[i]
        terms = work.residual_size.at[i]
        if d >= 0:
            terms = max(terms, value(m, m.dynamic_rounding[d], v))
        allowed = max(HOLDS * work.residual_size.at[i], ROUNDINGS * UNIT * terms)
        if not math.fabs(work.residual.at[i]) <= allowed:
            return False
        offs.at[i] = work.residual.at[i]
        work.residual.at[i] = allowed
        bounds.at[i] = allowed
    if not newton_step(e, rows, frees):
        return False
    fit(work.moved, n)
    fit(work.down, frees)
    copy_floats(frees, work.step.at, work.down.at)
    for side in range(2):
        way = 1.0 if side == 0 else -1.0
        for k in range(n):
            total = 0.0
            for j in range(frees):
                total += mode.finite_free.at[k * frees + j] * work.down.at[j]
            work.moved.at[k] = w[k] + way * total
        system(e, mode, v, work.moved.at)
        for i in range(rows):
            if not way * (work.residual.at[i] - offs.at[i]) >= ANSWERS * bounds.at[i]:
                return False
    write_bonds(e, v, w)
    return True
