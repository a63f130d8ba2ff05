"""Laws of which one is at its jump, and what else is free as if that were no law.

Where a flow that is to be nothing is the sum of others, no unknown says so, and the sign of what
steps leave of it leads them from side to side. With the flow held at zero the others are laws
without this jump. What is found is a solution if this law holds there as well.
"""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.continuation import continued
from hybond.engine.mode.nonlinear.damped import damped
from hybond.engine.mode.nonlinear.newton_system import measured_system, with_free
from hybond.engine.mode.nonlinear.put_back import HOLDS, all_hold
from hybond.engine.words import Floats


def at_jumps(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Look for free unknowns, into `r`, at which all laws hold and one of them is at its jump."""
    m = e.model
    if mode.rank != mode.structures:
        return False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0 or m.dynamic_jumps[d] != 1 or m.dynamic_partner[d] < 0:
            continue
        for j in range(mode.finite_frees):
            r[j] = 0.0
        e.work.held_jump = i + 1
        found = damped(e, mode, v, r) or continued(e, mode, v, r)
        e.work.held_jump = 0
        if found:
            with_free(mode, 2 * m.bonds, e.work.base, r, e.work.w)
            rows = measured_system(e, mode, v, e.work.w)
            mode.regular = False
            if all_hold(e, rows, HOLDS):
                return True
    return False
