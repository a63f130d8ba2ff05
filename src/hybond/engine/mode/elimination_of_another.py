"""What one elimination takes from another: all that it is, or rows in place of known columns."""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import grow_block, grow_places
from hybond.engine.mode.elimination import (
    NOWHERE,
    Elimination,
    append_entry,
    begin_elimination,
    drop_zeros,
    make_room,
    meet,
    meet_product,
    note_user,
)
from hybond.engine.words import Ints


def copy_elimination(source: Elimination, e: Elimination) -> None:
    """Make `e` a copy of another elimination with the same columns."""
    begin_elimination(e)
    e.done = source.done
    e.least = source.least
    e.dropped = source.dropped
    e.doubted = source.doubted
    for k in range(e.unknowns):
        e.same[k] = source.same[k]
        e.read[k] = source.read[k]
        e.last[k] = source.last[k]
        e.weight[k] = source.weight[k]
        e.solved[k] = source.solved[k]
        e.order[k] = source.order[k]
        if source.count[k] > 0:
            make_room(e, k, source.count[k])
        for i in range(source.count[k]):
            column = source.column.at[source.first[k] + i]
            e.column.at[e.first[k] + i] = column
            e.entry.at[e.first[k] + i] = source.entry.at[source.first[k] + i]
            e.rest.at[e.first[k] + i] = source.rest.at[source.first[k] + i]
            e.loss.at[e.first[k] + i] = source.loss.at[source.first[k] + i]
            if column < e.unknowns:
                note_user(e, column, k)
        e.count[k] = source.count[k]


def repeat_elimination(source: Elimination, e: Elimination) -> None:
    """Make `e` go on from where another elimination with the same columns is, as that would."""
    e.done = source.done
    e.least = source.least
    e.dropped = source.dropped
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
    for i in range(e.end):
        e.column.at[i] = source.column.at[i]
        e.entry.at[i] = source.entry.at[i]
        e.rest.at[i] = source.rest.at[i]
        e.loss.at[i] = source.loss.at[i]
    grow_places(e.cell_row, e.cells)
    grow_places(e.cell_next, e.cells)
    for i in range(e.cells):
        e.cell_row.at[i] = source.cell_row.at[i]
        e.cell_next.at[i] = source.cell_next.at[i]


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
                met += 1
        if met == 0:
            continue
        e.width = 0
        for i in range(first, first + e.count[user]):
            if e.place[e.column.at[i]] == NOWHERE:
                meet(e, e.column.at[i], e.entry.at[i], e.rest.at[i], e.loss.at[i])
        # in the order of what is told: sums follow it
        for k in range(known.unknowns):
            at = e.place[shift + k]
            if at == NOWHERE:
                continue
            e.place[shift + k] = NOWHERE
            for i in range(known.first[k], known.first[k] + known.count[k]):
                c = e.entry.at[at]
                column = shift + known.column.at[i]
                meet_product(e, column, c, e.rest.at[at], known.entry.at[i], known.rest.at[i])
                e.lost[column] += math.fabs(c) * known.loss.at[i]
                e.lost[column] += e.loss.at[at] * math.fabs(known.entry.at[i])
        drop_zeros(e)
        e.count[user] = 0
        make_room(e, user, e.width)
        for i in range(e.width):
            k = e.met[i]
            append_entry(e, user, k, e.total[k], e.over[k], e.lost[k])


def is_told(known: Elimination, shift: int, told: Ints, column: int) -> bool:
    """Whether a column is one that is replaced."""
    k = column - shift
    return k >= 0 and k < known.unknowns and told[k] != 0
