"""Square linear systems: factors with partial pivoting.

Matrices are arrays row after row. Factors stand where the matrix stood.
"""

import math
from typing import Final

from hybond.engine.words import Floats, Ints

REGULAR: Final = 0
SINGULAR: Final = 1


def lu_factor(n: int, a: Floats, row: Ints) -> int:
    """Put the factors of `a`, of n rows, in its place; SINGULAR if a pivot is zero.

    `row` keeps which row was the k-th pivot. As numpy.linalg.solve, which is LAPACK's gesv.
    """
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
                kept = a[k * n + j]
                a[k * n + j] = a[p * n + j]
                a[p * n + j] = kept
        for i in range(k + 1, n):
            factor = a[i * n + k] / pivot
            a[i * n + k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    a[i * n + j] -= factor * a[k * n + j]
    return REGULAR


def lu_solve(n: int, a: Floats, row: Ints, m: int, b: Floats) -> None:
    """Solve for `m` right-hand sides, the columns of `b`, in their place; `a` from lu_factor."""
    for k in range(n):
        p = row[k]
        if p != k:
            for j in range(m):
                kept = b[k * m + j]
                b[k * m + j] = b[p * m + j]
                b[p * m + j] = kept
    for i in range(n):
        for k in range(i):
            factor = a[i * n + k]
            if factor != 0.0:
                for j in range(m):
                    b[i * m + j] -= factor * b[k * m + j]
    for back in range(n):
        i = n - 1 - back
        for k in range(i + 1, n):
            factor = a[i * n + k]
            if factor != 0.0:
                for j in range(m):
                    b[i * m + j] -= factor * b[k * m + j]
        for j in range(m):
            b[i * m + j] /= a[i * n + i]


def lu_invert(n: int, a: Floats, row: Ints, inverse: Floats) -> int:
    """Put the inverse of `a` into `inverse`; `a` becomes its factors. SINGULAR if there is none."""
    if lu_factor(n, a, row) == SINGULAR:
        return SINGULAR
    for k in range(n * n):
        inverse[k] = 0.0
    for k in range(n):
        inverse[k * n + k] = 1.0
    lu_solve(n, a, row, n, inverse)
    return REGULAR
