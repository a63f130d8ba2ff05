"""Sparse Gauss-Jordan elimination that knows when a row vanished by structure.

Unknown columns are eliminated in the order rows arrive; known columns are only carried along. A
row whose unknowns all cancel is not lost: it is a constraint among the knowns. Unknowns that are
equal are one from the start.

Beside each entry stands what rounding may have lost in it, in units of rounding: the size of the
terms it came about by, sums and quotients followed to first order (running error analysis; Higham,
*Accuracy and Stability of Numerical Algorithms*, 2002, section 3.3). What is small because large
terms cancelled is known as that. Whether it is anything at all is told by how it would move with
what is given, in `mode/rows/drift`.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_block, grow_places
from hybond.engine.algebra.twofold import product_rest, sum_rest
from hybond.engine.mode.rows.drift import ONE_WAY, OTHER_WAY, drift_of
from hybond.engine.mode.rows.elimination_records import NOWHERE, SMALLEST, Elimination

CANCELLATION: Final = 1e-12
"""Of a sum below this part of its terms it is asked whether it is rounding; of others it is not."""
GIVEN: Final = 1e-14
"""A sum is rounding of what is given, to some 45 units in the last place as expressions of decimal
numbers have, if it is below this part of how far it moves with that."""
CLEAR: Final = 1e-9
"""A sum above this part of its terms has digits enough."""
ROUNDED: Final = 2.0**-96
"""A sum below this part of what it has lost on the way is rounding of rows with twice the digits:
2^-105 of its terms at each step, and some hundred steps."""
USED: Final = -1
"""What `add_row` says of a row that determined an unknown."""


def make_room(e: Elimination, k: int, many: int) -> None:
    """Make room for so many entries in row k; those there are kept."""
    if many <= e.room[k]:
        return
    room = max(many + many // 2, SMALLEST)
    grow_places(e.column, e.end + room)
    grow_block(e.entry, e.end + room)
    grow_block(e.rest, e.end + room)
    grow_block(e.loss, e.end + room)
    grow_block(e.one_drift, e.end + room)
    grow_block(e.other_drift, e.end + room)
    for i in range(e.count[k]):
        move_entry(e, e.first[k] + i, e.end + i)
    e.first[k] = e.end
    e.room[k] = room
    e.end += room


def move_entry(e: Elimination, at: int, to: int) -> None:
    """Put a copy of an entry elsewhere."""
    e.column.at[to] = e.column.at[at]
    e.entry.at[to] = e.entry.at[at]
    e.rest.at[to] = e.rest.at[at]
    e.loss.at[to] = e.loss.at[at]
    e.one_drift.at[to] = e.one_drift.at[at]
    e.other_drift.at[to] = e.other_drift.at[at]


def append_entry(e: Elimination, k: int, column: int) -> int:
    """Add an entry to row k, in which there is none in that column; return where it stands."""
    make_room(e, k, e.count[k] + 1)
    at = e.first[k] + e.count[k]
    e.column.at[at] = column
    e.count[k] += 1
    return at


def note_user(e: Elimination, k: int, row: int) -> None:
    """Note that a free unknown is in a row."""
    grow_places(e.cell_row, e.cells + 1)
    grow_places(e.cell_next, e.cells + 1)
    e.cell_row.at[e.cells] = row
    e.cell_next.at[e.cells] = e.user[k]
    e.user[k] = e.cells
    e.cells += 1
    e.used[k] += 1


def find_entry(e: Elimination, k: int, column: int) -> int:
    """Return where the entry of row k in a column stands, or NOWHERE."""
    for i in range(e.first[k], e.first[k] + e.count[k]):
        if e.column.at[i] == column:
            return i
    return NOWHERE


def first_of(e: Elimination, k: int) -> int:
    """Return the first unknown that k is equal to."""
    while e.same[k] != k:
        k = e.same[k]
    return k


def make_equal(e: Elimination, a: int, b: int) -> None:
    """Make two unknowns one; before any row is added."""
    a = first_of(e, a)
    b = first_of(e, b)
    if a < b:
        e.same[b] = a
    else:
        e.same[a] = b


def settle_equal(e: Elimination) -> None:
    """Let every unknown know the first that it is equal to."""
    for k in range(e.unknowns):
        e.same[k] = first_of(e, k)


def give(e: Elimination, column: int, value: float) -> None:
    """Add a term to the row that is to be added next; a column comes once."""
    e.given_column[e.given] = column
    e.given_value[e.given] = value
    e.given += 1


def cancels(e: Elimination, total: float, size: float, lost: float, drift: float) -> bool:
    """Whether a sum of terms of that size is zero; note how sure that is.

    It is if it is small, and either what rows with twice the digits leave of zero or what rounding
    of the numbers that were given makes of it: it would be something else if these moved. The
    current of a leak is small beside the terms it is summed from, too, and moves by as much of
    itself as what is given does of itself.
    """
    part = math.fabs(total)
    if part > CLEAR * size:
        return False
    zero = part <= CANCELLATION * size and part <= max(ROUNDED * lost, GIVEN * drift)
    if not zero:
        e.least = min(e.least, part / size)
    elif part > ROUNDED * lost:
        e.doubted = True
    return zero


def meet(e: Elimination, column: int, value: float, rest: float) -> None:
    """Add a term to the row under way, and by what it is more; not what it has lost."""
    if e.mark[column] == 0:
        e.mark[column] = 1
        e.met[e.width] = column
        e.width += 1
        e.total[column] = 0.0
        e.over[column] = 0.0
        e.size[column] = 0.0
        e.lost[column] = 0.0
        e.one_off[column] = 0.0
        e.other_off[column] = 0.0
    before = e.total[column]
    e.total[column] = before + value
    e.over[column] += sum_rest(before, value, e.total[column]) + rest
    e.size[column] += math.fabs(value)


def meet_product(
    e: Elimination, column: int, factor: float, more: float, entry: float, rest: float
) -> None:
    """Take a product away from the row under way; not what it has lost."""
    product = factor * entry
    over = product_rest(factor, entry, product) + (factor * rest + more * entry)
    meet(e, column, -product, -over)


def reduce_row(e: Elimination) -> None:
    """Replace solved unknowns in the row given; what is left is in `total` at the columns `met`."""
    e.width = 0
    for t in range(e.given):
        k = e.given_column[t]
        c = e.given_value[t]
        column = e.same[k] if k < e.unknowns else k
        one = drift_of(c, ONE_WAY)
        other = drift_of(c, OTHER_WAY)
        if column >= e.unknowns or e.solved[column] == 0:
            meet(e, column, c, 0.0)
            e.lost[column] += math.fabs(c)
            e.one_off[column] += one
            e.other_off[column] += other
            continue
        for i in range(e.first[column], e.first[column] + e.count[column]):
            at = e.column.at[i]
            meet_product(e, at, c, 0.0, e.entry.at[i], e.rest.at[i])
            e.lost[at] += math.fabs(c) * e.loss.at[i]
            e.one_off[at] -= c * e.one_drift.at[i] + one * e.entry.at[i]
            e.other_off[at] -= c * e.other_drift.at[i] + other * e.entry.at[i]
    e.given = 0
    drop_zeros(e)


def drop_zeros(e: Elimination) -> None:
    """Leave what cancels out of the row under way."""
    kept = 0
    for i in range(e.width):
        at = e.met[i]
        e.mark[at] = 0
        total = e.total[at] + e.over[at]
        e.over[at] = sum_rest(e.total[at], e.over[at], total)
        e.total[at] = total
        drift = max(math.fabs(e.one_off[at]), math.fabs(e.other_off[at]))
        if not cancels(e, e.total[at], e.size[at], e.lost[at], drift):
            e.met[kept] = at
            kept += 1
    e.width = kept


def add_row(e: Elimination) -> int:
    """Add the row given; USED, or how many known columns it constrains, at `met`, by `total`."""
    reduce_row(e)
    biggest = 0.0
    found = False
    for i in range(e.width):
        if e.met[i] < e.unknowns:
            found = True
            biggest = max(biggest, math.fabs(e.total[e.met[i]]) * e.weight[e.met[i]])
    if not found:
        return e.width
    pivot = -1
    for i in range(e.width):
        k = e.met[i]
        if k >= e.unknowns or math.fabs(e.total[k]) * e.weight[k] < 0.1 * biggest:
            continue
        if pivot < 0 or is_before(e, k, pivot):
            pivot = k
    solve_for(e, pivot)
    return USED


def is_before(e: Elimination, k: int, other: int) -> bool:
    """Whether unknown k is rather solved for than another one."""
    if e.read[k] != e.read[other]:
        return e.read[k] == 0
    if e.last[k] != e.last[other]:
        return e.last[k] != 0
    return e.used[k] < e.used[other] or (e.used[k] == e.used[other] and k < other)


def solve_for(e: Elimination, pivot: int) -> None:
    """Let the row under way determine an unknown, and put it into the other rows."""
    scale = e.total[pivot]
    doubt = e.lost[pivot] / math.fabs(scale)
    make_room(e, pivot, e.width)
    for i in range(e.width):
        k = e.met[i]
        if k != pivot:
            value = e.total[k] / scale
            product = value * scale
            rest = (e.total[k] - product) - product_rest(value, scale, product)
            rest = (rest + e.over[k] - value * e.over[pivot]) / scale
            at = append_entry(e, pivot, k)
            e.entry.at[at] = value
            e.rest.at[at] = rest
            e.loss.at[at] = e.lost[k] / math.fabs(scale) + math.fabs(value) * doubt
            e.one_drift.at[at] = (e.one_off[k] - value * e.one_off[pivot]) / scale
            e.other_drift.at[at] = (e.other_off[k] - value * e.other_off[pivot]) / scale
    e.solved[pivot] = 1
    e.used[pivot] = 0
    cell = e.user[pivot]
    while cell != NOWHERE:
        user = e.cell_row.at[cell]
        if user != pivot and find_entry(e, user, pivot) != NOWHERE:
            replace_in(e, user, pivot)
        cell = e.cell_next.at[cell]
    e.user[pivot] = NOWHERE
    e.order[e.done] = pivot
    e.done += 1
    for i in range(e.first[pivot], e.first[pivot] + e.count[pivot]):
        if e.column.at[i] < e.unknowns:
            note_user(e, e.column.at[i], pivot)


def replace_in(e: Elimination, user: int, pivot: int) -> None:
    """Put the row of `pivot` into that of `user`."""
    make_room(e, user, e.count[user] + e.count[pivot])
    first = e.first[user]
    for i in range(e.count[user]):
        e.place[e.column.at[first + i]] = i
    own = first + e.place[pivot]
    c = e.entry.at[own]
    e.entry.at[own] = 0.0
    for i in range(e.first[pivot], e.first[pivot] + e.count[pivot]):
        k = e.column.at[i]
        put = e.entry.at[i]
        change = c * put
        over = product_rest(c, put, change) + (c * e.rest.at[i] + e.rest.at[own] * put)
        at = e.place[k]
        old = 0.0
        new = -change
        rest = -over
        lost = math.fabs(c) * e.loss.at[i] + e.loss.at[own] * math.fabs(put)
        one = -(c * e.one_drift.at[i] + e.one_drift.at[own] * put)
        other = -(c * e.other_drift.at[i] + e.other_drift.at[own] * put)
        if at != NOWHERE:
            old = e.entry.at[first + at]
            total = old - change
            rest = sum_rest(old, -change, total) + (e.rest.at[first + at] - over)
            new = total + rest
            rest = sum_rest(total, rest, new)
            lost += e.loss.at[first + at]
            one += e.one_drift.at[first + at]
            other += e.other_drift.at[first + at]
        size = math.fabs(old) + math.fabs(change)
        if cancels(e, new, size, lost, max(math.fabs(one), math.fabs(other))):
            if at != NOWHERE:
                e.entry.at[first + at] = 0.0
                if k < e.unknowns:
                    e.used[k] -= 1
            continue
        if at == NOWHERE:
            at = append_entry(e, user, k) - first
            if k < e.unknowns:
                note_user(e, k, user)
        e.entry.at[first + at] = new
        e.rest.at[first + at] = rest
        e.loss.at[first + at] = lost
        e.one_drift.at[first + at] = one
        e.other_drift.at[first + at] = other
    tidy_row(e, user)


def tidy_row(e: Elimination, k: int) -> None:
    """Take what is zero out of a row, and what is known of where its columns stand."""
    kept = 0
    first = e.first[k]
    for i in range(e.count[k]):
        e.place[e.column.at[first + i]] = NOWHERE
        if e.entry.at[first + i] != 0.0:
            move_entry(e, first + i, first + kept)
            kept += 1
    e.count[k] = kept


def is_free(e: Elimination, k: int) -> bool:
    """Whether no row has determined an unknown; of equal ones the first stands for all."""
    return e.same[k] == k and e.solved[k] == 0
