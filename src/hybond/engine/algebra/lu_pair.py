"""Complex linear systems: factors with partial pivoting, real and imaginary parts apart.

As numpy.linalg.solve for complex numbers. Matrices are arrays row after row.
"""

import math

from hybond.engine.algebra.lu import REGULAR, SINGULAR
from hybond.engine.words import Floats, Ints, record


@record
class Complex:
    """A complex number."""

    re: float
    im: float


def set_reciprocal(z: Complex, re: float, im: float) -> None:
    """Put ``1 / (re + i im)`` into `z`."""
    if math.fabs(re) >= math.fabs(im):
        r = im / re
        d = re + im * r
        z.re = 1.0 / d
        z.im = -r / d
    else:
        r = re / im
        d = re * r + im
        z.re = r / d
        z.im = -1.0 / d


def lu_factor_pair(n: int, re: Floats, im: Floats, row: Ints, z: Complex) -> int:
    """Put the factors of ``re + i im`` in its place; SINGULAR if a pivot is zero."""
    for k in range(n):
        p = k
        most = math.fabs(re[k * n + k]) + math.fabs(im[k * n + k])
        for i in range(k + 1, n):
            size = math.fabs(re[i * n + k]) + math.fabs(im[i * n + k])
            if size > most:
                most = size
                p = i
        row[k] = p
        if most == 0.0 or not math.isfinite(most):
            return SINGULAR
        if p != k:
            for j in range(n):
                kept = re[k * n + j]
                re[k * n + j] = re[p * n + j]
                re[p * n + j] = kept
                kept = im[k * n + j]
                im[k * n + j] = im[p * n + j]
                im[p * n + j] = kept
        set_reciprocal(z, re[k * n + k], im[k * n + k])
        for i in range(k + 1, n):
            a = re[i * n + k]
            b = im[i * n + k]
            c = a * z.re - b * z.im
            d = a * z.im + b * z.re
            re[i * n + k] = c
            im[i * n + k] = d
            if c != 0.0 or d != 0.0:
                for j in range(k + 1, n):
                    re[i * n + j] -= c * re[k * n + j] - d * im[k * n + j]
                    im[i * n + j] -= c * im[k * n + j] + d * re[k * n + j]
    return REGULAR


def lu_solve_pair(
    n: int, re: Floats, im: Floats, row: Ints, z: Complex, x: Floats, y: Floats
) -> None:
    """Solve for the right-hand side ``x + i y`` in its place; factors from lu_factor_pair."""
    for k in range(n):
        p = row[k]
        if p != k:
            kept = x[k]
            x[k] = x[p]
            x[p] = kept
            kept = y[k]
            y[k] = y[p]
            y[p] = kept
    for i in range(n):
        for k in range(i):
            a = re[i * n + k]
            b = im[i * n + k]
            x[i] -= a * x[k] - b * y[k]
            y[i] -= a * y[k] + b * x[k]
    for back in range(n):
        i = n - 1 - back
        for k in range(i + 1, n):
            a = re[i * n + k]
            b = im[i * n + k]
            x[i] -= a * x[k] - b * y[k]
            y[i] -= a * y[k] + b * x[k]
        set_reciprocal(z, re[i * n + i], im[i * n + i])
        a = x[i]
        b = y[i]
        x[i] = a * z.re - b * z.im
        y[i] = a * z.im + b * z.re
