"""What stands: storages at an equilibrium that nothing touches, for as long as a motion lasts.

A mass on a spring whose force is its weight does not move. In floating point the two differ by
rounding of the product that the stretch was given as. The mass, which is at rest exactly, begins to
move by that, and a guard ``v.f > 0`` holds, however small it is beside the weight. But a state that
is an equilibrium to within rounding of what is stored is one. So, where motion begins, storages are
sought

- whose rates are sums of what storages give and of constants, and are rounding of their terms;
  what a bent storage gives counts by its slope at what it holds;
- which read each other only: no source that moves, no storage that moves, no signal;
- and for which a change of what they hold by no more than rounding makes all these rates zero.

Their rates are zero for as long as the motion lasts. By the second condition nothing that happens
elsewhere changes that, before something happens at an instant. The third tells rounding from what
is slow: two capacitors of one voltage, joined by a microhm, have rates that are small beside their
terms if one of them leaks, but are far from where they would rest.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.engine import Engine
from hybond.engine.mode.comparisons.standing_records import Standing
from hybond.engine.mode.comparisons.straight_rates import take_rate
from hybond.engine.mode.comparisons.sum_records import begin_sum, begin_sums, end_sum
from hybond.engine.words import Floats

LAST_DIGITS: Final = 64.0 * EPSILON
"""Part of what is stored that rounding may be: a product of decimals and its quotients are off by
some units each."""
TOLD: Final = 1e-6
"""A pivot, beside entries of 1, below which equations say too little to tell rounding from rest."""


def find_standing(e: Engine, rate: Floats) -> None:
    """Find what stands in the motion that begins in the present mode, with these rates."""
    if begin_standing(e, rate):
        take_sums(e)
        find_among(e, 0)


def begin_standing(e: Engine, rate: Floats) -> bool:
    """Note rates, and which may be rounding by a first look; whether any such storage holds some.

    The look needs no terms of the rates.
    """
    m = e.model
    x = e.standing
    x.some = False
    some = False
    for k in range(m.storages):
        x.rate[k] = rate[k]
        x.stands[k] = 1 if math.fabs(rate[k]) <= e.rate_noise[k] else 0
        some = some or (x.stands[k] != 0 and e.y[k] != 0.0)
    return some


def find_among(e: Engine, in_flow: int) -> bool:
    """Find what stands among what may, by the sums that are taken of their rates; if any does."""
    m = e.model
    x = e.standing
    for k in range(m.storages):
        leave_moving(e, k)
    while leaves_out(x, m.storages):
        pass
    gather(x, m.storages)
    for k in range(m.storages):
        if x.root[k] == k:
            find_block(e, k, in_flow)
    x.some = any_stands(x, m.storages)
    return x.some


def gather(x: Standing, storages: int) -> None:
    """Chain those that stand and read each other, from the first of them on."""
    s = x.sums
    for k in range(storages):
        x.root[k] = k if x.stands[k] != 0 else -1
        x.behind[k] = -1
    for k in range(storages):
        if x.stands[k] == 0:
            continue
        for p in range(s.first.at[k], s.first.at[k + 1]):
            if s.factor.at[p] != 0.0:
                unite(x.root, k, s.column.at[p])
    for i in range(storages):
        k = storages - 1 - i
        if x.root[k] < 0:
            continue
        root = first_of(x.root, k)
        x.root[k] = root
        if root != k:
            x.behind[k] = x.behind[root]
            x.behind[root] = k


def find_block(e: Engine, root: int, in_flow: int) -> None:
    """Find which of the storages of a chain stand, or that it is as the last time in the mode."""
    x = e.standing
    kept = e.mode.stood
    members = 0
    same = True
    k = root
    while k >= 0:
        members += 1
        same = same and kept.in_flow[k] == in_flow
        same = same and kept.y[k] == e.y[k] and kept.rate[k] == x.rate[k]
        k = x.behind[k]
    k = root
    while k >= 0:
        same = same and kept.members[k] == members
        k = x.behind[k]
    if not same:
        while stands_in(x, root) and not is_equilibrium(e, root, members):
            while leaves_out(x, e.model.storages):
                pass
    k = root
    while k >= 0:
        if same:
            x.stands[k] = kept.stands[k]
        kept.members[k] = members
        kept.in_flow[k] = in_flow
        kept.stands[k] = x.stands[k]
        kept.y[k] = e.y[k]
        kept.rate[k] = x.rate[k]
        k = x.behind[k]


def stands_in(x: Standing, root: int) -> bool:
    """Whether some storage of a chain stands."""
    k = root
    while k >= 0:
        if x.stands[k] != 0:
            return True
        k = x.behind[k]
    return False


def take_sums(e: Engine) -> None:
    """Take the rates of those that may stand as sums."""
    m = e.model
    s = e.standing.sums
    begin_sums(s, m.storages)
    for k in range(m.storages):
        if e.standing.stands[k] == 0 or not take_rate(e, m, s, k):
            begin_sum(s, k)
            end_sum(s, k, False)


def leave_moving(e: Engine, k: int) -> None:
    """Leave storage k out if its rate is more than rounding of its terms, or moves with time."""
    x = e.standing
    s = x.sums
    x.size[k] = math.fabs(s.level.at[k])
    for p in range(s.first.at[k], s.first.at[k + 1]):
        x.size[k] += math.fabs(s.factor.at[p] * e.y[s.column.at[p]])
    still = math.fabs(x.rate[k]) <= LAST_DIGITS * x.size[k] and s.drift.at[k] == 0.0
    if s.known.at[k] == 0 or not still:
        x.stands[k] = 0


def leaves_out(x: Standing, storages: int) -> bool:
    """Leave out what reads something that does not stand; whether there was any."""
    s = x.sums
    left = False
    for k in range(storages):
        if x.stands[k] == 0:
            continue
        for p in range(s.first.at[k], s.first.at[k + 1]):
            j = s.column.at[p]
            if s.factor.at[p] != 0.0 and (j >= storages or x.stands[j] == 0):
                x.stands[k] = 0
                left = True
    return left


def any_stands(x: Standing, storages: int) -> bool:
    """Whether some storage stands."""
    for k in range(storages):
        if x.stands[k] != 0:
            return True
    return False


def is_equilibrium(e: Engine, root: int, members: int) -> bool:
    """Whether changes by rounding make the rates of a chain zero; else leave one of it out.

    Each is sought as a part of what the storage holds, by elimination with full pivoting. What
    holds nothing has no rounding, and an equation without terms holds.
    """
    x = e.standing
    rows = put_equations(e, root, members)
    width = members + 1
    a = x.matrix.at
    for done in range(rows):
        row = done
        column = -1
        best = TOLD
        for i in range(done, rows):
            for j in range(width - 1):
                if x.taken[j] == 0 and math.fabs(a[i * width + j]) > best:
                    best = math.fabs(a[i * width + j])
                    row = i
                    column = j
        if column < 0:
            x.stands[x.row[done]] = 0
            return False
        x.taken[column] = 1
        put_solved(a, width, rows, done, row, column)
        storage = x.row[row]
        x.row[row] = x.row[done]
        x.row[done] = storage
    for i in range(rows):
        if math.fabs(a[i * width + width - 1]) > LAST_DIGITS:
            x.stands[x.row[i]] = 0
            return False
    return True


def put_equations(e: Engine, root: int, members: int) -> int:
    """Put a row there for each rate that has terms: parts of these, then by what it is not zero.

    Returns how many there are.
    """
    x = e.standing
    s = x.sums
    width = members + 1
    rows = 0
    column = 0
    k = root
    while k >= 0:
        x.place[k] = column
        x.taken[column] = 0
        column += 1
        if x.stands[k] != 0 and x.size[k] > 0.0:
            x.row[rows] = k
            rows += 1
        k = x.behind[k]
    fit(x.matrix, rows * width)
    a = x.matrix.at
    for i in range(rows):
        k = x.row[i]
        for j in range(width):
            a[i * width + j] = 0.0
        for p in range(s.first.at[k], s.first.at[k + 1]):
            j = s.column.at[p]
            if s.factor.at[p] != 0.0:
                a[i * width + x.place[j]] += s.factor.at[p] * e.y[j] / x.size[k]
        a[i * width + width - 1] = -x.rate[k] / x.size[k]
    return rows


def put_solved(a: Floats, width: int, rows: int, done: int, row: int, column: int) -> None:
    """Solve a row for a column, put it in its place, and take the column out of all others."""
    for j in range(width):
        entry = a[row * width + j]
        a[row * width + j] = a[done * width + j]
        a[done * width + j] = entry
    pivot = a[done * width + column]
    for j in range(width):
        a[done * width + j] /= pivot
    for i in range(rows):
        factor = a[i * width + column]
        if i == done or factor == 0.0:
            continue
        for j in range(width):
            a[i * width + j] -= factor * a[done * width + j]


def hold_standing(e: Engine, rate: Floats) -> None:
    """Let rates of what stands be zero."""
    x = e.standing
    for k in range(e.model.storages):
        if x.stands[k] != 0:
            rate[k] = 0.0
            e.rate_rest[k] = 0.0
