"""What settles within a moment of the run: what a storage holds there is what others have it hold.

A picofarad behind a milliohm has the voltage that it is charged to, and the rounding of that,
however far the energy of a whole circuit would lift it; a gram behind a stiff damper has the speed
of what pulls it. Several that are joined settle together: their difference at once, what they have
in common when that has gone elsewhere. So all that hang together are solved for together, in one
implicit step of Euler's over the moment,

    (q - q0) / moment = C S q,

`q` being what they store, `S` their stiffness and `C` what rates have of efforts and flows; with
twice the digits, as their differences settle by many powers of ten faster.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places, grow_places
from hybond.engine.algebra.lu import REGULAR
from hybond.engine.algebra.lu_twofold import lu_factor_twofold, lu_solve_twofold
from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.algebra.twofold import add_part
from hybond.engine.engine import Engine
from hybond.engine.mode.digits.cluster_records import Cluster
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import is_alone, own_stiffness, stiff
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.model import Model
from hybond.engine.words import Floats

MOMENT: Final = 1e-6
"""Part of the run in which what settles has settled: no more than that is seen of it."""
MOST: Final = 256
"""Storages that are solved for together, at the most: more of them count as if none settled."""
SLOW: Final = -1


def find_settling(e: Engine, mode: Mode, v: Floats) -> None:
    """Find which storages settle within a moment, and which of them hang together."""
    m = e.model
    rows = mode.finite
    if mode.never_settles:
        return
    mode.any_settles = False
    linear = True
    for k in range(m.storages):
        times = 0.0
        at = mode.same[rate_bond(m, k)]
        for i in range(rows.first.at[at], rows.first.at[at + 1]):
            if rows.column.at[i] == k:
                rate = way_of_rate(m, k) * rows.value.at[i]
                times -= rate * own_stiffness(m, k, v) * MOMENT * e.span
        settles = times > 1.0 and math.isfinite(times)
        mode.settles_with[k] = k if settles else SLOW
        mode.any_settles = mode.any_settles or settles
        linear = linear and is_alone(m, k)
    if not mode.any_settles:
        mode.never_settles = linear
        return
    take_fields(m, mode)
    for k in range(m.storages):
        at = mode.same[rate_bond(m, k)]
        for i in range(rows.first.at[at], rows.first.at[at + 1]):
            j = rows.column.at[i]
            if j < m.storages and mode.settles_with[k] != SLOW and mode.settles_with[j] != SLOW:
                unite(mode.settles_with, k, j)
    c = e.work.cluster
    for k in range(m.storages):
        c.after.at[k] = SLOW
        if mode.settles_with[k] != SLOW:
            first = first_of(mode.settles_with, k)
            mode.settles_with[k] = first
            if first != k:
                c.after.at[c.last.at[first]] = k
            c.last.at[first] = k


def take_fields(m: Model, mode: Mode) -> None:
    """Let all ports of a field hang together if one of them settles."""
    more = True
    while more:
        more = False
        for k in range(m.storages):
            for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
                j = m.stiff_other[i]
                if mode.settles_with[k] == SLOW and mode.settles_with[j] == SLOW:
                    continue
                more = more or mode.settles_with[k] == SLOW or mode.settles_with[j] == SLOW
                join(mode, k)
                join(mode, j)
                unite(mode.settles_with, k, j)


def join(mode: Mode, k: int) -> None:
    """Let storage k be among those that settle."""
    if mode.settles_with[k] == SLOW:
        mode.settles_with[k] = k


def open_cluster(e: Engine, mode: Mode, c: Cluster, first: int, v: Floats) -> bool:
    """Find the factors of those that settle with storage `first`; False if there are too many.

    After `find_settling` in the same mode.
    """
    m = e.model
    c.many = 0
    k = first
    while k != SLOW:
        grow_places(c.member, c.many + 1)
        c.member.at[c.many] = k
        c.place.at[k] = c.many
        c.many += 1
        k = c.after.at[k]
    n = c.many
    if n > MOST:
        return False
    fit(c.matrix, n * n)
    fit(c.rest, n * n)
    fit_places(c.row, n)
    fit(c.solved, n)
    fit(c.solved_rest, n)
    fit(c.bound, n)
    for i in range(n * n):
        c.matrix.at[i] = 0.0
        c.rest.at[i] = 0.0
    for i in range(n):
        add_part(c.matrix.at, c.rest.at, i * n + i, 1.0, 1.0 / (MOMENT * e.span), 0.0)
        put_row(m, mode, c, i, v)
    return lu_factor_twofold(n, c.matrix.at, c.rest.at, c.row.at) == REGULAR


def put_row(m: Model, mode: Mode, c: Cluster, i: int, v: Floats) -> None:
    """Take what the rate of member i has of what all members store off its row."""
    rows = mode.finite
    n = c.many
    at = mode.same[rate_bond(m, c.member.at[i])]
    way = way_of_rate(m, c.member.at[i])
    for p in range(rows.first.at[at], rows.first.at[at + 1]):
        k = rows.column.at[p]
        if k >= m.storages or mode.settles_with[k] != mode.settles_with[c.member.at[0]]:
            continue
        for q in range(m.stiff_first[k], m.stiff_first[k + 1]):
            to = i * n + c.place.at[m.stiff_other[q]]
            factor = -way * stiff(m, q, v)
            add_part(c.matrix.at, c.rest.at, to, factor, rows.value.at[p], rows.rest.at[p])


def settle_by_one(c: Cluster, j: int) -> bool:
    """Put what a unit of rate at member j has all store into `c.solved`; False if no numbers."""
    for i in range(c.many):
        c.solved.at[i] = 1.0 if i == j else 0.0
        c.solved_rest.at[i] = 0.0
    lu_solve_twofold(c.many, c.matrix.at, c.rest.at, c.row.at, c.solved.at, c.solved_rest.at)
    finite = True
    for i in range(c.many):
        finite = finite and math.isfinite(c.solved.at[i])
    return finite


def bound_settling(e: Engine, mode: Mode, reach: Floats, v: Floats) -> None:
    """Let what settles be no more than what it settles to.

    `reach` has how large the effort or flow of each storage may be, in the same measure.
    """
    m = e.model
    c = e.work.cluster
    for first in range(m.storages if mode.any_settles else 0):
        if mode.settles_with[first] != first or not open_cluster(e, mode, c, first, v):
            continue
        for i in range(c.many):
            c.bound.at[i] = 0.0
        finite = True
        for j in range(c.many):
            k = c.member.at[j]
            own = math.fabs(own_stiffness(m, k, v))
            finite = finite and own > 0.0 and settle_by_one(c, j)
            if not finite:
                break
            given = reach[k] / (own * MOMENT * e.span) + from_slow(m, mode, c, j, reach)
            for i in range(c.many):
                c.bound.at[i] += math.fabs(settled_effort(m, c, i, v)) * given
        for i in range(c.many if finite else 0):
            reach[c.member.at[i]] = min(reach[c.member.at[i]], c.bound.at[i])


def settled_effort(m: Model, c: Cluster, i: int, v: Floats) -> float:
    """Return the effort or flow of member i, of what is stored in `c.solved`."""
    k = c.member.at[i]
    total = 0.0
    for q in range(m.stiff_first[k], m.stiff_first[k + 1]):
        total += stiff(m, q, v) * c.solved.at[c.place.at[m.stiff_other[q]]]
    return total


def from_slow(m: Model, mode: Mode, c: Cluster, j: int, reach: Floats) -> float:
    """Return what the rate of member j has at the most of storages that do not settle."""
    rows = mode.finite
    at = mode.same[rate_bond(m, c.member.at[j])]
    total = 0.0
    for p in range(rows.first.at[at], rows.first.at[at + 1]):
        k = rows.column.at[p]
        if k < m.storages and mode.settles_with[k] == SLOW:
            total += math.fabs(rows.value.at[p]) * reach[k]
    return total
