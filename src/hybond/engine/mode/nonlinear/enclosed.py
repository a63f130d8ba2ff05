"""One law alone, with one unknown: a root between two values that differ in sign.

A steep power, turned round, throws Newton's steps far beyond its root, and from there each of them
comes back by a small part; an exponential does so until there is no number left for it. Signs lead
to a root of any law that has no jump there: what is infinite has a sign as well. Steps that grow
from where the search begins find the nearest change of it first. Between numbers of any size halves
are taken of their powers of two, then of themselves. What is zero there and farther on has ended
in its limit: that is no root.

Source: R. P. Brent, *Algorithms for Minimization without Derivatives*, 1973, chapter 4.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import system, with_free
from hybond.engine.mode.nonlinear.put_back import put_back
from hybond.engine.words import Floats

FIRST: Final = 2.0**-40
"""Part of where the search begins that its first step is."""
LEAST: Final = 1e-300
"""The first step from zero, and what stands for zero where powers of two are halved."""
FARTHER: Final = 16.0
"""How much longer each next step is."""
FARTHEST: Final = 1e150
HALVES: Final = 200
NO_ROW: Final = -1
DERIVED: Final = 2
"""Steps in which what is linear is solved: the second takes out rounding of the first."""
APART: Final = 4.0
"""Numbers that are more than so many times each other are halved by their powers of two."""


def enclosed(e: Engine, mode: Mode, v: Floats, r: Floats, from_guess: bool) -> bool:
    """Find the free unknown of the one law, into `r`, from its guess or zero; False if it has none.

    Other laws are not asked; derivatives of constraints, which are linear in what else is free,
    follow from it.
    """
    row = the_law(mode)
    j = the_unknown(e, mode, row) if row >= 0 else NO_ROW
    if j < 0 or mode.dynamics != mode.finite_frees or mode.rank != mode.structures:
        return False
    for k in range(mode.finite_frees):
        r[k] = mode.guess.at[k] if from_guess else 0.0
    begin = r[j]
    here = residual_at(e, mode, v, r, row, j, begin)
    if here != here or here == 0.0:
        return False
    # a part of next to nothing may be zero, and would never grow
    step = max(FIRST * math.fabs(begin), LEAST)
    up = begin
    down = begin
    above = True
    below = True
    while step < FARTHEST and (above or below):
        if above:
            there = residual_at(e, mode, v, r, row, j, begin + step)
            above = is_alike(there, here)
            beyond = begin + FARTHER * step
            if there == 0.0 and residual_at(e, mode, v, r, row, j, beyond) == 0.0:
                return False
            if not above and ends_between(e, mode, v, r, row, j, up, begin + step, here):
                return True
            up = begin + step
        if below:
            there = residual_at(e, mode, v, r, row, j, begin - step)
            below = is_alike(there, here)
            beyond = begin - FARTHER * step
            if there == 0.0 and residual_at(e, mode, v, r, row, j, beyond) == 0.0:
                return False
            if not below and ends_between(e, mode, v, r, row, j, down, begin - step, here):
                return True
            down = begin - step
        step *= FARTHER
    return False


def is_alike(a: float, b: float) -> bool:
    """Whether two numbers have one sign; zero has none."""
    return (a > 0.0 and b > 0.0) or (a < 0.0 and b < 0.0)


def the_law(mode: Mode) -> int:
    """Return the row of the only law, or of all that there is; NO_ROW if there are several."""
    if mode.dynamics == 1:
        return 0
    found = NO_ROW
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0:
            if found != NO_ROW:
                return NO_ROW
            found = i
    return found


def the_unknown(e: Engine, mode: Mode, row: int) -> int:
    """Return the only free unknown that a law reads; NO_ROW if there are several."""
    if mode.finite_frees == 1:
        return 0
    m = e.model
    found = NO_ROW
    d = mode.dynamic[row]
    if d < 0:
        return NO_ROW
    for p in range(m.law_reads[d], m.law_reads[d + 1]):
        k = m.law_column[p]
        for s in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
            j = mode.share_of.at[s]
            if found != NO_ROW and found != j:
                return NO_ROW
            found = j
    return found


def residual_at(e: Engine, mode: Mode, v: Floats, r: Floats, row: int, j: int, x: float) -> float:
    """Return what is left of the law at a value of its unknown, which goes into `r`."""
    r[j] = x
    with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
    system(e, mode, v, e.work.w)
    return e.work.residual.at[row]


def ends_between(
    e: Engine,
    mode: Mode,
    v: Floats,
    r: Floats,
    row: int,
    j: int,
    near: float,
    far: float,
    here: float,
) -> bool:
    """Halve what is between a value where the law has the sign of `here` and one where not.

    Whether the law holds where that ends: it may jump there, or have values no farther.
    """
    for _ in range(HALVES):
        middle = middle_of(near, far)
        if middle == near or middle == far:
            break
        if is_alike(residual_at(e, mode, v, r, row, j, middle), here):
            near = middle
        else:
            far = middle
    left = residual_at(e, mode, v, r, row, j, near)
    if math.fabs(residual_at(e, mode, v, r, row, j, far)) > math.fabs(left):
        residual_at(e, mode, v, r, row, j, near)
    frees = mode.finite_frees
    fit(e.work.step, frees + mode.dynamics + 1)
    for _ in range(DERIVED if frees > 1 else 0):
        # what else is free follows by what is linear in it
        if not newton_step(e, mode.dynamics, frees):
            return False
        for k in range(frees):
            r[k] -= e.work.step.at[k] if k != j else 0.0
        residual_at(e, mode, v, r, row, j, r[j])
        if not all_finite(frees, e.work.residual.at):
            return False
    rows = mode.dynamics
    if not all_finite(rows, e.work.residual.at) or not all_finite(rows * frees, e.work.jacobian.at):
        return False
    mode.regular = newton_step(e, rows, frees)
    return put_back(e, mode, v, e.work.w)


def middle_of(a: float, b: float) -> float:
    """Return a number between two: of those that are far apart half way by powers of two."""
    if a * b < 0.0:
        return 0.0
    low = max(min(math.fabs(a), math.fabs(b)), LEAST)
    high = max(math.fabs(a), math.fabs(b))
    if high <= APART * low:
        return 0.5 * a + 0.5 * b
    return math.copysign(math.sqrt(low) * math.sqrt(high), a + b)
