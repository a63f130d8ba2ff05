"""Eigenvalues of symmetric matrices, by Jacobi's rotations.

Source: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 8.5. Matrices are arrays row after row.
"""

import math
from typing import Final

from hybond.engine.words import Floats

EIGEN_ROUNDS: Final = 60
BESIDE_ZERO: Final = 1e-17
"""An entry beside the diagonal below this part of the whole is zero."""


def eigenvalues(n: int, a: Floats, values: Floats, vectors: Floats) -> None:
    """Put the eigenvalues of `a` in ascending order, and its eigenvectors as columns; `a` is lost.

    As numpy.linalg.eigh.
    """
    for k in range(n * n):
        vectors[k] = 0.0
    for k in range(n):
        vectors[k * n + k] = 1.0
    whole = 0.0
    for k in range(n * n):
        whole = math.hypot(whole, a[k])
    for _ in range(EIGEN_ROUNDS):
        if clear_all_entries(n, a, vectors, BESIDE_ZERO * whole):
            break
    for k in range(n):
        values[k] = a[k * n + k]
    for k in range(n):
        least = k
        for j in range(k + 1, n):
            if values[j] < values[least]:
                least = j
        if least != k:
            kept = values[k]
            values[k] = values[least]
            values[least] = kept
            for i in range(n):
                kept = vectors[i * n + k]
                vectors[i * n + k] = vectors[i * n + least]
                vectors[i * n + least] = kept


def clear_all_entries(n: int, a: Floats, vectors: Floats, small: float) -> bool:
    """Make every entry beside the diagonal zero once; return whether all were."""
    still = True
    for p in range(n - 1):
        for q in range(p + 1, n):
            across = a[p * n + q]
            if math.fabs(across) <= small:
                continue
            still = False
            zeta = (a[q * n + q] - a[p * n + p]) / (2.0 * across)
            t = math.copysign(1.0, zeta) / (math.fabs(zeta) + math.hypot(1.0, zeta))
            c = 1.0 / math.hypot(1.0, t)
            s = c * t
            for i in range(n):
                x = a[i * n + p]
                y = a[i * n + q]
                a[i * n + p] = c * x - s * y
                a[i * n + q] = s * x + c * y
                x = vectors[i * n + p]
                y = vectors[i * n + q]
                vectors[i * n + p] = c * x - s * y
                vectors[i * n + q] = s * x + c * y
            for j in range(n):
                x = a[p * n + j]
                y = a[q * n + j]
                a[p * n + j] = c * x - s * y
                a[q * n + j] = s * x + c * y
    return still
