"""Lemke's algorithm for ``z >= 0, w = M z + q >= 0, z w = 0``.

Pivoting decides which of each pair is zero, as a mode does; the values then follow from one linear
solve with that choice, so that they are as accurate as any other linear solve.

Sources: C. E. Lemke, Management Science 11(7):681-689, 1965; R. W. Cottle, J.-S. Pang, R. E.
Stone, *The Linear Complementarity Problem*, Academic Press 1992, algorithm 4.4.1.
"""

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.rounding import SMALLEST
from hybond.engine.algebra.scaling import balance, power_of_two
from hybond.engine.complementarity.lcp import ON_A_RAY, SOLVED, TOO_MANY_PIVOTS, Lcp
from hybond.engine.complementarity.pivoting import independent, lemke_path, principal, split_pairs
from hybond.engine.words import Floats, Ints

LCP_ZERO: Final = 1e-11
"""What counts as zero after scaling: entries of about one, the largest of q one."""
BEYOND_ARITHMETIC: Final = 1e12
"""A scaled solution beyond it comes from a matrix that is singular but for rounding."""
MEANT_PART: Final = 1e-9
"""A component of q that is not below it, relative to the largest, is no rounding."""
PROOF_ZERO: Final = 1e-14
"""Part of its terms up to which a row of a proof is zero: what is faint beside them, such as a leak
of 1 Mohm beside diodes, may still carry the answer."""
PATHS: Final = 5
"""How often a path is taken up again from its own end because rounding had misled it."""

NEGATIVE_POINT: Final = 2


def lemke(p: Lcp, n: int, m: Floats, q: Floats, start: Ints) -> int:
    """Solve for the n pairs of `m` and `q`; `start` is a guess of the z that are not zero.

    The answer is p.z, p.w, p.active and p.open. `start` is kept.
    """
    scale_problem(p, n, m, q)
    limit = 2000 + 20 * n
    warm = False
    for k in range(n):
        p.active[k] = start[k]
        if start[k] != 0:
            warm = True
    p.pivots = 0
    p.proved = False
    turn = 0
    while turn < 2 * PATHS:
        if warm and turn == PATHS:
            # rounding leads from this guess round in a ring; another path has other roundings
            warm = False
            for k in range(n):
                p.active[k] = 0
        turn += 1
        found = confirm_point(p, n)
        if found == SOLVED:
            for k in range(n):
                p.z[k] = p.size * p.d[k] * p.z[k]
                p.w[k] = p.size * p.w[k] / p.d[k]
            return SOLVED
        if found == NEGATIVE_POINT:
            if p.pivots >= limit:
                break
            found = principal(p, n, p.active)
        if found == SINGULAR:
            drop_dependent(p, n)
            continue
        path = lemke_path(p, n, limit - p.pivots, LCP_ZERO)
        if path == ON_A_RAY:
            p.proved = ray_proves(p, n)
            if p.proved or not warm:
                return ON_A_RAY
            warm = False
            for k in range(n):
                p.active[k] = 0  # another path may end elsewhere
        else:
            for k in range(n):
                p.active[k] ^= p.path[k]  # its point is confirmed, or the path taken up again
    return TOO_MANY_PIVOTS


def drop_dependent(p: Lcp, n: int) -> None:
    """Leave a part of the active pairs whose block is regular, none if all were."""
    before = 0
    for k in range(n):
        before += p.active[k]
    if independent(p, n, p.active) >= before:
        for k in range(n):
            p.active[k] = 0


def scale_problem(p: Lcp, n: int, m: Floats, q: Floats) -> None:
    """Put ``D M D`` and ``D q / size`` into the record.

    The size is that of the largest of ``D q``, unless that leaves another number, which the caller
    thinks of as large, below all tolerances.
    """
    balance(n, m, p.d, p.column)
    most = 0.0
    largest = 0.0
    for k in range(n):
        p.q[k] = p.d[k] * q[k]
        most = max(most, math.fabs(q[k]))
        largest = max(largest, math.fabs(p.q[k]))
        for j in range(n):
            p.matrix[k * n + j] = m[k * n + j] * p.d[k] * p.d[j]
    p.size = 1.0
    if largest > 0.0:
        meant = math.inf
        for k in range(n):
            if math.fabs(q[k]) >= MEANT_PART * most:
                meant = min(meant, math.fabs(p.q[k]))
        p.size = power_of_two(min(largest, 1e6 * meant))
    for k in range(n):
        p.q[k] /= p.size


def confirm_point(p: Lcp, n: int) -> int:
    """Put z, w and what is open of the active set there; NEGATIVE_POINT if one is, or SINGULAR."""
    count = split_pairs(p, n, p.active)
    for i in range(count):
        for j in range(count):
            p.block[i * count + j] = p.matrix[p.on[i] * n + p.on[j]]
        p.right[i] = -p.q[p.on[i]]
    if count > 0:
        if lu_factor(count, p.block, p.pivot) == SINGULAR:
            return SINGULAR
        lu_solve(count, p.block, p.pivot, 1, p.right)
    most = 0.0
    of_z = SMALLEST
    for k in range(n):
        p.z[k] = 0.0
        if p.q[k] != 0.0:
            of_z = 1.0
    least = of_z
    for i in range(count):
        size = math.fabs(p.right[i])
        if not size < BEYOND_ARITHMETIC:
            return SINGULAR
        p.z[p.on[i]] = p.right[i]
        most = max(most, size)
    of_z = max(of_z, most)
    bad = False
    for i in range(n):
        total = 0.0
        size = 0.0
        for j in range(n):
            total += p.matrix[i * n + j] * p.z[j]
            size += math.fabs(p.matrix[i * n + j]) * math.fabs(p.z[j])
        total += p.q[i]
        if p.active[i] != 0:
            total = 0.0
        z_part = p.z[i] / of_z
        w_part = total / max(least, size)
        if z_part < -LCP_ZERO or w_part < -LCP_ZERO:
            bad = True
        p.open[i] = 1 if z_part <= LCP_ZERO and w_part <= LCP_ZERO else 0
        p.w[i] = total
    if bad:
        return NEGATIVE_POINT
    for k in range(n):
        p.z[k] = max(p.z[k], 0.0)
        p.w[k] = max(p.w[k], 0.0)
    return SOLVED


def ray_proves(p: Lcp, n: int) -> bool:
    """Whether a ray proves that no ``z >= 0`` has ``M z + q >= 0`` (Farkas)."""
    for k in range(n):
        p.right[k] = p.ray[k] if p.active[k] != 0 else p.ray[n + k]
    along = 0.0
    size = 0.0
    for k in range(n):
        along += p.q[k] * p.right[k]
        size += math.fabs(p.q[k]) * math.fabs(p.right[k])
    for j in range(n):
        total = 0.0
        terms = 0.0
        for i in range(n):
            total += p.matrix[i * n + j] * p.right[i]
            terms += math.fabs(p.matrix[i * n + j]) * math.fabs(p.right[i])
        if total > PROOF_ZERO * terms:
            return False
    return along < -LCP_ZERO * size
