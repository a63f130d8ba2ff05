"""What the laws of a step leave open, and the shares that least leakage then decides."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.lu import SINGULAR, lu_invert
from hybond.engine.algebra.products import column_norm, copy_floats, copy_part
from hybond.engine.algebra.scaling import balance
from hybond.engine.algebra.svd import Svd, null_space
from hybond.engine.answers import value
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, SHUT, TWO_SIDED
from hybond.engine.complementarity.least_shares import (
    MOVES_PART,
    SAME_SHARE,
    cleared,
    least_shares,
    leave_still,
)
from hybond.engine.engine import OK, REFUSED, Engine, svd_room
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import open_mode, solve_with
from hybond.engine.laws.response import couple, find_gains
from hybond.engine.mode.mode_records import Mode
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Coupled, Stepping
from hybond.engine.words import Floats, Ints

REGULAR_ENOUGH: Final = 1e9
"""Condition up to which a balanced matrix is clearly not singular."""
NOTHING_PART: Final = 1e-10
"""Part of a balanced matrix that counts as nothing."""


def room_for(e: Engine) -> Svd:
    """Return room for the decompositions that shares ask for."""
    m = e.model
    rows = max(max(2 * m.ports, e.states), m.junctions + 1)
    return svd_room(e, rows, 2 * m.ports)


def find_still(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Find the `l` that may differ between two solutions: columns of ``c.basis``, mostly none.

    Those that no power is spent on, for a passive graph; elsewhere those that change no `w`. They
    leave what is stored alone.
    """
    n = e.model.ports
    a = s.shares
    c.still = 0
    c.moves = c.semidefinite > 0
    if n == 0:
        return OK
    # units apart: efforts and flows are of very different sizes
    balance(n, c.m.at, s.scale, s.down)
    fit(a.seen, n * n)
    fit(a.square, n * n)
    fit(s.square, n * n)
    put_power(n, c.m.at, c.semidefinite > 0, s)
    if is_regular(n, a.seen.at, s.square.at, s.row, a.square.at):
        if c.straight or c.semidefinite == 0:
            return OK
        put_power(n, c.m.at, False, s)
        if is_regular(n, a.seen.at, s.square.at, s.row, a.square.at):
            return OK
    if not c.straight:
        if see_both_sides(e, s, p) != OK:
            return REFUSED
        put_power(n, a.flows.at, c.semidefinite > 0, s)
    fit(c.basis, n * n)
    room = room_for(e)
    many = null_space(room, n, n, a.seen.at, NOTHING_PART, c.basis.at)
    for j in range(many):
        most = 0.0
        for k in range(n):
            c.basis.at[k * many + j] *= s.scale[k]
            most = max(most, math.fabs(c.basis.at[k * many + j]))
        for k in range(n):
            c.basis.at[k * many + j] /= most if most > 0.0 else 1.0
    if many > 0 and c.straight:
        many = leave_still(room, c.n, n, many, c.push.at, c.basis, a)
    elif many > 0:
        many = leave_still(room, e.states, n, many, a.rows.at, c.basis, a)
        fit(a.seen, n * max(many, 1))
        c.moves = c.moves and cleared(n, n, many, a.flows.at, c.basis.at, a.seen.at) > 0
    c.still = many
    return OK


def put_power(n: int, m: Floats, passive: bool, s: Stepping) -> None:
    """Put there what a share makes nothing of: rows of ``m + m'`` if `passive`, else of `m`."""
    for i in range(n):
        for j in range(n):
            own = m[i * n + j]
            if passive:
                own += m[j * n + i]
            s.shares.seen.at[i * n + j] = own * s.scale[i] * s.scale[j]
            s.square.at[i * n + j] = s.shares.seen.at[i * n + j]


def see_both_sides(e: Engine, s: Stepping, p: Ports) -> int:
    """Put how ports push what is stored into ``rows``, and each other beside it into ``flows``.

    The matrix of a step is one after the other. A modulus that moves within the step sends forces
    by what it is and gives back velocities by what it becomes, so that the matrix is not quite that
    of a passive graph any more, but each side is what it was.
    """
    m = e.model
    n = m.ports
    a = s.shares
    fit(a.kept, 2 * m.bonds * n)
    fit(a.flows, n * n)
    fit(a.rows, max(e.states, 1) * n)
    if find_gains(e, e.laws, p, s.v1, a.kept.at) != OK:
        return REFUSED
    couple(m, p, a.kept.at, a.flows.at, a.rows.at)
    return push_integrals(e, s, p)


def push_integrals(e: Engine, s: Stepping, p: Ports) -> int:
    """Put what ports add to rates of integrated signals into ``rows``, behind what is stored."""
    m = e.model
    n = m.ports
    if m.integrals == 0:
        return OK
    kept = e.laws.kept
    copy_floats(2 * m.slots, s.v1, kept)
    for k in range(n):
        s.wl[k] = 0.0
    if solve_with(e, p, s.v1, s.wl) != OK:
        return REFUSED
    for k in range(m.integrals):
        s.rate_l[k] = value(m, m.integral_rate[k], s.v1)
    for j in range(n):
        s.wl[j] = s.unit[j]
        if solve_with(e, p, s.v1, s.wl) != OK:
            return REFUSED
        s.wl[j] = 0.0
        for k in range(m.integrals):
            rate = value(m, m.integral_rate[k], s.v1)
            pushed = rate - s.rate_l[k]
            still = math.fabs(pushed) <= MOVES_PART * (math.fabs(rate) + math.fabs(s.rate_l[k]))
            at = (m.storages + k) * n + j
            s.shares.rows.at[at] = 0.0 if still else pushed / s.unit[j]
    copy_floats(2 * m.slots, kept, s.v1)
    return OK


def is_regular(n: int, a: Floats, factor: Floats, row: Ints, inverse: Floats) -> bool:
    """Whether a balanced matrix clearly is regular; `factor` is a copy of it, and lost."""
    if lu_invert(n, factor, row, inverse) == SINGULAR:
        return False
    return column_norm(n, a) * column_norm(n, inverse) < REGULAR_ENOUGH


def share(e: Engine, s: Stepping, p: Ports, c: Coupled) -> None:
    """Let `s.l` be of least leakage where laws leave it open; `s.shared` says whose it was."""
    m = e.model
    q = e.laws.problem
    n = m.ports
    a = s.shares
    many = c.still
    fit(a.basis, 2 * n * many)
    copy_floats(n * many, c.basis.at, a.basis.at)
    rows = put_seen(e, s, c)
    room = room_for(e)
    many = leave_still(room, rows, n, many, a.rows.at, a.basis, a)
    if many == 0:
        return
    put_bounds(e, s, c)
    # what l may differ by, then what that makes of w
    for k in range(n):
        for j in range(many):
            total = 0.0
            size = 0.0
            noise = 0.0
            for i in range(n):
                term = c.m.at[k * n + i] * a.basis.at[i * many + j]
                total += term
                size += math.fabs(term)
                # a difference quotient that should be zero is rounding of what the two laws do
                both = math.sqrt(math.fabs(c.m.at[k * n + k] * c.m.at[i * n + i]))
                noise += both * math.fabs(a.basis.at[i * many + j])
            still = math.fabs(total) <= MOVES_PART * size
            if not c.straight:
                still = still or math.fabs(total) <= NOTHING_PART * noise
            a.basis.at[(n + k) * many + j] = 0.0 if still else total
    others = put_leaks(e, s, p, c)
    room = room_for(e)
    if not least_shares(room, 2 * n, many, others, a):
        return
    changed = False
    for k in range(n):
        own = a.open.at[k] != 0 or a.open.at[n + k] != 0
        s.shared[k] = 1 if own else 0
        changed = changed or own
    if not changed:
        return
    for k in range(n):
        s.l[k] = a.values.at[k]
        if q.role[k] == ONE_SIDED and (s.l[k] > 0.0 or a.values.at[n + k] > 0.0):
            s.branch[k] = 1 if (s.l[k] > 0.0) == (q.common[k] != 0) else 0
        elif q.role[k] == TWO_SIDED and s.shared[k] != 0 and m.port_planar[k] == 0:
            # a share of friction is what does not slide
            s.branch[k] = 0


def put_seen(e: Engine, s: Stepping, c: Coupled) -> int:
    """Put what a share may not change into ``rows``: limits that follow it, and a passive `q`.

    All solutions z of a monotone problem agree in ``(M + M') z`` and ``q z`` (Cottle, Pang and
    Stone, *The Linear Complementarity Problem*, theorem 3.1.7).
    """
    q = e.laws.problem
    n = q.n
    a = s.shares
    fit(a.rows, (n + 1) * n)
    rows = 0
    for k in range(n):
        sloped = False
        if q.role[k] != ONE_SIDED and q.role[k] != CUT and q.role[k] != SHUT:
            for j in range(n):
                a.rows.at[rows * n + j] = q.slope[k * n + j]
                sloped = sloped or q.slope[k * n + j] != 0.0
        if sloped:
            rows += 1
    if c.moves:
        copy_part(n, q.moved, 0, a.rows.at, rows * n)
        rows += 1
    return rows


def put_bounds(e: Engine, s: Stepping, c: Coupled) -> None:
    """Put `l` and `w` there, and between what each of them may be."""
    m = e.model
    q = e.laws.problem
    n = m.ports
    a = s.shares
    fit(a.values, 2 * n)
    fit(a.low, 2 * n)
    fit(a.high, 2 * n)
    for k in range(n):
        w = q.moved[k]
        for j in range(n):
            w += c.m.at[k * n + j] * s.l[j]
        a.values.at[k] = s.l[k]
        a.values.at[n + k] = w
    for i in range(2 * n):
        a.low.at[i] = a.values.at[i]
        a.high.at[i] = a.values.at[i]
    for k in range(n):
        # disks have shared already
        if m.port_planar[k] != 0:
            continue
        is_common = q.common[k] != 0
        sizes = math.fabs(q.moved[k])
        for j in range(n):
            sizes += math.fabs(c.m.at[k * n + j] * s.l[j])
        if q.role[k] == ONE_SIDED:
            active = (s.branch[k] == 1) == is_common
            # what does nothing stays as it was; another that may carry something carries it
            able = active or (c.idle[k] == 0 and (c.semidefinite > 0 or q.open[k] != 0))
            # where no share moves a w, what stands open carries nothing
            apart = not c.moves and a.values.at[n + k] > MOVES_PART * sizes
            if able and not apart:
                a.low.at[k] = 0.0
                a.high.at[k] = math.inf
            a.low.at[n + k] = 0.0
            a.high.at[n + k] = math.inf
        elif q.role[k] == SHUT:
            a.low.at[k] = -math.inf
            a.high.at[k] = math.inf
        elif q.role[k] == CUT:
            a.low.at[n + k] = -math.inf
            a.high.at[n + k] = math.inf
        elif (s.branch[k] == 0 or q.open[k] != 0) and not is_common:
            # no share changes a limit that follows others: `put_seen`
            limit = q.limit[k]
            for j in range(n):
                limit += q.slope[k * n + j] * s.l[j]
            if math.fabs(s.l[k]) <= limit * (1.0 + SAME_SHARE):
                a.low.at[k] = -limit
                a.high.at[k] = limit


def put_leaks(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Put what flows through, or is held by, the junctions that machines switch; return how many.

    ``rows`` say it by the values that are shared, ``flows`` what it is now.
    """
    m = e.model
    n = m.ports
    a = s.shares
    mode: Mode = open_mode(e, p)
    most = m.junctions + 1
    fit(a.rows, most * 2 * n)
    fit(a.flows, most)
    rows = 0
    for j in range(m.junctions):
        if m.junction_switch[j] < 0 or m.end_first[j] == m.end_first[j + 1] or is_port(m, j):
            continue
        a.flows.at[rows] = 0.0
        for k in range(2 * n):
            a.rows.at[rows * 2 * n + k] = 0.0
        common = 0 if m.junction_kind[j] == 0 else m.bonds
        if mode.on[m.junction_switch[j]] == 0:
            for i in range(m.end_first[j], m.end_first[j + 1]):
                b = m.bonds - common + m.end_bond[i]
                add_leak(e, s, c, rows, b, float(m.end_sign[i]))
        else:
            add_leak(e, s, c, rows, common + m.end_bond[m.end_first[j]], 1.0)
        rows += 1
    return rows


def is_port(m: Model, junction: int) -> bool:
    """Whether a junction has a law of its own."""
    for k in range(m.ports):
        if m.port_junction[k] == junction:
            return True
    return False


def add_leak(e: Engine, s: Stepping, c: Coupled, row: int, b: int, way: float) -> None:
    """Add a bond variable to a leak."""
    n = e.model.ports
    a = s.shares
    flow = e.laws.response.bonds[b]
    for k in range(n):
        gain = c.gain.at[b * n + k]
        a.rows.at[row * 2 * n + k] += way * gain
        flow += gain * s.l[k]
    a.flows.at[row] += way * flow
