"""Where a polynomial of degree four is zero, and where it turns, between 0 and 1.

Between two neighbouring places at which its derivative is zero it is monotone, and has one root at
the most. So derivatives are solved first, from the one that is a line on.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.words import Floats, floats, record

DEGREE: Final = 4
COEFFICIENTS: Final = 5
ROUNDS: Final = 60


@record
class Quartic:
    """A polynomial and its derivatives, a row each; where it is zero, and where it turns."""

    row: Floats
    """Row k has the coefficients of ``x^0 ... x^(4 - k)`` of derivative k."""
    roots: int
    root: Floats
    turns: int
    turn: Floats


def make_quartic() -> Quartic:
    """Return room for a polynomial."""
    q = Quartic()
    q.row = floats(COEFFICIENTS * COEFFICIENTS)
    q.root = floats(COEFFICIENTS)
    q.turn = floats(COEFFICIENTS)
    return q


def horner(c: Floats, at: int, degree: int, x: float) -> float:
    """Return the polynomial whose coefficients stand from `at` on."""
    if degree == DEGREE:
        total = c[at + 4]
        total = total * x + c[at + 3]
        total = total * x + c[at + 2]
        total = total * x + c[at + 1]
        return total * x + c[at]
    if degree == DEGREE - 1:
        total = c[at + 3]
        total = total * x + c[at + 2]
        total = total * x + c[at + 1]
        return total * x + c[at]
    total = c[at + degree]
    for j in range(degree):
        total = total * x + c[at + degree - 1 - j]
    return total


def solve_quartic(q: Quartic, c: Floats, at: int) -> None:
    """Find the roots and turns of the polynomial whose coefficients stand from `at` on, in order.

    A root is where the sign changes.
    """
    last = DEGREE - 1 if bends(c, at) else 1
    copy_part(COEFFICIENTS, c, at, q.row, 0)
    for k in range(last + 1):
        for j in range(DEGREE - k):
            q.row[COEFFICIENTS * (k + 1) + j] = float(j + 1) * q.row[COEFFICIENTS * k + j + 1]
    q.roots = 0
    q.turns = 0
    for k in range(last, -1, -1):
        swapped = q.turn
        q.turn = q.root
        q.turns = q.roots
        q.root = swapped
        find_roots(q, k)


def bends(c: Floats, at: int) -> bool:
    """Whether the polynomial may bend both ways: else it turns once at the most, as a parabola.

    The coefficients of its second derivative in Bernstein's basis are of one sign then.
    """
    d0 = c[at + 2]
    d1 = d0 + 1.5 * c[at + 3]
    d2 = d0 + 3.0 * c[at + 3] + 6.0 * c[at + 4]
    up = d0 > 0.0 and d1 > 0.0 and d2 > 0.0
    down = d0 < 0.0 and d1 < 0.0 and d2 < 0.0
    return not up and not down


def turns(c: Floats, at: int) -> bool:
    """Whether the polynomial may turn: else the coefficients of its slope are of one sign.

    Those in Bernstein's basis, in whose hull it is.
    """
    d0 = c[at + 1]
    d1 = d0 + 2.0 / 3.0 * c[at + 2]
    d2 = d0 + 4.0 / 3.0 * c[at + 2] + c[at + 3]
    d3 = d0 + 2.0 * c[at + 2] + 3.0 * c[at + 3] + 4.0 * c[at + 4]
    up = d0 > 0.0 and d1 > 0.0 and d2 > 0.0 and d3 > 0.0
    down = d0 < 0.0 and d1 < 0.0 and d2 < 0.0 and d3 < 0.0
    return not up and not down


def solve_monotone(q: Quartic, c: Floats, at: int) -> None:
    """Find the root of such a polynomial that does not turn."""
    copy_part(COEFFICIENTS, c, at, q.row, 0)
    for j in range(DEGREE):
        q.row[COEFFICIENTS + j] = float(j + 1) * c[at + j + 1]
    q.turns = 0
    find_roots(q, 0)


def find_roots(q: Quartic, k: int) -> None:
    """Find the roots of derivative k, from those of the next one, which are in `turn`."""
    q.roots = 0
    low = 0.0
    before = horner(q.row, COEFFICIENTS * k, DEGREE - k, low)
    for i in range(q.turns + 1):
        high = q.turn[i] if i < q.turns else 1.0
        after = horner(q.row, COEFFICIENTS * k, DEGREE - k, high)
        if (before < 0.0 and after > 0.0) or (before > 0.0 and after < 0.0):
            q.root[q.roots] = between_signs(q, k, low, before, high, after)
            q.roots += 1
        low = high
        # on a root that is a turn as well the sign is that from before it
        before = after if after != 0.0 else before


def between_signs(
    q: Quartic, k: int, low: float, before: float, high: float, after: float
) -> float:
    """Return where derivative k changes its sign, to the last place: Newton within a bracket."""
    first = COEFFICIENTS * k
    degree = DEGREE - k
    a = low
    at_a = before
    b = high
    at_b = after
    x = low - before * (high - low) / (after - before)
    for _ in range(ROUNDS):
        if not (x > a and x < b):
            x = 0.5 * (a + b)
        here = horner(q.row, first, degree, x)
        if (here < 0.0) == (before < 0.0) and here != 0.0:
            a = x
            at_a = here
        else:
            b = x
            at_b = here
        slope = horner(q.row, first + COEFFICIENTS, degree - 1, x)
        there = x - here / slope if slope != 0.0 else 0.5 * (a + b)
        if there == x or 0.5 * (a + b) == a or 0.5 * (a + b) == b:
            break
        x = there
    return a if math.fabs(at_a) < math.fabs(at_b) else b
