"""Bond variables where something is shown or decided: with all digits, however many terms cancel.

Of what a state and the unknowns of Newton's method give to a bond variable each sum is rounded on
its own. Where large terms cancel, the sums of a junction, or the two sides of a two-port, would
differ by that rounding, and powers would not balance.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import Rows
from hybond.engine.algebra.twofold import (
    CLOSE,
    TWOFOLD_ZERO,
    keeps_digits,
    product_rest,
    row_cancelling,
    sum_rest,
)
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import own_stiffness
from hybond.engine.words import Floats
from hybond.engine.work import Work


def closely(e: Engine, mode: Mode, rows: Rows, w: Floats) -> None:
    """Put what the knowns give to bond variables by such rows into `w`."""
    xi = e.work.xi
    at = 0
    for k in range(2 * e.model.bonds):
        begin = at
        at = rows.first.at[k + 1]
        same = mode.same[k]
        if same < k:
            w[k] = w[same]
            continue
        total = 0.0
        size = 0.0
        for i in range(begin, at):
            term = rows.value.at[i] * xi[rows.column.at[i]]
            total += term
            size += math.fabs(term)
        w[k] = total if keeps_digits(total, size) else row_cancelling(rows, k, xi)


def sum_closely(e: Engine, mode: Mode, w: Floats) -> None:
    """Sum bond variables anew that knowns and free unknowns, which are in `w`, make by cancelling.

    What comes out as zero is left at that.
    """
    for k in range(2 * e.model.bonds):
        same = mode.same[k]
        if same < k:
            w[k] = w[same]
        elif w[k] != 0.0 and cancels_here(e, mode, k, w):
            w[k] = row_with_free(e, mode, k, w)


def rate_closely(e: Engine, mode: Mode, k: int, w: Floats) -> float:
    """Return one bond variable with all digits; also where its terms come out as zero.

    A leak of two capacitors at one voltage is less than the last digit of what they exchange.
    """
    same = mode.same[k]
    size = size_here(e, mode, same, w)
    if not math.fabs(w[k]) < CLOSE * size:
        return w[k]
    return without_dust(row_with_free(e, mode, same, w), size)


def rate_by_row(rows: Rows, k: int, xi: Floats) -> float:
    """Return the same of a bond variable that knowns `xi` give by row k alone."""
    total = 0.0
    size = 0.0
    for i in range(rows.first.at[k], rows.first.at[k + 1]):
        term = rows.value.at[i] * xi[rows.column.at[i]]
        total += term
        size += math.fabs(term)
    if not math.fabs(total) < CLOSE * size:
        return total
    return without_dust(row_cancelling(rows, k, xi), size)


def rate_twofold(e: Engine, mode: Mode, k: int, w: Floats) -> float:
    """Return the same with twice the digits: what it is rounded by stands in ``e.work.over``."""
    at = mode.same[k]
    total = row_twofold(e.work, mode.finite, at, e.work.xi)
    size = e.work.over_size
    rest = e.work.over
    some = mode.finite_frees > 0
    first = mode.share_first.at[at] if some else 0
    for p in range(first, mode.share_first.at[at + 1] if some else 0):
        j = mode.share_of.at[p]
        share = mode.finite_free.at[at * mode.finite_frees + j]
        free = w[mode.free_column[j]]
        term = share * free
        rest += product_rest(share, free, term)
        rest += mode.free_rest.at[at * mode.finite_frees + j] * free
        before = total
        total = before + term
        rest += sum_rest(before, term, total)
        size += math.fabs(term)
    return put_over(e.work, total, rest, size)


def row_twofold(work: Work, rows: Rows, k: int, xi: Floats) -> float:
    """Return the same of a bond variable that knowns `xi` give by row k alone."""
    total = 0.0
    rest = 0.0
    size = 0.0
    for i in range(rows.first.at[k], rows.first.at[k + 1]):
        at = xi[rows.column.at[i]]
        term = rows.value.at[i] * at
        rest += product_rest(rows.value.at[i], at, term) + rows.rest.at[i] * at
        before = total
        total = before + term
        rest += sum_rest(before, term, total)
        size += math.fabs(term)
    return put_over(work, total, rest, size)


def put_over(work: Work, total: float, rest: float, size: float) -> float:
    """Return a sum of terms of such a size without dust, and put what it is rounded by there."""
    rounded = without_dust(total + rest, size)
    work.over = sum_rest(total, rest, rounded) if rounded != 0.0 else 0.0
    work.over_size = size
    return rounded


def lasting_size(e: Engine, mode: Mode, k: int, b: int, acts: float) -> float:
    """Return what rounding in the rate of storage `k`, bond variable `b`, acts on for a time.

    All of what is given from outside, and of what laws are solved for. What is stored is rounded in
    all rates alike where these are summed with all digits: as if it were a little more or less, and
    for no longer than its own rate takes.
    """
    rows = mode.finite
    at = mode.same[b]
    given = math.fabs(e.work.w[b])
    stored = 0.0
    own = 0.0
    for i in range(rows.first.at[at], rows.first.at[at + 1]):
        term = math.fabs(rows.value.at[i] * e.work.xi[rows.column.at[i]])
        if rows.column.at[i] >= e.model.storages:
            given += term
            continue
        stored += term
        if rows.column.at[i] == k:
            own = math.fabs(rows.value.at[i] * own_stiffness(e.model, k, e.v))
    for j in range(mode.finite_frees):
        share = mode.finite_free.at[at * mode.finite_frees + j]
        given += math.fabs(share) * mode.free_size.at[j] if share != 0.0 else 0.0
    return given * acts + stored * (min(acts, 1.0 / own) if own > 0.0 else acts)


def without_dust(total: float, size: float) -> float:
    """Return a sum with twice the digits; zero if it is rounding of these beside its terms."""
    return total if math.fabs(total) > TWOFOLD_ZERO * size else 0.0


def cancels_here(e: Engine, mode: Mode, k: int, w: Floats) -> bool:
    """Whether a bond variable is a small part of its terms."""
    return math.fabs(w[k]) < CLOSE * size_here(e, mode, k, w)


def size_here(e: Engine, mode: Mode, k: int, w: Floats) -> float:
    """Return the size of the terms of a bond variable."""
    rows = mode.finite
    frees = mode.finite_frees
    size = 0.0
    for i in range(rows.first.at[k], rows.first.at[k + 1]):
        size += math.fabs(rows.value.at[i] * e.work.xi[rows.column.at[i]])
    for p in range(
        mode.share_first.at[k] if frees > 0 else 0, mode.share_first.at[k + 1] if frees > 0 else 0
    ):
        j = mode.share_of.at[p]
        size += math.fabs(mode.finite_free.at[k * frees + j] * w[mode.free_column[j]])
    return size


def row_with_free(e: Engine, mode: Mode, k: int, w: Floats) -> float:
    """Return the sum of the terms of a bond variable, with twice the digits on the way."""
    rows = mode.finite
    frees = mode.finite_frees
    total = 0.0
    rest = 0.0
    for i in range(rows.first.at[k], rows.first.at[k + 1]):
        at = e.work.xi[rows.column.at[i]]
        term = rows.value.at[i] * at
        rest += product_rest(rows.value.at[i], at, term) + rows.rest.at[i] * at
        before = total
        total = before + term
        rest += sum_rest(before, term, total)
    first = mode.share_first.at[k] if frees > 0 else 0
    for p in range(first, mode.share_first.at[k + 1] if frees > 0 else 0):
        j = mode.share_of.at[p]
        share = mode.finite_free.at[k * frees + j]
        at = w[mode.free_column[j]]
        term = share * at
        rest += product_rest(share, at, term) + mode.free_rest.at[k * frees + j] * at
        before = total
        total = before + term
        rest += sum_rest(before, term, total)
    return total + rest
