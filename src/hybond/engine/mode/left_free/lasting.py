"""Whether what is free at corners of laws stays so as what is known moves.

Dead zones in series are free as long as none is full. A valve through which a source drives nothing
is free at that instant alone: a moment later the pressure is where it opens, and that is its limit.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.flat_sides import is_any_at_corner
from hybond.engine.mode.nonlinear.freedom import rank_here
from hybond.engine.mode.nonlinear.newton_system import system, write_bonds
from hybond.engine.words import Floats


def is_free_at_corners(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether laws at corners leave unknowns free by their flat sides, for more than an instant."""
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    if e.model.flats == 0 or work.in_step or mode.rank != mode.structures:
        return False
    write_bonds(e, v, w)
    if not is_any_at_corner(e, mode, v, w):
        return False
    work.flat_sides = True
    rows = system(e, mode, v, w)
    work.flat_sides = False
    if not all_finite(rows * frees, work.jacobian.at):
        return False
    wide = frees + mode.knowns
    fit(work.a, rows * wide)
    for i in range(rows):
        for j in range(wide):
            work.a.at[i * wide + j] = 0.0
        copy_part(frees, work.jacobian.at, i * frees, work.a.at, i * wide)
        for k in range(n):
            slope = work.slopes.at[i * n + k]
            if slope != 0.0:
                same = mode.same[k]
                for p in range(mode.finite.first.at[same], mode.finite.first.at[same + 1]):
                    at = i * wide + frees + mode.finite.column.at[p]
                    work.a.at[at] += slope * mode.finite.value.at[p]
    if not all_finite(rows * wide, work.a.at):
        return False
    rank = rank_here(e, rows, frees, work.jacobian.at)
    return rank < frees and rank_here(e, rows, wide, work.a.at) == rank
