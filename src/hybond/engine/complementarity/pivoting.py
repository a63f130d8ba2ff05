"""Pivots on complementary pairs: principal pivots, regular parts, Lemke's path.

Source: R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press
1992: 2.3 (principal pivots), 4.4 (Lemke), 4.9 (lexicographic ratio test).
"""

import math
from typing import Final

from hybond.engine.algebra.lu import REGULAR, SINGULAR, lu_invert
from hybond.engine.algebra.products import column_norm, copy_floats, copy_part
from hybond.engine.complementarity.lcp import ON_A_RAY, SOLVED, TOO_MANY_PIVOTS, Lcp
from hybond.engine.words import Ints

REGULAR_PIVOT: Final = 1e-9
"""Smallest pivot of a matrix that counts as regular."""


def split_pairs(p: Lcp, n: int, active: Ints) -> int:
    """List which pairs are active in `p.on`, the others in `p.off`; return how many are."""
    count = 0
    others = 0
    for k in range(n):
        if active[k] != 0:
            p.on[count] = k
            count += 1
        else:
            p.off[others] = k
            others += 1
    return count


def principal(p: Lcp, n: int, active: Ints) -> int:
    """Put M and q after z and w of the active pairs have changed places into p.pivoted, p.constant.

    SINGULAR if the block of the active pairs is, or nearly so.
    """
    count = split_pairs(p, n, active)
    if count == 0:
        copy_floats(n * n, p.matrix, p.pivoted)
        copy_floats(n, p.q, p.constant)
        return REGULAR
    for i in range(count):
        for j in range(count):
            p.block[i * count + j] = p.matrix[p.on[i] * n + p.on[j]]
    before = column_norm(count, p.block)
    if lu_invert(count, p.block, p.pivot, p.inverse) == SINGULAR:
        return SINGULAR
    if not column_norm(count, p.inverse) * before < 1e13:
        return SINGULAR
    for i in range(count):
        at = p.on[i]
        for j in range(count):
            p.pivoted[at * n + p.on[j]] = p.inverse[i * count + j]
        for j in range(n - count):
            p.pivoted[at * n + p.off[j]] = 0.0
        for k in range(count):
            # few are not zero where pairs are many: what is far apart has nothing to do with it
            share = p.inverse[i * count + k]
            for j in range(n - count if share != 0.0 else 0):
                p.pivoted[at * n + p.off[j]] += share * p.matrix[p.on[k] * n + p.off[j]]
        for j in range(n - count):
            p.pivoted[at * n + p.off[j]] = -p.pivoted[at * n + p.off[j]]
        total = 0.0
        for k in range(count):
            total += p.inverse[i * count + k] * p.q[p.on[k]]
        p.constant[at] = -total
    for i in range(n - count):
        at = p.off[i]
        for j in range(n):
            p.pivoted[at * n + j] = 0.0
        for k in range(count):
            share = p.matrix[at * n + p.on[k]]
            for j in range(count if share != 0.0 else 0):
                p.pivoted[at * n + p.on[j]] += share * p.inverse[k * count + j]
            for j in range(n - count if share != 0.0 else 0):
                p.pivoted[at * n + p.off[j]] += share * -p.pivoted[p.on[k] * n + p.off[j]]
        for j in range(n - count):
            left = p.matrix[at * n + p.off[j]] - p.pivoted[at * n + p.off[j]]
            p.pivoted[at * n + p.off[j]] = left
        total = 0.0
        for k in range(count):
            total += p.matrix[at * n + p.on[k]] * p.constant[p.on[k]]
        p.constant[at] = p.q[at] + total
    return REGULAR


def independent(p: Lcp, n: int, active: Ints) -> int:
    """Leave of the active pairs those that symmetric elimination finds regular; return how many.

    Pivots of one or two pairs at a time: a skew block has no diagonal to divide by.
    """
    count = split_pairs(p, n, active)
    for i in range(count):
        p.path[i] = 1
        for j in range(count):
            p.block[i * count + j] = p.matrix[p.on[i] * n + p.on[j]]
    kept = 0
    while kept < count:
        one = 0
        alone = -1.0
        first = 0
        second = 0
        couple = -1.0
        for i in range(count):
            size = math.fabs(p.block[i * count + i]) if p.path[i] != 0 else 0.0
            if size > alone:
                alone = size
                one = i
            for j in range(count):
                size = 0.0
                if i != j and p.path[i] != 0 and p.path[j] != 0:
                    across = p.block[i * count + j] * p.block[j * count + i]
                    size = math.sqrt(math.fabs(across))
                if size > couple:
                    couple = size
                    first = i
                    second = j
        if max(alone, couple) < REGULAR_PIVOT:
            break
        if alone < 0.1 * couple:
            eliminate_two(p, count, first, second)
            kept += 2
        else:
            eliminate_one(p, count, one)
            kept += 1
    for i in range(count):
        if p.path[i] != 0:
            active[p.on[i]] = 0
    return kept


def eliminate_one(p: Lcp, n: int, k: int) -> None:
    """Take pair k out of the block."""
    for j in range(n):
        p.line[j] = p.block[k * n + j] / p.block[k * n + k]
        p.right[j] = p.block[j * n + k]
    for i in range(n):
        for j in range(n):
            p.block[i * n + j] -= p.right[i] * p.line[j]
    p.path[k] = 0


def eliminate_two(p: Lcp, n: int, k: int, l: int) -> None:
    """Take pairs k and l out of the block."""
    a = p.block[k * n + k]
    b = p.block[k * n + l]
    c = p.block[l * n + k]
    d = p.block[l * n + l]
    det = a * d - b * c
    for j in range(n):
        p.line[j] = (d * p.block[k * n + j] - b * p.block[l * n + j]) / det
        p.column[j] = (a * p.block[l * n + j] - c * p.block[k * n + j]) / det
    for j in range(n):
        p.right[j] = p.block[j * n + k]
        p.fall[j] = p.block[j * n + l]
    for i in range(n):
        for j in range(n):
            p.block[i * n + j] -= p.right[i] * p.line[j] + p.fall[i] * p.column[j]
    p.path[k] = 0
    p.path[l] = 0


def lemke_path(p: Lcp, n: int, limit: int, tol: float) -> int:
    """Follow Lemke's path from ``w = q + M z + z0`` with a large z0 until z0 is zero.

    M and q are p.pivoted and p.constant. Leaves in p.path which pairs have a basic z, in p.ray the
    direction of (w, z) if it ends on a ray, and counts p.pivots. The table holds ``basic = table
    nonbasic``, its last column the constants; unknowns are numbered w, z, z0. The lexicographic
    rule is that of ``q + (eps, eps^2, ...)``.
    """
    wide = n + 2
    z0 = 2 * n
    clear = True
    for i in range(n):
        copy_part(n, p.pivoted, i * n, p.table, i * wide)
        p.table[i * wide + n] = 1.0
        p.table[i * wide + n + 1] = p.constant[i]
        if not p.constant[i] >= 0.0:
            clear = False
        p.basic[i] = i
        p.beside[i] = n + i
        p.place[i] = -1
        p.place[n + i] = i
        p.path[i] = 0
    p.beside[n] = z0
    p.place[z0] = n
    if clear:
        return SOLVED
    entering = z0
    count = 0
    while count < limit:
        count += 1
        c = p.place[entering]
        steep = 1.0
        for i in range(n):
            p.column[i] = p.table[i * wide + c]
            steep = max(steep, math.fabs(p.column[i]))
        r = -1
        if count == 1:
            # the last w to become nonnegative as z0 falls from infinity gives z0 its place
            lowest = math.inf
            for i in range(n):
                lowest = min(lowest, p.constant[i])
            for i in range(n):
                if p.constant[i] <= lowest + tol:
                    r = i
        else:
            several = 0
            for i in range(n):
                if p.column[i] < -tol * steep:
                    p.rows[several] = i
                    several += 1
            if several == 0:
                note_ray(p, n, entering)
                note_path(p, n)
                p.pivots += count - 1
                return ON_A_RAY
            r = first_to_vanish(p, n, several, tol)
        leaving = p.basic[r]
        if leaving == z0:
            p.basic[r] = entering
            note_path(p, n)
            p.pivots += count
            return SOLVED
        exchange_basic(p, n, r, c)
        p.basic[r] = entering
        p.beside[c] = leaving
        p.place[entering] = -1
        p.place[leaving] = c
        entering = leaving + n if leaving < n else leaving - n
    note_path(p, n)
    p.pivots += limit
    return TOO_MANY_PIVOTS


def exchange_basic(p: Lcp, n: int, r: int, c: int) -> None:
    """Exchange the unknown of row r with that of column c, p.column being that column."""
    wide = n + 2
    for j in range(wide):
        p.line[j] = p.table[r * wide + j] / -p.column[r]
    p.line[c] = 1.0 / p.column[r]
    for i in range(n):
        p.table[i * wide + c] = 0.0
        factor = p.column[i]
        if i != r and factor != 0.0:
            for j in range(wide):
                p.table[i * wide + j] += factor * p.line[j]
    copy_part(wide, p.line, 0, p.table, r * wide)


def note_path(p: Lcp, n: int) -> None:
    """Note which pairs have a basic z."""
    for k in range(n):
        p.path[k] = 0
    for i in range(n):
        if n <= p.basic[i] and p.basic[i] < 2 * n:
            p.path[p.basic[i] - n] = 1


def note_ray(p: Lcp, n: int, entering: int) -> None:
    """Note the direction along the ray on which a path ends."""
    for k in range(2 * n + 1):
        p.ray[k] = 0.0
    for i in range(n):
        p.ray[p.basic[i]] = p.column[i]
    p.ray[entering] = 1.0


def first_to_vanish(p: Lcp, n: int, several: int, tol: float) -> int:
    """Return the row whose unknown is zero first, ties decided in lexicographic order.

    The rows are the first `several` of p.rows.
    """
    wide = n + 2
    for k in range(several):
        i = p.rows[k]
        p.fall[k] = -p.column[i]
        p.ratio[k] = max(p.table[i * wide + n + 1], 0.0) / p.fall[k]
    several = keep_least(p, several, tol)
    for k in range(several):
        if p.basic[p.rows[k]] == 2 * n:
            return p.rows[k]  # z0 itself is zero: done
    j = 0
    while j < n and several > 1:
        at = p.place[j]
        for k in range(several):
            i = p.rows[k]
            share = 1.0 if p.basic[i] == j else 0.0
            if at >= 0:
                share = -p.table[i * wide + at]
            p.ratio[k] = share / p.fall[k]
        several = keep_least(p, several, tol)
        j += 1
    best = 0
    for k in range(1, several):
        if p.fall[k] > p.fall[best]:
            best = k
    return p.rows[best]


def keep_least(p: Lcp, several: int, tol: float) -> int:
    """Keep of p.rows those whose ratio is least, to rounding; return how many."""
    lowest = math.inf
    for k in range(several):
        lowest = min(lowest, p.ratio[k])
    kept = 0
    for k in range(several):
        if p.ratio[k] <= lowest + tol * max(1.0, math.fabs(lowest)):
            p.rows[kept] = p.rows[k]
            p.fall[kept] = p.fall[k]
            kept += 1
    return kept
