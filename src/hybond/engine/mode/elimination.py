"""Sparse Gauss-Jordan elimination that knows when a row vanished by structure.

Unknown columns are eliminated in the order rows arrive; known columns are only carried along. A
row whose unknowns all cancel is not lost: it is a constraint among the knowns. Unknowns that are
equal are one from the start. After equations/elimination.py.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.words import Floats, Ints, floats, ints, record

CANCELLATION: Final = 1e-12
"""A sum below this part of its terms is a cancellation, hence zero."""
CLEAR: Final = 1e-9
"""A sum above this part of its terms has digits enough."""
NOISE: Final = 1e-14
"""A sum below this part of its terms may be nothing but rounding."""
USED: Final = -1
"""What `add_row` says of a row that determined an unknown."""


@record
class Elimination:
    """Unknown columns come first, knowns after them.

    Row k of `entry`, `columns` long, says ``unknown k + sum = 0`` where ``solved[k]``; its columns
    that are not zero are the ``count[k]`` first ones in row k of `column`.
    """

    unknowns: int
    columns: int
    same: Ints
    """The first of the unknowns that each one is equal to."""
    solved: Ints
    order: Ints
    """The unknowns that are solved, in the order in which they were."""
    done: int
    count: Ints
    column: Ints
    entry: Floats
    used: Ints
    """In how many rows each free unknown is."""
    least: float
    dropped: float
    # a row under way
    total: Floats
    size: Floats
    met: Ints
    mark: Ints
    width: int
    # the row to be added, column by column
    given: int
    given_column: Ints
    given_value: Floats


def make_elimination(unknowns: int, columns: int) -> Elimination:
    """Return room for an elimination of so many unknowns and columns."""
    e = Elimination()
    e.unknowns = unknowns
    e.columns = columns
    e.same = ints(unknowns)
    e.solved = ints(unknowns)
    e.order = ints(unknowns)
    e.count = ints(unknowns)
    e.column = ints(unknowns * columns)
    e.entry = floats(unknowns * columns)
    e.used = ints(unknowns)
    e.total = floats(columns)
    e.size = floats(columns)
    e.met = ints(columns)
    e.mark = ints(columns)
    e.given_column = ints(columns)
    e.given_value = floats(columns)
    begin_elimination(e)
    return e


def begin_elimination(e: Elimination) -> None:
    """Forget all rows, and which unknowns are equal."""
    e.done = 0
    e.least = 1.0
    e.dropped = 0.0
    e.given = 0
    for k in range(e.unknowns):
        e.same[k] = k
        e.solved[k] = 0
        e.used[k] = 0
        for i in range(e.count[k]):
            e.entry[k * e.columns + e.column[k * e.columns + i]] = 0.0
        e.count[k] = 0


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


def copy_elimination(source: Elimination, e: Elimination) -> None:
    """Make `e` a copy of another elimination with the same columns."""
    begin_elimination(e)
    e.done = source.done
    e.least = source.least
    e.dropped = source.dropped
    for k in range(e.unknowns):
        e.same[k] = source.same[k]
        e.solved[k] = source.solved[k]
        e.order[k] = source.order[k]
        e.used[k] = source.used[k]
        e.count[k] = source.count[k]
        for i in range(e.count[k]):
            at = k * e.columns + i
            e.column[at] = source.column[at]
            e.entry[k * e.columns + e.column[at]] = source.entry[k * e.columns + e.column[at]]


def give(e: Elimination, column: int, value: float) -> None:
    """Add a term to the row that is to be added next; a column comes once."""
    e.given_column[e.given] = column
    e.given_value[e.given] = value
    e.given += 1


def cancels(e: Elimination, total: float, size: float) -> bool:
    """Whether a sum of terms of that size is zero; note how sure that is."""
    part = math.fabs(total)
    if part > CLEAR * size:
        return False
    zero = part <= CANCELLATION * size
    if not zero:
        e.least = min(e.least, part / size)
    elif part > NOISE * size:
        e.dropped = max(e.dropped, part / size)
    return zero


def meet(e: Elimination, column: int, value: float) -> None:
    """Add a term to the row under way."""
    if e.mark[column] == 0:
        e.mark[column] = 1
        e.met[e.width] = column
        e.width += 1
        e.total[column] = 0.0
        e.size[column] = 0.0
    e.total[column] += value
    e.size[column] += math.fabs(value)


def reduce_row(e: Elimination) -> None:
    """Replace solved unknowns in the row given; what is left is in `total` at the columns `met`."""
    e.width = 0
    for t in range(e.given):
        k = e.given_column[t]
        c = e.given_value[t]
        column = e.same[k] if k < e.unknowns else k
        if column >= e.unknowns or e.solved[column] == 0:
            meet(e, column, c)
            continue
        row = column * e.columns
        for i in range(e.count[column]):
            at = e.column[row + i]
            meet(e, at, -c * e.entry[row + at])
    e.given = 0
    drop_zeros(e)


def drop_zeros(e: Elimination) -> None:
    """Leave what cancels out of the row under way."""
    kept = 0
    for i in range(e.width):
        at = e.met[i]
        e.mark[at] = 0
        if not cancels(e, e.total[at], e.size[at]):
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
            biggest = max(biggest, math.fabs(e.total[e.met[i]]))
    if not found:
        return e.width
    pivot = -1
    for i in range(e.width):
        k = e.met[i]
        if k >= e.unknowns or math.fabs(e.total[k]) < 0.1 * biggest:
            continue
        if pivot < 0 or e.used[k] < e.used[pivot] or (e.used[k] == e.used[pivot] and k < pivot):
            pivot = k
    solve_for(e, pivot)
    return USED


def solve_for(e: Elimination, pivot: int) -> None:
    """Let the row under way determine an unknown, and put it into the other rows."""
    scale = e.total[pivot]
    row = pivot * e.columns
    n = 0
    for i in range(e.width):
        k = e.met[i]
        if k != pivot:
            e.column[row + n] = k
            e.entry[row + k] = e.total[k] / scale
            n += 1
    e.count[pivot] = n
    e.solved[pivot] = 1
    left = e.used[pivot]
    e.used[pivot] = 0
    user = 0
    while left > 0:
        if user != pivot and e.solved[user] != 0 and e.entry[user * e.columns + pivot] != 0.0:
            replace_in(e, user, pivot)
            left -= 1
        user += 1
    e.order[e.done] = pivot
    e.done += 1
    for i in range(n):
        k = e.column[row + i]
        if k < e.unknowns:
            e.used[k] += 1


def replace_in(e: Elimination, user: int, pivot: int) -> None:
    """Put the row of `pivot` into that of `user`."""
    row = user * e.columns
    c = e.entry[row + pivot]
    forget(e, user, pivot)
    for i in range(e.count[pivot]):
        k = e.column[pivot * e.columns + i]
        change = c * e.entry[pivot * e.columns + k]
        old = e.entry[row + k]
        new = old - change
        if cancels(e, new, math.fabs(old) + math.fabs(change)):
            if old != 0.0:
                forget(e, user, k)
                if k < e.unknowns:
                    e.used[k] -= 1
            continue
        if old == 0.0:
            e.column[row + e.count[user]] = k
            e.count[user] += 1
            if k < e.unknowns:
                e.used[k] += 1
        e.entry[row + k] = new


def forget(e: Elimination, user: int, k: int) -> None:
    """Take a column out of a row."""
    row = user * e.columns
    n = e.count[user]
    i = 0
    while e.column[row + i] != k:
        i += 1
    while i + 1 < n:
        e.column[row + i] = e.column[row + i + 1]
        i += 1
    e.count[user] = n - 1
    e.entry[row + k] = 0.0


def put_in(e: Elimination, known: Elimination, shift: int, told: Ints) -> None:
    """Replace known columns by the rows of another elimination, of columns `shift` behind.

    Column ``shift + k`` is replaced where k is solved there and ``told[k]``. Of a row that has
    such columns all terms are summed anew.
    """
    for done in range(e.done):
        user = e.order[done]
        row = user * e.columns
        met = 0
        for k in range(known.unknowns):
            if told[k] != 0 and e.entry[row + shift + k] != 0.0:
                met += 1
        if met == 0:
            continue
        e.width = 0
        for i in range(e.count[user]):
            column = e.column[row + i]
            if not is_told(known, shift, told, column):
                meet(e, column, e.entry[row + column])
        for k in range(known.unknowns):
            if told[k] == 0 or e.entry[row + shift + k] == 0.0:
                continue
            for i in range(known.count[k]):
                j = known.column[k * known.columns + i]
                meet(e, shift + j, -e.entry[row + shift + k] * known.entry[k * known.columns + j])
        drop_zeros(e)
        for i in range(e.count[user]):
            e.entry[row + e.column[row + i]] = 0.0
        e.count[user] = e.width
        for i in range(e.width):
            e.column[row + i] = e.met[i]
            e.entry[row + e.met[i]] = e.total[e.met[i]]


def is_told(known: Elimination, shift: int, told: Ints, column: int) -> bool:
    """Whether a column is one that is replaced."""
    k = column - shift
    return k >= 0 and k < known.unknowns and told[k] != 0


def is_free(e: Elimination, k: int) -> bool:
    """Whether no row has determined an unknown; of equal ones the first stands for all."""
    return e.same[k] == k and e.solved[k] == 0
