"""The laws of junctions, all at once, as one mixed linear complementarity problem.

Given ``w = M l + q``, each port takes part in one of the ways of law_roles.py. The limit of
friction may be affine in `l`. Source: V. Acary, B. Brogliato,
*Numerical Methods for Nonsmooth Dynamical Systems*, Springer 2008, chapters 10 and 12.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.algebra.rounding import SMALLEST
from hybond.engine.algebra.svd import rank_above, svd
from hybond.engine.complementarity.law_roles import (
    BACKWARD,
    CUT,
    FORWARD,
    ONE_SIDED,
    SHUT,
    TWO_SIDED,
    LawProblem,
)
from hybond.engine.complementarity.lcp import SOLVED
from hybond.engine.complementarity.lcp_forms import solve_mixed
from hybond.engine.complementarity.one_sided import put_in_held, solve_one_sided
from hybond.engine.words import Floats, Ints

SETTLED: Final = 1e-9
"""Part of its terms up to which what is held counts as zero."""


def solve_laws(p: LawProblem, start: Ints) -> bool:
    """Find what the laws of all ports do together; False if nothing was found.

    `start` is a guess of the branches.
    """
    n = p.n
    holds_any = False
    rubs = False
    p.doubtful = False
    for k in range(n):
        p.moved[k] = p.q[k] + p.shift[k] if p.shifted else p.q[k]
        p.l[k] = 0.0
        p.branch[k] = 0
        p.open[k] = 0
        if p.role[k] == SHUT:
            holds_any = True
        if p.role[k] == TWO_SIDED or p.role[k] >= FORWARD:
            rubs = True
    if rubs:
        return solve_with_friction(p, p.moved, p.q, start)
    if holds_any:
        return solve_without_held(p, start)
    return solve_one_sided(p, n, p.m, p.moved, p.role, p.common, start, p.l, p.branch, p.open)


def solve_without_held(p: LawProblem, start: Ints) -> bool:
    """Put in the `l` that hold ``w = 0``, and solve for the others."""
    n = p.n
    many = 0
    free = 0
    for k in range(n):
        if p.role[k] == SHUT:
            p.held[many] = k
            many += 1
        else:
            p.free[free] = k
            free += 1
    for i in range(many):
        a = held_scale(p, p.held[i])
        for j in range(many):
            entry = p.m[p.held[i] * n + p.held[j]]
            p.block[i * many + j] = entry / held_scale(p, p.held[j]) / a
    svd(p.svd, many, many, p.block)
    tied = rank_above(p.svd, many, SETTLED) < many
    # what is held may depend on the others, not on its own l alone
    if tied and solve_with_friction(p, p.moved, p.moved, start):
        return True
    # or nothing decides some l, like voltages of switches that leave a part afloat
    wide = free + 1
    put_in_held(p, n, many, free, p.m, p.moved, p.inner, p.rest)
    for i in range(free):
        one = p.free[i]
        p.inner_role[i] = p.role[one]
        p.inner_common[i] = p.common[one]
        p.inner_start[i] = start[one]
        # solve_one_sided lists pairs in the same places
        p.place[i] = one
    copy_places(many, p.held, 0, p.place, free)
    copy_floats(many * wide, p.into, p.kept)
    if not inner_solved(p, free):
        p.lcp.proved = p.lcp.proved and not tied
        return False
    for i in range(free):
        one = p.place[i]
        p.l[one] = p.inner_l[i]
        p.branch[one] = p.inner_branch[i]
        p.open[one] = p.inner_open[i]
    for i in range(many):
        total = 0.0
        for j in range(free):
            total += p.kept[i * wide + j] * p.inner_l[j]
        p.l[p.place[free + i]] = -(total + p.kept[i * wide + free])
    return not tied or is_held(p)


def is_held(p: LawProblem) -> bool:
    """Whether what is held is zero but for rounding."""
    n = p.n
    for k in range(n):
        if p.role[k] != SHUT:
            continue
        total = p.moved[k]
        size = math.fabs(p.moved[k])
        for j in range(n):
            total += p.m[k * n + j] * p.l[j]
            size += math.fabs(p.m[k * n + j]) * math.fabs(p.l[j])
        if math.fabs(total) > SETTLED * size:
            return False
    return True


def inner_solved(p: LawProblem, free: int) -> bool:
    """Solve for the ports that are not held."""
    return solve_one_sided(
        p,
        free,
        p.inner,
        p.rest,
        p.inner_role,
        p.inner_common,
        p.inner_start,
        p.inner_l,
        p.inner_branch,
        p.inner_open,
    )


def held_scale(p: LawProblem, k: int) -> float:
    """Return the square root of what a port feels of itself."""
    return math.sqrt(max(math.fabs(p.m[k * p.n + k]), SMALLEST))


def solve_with_friction(p: LawProblem, moved: Floats, held: Floats, start: Ints) -> bool:
    """Write the laws as rows ``A a + B b + C l = d`` with ``a, b >= 0`` and ``a b = 0``; solve."""
    pairs = pair_up(p)
    write_laws(p, pairs, moved, held)
    for i in range(pairs):
        one = p.pair_of[i]
        if p.pair_way[i] != 0:
            p.guess[i] = 1 if start[one] == p.pair_way[i] else 0
        else:
            p.guess[i] = 1 if (start[one] == 1) == (p.common[one] != 0) else 0
    if solve_mixed(p.mixed, pairs, p.n, p.guess, True) != SOLVED:
        return False
    read_mixed(p, pairs)
    return True


def pair_up(p: LawProblem) -> int:
    """Give a pair to each one-sided law and two to each friction; return how many there are."""
    pairs = 0
    for k in range(p.n):
        if p.role[k] == ONE_SIDED:
            p.pair_of[pairs] = k
            p.pair_way[pairs] = 0
            pairs += 1
        elif p.role[k] == TWO_SIDED:
            p.pair_of[pairs] = k
            p.pair_way[pairs] = 1
            p.pair_of[pairs + 1] = k
            p.pair_way[pairs + 1] = -1
            pairs += 2
    return pairs


def write_laws(p: LawProblem, pairs: int, moved: Floats, held: Floats) -> None:
    """Write the rows of all laws into the mixed problem."""
    n = p.n
    x = p.mixed
    rows = pairs + n
    wide = 2 * pairs + n
    for k in range(rows * wide):
        x.whole[k] = 0.0
    for k in range(rows):
        x.right[k] = 0.0
    row = 0
    pair = 0
    for k in range(n):
        at = row * wide + 2 * pairs
        role = p.role[k]
        own = p.m[k * n + k]
        if role == CUT:
            x.whole[at + k] = 1.0
            row += 1
        elif role == SHUT:
            copy_part(n, p.m, k * n, x.whole, at)
            x.right[row] = -held[k]
            row += 1
        elif role >= FORWARD:
            way = 1.0 if role == FORWARD else -1.0
            for j in range(n):
                x.whole[at + j] = way * p.slope[k * n + j]
            x.whole[at + k] += 1.0
            x.right[row] = -way * p.limit[k]
            row += 1
        elif role == ONE_SIDED:
            per = 1.0 / own if own > 0.0 else 1.0
            x.whole[row * wide + pair] = 1.0
            x.whole[at + k] = -1.0
            x.whole[(row + 1) * wide + pairs + pair] = 1.0
            for j in range(n):
                x.whole[at + wide + j] = -p.m[k * n + j] * per
            x.right[row + 1] = moved[k] * per
            row += 2
            pair += 1
        else:
            give_friction(p, k, row, pair, pairs)
            row += 3
            pair += 2


def read_mixed(p: LawProblem, pairs: int) -> None:
    """Take the answer of the mixed problem: what carries, which branches, what is open."""
    x = p.mixed
    for k in range(p.n):
        p.l[k] = x.c[k]
        p.open[k] = 0
        p.branch[k] = 1 if p.role[k] == FORWARD else -1 if p.role[k] == BACKWARD else 0
    for i in range(pairs):
        one = p.pair_of[i]
        if p.pair_way[i] == 0:
            p.branch[one] = 1 if (x.active[i] != 0) == (p.common[one] != 0) else 0
        elif x.active[i] != 0:
            p.branch[one] = p.pair_way[i]
        if x.open[i] != 0:
            p.open[one] = 1
    for i in range(pairs):
        # what slides clearly is at its limit, and at that of the other way where both are zero
        if p.pair_way[i] != 0 and x.active[i] != 0 and x.open[i] == 0:
            p.open[p.pair_of[i]] = 0


def give_friction(p: LawProblem, k: int, row: int, pair: int, pairs: int) -> None:
    """Give the three rows of a friction law; its pairs are `pair` and the next one.

    Both variables of a pair are written in the unit of `l`, by what the port feels of itself: so
    are those of one-sided laws, and tolerances then agree.
    """
    n = p.n
    x = p.mixed
    wide = 2 * pairs + n
    at = row * wide + 2 * pairs
    own = p.m[k * n + k]
    is_common = p.common[k] != 0
    per = 1.0 / own if own > 0.0 else 1.0
    of_speed = 1.0 if is_common else per
    of_force = per if is_common else 1.0
    held = -p.q[k] if is_common else 0.0
    x.whole[row * wide + pair] = 1.0
    x.whole[row * wide + pair + 1] = -1.0
    x.whole[(row + 1) * wide + pairs + pair] = 1.0
    x.whole[(row + 2) * wide + pairs + pair + 1] = 1.0
    for j in range(n):
        unit = 1.0 if j == k else 0.0
        speed = unit if is_common else p.m[k * n + j]
        force = -p.m[k * n + j] if is_common else -unit
        slope = p.slope[k * n + j]
        x.whole[at + j] = -speed * of_speed
        x.whole[at + wide + j] = (force - slope) * of_force
        x.whole[at + 2 * wide + j] = (-force - slope) * of_force
    x.right[row] = 0.0 if is_common else p.q[k] * per
    x.right[row + 1] = (p.limit[k] - held) * of_force
    x.right[row + 2] = (p.limit[k] + held) * of_force
