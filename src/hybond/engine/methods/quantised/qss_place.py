"""Where a linearly implicit quantised state is put: ahead of the state, or on its equilibrium.

Source: G. Migoni, M. Bortolotto, E. Kofman, F. E. Cellier, "Linearly implicit quantization-based
integration methods for stiff ordinary differential equations", Simul. Model. Pract. Theory 35,
2013. The condition of touching is the one of order n written as one formula.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.words import Floats, float_table

WEAK: Final = 0.1
"""Own feedback times duration below which a state is quantised as if it had none."""
FACTORIAL: Final = float_table(1.0, 1.0, 2.0, 6.0)
SIGN: Final = float_table(1.0, -1.0, 1.0, -1.0)
TURNS: Final = 80


def place_ahead(
    x: float, n: int, u: Floats, a: float, quantum: float, ahead: Floats, q: Floats
) -> float:
    """Put a quantised state of n coefficients there; return for how long it serves.

    Of ``x' = a q + u`` with ``a < 0``: the polynomial `q` that `x` will touch with all but its
    last derivative, ``x - q = c (s - h)^n``, at the largest ``h`` for which it begins no further
    than half a quantum from `x`. If that is so for every h, `q` is where x stops changing its
    n-th derivative, and serves until something else changes: a fast state rests on its
    equilibrium instead of chattering about it. With own feedback that is weak over h, or none or
    unstable, `q` is the ordinary one of QSS, `x` itself.
    """
    for k in range(n):
        ahead[k] = 0.0
    alpha = follow_difference(x, n, u, a, ahead, q)
    if alpha == 0.0:
        return math.inf
    plain = math.pow(quantum / math.fabs(alpha), 1.0 / float(n))
    if not a * plain < -WEAK:
        return math.inf
    band = 0.5 * quantum
    last = alpha * FACTORIAL[n] * SIGN[n]
    for _ in range(n):
        last /= math.fabs(a)
    if math.fabs(last) <= band:
        ahead[0] = last
        follow_difference(x, n, u, a, ahead, q)
        return math.inf
    h = duration_ahead(math.fabs(alpha) / band, -a, n)
    total = 0.0
    power = 1.0
    for k in range(n + 1):
        total += power / FACTORIAL[k]
        power *= -a * h
    power = alpha / total
    for k in range(n - 1, -1, -1):
        power *= -h
        ahead[k] = power * FACTORIAL[n] / (FACTORIAL[k] * FACTORIAL[n - k])
    follow_difference(x, n, u, a, ahead, q)
    return h


def follow_difference(x: float, n: int, u: Floats, a: float, ahead: Floats, q: Floats) -> float:
    """Put `q` there with ``x - q`` beginning with what is given; return the last of x."""
    c = x
    for k in range(n):
        q[k] = c - ahead[k]
        c = (a * q[k] + u[k]) / (float(k) + 1.0)
    return c


def duration_ahead(ratio: float, rate: float, n: int) -> float:
    """Return the h with ``ratio h^n = sum (rate h)^k / k!``, k to n (Newton in 1/h).

    As a polynomial of 1/h it is convex and rising, and the start is to the right of its root.
    """
    v = math.pow(ratio, 1.0 / float(n))
    for _ in range(TURNS):
        value = 0.0
        slope = 0.0
        power = 1.0
        for k in range(n + 1):
            slope = slope * v + value
            value = value * v + power / FACTORIAL[k]
            power *= rate
        change = (value - ratio) / slope
        v -= change
        if change <= 1e-14 * v:
            break
    return 1.0 / v
