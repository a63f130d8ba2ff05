"""Ranges of expressions over an interval of time, and of their rates: what lies between two ends.

A range is an enclosure but for rounding; what has no value somewhere in the interval is unbounded.
Where an expression jumps its rate is that on both sides: a kink ends the step there.

Source: R. E. Moore, R. B. Kearfott, M. J. Cloud, Introduction to Interval Analysis, SIAM 2009.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.expressions.functions import (
    ACOS,
    ASIN,
    ATAN,
    COS,
    COSH,
    EXP,
    LOG,
    LOG10,
    SIN,
    SINH,
    SQRT,
    TAN,
    TANH,
    function_of,
    power,
)
from hybond.engine.words import Floats, floats, quotient, record

ROUND: Final = 2.0 * math.pi


@record
class Ranges:
    """Of each part of courses: the least and the greatest value, and those of its rate.

    `late` is the rate of what the plant moves, of late.
    """

    low: Floats
    high: Floats
    low_rate: Floats
    high_rate: Floats
    late: Floats


def make_ranges(n: int, plants: int) -> Ranges:
    """Return room for n parts, and for so many that the plant moves."""
    r = Ranges()
    r.low = floats(n)
    r.high = floats(n)
    r.low_rate = floats(n)
    r.high_rate = floats(n)
    r.late = floats(plants)
    return r


def put_range(r: Ranges, k: int, low: float, high: float) -> None:
    """Put the range of a part there; unbounded where it has no value."""
    bounded = low == low and high == high
    r.low[k] = min(low, high) if bounded else -math.inf
    r.high[k] = max(low, high) if bounded else math.inf


def put_rates(r: Ranges, k: int, low: float, high: float) -> None:
    """Put the range of its rate there, likewise."""
    bounded = low == low and high == high
    r.low_rate[k] = min(low, high) if bounded else -math.inf
    r.high_rate[k] = max(low, high) if bounded else math.inf


def leave_open(r: Ranges, k: int) -> None:
    """Let nothing be known of a part."""
    put_range(r, k, -math.inf, math.inf)
    put_rates(r, k, -math.inf, math.inf)


def product(a: float, b: float) -> float:
    """Return a product, in which nothing times anything is nothing."""
    return 0.0 if a == 0.0 or b == 0.0 else a * b


def least_product(a: float, b: float, c: float, d: float) -> float:
    """Return the least product of two numbers in ``[a, b]`` and ``[c, d]``."""
    return min(min(product(a, c), product(a, d)), min(product(b, c), product(b, d)))


def greatest_product(a: float, b: float, c: float, d: float) -> float:
    """Return the greatest one."""
    return max(max(product(a, c), product(a, d)), max(product(b, c), product(b, d)))


def nearest(a: float, b: float) -> float:
    """Return the least magnitude in ``[a, b]``."""
    return 0.0 if a <= 0.0 and b >= 0.0 else min(math.fabs(a), math.fabs(b))


def farthest(a: float, b: float) -> float:
    """Return the greatest one."""
    return max(math.fabs(a), math.fabs(b))


def multiply_ranges(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be the product of two others."""
    a = r.low[i]
    b = r.high[i]
    c = r.low[j]
    d = r.high[j]
    put_range(r, k, least_product(a, b, c, d), greatest_product(a, b, c, d))
    low = least_product(a, b, r.low_rate[j], r.high_rate[j])
    low += least_product(c, d, r.low_rate[i], r.high_rate[i])
    high = greatest_product(a, b, r.low_rate[j], r.high_rate[j])
    high += greatest_product(c, d, r.low_rate[i], r.high_rate[i])
    put_rates(r, k, low, high)


def divide_ranges(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be the quotient of two others."""
    c = r.low[j]
    d = r.high[j]
    if c <= 0.0 and d >= 0.0:
        leave_open(r, k)
        return
    low = 1.0 / d
    high = 1.0 / c
    put_range(
        r,
        k,
        least_product(r.low[i], r.high[i], low, high),
        greatest_product(r.low[i], r.high[i], low, high),
    )
    down = greatest_product(r.low[k], r.high[k], r.low_rate[j], r.high_rate[j])
    up = least_product(r.low[k], r.high[k], r.low_rate[j], r.high_rate[j])
    least = r.low_rate[i] - down
    most = r.high_rate[i] - up
    put_rates(r, k, least_product(least, most, low, high), greatest_product(least, most, low, high))


def raise_range(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be a power."""
    a = r.low[i]
    b = r.high[i]
    n = r.low[j]
    if r.high[j] != n or r.low_rate[j] != 0.0 or r.high_rate[j] != 0.0:
        raise_to_range(r, k, i, j)
        return
    whole = math.floor(n) == n
    if (n < 0.0 and a <= 0.0 and b >= 0.0) or (not whole and b < 0.0):
        leave_open(r, k)
        return
    a = a if whole else max(a, 0.0)
    put_range(r, k, least_power(a, b, n), greatest_power(a, b, n))
    if n == 0.0:
        put_rates(r, k, 0.0, 0.0)
        return
    low = n * least_power(a, b, n - 1.0)
    high = n * greatest_power(a, b, n - 1.0)
    put_slopes(r, k, i, min(low, high), max(low, high))


def least_power(a: float, b: float, n: float) -> float:
    """Return the least n-th power of a number in ``[a, b]``, where it has values all over."""
    if a < 0.0 and b > 0.0 and math.fmod(n, 2.0) == 0.0:
        return power(0.0, n)
    return min(power(a, n), power(b, n))


def greatest_power(a: float, b: float, n: float) -> float:
    """Return the greatest one."""
    return max(power(a, n), power(b, n))


def raise_to_range(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be a power whose exponent moves: ``exp(b log(a))``."""
    if not r.low[i] > 0.0:
        leave_open(r, k)
        return
    a = math.log(r.low[i])
    b = function_of(LOG, r.high[i], 0.0)
    low = least_product(a, b, r.low[j], r.high[j])
    high = greatest_product(a, b, r.low[j], r.high[j])
    put_range(r, k, function_of(EXP, low, 0.0), function_of(EXP, high, 0.0))
    c = 1.0 / r.high[i]
    d = 1.0 / r.low[i]
    least = least_product(r.low_rate[i], r.high_rate[i], c, d)
    most = greatest_product(r.low_rate[i], r.high_rate[i], c, d)
    low = least_product(a, b, r.low_rate[j], r.high_rate[j])
    low += least_product(least, most, r.low[j], r.high[j])
    high = greatest_product(a, b, r.low_rate[j], r.high_rate[j])
    high += greatest_product(least, most, r.low[j], r.high[j])
    put_rates(
        r,
        k,
        least_product(r.low[k], r.high[k], low, high),
        greatest_product(r.low[k], r.high[k], low, high),
    )


def put_slopes(r: Ranges, k: int, i: int, low: float, high: float) -> None:
    """Put the rate of a function of part i there, whose slope lies in a range."""
    put_rates(
        r,
        k,
        least_product(low, high, r.low_rate[i], r.high_rate[i]),
        greatest_product(low, high, r.low_rate[i], r.high_rate[i]),
    )


def least_sine(a: float, b: float) -> float:
    """Return the least sine of a number in ``[a, b]``."""
    return -greatest_sine(-b, -a)


def greatest_sine(a: float, b: float) -> float:
    """Return the greatest one."""
    if not b - a < ROUND:
        return 1.0
    turn = 0.5 * math.pi + ROUND * math.ceil((a - 0.5 * math.pi) / ROUND)
    return 1.0 if turn <= b else max(math.sin(a), math.sin(b))


def apply_to_range(r: Ranges, k: int, i: int, which: int) -> None:
    """Let part k be a function of one number of part i."""
    a = r.low[i]
    b = r.high[i]
    quarter = 0.5 * math.pi
    if not (math.isfinite(a) and math.isfinite(b)) and which <= TAN:
        put_range(r, k, -1.0, 1.0)
        put_slopes(r, k, i, -1.0, 1.0)
        if which == TAN:
            leave_open(r, k)
    elif which == SIN:
        put_range(r, k, least_sine(a, b), greatest_sine(a, b))
        put_slopes(
            r, k, i, least_sine(a + quarter, b + quarter), greatest_sine(a + quarter, b + quarter)
        )
    elif which == COS:
        put_range(
            r, k, least_sine(a + quarter, b + quarter), greatest_sine(a + quarter, b + quarter)
        )
        put_slopes(r, k, i, -greatest_sine(a, b), -least_sine(a, b))
    elif which == TAN:
        take_tangent(r, k, i)
    elif which == COSH:
        put_range(
            r, k, function_of(COSH, nearest(a, b), 0.0), function_of(COSH, farthest(a, b), 0.0)
        )
        put_slopes(r, k, i, function_of(SINH, a, 0.0), function_of(SINH, b, 0.0))
    elif which == ASIN or which == ACOS:
        a = min(max(a, -1.0), 1.0)
        b = min(max(b, -1.0), 1.0)
        put_range(r, k, function_of(which, a, 0.0), function_of(which, b, 0.0))
        sign = 1.0 if which == ASIN else -1.0
        least = sign * slope_of(which, nearest(a, b))
        put_slopes(r, k, i, least, sign * slope_of(which, farthest(a, b)))
    elif which >= ATAN and which <= SQRT:
        lowest = 0.0 if which >= LOG else -math.inf
        if b < lowest:
            leave_open(r, k)
            return
        a = max(a, lowest)
        put_range(r, k, function_of(which, a, 0.0), function_of(which, b, 0.0))
        steep = which == SINH or which == ATAN or which == TANH
        least = slope_of(which, nearest(a, b) if steep else a)
        put_slopes(r, k, i, least, slope_of(which, farthest(a, b) if steep else b))
    else:
        # whole numbers
        put_range(r, k, function_of(which, a, 0.0), function_of(which, b, 0.0))
        put_rates(r, k, 0.0, 0.0)


def take_tangent(r: Ranges, k: int, i: int) -> None:
    """Let part k be the tangent of part i."""
    a = r.low[i]
    b = r.high[i]
    if math.floor(a / math.pi + 0.5) != math.floor(b / math.pi + 0.5):
        leave_open(r, k)
        return
    low = math.tan(a)
    high = math.tan(b)
    put_range(r, k, low, high)
    near = nearest(low, high)
    far = farthest(low, high)
    put_slopes(r, k, i, 1.0 + near * near, 1.0 + far * far)


def slope_of(which: int, x: float) -> float:
    """Return the slope of a function of one number, the magnitude of that of an arc cosine."""
    if which == ASIN or which == ACOS:
        return quotient(1.0, math.sqrt(max(1.0 - x * x, 0.0)))
    if which == ATAN:
        return 1.0 / (1.0 + x * x)
    if which == SINH:
        return function_of(COSH, x, 0.0)
    if which == TANH:
        return 1.0 - math.tanh(x) * math.tanh(x)
    if which == EXP:
        return function_of(EXP, x, 0.0)
    if which == LOG:
        return quotient(1.0, x)
    if which == LOG10:
        return quotient(1.0, x * math.log(10.0))
    return quotient(0.5, math.sqrt(x))
