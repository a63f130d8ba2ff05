"""Newton's steps for laws that do not know of each other: for one group of them after the other.

Together all would take as many steps as the slowest of them, a flow that comes to rest, and what
is small in one would count as nothing beside another. Each group begins where Newton ended last.
Where steps of one law with one unknown come to a slope that is zero at this point alone, or swing
over a root that is steep, a change of its sign is looked for. If that leads nowhere, or what is
found does not hold, all laws are solved together.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.answers import value
from hybond.engine.engine import Engine, count_work
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.apart import slope_of_given
from hybond.engine.mode.nonlinear.damped import HALVES, SETTLED
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value
from hybond.engine.mode.nonlinear.enclosed import APART, is_alike, middle_of
from hybond.engine.mode.nonlinear.newton_step import SWINGS, TOLERANCE, newton_step
from hybond.engine.mode.nonlinear.newton_system import is_zero, largest_of, with_free, with_free_one
from hybond.engine.mode.nonlinear.put_back import HOLDS, put_back
from hybond.engine.mode.nonlinear.slopes_bounded import bound_row, is_bounded
from hybond.engine.words import Floats

STEPS: Final = 60
ASKED: Final = 16
"""Laws that only give are put back into themselves once in so many times within steps: what
rounding hides of them grows slowly, and asking costs several times what giving does."""
TWICE: Final = 0.1
"""Where steps halve, as towards a root of a square, twice the step is taken if it leaves less than
this part of the law."""
LEAST: Final = 1e-300
LEAST_PART: Final = 2.0**-50
FARTHER: Final = 2.0**40
FARTHEST: Final = 1e150
"""How a change of sign is looked for: from the least way on, by longer and longer ones; from a
number that is not zero from this part of it on."""
MIDDLES: Final = 200


def solved_apart(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Go from `r` to a root, group after group; False if any of them does not come to one."""
    work = e.work
    a = mode.apart
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    if a.groups < 2 or mode.affine or mode.rank != mode.structures:
        return False
    if work.aid > 0.0 or not all_finite(n, work.base) or not all_finite(frees, r):
        return False
    fit(work.slopes, mode.dynamics * n)
    fit(work.residual, frees)
    fit(work.residual_size, frees)
    fit(work.residual_reach, frees)
    fit(work.jacobian, frees * frees)
    fit(work.trial, frees)
    work.reluctant = mode.reluctant
    work.bends = mode.bent
    known = largest_of(n, work.base)
    for g in range(a.groups):
        many = a.begins.at[g + 1] - a.begins.at[g]
        if not group_steps(e, mode, v, r, g, many, known):
            return False
    with_free(mode, n, work.base, r, work.w)
    mode.regular = True
    if goes_unasked(e, mode):
        return True
    return put_back(e, mode, v, work.w)


def goes_unasked(e: Engine, mode: Mode) -> bool:
    """Whether laws are not put back into themselves: each only gives, and is asked now and then."""
    return mode.apart.all_give and e.work.in_step and mode.solves % ASKED != 0


def give(e: Engine, mode: Mode, v: Floats, r: Floats, g: int) -> bool:
    """Let the law of a group give its variable, all that it reads being known; whether it does.

    The law is linear in that variable, with a slope that does not change: the value is what is left
    of it where the variable is zero, over that slope.
    """
    m = e.model
    work = e.work
    a = mode.apart
    k = a.given.at[g]
    i = a.row.at[a.begins.at[g]]
    j = a.unknown.at[a.begins.at[g]]
    for s in range(a.read_from.at[g], a.read_from.at[g + 1]):
        b = a.read.at[s]
        v[m.bond_slot + b] = with_free_one(mode, work.base, r, b) if b != k else 0.0
    left = dynamic_value(e, mode, i, v) / slope_of_given(m, mode.dynamic[i], k)
    found = -(left + work.base[k]) / mode.finite_free.at[k * mode.finite_frees + j]
    if not math.isfinite(found):
        return False
    r[j] = found
    if not goes_unasked(e, mode):
        group_system(e, mode, v, r, g)
    return True


def group_steps(
    e: Engine, mode: Mode, v: Floats, r: Floats, g: int, many: int, known: float
) -> bool:
    """Take Newton's steps for one group, of so many laws; whether they end."""
    work = e.work
    if mode.apart.given.at[g] >= 0 and give(e, mode, v, r, g):
        return True
    begin = mode.apart.begins.at[g]
    update = math.inf
    share = math.inf
    before = math.inf
    for step in range(STEPS):
        group_system(e, mode, v, r, g)
        if not all_finite(many, work.residual.at):
            return False
        if is_zero(many, work.residual.at):
            return is_determined(e, mode, g)
        if not all_finite(many * many, work.jacobian.at):
            return False
        if many == 1 and work.jacobian.at[0] == 0.0:
            if not is_determined(e, mode, g) or not leaves_flat(e, mode, v, r, g):
                return False
            update = math.inf
            share = math.inf
            before = math.inf
            work.trial.at[0] = 0.0
            continue
        if many == 1:
            work.step.at[0] = work.residual.at[0] / work.jacobian.at[0]
            if not math.isfinite(work.step.at[0]):
                return False
        elif not newton_step(e, many, many):
            return False
        left = largest_of(many, work.residual.at)
        previous = update
        update = largest_of(many, work.step.at)
        shared = share
        share = 0.0
        scale = known
        swings = step > 0
        for q in range(many):
            j = mode.apart.unknown.at[begin + q]
            own = math.fabs(r[j])
            moved = math.fabs(work.step.at[q])
            scale = max(scale, own)
            if moved > share * own:
                share = moved / own if own > 0.0 else math.inf
            swings = swings and math.fabs(work.trial.at[q] + work.step.at[q]) <= SWINGS * update
        for q in range(many):
            r[mode.apart.unknown.at[begin + q]] -= work.step.at[q]
        small = update <= TOLERANCE * scale
        if small and share <= SETTLED:
            return True
        step_taken = work.step.at[0]
        if many == 1 and swings and lies_between(e, mode, v, r, g, step_taken):
            j = mode.apart.unknown.at[begin]
            return enclose(e, mode, v, r, g, r[j] + step_taken)
        shrinks = update < 0.5 * previous or (small and share < 0.5 * shared)
        if not shrinks and left >= 0.5 * before and holds(e, mode, v, r, g):
            return True
        halves = many == 1 and step > 0
        halves = halves and math.fabs(2.0 * step_taken - work.trial.at[0]) <= HALVES * update
        copy_floats(many, work.step.at, work.trial.at)
        if halves and takes_twice(e, mode, v, r, g, step_taken, left):
            work.trial.at[0] = 2.0 * step_taken
        before = left
    return False


def group_system(e: Engine, mode: Mode, v: Floats, r: Floats, g: int) -> None:
    """Put residuals of a group, the sizes of their terms and their Jacobian into `e.work`."""
    m = e.model
    work = e.work
    a = mode.apart
    n = 2 * m.bonds
    frees = mode.finite_frees
    begin = a.begins.at[g]
    many = a.begins.at[g + 1] - begin
    for s in range(a.read_from.at[g], a.read_from.at[g + 1]):
        k = a.read.at[s]
        work.w[k] = with_free_one(mode, work.base, r, k)
        v[m.bond_slot + k] = work.w[k]
    count_work(e, many * many * many + a.read_from.at[g + 1] - a.read_from.at[g])
    for q in range(many):
        i = a.row.at[begin + q]
        d = mode.dynamic[i]
        work.f[i] = dynamic_value(e, mode, i, v)
        work.residual.at[q] = work.f[i]
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            law = m.slope_value[p]
            slope = m.slope_constant[p] if law < 0 else value(m, law, v)
            work.slopes.at[i * n + m.slope_column[p]] = slope
        if not is_bounded(m, mode, i, work.slopes.at):
            clear_others(e, mode, i)
            bound_row(e, mode, i, v)
        size = 0.0
        for j in range(many):
            work.jacobian.at[q * many + j] = 0.0
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            k = m.slope_column[p]
            slope = work.slopes.at[i * n + k]
            if slope == 0.0:
                continue
            if math.isfinite(slope):
                size += math.fabs(slope * work.w[k])
            for j in range(many):
                part = mode.finite_free.at[k * frees + a.unknown.at[begin + j]]
                if part != 0.0:
                    work.jacobian.at[q * many + j] += slope * part
        work.residual_size.at[q] = size


def clear_others(e: Engine, mode: Mode, i: int) -> None:
    """Let slopes of a row be zero by all variables that the table does not list."""
    m = e.model
    n = 2 * m.bonds
    d = mode.dynamic[i]
    at = m.slope_first[d]
    for k in range(n):
        if at < m.slope_first[d + 1] and m.slope_column[at] == k:
            at += 1
        else:
            e.work.slopes.at[i * n + k] = 0.0


def holds(e: Engine, mode: Mode, v: Floats, r: Floats, g: int) -> bool:
    """Whether the laws of a group hold at `r`."""
    group_system(e, mode, v, r, g)
    for q in range(mode.apart.begins.at[g + 1] - mode.apart.begins.at[g]):
        if not math.fabs(e.work.residual.at[q]) <= HOLDS * e.work.residual_size.at[q]:
            return False
    return True


def is_determined(e: Engine, mode: Mode, g: int) -> bool:
    """Whether laws of a group leave none of its unknowns free, after `group_system`.

    That a slope is zero at this point alone leaves nothing free: an orifice at rest has one flow.
    """
    m = e.model
    work = e.work
    a = mode.apart
    begin = a.begins.at[g]
    many = a.begins.at[g + 1] - begin
    if not all_finite(many * many, work.jacobian.at):
        return False
    if many > 1 or work.jacobian.at[0] != 0.0:
        return newton_step(e, many, many)
    d = mode.dynamic[a.row.at[begin]]
    seen = 0
    alone = 0
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        at = m.slope_column[p] * mode.finite_frees + a.unknown.at[begin]
        if mode.finite_free.at[at] != 0.0:
            seen += 1
            alone += m.slope_isolated[p]
    return seen == 1 and alone == 1


def takes_twice(
    e: Engine, mode: Mode, v: Floats, r: Floats, g: int, step: float, left: float
) -> bool:
    """Take a step a second time, where that leaves next to nothing of the law; whether it does."""
    j = mode.apart.unknown.at[mode.apart.begins.at[g]]
    once = r[j]
    if math.fabs(law_at(e, mode, v, r, g, once - step)) <= TWICE * left:
        return True
    r[j] = once
    return False


def law_at(e: Engine, mode: Mode, v: Floats, r: Floats, g: int, x: float) -> float:
    """Return what is left of the law of a group where its unknown is x, which goes into `r`."""
    r[mode.apart.unknown.at[mode.apart.begins.at[g]]] = x
    group_system(e, mode, v, r, g)
    return e.work.residual.at[0]


def leaves_flat(e: Engine, mode: Mode, v: Floats, r: Floats, g: int) -> bool:
    """Go on from where the slope of a law is zero, to the side on which it changes its sign.

    Up to a few times as far as it does so. Where it does so on both sides, as a square does, other
    ways to a solution decide.
    """
    j = mode.apart.unknown.at[mode.apart.begins.at[g]]
    begin = r[j]
    here = e.work.residual.at[0]
    way = LEAST if begin == 0.0 else math.fabs(begin) * LEAST_PART
    near = 0.0
    while way < FARTHEST:
        above = is_alike(law_at(e, mode, v, r, g, begin + way), here)
        below = is_alike(law_at(e, mode, v, r, g, begin - way), here)
        if not above and not below:
            return False
        if not above or not below:
            side = 1.0 if below else -1.0
            while way > APART * max(near, LEAST):
                middle = middle_of(near, way)
                if is_alike(law_at(e, mode, v, r, g, begin + side * middle), here):
                    near = middle
                else:
                    way = middle
            r[j] = begin + side * way
            return True
        near = way
        way *= FARTHER
    return False


def lies_between(e: Engine, mode: Mode, v: Floats, r: Floats, g: int, step: float) -> bool:
    """Whether a law changes its sign on the step by which its unknown has come to where it is."""
    j = mode.apart.unknown.at[mode.apart.begins.at[g]]
    x = r[j]
    here = law_at(e, mode, v, r, g, x)
    there = law_at(e, mode, v, r, g, x + step)
    r[j] = x
    return here * there < 0.0


def enclose(e: Engine, mode: Mode, v: Floats, r: Floats, g: int, near: float) -> bool:
    """Halve the way by which the unknown of a law has come over a root; whether it holds there."""
    j = mode.apart.unknown.at[mode.apart.begins.at[g]]
    far = r[j]
    here = law_at(e, mode, v, r, g, near)
    for _ in range(MIDDLES):
        middle = middle_of(near, far)
        if middle == near or middle == far:
            break
        left = law_at(e, mode, v, r, g, middle)
        if left == 0.0:
            return is_determined(e, mode, g)
        if is_alike(left, here):
            near = middle
        else:
            far = middle
    left = math.fabs(law_at(e, mode, v, r, g, far))
    if math.fabs(law_at(e, mode, v, r, g, near)) > left:
        r[j] = far
    return holds(e, mode, v, r, g) and is_determined(e, mode, g)


def all_determined(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether no law leaves anything free at the bond variables `w`, seen group by group."""
    work = e.work
    a = mode.apart
    n = 2 * e.model.bonds
    if a.groups == 0 or mode.affine or mode.rank != mode.structures:
        return False
    fit(work.slopes, mode.dynamics * n)
    fit(work.residual, mode.dynamics)
    fit(work.residual_size, mode.dynamics)
    fit(work.jacobian, mode.dynamics * mode.dynamics)
    fit(work.step, 2 * mode.dynamics)
    fit(work.found_apart, mode.finite_frees)
    for j in range(mode.finite_frees):
        work.found_apart.at[j] = w[mode.free_column[j]]
    for g in range(a.groups):
        group_system(e, mode, v, work.found_apart.at, g)
        if not is_determined(e, mode, g):
            return False
    return True
