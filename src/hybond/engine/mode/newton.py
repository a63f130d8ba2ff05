"""Bond variables of a mode at one instant: a product with what is known, or Newton's method.

Newton solves in the unknowns that elimination left free.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Rows, fit, row_times
from hybond.engine.algebra.products import all_finite, times_orthonormal
from hybond.engine.algebra.svd import null_space
from hybond.engine.engine import NOT_FINITE, OK, Engine, say_fault, svd_room
from hybond.engine.mode.damped import shorter_steps
from hybond.engine.mode.dynamic_rows import dynamic_value, slopes_at
from hybond.engine.mode.leakage import project
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.newton_system import (
    is_zero,
    largest_of,
    newton_step,
    system,
    with_free,
    write_bonds,
)
from hybond.engine.mode.storage import co_energy
from hybond.engine.model import node_name, value
from hybond.engine.reasons.facts import NO_ELEMENT, OVERFLOW, tell_law, tell_laws
from hybond.engine.words import Floats, Text

STEPS: Final = 40
ASIDE: Final = 3
"""Times that Newton leaves a point where the laws are flat."""
TOLERANCE: Final = 1e-13
"""Newton ends when an update is below this part of the bond variables' size."""
RANK_TOLERANCE: Final = 1e-10


def knowns_of(e: Engine, mode: Mode, v: Floats, rates: bool) -> None:
    """Put co-energy variables, values and, if asked for, rates of sources into `e.work.xi`."""
    m = e.model
    xi = e.work.xi
    co_energy(m, v, xi)
    for k in range(mode.sources):
        source = mode.source[k]
        law = m.source_value[source] if source >= 0 else -1
        xi[m.storages + k] = mode.source_level[k] if law < 0 else value(m, law, v)
        at = m.storages + mode.sources + k
        xi[at] = 0.0
        if rates and mode.rated[k] != 0:
            xi[at] = value(m, m.source_rate[source], v)


def by_knowns(e: Engine, mode: Mode, rows: Rows, w: Floats) -> None:
    """Put what the knowns give to bond variables by such rows into `w`."""
    xi = e.work.xi
    n = 2 * e.model.bonds
    for k in range(n):
        same = mode.same[k]
        w[k] = w[same] if same < k else row_times(rows, k, xi)


def solve(e: Engine, mode: Mode, v: Floats) -> int:
    """Put the bond variables into `e.work.w` and write them into `v`.

    OK, or NOT_FINITE with a fault noted: HB-N301 if Newton does not converge, HB-N302 if a law has
    no value.
    """
    w = e.work.w
    knowns_of(e, mode, v, True)
    if mode.dynamics == 0:
        by_knowns(e, mode, mode.direct, w)
    elif newton(e, mode, v) != OK:
        return NOT_FINITE
    elif mode.leakage.stages > 0:
        project(mode.leakage, 2 * e.model.bonds, w)
    write_bonds(e, v, w)
    return OK


def newton(e: Engine, mode: Mode, v: Floats) -> int:
    """Solve for the free unknowns, from where Newton ended last."""
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    base = work.base
    w = work.w
    by_knowns(e, mode, mode.finite, base)
    fit(work.step, frees + mode.dynamics + 1)
    fit(work.guess, frees + 1)
    r = work.guess.at
    for j in range(frees):
        r[j] = mode.guess.at[j] if mode.guessed else 0.0
    update = math.inf
    aside = 0
    for _ in range(STEPS):
        with_free(mode, n, base, r, w)
        rows = system(e, mode, v, w)
        if not all_finite(rows, work.residual.at):
            return blame(e, mode, v)
        if is_zero(rows, work.residual.at):
            # exact already, even where a law has no slope: a root at zero flow
            keep_guess(mode, r)
            return OK
        if not all_finite(rows * frees, work.jacobian.at):
            return blame(e, mode, v)
        newton_step(e, rows, frees)
        scale = largest_of(n, base) + largest_of(frees, r)
        if aside < ASIDE and stands_still(e, mode, rows, frees):
            # flat here (a quadratic law at zero flow), yet not satisfied: look aside
            aside += 1
            for j in range(frees):
                r[j] += (
                    math.pow(10.0, -3.0 * float(aside)) * max(scale, 1e-6) * (1.0 + 0.1 * float(j))
                )
            update = math.inf
            continue
        previous = update
        update = largest_of(frees, work.step.at)
        for j in range(frees):
            r[j] -= work.step.at[j]
        if mode.affine:
            # one step from anywhere is exact
            update = 0.0
        # rounding keeps a step from vanishing: stop as well when it no longer shrinks
        if update <= TOLERANCE * scale or (update <= 1e-9 * scale and update >= 0.5 * previous):
            with_free(mode, n, base, r, w)
            keep_guess(mode, r)
            return OK
    if shorter_steps(e, mode, v, TOLERANCE):
        with_free(mode, n, base, r, w)
        keep_guess(mode, r)
        return OK
    mode.guessed = False
    say_fault(e, "HB-N301", "laws have no solution near the last one", first_place(e, mode))
    if e.model.tells != 0:
        tell_laws(e, mode)
    e.fault.t = v[0]
    return NOT_FINITE


def keep_guess(mode: Mode, r: Floats) -> None:
    """Keep where Newton ended."""
    for j in range(mode.finite_frees):
        mode.guess.at[j] = r[j]
    mode.guessed = True


def stands_still(e: Engine, mode: Mode, rows: int, frees: int) -> bool:
    """Whether a step leaves a part of the residual that the slopes here cannot reach."""
    if mode.affine:
        return False
    work = e.work
    much = False
    most = 0.0
    for i in range(rows):
        total = work.residual.at[i]
        for j in range(frees):
            total -= work.jacobian.at[i * frees + j] * work.step.at[j]
        rest = math.fabs(total)
        much = much or rest > 0.5 * math.fabs(work.residual.at[i])
        most = max(most, rest)
    return much and most > 0.0


def first_place(e: Engine, mode: Mode) -> Text:
    """Return the first element whose law is evaluated in a mode."""
    m = e.model
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0:
            return node_name(m, m.dynamic_node[mode.dynamic[i]])
    return ""


def blame(e: Engine, mode: Mode, v: Floats) -> int:
    """Name the law whose value or slope is not a number."""
    m = e.model
    n = 2 * m.bonds
    mode.guessed = False
    slopes_at(e, mode, v, e.work.slopes)
    for i in range(mode.dynamics):
        steep = False
        for k in range(n):
            steep = steep or not math.isfinite(e.work.slopes.at[i * n + k])
        if steep or not math.isfinite(dynamic_value(e, mode, i, v)):
            d = mode.dynamic[i]
            place = node_name(m, m.dynamic_node[d]) if d >= 0 else "a constraint's derivative"
            say_fault(e, "HB-N302", "a law has no finite value or slope", place)
            if m.tells != 0:
                element = m.dynamic_node[d] if d >= 0 else NO_ELEMENT
                tell_law(e, mode, element, dynamic_value(e, mode, i, v))
            e.fault.t = v[0]
            return NOT_FINITE
    say_fault(e, "HB-N302", "the equations overflow", "")
    if m.tells != 0:
        tell_law(e, mode, OVERFLOW, 0.0)
    e.fault.t = v[0]
    return NOT_FINITE


def freedom_at(e: Engine, mode: Mode, v: Floats) -> int:
    """Return in how many directions bond variables are free at this point, into `e.work.freedom`.

    Bond variables in `v` are the solution.
    """
    m = e.model
    work = e.work
    n = 2 * m.bonds
    frees = mode.finite_frees
    if mode.dynamics == 0 or frees == 0:
        fit(work.freedom, n * max(mode.loose, 1))
        for i in range(n * mode.loose):
            work.freedom.at[i] = mode.freedom.at[i]
        return mode.loose
    for k in range(n):
        work.w[k] = v[m.bond_slot + k]
    rows = system(e, mode, v, work.w)
    size = 0.0
    for i in range(rows * frees):
        if math.isfinite(work.jacobian.at[i]):
            size = max(size, math.fabs(work.jacobian.at[i]))
    for i in range(rows * frees):
        if not math.isfinite(work.jacobian.at[i]):
            # a slope without bound (a root at zero) fixes its variable like any other
            work.jacobian.at[i] = size if size > 0.0 else 1.0
    fit(work.a, frees * frees)
    d = svd_room(e, max(rows, frees), max(rows, frees))
    many = null_space(d, rows, frees, work.jacobian.at, RANK_TOLERANCE, work.a.at)
    fit(work.freedom, n * max(many, 1))
    times_orthonormal(n, frees, many, mode.finite_free.at, work.a.at, work.freedom.at)
    return many
