"""Laws with several solutions: where Newton's method begins, so that it ends at the one followed.

A motion notes the solution that it has come along at points of each step, so near to each other
that between two of them it is as good as straight. What is read at any time of the step begins
there.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import fit, fit_places, grow_block
from hybond.engine.algebra.lu import SINGULAR, lu_factor
from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton import by_knowns, knowns_of
from hybond.engine.mode.nonlinear.newton_step import newton_step
from hybond.engine.mode.nonlinear.newton_system import system, with_free
from hybond.engine.words import Floats


def begin_on_branch(e: Engine, mode: Mode, t: float) -> None:
    """Let Newton's method begin at the solution that was followed, if that was at this time."""
    b = mode.branch
    last = b.points - 1
    if last < 0 or t < b.when.at[0] or t > b.when.at[last]:
        return
    low = 0
    high = last
    while high - low > 1:
        middle = (low + high) // 2
        if b.when.at[middle] <= t:
            low = middle
        else:
            high = middle
    n = 2 * e.model.bonds
    length = b.when.at[high] - b.when.at[low]
    part = (t - b.when.at[low]) / length if length > 0.0 else 0.0
    for j in range(mode.finite_frees):
        k = mode.free_column[j]
        begin = b.root.at[low * n + k]
        end = b.root.at[high * n + k]
        mode.guess.at[j] = end if part == 1.0 else begin + part * (end - begin)
    mode.guessed = True


def forget_points(mode: Mode) -> None:
    """Follow none."""
    mode.branch.known = False
    mode.branch.ended = False
    mode.branch.points = 0


def take_points(e: Engine, mode: Mode, many: int, when: Floats, given: Floats) -> None:
    """Follow what went through these points: times, and bond variables row after row."""
    b = mode.branch
    n = 2 * e.model.bonds
    fit(b.when, many)
    fit(b.root, many * n)
    copy_part(many, when, 0, b.when.at, 0)
    copy_part(many * n, given, 0, b.root.at, 0)
    b.points = many
    b.known = many > 0
    mode.guessed = mode.guessed or b.known


def put_point(e: Engine, mode: Mode, t: float) -> None:
    """Note the bond variables just found as those of the solution followed."""
    b = mode.branch
    n = 2 * e.model.bonds
    grow_block(b.when, b.points + 1)
    grow_block(b.root, (b.points + 1) * n)
    b.when.at[b.points] = t
    copy_part(n, e.work.w, 0, b.root.at, b.points * n)
    b.points += 1


def take_unknowns(e: Engine, mode: Mode, r: Floats) -> None:
    """Put the free unknowns at the last point into `r`."""
    at = (mode.branch.points - 1) * 2 * e.model.bonds
    for j in range(mode.finite_frees):
        r[j] = mode.branch.root.at[at + mode.free_column[j]]


def know(e: Engine, mode: Mode, v: Floats) -> None:
    """Find what bond variables are made of where all but them is written in `v`."""
    knowns_of(e, mode, v, True)
    by_knowns(e, mode, mode.finite, e.work.base)


def step_from(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Find Newton's step from `r` after `know`, and factors of the slopes; whether there is one."""
    b = e.work.following
    frees = mode.finite_frees
    with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
    rows = system(e, mode, v, e.work.w)
    if rows != frees or not all_finite(rows, e.work.residual.at):
        return False
    if not all_finite(rows * frees, e.work.jacobian.at):
        return False
    fit(b.square, frees * frees)
    fit_places(b.pivot, frees)
    copy_part(frees * frees, e.work.jacobian.at, 0, b.square.at, 0)
    newton_step(e, rows, frees)
    return all_finite(frees, e.work.step.at)


def take_signs(e: Engine, mode: Mode, sign: Floats) -> None:
    """Put the sign of the determinant of the last step's slopes into `sign`, of each group of laws.

    It is zero where there is none. Two groups that turn at one instant leave that of all as it was.
    """
    a = mode.apart
    if a.groups == 0:
        sign[0] = sign_of_square(e, mode, -1)
    for g in range(a.groups):
        sign[g] = sign_of_square(e, mode, g)


def groups_of(mode: Mode) -> int:
    """Return the number of groups of laws; all are one where none are told apart."""
    return max(mode.apart.groups, 1)


def sign_of_square(e: Engine, mode: Mode, g: int) -> float:
    """Return the sign for one group; if -1, for all."""
    b = e.work.following
    a = mode.apart
    frees = mode.finite_frees
    begin = a.begins.at[g] if g >= 0 else 0
    n = a.begins.at[g + 1] - begin if g >= 0 else frees
    fit(b.product, n * n)
    for i in range(n):
        row = a.row.at[begin + i] if g >= 0 else i
        for j in range(n):
            column = a.unknown.at[begin + j] if g >= 0 else j
            b.product.at[i * n + j] = b.square.at[row * frees + column]
    if lu_factor(n, b.product.at, b.pivot.at) == SINGULAR:
        return 0.0
    sign = 1.0
    for k in range(n):
        pivot = b.product.at[k * n + k]
        if pivot == 0.0 or not math.isfinite(pivot):
            return 0.0
        if pivot < 0.0:
            sign = -sign
        if b.pivot.at[k] != k:
            sign = -sign
    return sign
