"""Propagation of ``b' = M b`` by the exponential of the matrix, for any time at once.

Up to about the inverse of the norm, a state is propagated by its Taylor series. For longer there
are levels: the exponentials for a unit, two, four, ..., each less the identity.
Less the identity, because slow motions beside a fast one hardly change in a unit: squared as
``(I + D)^2 - I = 2 D + D^2``, what they do is not lost in rounding.
Source: C. Moler, C. Van Loan, SIAM Review 45(1), 2003.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, fit, make_block
from hybond.engine.algebra.products import copy_floats, copy_part, times_matrix, times_vector
from hybond.engine.algebra.twofold import sum_rest
from hybond.engine.methods.linear.flow_records import LEVELS, PARTS, TERMS, Exact, Flow
from hybond.engine.words import Floats, some

SMALL: Final = 2.0**-60
"""Part of the state below which a term is nothing."""
LONGEST: Final = 1.5
"""Time that a series goes over, in units of the inverse of the norm: so many terms are enough."""
FEW: Final = 4
"""Of no more components series are summed one by one, of more all at once."""


def level_of(x: Exact, f: Flow, k: int) -> Floats:
    """Return the exponential for ``2^k`` units, less the identity."""
    n = f.n
    while f.levels <= k:
        if f.level[f.levels] is None:
            f.level[f.levels] = make_block(n * n)
        new: Block = some(f.level[f.levels])
        fit(new, n * n)
        fit(x.power, n * n)
        if f.levels == 0:
            first_level(x, f, new.at)
        else:
            d = some(f.level[f.levels - 1]).at
            times_matrix(n, n, n, d, d, new.at)
            for i in range(n * n):
                new.at[i] += 2.0 * d[i]
        f.levels += 1
    return some(f.level[k]).at


def first_level(x: Exact, f: Flow, out: Floats) -> None:
    """Put the exponential for a unit there, less the identity: a series of sparse products."""
    n = f.n
    fit(x.dense, n * n)
    power = x.power.at
    other = x.dense.at
    for i in range(n * n):
        out[i] = 0.0
        power[i] = 0.0
    for i in range(n):
        power[i * n + i] = 1.0
    for term in range(TERMS):
        factor = f.unit / (float(term) + 1.0)
        for i in range(n * n):
            other[i] = 0.0
        for i in range(n):
            for p in range(f.own.first.at[i], f.own.first.at[i + 1]):
                entry = factor * f.own.value.at[p]
                row = f.own.column.at[p] * n
                for j in range(n):
                    other[i * n + j] += entry * power[row + j]
        for i in range(n * n):
            power[i] = other[i]
            out[i] += other[i]


def to_own(f: Flow, b: Floats, over: Floats) -> None:
    """Replace z, in balanced units, by the coordinates that the flow is propagated in.

    In `over`, room for as many, stands by what each is more than the sum that it was rounded to:
    of a hundred small shares that one has the rounding would be seen in the rates of all.
    """
    for i in range(f.n):
        over[i] = 0.0
    for p in range(f.shares):
        other = f.other.at[p]
        add_share(b, other, over, other, -f.share.at[p] * b[f.row.at[p]])
    for i in range(f.n):
        b[i] += over[i]


def from_own(f: Flow, b: Floats, at: int, over: Floats, shared: Floats) -> None:
    """Replace such coordinates, from `at` on, by z; `shared` grows to the size of what is added.

    A state that is zero is a difference there of what others hold, and no more exact than these.
    """
    for i in range(f.n):
        over[i] = 0.0
    for p in range(f.shares - 1, -1, -1):
        other = f.other.at[p]
        term = f.share.at[p] * b[at + f.row.at[p]]
        add_share(b, at + other, over, other, term)
        shared[other] = max(shared[other], math.fabs(term))
    for i in range(f.n):
        b[at + i] += over[i]


def add_share(b: Floats, at: int, over: Floats, i: int, term: float) -> None:
    """Add a term to component i, which stands at `at`; by what that is rounded goes there."""
    before = b[at]
    b[at] = before + term
    over[i] += sum_rest(before, term, b[at])


def series(x: Exact, f: Flow, b: Floats, h: float) -> int:
    """Put the terms of the Taylor series but for the first into `terms`; return how many."""
    n = f.n
    terms = x.terms.at
    total = x.b2.at
    copy_floats(n, b, total)
    first = f.own.first.at
    column = f.own.column.at
    value = f.own.value.at
    for k in range(TERMS):
        factor = h / (float(k) + 1.0)
        moves = False
        below = b if k == 0 else terms
        at = max(k - 1, 0) * n
        p = first[0]
        for i in range(n):
            term = 0.0
            stop = first[i + 1]
            while p < stop:
                term += value[p] * below[at + column[p]]
                p += 1
            term *= factor
            terms[k * n + i] = term
            total[i] += term
            # each component for itself: a small one may stand beside a large one all the time
            if math.fabs(term) > SMALL * math.fabs(total[i]):
                moves = True
        if not moves:
            return k + 1
    return TERMS


def pass_time(x: Exact, f: Flow, b: Floats, h: float) -> bool:
    """Let a time pass for `b`; False if it is too long."""
    n = f.n
    rest = h
    if rest >= f.unit:
        size = f.unit
        k = 0
        while 2.0 * size <= rest:
            size *= 2.0
            k += 1
        if k >= LEVELS:
            return False
        while k >= 0:
            if size <= rest:
                level = level_of(x, f, k)
                times_vector(n, n, level, b, x.b2.at)
                for i in range(n):
                    b[i] += x.b2.at[i]
                rest -= size
            size *= 0.5
            k -= 1
    if rest > 0.0:
        many = series(x, f, b, rest)
        for i in range(n):
            total = 0.0
            for k in range(many):
                total += x.terms.at[(many - 1 - k) * n + i]
            b[i] += total
    return True


def pass_parts(x: Exact, f: Flow, h: float) -> bool:
    """Put z at all parts of a time behind its beginning, which stands there; False: too long."""
    n = f.n
    parts = x.parts.at
    for i in range(n):
        parts[i] /= f.scale.at[i]
    copy_floats(n, parts, x.b.at)
    if f.shares > 0:
        to_own(f, x.b.at, x.b2.at)
        fit(x.shared, n)
        for i in range(n):
            x.shared.at[i] = 0.0
    reach = parts_at_once(f, h)
    done = 0
    while done < PARTS:
        reach = min(reach, PARTS - done)
        begin = h * float(done) / float(PARTS)
        end = h if done + reach == PARTS else h * float(done + reach) / float(PARTS)
        if reach > 1:
            many = series(x, f, x.b.at, end - begin)
            for j in range(1, reach + 1):
                sum_series(n, many, x.terms.at, float(j) / float(reach), parts, (done + j) * n)
                for i in range(n):
                    parts[(done + j) * n + i] += x.b.at[i]
        else:
            if not pass_time(x, f, x.b.at, end - begin):
                return False
            copy_part(n, x.b.at, 0, parts, (done + 1) * n)
        done += reach
        copy_part(n, parts, done * n, x.b.at, 0)
    for part in range(1, PARTS + 1 if f.shares > 0 else 1):
        from_own(f, parts, part * n, x.b2.at, x.shared.at)
    for part in range(PARTS + 1):
        for i in range(n):
            parts[part * n + i] *= f.scale.at[i]
    return True


def parts_at_once(f: Flow, h: float) -> int:
    """Return over how many parts of a time one series goes: all of them, if the time is short."""
    if h * f.norm <= LONGEST:
        return PARTS
    reach = PARTS - 1
    while reach > 1 and h * float(reach) / float(PARTS) * f.norm > LONGEST:
        reach -= 1
    return reach


def sum_series(n: int, many: int, terms: Floats, at: float, out: Floats, begin: int) -> None:
    """Put the sum of a series, but for its first term, at a part of its time into `out`."""
    if n <= FEW:
        for i in range(n):
            total = 0.0
            for k in range(many - 1, -1, -1):
                total = at * (terms[k * n + i] + total)
            out[begin + i] = total
        return
    for i in range(n):
        out[begin + i] = 0.0
    for k in range(many - 1, -1, -1):
        for i in range(n):
            out[begin + i] = at * (terms[k * n + i] + out[begin + i])


def pass_derivatives(f: Flow, many: int, z: Floats, rows: Floats) -> None:
    """Put the derivatives 1, 2, ... of z, each over its factorial, into `rows`."""
    n = f.n
    # each row from the one before, the first from z
    for order in range(many):
        begin = max(order - 1, 0) * n
        for i in range(n):
            total = 0.0
            for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
                j = f.rows.column.at[p]
                below = z[j] / f.scale.at[j] if order == 0 else rows[begin + j]
                total += f.rows.value.at[p] * below
            rows[order * n + i] = total / (float(order) + 1.0)
    for order in range(many):
        for i in range(n):
            rows[order * n + i] *= f.scale.at[i]


def even_length(f: Flow, h: float) -> float:
    """Return a time, at most `h`, whose parts are each one level; `h` itself if it is short."""
    part = f.unit
    if not h > float(PARTS) * part:
        return h
    while 2.0 * float(PARTS) * part <= h:
        part *= 2.0
    return float(PARTS) * part


def rate_of(f: Flow, z: Floats, i: int) -> float:
    """Return the rate of component i of z."""
    total = 0.0
    for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
        j = f.rows.column.at[p]
        total += f.rows.value.at[p] * (z[j] / f.scale.at[j])
    return total * f.scale.at[i]


def size_of_rate(f: Flow, states: int, z: Floats, i: int) -> float:
    """Return the size of the terms of the rate of component i of z that time alone makes."""
    total = 0.0
    for p in range(f.rows.first.at[i], f.rows.first.at[i + 1]):
        j = f.rows.column.at[p]
        if j >= states:
            total += math.fabs(f.rows.value.at[p] * (z[j] / f.scale.at[j]))
    return total * f.scale.at[i]
