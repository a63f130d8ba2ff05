"""Idle laws beside others that carry: all that may carry the same do so, in the least shares.

An answer of the laws is a corner of what they may do: of two diodes in parallel one has all of the
current, and which one depends on nothing but their order. So what the answer may be moved by is
looked for: values that some conducting laws may give away and idle ones beside them may take, while
what is stored moves as it did, what blocks lets nothing through and what conducts holds nothing.
Of these answers the one of least leakage is taken, no law giving less than nothing: equal parts
take equal shares, whatever they are called and in whichever order they are declared. Laws that
have a share there are ON, the others OFF, and the mode then leaves open how they share.

What a closed switch or a wire carries is not asked for: a diode beside it carries nothing.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, SHUT
from hybond.engine.engine import Engine, svd_room
from hybond.engine.laws.law_records import Laws
from hybond.engine.mode.freedom import directions_left
from hybond.engine.mode.tableau import COMMON
from hybond.engine.timestepping.step_shares import least_shares
from hybond.engine.words import Floats

RESIDUE: Final = 1e-12
"""Part of its terms up to which a difference of two solutions is nothing but rounding."""


def find_shares(e: Engine, r: Laws, q: Floats, h: float, jump: bool) -> bool:
    """Put the answer there in which all that may carry do: ``r.branch``; False if it is the one.

    ``r.shares`` says of which laws that decides. `q` and `h` are what the laws were asked with.
    """
    n = e.model.ports
    idle = False
    for k in range(n):
        r.shares[k] = 0
        r.branch[k] = r.answer[k]
        idle = idle or (r.answer_open[k] != 0 and r.role[k] == ONE_SIDED)
    if not idle:
        return False
    many = find_moves(e, r)
    if many == 0:
        return False
    put_moves(e, r, many, q, h, jump)
    if not least_shares(svd_room(e, 2 * n, 2 * n), 2 * n, many, 0, r.room):
        return False
    changed = False
    x = r.room
    for k in range(n):
        if r.role[k] != ONE_SIDED or (x.open.at[k] == 0 and x.open.at[n + k] == 0):
            continue
        r.shares[k] = 1
        r.branch[k] = 1 if x.values.at[common_at(r, k, n)] > 0.0 else 0
        changed = changed or (r.branch[k] != 0 and r.answer_open[k] != 0)
    return changed


def common_at(r: Laws, k: int, n: int) -> int:
    """Return where the common variable of a port stands among all `l` and all `w`."""
    return k if r.now.given[k] == COMMON else n + k


def may_move(r: Laws, k: int) -> bool:
    """Whether the `l` of a port may differ between answers in which it does what it does."""
    if r.role[k] == ONE_SIDED:
        carries = r.answer[k] != 0 or r.answer_open[k] != 0
        return carries == (r.now.given[k] == COMMON)
    return r.role[k] == SHUT


def stays(r: Laws, k: int) -> bool:
    """Whether the `w` of a port is the same in all answers in which it does what it does."""
    return may_move(r, k) or (r.role[k] != ONE_SIDED and r.role[k] != CUT)


def find_moves(e: Engine, r: Laws) -> int:
    """Find what the answer may be moved by, into ``r.room.onto``; return in how many ways.

    Each is a column with a row for every `l` in ``r.tried``, whose number is ``r.many_tried``.
    """
    m = e.model
    n = m.ports
    x = r.room
    many = 0
    for k in range(n):
        if may_move(r, k):
            r.tried[many] = k
            many += 1
    r.many_tried = many
    if many == 0:
        return 0
    fit(x.rows, (2 * n + m.storages) * many)
    rows = 0
    for k in range(n):
        if stays(r, k):
            rows += put_row(r, rows, k, n, r.response.d, rounding_of(r, r.response.size[k]))
            rows += put_row(r, rows, k, n, r.response.ce, 0.0)
    for s in range(m.storages):
        rows += put_row(r, rows, s, n, r.response.e, rounding_of(r, r.field[s]))
    fit(x.onto, many * many)
    return directions_left(e, rows, many, x.rows.at, x.onto.at)


def rounding_of(r: Laws, size: float) -> float:
    """Return what is rounding beside a value: the gains of a nonlinear graph are differences."""
    return 0.0 if r.now.linear else RESIDUE * math.fabs(size)


def put_row(r: Laws, row: int, at: int, n: int, a: Floats, least: float) -> int:
    """Put a row of `a` there, of the `l` in ``r.tried``; return 1, or 0 if it is zero."""
    many = r.many_tried
    out = r.room.rows.at
    found = 0
    for i in range(many):
        entry = a[at * n + r.tried[i]]
        out[row * many + i] = entry if math.fabs(entry) > least else 0.0
        if out[row * many + i] != 0.0:
            found = 1
    return found


def put_moves(e: Engine, r: Laws, many: int, q: Floats, h: float, jump: bool) -> None:
    """Put the answer, what it may be moved by, and bounds of that where shares are looked for.

    What no move changes is zero there: it is no measure of what is shared.
    """
    n = e.model.ports
    a = r.response
    x = r.room
    fit(x.basis, 2 * n * many)
    fit(x.values, 2 * n)
    fit(x.low, 2 * n)
    fit(x.high, 2 * n)
    for i in range(2 * n * many):
        x.basis.at[i] = 0.0
    for i in range(r.many_tried):
        for j in range(many):
            x.basis.at[r.tried[i] * many + j] = x.onto.at[i * many + j]
    for k in range(n):
        # what is given moves as it is given, and what follows by what is fed through
        x.values.at[k] = r.answer_l[k]
        w = q[k]
        for i in range(n):
            w += (a.d[k * n + i] + h * a.ce[k * n + i]) * r.answer_l[i]
        x.values.at[n + k] = w
        for j in range(many if not stays(r, k) else 0):
            total = 0.0
            size = 0.0
            for i in range(n):
                term = a.d[k * n + i] * x.basis.at[i * many + j]
                total += term
                size += math.fabs(term)
            x.basis.at[(n + k) * many + j] = total if math.fabs(total) > 1e-9 * size else 0.0
    for i in range(2 * n):
        k = i if i < n else i - n
        moves = False
        for j in range(many):
            moves = moves or x.basis.at[i * many + j] != 0.0
        x.low.at[i] = 0.0
        x.high.at[i] = math.inf if moves else 0.0
        if not moves:
            x.values.at[i] = 0.0
        elif r.role[k] == SHUT or r.role[k] == CUT:
            x.low.at[i] = -math.inf
        else:
            x.values.at[i] = max(x.values.at[i], 0.0)
