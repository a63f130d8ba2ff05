"""Tables that laws read, and the lesser and greater of two numbers, as expressions mean them.

After model/expressions/algebra.py: what is not a number stays so.
"""

from __future__ import annotations

import math

from hybond.engine.words import Floats


def least_of(a: float, b: float) -> float:
    """Return the lesser of two."""
    return b if b < a or b != b else a


def greatest_of(a: float, b: float) -> float:
    """Return the greater of two."""
    return b if b > a or b != b else a


def segment(n: int, points: Floats, first: int, x: float) -> int:
    """Return the segment of a table of n points that x lies in, or the one next to it.

    `points` are all arguments, from `first` on, then all values.
    """
    low = 0
    high = n
    while low < high:
        middle = (low + high) // 2
        if x < points[first + middle]:
            high = middle
        else:
            low = middle + 1
    return max(0, min(low - 1, n - 2))


def slope_of_table(n: int, points: Floats, first: int, goes_on: bool, x: float) -> float:
    """Return the slope of the segment at x: at a point, of the segment to its right."""
    if x != x or (not goes_on and not (points[first] <= x and x <= points[first + n - 1])):
        return math.nan
    k = first + segment(n, points, first, x)
    return (points[n + k + 1] - points[n + k]) / (points[k + 1] - points[k])


def read_table(n: int, points: Floats, first: int, goes_on: bool, x: float) -> float:
    """Read a table of n points at x: straight lines between them, and outside if it goes on.

    A line is counted from its nearer point: beside a point at zero no digit is lost.
    """
    slope = slope_of_table(n, points, first, goes_on, x)
    if slope != slope:
        return slope
    k = first + segment(n, points, first, x)
    if points[k + 1] - x < x - points[k]:
        k += 1
    return points[n + k] + slope * (x - points[k])


def square(x: float) -> float:
    """Return x times itself, as expressions of a model that are printed ask for it by its name."""
    return x * x
