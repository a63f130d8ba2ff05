"""Laws that hold at a jump of one of them or just beside it, though Newton's steps miss that.

What a spring brings to rest against ``sign(f)`` approaches the edge of what the sign gives, and
comes to it within the last digits of the spring: whether a flow is left that the law has a value
for is a matter of rounding then. So the flow is next to nothing, on either side, and the law gives
what it gives there; if it holds to rounding of its terms, that is the solution. What else is free
is looked for from where it was last, and from zero: what a `tanh` reads may have been far away.
What is known of what the sign reads may be the rounding of a sum that has come to zero, as where a
stop is met at that instant: then the flow is zero as well.

A law that jumps and one that is flat see the same unknown sum of what each is asked for. What one
of them is to take, slopes do not tell: at zero the one that jumps leaves all of it to the other.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.level import is_level, put_level
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import (
    largest_of,
    measured_system,
    system,
    with_free,
)
from hybond.engine.mode.nonlinear.put_back import HOLDS, all_hold
from hybond.engine.words import Floats

NEXT_TO_NOTHING: Final = 1e-290
"""What has a sign, and is no part of anything."""
NO_FREE: Final = -1
TURNS: Final = 20
SMALL: Final = 1e-13
"""Steps end that are below this part of the unknowns."""


def from_beside_jumps(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Look for free unknowns, into `r`, at which all laws hold beside a jump of one of them."""
    m = e.model
    if mode.rank != mode.structures:
        return False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0 or m.dynamic_jumps[d] != 1 or m.dynamic_partner[d] < 0:
            continue
        k = mode.same[m.dynamic_partner[d]]
        known = e.work.base[k]
        if is_level(e, mode, v, e.work.base, k):
            put_level(e, mode, e.work.base, k)
        j = free_alone(mode, k)
        # above the jump, below it, at the jump itself
        for turn in range(0 if j == NO_FREE else 6 if mode.guessed else 3):
            way = 1.0 if turn % 3 == 0 else -1.0 if turn % 3 == 1 else 0.0
            # beside what is known, next to nothing is nothing
            at = beside(mode, k, j, e.work.base, way)
            if way != 0.0 and at == beside(mode, k, j, e.work.base, 0.0):
                continue
            from_guess = mode.guessed and turn < 3
            found = holds_beside(e, mode, v, r, i, j, at, from_guess)
            if found and not (way != 0.0 and is_asked_by_another(e, mode, i, j)):
                return True
        for b in range(k, 2 * m.bonds):
            if mode.same[b] == k:
                e.work.base[b] = known
    return False


def free_alone(mode: Mode, k: int) -> int:
    """Return the free unknown that bond variable k goes with, beside what is known, or NO_FREE.

    Of a flow that passes through several elements one stands for all, whichever it is.
    """
    found = NO_FREE
    for j in range(mode.finite_frees):
        if mode.finite_free.at[k * mode.finite_frees + j] != 0.0:
            if found != NO_FREE:
                return NO_FREE
            found = j
    return found


def beside(mode: Mode, k: int, j: int, base: Floats, way: float) -> float:
    """Return unknown j where bond variable k is zero, or that way beside it next to nothing."""
    return way * NEXT_TO_NOTHING - base[k] / mode.finite_free.at[k * mode.finite_frees + j]


def holds_beside(
    e: Engine, mode: Mode, v: Floats, r: Floats, i: int, j: int, at: float, from_guess: bool
) -> bool:
    """Whether all laws hold where unknown j, which law i jumps with, is at or beside the jump.

    What else is free follows from the other laws.
    """
    work = e.work
    frees = mode.finite_frees
    for k in range(frees):
        r[k] = mode.guess.at[k] if from_guess else 0.0
    r[j] = at
    found = False
    for _ in range(TURNS):
        with_free(mode, 2 * e.model.bonds, work.base, r, work.w)
        rows = system(e, mode, v, work.w)
        if not all_finite(rows, work.residual.at):
            return False
        if not all_finite(rows * frees, work.jacobian.at):
            return False
        for k in range(frees):
            work.jacobian.at[i * frees + k] = 1.0 if k == j else 0.0
        work.residual.at[i] = 0.0
        newton_step(e, rows, frees)
        step = 0.0
        for k in range(frees):
            if k != j:
                r[k] -= work.step.at[k]
                step = max(step, math.fabs(work.step.at[k]))
        if step <= SMALL * largest_of(frees, r):
            found = True
            break
    if not found:
        return False
    with_free(mode, 2 * e.model.bonds, work.base, r, work.w)
    rows = measured_system(e, mode, v, work.w)
    mode.regular = False
    return all_hold(e, rows, HOLDS)


def is_asked_by_another(e: Engine, mode: Mode, i: int, j: int) -> bool:
    """Whether another law, at its own jump, gives unknown j, which is next to nothing for law i.

    A friction that has come to rest gives no force, not next to none: nothing says on which side of
    its jump the other law is, and both would have to have values between their limits.
    """
    m = e.model
    frees = mode.finite_frees
    for other in range(mode.dynamics):
        d = mode.dynamic[other]
        if other == i or d < 0 or m.dynamic_jumps[d] != 1 or m.dynamic_partner[d] < 0:
            continue
        if e.work.w[m.dynamic_partner[d]] == 0.0 and e.work.jacobian.at[other * frees + j] != 0.0:
            return True
    return False
