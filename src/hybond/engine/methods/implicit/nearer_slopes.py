"""Slopes over much shorter differences, where the usual ones reach over a bend of a law.

A resistor ``k*f*abs(f)`` between stiff storages takes next to nothing of their efforts, and lets
the root of that flow. What the usual difference shifts a state by may be more than all that drives
the flow: its slope is that of a chord then, by which stages do not converge however smoothly the
motion follows, and steps would be as short as the settling. That is seen where stages fail, from
the slopes that both give; from there on, until something jumps, differences are the shorter ones.
Rounding tells more in these: where stages go on to fail, they are the usual ones again. What is
written as a root has edges, and ways of its own.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import Engine
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_slopes import differences

NEARER: Final = 2.0**-10
"""The part of the usual difference, in which a bend is straight and rounding does not tell yet."""
ENOUGH_TRIED: Final = 6
"""Attempts that failed with such slopes after which the usual ones are taken again."""
OTHER: Final = 0.1
"""Part by which slopes are to differ, of what settles within the step by itself."""


def takes_nearer_slopes(e: Engine, r: Radau, rtol: float) -> bool:
    """Whether slopes over a shorter difference are others; then the step has those.

    Once for each beginning of a step.
    """
    if r.nearer < 1.0 and r.rejected >= ENOUGH_TRIED:
        r.nearer = 1.0
        r.doubted_at = r.t0
        differences(e, r, rtol, False)
        return True
    if r.nearer < 1.0 or r.doubted_at == r.t0 or r.sided:
        return False
    if e.model.edges > 0 or e.model.bends > 0.0:
        return False
    n = r.n
    r.doubted_at = r.t0
    fit(r.slopes_before, n * n)
    copy_floats(n * n, r.jacobian, r.slopes_before.at)
    from_before = r.twofold_from
    r.nearer = NEARER
    differences(e, r, rtol, False)
    for i in range(n):
        before = math.fabs(r.slopes_before.at[i * n + i])
        now = math.fabs(r.jacobian[i * n + i])
        most = max(before, now)
        if math.fabs(now - before) > OTHER * most and r.h * most > 1.0:
            return True
    r.nearer = 1.0
    copy_floats(n * n, r.slopes_before.at, r.jacobian)
    r.twofold_from = from_before
    return False
