"""What the laws of a step leave open, and the shares that least leakage then decides."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.lu import SINGULAR, lu_invert
from hybond.engine.algebra.products import column_norm
from hybond.engine.algebra.scaling import balance
from hybond.engine.algebra.svd import Svd, null_space
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, SHUT
from hybond.engine.complementarity.least_shares import least_shares, leave_still
from hybond.engine.engine import Engine, svd_room
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import open_mode
from hybond.engine.mode.mode_records import Mode
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Coupled, Stepping
from hybond.engine.words import Floats, Ints

REGULAR_ENOUGH: Final = 1e9
"""Condition up to which a balanced matrix is clearly not singular."""


def room_for(e: Engine) -> Svd:
    """Return room for the decompositions that shares ask for."""
    m = e.model
    rows = max(max(2 * m.ports, e.states), m.junctions + 1)
    return svd_room(e, rows, 2 * m.ports)


def find_still(e: Engine, s: Stepping, c: Coupled) -> None:
    """Find the `l` that may differ between two solutions: columns of ``c.basis``, mostly none.

    Those that no power is spent on, for a passive graph; elsewhere those that change no `w`. They
    leave what is stored alone.
    """
    n = e.model.ports
    a = s.shares
    c.still = 0
    if n == 0:
        return
    # units apart: efforts and flows are of very different sizes
    balance(n, c.m.at, s.scale, s.down)
    fit(a.seen, n * n)
    fit(a.square, n * n)
    fit(s.square, n * n)
    for i in range(n):
        for j in range(n):
            own = c.m.at[i * n + j]
            if c.semidefinite > 0:
                own += c.m.at[j * n + i]
            a.seen.at[i * n + j] = own * s.scale[i] * s.scale[j]
            s.square.at[i * n + j] = a.seen.at[i * n + j]
    if is_regular(n, a.seen.at, s.square.at, s.row, a.square.at):
        return
    fit(c.basis, n * n)
    room = room_for(e)
    many = null_space(room, n, n, a.seen.at, 1e-10, c.basis.at)
    for j in range(many):
        most = 0.0
        for k in range(n):
            c.basis.at[k * many + j] *= s.scale[k]
            most = max(most, math.fabs(c.basis.at[k * many + j]))
        for k in range(n):
            c.basis.at[k * many + j] /= most if most > 0.0 else 1.0
    if many > 0:
        many = leave_still(room, c.n, n, many, c.push.at, c.basis, a)
    c.still = many


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
    for i in range(n * many):
        a.basis.at[i] = c.basis.at[i]
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
            for i in range(n):
                term = c.m.at[k * n + i] * a.basis.at[i * many + j]
                total += term
                size += math.fabs(term)
            a.basis.at[(n + k) * many + j] = 0.0 if math.fabs(total) <= 1e-7 * size else total
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
    if c.semidefinite > 0:
        for j in range(n):
            a.rows.at[rows * n + j] = q.moved[j]
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
        if q.role[k] == ONE_SIDED:
            active = (s.branch[k] == 1) == is_common
            # what does nothing stays as it was; another that may carry something carries it
            if active or (c.idle[k] == 0 and (c.semidefinite > 0 or q.open[k] != 0)):
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
        elif s.branch[k] == 0 and not is_common:
            sloped = False
            for j in range(n):
                sloped = sloped or q.slope[k * n + j] != 0.0
            if not sloped and math.fabs(s.l[k]) <= q.limit[k]:
                a.low.at[k] = -q.limit[k]
                a.high.at[k] = q.limit[k]


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
