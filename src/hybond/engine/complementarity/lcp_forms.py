"""Complementarity with both unknowns of each pair on equal terms, and unknowns without sign.

``A a + B b + C c = q`` with ``a, b >= 0`` and ``a_k b_k = 0`` for each pair k.

Source: R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press
1992: 1.5 (mixed, horizontal and other forms).
"""

import math
from typing import Final

from hybond.engine.algebra.lu import REGULAR, SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.algebra.scaling import balance_sides
from hybond.engine.complementarity.choice import Choice, complementary_basis, make_choice
from hybond.engine.complementarity.lcp import NO_CHOICE, SOLVED, Lcp, make_lcp
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.words import Floats, Ints, floats, ints, record

NO_COEFFICIENT: Final = 1e-14
"""What elimination leaves of a zero, coefficients being scaled to about one."""
FAR: Final = 1e4
"""Scaled entries beyond it say that the guessed choice is too near a singular one to reduce by."""


@record
class Mixed:
    """Room for problems of up to `pairs` pairs and `free` unknowns without sign, and the answer.

    `whole` holds the coefficients A, B, C side by side, ``pairs + free`` rows of them for a problem
    of that size, and `right` the right-hand side; both are lost in solving. The answer is `a`, `b`,
    `c`, which a are not zero in `active`, and which pairs are zero on both sides in `open`.
    """

    whole: Floats
    right: Floats
    a: Floats
    b: Floats
    c: Floats
    active: Ints
    open: Ints
    rows: Floats
    columns: Floats
    across: Floats
    down: Floats
    is_a: Ints
    begin: Ints
    kept: Floats
    reduced: Floats
    pivot: Ints
    inner: Floats
    constant: Floats
    lcp: Lcp
    choice: Choice


def make_mixed(pairs: int, free: int) -> Mixed:
    """Return room for problems of up to these sizes."""
    rows = pairs + free
    wide = 2 * pairs + free
    x = Mixed()
    x.whole = floats(rows * wide)
    x.right = floats(rows)
    x.a = floats(pairs)
    x.b = floats(pairs)
    x.c = floats(free)
    x.active = ints(pairs)
    x.open = ints(pairs)
    x.rows = floats(rows)
    x.columns = floats(wide)
    x.across = floats(rows)
    x.down = floats(wide)
    x.is_a = ints(pairs)
    x.begin = ints(pairs)
    x.kept = floats(rows * rows)
    x.reduced = floats(rows * (pairs + 1))
    x.pivot = ints(rows)
    x.inner = floats(pairs * pairs)
    x.constant = floats(pairs)
    x.lcp = make_lcp(pairs)
    x.choice = make_choice(rows, wide)
    return x


def solve_mixed(x: Mixed, n: int, m: int, start: Ints, guessed: bool) -> int:
    """Solve for n pairs and m free unknowns; `start` says which a are not zero, if `guessed`.

    One unknown of each pair is chosen such that these and the free ones can be solved for; what is
    left is a standard problem.
    """
    rows = n + m
    wide = 2 * n + m
    balance_sides(rows, wide, x.whole, x.rows, x.columns, x.across, x.down)
    for i in range(rows):
        for j in range(wide):
            x.whole[i * wide + j] = x.whole[i * wide + j] * x.rows[i] * x.columns[j]
        x.right[i] = x.rows[i] * x.right[i]
    reduced = SINGULAR
    if guessed:
        copy_places(n, start, 0, x.is_a, 0)
        reduced = reduce_mixed(x, n, m)
        if reduced == REGULAR and furthest(x, n, m) > FAR:
            reduced = SINGULAR
    if reduced == SINGULAR:
        if not complementary_basis(x.choice, rows, wide, n, x.whole):
            return NO_CHOICE
        for k in range(n):
            x.is_a[k] = 0
        for i in range(rows):
            if x.choice.owner[i] < n:
                x.is_a[x.choice.owner[i]] = 1
        if reduce_mixed(x, n, m) == SINGULAR:
            return NO_CHOICE
    for i in range(n):
        for j in range(n):
            inner = -x.reduced[i * (n + 1) + 1 + j]
            # else a pair that nothing couples gets a unit from rounding
            x.inner[i * n + j] = 0.0 if math.fabs(inner) < NO_COEFFICIENT else inner
        x.constant[i] = x.reduced[i * (n + 1)]
        x.begin[i] = start[i] ^ x.is_a[i] if guessed else 0
    status = lemke(x.lcp, n, x.inner, x.constant, x.begin)
    if status != SOLVED:
        return status
    for k in range(n):
        chosen = x.is_a[k] != 0
        x.a[k] = x.columns[k] * (x.lcp.w[k] if chosen else x.lcp.z[k])
        x.b[k] = x.columns[n + k] * (x.lcp.z[k] if chosen else x.lcp.w[k])
        x.active[k] = x.lcp.active[k] ^ x.is_a[k]
        x.open[k] = x.lcp.open[k]
    for i in range(m):
        total = 0.0
        for j in range(n):
            total += x.reduced[(n + i) * (n + 1) + 1 + j] * x.lcp.z[j]
        x.c[i] = x.columns[2 * n + i] * (x.reduced[(n + i) * (n + 1)] - total)
    return SOLVED


def furthest(x: Mixed, n: int, m: int) -> float:
    """Return the largest coefficient of what is left, a constant aside."""
    most = 0.0
    for i in range(n + m):
        for j in range(n):
            size = math.fabs(x.reduced[i * (n + 1) + 1 + j])
            if not size <= most:
                most = size
    return most


def reduce_mixed(x: Mixed, n: int, m: int) -> int:
    """Solve for one unknown of each pair (a where x.is_a) and the free ones.

    Column 0 is the constant, the others what each unknown of the other kind takes from it.
    """
    rows = n + m
    wide = 2 * n + m
    for i in range(rows):
        x.reduced[i * (n + 1)] = x.right[i]
        for k in range(n):
            own = k if x.is_a[k] != 0 else n + k
            other = n + k if x.is_a[k] != 0 else k
            x.kept[i * rows + k] = x.whole[i * wide + own]
            x.reduced[i * (n + 1) + 1 + k] = x.whole[i * wide + other]
        copy_part(m, x.whole, i * wide + 2 * n, x.kept, i * rows + n)
    if lu_factor(rows, x.kept, x.pivot) == SINGULAR:
        return SINGULAR
    lu_solve(rows, x.kept, x.pivot, n + 1, x.reduced)
    return REGULAR
