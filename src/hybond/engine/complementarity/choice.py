"""One unknown of each pair, and all free ones, that can be solved for.

Source: J. Edmonds, *Submodular functions, matroids, and certain polyhedra*, 1970 (the augmenting
path).
"""

import math

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.complementarity.pivoting import REGULAR_PIVOT
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Choice:
    """Room to choose among `wide` columns of a matrix of up to `rows` rows.

    `owner` is the column that each row was solved for, -1 for none; `waiting` says which columns
    may still be chosen.
    """

    table: Floats
    owner: Ints
    waiting: Ints
    line: Floats
    column: Floats
    queue: Ints
    came: Ints
    by: Ints
    step_row: Ints
    step_column: Ints
    steps: int


def make_choice(rows: int, wide: int) -> Choice:
    """Return room for such matrices."""
    c = Choice()
    c.table = floats(rows * wide)
    c.owner = ints(rows)
    c.waiting = ints(wide)
    c.line = floats(wide)
    c.column = floats(rows)
    c.queue = ints(rows)
    c.came = ints(rows)
    c.by = ints(rows)
    c.step_row = ints(rows + 1)
    c.step_column = ints(rows + 1)
    return c


def complementary_basis(c: Choice, rows: int, wide: int, pairs: int, w: Floats) -> bool:
    """Choose one column of each pair (k, pairs + k), and all later ones, that are independent.

    The columns are in `c.owner`; False if no such choice exists. The largest entry is the pivot and
    takes its pair out; where nothing is left, chosen columns are exchanged for their partners.
    """
    copy_floats(rows * wide, w, c.table)
    for i in range(rows):
        c.owner[i] = -1
    for j in range(wide):
        c.waiting[j] = 1
    for phase in range(2):
        first = 2 * pairs if phase == 0 else 0
        until = wide if phase == 0 else 2 * pairs
        while any_waiting(c, first, until):
            most = -1.0
            r = 0
            best = 0
            for i in range(rows):
                if c.owner[i] < 0:
                    for j in range(first, until):
                        size = math.fabs(c.table[i * wide + j])
                        if c.waiting[j] != 0 and size > most:
                            most = size
                            r = i
                            best = j
            c.steps = 0
            if most > REGULAR_PIVOT:
                c.step_row[0] = r
                c.step_column[0] = best
                c.steps = 1
            elif phase == 1:
                augmenting_path(c, rows, wide, pairs)
            if c.steps == 0:
                return False
            for k in range(c.steps):
                take_column(c, rows, wide, pairs, c.step_row[k], c.step_column[k])
    return True


def any_waiting(c: Choice, first: int, until: int) -> bool:
    """Whether one of these columns may still be chosen."""
    j = first
    while j < until and c.waiting[j] == 0:
        j += 1
    return j < until


def take_column(c: Choice, rows: int, wide: int, pairs: int, r: int, column: int) -> None:
    """Solve row r for a column, and take its pair out."""
    c.waiting[column] = 0
    if column < 2 * pairs:
        partner = (column + pairs) % (2 * pairs)
        for i in range(rows):
            if c.owner[i] == partner:
                c.owner[i] = -1
        c.waiting[partner] = 0
    pivot = c.table[r * wide + column]
    for j in range(wide):
        c.line[j] = c.table[r * wide + j] / pivot
    for i in range(rows):
        c.column[i] = c.table[i * wide + column]
    for i in range(rows):
        factor = c.column[i]
        for j in range(wide):
            c.table[i * wide + j] -= factor * c.line[j]
    copy_part(wide, c.line, 0, c.table, r * wide)
    c.owner[r] = column


def augmenting_path(c: Choice, rows: int, wide: int, pairs: int) -> None:
    """Find the pivots that free a row for a waiting column; none if there are none."""
    count = 0
    for i in range(rows):
        c.came[i] = -2
        if c.owner[i] < 0:
            c.came[i] = -1
            c.queue[count] = i
            count += 1
    at = 0
    while at < count:
        r = c.queue[at]
        at += 1
        last = -1
        most = REGULAR_PIVOT
        for j in range(2 * pairs):
            size = math.fabs(c.table[r * wide + j])
            if c.waiting[j] != 0 and size > most:
                most = size
                last = j
        if last >= 0:
            note_steps(c, r, last)
            return
        for other in range(rows):
            chosen = c.owner[other]
            if c.came[other] == -2 and chosen >= 0 and chosen < 2 * pairs:
                partner = (chosen + pairs) % (2 * pairs)
                if math.fabs(c.table[r * wide + partner]) > REGULAR_PIVOT:
                    c.came[other] = r
                    c.by[other] = partner
                    c.queue[count] = other
                    count += 1


def note_steps(c: Choice, r: int, last: int) -> None:
    """Put the pivots that lead to row r in order, the first one first."""
    count = 1
    row = r
    while c.came[row] >= 0:
        count += 1
        row = c.came[row]
    c.steps = count
    c.step_row[count - 1] = r
    c.step_column[count - 1] = last
    row = r
    k = count - 2
    while c.came[row] >= 0:
        c.step_row[k] = c.came[row]
        c.step_column[k] = c.by[row]
        row = c.came[row]
        k -= 1
