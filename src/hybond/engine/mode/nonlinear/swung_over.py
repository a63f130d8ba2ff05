"""One law alone, over whose root Newton's steps swing: an amplifier at one limit, then the other.

Both limits are flat, and from each of them a step leads to the other; parts of a step lead to a
root only if one of them happens to end in what is steep between, a part in 100,000 of the way. But
the law has one sign at one limit and the other at the other. So what is between them is halved up
to where a step stays there and leaves less of the law. From there Newton's steps are full ones.

Only where the law has one solution, as it would not be the one that shorter steps lead to.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.enclosed import is_alike, residual_at
from hybond.engine.mode.nonlinear.followed_records import NEVER
from hybond.engine.mode.nonlinear.several import may_have_several
from hybond.engine.words import Floats

TIMES: Final = 64
"""Halves that are taken: fewer than a number has digits and powers of two."""
LESS: Final = 0.5
"""Part of what a law leaves that a step may leave of it."""


def led_between(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Lead the one unknown from where full steps have ended to where one of them helps."""
    if mode.finite_frees != 1 or mode.dynamics != 1 or mode.rank != mode.structures:
        return False
    if may_have_several(e, mode) or mode.branch.others != NEVER:
        return False
    near = r[0]
    there = residual_at(e, mode, v, r, 0, 0, near)
    far = next_of(e, near)
    beyond = residual_at(e, mode, v, r, 0, 0, far)
    if not is_between(there, beyond):
        return False
    guess = mode.guess.at[0] if mode.guessed else 0.0
    if (guess - near) * (guess - far) < 0.0:
        left = residual_at(e, mode, v, r, 0, 0, guess)
        if is_alike(left, there):
            near = guess
        elif is_alike(left, beyond):
            far = guess
    for _ in range(TIMES):
        middle = 0.5 * near + 0.5 * far
        left = residual_at(e, mode, v, r, 0, 0, middle)
        if left != left or middle == near or middle == far:
            return False
        after = next_of(e, middle)
        if (after - near) * (after - far) < 0.0:
            less = residual_at(e, mode, v, r, 0, 0, after)
            if math.fabs(less) <= LESS * math.fabs(left):
                r[0] = after
                return True
        if is_alike(left, there):
            near = middle
        else:
            far = middle
    return False


def next_of(e: Engine, x: float) -> float:
    """Return where a step leads from where the law was asked last; `x` if it leads nowhere."""
    if not all_finite(1, e.work.jacobian.at) or e.work.jacobian.at[0] == 0.0:
        return x
    there = x - e.work.residual.at[0] / e.work.jacobian.at[0]
    return there if math.isfinite(there) else x


def is_between(a: float, b: float) -> bool:
    """Whether zero is between two numbers."""
    return (a < 0.0 and b > 0.0) or (a > 0.0 and b < 0.0)
