"""One choice of ways for the laws of a part: what it asks for, and whether anything keeps it.

A way makes of each law an equation, and inequalities that say where the way ends. Where the
equations leave something open, the answer is the smallest one that keeps the inequalities, if any
does (`least_distance`).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.least_distance import nearest_point
from hybond.engine.algebra.products import largest_part
from hybond.engine.complementarity.branch_records import Branching
from hybond.engine.complementarity.law_roles import FORWARD, ONE_SIDED, SHUT, TWO_SIDED

KEPT_UP_TO: Final = 1e-11
"""Part of its terms, or of the largest constant, up to which an inequality is kept."""
NO_PIVOT: Final = 1e-11
"""What elimination leaves of a zero, rows being of size one."""
FAINT_PIVOT: Final = 1e-8
"""A pivot below it leaves a doubt,"""
CLEARLY_NONE: Final = 1e-14
"""and so does one above it that does not count."""


def keeps_choice(b: Branching) -> bool:
    """Whether the ways in ``b.way`` have an answer; it is put into ``b.l`` and ``b.w``."""
    n = b.n
    for i in range(n):
        put_equation_of(b, i)
    rows = 0
    for i in range(n):
        rows = put_ends_of(b, i, rows)
    faint = False
    solved = 0
    for i in range(n):
        b.column[i] = i
    going = True
    while going and solved < n:
        size = take_pivot(b, solved)
        if size > NO_PIVOT:
            faint = faint or size < FAINT_PIVOT
            eliminate_pivot(b, solved)
            solved += 1
        else:
            faint = faint or size > CLEARLY_NONE
            going = False
    for i in range(solved, n):
        if math.fabs(b.right[i]) > KEPT_UP_TO * max(b.terms[i], 1.0):
            b.doubt = b.doubt or faint
            return False
    for i in range(n):
        b.l[b.column[i]] = b.right[i] if i < solved else 0.0
    if solved < n:
        put_open(b, solved)
    find_w(b)
    if holds_ends(b, rows):
        return True
    if solved < n and move_inside(b, rows, n - solved):
        find_w(b)
        if holds_ends(b, rows):
            return True
        faint = True
    b.doubt = b.doubt or faint
    return False


def put_equation_of(b: Branching, i: int) -> None:
    """Put the equation of law i in the way that it is to go."""
    n = b.n
    way = float(b.way[i])
    role = b.role[i]
    common = b.common[i] != 0
    held = role == SHUT or (role == ONE_SIDED and (b.way[i] == 1) == common)
    held = held or (role == TWO_SIDED and b.way[i] == 0 and not common)
    slides = role >= FORWARD or (role == TWO_SIDED and b.way[i] != 0)
    b.right[i] = 0.0
    for j in range(n):
        own = 1.0 if i == j else 0.0
        if held:
            own = b.m[i * n + j]
        elif slides:
            # what is l of friction that is given its force is the force
            net = b.m[i * n + j] if common and role == TWO_SIDED else own
            own = net + way * b.slope[i * n + j]
        b.a[i * n + j] = own
    if held:
        b.right[i] = -b.q[i]
    elif slides:
        b.right[i] = -way * b.limit[i]
        if common and role == TWO_SIDED:
            b.right[i] -= b.q[i]
    b.terms[i] = math.fabs(b.right[i])
    most = largest_part(n, b.a, i * n)
    per = 1.0 / most if most > 0.0 else 1.0
    for j in range(n):
        b.a[i * n + j] *= per
    b.right[i] *= per
    b.terms[i] *= per


def put_ends_of(b: Branching, i: int, first: int) -> int:
    """Put where the way of law i ends into rows from `first` on; return the next free row."""
    role = b.role[i]
    common = b.common[i] != 0
    if role == ONE_SIDED:
        return put_end(b, first, i, (b.way[i] == 1) != common, 1.0, 0.0)
    if role != TWO_SIDED:
        return first
    if b.way[i] != 0:
        # it goes that way, with a limit that is none below zero
        row = put_end(b, first, i, not common, float(b.way[i]), 0.0)
        return put_end(b, row, i, False, 0.0, 1.0)
    row = put_end(b, first, i, common, 1.0, 1.0)
    return put_end(b, row, i, common, -1.0, 1.0)


def put_end(b: Branching, row: int, i: int, is_w: bool, part: float, of_limit: float) -> int:
    """Put ``part`` of `w` or `l`, plus a part of the limit, into a row; return the next one."""
    n = b.n
    b.floor[row] = of_limit * b.limit[i] + (part * b.q[i] if is_w else 0.0)
    b.faint[row] = math.fabs(part) * b.noise[i] if is_w else 0.0
    b.slack[row] = max(of_limit * math.fabs(b.limit[i]), math.fabs(part * b.q[i]) if is_w else 0.0)
    for j in range(n):
        own = b.m[i * n + j] if is_w else (1.0 if i == j else 0.0)
        b.g[row * n + j] = part * own + of_limit * b.slope[i * n + j]
    return row + 1


def take_pivot(b: Branching, k: int) -> float:
    """Bring the largest coefficient that is left to row and column k; return its size."""
    n = b.n
    best = -1.0
    p = k
    c = k
    for i in range(k, n):
        for j in range(k, n):
            size = math.fabs(b.a[i * n + j])
            if size > best:
                best = size
                p = i
                c = j
    for j in range(n):
        kept = b.a[p * n + j]
        b.a[p * n + j] = b.a[k * n + j]
        b.a[k * n + j] = kept
    for i in range(n):
        kept = b.a[i * n + c]
        b.a[i * n + c] = b.a[i * n + k]
        b.a[i * n + k] = kept
    kept = b.right[p]
    b.right[p] = b.right[k]
    b.right[k] = kept
    kept = b.terms[p]
    b.terms[p] = b.terms[k]
    b.terms[k] = kept
    one = b.column[c]
    b.column[c] = b.column[k]
    b.column[k] = one
    return best


def eliminate_pivot(b: Branching, k: int) -> None:
    """Solve row k for its unknown, and put that into all other rows."""
    n = b.n
    pivot = b.a[k * n + k]
    for j in range(k, n):
        b.a[k * n + j] /= pivot
    b.right[k] /= pivot
    b.terms[k] /= math.fabs(pivot)
    for i in range(n):
        factor = b.a[i * n + k]
        if i != k and factor != 0.0:
            for j in range(k, n):
                b.a[i * n + j] -= factor * b.a[k * n + j]
            b.right[i] -= factor * b.right[k]
            b.terms[i] += math.fabs(factor) * b.terms[k]


def put_open(b: Branching, solved: int) -> None:
    """Put an orthonormal basis of what the equations leave open there, and the smallest answer."""
    n = b.n
    many = n - solved
    for c in range(many):
        for i in range(n):
            b.basis[i * many + c] = 0.0
        for i in range(solved):
            b.basis[b.column[i] * many + c] = -b.a[i * n + solved + c]
        b.basis[b.column[solved + c] * many + c] = 1.0
        for other in range(c + 1):
            # against all before it, then to length one
            along = 0.0
            for i in range(n):
                along += b.basis[i * many + other] * b.basis[i * many + c]
            length = math.sqrt(along) if other == c else 1.0
            for i in range(n):
                if other < c:
                    b.basis[i * many + c] -= along * b.basis[i * many + other]
                else:
                    b.basis[i * many + c] /= length
    for c in range(many):
        along = 0.0
        for i in range(n):
            along += b.basis[i * many + c] * b.l[i]
        for i in range(n):
            b.l[i] -= along * b.basis[i * many + c]


def find_w(b: Branching) -> None:
    """Put ``w`` of the answer there."""
    n = b.n
    b.largest = 0.0
    for i in range(n):
        b.largest = max(b.largest, math.fabs(b.l[i]))
        b.w[i] = b.q[i]
        for j in range(n):
            b.w[i] += b.m[i * n + j] * b.l[j]


def holds_ends(b: Branching, rows: int) -> bool:
    """Whether all inequalities are kept, up to rounding."""
    n = b.n
    if not math.isfinite(b.largest):
        return False
    for r in range(rows):
        total = b.floor[r]
        size = b.slack[r]
        for j in range(n):
            term = b.g[r * n + j] * b.l[j]
            total += term
            size += math.fabs(term)
        if not total >= -KEPT_UP_TO * max(size, max(b.largest, 1.0)) - b.faint[r]:
            return False
    return True


def move_inside(b: Branching, rows: int, many: int) -> bool:
    """Add to the answer what keeps the inequalities, the least of it; False if nothing does."""
    n = b.n
    for r in range(rows):
        total = b.floor[r]
        size = max(b.slack[r], 1.0)
        for j in range(n):
            total += b.g[r * n + j] * b.l[j]
            size = max(size, math.fabs(b.g[r * n + j] * b.l[j]))
        b.bound[r] = -total - 0.1 * KEPT_UP_TO * size
        for c in range(many):
            along = 0.0
            for j in range(n):
                along += b.g[r * n + j] * b.basis[j * many + c]
            b.moved[r * many + c] = 0.0 if math.fabs(along) < NO_PIVOT else along
    if not nearest_point(b.distance, rows, many, b.moved, b.bound, b.z):
        return False
    for i in range(n):
        for c in range(many):
            b.l[i] += b.basis[i * many + c] * b.z[c]
    return True
