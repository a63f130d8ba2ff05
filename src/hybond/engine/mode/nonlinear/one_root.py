"""Whether laws that hang together have one solution, told by the signs of their slopes alone.

The determinant of their slopes by the unknowns is a sum of products of slopes, one of each law at
the most. Where each slope has a sign that it keeps whatever is read, and all of these products have
one sign, so has the determinant: no solution can turn into another. So it is of amplifiers with
diodes and resistors about them that feed back against themselves. Slopes of one law that are
multiples of each other, as of a limited gain that reads a difference, are one slope.

What lies between two solutions proves it: the mean slopes on the straight way from one to the other
have these signs, too, and multiples of each other are the same ones. So their determinant is zero
only where laws are flat all the way.

Source: I. W. Sandberg, A. N. Willson, *Some theorems on properties of DC equations of nonlinear
networks*, Bell System Technical Journal 48, 1969, theorem 3 (matrices of the class P0).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.answers import value
from hybond.engine.engine import NOT_ASKED, Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Floats

HANGS: Final = 2
"""In the tables: no sign is told of a slope, and it hangs on more than its law's own variable."""
MOST: Final = 8
"""Laws that hang together of which it is told, ..."""
TERMS: Final = 524288
"""... and terms of the products of their slopes that are summed."""
CANCELS: Final = 1e-12
"""Part of its terms above which a sum is known to have its sign, ..."""
ROUNDED: Final = 1e-14
"""... and below which it is zero; between them nothing is told."""
UNTOLD: Final = 2.0
SMALLEST: Final = -9
LARGEST: Final = 6
PER_DECADE: Final = 32
"""Powers of ten between which what laws read is tried, and how many numbers in each."""


def has_one_root(e: Engine, mode: Mode, begin: int, end: int, v: Floats) -> bool:
    """Whether all products of slopes of the laws `begin` to `end` of groups have one sign.

    `v` holds values that may be written over. Of a slope ``1 - s`` the sign may be known as it is,
    and with other multiples of s only for what they are together: both are asked.
    """
    if end - begin > MOST:
        return False
    if put_parts(e, mode, begin, end - begin, True, v) and have_one_sign(e, end - begin):
        return True
    return put_parts(e, mode, begin, end - begin, False, v) and have_one_sign(e, end - begin)


def have_one_sign(e: Engine, n: int) -> bool:
    """Whether all determinants of one part of each of `n` rows have one sign."""
    b = e.work.following
    many = 1
    terms = n
    for _ in range(n):
        terms *= 2
    fit_places(b.chosen, n)
    for i in range(n):
        b.chosen.at[i] = 0
        many *= b.part_from.at[i + 1] - b.part_from.at[i]
        if many * terms > TERMS:
            return False
    above = False
    below = False
    for _ in range(many):
        sign = sign_of_product(e, n)
        if sign == UNTOLD:
            return False
        above = above or sign > 0.0
        below = below or sign < 0.0
        take_next(e, n)
    return not (above and below)


def put_parts(e: Engine, mode: Mode, begin: int, n: int, together: bool, v: Floats) -> bool:
    """Put what each law's row is a sum of into ``parts``: what is constant, and each slope.

    Those that are multiples of each other are one if `together`. False if there is a slope of which
    no sign is known.
    """
    m = e.model
    b = e.work.following
    a = mode.apart
    room = 0
    for i in range(n):
        d = mode.dynamic[a.row.at[begin + i]]
        room += 1 + m.slope_first[d + 1] - m.slope_first[d]
    fit(b.parts, (room + 1) * n)
    fit(b.row_size, n)
    fit_places(b.part_from, n + 1)
    at = 0
    for i in range(n):
        d = mode.dynamic[a.row.at[begin + i]]
        constant = at
        b.part_from.at[i] = at
        at += 1
        for j in range(n):
            b.parts.at[constant * n + j] = 0.0
            b.row_size.at[j] = 0.0
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            if m.slope_value[p] < 0:
                add_part(e, mode, begin, n, p, m.slope_constant[p], constant)
            elif together:
                add_part(e, mode, begin, n, p, m.slope_beside[p], constant)
        if not is_told(e, n, constant):
            return False
        for p in range(m.slope_first[d], m.slope_first[d + 1]):
            if m.slope_value[p] < 0 or (together and m.slope_like[p] != p):
                continue
            for j in range(n):
                b.parts.at[at * n + j] = 0.0
                b.row_size.at[j] = 0.0
            if not together:
                add_part(e, mode, begin, n, p, 1.0, at)
            for q in range(p, m.slope_first[d + 1] if together else p):
                if m.slope_like[q] == p:
                    add_part(e, mode, begin, n, q, m.slope_times[q], at)
            if not is_told(e, n, at):
                return False
            if is_nothing(e, n, at):
                continue
            if together:
                sign = sign_of_multiple(e, mode, d, p, v)
            else:
                sign = sign_of_slope(e, mode, d, p, v)
            if sign == 0.0:
                return False
            for j in range(n):
                b.parts.at[at * n + j] *= sign
            at += 1
    b.part_from.at[n] = at
    return True


def add_part(e: Engine, mode: Mode, begin: int, n: int, p: int, factor: float, at: int) -> None:
    """Add what slope p gives by each unknown to part `at`, a factor being all that it is."""
    b = e.work.following
    first = e.model.slope_column[p] * mode.finite_frees
    for j in range(n):
        share = factor * mode.finite_free.at[first + mode.apart.unknown.at[begin + j]]
        b.parts.at[at * n + j] += share
        b.row_size.at[j] += math.fabs(share)


def is_told(e: Engine, n: int, at: int) -> bool:
    """Whether part `at` is known for what it is, by its terms; what is their rounding is zero."""
    b = e.work.following
    for j in range(n):
        part = math.fabs(b.parts.at[at * n + j])
        if part <= ROUNDED * b.row_size.at[j]:
            b.parts.at[at * n + j] = 0.0
        elif not part > CANCELS * b.row_size.at[j]:
            return False
    return True


def is_nothing(e: Engine, n: int, at: int) -> bool:
    """Whether part `at` is zero by all unknowns."""
    for j in range(n):
        if e.work.following.parts.at[at * n + j] != 0.0:
            return False
    return True


def sign_of_multiple(e: Engine, mode: Mode, d: int, p: int, v: Floats) -> float:
    """Return the sign of what slope p of law d is a multiple of, as its multiples tell; 0: none."""
    m = e.model
    if m.slope_like_sign[p] != 0:
        return float(m.slope_like_sign[p])
    for q in range(p, m.slope_first[d + 1]):
        if m.slope_like[q] == p and m.slope_beside[q] == 0.0:
            sign = sign_of_slope(e, mode, d, q, v)
            if sign != 0.0:
                return sign if m.slope_times[q] > 0.0 else -sign
    return 0.0


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
    """Return the sign of the determinant of the parts chosen; 0 if it is none but for rounding.

    UNTOLD where it may be. It is summed over sets of unknowns, row after row, and so are the sizes
    of its terms: these tell what is rounding, whatever units unknowns are in.
    """
    b = e.work.following
    sets = 1
    for _ in range(n):
        sets *= 2
    fit(b.product, 2 * sets)
    for k in range(1, 2 * sets):
        b.product.at[k] = 0.0
    b.product.at[0] = 1.0
    b.product.at[sets] = 1.0
    for k in range(1, sets):
        # of this set the unknowns, from the last on, and how many there are
        many = 0
        left = k
        while left > 0:
            many += left % 2
            left //= 2
        row = b.part_from.at[many - 1] + b.chosen.at[many - 1]
        behind = 0
        bit = sets // 2
        for j in range(n):
            unknown = n - 1 - j
            if (k // bit) % 2 == 1:
                share = b.parts.at[row * n + unknown]
                way = 1.0 if behind % 2 == 0 else -1.0
                b.product.at[k] += way * share * b.product.at[k - bit]
                b.product.at[sets + k] += math.fabs(share) * b.product.at[sets + k - bit]
                behind += 1
            bit //= 2
    total = b.product.at[sets - 1]
    most = b.product.at[2 * sets - 1]
    if math.fabs(total) <= ROUNDED * most:
        return 0.0
    if not math.fabs(total) > CANCELS * most:
        return UNTOLD
    return 1.0 if total > 0.0 else -1.0


def take_next(e: Engine, n: int) -> None:
    """Choose other parts of rows: the next one in the order of numbers of many digits."""
    b = e.work.following
    for i in range(n):
        b.chosen.at[i] += 1
        if b.chosen.at[i] < b.part_from.at[i + 1] - b.part_from.at[i]:
            return
        b.chosen.at[i] = 0
