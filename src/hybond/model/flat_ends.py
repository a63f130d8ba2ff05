"""Which laws need their flat ends as constraints: structure says so, before any run.

A law ``f(e)`` that is flat where it ends says nothing of the effort there. Where the rest of the
model gives the effort, nothing is lacking. But where what is stored gives the flow, in some mode,
the effort is found from the law turned round, and at its flat end from nothing: there the end is
an end stop. So a law needs its ends as constraints if some flows and efforts that are given, that
of the resistor among them as if it were a source, have a relation that a storage takes part in.

All modes are looked at in one: what a controlled junction gives in some mode, zero flow or zero
effort, may take part in a relation. So whether a relation is one of a mode that is never entered
is not asked: there are few, and ends that are not needed do no harm. In a relation of the
smallest kind everything takes part, and who does with whom is an equivalence (the components of a
matroid): one elimination finds all.
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Collection, Sequence

from hybond.model.expressions.slots import plain
from hybond.model.graph import Bond, Node
from hybond.model.junction_structure import Row, junction_rows, two_port_rows
from hybond.model.kinds import RESISTORS, STORAGES, TWO_PORTS

ROUNDING = 1e-9
"""Part of the largest coefficient of a row below which one is rounding."""
USABLE = 0.1
"""Part of it from which on one may be divided by."""


def needing_ends(
    nodes: Sequence[Node], bonds: Sequence[Bond], candidates: Sequence[int]
) -> list[int]:
    """Return those of the resistors whose laws need their ends as constraints.

    Parameters
    ----------
    candidates : sequence of int
        Nodes of resistors with one port whose laws have flat ends.
    """
    if not candidates:
        return []
    many = len(bonds)
    given: set[int] = set()
    stored: set[int] = set()
    rows: list[Row] = []
    extra = 2 * many
    for node in nodes:
        if node.is_junction:
            own = junction_rows(node, many, off=False)
            if node.controlled and own:
                # while it is OFF its common variable is zero, while it is ON its net one
                own[-1][extra] = -1.0
                common = 0 if node.kind == "0" else many
                given.add(extra)
                given.update(common + end.bond for end in node.ends)
                extra += 1
            rows += own
        elif node.kind in TWO_PORTS:
            if node.controlled:
                given.update(k + end.bond for end in node.ends for k in (0, many))
            rows += two_port_rows(node, _modulus(node), many)
        elif node.kind in RESISTORS:
            matrix = node.law.matrix if node.law is not None else None
            if matrix is not None and len(node.ends) == 1 and plain(matrix[0][0]) == 0.0:
                given.add(_output(node, many))
        elif node.about.imposes is not None:
            first = 0 if node.about.imposes == "e" else many
            imposed = [first + end.bond for end in node.ends]
            given.update(imposed)
            if node.kind in STORAGES:
                stored.update(imposed)
    ends = {k: _output(nodes[k], many) for k in candidates}
    given.update(ends.values())
    groups = _related(rows, given)
    # a variable that two give is a relation of these two
    stores = {groups[k] for k in stored if k in groups}
    return [k for k, at in ends.items() if at in stored or groups.get(at) in stores]


def _output(node: Node, bonds: int) -> int:
    """Return the variable that the law of a resistor gives."""
    assert node.law is not None
    return (0 if node.law.output == "e" else bonds) + node.ends[0].bond


def _related(rows: list[Row], given: Collection[int]) -> dict[int, int]:
    """Return for each given variable that has a relation with others a number of its group."""
    rows = _among(rows, given)
    often = Counter(k for row in rows for k in row)
    solved: dict[int, Row] = {}
    users: dict[int, set[int]] = {}
    for row in rows:
        for column in [k for k in row if k in solved]:
            _subtract(row, solved[column], column)
        if not row:
            continue
        # what few rows have is found from the others without making many of these longer
        large = max(map(abs, row.values()))
        usable = (k for k, c in row.items() if abs(c) >= USABLE * large)
        pivot = min(usable, key=lambda k: (often[k], k))
        for other in sorted(users.pop(pivot, ())):
            before = set(solved[other])
            _subtract(solved[other], row, pivot)
            _move_user(users, other, before, set(solved[other]))
        solved[pivot] = row
        _move_user(users, pivot, set(), set(row))
    groups: dict[int, int] = {}
    members: dict[int, set[int]] = {}
    for pivot, row in solved.items():
        if len(row) > 1:
            met = {groups[k] for k in row if k in groups}
            into = max(met, key=lambda group: len(members[group]), default=pivot)
            new = set(row).union(*(members.pop(group) for group in met if group != into))
            members.setdefault(into, set()).update(new)
            groups.update(dict.fromkeys(new, into))
    return groups


def _among(rows: list[Row], given: Collection[int]) -> list[Row]:
    """Return what rows say of the given variables alone: all others are eliminated."""
    alive = {k: dict(row) for k, row in enumerate(rows)}
    users: dict[int, set[int]] = {}
    for k, row in alive.items():
        for column in row:
            if column not in given:
                users.setdefault(column, set()).add(k)
    waiting = [(len(own), column) for column, own in users.items()]
    heapq.heapify(waiting)
    while waiting:
        many, column = heapq.heappop(waiting)
        own = users[column]
        if len(own) != many:
            if own:
                heapq.heappush(waiting, (len(own), column))
            continue
        large = max(abs(alive[k][column]) for k in own)
        usable = [k for k in own if abs(alive[k][column]) >= USABLE * large]
        pivot = min(usable, key=lambda k: (len(alive[k]), k))
        row = alive.pop(pivot)
        for k in row:
            if k not in given:
                users[k].discard(pivot)
        for other in sorted(own):
            before = alive[other].keys() - given
            _subtract(alive[other], row, column)
            _move_user(users, other, before, alive[other].keys() - given)
    return list(alive.values())


def _move_user(users: dict[int, set[int]], row: int, before: set[int], after: set[int]) -> None:
    """Note which columns a row has that had others before."""
    for k in before - after:
        if k in users:
            users[k].discard(row)
    for k in after - before:
        users.setdefault(k, set()).add(row)


def _subtract(row: Row, other: Row, column: int) -> None:
    """Take so much of another row from one that a variable goes."""
    factor = row[column] / other[column]
    size = max(map(abs, row.values()))
    for k, c in other.items():
        new = row.get(k, 0.0) - factor * c
        if k == column or abs(new) <= ROUNDING * max(size, abs(factor * c)):
            row.pop(k, None)
        else:
            row[k] = new


def _modulus(node: Node) -> float:
    """Return a number for a modulus: its own, or one that no other has where it varies."""
    law = node.law
    if law is not None and law.matrix is not None:
        return plain(law.matrix[0][0])
    from random import Random

    return Random(node.index).uniform(0.5, 2.0)
