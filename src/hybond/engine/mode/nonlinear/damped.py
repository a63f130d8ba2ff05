"""Newton with steps that are shortened until they help.

Full steps jump to and fro where a law is bent like a root on both sides of rest: two orifices in a
row. A step is taken as far as the *next* one, with the same slopes, becomes smaller. Where each
step is half of the one before, as towards the root of a square, twice the step leads there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton_step import TOLERANCE, newton_step
from hybond.engine.mode.nonlinear.newton_system import (
    LAST_PLACES,
    is_zero,
    largest_of,
    system,
    with_free,
)
from hybond.engine.mode.nonlinear.put_back import is_exact, put_back
from hybond.engine.words import Floats

DAMPED_STEPS: Final = 200
SETTLED: Final = 1e-6
"""A step that is below this part of an unknown leaves nothing of it: the next one is its square."""
HALVES: Final = 0.02
"""Part of the largest step by which steps may differ from half of those before."""
TWICE: Final = 0.1
"""What is left of a step after twice it, if that was one towards the root of a square."""
UNSEEN: Final = 1e-6
"""Part of a weight that rounding of a zero is: as much as leaves nothing of an unknown."""
SHORTEST: Final = 2.0**-30
"""The smallest part of a step that is tried."""


def damped(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Go from `r` to a root; False if none is found."""
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    fit(work.whole, frees)
    fit(work.weight, frees)
    fit(work.trial, frees)
    fit(work.before, frees)
    for j in range(frees):
        work.weight.at[j] = 0.0
        work.before.at[j] = 0.0
    for _ in range(DAMPED_STEPS):
        with_free(mode, n, work.base, r, work.w)
        rows = system(e, mode, v, work.w)
        if is_zero(rows, work.residual.at):
            mode.regular = False
            return True
        if not all_finite(rows, work.residual.at):
            return False
        if not all_finite(rows * frees, work.jacobian.at):
            return False
        mode.regular = newton_step(e, rows, frees)
        size = largest_of(frees, r)
        small = True
        last = True
        for j in range(frees):
            step = math.fabs(work.step.at[j])
            work.whole.at[j] = work.step.at[j]
            work.weight.at[j] = max(work.weight.at[j], max(math.fabs(r[j]), step))
            small = small and step <= TOLERANCE * size
            last = last and step <= SETTLED * math.fabs(r[j])
        last = last and small
        halves = is_half(frees, work.step.at, work.before.at)
        part = 1.0
        if not last:
            fit(work.slopes_there, rows * frees)
            copy_floats(rows * frees, work.jacobian.at, work.slopes_there.at)
            part = 2.0 if halves and helps(e, mode, v, r, rows, 2.0) else 0.0
            if part == 0.0:
                part = helpful_part(e, mode, v, r, rows)
            if part == 0.0 and rounding_weighs(e, rows, frees):
                part = helpful_part(e, mode, v, r, rows)
            # what no part of a step makes smaller is rounding if it is small beside the others
            last = part == 0.0 and small
        for j in range(frees):
            r[j] -= part * work.whole.at[j]
            work.before.at[j] = part * work.whole.at[j]
        if last:
            with_free(mode, n, work.base, r, work.w)
            return put_back(e, mode, v, work.w)
        if part == 0.0:
            met = is_rounding_of_all(e, mode, v, r)
            work.met_rounding = work.met_rounding or met
            return met and work.takes_rounding
    return False


def is_rounding_of_all(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Whether what no part of a step makes smaller is the rounding of all laws.

    Where every unknown passes through zero at once, as the effort and the flow of a root do, none
    of them tells how small a step is. Of a law that is flat there it tells nothing: other ways to a
    solution go before.
    """
    with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
    rows = system(e, mode, v, e.work.w)
    return put_back(e, mode, v, e.work.w) and is_exact(e, mode, v, rows)


def is_half(frees: int, step: Floats, before: Floats) -> bool:
    """Whether a step is half of the one before."""
    most = largest_of(frees, before)
    half = most > 0.0
    for j in range(frees):
        half = half and math.fabs(step[j] - 0.5 * before[j]) <= HALVES * most
    return half


def rounding_weighs(e: Engine, rows: int, frees: int) -> bool:
    """Give unknowns that the others leave nothing but rounding a weight beside it; False: none.

    What is zero has no size of its own: whatever part of a step is taken, the next one changes it
    by as much again, and says nothing of those that are not zero.
    """
    work = e.work
    if rows != frees:
        return False
    fit(work.rounded, frees)
    fit(work.trial, frees)
    fit(work.jacobian2, rows * frees)
    fit_places(work.pivots, rows)
    copy_floats(rows * frees, work.slopes_there.at, work.jacobian2.at)
    if lu_factor(rows, work.jacobian2.at, work.pivots.at) == SINGULAR:
        return False
    for j in range(frees):
        work.rounded.at[j] = 0.0
    for i in range(rows):
        size = work.residual_size.at[i]
        for j in range(frees):
            size += math.fabs(work.slopes_there.at[i * frees + j] * work.whole.at[j])
        for j in range(frees):
            work.trial.at[j] = 0.0
        work.trial.at[i] = LAST_PLACES * size
        lu_solve(rows, work.jacobian2.at, work.pivots.at, 1, work.trial.at)
        for j in range(frees):
            work.rounded.at[j] += math.fabs(work.trial.at[j])
    found = False
    for j in range(frees):
        rounded = work.rounded.at[j]
        if math.fabs(work.whole.at[j]) <= rounded and work.weight.at[j] * UNSEEN < rounded:
            work.weight.at[j] = rounded / UNSEEN
            found = True
    return found


def helpful_part(e: Engine, mode: Mode, v: Floats, r: Floats, rows: int) -> float:
    """Return the part of the whole step from `r` after which the next one is smaller; 0: none."""
    part = 1.0
    while part >= SHORTEST:
        if helps(e, mode, v, r, rows, part):
            return part
        part *= 0.5
    return 0.0


def helps(e: Engine, mode: Mode, v: Floats, r: Floats, rows: int, part: float) -> bool:
    """Whether the next step is smaller after a part of the whole one, or next to none after two."""
    work = e.work
    frees = mode.finite_frees
    length = weighted(e, frees, work.whole.at)
    for j in range(frees):
        work.trial.at[j] = r[j] - part * work.whole.at[j]
    with_free(mode, 2 * e.model.bonds, work.base, work.trial.at, work.w)
    system(e, mode, v, work.w)
    if not all_finite(rows, work.residual.at):
        return False
    copy_floats(rows * frees, work.slopes_there.at, work.jacobian.at)
    newton_step(e, rows, frees)
    most = 1.0 - 0.5 * part if part <= 1.0 else TWICE
    return weighted(e, frees, work.step.at) <= most * length


def weighted(e: Engine, n: int, a: Floats) -> float:
    """Return the largest magnitude of a step, each part of it measured by its weight."""
    most = 0.0
    for j in range(n):
        weight = e.work.weight.at[j]
        most = max(most, math.fabs(a[j]) / (weight if weight > 0.0 else 1.0))
    return most
