"""Factors of a step of Radau IIA, and what is solved for by them.

Where states exchange what they store so fast that rounding of one step's factors would move what
all of them do together, matrix, factors and right-hand sides have twice the digits of a number:
two capacitors joined by a picoohm exchange at 1e12 a second, and in steps of an hour what both lose
by a leak is a part in 1e16 of that. Nothing else serves: such factors in single numbers are no
start of a refinement either.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import REGULAR, SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.lu_pair import lu_factor_pair, lu_solve_pair
from hybond.engine.algebra.lu_twofold import lu_factor_twofold, lu_solve_twofold
from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_sparse,
    solve_sparse,
)
from hybond.engine.algebra.twofold import add_part, sum_rest
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.words import Floats, float_table

STEADY_SIZE: Final = 1e-3
SPARSE_FROM: Final = 48
"""Equations from which on sparse factors are worth it, ..."""
FEW_TERMS: Final = 6
"""... if no more than one in so many terms is there."""
REAL: Final = 3.63783425274449573
PAIR_RE: Final = 2.68108287362775213
PAIR_IM: Final = 3.05043019924741057
BUTCHER_INVERSE: Final = float_table(
    3.22474487139158905,
    1.16784008469040549,
    -0.253197264742180826,
    -3.56784008469040549,
    0.775255128608410951,
    1.05319726474218083,
    5.53197264742180826,
    -7.53197264742180826,
    5.0,
)
REAL_IN: Final = float_table(4.17871859155190473, 0.327682820761062387, 0.523376445499449548)
PAIR_IN_RE: Final = float_table(-2.08935929577595236, -0.163841410380531194, 0.238311777250275226)
PAIR_IN_IM: Final = float_table(-0.251436317472893438, 1.28596347492780271, -0.298019602414112462)


def factorise(r: Radau) -> int:
    """Make factors for a step of size r.h, if those that there are do not serve."""
    if r.served > 0.0 and math.fabs(r.h - r.served) <= STEADY_SIZE * r.h:
        return REGULAR
    r.served = 0.0
    r.twofold = r.h > r.twofold_from
    found = factors_twofold(r) if r.twofold else factors(r)
    if found == REGULAR:
        r.served = r.h
    return found


def is_sparse(n: int, terms: int) -> bool:
    """Whether so many terms of n equations are few."""
    return n >= SPARSE_FROM and FEW_TERMS * terms <= n * n


def factors(r: Radau) -> int:
    """Make factors of a real and a complex matrix."""
    n = r.n
    terms = 0
    for k in range(n * n):
        if r.jacobian[k] != 0.0:
            terms += 1
    r.sparse = is_sparse(n, terms) and factors_sparsely(r, terms)
    if r.sparse:
        return REGULAR
    for k in range(n * n):
        r.real[k] = -r.jacobian[k]
        r.re[k] = -r.jacobian[k]
        r.im[k] = 0.0
    for k in range(n):
        r.real[k * n + k] += REAL / r.h
        r.re[k * n + k] += PAIR_RE / r.h
        r.im[k * n + k] = PAIR_IM / r.h
    if lu_factor(n, r.real, r.real_row) == SINGULAR:
        return SINGULAR
    return lu_factor_pair(n, r.re, r.im, r.pair_row, r.number)


def factors_sparsely(r: Radau, terms: int) -> bool:
    """Make sparse ones, those of the complex matrix for real and imaginary parts; False: none."""
    n = r.n
    begin_system(r.real_lu, n, terms + n)
    begin_system(r.pair_lu, 2 * n, 2 * terms + 4 * n)
    for i in range(n):
        add_term(r.real_lu, i, REAL / r.h)
        for half in range(2):
            add_term(r.pair_lu, 2 * i + half, PAIR_RE / r.h)
            add_term(r.pair_lu, 2 * i + 1 - half, (PAIR_IM if half == 1 else -PAIR_IM) / r.h)
            for j in range(n):
                slope = r.jacobian[i * n + j]
                if slope != 0.0:
                    add_term(r.pair_lu, 2 * j + half, -slope)
                    if half == 0:
                        add_term(r.real_lu, j, -slope)
            end_equation(r.pair_lu)
        end_equation(r.real_lu)
    fit(r.x_pair, 4 * n)
    fit(r.x_rest, n)
    return factor_sparse(r.real_lu, r.factoring) and factor_sparse(r.pair_lu, r.factoring)


def solve_real_sparsely(r: Radau, x: Floats) -> None:
    """Solve by the sparse factors of the real matrix, in place."""
    n = r.n
    for i in range(n):
        r.x_rest.at[i] = x[i]
    solve_sparse(r.real_lu, r.factoring, r.x_rest.at, x)


def solve_pair_sparsely(r: Radau) -> None:
    """Solve by those of the complex one for ``r.x_re`` and ``r.x_im``."""
    n = r.n
    fit(r.pair, 2 * n)
    for i in range(n):
        r.x_pair.at[2 * i] = r.x_re[i]
        r.x_pair.at[2 * i + 1] = r.x_im[i]
    solve_sparse(r.pair_lu, r.factoring, r.x_pair.at, r.pair.at)
    for i in range(n):
        r.x_re[i] = r.pair.at[2 * i]
        r.x_im[i] = r.pair.at[2 * i + 1]


def factors_twofold(r: Radau) -> int:
    """Make the same with twice the digits, the complex one as a real one of twice as many rows."""
    n = r.n
    fit(r.real_rest, n * n)
    fit(r.pair, 4 * n * n)
    fit(r.pair_rest, 4 * n * n)
    fit_places(r.pair_pivot, 2 * n)
    fit(r.f_rest, 3 * n)
    fit(r.x_rest, n)
    fit(r.x_pair, 2 * n)
    fit(r.x_pair_rest, 2 * n)
    for k in range(n * n):
        r.real[k] = -r.jacobian[k]
        r.real_rest.at[k] = -r.jacobian_rest.at[k]
    for k in range(4 * n * n):
        r.pair.at[k] = 0.0
        r.pair_rest.at[k] = 0.0
    for i in range(n):
        for j in range(n):
            for half in range(2):
                at = (i + half * n) * 2 * n + j + half * n
                r.pair.at[at] = -r.jacobian[i * n + j]
                r.pair_rest.at[at] = -r.jacobian_rest.at[i * n + j]
    for i in range(n):
        add_part(r.real, r.real_rest.at, i * n + i, 1.0, REAL / r.h, 0.0)
        for half in range(2):
            row = (i + half * n) * 2 * n
            add_part(r.pair.at, r.pair_rest.at, row + i + half * n, 1.0, PAIR_RE / r.h, 0.0)
        r.pair.at[i * 2 * n + n + i] = -PAIR_IM / r.h
        r.pair.at[(n + i) * 2 * n + i] = PAIR_IM / r.h
    if lu_factor_twofold(n, r.real, r.real_rest.at, r.real_row) == SINGULAR:
        return SINGULAR
    return lu_factor_twofold(2 * n, r.pair.at, r.pair_rest.at, r.pair_pivot.at)


def solve_real(r: Radau, rate: Floats, rest: Floats, x: Floats) -> None:
    """Put ``(REAL/h - J)^-1 (rate + x)`` into `x`; `rest` is what the rate was rounded by."""
    n = r.n
    if not r.twofold:
        for i in range(n):
            x[i] = rate[i] + x[i]
        if r.sparse:
            solve_real_sparsely(r, x)
        else:
            lu_solve(n, r.real, r.real_row, 1, x)
        return
    for i in range(n):
        total = rate[i] + x[i]
        r.x_rest.at[i] = sum_rest(rate[i], x[i], total) + rest[i]
        x[i] = total
    lu_solve_twofold(n, r.real, r.real_rest.at, r.real_row, x, r.x_rest.at)


def solve_stages(r: Radau) -> None:
    """Solve for what is left of the equations of the stages, in the basis of eigenvectors."""
    if r.twofold:
        solve_stages_twofold(r)
        return
    n = r.n
    for i in range(n):
        r.x_real[i] = 0.0
        r.x_re[i] = 0.0
        r.x_im[i] = 0.0
    for s in range(3):
        first = BUTCHER_INVERSE[3 * s] / r.h
        second = BUTCHER_INVERSE[3 * s + 1] / r.h
        third = BUTCHER_INVERSE[3 * s + 2] / r.h
        for i in range(n):
            residual = r.f[s * n + i] - (
                first * r.z[i] + second * r.z[n + i] + third * r.z[2 * n + i]
            )
            r.x_real[i] += REAL_IN[s] * residual
            r.x_re[i] += PAIR_IN_RE[s] * residual
            r.x_im[i] += PAIR_IN_IM[s] * residual
    if r.sparse:
        solve_real_sparsely(r, r.x_real)
        solve_pair_sparsely(r)
        return
    lu_solve(n, r.real, r.real_row, 1, r.x_real)
    lu_solve_pair(n, r.re, r.im, r.pair_row, r.number, r.x_re, r.x_im)


def solve_stages_twofold(r: Radau) -> None:
    """Do the same with twice the digits."""
    n = r.n
    for i in range(n):
        r.x_real[i] = 0.0
        r.x_rest.at[i] = 0.0
    for i in range(2 * n):
        r.x_pair.at[i] = 0.0
        r.x_pair_rest.at[i] = 0.0
    for s in range(3):
        first = BUTCHER_INVERSE[3 * s] / r.h
        second = BUTCHER_INVERSE[3 * s + 1] / r.h
        third = BUTCHER_INVERSE[3 * s + 2] / r.h
        for i in range(n):
            moved = first * r.z[i] + second * r.z[n + i] + third * r.z[2 * n + i]
            rate = r.f[s * n + i]
            left = rate - moved
            rest = sum_rest(rate, -moved, left) + r.f_rest.at[s * n + i]
            add_part(r.x_real, r.x_rest.at, i, REAL_IN[s], left, rest)
            add_part(r.x_pair.at, r.x_pair_rest.at, i, PAIR_IN_RE[s], left, rest)
            add_part(r.x_pair.at, r.x_pair_rest.at, n + i, PAIR_IN_IM[s], left, rest)
    lu_solve_twofold(n, r.real, r.real_rest.at, r.real_row, r.x_real, r.x_rest.at)
    lu_solve_twofold(
        2 * n, r.pair.at, r.pair_rest.at, r.pair_pivot.at, r.x_pair.at, r.x_pair_rest.at
    )
    for i in range(n):
        r.x_re[i] = r.x_pair.at[i]
        r.x_im[i] = r.x_pair.at[n + i]
