"""From laws that are linear enough to the given ones: where Newton does not find a solution.

A resistance stands beside each law and becomes ever smaller; each solution is where the next one
begins. Laws that saturate, and laws that are flat where nothing is known, are followed to their
solution, which monotone laws have once. Where the way ends, at a fold or beyond all bounds, there
is none.

Source: L. W. Nagel, *SPICE2*, 1975, gmin stepping.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.damped import damped
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import largest_of, system, with_free
from hybond.engine.words import Floats

STRONGEST: Final = 1e12
"""The resistance, or conductance, in SI units, up to which one is looked for to begin with."""
WEAKEST: Final = 1e-40
"""The part of the first one at which it is given up."""
FIRST_PART: Final = 0.1
LEAST_PART: Final = 1e-3
NO_PART: Final = 0.99
"""The next resistance is this part of the last one: at first, at the least, at the most."""
STILL: Final = 1e-3
"""Part of the largest unknown by which one may move where the way is about to end."""
TRIES: Final = 400


def continued(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Find the free unknowns, into `r`, on the way from laws with a resistance beside them."""
    work = e.work
    frees = mode.finite_frees
    helped = False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        helped = helped or (d >= 0 and e.model.dynamic_partner[d] >= 0)
    if not helped:
        return False
    fit(work.begun, frees)
    work.aid = 1.0
    found = False
    while not found and work.aid <= STRONGEST:
        for j in range(frees):
            r[j] = 0.0
        found = damped(e, mode, v, r)
        if not found and jumps(e, mode):
            found = beyond_jumps(e, mode, v, r) and damped(e, mode, v, r)
        if not found:
            work.aid *= 1e3
    found = found and weaken(e, mode, v, r)
    work.aid = 0.0
    return found


def jumps(e: Engine, mode: Mode) -> bool:
    """Whether a law of the mode jumps."""
    some = False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        some = some or (d >= 0 and e.model.dynamic_jumps[d] != 0)
    return some


def beyond_jumps(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Take one whole step from zero: beside a resistance its sides are those of the solution.

    At zero a sign is zero, and the step the one without it; no shorter step leads past the jump,
    behind which all that is left is larger.
    """
    frees = mode.finite_frees
    for j in range(frees):
        r[j] = 0.0
    with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
    rows = system(e, mode, v, e.work.w)
    if not all_finite(rows, e.work.residual.at):
        return False
    if not all_finite(rows * frees, e.work.jacobian.at):
        return False
    newton_step(e, rows, frees)
    for j in range(frees):
        r[j] -= e.work.step.at[j]
    return True


def weaken(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Make the resistance smaller until there is a solution without one."""
    work = e.work
    frees = mode.finite_frees
    first = work.aid
    part = FIRST_PART
    rests = False
    for _ in range(TRIES):
        copy_floats(frees, r, work.begun.at)
        aid = work.aid
        if rests or is_small(e, mode, r):
            work.aid = 0.0
            if damped(e, mode, v, r):
                return True
            copy_floats(frees, work.begun.at, r)
        if aid < WEAKEST * first:
            return False
        work.aid = part * aid
        if damped(e, mode, v, r):
            rests = moved_little(frees, work.begun.at, r)
            part = max(part * part, LEAST_PART)
        else:
            rests = False
            copy_floats(frees, work.begun.at, r)
            work.aid = aid
            part = math.sqrt(part)
            if part > NO_PART:
                return False
    return False


def moved_little(frees: int, before: Floats, after: Floats) -> bool:
    """Whether a weaker resistance has moved no unknown by much of the largest.

    A law that gives nothing has nothing beside which its resistance would be small: a valve that
    is shut, beside one that has all but reached its limit.
    """
    moved = 0.0
    for j in range(frees):
        moved = max(moved, math.fabs(after[j] - before[j]))
    return moved <= STILL * largest_of(frees, after)


def is_small(e: Engine, mode: Mode, r: Floats) -> bool:
    """Whether what the resistance adds to each law is a small part of the law."""
    m = e.model
    work = e.work
    n = 2 * m.bonds
    with_free(mode, n, work.base, r, work.w)
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0 or m.dynamic_partner[d] < 0:
            continue
        aid = math.fabs(work.aid * work.w[m.dynamic_partner[d]])
        own = 0.0
        for k in range(n):
            if k != m.dynamic_partner[d]:
                own = max(own, math.fabs(work.slopes.at[i * n + k] * work.w[k]))
        if aid > 0.1 * own:
            return False
    return True
