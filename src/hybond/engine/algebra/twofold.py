"""What a sum or a product was rounded by: the digits that the result has no room for.

A number and such a rest beside it have twice the digits of one (Dekker, *A floating-point technique
for extending the available precision*, 1971; Knuth's sum).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Rows
from hybond.engine.words import Floats

SPLIT: Final = 134217729.0
"""2^27 + 1: its product with a number tells the upper half of its digits."""
LARGEST: Final = 1e270
"""Beyond this a number is not split: nothing is known of what its products were rounded by."""
CLOSE: Final = 2.0**-10
"""A sum below this part of its terms has lost digits enough for being summed with twice as many."""

TWOFOLD_ZERO: Final = 2.0**-98
"""A sum below this part of its terms is what rounding leaves of zero with twice the digits."""


def sum_rest(a: float, b: float, total: float) -> float:
    """Return by what ``a + b`` is more than the sum that it was rounded to."""
    if not math.isfinite(total):
        return 0.0
    part = total - a
    return (a - (total - part)) + (b - part)


def product_rest(a: float, b: float, product: float) -> float:
    """Return by what ``a*b`` is more than the product that it was rounded to."""
    if a == 1.0 or a == -1.0 or b == 1.0 or b == -1.0:
        return 0.0
    if not (math.fabs(a) < LARGEST and math.fabs(b) < LARGEST and math.fabs(product) < LARGEST):
        return 0.0
    part = SPLIT * a
    a1 = part - (part - a)
    a2 = a - a1
    part = SPLIT * b
    b1 = part - (part - b)
    b2 = b - b1
    return ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2


def row_closely(r: Rows, k: int, x: Floats) -> float:
    """Return the product of row k with a vector: with all its digits, however many terms cancel.

    What comes out as zero is left at that.
    """
    total = 0.0
    size = 0.0
    for i in range(r.first.at[k], r.first.at[k + 1]):
        term = r.value.at[i] * x[r.column.at[i]]
        total += term
        size += math.fabs(term)
    return total if keeps_digits(total, size) else row_cancelling(r, k, x)


def keeps_digits(total: float, size: float) -> bool:
    """Whether a sum is so large a part of its terms that it has digits enough; zero is left."""
    return total == 0.0 or not math.fabs(total) < CLOSE * size


def row_cancelling(r: Rows, k: int, x: Floats) -> float:
    """Return the same of a row whose terms cancel."""
    closer = 0.0
    rest = 0.0
    for i in range(r.first.at[k], r.first.at[k + 1]):
        at = x[r.column.at[i]]
        term = r.value.at[i] * at
        rest += product_rest(r.value.at[i], at, term) + r.rest.at[i] * at
        before = closer
        closer = before + term
        rest += sum_rest(before, term, closer)
    return closer + rest


def add_product(a: Floats, r: Floats, at: int, factor: float, more: float, of: int) -> None:
    """Add a product with entry `of` to entry `at`, both with their rests in `r`."""
    change = factor * a[of]
    over = product_rest(factor, a[of], change) + (factor * r[of] + more * a[of])
    old = a[at]
    total = old + change
    rest = sum_rest(old, change, total) + (r[at] + over)
    new = total + rest
    if math.fabs(new) <= TWOFOLD_ZERO * (math.fabs(old) + math.fabs(change)):
        a[at] = 0.0
        r[at] = 0.0
        return
    a[at] = new
    r[at] = sum_rest(total, rest, new)


def take_quotient(b: Floats, r: Floats, at: int, a: Floats, s: Floats, of: int) -> None:
    """Divide entry `at` of `b` by entry `of` of `a`; their rests are in `r` and `s`."""
    quotient = b[at] / a[of]
    product = quotient * a[of]
    rest = (b[at] - product) - product_rest(quotient, a[of], product)
    rest = (rest + (r[at] - quotient * s[of])) / a[of]
    b[at] = quotient + rest
    r[at] = sum_rest(quotient, rest, b[at])


def add_part(a: Floats, r: Floats, at: int, factor: float, value: float, rest: float) -> None:
    """Add a number's product with a factor to entry `at`, both with their rests."""
    change = factor * value
    over = product_rest(factor, value, change) + factor * rest
    old = a[at]
    total = old + change
    over += sum_rest(old, change, total) + r[at]
    a[at] = total + over
    r[at] = sum_rest(total, over, a[at])
