"""Square systems that are clearly regular, solved by orthogonal factors.

What singular values would say of them costs many times as much; where there is doubt they are asked
(svd.py).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.qr import qr_reflect, qr_rotate
from hybond.engine.words import Floats, Ints

REGULAR: Final = 1e-8
"""A matrix whose diagonal of R falls to this part of its first entry is not clearly regular."""


def solve_regular(
    n: int, a: Floats, c: int, b: Floats, x: Floats, room: Floats, scale: Floats, column: Ints
) -> bool:
    """Solve ``a x = b`` for the c columns of `b`; False if `a`, n by n, is not clearly regular."""
    copy_floats(n * n, a, room)
    qr_reflect(n, n, room, scale, column, True)
    first = math.fabs(room[0]) if n > 0 else 0.0
    for k in range(n):
        # one that is no number is not regular either
        if not math.fabs(room[k * n + k]) > REGULAR * first:
            return False
    copy_floats(n * c, b, x)
    qr_rotate(n, n, room, scale, True, c, x)
    for step in range(n):
        k = n - 1 - step
        for j in range(c):
            total = x[k * c + j]
            for i in range(k + 1, n):
                total -= room[k * n + i] * x[i * c + j]
            x[k * c + j] = total / room[k * n + k]
    unpermute(n, c, x, column)
    return True


def unpermute(n: int, c: int, x: Floats, column: Ints) -> None:
    """Put the rows of `x` where the columns that they belong to were."""
    for k in range(n):
        # each exchange puts one row where it belongs
        while column[k] != k:
            to = column[k]
            for j in range(c):
                kept = x[k * c + j]
                x[k * c + j] = x[to * c + j]
                x[to * c + j] = kept
            column[k] = column[to]
            column[to] = to
