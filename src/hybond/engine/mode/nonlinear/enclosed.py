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
APART: Final = 4.0
"""Numbers that are more than so many times each other are halved by their powers of two."""


def enclosed(e: Engine, mode: Mode, v: Floats, r: Floats, begin: float) -> bool:
    """Find the one free unknown, into `r`, from where it is looked for; False if it is not there.

    Laws of more unknowns, and those that constraints are hidden in, are not asked.
    """
    if mode.finite_frees != 1 or mode.dynamics != 1 or mode.rank != mode.structures:
        return False
    here = residual_at(e, mode, v, r, begin)
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
            there = residual_at(e, mode, v, r, begin + step)
            above = is_alike(there, here)
            beyond = begin + FARTHER * step
            if there == 0.0 and residual_at(e, mode, v, r, beyond) == 0.0:
                return False
            if not above and ends_between(e, mode, v, r, up, begin + step, here):
                return True
            up = begin + step
        if below:
            there = residual_at(e, mode, v, r, begin - step)
            below = is_alike(there, here)
            beyond = begin - FARTHER * step
            if there == 0.0 and residual_at(e, mode, v, r, beyond) == 0.0:
                return False
            if not below and ends_between(e, mode, v, r, down, begin - step, here):
                return True
            down = begin - step
        step *= FARTHER
    return False


def is_alike(a: float, b: float) -> bool:
    """Whether two numbers have one sign; zero has none."""
    return (a > 0.0 and b > 0.0) or (a < 0.0 and b < 0.0)


def residual_at(e: Engine, mode: Mode, v: Floats, r: Floats, x: float) -> float:
    """Return what is left of the law at a value of the unknown, which goes into `r`."""
    r[0] = x
    with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
    system(e, mode, v, e.work.w)
    return e.work.residual.at[0]


def ends_between(
    e: Engine, mode: Mode, v: Floats, r: Floats, near: float, far: float, here: float
) -> bool:
    """Halve what is between a value where the law has the sign of `here` and one where not.

    Whether the law holds where that ends: it may jump there, or have values no farther.
    """
    for _ in range(HALVES):
        middle = middle_of(near, far)
        if middle == near or middle == far:
            break
        if is_alike(residual_at(e, mode, v, r, middle), here):
            near = middle
        else:
            far = middle
    left = residual_at(e, mode, v, r, near)
    if math.fabs(residual_at(e, mode, v, r, far)) > math.fabs(left):
        residual_at(e, mode, v, r, near)
    rows = 1
    if not all_finite(rows, e.work.residual.at) or not all_finite(rows, e.work.jacobian.at):
        return False
    mode.regular = newton_step(e, rows, rows)
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
