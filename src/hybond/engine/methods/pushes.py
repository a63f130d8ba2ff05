"""The energy that what pushes would give in a moment: what rounding is measured by at rest.

Bodies at rest have no energy to measure rounding by, though great forces may hold them there. What
storages give to each other is no push: it is counted where it is stored, and as much of it comes
back. Nor is more given than what is stored takes in that moment: a capacitor behind a nano-ohm is
at the voltage of its source long before, and no further, while a current through it would be that
of a short circuit. So each push acts for one implicit step of Euler's over the moment, in which all
that settles faster has settled; what two capacitors have together that a nano-ohm joins does not.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_sparse,
    solve_sparse,
)
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.sizes import rate_of
from hybond.engine.mode.storage import own_stiffness, stiff


def forget_pushes(e: Engine) -> None:
    """Know of no push."""
    for k in range(e.model.storages):
        e.push_alone[k] = 0.0


def see_pushes(e: Engine, mode: Mode, moment: float) -> None:
    """Learn the energy that what pushes would give in such a time, each as if it were alone.

    That of each part is then in `e.work.part_here`.
    """
    m = e.model
    most = e.work.part_here
    for p in range(e.parts):
        most[p] = 0.0
    soon = False
    for k in range(m.storages):
        soon = soon or (e.push_alone[k] > 0.0 and settles_in(e, mode, k, moment))
    soon = soon and factor_step(e, mode, moment)
    for k in range(m.storages):
        if e.push_alone[k] > 0.0:
            p = e.storage_part[k]
            if soon and settles_in(e, mode, k, moment):
                energy = settled_energy(e, k)
            else:
                energy = (
                    0.5 * math.fabs(own_stiffness(m, k, e.v)) * e.push_alone[k] * e.push_alone[k]
                )
            if math.isfinite(energy):
                most[p] = max(most[p], energy)
    for p in range(e.parts):
        e.pushed_energy[p] = max(e.pushed_energy[p], most[p])


def settles_in(e: Engine, mode: Mode, k: int, moment: float) -> bool:
    """Whether what a port stores brings itself back within that time."""
    m = e.model
    rows = mode.finite
    at = mode.same[rate_of(m, k)]
    own = 0.0
    for i in range(rows.first.at[at], rows.first.at[at + 1]):
        if rows.column.at[i] == k:
            own += math.fabs(rows.value.at[i] * own_stiffness(m, k, e.v))
    return own * moment > 1.0 and math.isfinite(own)


def factor_step(e: Engine, mode: Mode, moment: float) -> bool:
    """Find the factors of that step; False if its slopes are no numbers, or rounding alone."""
    m = e.model
    f = e.work.step_of_pushes
    rows = mode.finite
    terms = m.storages
    for k in range(m.storages):
        at = mode.same[rate_of(m, k)]
        for i in range(rows.first.at[at], rows.first.at[at + 1]):
            j = rows.column.at[i]
            terms += m.stiff_first[j + 1] - m.stiff_first[j] if j < m.storages else 0
    begin_system(f, m.storages, terms)
    for k in range(m.storages):
        add_term(f, k, 1.0)
        at = mode.same[rate_of(m, k)]
        for i in range(rows.first.at[at], rows.first.at[at + 1]):
            j = rows.column.at[i]
            if j >= m.storages:
                continue
            for p in range(m.stiff_first[j], m.stiff_first[j + 1]):
                slope = moment * rows.value.at[i] * stiff(m, p, e.v)
                if not math.isfinite(slope):
                    return False
                add_term(f, m.stiff_other[p], -slope)
        end_equation(f)
    return factor_sparse(f, e.work.factoring)


def settled_energy(e: Engine, k: int) -> float:
    """Return the energy that the step makes of what is given to port k."""
    m = e.model
    push = e.work.here
    taken = e.work.ahead
    for j in range(m.storages):
        push[j] = 0.0
    push[k] = e.push_alone[k]
    solve_sparse(e.work.step_of_pushes, e.work.factoring, push, taken)
    total = 0.0
    for j in range(m.storages):
        total += 0.5 * math.fabs(own_stiffness(m, j, e.v)) * taken[j] * taken[j]
    return total
