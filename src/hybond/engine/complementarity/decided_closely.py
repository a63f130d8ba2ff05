"""One-sided laws that a leak tells apart, decided with twice the digits of a number.

What ports give acts at once, by ``D``, and by what is stored, by ``h C E`` over a vanishing step.
Where the step is so short that the second is lost in the rounding of the first, as beside a leak
that takes 1e-9 of a current, a number has no room for ``D + h C E``: currents that ``D`` says
nothing of look like rounding. With the rests of all sums they are decided. That is so only where
``D`` is known to be singular: rows that are the same to the last digit, or clearly not the same.

Source: K. G. Murty, *Note on a Bard-type scheme for solving the complementarity problem*, Opsearch
11 (1974): of the pairs that are violated the first changes.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR
from hybond.engine.algebra.lu_twofold import lu_factor_twofold, lu_solve_twofold
from hybond.engine.algebra.twofold import (
    add_part,
    add_product,
    product_rest,
    sum_rest,
    take_quotient,
)
from hybond.engine.words import Floats, Ints, floats, ints, record

CLEAR: Final = 1e-11
"""Part of a diagonal entry that elimination has to leave of it to be more than its rounding."""
MOST: Final = 24
"""Laws up to which they are decided so, and for which there is room."""
ZERO: Final = 2.0**-80
"""Part of its terms below which a value that is found with twice the digits is zero."""
TURNS: Final = 8
"""So many changes for each law, at the most."""


@record
class Closer:
    """Room for one question with twice the digits: ``w = m l + q`` with their rests.

    `d` is what acts at once. The rest is room to work in.
    """

    n: int
    m: Floats
    m_rest: Floats
    d: Floats
    q: Floats
    q_rest: Floats
    l: Floats
    active: Ints
    zero: Ints
    a: Floats
    a_rest: Floats
    b: Floats
    b_rest: Floats
    w: Floats
    w_rest: Floats
    on: Ints
    row: Ints
    used: Ints


def make_closer(n: int) -> Closer:
    """Return room for n laws."""
    p = Closer()
    p.m = floats(n * n)
    p.m_rest = floats(n * n)
    p.d = floats(n * n)
    p.q = floats(n)
    p.q_rest = floats(n)
    p.l = floats(n)
    p.active = ints(n)
    p.zero = ints(n)
    p.a = floats(n * n)
    p.a_rest = floats(n * n)
    p.b = floats(n)
    p.b_rest = floats(n)
    p.w = floats(n)
    p.w_rest = floats(n)
    p.on = ints(n)
    p.row = ints(n)
    p.used = ints(n)
    return p


def put_entry(p: Closer, at: int, d: float, h: float, ce: float) -> None:
    """Put ``d + h ce`` there with what it was rounded by."""
    stored = h * ce
    total = d + stored
    p.d[at] = d
    p.m[at] = total
    p.m_rest[at] = sum_rest(d, stored, total) + product_rest(h, ce, stored)


def put_known(p: Closer, at: int, y: float, h: float, rate: float) -> None:
    """Put ``y + h rate`` there likewise."""
    moved = h * rate
    total = y + moved
    p.q[at] = total
    p.q_rest[at] = sum_rest(y, moved, total) + product_rest(h, rate, moved)


def decide_closely(p: Closer) -> bool:
    """Find ``0 <= l``, ``w >= 0``, one of them zero, from the pairs in `active`; False if it fails.

    `zero` are then the pairs of which both are.
    """
    n = p.n
    if not is_clearly_singular(p):
        return False
    for _ in range(TURNS * n + TURNS):
        many = 0
        for k in range(n):
            if p.active[k] != 0:
                p.on[many] = k
                many += 1
        if not solve_active(p, many):
            return False
        changed = -1
        for k in range(n - 1, -1, -1):
            if sign_of_pair(p, k) < 0:
                changed = k
        if changed < 0:
            for k in range(n):
                p.zero[k] = 1 if sign_of_pair(p, k) == 0 else 0
            return True
        p.active[changed] = 1 - p.active[changed]
    return False


def is_clearly_singular(p: Closer) -> bool:
    """Whether elimination leaves of each pivot of `d` a clear part, or nothing.

    What is in between is the rounding of `d` itself, which says nothing of its sign.
    """
    n = p.n
    for i in range(n * n):
        p.a[i] = p.d[i]
        p.a_rest[i] = 0.0
    for k in range(n):
        p.used[k] = 0
    for _ in range(n):
        best = -1
        most = 0.0
        for k in range(n):
            # by what is left of each: a leak is small beside what it is next to
            own = math.fabs(p.d[k * n + k])
            part = math.fabs(p.a[k * n + k]) / own if p.used[k] == 0 and own > 0.0 else 0.0
            if part > most:
                most = part
                best = k
        if best < 0:
            break
        if most < CLEAR:
            return False
        p.used[best] = 1
        for i in range(n):
            at = i * n + best
            if p.used[i] != 0 or p.a[at] == 0.0:
                continue
            take_quotient(p.a, p.a_rest, at, p.a, p.a_rest, best * n + best)
            for j in range(n):
                if p.used[j] == 0 and p.a[best * n + j] != 0.0:
                    less = -p.a[at]
                    add_product(p.a, p.a_rest, i * n + j, less, -p.a_rest[at], best * n + j)
    for i in range(n):
        for j in range(n):
            if p.used[i] == 0 and p.used[j] == 0 and p.a[i * n + j] != 0.0:
                return False
    return True


def solve_active(p: Closer, many: int) -> bool:
    """Put in the `l` of the active pairs that make their `w` zero, and find the other `w`."""
    n = p.n
    for i in range(many):
        one = p.on[i]
        p.b[i] = -p.q[one]
        p.b_rest[i] = -p.q_rest[one]
        for j in range(many):
            p.a[i * many + j] = p.m[one * n + p.on[j]]
            p.a_rest[i * many + j] = p.m_rest[one * n + p.on[j]]
    if many > 0:
        if lu_factor_twofold(many, p.a, p.a_rest, p.row) == SINGULAR:
            return False
        lu_solve_twofold(many, p.a, p.a_rest, p.row, p.b, p.b_rest)
    for k in range(n):
        p.l[k] = 0.0
        p.w[k] = p.q[k]
        p.w_rest[k] = p.q_rest[k]
    for i in range(many):
        p.l[p.on[i]] = p.b[i]
        if not math.isfinite(p.b[i]):
            return False
    for k in range(n):
        size = math.fabs(p.q[k])
        for i in range(many):
            at = k * n + p.on[i]
            add_part(p.w, p.w_rest, k, p.m[at], p.b[i], p.b_rest[i])
            add_part(p.w, p.w_rest, k, p.m_rest[at], p.b[i], 0.0)
            size += math.fabs(p.m[at] * p.b[i])
        if p.active[k] != 0 or math.fabs(p.w[k]) <= ZERO * size:
            p.w[k] = 0.0
    return True


def sign_of_pair(p: Closer, k: int) -> int:
    """Return the sign of what may not be below zero: `l` of an active pair, `w` of another."""
    value = p.l[k] if p.active[k] != 0 else p.w[k]
    return 1 if value > 0.0 else -1 if value < 0.0 else 0
