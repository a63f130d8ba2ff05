"""Orthogonal factors by Householder's reflections, with and without exchange of columns.

Matrices are arrays row after row.
"""

import math

from hybond.engine.words import Floats, Ints


def qr_reflect(m: int, n: int, a: Floats, scale: Floats, column: Ints, pivot: bool) -> int:
    """Factor `a`, of m rows and n columns, in its place; return how many reflections there are.

    Above the diagonal stands R, below it the reflections ``1 - scale v v'`` with ``v[k] = 1``. With
    `pivot` the column with the largest rest comes next; `column` says which one stands where.
    """
    steps = min(m, n)
    for j in range(n):
        column[j] = j
    for k in range(steps):
        if pivot:
            bring_largest(m, n, a, k, column)
        size = 0.0
        for i in range(k, m):
            size = math.hypot(size, a[i * n + k])
        scale[k] = 0.0
        if size == 0.0:
            continue
        head = a[k * n + k]
        beta = -math.copysign(size, head)
        scale[k] = (beta - head) / beta
        for i in range(k + 1, m):
            a[i * n + k] /= head - beta
        a[k * n + k] = beta
        for j in range(k + 1, n):
            total = a[k * n + j]
            for i in range(k + 1, m):
                total += a[i * n + k] * a[i * n + j]
            total *= scale[k]
            a[k * n + j] -= total
            for i in range(k + 1, m):
                a[i * n + j] -= total * a[i * n + k]
    return steps


def bring_largest(m: int, n: int, a: Floats, k: int, column: Ints) -> None:
    """Exchange column k with the one whose part below row k is largest."""
    best = k
    most = -1.0
    for j in range(k, n):
        size = 0.0
        for i in range(k, m):
            size += a[i * n + j] * a[i * n + j]
        if size > most:
            most = size
            best = j
    if best == k:
        return
    for i in range(m):
        kept = a[i * n + k]
        a[i * n + k] = a[i * n + best]
        a[i * n + best] = kept
    place = column[k]
    column[k] = column[best]
    column[best] = place


def qr_rotate(m: int, n: int, a: Floats, scale: Floats, back: bool, c: int, b: Floats) -> None:
    """Multiply `b`, of m rows and c columns, by Q, or with `back` by its transpose."""
    steps = min(m, n)
    for step in range(steps):
        k = step if back else steps - 1 - step
        if scale[k] == 0.0:
            continue
        for j in range(c):
            total = b[k * c + j]
            for i in range(k + 1, m):
                total += a[i * n + k] * b[i * c + j]
            total *= scale[k]
            b[k * c + j] -= total
            for i in range(k + 1, m):
                b[i * c + j] -= total * a[i * n + k]


def complement(m: int, n: int, a: Floats, scale: Floats, column: Ints, basis: Floats) -> int:
    """Put an orthonormal basis of what is orthogonal to the n independent columns of `a` there.

    Returns their number, m - n; `a` is lost.
    """
    qr_reflect(m, n, a, scale, column, False)
    free = max(m - n, 0)
    for k in range(m * free):
        basis[k] = 0.0
    for j in range(free):
        basis[(n + j) * free + j] = 1.0
    qr_rotate(m, n, a, scale, False, free, basis)
    return free
