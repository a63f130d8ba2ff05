"""What a mode keeps of an elimination: rows by what is known, and what free unknowns give."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Rows,
    fit,
    fit_places,
    fit_rows,
    grow_block,
    grow_places,
)
from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.elimination import is_free
from hybond.engine.mode.rows.elimination_records import NOWHERE, Elimination
from hybond.engine.mode.rows.tableau import NOT_OPEN
from hybond.engine.model import Model
from hybond.engine.words import Ints

LONG: Final = 32
"""Entries from which on it is worth its while to find rows that are equal to the last bit."""
LOST: Final = 0.02
"""Units of rounding that elimination may lose, against those that a comparison lets pass: eight
of 2.2e-16, against 1e-13 of the terms."""
MOVED: Final = 16.0
"""How far an entry moves with what is given, against how far it does along one of two directions
that are drawn at random."""
TWICE: Final = 2.0**-48
"""Part of what is lost that is lost by rows with twice the digits as well."""


def free_columns(x: Elimination, column: Ints) -> int:
    """Put the free unknowns of an elimination there and return how many they are."""
    many = 0
    for k in range(x.unknowns):
        if is_free(x, k):
            column[many] = k
            many += 1
    return many


def share_rows(m: Model, x: Elimination, mode: Mode) -> None:
    """Let the bonds of a controlled junction that is ON share a row if it is the same and long.

    Such rows are as long as a bus has branches, in each branch.
    """
    for j in range(m.junctions):
        switch = m.junction_switch[j]
        if switch < 0 or mode.on[switch] == 0 or mode.given[j] != NOT_OPEN:
            continue
        common = 0 if m.junction_kind[j] == 0 else m.bonds
        for i in range(m.end_first[j], m.end_first[j + 1] - 1):
            one = first_of(mode.same, common + m.end_bond[i])
            other = first_of(mode.same, common + m.end_bond[i + 1])
            if one != other and x.count[one] >= LONG and is_same_row(x, one, other):
                unite(mode.same, one, other)
    for k in range(2 * m.bonds):
        mode.same[k] = first_of(mode.same, k)


def is_same_row(x: Elimination, one: int, other: int) -> bool:
    """Whether two unknowns have one row, to the last bit."""
    if x.count[one] != x.count[other]:
        return False
    a = x.first[one]
    b = x.first[other]
    for i in range(x.count[one]):
        if x.column.at[a + i] != x.column.at[b + i]:
            return False
        if x.entry.at[a + i] != x.entry.at[b + i] or x.rest.at[a + i] != x.rest.at[b + i]:
            return False
        if row_term_size(x, a + i) != row_term_size(x, b + i):
            return False
    return True


def row_term_size(x: Elimination, i: int) -> float:
    """Return what rounding of an entry is measured by.

    Rows have twice the digits of a number: what an entry has lost on the way is what rounding of
    the given numbers makes of it, and no more than that. A current that is found as a difference
    of others a million times as large, by the order in which bonds are declared, has all its digits
    if it is that of its own resistor.
    """
    lost = x.loss.at[i]
    moved = MOVED * max(math.fabs(x.one_drift.at[i]), math.fabs(x.other_drift.at[i]))
    return max(math.fabs(x.entry.at[i]), LOST * min(lost, moved + TWICE * lost))


def known_entries(x: Elimination, same: Ints) -> int:
    """Return how many entries there are in known columns, where equal unknowns share a row."""
    entries = 0
    free = False
    for k in range(x.unknowns):
        free = free or is_free(x, k)
        if same[k] == k:
            entries += x.count[k]
    for k in range(x.unknowns if free else 0):
        for i in range(x.first[k], x.first[k] + (x.count[k] if same[k] == k else 0)):
            entries -= 1 if x.column.at[i] < x.unknowns else 0
    return entries


def take_rows(x: Elimination, knowns: int, same: Ints, rows: Rows) -> None:
    """Take what knowns give to each bond variable; equal ones share the row of the first."""
    n = x.unknowns
    fit_rows(rows, n, known_entries(x, same))
    entries = 0
    for k in range(n):
        rows.first.at[k] = entries
        if x.solved[k] == 0 or same[k] != k:
            continue
        begin = entries
        for i in range(x.first[k], x.first[k] + x.count[k]):
            j = x.column.at[i] - n
            if j < 0 or j >= knowns:
                continue
            # in the order of knowns, which sums follow
            at = entries
            while at > begin and rows.column.at[at - 1] > j:
                rows.column.at[at] = rows.column.at[at - 1]
                rows.value.at[at] = rows.value.at[at - 1]
                rows.size.at[at] = rows.size.at[at - 1]
                rows.rest.at[at] = rows.rest.at[at - 1]
                at -= 1
            rows.column.at[at] = j
            rows.value.at[at] = -x.entry.at[i]
            rows.rest.at[at] = -x.rest.at[i]
            rows.size.at[at] = row_term_size(x, i)
            entries += 1
    rows.first.at[n] = entries


def take_free(x: Elimination, frees: int, column: Ints, block: Block) -> None:
    """Take what free unknowns give to each bond variable."""
    fit(block, x.unknowns * frees)
    for j in range(frees):
        x.place[column[j]] = j
    for k in range(x.unknowns if frees > 0 else 0):
        row = x.same[k]
        at = k * frees
        for j in range(frees):
            block.at[at + j] = 0.0
        for i in range(x.first[row], x.first[row] + x.count[row]):
            j = x.place[x.column.at[i]]
            if j != NOWHERE:
                block.at[at + j] = -x.entry.at[i]
        if x.place[row] != NOWHERE:
            block.at[at + x.place[row]] = 1.0
    for j in range(frees):
        x.place[column[j]] = NOWHERE


def list_shares(mode: Mode, n: int) -> None:
    """List which free unknowns have part in each of n bond variables."""
    frees = mode.finite_frees
    if frees == 0:
        return
    many = 0
    for i in range(n * frees):
        many += 1 if mode.finite_free.at[i] != 0.0 else 0
    fit_places(mode.share_first, n + 1)
    fit_places(mode.share_of, many)
    many = 0
    for k in range(n):
        mode.share_first.at[k] = many
        for j in range(frees):
            if mode.finite_free.at[k * frees + j] != 0.0:
                mode.share_of.at[many] = j
                many += 1
    mode.share_first.at[n] = many


def take_free_rows(x: Elimination, frees: int, column: Ints, rows: Rows) -> None:
    """Take the same as sparse rows."""
    for j in range(frees):
        x.place[column[j]] = j
    fit_rows(rows, x.unknowns, 0)
    entries = 0
    for k in range(x.unknowns):
        rows.first.at[k] = entries
        row = x.same[k]
        if x.place[row] != NOWHERE:
            put_entry(rows, entries, x.place[row], 1.0)
            entries += 1
        for i in range(x.first[row], x.first[row] + x.count[row]):
            j = x.place[x.column.at[i]]
            if j != NOWHERE:
                put_entry(rows, entries, j, -x.entry.at[i])
                entries += 1
    rows.first.at[x.unknowns] = entries
    for j in range(frees):
        x.place[column[j]] = NOWHERE


def put_entry(rows: Rows, at: int, column: int, value: float) -> None:
    """Put an entry behind all others; what it is measured by, nobody asks."""
    grow_places(rows.column, at + 1)
    grow_block(rows.value, at + 1)
    rows.column.at[at] = column
    rows.value.at[at] = value


def take_free_rest(x: Elimination, mode: Mode) -> None:
    """Take by what these are more than they were rounded to."""
    frees = mode.finite_frees
    fit(mode.free_rest, x.unknowns * frees)
    for j in range(frees):
        x.place[mode.free_column[j]] = j
    for k in range(x.unknowns if frees > 0 else 0):
        for j in range(frees):
            mode.free_rest.at[k * frees + j] = 0.0
        row = x.same[k]
        for i in range(x.first[row], x.first[row] + x.count[row]):
            j = x.place[x.column.at[i]]
            if j != NOWHERE:
                mode.free_rest.at[k * frees + j] = -x.rest.at[i]
    for j in range(frees):
        x.place[mode.free_column[j]] = NOWHERE
