"""What laws leave free at the values that hold, and least leakage there.

A direction is free if the slopes of all laws see nothing of it, and if the laws still hold when the
values move along it: an orifice at rest has no slope, but one flow. Values that are determined stay
as Newton found them.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.products import all_finite, copy_floats, copy_part, times_cancelling
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.left_free.lasting import is_free_at_corners
from hybond.engine.mode.left_free.leakage import least_leakage, project
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.flat_sides import is_at_corner
from hybond.engine.mode.nonlinear.freedom import directions_left
from hybond.engine.mode.nonlinear.newton import keep_residuals
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import measured_system, system, write_bonds
from hybond.engine.mode.nonlinear.put_back import HOLDS, ROUNDINGS, UNIT, all_hold, excess
from hybond.engine.mode.nonlinear.solved_apart import all_determined
from hybond.engine.words import Floats

ASIDE: Final = 1e-4
"""The part of the values by which they are moved to see whether laws still hold."""
FLAT: Final = 1e-13
"""Part of its terms by which a law may change on that way: what its slopes, known to 1e-10, hide of
it, and rounding. A square changes by more, however small it is beside large terms that cancel."""
HALVINGS: Final = 60
LAST: Final = 2.0**-52
"""Part of the way that is its rounding."""
ALONG: Final = 1e-12
"""Part of its terms by which a law may be off that ends the way to least leakage, as where a valve
begins to open: all the way, none is what it would be solved to."""

FARTHER: Final = 1e-6
"""Part of the rest of a way by which one looks beyond its end for the law that ends it."""
BACK: Final = 1e-9
"""Part of the way to where laws no longer hold that is left."""


def least_of_free(e: Engine, mode: Mode, v: Floats, w: Floats) -> None:
    """Replace what laws leave free in the solution `w` of Newton by what has least leakage.

    Where the laws do not hold all the way, as far as they do, and on along the corners of those
    that end it.
    """
    let_go(e, mode)
    if mode.clear and not is_free_at_corners(e, mode, v, w):
        take_unseen(e, mode)
        project(mode.leakage, 2 * e.model.bonds, w)
        return
    mode.regular = mode.regular or all_determined(e, mode, v, w)
    if mode.regular and not is_free_at_corners(e, mode, v, w):
        mode.loose = 0
        mode.leakage.stages = 0
        return
    find_free(e, mode, v, w)
    turns = 0
    while mode.loose > 0 and turns <= e.model.flats:
        turns += 1
        part = to_least(e, mode, v, w)
        if part == 1.0 or mode.loose == 1 or not keep_at_corner(e, mode, v, w, part):
            break
        find_free(e, mode, v, w)
    if turns > 1:
        # what is left free there is so whichever corners the way has met
        let_go(e, mode)
        find_free(e, mode, v, w)


def take_unseen(e: Engine, mode: Mode) -> None:
    """Let bond variables be free as what no law sees moves them, and nothing else."""
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    many = mode.unseen
    fit(e.work.b, n * many)
    times_cancelling(n, frees, many, mode.finite_free.at, mode.unseen_ways.at, e.work.b.at)
    fit(mode.freedom, n * many)
    keep_moving(n, many, many, e.work.b.at, mode.freedom.at)
    mode.loose = many
    least_leakage(e, mode, many, mode.freedom.at, mode.leakage)


def let_go(e: Engine, mode: Mode) -> None:
    """Keep no law at its corner."""
    fit_places(e.work.kept_at_corner, mode.dynamics)
    for i in range(mode.dynamics):
        e.work.kept_at_corner.at[i] = 0


def to_least(e: Engine, mode: Mode, v: Floats, w: Floats) -> float:
    """Move `w` to what has least leakage, or as far as laws hold; return that part of the way."""
    work = e.work
    n = 2 * e.model.bonds
    fit(work.begun, n)
    fit(work.moved, n)
    for k in range(n):
        work.begun.at[k] = w[k]
        work.moved.at[k] = w[k]
    project(mode.leakage, n, work.moved.at)
    part = 1.0
    most = HOLDS
    if not mode.affine and holds_at(e, mode, v, work.begun.at, ALONG):
        most = ALONG
    if not mode.affine and not holds_at(e, mode, v, work.moved.at, most):
        part = end_of_way(e, mode, v, w, most)
    for k in range(n):
        w[k] = work.moved.at[k]
        if part < 1.0:
            w[k] = work.begun.at[k] + part * (work.moved.at[k] - work.begun.at[k])
    return part


def keep_at_corner(e: Engine, mode: Mode, v: Floats, w: Floats, part: float) -> bool:
    """Keep the law that has ended a way at its corner, if it is at one; whether it is another one.

    The way goes on along the corner then: of three dead zones in series one is full, and two share
    what is left.
    """
    work = e.work
    n = 2 * e.model.bonds
    if mode.rank != mode.structures:
        return False
    beyond = part + FARTHER * (1.0 - part)
    for k in range(n):
        work.moved.at[k] = work.begun.at[k] + beyond * (work.moved.at[k] - work.begun.at[k])
    rows = laws_measured(e, mode, v, work.moved.at)
    worst = -1
    most = 0.0
    for i in range(rows):
        off = excess(e, i, ALONG)
        if off > most:
            most = off
            worst = i
    write_bonds(e, v, w)
    if worst < 0 or work.kept_at_corner.at[worst] != 0 or not is_at_corner(e, mode, worst, v, w):
        return False
    work.kept_at_corner.at[worst] = 1
    return True


def end_of_way(e: Engine, mode: Mode, v: Floats, w: Floats, most: float) -> float:
    """Return up to which part of the way from `begun` to `moved` all laws hold.

    Beyond it they are off by more and more, along a straight line where it ends at the corner of
    one: that line is followed back, and else the way is halved.
    """
    work = e.work
    n = 2 * e.model.bonds
    low = 0.0
    high = 1.0
    gap = LAST
    back = math.nan
    off = math.nan
    for turn in range(2 * HALVINGS):
        if high - low <= 2.0 * LAST * high:
            break
        part = 0.5 * (low + high)
        if turn % 2 == 1 and math.isfinite(back):
            part = min(max(back, low + gap * high), high - gap * high)
            gap *= 16.0
            if part <= low or part >= high:
                part = 0.5 * (low + high)
        for k in range(n):
            w[k] = work.begun.at[k] + part * (work.moved.at[k] - work.begun.at[k])
        here = excess_at(e, mode, v, w, most)
        if here <= 0.0:
            low = part
        else:
            back = part - here * (high - part) / (off - here) if off > here else math.nan
            high = part
            off = here
    return low


def far_held(
    e: Engine, mode: Mode, begin: Floats, v: Floats, direction: Floats, far: float
) -> float:
    """Return how far along a direction, up to `far`, bond variables may go from where they `begin`.

    That is as far as all laws hold, less a part of it by which they are off there.
    """
    work = e.work
    n = 2 * e.model.bonds
    fit(work.moved, n)
    low = 0.0
    high = 1.0
    part = 1.0
    for _ in range(HALVINGS):
        for k in range(n):
            work.moved.at[k] = begin[k] + part * far * direction[k]
        if holds_at(e, mode, v, work.moved.at, ALONG):
            low = part
        else:
            high = part
        if low == 1.0:
            return far
        part = 0.5 * (low + high)
    return (1.0 - BACK) * low * far


def freedom_at(e: Engine, mode: Mode, v: Floats) -> int:
    """Return in how many directions bond variables are free at this point, into `e.work.freedom`.

    Bond variables in `v` are the solution.
    """
    m = e.model
    work = e.work
    n = 2 * m.bonds
    if mode.dynamics > 0 and mode.finite_frees > 0:
        copy_part(n, v, m.bond_slot, work.w, 0)
        let_go(e, mode)
        find_free(e, mode, v, work.w)
    fit(work.freedom, n * max(mode.loose, 1))
    copy_floats(n * mode.loose, mode.freedom.at, work.freedom.at)
    return mode.loose


def find_free(e: Engine, mode: Mode, v: Floats, w: Floats) -> None:
    """Find the directions in which bond variables are free at the solution `w`, and their leakage.

    Into `mode.freedom`, `mode.loose` and `mode.leakage`.
    """
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    corners = is_free_at_corners(e, mode, v, w)
    if not corners and all_determined(e, mode, v, w):
        mode.loose = 0
        mode.leakage.stages = 0
        return
    work.flat_sides = corners
    rows = system(e, mode, v, w)
    work.flat_sides = False
    mode.loose = 0
    mode.leakage.stages = 0
    if not all_finite(rows * frees, work.jacobian.at):
        return
    if newton_step(e, rows, frees):
        return
    count_alone(e, mode)
    fit(work.a, frees * frees)
    many = directions_left(e, rows, frees, work.jacobian.at, work.a.at)
    if many == 0:
        return
    fit(work.b, n * many)
    times_cancelling(n, frees, many, mode.finite_free.at, work.a.at, work.b.at)
    fit(mode.freedom, n * many)
    fit(work.moved, n)
    for j in range(many):
        moves = mode.affine or may_move(e, mode, v, w, many, j)
        if moves or (corners and moves_corner(e, mode, v, w, many, j)):
            mode.loose += 1
        else:
            for k in range(n):
                work.b.at[k * many + j] = 0.0
    keep_moving(n, many, mode.loose, work.b.at, mode.freedom.at)
    write_bonds(e, v, w)
    least_leakage(e, mode, mode.loose, mode.freedom.at, mode.leakage)


def count_alone(e: Engine, mode: Mode) -> None:
    """Let laws that read what is free with a slope that is zero here, and not beside, count for it.

    At rest a flow through ``k*f*abs(f)`` has no slope, and still is nothing but zero: whatever such
    a law reads moves nowhere, if it reads nothing else that is free.
    """
    m = e.model
    work = e.work
    frees = mode.finite_frees
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        empty = d >= 0
        for j in range(frees):
            empty = empty and work.jacobian.at[i * frees + j] == 0.0
        if not empty:
            continue
        seen = 0
        read = -1
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            if is_free(mode, m.slope_column[p]):
                seen += 1
                read = m.slope_column[p] if m.slope_isolated[p] != 0 else -1
        if seen == 1 and read >= 0:
            for j in range(frees):
                work.jacobian.at[i * frees + j] = mode.finite_free.at[read * frees + j]


def is_free(mode: Mode, b: int) -> bool:
    """Whether a bond variable hangs on unknowns that are solved for."""
    found = False
    for j in range(mode.finite_frees):
        found = found or mode.finite_free.at[b * mode.finite_frees + j] != 0.0
    return found


def keep_moving(n: int, many: int, kept: int, found: Floats, freedom: Floats) -> None:
    """Put the directions that move anything into `freedom`, each of length 1."""
    at = 0
    for j in range(many):
        size = 0.0
        for k in range(n):
            size = math.hypot(size, found[k * many + j])
        if size == 0.0:
            continue
        for k in range(n):
            freedom[k * kept + at] = found[k * many + j] / size
        at += 1


def may_move(e: Engine, mode: Mode, v: Floats, w: Floats, many: int, j: int) -> bool:
    """Whether the laws still hold where direction j of ``e.work.b`` leads to, on either side."""
    work = e.work
    n = 2 * e.model.bonds
    most = 0.0
    size = 0.0
    for k in range(n):
        if work.b.at[k * many + j] != 0.0:
            size = max(size, math.fabs(work.b.at[k * many + j]))
            most = max(most, math.fabs(w[k]))
    if size == 0.0:
        return False
    keep_residuals(e, measured_system(e, mode, v, w))
    tries = 1 if most > 0.0 else 3
    for turn in range(2 * tries):
        far = math.pow(ASIDE, float(1 + turn // 2)) * (most if most > 0.0 else 1.0) / size
        for k in range(n):
            way = far if turn % 2 == 0 else -far
            work.moved.at[k] = w[k] + way * work.b.at[k * many + j]
        if holds_at(e, mode, v, work.moved.at, HOLDS) and is_flat(e, mode.dynamics):
            return True
    return False


def moves_corner(e: Engine, mode: Mode, v: Floats, w: Floats, many: int, j: int) -> bool:
    """Whether direction j of ``e.work.b`` moves what a law at a corner reads.

    It may leave the corner only together with others: how far, the way to least leakage finds out.
    """
    m = e.model
    write_bonds(e, v, w)
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0 and is_at_corner(e, mode, i, v, w):
            for p in range(m.slope_first[d], m.slope_first[d + 1]):
                if m.slope_flat[p] != 0 and e.work.b.at[m.slope_column[p] * many + j] != 0.0:
                    return True
    return False


def is_flat(e: Engine, rows: int) -> bool:
    """Whether residuals are those of before, but for what slopes hide and rounding."""
    work = e.work
    for i in range(rows):
        moved = math.fabs(work.residual.at[i] - work.residual_before.at[i])
        most = FLAT * work.residual_size.at[i] + ROUNDINGS * UNIT * work.residual_reach.at[i]
        if moved > most:
            return False
    return True


def excess_at(e: Engine, mode: Mode, v: Floats, w: Floats, part: float) -> float:
    """Return what laws are off by beyond what `all_hold` allows, added up."""
    rows = laws_measured(e, mode, v, w)
    total = 0.0
    for i in range(rows):
        off = excess(e, i, part)
        if not off <= 0.0:
            total += off if off == off else math.inf
    return total


def holds_at(e: Engine, mode: Mode, v: Floats, w: Floats, part: float) -> bool:
    """Whether all laws hold at the bond variables `w`, to such a part of their terms."""
    return all_hold(e, laws_measured(e, mode, v, w), part)


def laws_measured(e: Engine, mode: Mode, v: Floats, w: Floats) -> int:
    """Put the residuals of laws at `w` there, measured by what rounding inside of each may be too.

    Returns how many there are.
    """
    m = e.model
    rows = measured_system(e, mode, v, w)
    for i in range(rows if mode.rank == mode.structures else 0):
        d = mode.dynamic[i]
        if d >= 0:
            inside = value(m, m.dynamic_rounding[d], v)
            if inside < math.inf:
                e.work.residual_reach.at[i] = max(e.work.residual_reach.at[i], inside)
    return rows
