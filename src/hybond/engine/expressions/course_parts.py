"""What courses are made of: parts that work on parts before them, and their ranges.

A course is what time alone, or a phase of the plant, does in an expression. `tables/courses.py`
makes its parts.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.expressions.code import (
    ABSOLUTE,
    ADD,
    APPLY,
    DIVIDE,
    GREATEST,
    LEAST,
    LENGTH,
    MULTIPLY,
    NEGATE,
    NUMBER,
    RAISE,
    READ,
    SIGN,
    SLOPE,
    SUBTRACT,
)
from hybond.engine.expressions.course_ranges import (
    Ranges,
    apply_to_range,
    divide_ranges,
    farthest,
    greatest_product,
    least_product,
    leave_open,
    multiply_ranges,
    nearest,
    put_range,
    put_rates,
    raise_range,
)
from hybond.engine.expressions.functions import COS, SIN, function_of, power, ratio, sign_of
from hybond.engine.expressions.lookup import read_table, segment
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints

AT_TIME: Final = 40
AT_INPUT: Final = 41  # and which one: a straight line
HELD: Final = 42  # and its slot: what does not change while time passes
LESS: Final = 43
GREATER: Final = 44
SAME: Final = 45  # 1 behind it: the opposite
BOTH: Final = 46
EITHER: Final = 47
OPPOSITE: Final = 48
CHOOSE: Final = 49  # of two, by the third
ARC: Final = 50
"""Of two numbers; what has a number of `code` is as there."""
AT_SIGNAL: Final = 51  # its slot, the part that is its rate, and 1: the plant has a say in it
AT_PLANT: Final = 52  # and its slot, and which one: its rate is what it was of late
STEADY: Final = 0
"""Of a part: it is a number; it is held; a line in time; made of sines of lines; none of these."""
STILL: Final = 1
LINE: Final = 2
SINES: Final = 3
OTHER: Final = 4
MOST_POWER: Final = 32.0


def range_parts(m: Model, r: Ranges, v: Floats, a: float, b: float) -> None:
    """Put the ranges of all parts in ``[a, b]`` there; `v` has values of its own time.

    What the plant moves may go on twice as fast as it did of late (`r.late`), or stay.
    """
    for k in range(m.course_nodes):
        what = m.course_op[k]
        i = m.course_left[k]
        j = m.course_right[k]
        if what == NUMBER:
            put_range(r, k, m.course_number[i], m.course_number[i])
            put_rates(r, k, 0.0, 0.0)
        elif what == AT_TIME:
            put_range(r, k, a, b)
            put_rates(r, k, 1.0, 1.0)
        elif what == AT_INPUT:
            rate = v[m.input_rate_slot + i]
            here = v[m.input_slot + i]
            put_range(r, k, here + rate * (a - v[0]), here + rate * (b - v[0]))
            put_rates(r, k, rate, rate)
        elif what == HELD:
            put_range(r, k, v[i], v[i])
            put_rates(r, k, 0.0, 0.0)
        elif what == AT_SIGNAL:
            low = least_product(a - v[0], b - v[0], r.low[j], r.high[j])
            high = greatest_product(a - v[0], b - v[0], r.low[j], r.high[j])
            put_range(r, k, v[i] + low, v[i] + high)
            put_rates(r, k, r.low[j], r.high[j])
        elif what == AT_PLANT:
            most = 2.0 * r.late[j]
            put_range(r, k, v[i] + min(most, 0.0) * (b - v[0]), v[i] + max(most, 0.0) * (b - v[0]))
            put_rates(r, k, min(most, 0.0), max(most, 0.0))
        elif what == ADD:
            put_range(r, k, r.low[i] + r.low[j], r.high[i] + r.high[j])
            put_rates(r, k, r.low_rate[i] + r.low_rate[j], r.high_rate[i] + r.high_rate[j])
        elif what == SUBTRACT:
            put_range(r, k, r.low[i] - r.high[j], r.high[i] - r.low[j])
            put_rates(r, k, r.low_rate[i] - r.high_rate[j], r.high_rate[i] - r.low_rate[j])
        elif what == MULTIPLY:
            multiply_ranges(r, k, i, j)
        elif what == DIVIDE:
            divide_ranges(r, k, i, j)
        elif what == RAISE:
            raise_range(r, k, i, j)
        elif what == NEGATE:
            put_range(r, k, -r.high[i], -r.low[i])
            put_rates(r, k, -r.high_rate[i], -r.low_rate[i])
        elif what == APPLY:
            apply_to_range(r, k, i, j)
        elif what >= LESS and what <= CHOOSE:
            range_truth(r, k, what, i, j, m.course_third[k])
        elif what == READ or what == SLOPE:
            range_table(r, k, i, m.course_number, j, what == SLOPE)
        else:
            range_of_two(r, k, what, i, j)


def range_of_two(r: Ranges, k: int, what: int, i: int, j: int) -> None:
    """Let part k be what bends or jumps of one or two others."""
    a = r.low[i]
    b = r.high[i]
    far = farthest(r.low_rate[i], r.high_rate[i])
    if what == ABSOLUTE:
        put_range(r, k, nearest(a, b), farthest(a, b))
        if a >= 0.0:
            put_rates(r, k, r.low_rate[i], r.high_rate[i])
        elif b <= 0.0:
            put_rates(r, k, -r.high_rate[i], -r.low_rate[i])
        else:
            put_rates(r, k, -far, far)
    elif what == SIGN:
        put_range(r, k, sign_of(a), sign_of(b))
        put_rates(r, k, 0.0, 0.0)
    elif what == LEAST:
        take_one(r, k, i, j, b < r.low[j], r.high[j] < a)
        put_range(r, k, min(a, r.low[j]), min(b, r.high[j]))
    elif what == GREATEST:
        take_one(r, k, i, j, a > r.high[j], r.low[j] > b)
        put_range(r, k, max(a, r.low[j]), max(b, r.high[j]))
    elif what == LENGTH:
        range_length(r, k, i, j)
    elif what == ARC:
        range_arc(r, k, i, j)
    else:
        range_rest(r, k, i, j)


def take_one(r: Ranges, k: int, i: int, j: int, first: bool, second: bool) -> None:
    """Let part k be one of two others; if it may be either, with the rates of both."""
    low = min(r.low_rate[i], r.low_rate[j])
    high = max(r.high_rate[i], r.high_rate[j])
    if first:
        low = r.low_rate[i]
        high = r.high_rate[i]
    elif second:
        low = r.low_rate[j]
        high = r.high_rate[j]
    put_rates(r, k, low, high)


def range_length(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be how far from nothing a point is whose places are parts i and j."""
    near = math.hypot(nearest(r.low[i], r.high[i]), nearest(r.low[j], r.high[j]))
    far = math.hypot(farthest(r.low[i], r.high[i]), farthest(r.low[j], r.high[j]))
    put_range(r, k, near, far)
    most = math.hypot(
        farthest(r.low_rate[i], r.high_rate[i]), farthest(r.low_rate[j], r.high_rate[j])
    )
    put_rates(r, k, -most, most)
    if near > 0.0 and math.isfinite(most) and math.isfinite(far):
        # along the radius only: of what turns that is next to nothing
        low = least_product(r.low[i], r.high[i], r.low_rate[i], r.high_rate[i])
        low += least_product(r.low[j], r.high[j], r.low_rate[j], r.high_rate[j])
        high = greatest_product(r.low[i], r.high[i], r.low_rate[i], r.high_rate[i])
        high += greatest_product(r.low[j], r.high[j], r.low_rate[j], r.high_rate[j])
        low = max(least_product(low, low, 1.0 / far, 1.0 / near), -most)
        put_rates(r, k, low, min(greatest_product(high, high, 1.0 / far, 1.0 / near), most))


def range_arc(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be the angle of a point whose height is part i and whose width is part j."""
    near = math.hypot(nearest(r.low[i], r.high[i]), nearest(r.low[j], r.high[j]))
    if near == 0.0:
        leave_open(r, k)
        return
    put_range(r, k, -math.pi, math.pi)
    if r.low[j] >= 0.0 or r.low[i] > 0.0 or r.high[i] < 0.0:
        a = math.atan2(r.low[i], r.low[j])
        b = math.atan2(r.low[i], r.high[j])
        c = math.atan2(r.high[i], r.low[j])
        d = math.atan2(r.high[i], r.high[j])
        put_range(r, k, min(min(a, b), min(c, d)), max(max(a, b), max(c, d)))
    far = math.hypot(farthest(r.low[i], r.high[i]), farthest(r.low[j], r.high[j]))
    low = least_product(r.low[j], r.high[j], r.low_rate[i], r.high_rate[i])
    low -= greatest_product(r.low[i], r.high[i], r.low_rate[j], r.high_rate[j])
    high = greatest_product(r.low[j], r.high[j], r.low_rate[i], r.high_rate[i])
    high -= least_product(r.low[i], r.high[i], r.low_rate[j], r.high_rate[j])
    low = least_product(low, low, 1.0 / (far * far), 1.0 / (near * near))
    put_rates(r, k, low, greatest_product(high, high, 1.0 / (far * far), 1.0 / (near * near)))


def range_rest(r: Ranges, k: int, i: int, j: int) -> None:
    """Let part k be what is left of part i after whole multiples of part j."""
    whole = r.low[j]
    if whole == 0.0 or r.high[j] != whole:
        leave_open(r, k)
        return
    many = math.floor(r.low[i] / whole)
    put_rates(r, k, r.low_rate[i], r.high_rate[i])
    if many == math.floor(r.high[i] / whole):
        put_range(r, k, r.low[i] - many * whole, r.high[i] - many * whole)
    else:
        put_range(r, k, 0.0, whole)


def range_truth(r: Ranges, k: int, what: int, i: int, j: int, third: int) -> None:
    """Let part k be a truth, 0 or 1, or what one chooses."""
    put_rates(r, k, 0.0, 0.0)
    if what == CHOOSE:
        surely = r.low[third] > 0.0
        never = r.high[third] <= 0.0
        take_one(r, k, i, j, surely, never)
        low = r.low[i] if surely else r.low[j] if never else min(r.low[i], r.low[j])
        high = r.high[i] if surely else r.high[j] if never else max(r.high[i], r.high[j])
        put_range(r, k, low, high)
    elif what == LESS:
        put_range(r, k, truth(r.high[i] < r.low[j]), truth(r.low[i] <= r.high[j]))
    elif what == GREATER:
        put_range(r, k, truth(r.low[i] > r.high[j]), truth(r.high[i] >= r.low[j]))
    elif what == SAME:
        apart = r.high[i] < r.low[j] or r.high[j] < r.low[i]
        put_range(r, k, truth(apart and third != 0), truth(not apart or third != 0))
    elif what == BOTH:
        put_range(r, k, min(r.low[i], r.low[j]), min(r.high[i], r.high[j]))
    elif what == EITHER:
        put_range(r, k, max(r.low[i], r.low[j]), max(r.high[i], r.high[j]))
    else:
        put_range(r, k, truth(r.high[i] <= 0.0), truth(r.low[i] <= 0.0))


def truth(holds: bool) -> float:
    """Return 1 of what holds."""
    return 1.0 if holds else 0.0


def range_table(r: Ranges, k: int, i: int, number: Floats, at: int, sloped: bool) -> None:
    """Let part k be what a table says of part i, or its slope."""
    n = int(number[at])
    first = at + 2
    a = r.low[i]
    b = r.high[i]
    if number[at + 1] == 0.0 and (a < number[first] or b > number[first + n - 1]):
        leave_open(r, k)
        return
    begin = segment(n, number, first, a)
    end = segment(n, number, first, b)
    low = min(read_table(n, number, first, True, a), read_table(n, number, first, True, b))
    high = max(read_table(n, number, first, True, a), read_table(n, number, first, True, b))
    least = math.inf
    most = -math.inf
    for p in range(begin, end + 1):
        x = number[first + p]
        y = number[first + n + p]
        slope = (number[first + n + p + 1] - y) / (number[first + p + 1] - x)
        least = min(least, slope)
        most = max(most, slope)
        if p > begin:
            low = min(low, y)
            high = max(high, y)
    if sloped:
        put_range(r, k, least, most)
        put_rates(r, k, 0.0, 0.0)
        return
    put_range(r, k, low, high)
    put_rates(
        r,
        k,
        least_product(least, most, r.low_rate[i], r.high_rate[i]),
        greatest_product(least, most, r.low_rate[i], r.high_rate[i]),
    )


def find_kinds(m: Model, r: Ranges, kind: Ints, fast: Floats) -> None:
    """Find what each part is, with the slope of a line or the fastest sine that it is made of.

    Numbers stand in `r` afterwards.
    """
    for k in range(m.course_nodes):
        what = m.course_op[k]
        i = m.course_left[k]
        j = m.course_right[k]
        kind[k] = OTHER
        fast[k] = 0.0
        if what == NUMBER:
            kind[k] = STEADY
            r.low[k] = m.course_number[i]
        elif what == AT_TIME:
            kind[k] = LINE
            fast[k] = 1.0
        elif what == AT_SIGNAL:
            kind[k] = LINE if kind[j] == STEADY or m.course_third[k] != 0 else OTHER
            fast[k] = r.low[j] if kind[j] == STEADY else 0.0
        elif what == AT_PLANT:
            kind[k] = LINE
        elif what == HELD:
            kind[k] = STILL
        elif what == AT_INPUT:
            kind[k] = SINES
        elif what == NEGATE:
            kind[k] = kind[i]
            fast[k] = -fast[i] if kind[i] == LINE else fast[i]
            r.low[k] = -r.low[i]
        elif what == ADD or what == SUBTRACT or what == MULTIPLY or what == DIVIDE:
            find_kind_of_two(r, kind, fast, k, what, i, j)
        elif what == RAISE:
            find_kind_of_power(r, kind, fast, k, i, j)
        elif what == APPLY and kind[i] == STEADY:
            kind[k] = STEADY
            r.low[k] = function_of(j, r.low[i], 0.0)
        elif what == APPLY and kind[i] == STILL:
            kind[k] = STILL
        elif what == APPLY and kind[i] == LINE and (j == SIN or j == COS):
            kind[k] = SINES
            fast[k] = math.fabs(fast[i])


def find_kind_of_two(
    r: Ranges, kind: Ints, fast: Floats, k: int, what: int, i: int, j: int
) -> None:
    """Find what a sum, a product or a quotient is."""
    most = max(kind[i], kind[j])
    if most == OTHER:
        return
    if most == STEADY:
        kind[k] = STEADY
        r.low[k] = (
            r.low[i] + r.low[j]
            if what == ADD
            else r.low[i] - r.low[j]
            if what == SUBTRACT
            else r.low[i] * r.low[j]
            if what == MULTIPLY
            else ratio(r.low[i], r.low[j])
        )
    elif what == ADD or what == SUBTRACT:
        kind[k] = most
        # sines beside a line are as fast as they are: the line has no say in it
        a = fast[i] if most == LINE or kind[i] == SINES else 0.0
        b = fast[j] if most == LINE or kind[j] == SINES else 0.0
        fast[k] = max(a, b) if most == SINES else a + b if what == ADD else a - b
    elif what == MULTIPLY and kind[i] == STEADY and most == LINE:
        kind[k] = LINE
        fast[k] = r.low[i] * fast[j]
    elif what == MULTIPLY and kind[j] == STEADY and most == LINE:
        kind[k] = LINE
        fast[k] = fast[i] * r.low[j]
    elif what == DIVIDE and kind[j] == STEADY and most == LINE:
        kind[k] = LINE
        fast[k] = ratio(fast[i], r.low[j])
    elif what == MULTIPLY or kind[j] <= STILL:
        kind[k] = STILL if most == STILL else SINES
        a = fast[i] if kind[i] == SINES else 0.0
        fast[k] = a + (fast[j] if kind[j] == SINES else 0.0)


def find_kind_of_power(r: Ranges, kind: Ints, fast: Floats, k: int, i: int, j: int) -> None:
    """Find what a power is: of sines, if its exponent is a whole number."""
    if kind[i] <= STILL and kind[j] <= STILL:
        kind[k] = max(kind[i], kind[j])
        r.low[k] = power(r.low[i], r.low[j])
        return
    n = r.low[j]
    if (
        kind[j] == STEADY
        and kind[i] <= SINES
        and n >= 1.0
        and n <= MOST_POWER
        and math.floor(n) == n
    ):
        kind[k] = SINES
        fast[k] = n * fast[i] if kind[i] == SINES else 0.0
