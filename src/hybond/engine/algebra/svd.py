"""Singular values by Jacobi's rotations from one side; what follows from them.

Null spaces, ranks, least squares of smallest norm, pseudo-inverses: what the equations of a mode
and its jumps take from numpy.linalg. Matrices are arrays row after row.

Source: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 8.6.3. Two columns are turned in their
plane until all are orthogonal; their lengths are then the singular values, small ones to nearly
full relative accuracy.
"""

import math
from typing import Final

from hybond.engine.algebra.products import largest_part
from hybond.engine.algebra.regular import solve_regular
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.words import Floats, Ints, floats, ints, record

SVD_SWEEPS: Final = 60
RIGHT_ANGLE: Final = 1e-15
"""Cosine of an angle that counts as right."""
NO_COLUMN: Final = 1e-25
"""A column below this part of the largest is zero."""


@record
class Svd:
    """Room for a matrix of up to `rows` times `columns`, and what it falls apart into.

    `u` holds the columns of U times the singular values, one after the other, `v` those of V.
    """

    rows: int
    columns: int
    u: Floats
    v: Floats
    s: Floats
    length: Floats
    place: Ints
    """Where the columns of a regular matrix were."""


def make_svd(rows: int, columns: int) -> Svd:
    """Return room for matrices of up to these sizes."""
    d = Svd()
    d.rows = rows
    d.columns = columns
    d.u = floats(rows * columns)
    d.v = floats(columns * columns)
    d.s = floats(columns)
    d.length = floats(columns)
    d.place = ints(columns)
    return d


def svd(d: Svd, m: int, n: int, a: Floats) -> None:
    """Find ``a = U S V'``, `a` of m rows and n columns; the largest value comes first."""
    for j in range(n):
        for i in range(m):
            d.u[j * m + i] = a[i * n + j]
    svd_of_columns(d, m, n)


def svd_of_transpose(d: Svd, m: int, n: int, a: Floats) -> None:
    """Find the same of the transpose of `a`, which has m rows and n columns."""
    for i in range(m):
        for j in range(n):
            d.u[i * n + j] = a[i * n + j]
    svd_of_columns(d, n, m)


def svd_of_columns(d: Svd, m: int, n: int) -> None:
    """Turn the n columns of length m in `d.u` until they are orthogonal, and put them in order."""
    for k in range(n * n):
        d.v[k] = 0.0
    for k in range(n):
        d.v[k * n + k] = 1.0
    for _ in range(SVD_SWEEPS):
        if turn_all_pairs(d, m, n):
            break
    for k in range(n):
        d.s[k] = math.sqrt(inner_product(m, d.u, k * m, k * m))
    for k in range(n):
        best = k
        for j in range(k + 1, n):
            if d.s[j] > d.s[best]:
                best = j
        if best != k:
            kept = d.s[k]
            d.s[k] = d.s[best]
            d.s[best] = kept
            exchange_columns(m, d.u, k * m, best * m)
            exchange_columns(n, d.v, k * n, best * n)


def turn_all_pairs(d: Svd, m: int, n: int) -> bool:
    """Turn all pairs of columns once; return whether all were orthogonal."""
    most = 0.0
    for k in range(n):
        d.length[k] = inner_product(m, d.u, k * m, k * m)
        most = max(most, d.length[k])
    still = True
    small = NO_COLUMN * NO_COLUMN * most
    for p in range(n - 1):
        for q in range(p + 1, n):
            if d.length[p] <= small or d.length[q] <= small:
                continue
            across = inner_product(m, d.u, p * m, q * m)
            if math.fabs(across) <= RIGHT_ANGLE * math.sqrt(d.length[p]) * math.sqrt(d.length[q]):
                continue
            still = False
            zeta = (d.length[q] - d.length[p]) / (2.0 * across)
            t = math.copysign(1.0, zeta) / (math.fabs(zeta) + math.hypot(1.0, zeta))
            c = 1.0 / math.hypot(1.0, t)
            turn_columns(m, d.u, p * m, q * m, c, c * t)
            turn_columns(n, d.v, p * n, q * n, c, c * t)
            d.length[p] = inner_product(m, d.u, p * m, p * m)
            d.length[q] = inner_product(m, d.u, q * m, q * m)
    return still


def inner_product(n: int, a: Floats, p: int, q: int) -> float:
    """Return the inner product of the n numbers from p on and those from q on."""
    total = 0.0
    for k in range(n):
        total += a[p + k] * a[q + k]
    return total


def turn_columns(n: int, a: Floats, p: int, q: int, c: float, s: float) -> None:
    """Turn two columns in their plane."""
    for k in range(n):
        x = a[p + k]
        y = a[q + k]
        a[p + k] = c * x - s * y
        a[q + k] = s * x + c * y


def exchange_columns(n: int, a: Floats, p: int, q: int) -> None:
    """Exchange two columns."""
    for k in range(n):
        kept = a[p + k]
        a[p + k] = a[q + k]
        a[q + k] = kept


def rank_above(d: Svd, n: int, threshold: float) -> int:
    """Return how many of n singular values exceed `threshold`."""
    rank = 0
    while rank < n and d.s[rank] > threshold:
        rank += 1
    return rank


def null_space(d: Svd, m: int, n: int, a: Floats, tolerance: float, basis: Floats) -> int:
    """Put an orthonormal basis of the null space of `a` into `basis`; return how many columns.

    `a` has m rows and n columns and is kept; rows are measured by their largest entry.
    """
    if m == 0:
        for k in range(n * n):
            basis[k] = 0.0
        for k in range(n):
            basis[k * n + k] = 1.0
        return n
    for i in range(m):
        size = largest_part(n, a, i * n)
        for j in range(n):
            d.u[j * m + i] = a[i * n + j] / size if size > 0.0 else 0.0
    svd_of_columns(d, m, n)
    first = d.s[0] if n > 0 else 0.0
    rank = rank_above(d, n, tolerance * max(first, 1e-300))
    rest_of_v(d, n, rank, basis)
    return n - rank


def rest_of_v(d: Svd, n: int, rank: int, basis: Floats) -> None:
    """Put the columns of V from `rank` on into the columns of `basis`."""
    free = n - rank
    for j in range(free):
        for i in range(n):
            basis[i * free + j] = d.v[(rank + j) * n + i]


def smallest_solution(d: Svd, m: int, n: int, rank: int, c: int, b: Floats, x: Floats) -> None:
    """Put the least squares solutions of smallest norm for the c columns of `b` into `x`.

    `d` is the decomposition of the matrix, of m rows and n columns, of which `rank` values count.
    """
    for k in range(n * c):
        x[k] = 0.0
    for k in range(rank):
        for j in range(c):
            total = 0.0
            for i in range(m):
                total += d.u[k * m + i] * b[i * c + j]
            # the columns of u carry one factor of the singular value, its inverse another
            total = total / d.s[k] / d.s[k]
            for i in range(n):
                x[i * c + j] += d.v[k * n + i] * total


def least_squares(
    d: Svd, m: int, n: int, a: Floats, relative: float, c: int, b: Floats, x: Floats
) -> int:
    """Solve ``a x = b`` for the c columns of `b` in the least squares; return the rank of `a`.

    Singular values up to the part `relative` of the largest count as zero; a negative one says
    rounding times the larger size. As numpy.linalg.lstsq, rcond being `relative`, or None.
    """
    if m == n and solve_regular(n, a, c, b, x, d.u, d.length, d.place):
        return n
    svd(d, m, n, a)
    longer = max(m, n)
    part = relative if relative >= 0.0 else EPSILON * float(longer)
    first = d.s[0] if n > 0 else 0.0
    rank = min(rank_above(d, n, part * first), m)
    smallest_solution(d, m, n, rank, c, b, x)
    return rank


def pseudo_inverse(d: Svd, m: int, n: int, a: Floats, relative: float, x: Floats) -> int:
    """Put the pseudo-inverse of `a`, n rows and m columns, into `x`; return the rank.

    As numpy.linalg.pinv with rcond being `relative`.
    """
    svd(d, m, n, a)
    first = d.s[0] if n > 0 else 0.0
    rank = min(rank_above(d, n, relative * first), m)
    for k in range(n * m):
        x[k] = 0.0
    for k in range(rank):
        for j in range(m):
            share = d.u[k * m + j] / d.s[k] / d.s[k]
            for i in range(n):
                x[i * m + j] += d.v[k * n + i] * share
    return rank
