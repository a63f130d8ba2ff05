"""The point next to the origin where some inequalities hold, or that there is none.

Source: C. L. Lawson, R. J. Hanson, *Solving Least Squares Problems*, SIAM 1995: 23.3 (nonnegative
least squares) and 23.4 (least distance programming).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.svd import Svd, least_squares, make_svd
from hybond.engine.words import Floats, Ints, floats, ints, record

NO_PULL: Final = 1e-12
"""A column of length one that would lower the rest by less than this part does not."""
NOTHING_LEFT: Final = 1e-12
"""A rest of a unit below it says that no point keeps all inequalities, none up to its root."""


@record
class LeastDistance:
    """Room for up to `most` inequalities of up to `wide` unknowns."""

    column: Floats
    chosen: Ints
    u: Floats
    rest: Floats
    block: Floats
    right: Floats
    trial: Floats
    svd: Svd


def make_least_distance(most: int, wide: int) -> LeastDistance:
    """Return room for such problems."""
    r = LeastDistance()
    rows = wide + 1
    r.column = floats(rows * most)
    r.chosen = ints(most)
    r.u = floats(most)
    r.rest = floats(rows)
    r.block = floats(rows * most)
    r.right = floats(rows)
    r.trial = floats(most)
    r.svd = make_svd(max(rows, most), most)
    return r


def nearest_point(r: LeastDistance, n: int, d: int, g: Floats, h: Floats, z: Floats) -> bool:
    """Put the smallest `z`, of d numbers, with ``g z >= h`` there; False if there is none.

    `g` has n rows. What an inequality misses by rounding is for the caller to judge.
    """
    rows = d + 1
    for k in range(n):
        size = math.fabs(h[k])
        for i in range(d):
            size = math.hypot(size, g[k * d + i])
        per = 1.0 / size if size > 0.0 else 0.0
        for i in range(d):
            r.column[k * rows + i] = g[k * d + i] * per
        r.column[k * rows + d] = h[k] * per
        r.chosen[k] = 0
        r.u[k] = 0.0
    nonnegative_squares(r, n, rows)
    if r.rest[d] < NOTHING_LEFT:
        return False
    for i in range(d):
        z[i] = -r.rest[i] / r.rest[d]
    return True


def nonnegative_squares(r: LeastDistance, n: int, rows: int) -> None:
    """Find ``u >= 0`` for which its sum of columns is next to the last unit vector.

    `rest` is what is left of that vector.
    """
    for _ in range(3 * n + 3):
        put_rest(r, n, rows)
        best = -1
        most = NO_PULL
        for k in range(n):
            pull = 0.0
            for i in range(rows):
                pull += r.column[k * rows + i] * r.rest[i]
            if r.chosen[k] == 0 and pull > most:
                most = pull
                best = k
        if best < 0:
            return
        r.chosen[best] = 1
        while not inside(r, n, rows, best):
            if r.chosen[best] == 0:
                return


def put_rest(r: LeastDistance, n: int, rows: int) -> None:
    """Put what is left of the last unit vector there."""
    for i in range(rows):
        r.rest[i] = 1.0 if i == rows - 1 else 0.0
        for k in range(n):
            r.rest[i] -= r.column[k * rows + i] * r.u[k]


def inside(r: LeastDistance, n: int, rows: int, newest: int) -> bool:
    """Solve for the chosen columns; False if one had to go because its `u` came to zero."""
    many = 0
    for k in range(n):
        many += r.chosen[k]
    at = 0
    for k in range(n):
        if r.chosen[k] != 0:
            for i in range(rows):
                r.block[i * many + at] = r.column[k * rows + i]
            at += 1
    for i in range(rows):
        r.right[i] = 1.0 if i == rows - 1 else 0.0
    least_squares(r.svd, rows, many, r.block, -1.0, 1, r.right, r.trial)
    part = 1.0
    at = 0
    for k in range(n):
        if r.chosen[k] != 0:
            if r.trial[at] <= 0.0:
                part = min(part, r.u[k] / (r.u[k] - r.trial[at])) if r.u[k] > 0.0 else 0.0
            at += 1
    at = 0
    whole = True
    for k in range(n):
        if r.chosen[k] != 0:
            shrinks = r.trial[at] <= 0.0
            r.u[k] += part * (r.trial[at] - r.u[k])
            at += 1
            if shrinks and (r.u[k] <= NO_PULL * NO_PULL or k == newest):
                r.u[k] = 0.0
                r.chosen[k] = 0
                whole = False
            elif shrinks:
                whole = False
    return whole
