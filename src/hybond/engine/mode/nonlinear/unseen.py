"""Free unknowns that no law sees, whatever its slopes are, and Newton's step beside them.

Two bonds between the same junctions share a flow: what goes round there moves nothing that a law
reads. Newton's system has fewer rows than unknowns then at every instant, and is singular. With one
unknown held for each such way the others have as many rows as they are, and the step of these is as
clear as any: what is left free is known once for a mode.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.freedom import NO_ROW, directions_left
from hybond.engine.mode.nonlinear.newton_step import CLEAR_PIVOT, least_pivot
from hybond.engine.mode.nonlinear.single_terms import tell_singles
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.model import Model
from hybond.engine.words import Ints


def find_unseen(e: Engine, mode: Mode) -> None:
    """Find the ways in which unknowns of a mode are free of all that its laws read.

    None where rows are more, or fewer, than what is left, or where a source follows what it reads.
    """
    m = e.model
    frees = mode.finite_frees
    mode.unseen = 0
    if mode.dynamics == 0 or mode.dynamics >= frees or mode.structures > 0:
        return
    if not list_read(e, mode):
        return
    rows = 0
    fit(e.work.c, 2 * m.bonds * frees)
    for k in range(2 * m.bonds):
        if e.work.read_by_laws.at[k] != 0:
            for j in range(frees):
                e.work.c.at[rows * frees + j] = mode.finite_free.at[k * frees + j]
            rows += 1
    fit(mode.unseen_ways, frees * frees)
    many = directions_left(e, rows, frees, e.work.c.at, mode.unseen_ways.at)
    if many + mode.dynamics != frees:
        return
    fit_places(mode.unseen_held, frees)
    for j in range(frees):
        mode.unseen_held.at[j] = 1 if e.work.pivot_row.at[j] == NO_ROW else 0
    mode.unseen = many


def list_read(e: Engine, mode: Mode) -> bool:
    """Note which bond variables the rows of a mode read; False where that is not known of one."""
    m = e.model
    fit_places(e.work.read_by_laws, 2 * m.bonds)
    read = e.work.read_by_laws.at
    for k in range(2 * m.bonds):
        read[k] = 0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0:
            if not note_rates_of(m, mode, -1 - d, e.work.read_by_laws.at):
                return False
            continue
        for p in range(m.law_reads[d], m.law_reads[d + 1]):
            read[m.law_column[p]] = 1
    return True


def note_rates_of(m: Model, mode: Mode, c: int, read: Ints) -> bool:
    """Note which bond variables the derivative of a constraint reads; False as above."""
    for p in range(mode.constraints.first.at[c], mode.constraints.first.at[c + 1]):
        k = mode.constraints.column.at[p]
        if k >= m.storages:
            source = mode.source[k - m.storages]
            if source >= 0 and m.source_first[source] < m.source_first[source + 1]:
                return False
            continue
        for j in range(m.stiff_first[k], m.stiff_first[k + 1]):
            read[rate_bond(m, m.stiff_other[j])] = 1
    return True


def step_beside_unseen(e: Engine, mode: Mode, rows: int) -> bool:
    """Solve ``jacobian step = residual``, what no law sees being zero, if that is clearly regular.

    Nothing is done where it is not.
    """
    work = e.work
    frees = mode.finite_frees
    held = mode.unseen_held.at
    if mode.unseen == 0 or rows + mode.unseen != frees:
        return False
    fit(work.seen_slopes, rows * rows)
    fit(work.jacobian2, rows * rows)
    fit(work.seen_step, rows)
    fit_places(work.pivots, rows)
    for i in range(rows):
        at = i * rows
        for j in range(frees):
            if held[j] == 0:
                work.seen_slopes.at[at] = work.jacobian.at[i * frees + j]
                at += 1
    copy_floats(rows * rows, work.seen_slopes.at, work.jacobian2.at)
    copy_floats(rows, work.residual.at, work.seen_step.at)
    if lu_factor(rows, work.jacobian2.at, work.pivots.at) == SINGULAR:
        return False
    lu_solve(rows, work.jacobian2.at, work.pivots.at, 1, work.seen_step.at)
    least = least_pivot(rows, work.seen_slopes.at, work.jacobian2.at)
    if not (least >= CLEAR_PIVOT and all_finite(rows, work.seen_step.at)):
        return False
    at = 0
    fit_places(work.single, frees)
    for j in range(frees):
        work.single.at[j] = held[j]
        work.step.at[j] = 0.0
        if held[j] == 0:
            work.step.at[j] = work.seen_step.at[at]
            at += 1
    tell_singles(e, rows, frees, False)
    return True
