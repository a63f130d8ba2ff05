"""Junction laws that are one-sided or cut: a linear complementarity problem, level by level."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.algebra.svd import least_squares
from hybond.engine.complementarity.law_roles import ONE_SIDED, LawProblem
from hybond.engine.complementarity.lcp import SOLVED
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.words import Floats, Ints

CLEAR_PART: Final = 1e-6
"""Part of the largest of its kind from which a value is positive beyond doubt."""
SHARED: Final = 1e-10
"""Part of their terms up to which rows of a block say the same, and what is blocked is zero."""
LEVELS: Final = 4
"""Orders of magnitude at which pairs that are zero on both sides are looked at again."""


def solve_one_sided(
    p: LawProblem,
    n: int,
    m: Floats,
    q: Floats,
    role: Ints,
    common: Ints,
    start: Ints,
    l: Floats,
    branch: Ints,
    open: Ints,
) -> bool:
    """Solve where all laws are one-sided, or cut."""
    many = 0
    for k in range(n):
        l[k] = 0.0
        branch[k] = 0
        open[k] = 0
        if role[k] == ONE_SIDED:
            p.who[many] = k
            many += 1
    if many == 0:
        return True
    for i in range(many):
        one = p.who[i]
        p.guess[i] = 1 if (start[one] == 1) == (common[one] != 0) else 0
        p.own_q[i] = q[one]
        for j in range(many):
            p.own[i * many + j] = m[one * n + p.who[j]]
    if as_before(p, many):
        for i in range(many):
            one = p.who[i]
            l[one] = p.z[i]
            branch[one] = 1 if (p.guess[i] != 0) == (common[one] != 0) else 0
        return True
    if not by_levels(p, many):
        return False
    for i in range(many):
        one = p.who[i]
        l[one] = p.z[i]
        branch[one] = 1 if (p.active[i] != 0) == (common[one] != 0) else 0
        open[one] = p.left[i]
    return True


def as_before(p: LawProblem, n: int) -> bool:
    """Whether the guessed active set clearly is the solution, which is p.z then.

    Where several share what they block, in any shares, all of them may go on doing so.
    """
    many = 0
    for k in range(n):
        p.z[k] = 0.0
        if p.guess[k] != 0:
            p.active[many] = k
            many += 1
    put_active(p, n, many)
    shared = many > 0 and lu_factor(many, p.block, p.pivot) == SINGULAR
    if shared:
        put_active(p, n, many)
        for i in range(many):
            p.fixed[i] = p.sub_q[i]
        least_squares(p.svd, many, many, p.block, SHARED, 1, p.fixed, p.sub_q)
    elif many > 0:
        lu_solve(many, p.block, p.pivot, 1, p.sub_q)
    most = 0.0
    for i in range(many):
        p.z[p.active[i]] = p.sub_q[i]
        if not p.sub_q[i] <= most:
            most = p.sub_q[i]
    size = 0.0
    clear = True
    for i in range(n):
        total = 0.0
        terms = 0.0
        for j in range(n):
            total += p.own[i * n + j] * p.z[j]
            terms += math.fabs(p.own[i * n + j] * p.z[j])
        p.sub_q[i] = total + p.own_q[i]
        terms += math.fabs(p.own_q[i])
        size = max(size, terms)
        if shared and p.guess[i] != 0:
            clear = clear and math.fabs(p.sub_q[i]) <= SHARED * terms
    for k in range(n):
        if p.guess[k] != 0:
            clear = clear and p.z[k] > CLEAR_PART * most
        else:
            clear = clear and p.sub_q[k] > CLEAR_PART * size
    return clear


def put_active(p: LawProblem, n: int, many: int) -> None:
    """Put the rows and columns of the active pairs into p.block, and what they must make up for."""
    for i in range(many):
        p.sub_q[i] = -p.own_q[p.active[i]]
        for j in range(many):
            p.block[i * many + j] = p.own[p.active[i] * n + p.active[j]]


def by_levels(p: LawProblem, n: int) -> bool:
    """Solve ``0 <= l``, ``q + m l >= 0``, one of them zero, level by level of magnitude.

    Pairs that are zero on both sides, measured by the largest of them, are decided by what is left
    of q once the others are: a current that passes through zero while others flow. The answer is
    p.z, p.active, and what stays open at every level in p.left.
    """
    if lemke(p.lcp, n, p.own, p.own_q, p.guess) != SOLVED:
        return False
    p.doubtful = is_doubtful(p, n)
    several = 0
    for k in range(n):
        p.z[k] = p.lcp.z[k]
        p.active[k] = p.lcp.active[k]
        p.left[k] = p.lcp.open[k]
        several += p.left[k]
    level = 0
    while level < LEVELS and several > 0:
        level += 1
        if not finer_level(p, n, several):
            break
        still = 0
        i = 0
        for k in range(n):
            if p.left[k] != 0:
                p.active[k] = p.lcp.active[i]
                p.left[k] = p.lcp.open[i]
                still += p.left[k]
                i += 1
        if still == several:
            break
        several = still
    return True


def is_doubtful(p: LawProblem, n: int) -> bool:
    """Whether some pair of Lemke's answer is zero, or nearly, on both sides."""
    most = 0.0
    size = 0.0
    for k in range(n):
        most = max(most, p.lcp.z[k])
        terms = math.fabs(p.own_q[k])
        for j in range(n):
            terms += math.fabs(p.own[k * n + j]) * p.lcp.z[j]
        size = max(size, terms)
    found = False
    for k in range(n):
        idle = p.lcp.z[k] <= CLEAR_PART * most and p.lcp.w[k] <= CLEAR_PART * size
        found = found or idle
    return found


def finer_level(p: LawProblem, n: int, several: int) -> bool:
    """Solve for the pairs in p.left with what the others leave of q; False if nothing is left."""
    sure = 0
    left = 0
    for k in range(n):
        if p.left[k] != 0:
            p.free[left] = k
            left += 1
        elif p.active[k] != 0:
            p.held[sure] = k
            sure += 1
    put_in_held(p, n, sure, several, p.own, p.own_q, p.sub, p.sub_q)
    most = 0.0
    for i in range(several):
        one = p.free[i]
        terms = math.fabs(p.own_q[one])
        for s in range(sure):
            held = p.into[s * (several + 1) + several]
            terms += math.fabs(p.own[one * n + p.held[s]] * held)
        if math.fabs(p.sub_q[i]) <= CANCELS * terms:
            p.sub_q[i] = 0.0  # rounding decides nothing: what is open stays so
        most = max(most, math.fabs(p.sub_q[i]))
        p.sub_start[i] = p.guess[p.free[i]]
    if most == 0.0:
        return False
    for i in range(several):
        p.sub_q[i] /= most
    return lemke(p.lcp, several, p.sub, p.sub_q, p.sub_start) == SOLVED


def put_in_held(
    p: LawProblem, n: int, many: int, free: int, m: Floats, q: Floats, inner: Floats, rest: Floats
) -> None:
    """Put in the `l` of `many` ports in p.held that make ``w = m l + q`` zero there.

    What is left for the `free` ports in p.free is ``w = inner l + rest``; minus the held `l` are
    ``p.into (l, 1)``.
    """
    wide = free + 1
    for i in range(many):
        one = p.held[i]
        for j in range(many):
            p.block[i * many + j] = m[one * n + p.held[j]]
        for j in range(free):
            p.fixed[i * wide + j] = m[one * n + p.free[j]]
        p.fixed[i * wide + free] = q[one]
    if many > 0:
        least_squares(p.svd, many, many, p.block, -1.0, wide, p.fixed, p.into)
    for i in range(free):
        one = p.free[i]
        for j in range(wide):
            p.fixed[j] = 0.0
        for s in range(many):
            # few are not zero where pairs are many: what is far apart has nothing to do with it
            share = m[one * n + p.held[s]]
            for j in range(wide if share != 0.0 else 0):
                p.fixed[j] += share * p.into[s * wide + j]
        for j in range(free):
            inner[i * free + j] = m[one * n + p.free[j]] - p.fixed[j]
        rest[i] = q[one] - p.fixed[free]
