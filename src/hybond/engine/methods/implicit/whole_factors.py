"""Factors of the system of all stages: sparse where rates hang on few states each.

Unknowns of one state at the three stages stand beside each other there: what joins a row of tanks
is then as near to the diagonal as they are to each other.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.lu import REGULAR, lu_factor, lu_solve
from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_sparse,
    solve_sparse,
)
from hybond.engine.methods.implicit.radau_factors import BUTCHER_INVERSE, is_sparse
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.words import Floats


def factor_whole(r: Radau) -> bool:
    """Find factors of the system whose slopes are in ``r.stage_slopes``; False: they are singular.

    These are those of each stage, of the states of the part by each other.
    """
    p = r.parts
    terms = 0
    for k in range(3 * p * p):
        if r.stage_slopes.at[k] != 0.0:
            terms += 1
    r.whole_sparse = is_sparse(3 * p, 3 * terms)
    if r.whole_sparse and factor_sparsely(r, terms + 9 * p):
        return True
    r.whole_sparse = False
    many = 3 * p
    fit(r.whole, many * many)
    for k in range(many * many):
        r.whole.at[k] = 0.0
    for s in range(3):
        for a in range(p):
            row = s * p + a
            for j in range(3):
                r.whole.at[row * many + j * p + a] = BUTCHER_INVERSE[3 * s + j] / r.h
            for b in range(p):
                r.whole.at[row * many + s * p + b] -= r.stage_slopes.at[(s * p + a) * p + b]
    return lu_factor(many, r.whole.at, r.whole_row.at) == REGULAR


def factor_sparsely(r: Radau, terms: int) -> bool:
    """Find sparse factors; False if there are none."""
    p = r.parts
    begin_system(r.whole_lu, 3 * p, terms)
    for a in range(p):
        for s in range(3):
            for j in range(3):
                add_term(r.whole_lu, 3 * a + j, BUTCHER_INVERSE[3 * s + j] / r.h)
            for b in range(p):
                slope = r.stage_slopes.at[(s * p + a) * p + b]
                if slope != 0.0:
                    add_term(r.whole_lu, 3 * b + s, -slope)
            end_equation(r.whole_lu)
    return factor_sparse(r.whole_lu, r.factoring)


def solve_by_whole(r: Radau, x: Floats) -> None:
    """Solve by these factors for what is in `x`, in its place: stage after stage."""
    p = r.parts
    if not r.whole_sparse:
        lu_solve(3 * p, r.whole.at, r.whole_row.at, 1, x)
        return
    fit(r.given_whole, 3 * p)
    fit(r.found_whole, 3 * p)
    for a in range(p):
        for s in range(3):
            r.given_whole.at[3 * a + s] = x[s * p + a]
    solve_sparse(r.whole_lu, r.factoring, r.given_whole.at, r.found_whole.at)
    for a in range(p):
        for s in range(3):
            x[s * p + a] = r.found_whole.at[3 * a + s]
