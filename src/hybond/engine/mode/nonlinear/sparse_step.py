"""Newton's step where there are many laws, each of which knows of few unknowns: sparse factors.

The pipes of a town: each knows of the loops that it is in. Where pivots leave doubt, or where most
laws know of most unknowns, the step is left to dense factors.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_again,
    factor_sparse,
    solve_sparse,
    solve_transposed,
)
from hybond.engine.engine import Engine
from hybond.engine.mode.nonlinear.single_terms import take_single

MANY: Final = 32
"""Unknowns from which on factors are sparse: of fewer, dense ones are as quick."""
FULL: Final = 0.25
"""Part of all slopes that are not zero, from which on they are not."""
CLEAR: Final = 1e-6
"""A pivot above this part of its terms, and of the largest slope of its law or of its unknown, is
no cancellation."""


def sparse_step(e: Engine, n: int) -> bool:
    """Solve ``jacobian step = residual``; False if that is not done, or not clearly regular."""
    work = e.work
    if not factor_slopes(e, n):
        return False
    solve_sparse(work.newton_factors, work.factoring, work.residual.at, work.step.at)
    if not all_finite(n, work.step.at):
        return False
    take_single(e, n, True)
    return True


def factor_slopes(e: Engine, n: int) -> bool:
    """Factor the Jacobian, of n rows, into ``work.newton_factors``; False as above."""
    if n < MANY:
        return False
    work = e.work
    f = work.newton_factors
    a = work.jacobian.at
    terms = 0
    for i in range(n * n):
        terms += 1 if a[i] != 0.0 else 0
    if float(terms) > FULL * float(n) * float(n):
        return False
    if work.newton_order and put_same_terms(e, n, terms):
        if not work.newton_moved or factor_again(f, work.factoring):
            return is_clear(e, n)
    begin_system(f, n, terms)
    for i in range(n):
        for j in range(n):
            if a[i * n + j] != 0.0:
                add_term(f, j, a[i * n + j])
        end_equation(f)
    work.newton_order = factor_sparse(f, work.factoring)
    return work.newton_order and is_clear(e, n)


def put_same_terms(e: Engine, n: int, terms: int) -> bool:
    """Whether slopes that are not zero are where they were when factors were found last.

    Whether any of them is another one is in `e.work.newton_moved`.
    """
    f = e.work.newton_factors
    a = e.work.jacobian.at
    e.work.newton_moved = False
    if f.unknowns != n or f.begins.at[n] != terms:
        return False
    for i in range(n):
        for p in range(f.begins.at[i], f.begins.at[i + 1]):
            slope = a[i * n + f.term_of.at[p]]
            if slope == 0.0:
                return False
            if slope != f.term.at[p]:
                f.term.at[p] = slope
                e.work.newton_moved = True
    return True


def is_clear(e: Engine, n: int) -> bool:
    """Whether no pivot may be what cancels."""
    work = e.work
    f = work.newton_factors
    fit(work.down, n)
    for j in range(n):
        work.down.at[j] = 0.0
    for p in range(f.begins.at[n]):
        j = f.term_of.at[p]
        work.down.at[j] = max(work.down.at[j], math.fabs(f.term.at[p]))
    for k in range(n):
        i = f.taken.at[k]
        most = 0.0
        for p in range(f.begins.at[i], f.begins.at[i + 1]):
            most = max(most, math.fabs(f.term.at[p]))
        most = max(min(most, work.down.at[f.pivot.at[k]]), f.made_of.at[k])
        if not math.fabs(f.diagonal.at[k]) >= CLEAR * most:
            return False
    return True


def put_inverse_row(e: Engine, n: int, j: int) -> None:
    """Put what unknown j has of each residual into row j of ``work.inverse``."""
    work = e.work
    fit(work.row, n)
    fit(work.left_over, n)
    for i in range(n):
        work.row.at[i] = 0.0
    work.row.at[j] = 1.0
    solve_transposed(work.newton_factors, work.factoring, work.row.at, work.left_over.at)
    copy_part(n, work.left_over.at, 0, work.inverse.at, j * n)
