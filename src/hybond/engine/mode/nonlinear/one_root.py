"""Whether laws that hang together have one solution, told by the signs of their slopes alone.

The determinant of their slopes by the unknowns is a sum of products of slopes, one of each law at
the most. Where each slope has a sign that it keeps whatever is read, and all of these products have
one sign, so has the determinant: no solution can turn into another. So it is of amplifiers with
diodes and resistors about them that feed back against themselves.

Source: I. W. Sandberg, A. N. Willson, *Some theorems on properties of DC equations of nonlinear
networks*, Bell System Technical Journal 48, 1969, theorem 3 (matrices of the class P0).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor
from hybond.engine.answers import value
from hybond.engine.engine import NOT_ASKED, Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Floats

HANGS: Final = 2
"""In the tables: no sign is told of a slope, and it hangs on more than its law's own variable."""
MOST: Final = 6
"""Laws that hang together of which it is told, ..."""
PRODUCTS: Final = 1024
"""... and products of their slopes that are looked at."""
CANCELS: Final = 1e-12
"""Part of its terms below which a product is none."""
SMALLEST: Final = -9
LARGEST: Final = 6
PER_DECADE: Final = 32
"""Powers of ten between which what laws read is tried, and how many numbers in each."""


def has_one_root(e: Engine, mode: Mode, begin: int, end: int, v: Floats) -> bool:
    """Whether all products of slopes of the laws `begin` to `end` of groups have one sign.

    `v` holds values that may be written over.
    """
    b = e.work.following
    n = end - begin
    if n > MOST or not put_parts(e, mode, begin, n, v):
        return False
    many = 1
    fit_places(b.chosen, n)
    for i in range(n):
        b.chosen.at[i] = 0
        many *= b.part_from.at[i + 1] - b.part_from.at[i]
        if many > PRODUCTS:
            return False
    above = False
    below = False
    for _ in range(many):
        sign = sign_of_product(e, n)
        above = above or sign > 0.0
        below = below or sign < 0.0
        take_next(e, n)
    return not (above and below)


def put_parts(e: Engine, mode: Mode, begin: int, n: int, v: Floats) -> bool:
    """Put what each law's row is a sum of into ``parts``: what is constant, and each slope.

    False if there is a slope of which no sign is known.
    """
    m = e.model
    b = e.work.following
    a = mode.apart
    room = 0
    for i in range(n):
        d = mode.dynamic[a.row.at[begin + i]]
        room += 1 + m.slope_first[d + 1] - m.slope_first[d]
    fit(b.parts, room * n)
    fit_places(b.part_from, n + 1)
    at = 0
    for i in range(n):
        d = mode.dynamic[a.row.at[begin + i]]
        constant = at
        b.part_from.at[i] = at
        at += 1
        for j in range(n):
            b.parts.at[constant * n + j] = 0.0
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            first = m.slope_column[p] * mode.finite_frees
            reaches = False
            for j in range(n):
                reaches = reaches or mode.finite_free.at[first + a.unknown.at[begin + j]] != 0.0
            if not reaches:
                continue
            if m.slope_value[p] < 0:
                for j in range(n):
                    share = mode.finite_free.at[first + a.unknown.at[begin + j]]
                    b.parts.at[constant * n + j] += m.slope_constant[p] * share
                continue
            sign = sign_of_slope(e, mode, d, p, v)
            if sign == 0.0:
                return False
            for j in range(n):
                share = mode.finite_free.at[first + a.unknown.at[begin + j]]
                b.parts.at[at * n + j] = sign * share
            at += 1
    b.part_from.at[n] = at
    return True


def sign_of_slope(e: Engine, mode: Mode, d: int, p: int, v: Floats) -> float:
    """Return the sign that a slope of law d keeps whatever is read; 0 if none is known.

    That of a law of one bond is told at numbers of all sizes, once where it reads nothing else.
    """
    m = e.model
    if m.slope_sign[p] == 1 or m.slope_sign[p] == -1:
        return float(m.slope_sign[p])
    if m.slope_column[p] != m.dynamic_partner[d]:
        return 0.0
    if m.slope_sign[p] != HANGS and e.slope_known[p] != NOT_ASKED:
        return float(e.slope_known[p])
    sign = sign_by_sizes(e, mode, d, -1, v)
    sign *= m.dynamic_way[d]
    if m.slope_sign[p] != HANGS:
        e.slope_known[p] = int(sign)
    return sign


def sign_by_sizes(e: Engine, mode: Mode, d: int, j: int, v: Floats) -> float:
    """Return the sign that a slope has where what its law reads is a number of any size; 0: both.

    By unknown j; if -1, as a resistance beside the law: a law that only resists is below zero.
    """
    m = e.model
    k = m.bond_slot + m.dynamic_partner[d]
    kept = v[k]
    above = False
    below = False
    for side in range(2):
        for n in range((LARGEST - SMALLEST) * PER_DECADE + 1):
            size = math.pow(10.0, float(SMALLEST) + float(n) / float(PER_DECADE))
            v[k] = size if side == 0 else -size
            slope = slope_of(e, mode, d, j, v)
            if math.isfinite(slope):
                above = above or slope > 0.0
                below = below or slope < 0.0
    v[k] = kept
    if above and below:
        return 0.0
    return 1.0 if above else -1.0


def slope_of(e: Engine, mode: Mode, d: int, j: int, v: Floats) -> float:
    """Return the slope of a law by unknown j; if -1, by what it reads, below zero if it resists."""
    m = e.model
    total = 0.0
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        law = m.slope_value[p]
        k = m.slope_column[p]
        if j < 0 and k != m.dynamic_partner[d]:
            continue
        slope = m.slope_constant[p] if law < 0 else value(m, law, v)
        share = m.dynamic_way[d] if j < 0 else mode.finite_free.at[k * mode.finite_frees + j]
        total += slope * share if share != 0.0 else 0.0
    return total


def sign_of_product(e: Engine, n: int) -> float:
    """Return the sign of the determinant of the parts chosen; 0 if it is none but for rounding."""
    b = e.work.following
    fit(b.product, n * n)
    fit_places(b.pivot, n)
    most = 1.0
    for i in range(n):
        row = b.part_from.at[i] + b.chosen.at[i]
        largest = 0.0
        for j in range(n):
            b.product.at[i * n + j] = b.parts.at[row * n + j]
            largest = max(largest, math.fabs(b.parts.at[row * n + j]))
        most *= largest
    if most == 0.0 or lu_factor(n, b.product.at, b.pivot.at) == SINGULAR:
        return 0.0
    total = 1.0
    for k in range(n):
        total *= b.product.at[k * n + k]
        if b.pivot.at[k] != k:
            total = -total
    if not math.fabs(total) > CANCELS * most:
        return 0.0
    return 1.0 if total > 0.0 else -1.0


def take_next(e: Engine, n: int) -> None:
    """Choose other parts of rows: the next one in the order of numbers of many digits."""
    b = e.work.following
    for i in range(n):
        b.chosen.at[i] += 1
        if b.chosen.at[i] < b.part_from.at[i + 1] - b.part_from.at[i]:
            return
        b.chosen.at[i] = 0
