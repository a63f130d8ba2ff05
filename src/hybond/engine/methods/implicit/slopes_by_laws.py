"""The Jacobian of a step of Radau IIA from the slopes of laws, where differences reach over a bend.

Two tanks that a pipe ``k*f*abs(f)`` joins empty as one. What drives the flow then is a part in 1e9
of what both hold, and any difference that is more than rounding moves it by much of itself: what
one tank does comes out as another slope than what the other does, and nothing is left of what both
do together. The laws have their slopes as expressions. Of these come the rates of bond variables by
what is stored, as a solution of the same linear equations that Newton solves: what cancels between
columns is written as such there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import rate_at
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value
from hybond.engine.mode.nonlinear.newton import by_knowns, source_of
from hybond.engine.mode.nonlinear.newton_system import system, write_bonds
from hybond.engine.mode.rows.storage import stiff
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.surfaces.values import set_motion
from hybond.engine.words import Floats

FAR: Final = 1e-3
"""Part of a rate that a difference moves it by where it may reach over a bend."""

LOST: Final = 1e-2
"""Part of what slows down over a step that rounding of slopes may be."""


def reaches_far(n: int, f: Floats, first: int, there: Floats) -> bool:
    """Whether the state that was shifted moves a rate by much of what it is, from `first` on."""
    for i in range(n):
        here = f[first + i]
        if math.fabs(there[i] - here) > FAR * math.fabs(here):
            return True
    return False


def may_be_by_laws(e: Engine, mode: Mode) -> bool:
    """Whether laws alone, as many as there are unknowns, stand between what is stored and rates.

    What is tied to others, or slides, has slopes by more than laws.
    """
    plain = mode.structures == 0 and mode.constraints.rows == 0 and e.slide.k == 0
    return plain and mode.dynamics > 0 and mode.finite_frees == mode.dynamics


def slopes_by_laws(e: Engine, r: Radau, t: float, y: Floats) -> None:
    """Make the Jacobian at a state, where laws have slopes; else it is what it was, of chords.

    Nor where slopes are so steep that a number has no digits for what is slow beside them: there
    the flow is driven by what is rounding of what is stored. What rates are rounded by is none.
    With edges, or limits that nothing reaches, slopes may be without bound: there differences stay.
    """
    m = e.model
    if m.begins == 0 or m.edges > 0 or m.bends > 0.0:
        return
    n = r.n
    r.chords = True
    if not may_be_by_laws(e, e.mode):
        return
    fit(r.differences, n * n)
    copy_floats(n * n, r.jacobian, r.differences.at)
    if not put_slopes_by_laws(e, r, t, y):
        copy_floats(n * n, r.differences.at, r.jacobian)
        return
    r.chords = False
    if e.mode.closely:
        fit(r.jacobian_rest, n * n)
        for k in range(n * n):
            r.jacobian_rest.at[k] = 0.0


def put_slopes_by_laws(e: Engine, r: Radau, t: float, y: Floats) -> bool:
    """Do so; False where that was in vain."""
    mode = e.mode
    m = e.model
    v = e.v
    frees = mode.finite_frees
    if rate_at(e, r.n, t, y, r.x_real) != OK:
        return False
    fit(r.by_laws, frees * frees)
    fit(r.laws_left, frees)
    fit(r.laws_now, mode.dynamics + mode.sources + m.integrals)
    fit(r.bonds_here, 2 * m.bonds)
    fit(r.bonds_moved, 2 * m.bonds)
    fit_places(r.by_laws_row, frees)
    copy_floats(2 * m.bonds, e.work.w, r.bonds_here.at)
    if system(e, mode, v, e.work.w) != frees:
        return False
    copy_floats(frees * frees, e.work.jacobian.at, r.by_laws.at)
    if not all_finite(frees * frees, r.by_laws.at):
        return False
    if lu_factor(frees, r.by_laws.at, r.by_laws_row.at) == SINGULAR:
        return False
    put_now(e, r, mode)
    found = True
    for j in range(r.n):
        found = move_one(e, r, mode, t, y, j) and found
    set_motion(e, v, t, y)
    write_bonds(e, v, r.bonds_here.at)
    most = 0.0
    for k in range(r.n * r.n):
        most = max(most, math.fabs(r.jacobian[k]))
    return found and EPSILON * most * r.h <= LOST


def put_now(e: Engine, r: Radau, mode: Mode) -> None:
    """Keep what laws, sources and rates of signals are where the step starts."""
    m = e.model
    now = r.laws_now.at
    for i in range(mode.dynamics):
        left = dynamic_value(e, mode, i, e.v)
        now[i] = left
    for k in range(mode.sources):
        given = source_of(e, mode, k, e.v)
        now[mode.dynamics + k] = given
    for k in range(m.integrals):
        there = value(m, m.integral_rate[k], e.v)
        now[mode.dynamics + mode.sources + k] = there


def move_one(e: Engine, r: Radau, mode: Mode, t: float, y: Floats, j: int) -> bool:
    """Put a column of the Jacobian: what state j moves, all else that is stored being held.

    What laws, sources and signals read of it themselves is a difference, which bends no law of
    what is between storages.
    """
    m = e.model
    v = e.v
    now = r.laws_now.at
    moved = r.bonds_moved.at
    frees = mode.finite_frees
    xi = e.work.xi
    for k in range(mode.knowns):
        xi[k] = 0.0
    for k in range(m.storages):
        for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
            if m.stiff_other[i] == j:
                slope = stiff(m, i, v)
                xi[k] = slope
    size = max(math.fabs(y[j]), r.made_for[j])
    for i in range(r.n):
        r.moved_state[i] = y[i]
    r.moved_state[j] += math.sqrt(EPSILON) * (size if size > 0.0 else 1.0)
    width = r.moved_state[j] - y[j]
    set_motion(e, v, t, r.moved_state)
    for k in range(mode.sources):
        given = source_of(e, mode, k, v)
        xi[m.storages + k] = (given - now[mode.dynamics + k]) / width
    by_knowns(e, mode, mode.finite, moved)
    for i in range(mode.dynamics):
        left = dynamic_value(e, mode, i, v)
        total = (left - now[i]) / width
        for k in range(2 * m.bonds):
            steep = e.work.slopes.at[i * 2 * m.bonds + k]
            if steep != 0.0:
                total += steep * moved[k]
        r.laws_left.at[i] = -total
    lu_solve(frees, r.by_laws.at, r.by_laws_row.at, 1, r.laws_left.at)
    for k in range(2 * m.bonds):
        for p in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
            share = mode.share_of.at[p]
            moved[k] += mode.finite_free.at[k * frees + share] * r.laws_left.at[share]
    if not all_finite(2 * m.bonds, moved):
        return False
    for k in range(m.storages):
        r.jacobian[k * r.n + j] = way_of_rate(m, k) * moved[rate_bond(m, k)]
    for k in range(2 * m.bonds):
        e.work.w[k] = r.bonds_here.at[k] + width * moved[k]
    write_bonds(e, v, e.work.w)
    found = True
    for k in range(m.integrals):
        there = value(m, m.integral_rate[k], v)
        change = there - now[mode.dynamics + mode.sources + k]
        r.jacobian[(m.storages + k) * r.n + j] = change / width
        found = found and math.isfinite(change)
    set_motion(e, v, t, y)
    write_bonds(e, v, r.bonds_here.at)
    return found
