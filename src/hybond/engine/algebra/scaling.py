"""Scaling of matrices by powers of two, so that their largest entries are near one.

Source: D. Ruiz, *A scaling algorithm to equilibrate both rows and columns norms in matrices*,
RAL-TR-2001-034, 2001.
"""

import math
from typing import Final

from hybond.engine.words import Floats

SWEEPS_OF_SCALING: Final = 40


def power_of_two(d: float) -> float:
    """Return the power of two that is next to `d` on a logarithmic scale."""
    p = 1.0
    while d * p * (d * p) >= 2.0:
        p *= 0.5
    while d * p * (d * p) < 0.5:
        p *= 2.0
    return 1.0 / p


def balance(n: int, m: Floats, d: Floats, down: Floats) -> None:
    """Put ``d > 0`` there such that rows and columns of ``d_i m_ij d_j`` are near one.

    Symmetric, so that `m` stays semidefinite.
    """
    for j in range(n):
        d[j] = 1.0
    for _ in range(SWEEPS_OF_SCALING):
        most = 0.0
        least = math.inf
        for j in range(n):
            down[j] = 0.0
            for i in range(n):
                size = max(math.fabs(m[i * n + j]), math.fabs(m[j * n + i]))
                if size != 0.0:
                    down[j] = max(down[j], size * d[i] * d[j])
            if down[j] == 0.0:
                down[j] = 1.0
            most = max(most, down[j])
            least = min(least, down[j])
        for j in range(n):
            d[j] /= math.sqrt(down[j])
        if most < 1.5 and least > 0.67:
            break
    for j in range(n):
        d[j] = power_of_two(d[j])


def balance_sides(
    m: int, n: int, w: Floats, rows: Floats, columns: Floats, across: Floats, down: Floats
) -> None:
    """Put factors there such that rows and columns of ``r_i w_ij c_j`` are near one."""
    for i in range(m):
        rows[i] = 1.0
    for j in range(n):
        columns[j] = 1.0
    if m * n == 0:
        return
    for _ in range(SWEEPS_OF_SCALING):
        for i in range(m):
            across[i] = 0.0
        for j in range(n):
            down[j] = 0.0
        for i in range(m):
            for j in range(n):
                if w[i * n + j] == 0.0:
                    continue
                now = math.fabs(w[i * n + j]) * rows[i] * columns[j]
                across[i] = max(across[i], now)
                down[j] = max(down[j], now)
        most = 0.0
        least = math.inf
        for i in range(m):
            if across[i] == 0.0:
                across[i] = 1.0
            most = max(most, across[i])
            least = min(least, across[i])
            rows[i] /= math.sqrt(across[i])
        for j in range(n):
            if down[j] == 0.0:
                down[j] = 1.0
            most = max(most, down[j])
            least = min(least, down[j])
            columns[j] /= math.sqrt(down[j])
        if most < 1.5 and least > 0.67:
            break
    for i in range(m):
        rows[i] = power_of_two(rows[i])
    for j in range(n):
        columns[j] = power_of_two(columns[j])
