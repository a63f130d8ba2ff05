"""Whether a matrix is positive semidefinite, so that laws coupled by it have one convex answer."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.scaling import balance
from hybond.engine.words import Floats

INDEFINITE: Final = 1e-11
"""A matrix is semidefinite if its eigenvalues, after scaling, are not below minus this, per row."""


def is_indefinite(n: int, m: Floats, scale: Floats, down: Floats, square: Floats) -> bool:
    """Whether a matrix is not positive semidefinite, to rounding, after scaling.

    The last three are room: n, n and n times n numbers.
    """
    balance(n, m, scale, down)
    for i in range(n):
        for j in range(n):
            own = m[i * n + j] + m[j * n + i]
            square[i * n + j] = own * scale[i] * scale[j]
        square[i * n + i] += INDEFINITE * float(n)
    # Cholesky, of the upper half alone: its pivots say it
    for k in range(n):
        pivot = square[k * n + k]
        if not pivot > 0.0:
            return True
        for i in range(k + 1, n):
            share = square[k * n + i] / pivot
            if share != 0.0:
                for j in range(i, n):
                    square[i * n + j] -= share * square[k * n + j]
    return False
