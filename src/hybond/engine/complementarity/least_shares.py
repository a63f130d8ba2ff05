"""Shares of laws that depend on each other: a table on four legs, diodes in parallel.

Laws may have many solutions over a step that store the same. Of these this is the one of least
leakage, as everywhere else: the least sum of squares of what flows through conducting junctions and
of what blocking ones hold, each in SI. It does not depend on the order of elements, equal parts
take equal shares, and no law is left: diodes never share by letting current back.

The conditions for the least norm of ``x + N t`` between bounds are again a complementarity problem.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, Places, fit, fit_places, make_block, make_places
from hybond.engine.algebra.products import copy_floats, copy_part, largest, times_matrix
from hybond.engine.algebra.svd import Svd, null_space
from hybond.engine.complementarity.lcp import SOLVED, Lcp, make_lcp
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.words import Floats, record

SAME_SHARE: Final = 1e-9
"""Shares that differ by less of the largest are the same."""
MOVES_PART: Final = 1e-7
"""Part of its terms from which a sum counts as moved by a share."""
SHARES_RANK: Final = 1e-10


@record
class Shares:
    """Room for shares that the laws leave open: values, their bounds, what may be added to them."""

    values: Block
    low: Block
    high: Block
    basis: Block
    kept: Block
    rows: Block
    seen: Block
    onto: Block
    flows: Block
    t: Block
    square: Block
    q: Block
    start: Places
    open: Places
    lcp: Lcp
    lcp_most: int


def make_shares() -> Shares:
    """Return room that grows where shares are open."""
    a = Shares()
    a.values = make_block(1)
    a.low = make_block(1)
    a.high = make_block(1)
    a.basis = make_block(1)
    a.kept = make_block(1)
    a.rows = make_block(1)
    a.seen = make_block(1)
    a.onto = make_block(1)
    a.flows = make_block(1)
    a.t = make_block(1)
    a.square = make_block(1)
    a.q = make_block(1)
    a.start = make_places(1)
    a.open = make_places(1)
    a.lcp = make_lcp(1)
    a.lcp_most = 1
    return a


def cleared(rows: int, n: int, many: int, a: Floats, basis: Floats, out: Floats) -> int:
    """Put ``a basis`` there, without rows that are nothing but cancellation; return how many stay.

    `a` has so many `rows` of n entries, `basis` `many` columns.
    """
    kept = 0
    for i in range(rows):
        some_entry = False
        for j in range(many):
            total = 0.0
            size = 0.0
            for k in range(n):
                if a[i * n + k] != 0.0:
                    total += a[i * n + k] * basis[k * many + j]
                    size += math.fabs(a[i * n + k]) * math.fabs(basis[k * many + j])
            out[kept * many + j] = 0.0 if math.fabs(total) <= MOVES_PART * size else total
            some_entry = some_entry or out[kept * many + j] != 0.0
        if some_entry:
            kept += 1
    return kept


def leave_still(d: Svd, rows: int, n: int, many: int, a: Floats, basis: Block, x: Shares) -> int:
    """Leave of what `basis` spans that which `a` is blind to; return how many columns stay."""
    fit(x.seen, max(rows, 1) * many)
    kept = cleared(rows, n, many, a, basis.at, x.seen.at)
    if kept == 0:
        return many
    fit(x.square, many * many)
    free = null_space(d, kept, many, x.seen.at, SHARES_RANK, x.square.at)
    fit(x.onto, n * max(free, 1))
    times_matrix(n, many, free, basis.at, x.square.at, x.onto.at)
    for k in range(n):
        size = 0.0
        for i in range(many):
            size += math.fabs(basis.at[k * many + i])
        for j in range(free):
            # what is left of a value that stays would pass for a row of its own
            if math.fabs(x.onto.at[k * free + j]) <= SHARES_RANK * size:
                x.onto.at[k * free + j] = 0.0
    copy_floats(n * free, x.onto.at, basis.at)
    return free


def least_shares(d: Svd, n: int, many: int, others: int, x: Shares) -> bool:
    """Let ``x.values``, n of them, be those of least leakage; False if nothing is open.

    ``x.basis``, of `many` columns, says what may be added; ``x.low`` and ``x.high`` are bounds,
    equal where a value stays. ``x.rows`` is what leaks elsewhere, `others` rows by the values, and
    ``x.flows`` how much that is now. ``x.open`` says which values were open.
    """
    fit_places(x.open, n)
    for k in range(n):
        x.open.at[k] = 0
    free = free_directions(d, n, many, x)
    if free == 0:
        return False
    orthogonal(n, free, others, x)
    if not inside_bounds(n, free, x):
        note_touched(n, free, x.kept.at, x)
        return True
    size = 0.0
    fit(x.onto, n)
    for k in range(n):
        total = x.values.at[k]
        for j in range(free):
            total += x.kept.at[k * free + j] * x.t.at[j]
        x.onto.at[k] = min(max(total, x.low.at[k]), x.high.at[k])
        size = max(size, max(math.fabs(x.values.at[k]), math.fabs(x.onto.at[k])))
    near = SAME_SHARE * size
    bound = 0
    fit(x.seen, n * free)
    for k in range(n):
        share = x.onto.at[k]
        if share - x.low.at[k] <= near:
            share = x.low.at[k]
        elif x.high.at[k] - share <= near:
            share = x.high.at[k]
        if math.fabs(share - x.values.at[k]) > near:
            x.open.at[k] = 1
        x.values.at[k] = share
        if not (share > x.low.at[k] and share < x.high.at[k]):
            copy_part(free, x.kept.at, k * free, x.seen.at, bound * free)
            bound += 1
    fit(x.square, free * free)
    left = null_space(d, bound, free, x.seen.at, SHARES_RANK, x.square.at)
    fit(x.onto, n * max(left, 1))
    times_matrix(n, free, left, x.kept.at, x.square.at, x.onto.at)
    note_touched(n, left, x.onto.at, x)
    return True


def free_directions(d: Svd, n: int, many: int, x: Shares) -> int:
    """Put what leaves the fixed values alone into ``x.kept``; return how many columns."""
    fixed = 0
    most = 0.0
    fit(x.seen, n * many)
    for k in range(n):
        for j in range(many):
            most = max(most, math.fabs(x.basis.at[k * many + j]))
        if x.low.at[k] >= x.high.at[k]:
            copy_part(many, x.basis.at, k * many, x.seen.at, fixed * many)
            fixed += 1
    fit(x.square, many * many)
    free = null_space(d, fixed, many, x.seen.at, SHARES_RANK, x.square.at)
    fit(x.onto, n * max(free, 1))
    fit(x.kept, n * max(free, 1))
    stay = 0
    for j in range(free):
        some_entry = False
        for k in range(n):
            total = 0.0
            for i in range(many):
                total += x.basis.at[k * many + i] * x.square.at[i * free + j]
            # what cancels but for rounding moves nothing, and asks for no bound
            x.onto.at[k] = total if math.fabs(total) > SAME_SHARE * most else 0.0
            some_entry = some_entry or x.onto.at[k] != 0.0
        if some_entry:
            copy_part(n, x.onto.at, 0, x.kept.at, stay * n)
            stay += 1
    # column after column so far
    copy_floats(n * stay, x.kept.at, x.onto.at)
    for j in range(stay):
        for k in range(n):
            x.kept.at[k * stay + j] = x.onto.at[j * n + k]
    return stay


def orthogonal(n: int, free: int, others: int, x: Shares) -> None:
    """Make the directions orthonormal, leaks elsewhere counted; ``x.t`` leads to the least norm.

    Gram and Schmidt, twice: the normal equations are then as good as the basis.
    """
    rows = n + others
    fit(x.onto, rows * free)
    fit(x.t, free)
    for j in range(free):
        for k in range(n):
            x.onto.at[k * free + j] = x.kept.at[k * free + j]
        for i in range(others):
            total = 0.0
            for k in range(n):
                total += x.rows.at[i * n + k] * x.kept.at[k * free + j]
            x.onto.at[(n + i) * free + j] = total
    for j in range(free):
        for _ in range(2):
            for i in range(j):
                share = 0.0
                for k in range(rows):
                    share += x.onto.at[k * free + i] * x.onto.at[k * free + j]
                add_direction(n, rows, free, i, j, -share, x)
        size = 0.0
        for k in range(rows):
            size += x.onto.at[k * free + j] * x.onto.at[k * free + j]
        size = math.sqrt(size)
        total = 0.0
        for k in range(rows):
            x.onto.at[k * free + j] /= size
            here = x.values.at[k] if k < n else x.flows.at[k - n]
            total += x.onto.at[k * free + j] * here
        for k in range(n):
            x.kept.at[k * free + j] /= size
        x.t.at[j] = -total


def add_direction(n: int, rows: int, free: int, i: int, j: int, share: float, x: Shares) -> None:
    """Add a part of direction i to direction j."""
    for k in range(rows):
        x.onto.at[k * free + j] += share * x.onto.at[k * free + i]
    for k in range(n):
        x.kept.at[k * free + j] += share * x.kept.at[k * free + i]


def inside_bounds(n: int, free: int, x: Shares) -> bool:
    """Keep ``x.t`` to the bounds, with the least change; False if that finds no answer."""
    bounds = 0
    fit(x.seen, 2 * n * free)
    fit(x.q, 4 * n)
    for k in range(n):
        if x.low.at[k] >= x.high.at[k]:
            continue
        for side in range(2):
            bound = x.low.at[k] if side == 0 else x.high.at[k]
            if not math.isfinite(bound):
                continue
            way = 1.0 if side == 0 else -1.0
            for j in range(free):
                x.seen.at[bounds * free + j] = way * x.kept.at[k * free + j]
            room = way * (x.values.at[k] - bound)
            # what is beyond its bound by more than rounding has to be brought back
            rounding = SAME_SHARE * (math.fabs(x.values.at[k]) + math.fabs(bound))
            x.q.at[bounds] = room if room < -rounding else max(room, 0.0)
            bounds += 1
    beyond = False
    for i in range(bounds):
        for j in range(free):
            x.q.at[i] += x.seen.at[i * free + j] * x.t.at[j]
        beyond = beyond or x.q.at[i] < 0.0
    if not beyond:
        return True
    if bounds > x.lcp_most:
        x.lcp_most = bounds
        x.lcp = make_lcp(bounds)
    fit(x.square, bounds * bounds)
    fit_places(x.start, bounds)
    for i in range(bounds):
        x.start.at[i] = 0
        for j in range(bounds):
            total = 0.0
            for k in range(free):
                total += x.seen.at[i * free + k] * x.seen.at[j * free + k]
            x.square.at[i * bounds + j] = total
    if lemke(x.lcp, bounds, x.square.at, x.q.at, x.start.at) != SOLVED:
        return False
    for i in range(bounds):
        for j in range(free):
            x.t.at[j] += x.seen.at[i * free + j] * x.lcp.z[i]
    return True


def note_touched(n: int, many: int, basis: Floats, x: Shares) -> None:
    """Note the values that a basis moves as open."""
    most = largest(n * many, basis)
    for k in range(n):
        for j in range(many):
            own = math.fabs(basis[k * many + j])
            if most > 0.0 and own > SAME_SHARE * most:
                x.open.at[k] = 1
