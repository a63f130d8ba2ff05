"""Rows under elimination: what is known of each, and room for them."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Block, Places, make_block, make_places
from hybond.engine.words import Floats, Ints, floats, ints, record

SMALLEST: Final = 4
"""Entries that a row has room for at the least."""
NOWHERE: Final = -1
"""No entry, or the end of a list."""


@record
class Elimination:
    """Unknown columns come first, knowns after them.

    Row k says ``unknown k + sum = 0`` where ``solved[k]``: the sum of the entries ``first[k] <= i <
    first[k] + count[k]`` of `column` and `entry`, each column once. Rows that need more room move
    to the end.
    """

    unknowns: int
    columns: int
    """How many there are, unknowns and knowns."""
    furnished: bool
    """Whether there is room for rows: what only repeats others, or is never asked, has none."""
    same: Ints
    """The first of the unknowns that each one is equal to."""
    solved: Ints
    order: Ints
    """The unknowns that are solved, in the order in which they were."""
    done: int
    first: Ints
    count: Ints
    room: Ints
    """How many entries there is room for in each row."""
    end: int
    """Where the next row goes."""
    column: Places
    entry: Block
    rest: Block
    """By what each entry is more than it was rounded to: rows have twice the digits of a number."""
    loss: Block
    """At least the size of the entry: rounding has moved it by no more than some units of this."""
    one_drift: Block
    """How far the entry moves if what is given moves one way, and another one."""
    other_drift: Block
    read: Ints
    """Whether a bent law reads an unknown: it is left free where others can be solved for. Newton's
    method finds it to its last digit then, and where it is zero it is; a difference of others has
    the sign of their rounding."""
    last: Ints
    """Whether an unknown is in one row alone, which it ends: the force of a source of flow. Solved
    for there it takes the terms of all others, and they keep their digits."""
    weight: Floats
    """How large each unknown is known to be; 1 where nothing is known. Of a row the largest of its
    terms is solved for: what is a sum of them then is no small difference of large ones."""
    used: Ints
    """In how many rows each free unknown is."""
    user: Ints
    """Of each unknown: the first of a list of rows that it is in, or was."""
    cells: int
    cell_row: Places
    cell_next: Places
    least: float
    doubted: bool
    """Whether a sum was taken for rounding of what is given; twice the digits do not make it so."""
    # a row under way
    total: Floats
    over: Floats
    """By what each total is more than it was rounded to."""
    size: Floats
    lost: Floats
    one_off: Floats
    """How far each total moves if what is given moves one way, and another one."""
    other_off: Floats
    met: Ints
    mark: Ints
    width: int
    place: Ints
    """Of the columns of one row: where they stand, elsewhere NOWHERE."""
    # the row to be added, column by column
    given: int
    given_column: Ints
    given_value: Floats


def make_elimination(unknowns: int, columns: int) -> Elimination:
    """Return an elimination of so many unknowns and columns; room for rows is made at need."""
    e = Elimination()
    e.unknowns = unknowns
    e.columns = columns
    e.same = ints(unknowns)
    e.solved = ints(unknowns)
    e.order = ints(unknowns)
    e.first = ints(unknowns)
    e.count = ints(unknowns)
    e.room = ints(unknowns)
    e.column = make_places(1)
    e.entry = make_block(1)
    e.rest = make_block(1)
    e.loss = make_block(1)
    e.one_drift = make_block(1)
    e.other_drift = make_block(1)
    e.read = ints(unknowns)
    e.last = ints(unknowns)
    e.weight = floats(unknowns)
    for k in range(unknowns):
        e.weight[k] = 1.0
    e.used = ints(unknowns)
    e.user = ints(unknowns)
    e.cell_row = make_places(1)
    e.cell_next = make_places(1)
    forget_rows_of(e)
    return e


def furnish(e: Elimination) -> None:
    """Make the room that adding rows takes."""
    e.furnished = True
    many = SMALLEST * e.unknowns
    e.column = make_places(many)
    e.entry = make_block(many)
    e.rest = make_block(many)
    e.loss = make_block(many)
    e.one_drift = make_block(many)
    e.other_drift = make_block(many)
    e.cell_row = make_places(many)
    e.cell_next = make_places(many)
    e.total = floats(e.columns)
    e.over = floats(e.columns)
    e.size = floats(e.columns)
    e.lost = floats(e.columns)
    e.one_off = floats(e.columns)
    e.other_off = floats(e.columns)
    e.met = ints(e.columns)
    e.mark = ints(e.columns)
    e.place = ints(e.columns)
    for k in range(e.columns):
        e.place[k] = NOWHERE
    e.given_column = ints(e.columns)
    e.given_value = floats(e.columns)


def begin_elimination(e: Elimination) -> None:
    """Forget all rows, and which unknowns are equal."""
    if not e.furnished:
        furnish(e)
    forget_rows_of(e)


def forget_rows_of(e: Elimination) -> None:
    """Be as if no row had been added."""
    e.done = 0
    e.least = 1.0
    e.doubted = False
    e.given = 0
    e.end = 0
    e.cells = 0
    for k in range(e.unknowns):
        e.same[k] = k
        e.solved[k] = 0
        e.used[k] = 0
        e.count[k] = 0
        e.room[k] = 0
        e.user[k] = NOWHERE
