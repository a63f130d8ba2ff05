"""Products of matrices, which are arrays row after row, and the largest of some numbers."""

import math

from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.words import Floats, Ints


def times_vector(m: int, n: int, a: Floats, x: Floats, y: Floats) -> None:
    """Put `a` times `x` into `y`; `a` has m rows and n columns."""
    for i in range(m):
        total = 0.0
        for j in range(n):
            total += a[i * n + j] * x[j]
        y[i] = total


def times_matrix(m: int, k: int, n: int, a: Floats, b: Floats, c: Floats) -> None:
    """Put `a`, of m rows and k columns, times `b`, of k rows and n columns, into `c`."""
    for i in range(m):
        for j in range(n):
            c[i * n + j] = 0.0
        for p in range(k):
            factor = a[i * k + p]
            if factor != 0.0:
                for j in range(n):
                    c[i * n + j] += factor * b[p * n + j]


def times_cancelling(m: int, k: int, n: int, a: Floats, b: Floats, c: Floats) -> None:
    """Put `a` times `b` into `c`, as `times_matrix`; what rounding leaves of zero is zero."""
    for i in range(m):
        for j in range(n):
            total = 0.0
            size = 0.0
            for p in range(k):
                term = a[i * k + p] * b[p * n + j]
                total += term
                size += math.fabs(term)
            c[i * n + j] = 0.0 if math.fabs(total) <= CANCELS * size else total


def times_orthonormal(m: int, k: int, n: int, a: Floats, b: Floats, c: Floats) -> None:
    """Put `a` times `b`, whose columns are of length 1, into `c`.

    Rounding of `b` is measured by that length, not by its entries: an entry that should be zero is
    a small number, and what it makes of a row of `a` is zero.
    """
    times_matrix(m, k, n, a, b, c)
    for i in range(m):
        size = 0.0
        for p in range(k):
            size += math.fabs(a[i * k + p])
        for j in range(n):
            if math.fabs(c[i * n + j]) <= CANCELS * size:
                c[i * n + j] = 0.0


def largest(n: int, a: Floats) -> float:
    """Return the largest magnitude of the first n numbers; 0 if there are none."""
    most = 0.0
    for k in range(n):
        if math.fabs(a[k]) > most:
            most = math.fabs(a[k])
    return most


def largest_part(n: int, a: Floats, at: int) -> float:
    """Return the same of n numbers from `at` on."""
    most = 0.0
    for k in range(n):
        most = max(most, math.fabs(a[at + k]))
    return most


def all_finite(n: int, a: Floats) -> bool:
    """Whether none of the first n numbers is infinite or not a number."""
    nothing = 0.0
    for k in range(n):
        nothing += 0.0 * a[k]
    return nothing == 0.0


def are_equal(n: int, a: Floats, b: Floats) -> bool:
    """Whether the first n numbers of both are the same."""
    for k in range(n):
        if a[k] != b[k]:
            return False
    return True


def copy_floats(n: int, a: Floats, b: Floats) -> None:
    """Copy the first n numbers of `a` into `b`."""
    for k in range(n):
        b[k] = a[k]


def copy_part(n: int, a: Floats, first: int, b: Floats, at: int) -> None:
    """Copy n numbers of `a`, from `first` on, into `b`, from `at` on."""
    for k in range(n):
        b[at + k] = a[first + k]


def copy_places(n: int, a: Ints, first: int, b: Ints, at: int) -> None:
    """Do the same with whole numbers."""
    for k in range(n):
        b[at + k] = a[first + k]


def column_norm(n: int, a: Floats) -> float:
    """Return the largest sum of magnitudes of a column."""
    most = 0.0
    for j in range(n):
        total = 0.0
        for i in range(n):
            total += math.fabs(a[i * n + j])
        if not total <= most:
            most = total
    return most
