"""Another solution of laws than the one that a run goes by, looked for from many beginnings.

What is found is one: each law holds there, it is a point, and laws do not hold on the way to it.
That none is found says nothing.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.products import all_finite, copy_part
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.branch import know
from hybond.engine.mode.nonlinear.damped import damped
from hybond.engine.mode.nonlinear.followed_records import MAY, NEVER, UNKNOWN
from hybond.engine.mode.nonlinear.newton import level_edges
from hybond.engine.mode.nonlinear.newton_step import NO_PIVOT, newton_step
from hybond.engine.mode.nonlinear.newton_system import (
    largest_of,
    measured_system,
    system,
    with_free,
)
from hybond.engine.mode.nonlinear.put_back import HOLDS, all_hold, put_back
from hybond.engine.mode.nonlinear.several import is_group_single
from hybond.engine.words import Floats

UNKNOWNS: Final = 12
"""So many unknowns are begun elsewhere, at the most."""
SIZES: Final = 13
"""By how much: parts of the largest variable of their kind, ..."""
PARTS: Final = 6
"""... so many of them, and powers of ten in SI, either way; ..."""
OF_ITSELF: Final = 10
"""... and where what a law reads is so many parts of itself: a load of constant power takes it at
nearly no voltage as well."""
STEPS: Final = 25
ENDS: Final = 1e-9
"""Steps end that are below this part of each unknown, or of the largest by this much less, ..."""
ENDS_OF_ALL: Final = 1e-12
"""... and where they come as near as"""
NEAR: Final = 1e-6
"""this part of each to the solution that is known."""
LOOKED_WITH: Final = 2e7
"""Multiplications of a run with which it is looked for another solution: some hundredths of a
second, however large the model is and however often it might be looked for."""
LAW: Final = 200.0
"""So many of them is a law that is evaluated."""
COMES_BACK: Final = 1e-7
"""Steps have come back that end nearer to it than this part of the way they began at."""
APART: Final = 0.1
"""How far apart two solutions are, as a part of a variable, ..."""
APART_OF_ALL: Final = 1e-6
"""... and of the largest of its kind."""


def may_have_others(e: Engine, mode: Mode) -> bool:
    """Whether it is not known that the laws of a mode have one solution, be it followed or not."""
    b = mode.branch
    if b.others == UNKNOWN:
        b.others = MAY if leaves_some_open(e, mode) else NEVER
    return b.others == MAY


def leaves_some_open(e: Engine, mode: Mode) -> bool:
    """Whether some unknowns may have other values; they are noted in ``open_unknown``."""
    b = mode.branch
    frees = mode.finite_frees
    if mode.dynamics == 0 or mode.affine or mode.opened or mode.dynamics != frees:
        return False
    fit_places(b.open_unknown, frees)
    a = mode.apart
    apart = a.groups > 0 and mode.rank == mode.structures
    for j in range(frees):
        b.open_unknown.at[j] = 0 if apart else 1
    found = not apart
    fit(e.work.following.values, 2 * e.model.slots)
    v = e.work.following.values.at
    copy_part(2 * e.model.slots, e.v, 0, v, 0)
    for g in range(a.groups if apart else 0):
        if jumps_in_group(e, mode, g) or not is_group_single(e, mode, g, v):
            found = True
            for q in range(a.begins.at[g], a.begins.at[g + 1]):
                b.open_unknown.at[a.unknown.at[q]] = 1
    return found


def jumps_in_group(e: Engine, mode: Mode, g: int) -> bool:
    """Whether a law of a group may jump: slopes tell nothing of that."""
    a = mode.apart
    for q in range(a.begins.at[g], a.begins.at[g + 1]):
        d = mode.dynamic[a.row.at[q]]
        if d < 0 or e.model.dynamic_breaks[d] != 0:
            return True
    return False


def finds_another(e: Engine, mode: Mode, v: Floats, patient: int) -> bool:
    """Look for another solution than the one in `e.work.w`, with all but bond variables in `v`.

    So many times that full steps do not settle they are made shorter, which takes long. It is in
    ``another`` then, and the one that is known in ``root_here``; `e.work.w` is that again.
    """
    f = e.work.following
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    fit(f.root_here, n)
    fit(f.another, n)
    fit(f.begun, frees)
    f.patience = patient
    copy_part(n, e.work.w, 0, f.root_here.at, 0)
    know(e, mode, v)
    level_edges(e, mode, v, e.work.base)
    found = False
    tried = 0
    last = -1
    for i in range(frees):
        # others first each time, where they are more
        j = (i + f.begun_at) % frees
        if mode.branch.open_unknown.at[j] == 0 or tried == UNKNOWNS:
            continue
        tried += 1
        last = j
        for turn in range(2 * SIZES + OF_ITSELF):
            size = size_of_turn(e, mode, j, turn // 2) if turn < 2 * SIZES else 1.0
            if not found and size > 0.0 and f.spent <= LOOKED_WITH:
                for k in range(frees):
                    f.begun.at[k] = f.root_here.at[mode.free_column[k]]
                if turn < 2 * SIZES:
                    f.begun.at[j] += size if turn % 2 == 0 else -size
                else:
                    f.begun.at[j] += way_to_part(e, mode, j, part_of_turn(turn - 2 * SIZES))
                found = leads_elsewhere(e, mode, v, f.begun.at)
    f.begun_at = last + 1 if tried == UNKNOWNS else 0
    # to all others at once: the other side of what is symmetric, and nothing
    for turn in range(2):
        if not found and tried > 1:
            for i in range(frees):
                f.begun.at[i] = -f.root_here.at[mode.free_column[i]] if turn == 0 else 0.0
            found = leads_elsewhere(e, mode, v, f.begun.at)
    copy_part(n, f.root_here.at, 0, e.work.w, 0)
    return found


def size_of_turn(e: Engine, mode: Mode, j: int, turn: int) -> float:
    """Return by how much unknown j is begun elsewhere; 0: by nothing."""
    if turn >= PARTS:
        return math.pow(10.0, float(turn - PARTS - (SIZES - PARTS) // 2))
    return largest_of_kind(e, mode.free_column[j]) * math.pow(10.0, 0.75 * float(turn) - 2.25)


def part_of_turn(turn: int) -> float:
    """Return which part of itself a law begins to read: nothing, the opposite, 0.5 to 0.008."""
    if turn < 2:
        return -float(turn)
    part = math.pow(10.0, 0.3 - 0.6 * float(turn // 2))
    return part if turn % 2 == 0 else -part


def way_to_part(e: Engine, mode: Mode, j: int, part: float) -> float:
    """Return how far unknown j is from where a bent law reads that part of what it reads now."""
    m = e.model
    here = e.work.following.root_here.at
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        for p in range(m.slope_first[d] if d >= 0 else 0, m.slope_first[d + 1] if d >= 0 else 0):
            k = m.slope_column[p]
            share = mode.finite_free.at[k * mode.finite_frees + j]
            if m.slope_value[p] >= 0 and share != 0.0:
                return (part - 1.0) * here[k] / share
    return (part - 1.0) * here[mode.free_column[j]]


def largest_of_kind(e: Engine, k: int) -> float:
    """Return the largest bond variable of the kind of variable k where the solution is known."""
    m = e.model
    most = 0.0
    for b in range(2 * m.bonds):
        if m.bond_class[b] == m.bond_class[k]:
            most = max(most, math.fabs(e.work.following.root_here.at[b]))
    return most


def leads_elsewhere(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Whether Newton's steps from `r` lead to another solution: it is in ``another`` then."""
    f = e.work.following
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    w = e.work.w
    ended = False
    near = False
    regular = False
    way = way_from_here(mode, f.root_here.at, r)
    size = float(frees)
    for _ in range(STEPS):
        f.spent += size * size * size + LAW * size
        with_free(mode, n, e.work.base, r, w)
        rows = system(e, mode, v, w)
        if rows != frees or not all_finite(rows, e.work.residual.at):
            return False
        if not all_finite(rows * frees, e.work.jacobian.at):
            return False
        regular = newton_step(e, rows, frees)
        least = ENDS_OF_ALL * largest_of(frees, r)
        ended = True
        near = True
        for j in range(frees):
            r[j] -= e.work.step.at[j]
            ended = ended and math.fabs(e.work.step.at[j]) <= ENDS * math.fabs(r[j]) + least
            here = f.root_here.at[mode.free_column[j]]
            near = near and math.fabs(r[j] - here) <= NEAR * math.fabs(here)
        if ended or near:
            break
    with_free(mode, n, e.work.base, r, w)
    if not ended and not near and f.patience > 0 and is_apart(e, w):
        f.patience -= 1
        f.spent += float(STEPS) * (size * size * size + LAW * size)
        ended = damped(e, mode, v, r)
        with_free(mode, n, e.work.base, r, w)
        regular = system(e, mode, v, w) == frees and newton_step(e, frees, frees)
    # what has come back but for rounding may be anything beside what is zero
    if not ended or not way_from_here(mode, f.root_here.at, r) > COMES_BACK * way:
        return False
    if not is_apart(e, w):
        return False
    # of a steep law the pivots are small parts of others
    if not regular and not has_pivots(e, frees):
        return False
    system(e, mode, v, w)
    copy_part(n, w, 0, f.another.at, 0)
    held = put_back(e, mode, v, w) and not holds_between(e, mode, v)
    e.work.lost = 0.0
    return held


def has_pivots(e: Engine, n: int) -> bool:
    """Whether each pivot of the last step is more than rounding of what cancels in its column."""
    for k in range(n):
        most = 0.0
        for i in range(n):
            most = max(most, math.fabs(e.work.jacobian.at[i * n + k]))
        if most == 0.0 or not math.fabs(e.work.jacobian2.at[k * n + k]) >= NO_PIVOT * most:
            return False
    return True


def way_from_here(mode: Mode, here: Floats, r: Floats) -> float:
    """Return how far the unknown is that is farthest from the solution that is known."""
    most = 0.0
    for j in range(mode.finite_frees):
        most = max(most, math.fabs(r[j] - here[mode.free_column[j]]))
    return most


def is_apart(e: Engine, w: Floats) -> bool:
    """Whether a bond variable is another number than where the solution is known."""
    for k in range(2 * e.model.bonds):
        if part_apart(e, w, k) > 0.0:
            return True
    return False


def part_apart(e: Engine, w: Floats, k: int) -> float:
    """Return by what part of itself bond variable k is another number; 0 if it is as good as it."""
    here = e.work.following.root_here.at[k]
    most = max(math.fabs(w[k]), math.fabs(here))
    off = math.fabs(w[k] - here)
    if not off > APART * most or not off > APART_OF_ALL * largest_of_kind(e, k):
        return 0.0
    return off / most


def holds_between(e: Engine, mode: Mode, v: Floats) -> bool:
    """Whether laws hold on the way between the two as well: where they are flat, both are one."""
    f = e.work.following
    for side in range(2):
        part = 0.3 if side == 0 else 0.7
        for k in range(2 * e.model.bonds):
            here = f.root_here.at[k]
            e.work.w[k] = here + part * (f.another.at[k] - here)
        if all_hold(e, measured_system(e, mode, v, e.work.w), HOLDS):
            return True
    return False
