"""What a row of Newton's step says of one unknown alone, beside others that are exactly zero.

Factors add rows to it that say more, and leave it their rounding: of what is zero, however large
the others are.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import fit_places
from hybond.engine.engine import Engine


def take_single(e: Engine, n: int, sparse: bool) -> None:
    """Let it be that, of n rows of the Jacobian as it stands, or of terms of sparse factors."""
    fit_places(e.work.single, n)
    for j in range(n):
        e.work.single.at[j] = 0
    tell_singles(e, n, n, sparse)


def tell_singles(e: Engine, n: int, columns: int, sparse: bool) -> None:
    """Do so for n rows of so many columns; some unknowns may be known to be zero already."""
    work = e.work
    f = work.newton_factors
    more = True
    while more:
        more = False
        for i in range(n):
            alone = -1
            slope = 1.0
            begin = f.begins.at[i] if sparse else i * columns
            end = f.begins.at[i + 1] if sparse else begin + columns
            for p in range(begin, end):
                j = f.term_of.at[p] if sparse else p - begin
                term = f.term.at[p] if sparse else work.jacobian.at[p]
                if term != 0.0 and not is_nothing(e, j):
                    alone = j if alone == -1 else columns
                    slope = term
            more = let_alone(e, columns, i, alone, slope) or more


def is_nothing(e: Engine, j: int) -> bool:
    """Whether a row alone has told that unknown j is exactly zero."""
    return e.work.single.at[j] == 1 and e.work.step.at[j] == 0.0


def let_alone(e: Engine, columns: int, i: int, alone: int, slope: float) -> bool:
    """Let row i tell the one unknown that it has, if it has one; whether that is exactly zero.

    `alone` is -1 where it has none, and `columns` where it has several.
    """
    work = e.work
    if alone < 0 or alone == columns or work.single.at[alone] == 1:
        return False
    found = work.residual.at[i] / slope
    if not math.isfinite(found):
        return False
    work.step.at[alone] = found
    work.single.at[alone] = 1
    return found == 0.0
