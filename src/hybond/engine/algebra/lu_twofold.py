"""Square linear systems with twice the digits of a number: factors with partial pivoting.

Each entry of a matrix or of a right-hand side has the rest beside it that it was rounded by.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.lu import REGULAR, SINGULAR
from hybond.engine.algebra.twofold import add_product, take_quotient
from hybond.engine.words import Floats, Ints


def lu_factor_twofold(n: int, a: Floats, rest: Floats, row: Ints) -> int:
    """Put the factors of `a`, of n rows, in its place; SINGULAR if a pivot is zero."""
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if math.fabs(a[i * n + k]) > math.fabs(a[p * n + k]):
                p = i
        row[k] = p
        pivot = a[p * n + k]
        if pivot == 0.0 or not math.isfinite(pivot):
            return SINGULAR
        if p != k:
            for j in range(n):
                swap(a, k * n + j, p * n + j)
                swap(rest, k * n + j, p * n + j)
        for i in range(k + 1, n):
            at = i * n + k
            if a[at] == 0.0:
                continue
            take_quotient(a, rest, at, a, rest, k * n + k)
            for j in range(k + 1, n):
                if a[k * n + j] != 0.0:
                    add_product(a, rest, i * n + j, -a[at], -rest[at], k * n + j)
    return REGULAR


def lu_solve_twofold(n: int, a: Floats, rest: Floats, row: Ints, b: Floats, b_rest: Floats) -> None:
    """Solve for a right-hand side in its place; factors from lu_factor_twofold."""
    for k in range(n):
        if row[k] != k:
            swap(b, k, row[k])
            swap(b_rest, k, row[k])
    for i in range(n):
        for k in range(i):
            if a[i * n + k] != 0.0:
                add_product(b, b_rest, i, -a[i * n + k], -rest[i * n + k], k)
    for back in range(n):
        i = n - 1 - back
        for k in range(i + 1, n):
            if a[i * n + k] != 0.0:
                add_product(b, b_rest, i, -a[i * n + k], -rest[i * n + k], k)
        take_quotient(b, b_rest, i, a, rest, i * n + i)


def swap(a: Floats, i: int, j: int) -> None:
    """Exchange two entries."""
    kept = a[i]
    a[i] = a[j]
    a[j] = kept
