"""What one elimination takes from another: all that it is, or rows in place of known columns."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_block, grow_places
from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.mode.rows.elimination import (
    append_entry,
    drop_zeros,
    make_room,
    meet,
    meet_product,
    note_user,
)
from hybond.engine.mode.rows.elimination_records import NOWHERE, Elimination, begin_elimination
from hybond.engine.words import Ints

FEW: Final = 16
"""Known columns of a row up to which they are put in order one by one; else all are gone through.
"""


def copy_elimination(source: Elimination, e: Elimination) -> None:
    """Make `e` a copy of another elimination with the same columns."""
    begin_elimination(e)
    e.done = source.done
    e.least = source.least
    e.doubted = source.doubted
    for k in range(e.unknowns):
        e.same[k] = source.same[k]
        e.read[k] = source.read[k]
        e.last[k] = source.last[k]
        e.weight[k] = source.weight[k]
        e.solved[k] = source.solved[k]
        e.order[k] = source.order[k]
        many = source.count[k]
        if many > 0:
            make_room(e, k, many)
            copy_entries(source, source.first[k], e, e.first[k], many)
        for i in range(many):
            column = e.column.at[e.first[k] + i]
            if column < e.unknowns:
                note_user(e, column, k)
        e.count[k] = many


def copy_entries(source: Elimination, at: int, e: Elimination, to: int, many: int) -> None:
    """Copy so many entries from a place in another elimination to one in this, array by array."""
    copy_places(many, source.column.at, at, e.column.at, to)
    copy_part(many, source.entry.at, at, e.entry.at, to)
    copy_part(many, source.rest.at, at, e.rest.at, to)
    copy_part(many, source.loss.at, at, e.loss.at, to)
    copy_part(many, source.one_drift.at, at, e.one_drift.at, to)
    copy_part(many, source.other_drift.at, at, e.other_drift.at, to)


def repeat_elimination(source: Elimination, e: Elimination) -> None:
    """Make `e` go on from where another elimination with the same columns is, as that would."""
    e.done = source.done
    e.least = source.least
    e.doubted = source.doubted
    e.given = 0
    e.end = source.end
    e.cells = source.cells
    for k in range(e.unknowns):
        e.same[k] = source.same[k]
        e.solved[k] = source.solved[k]
        e.order[k] = source.order[k]
        e.first[k] = source.first[k]
        e.count[k] = source.count[k]
        e.room[k] = source.room[k]
        e.read[k] = source.read[k]
        e.last[k] = source.last[k]
        e.weight[k] = source.weight[k]
        e.used[k] = source.used[k]
        e.user[k] = source.user[k]
    grow_places(e.column, e.end)
    grow_block(e.entry, e.end)
    grow_block(e.rest, e.end)
    grow_block(e.loss, e.end)
    grow_block(e.one_drift, e.end)
    grow_block(e.other_drift, e.end)
    copy_entries(source, 0, e, 0, e.end)
    grow_places(e.cell_row, e.cells)
    grow_places(e.cell_next, e.cells)
    copy_places(e.cells, source.cell_row.at, 0, e.cell_row.at, 0)
    copy_places(e.cells, source.cell_next.at, 0, e.cell_next.at, 0)


def put_in(e: Elimination, known: Elimination, shift: int, told: Ints) -> None:
    """Replace known columns by the rows of another elimination, of columns `shift` behind.

    Column ``shift + k`` is replaced where k is solved there and ``told[k]``. Of a row that has
    such columns all terms are summed anew.
    """
    for done in range(e.done):
        user = e.order[done]
        first = e.first[user]
        met = 0
        for i in range(first, first + e.count[user]):
            if is_told(known, shift, told, e.column.at[i]):
                e.place[e.column.at[i]] = i
                if met < FEW:
                    put_in_order(e, met, e.column.at[i])
                met += 1
        if met == 0:
            continue
        e.width = 0
        for i in range(first, first + e.count[user]):
            column = e.column.at[i]
            if e.place[column] == NOWHERE:
                meet(e, column, e.entry.at[i], e.rest.at[i])
                e.lost[column] += e.loss.at[i]
                e.one_off[column] += e.one_drift.at[i]
                e.other_off[column] += e.other_drift.at[i]
        # in the order of what is told: sums follow it
        for q in range(met if met <= FEW else known.unknowns):
            k = e.given_column[q] - shift if met <= FEW else q
            at = e.place[shift + k]
            if at == NOWHERE:
                continue
            e.place[shift + k] = NOWHERE
            for i in range(known.first[k], known.first[k] + known.count[k]):
                c = e.entry.at[at]
                put = known.entry.at[i]
                column = shift + known.column.at[i]
                meet_product(e, column, c, e.rest.at[at], put, known.rest.at[i])
                e.lost[column] += math.fabs(c) * known.loss.at[i] + e.loss.at[at] * math.fabs(put)
                e.one_off[column] -= c * known.one_drift.at[i] + e.one_drift.at[at] * put
                e.other_off[column] -= c * known.other_drift.at[i] + e.other_drift.at[at] * put
        drop_zeros(e)
        e.count[user] = 0
        make_room(e, user, e.width)
        for i in range(e.width):
            k = e.met[i]
            at = append_entry(e, user, k)
            e.entry.at[at] = e.total[k]
            e.rest.at[at] = e.over[k]
            e.loss.at[at] = e.lost[k]
            e.one_drift.at[at] = e.one_off[k]
            e.other_drift.at[at] = e.other_off[k]


def put_in_order(e: Elimination, many: int, column: int) -> None:
    """Put a column among the first `many`, in their order, where no row is given yet."""
    at = many
    while at > 0 and e.given_column[at - 1] > column:
        e.given_column[at] = e.given_column[at - 1]
        at -= 1
    e.given_column[at] = column


def is_told(known: Elimination, shift: int, told: Ints, column: int) -> bool:
    """Whether a column is one that is replaced."""
    k = column - shift
    return k >= 0 and k < known.unknowns and told[k] != 0
