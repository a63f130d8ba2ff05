"""The rate of a function of time of which nothing but its values is known.

Differences over a span `h` on both sides are those of a polynomial of the sixth degree. How long
`h` may be is for the function to say: spans become shorter until the same points say the same by
the fourth degree, and what is between them is what is there, so that no pulse stands between. Then
what is left out is some 1e-13 of the rate, wherever the function is smooth on its own scale of
time. Next to a place where it is not, all points stand on one side.

A function that is asked at many times is asked at a few first, which belong to a part of the run
and not to who asks: longer spans than the longest that served one of them are left out there.

Source of the weights: B. Fornberg, *Generation of finite difference formulas on arbitrarily spaced
grids*, Mathematics of Computation 51 (1988), tables 1 and 3.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import Final

LONGEST: Final = 2.0**-10
"""The first span, as a part of the time that there is; it is a fourth of that next time."""
SHORTEST: Final = 2.0**-44
"""The last one, as a part of it."""
ODD: Final = 1.0 + 5077.0 / 2.0**14
"""Spans are so many times a power of two: a period is no multiple of one, and times are exact."""
AGREE: Final = 1e-9
"""By what part of it both degrees may differ: what the sixth leaves out is far less."""
EPS: Final = sys.float_info.epsilon
NOISE: Final = 4.0
"""Last places of values that are rounding."""
CELLS: Final = 16
"""Of so many parts of the time, each has a first span of its own."""
PLACES: Final = (0.1875, 0.4375, 0.8125)
"""Where in such a part it is looked for."""
LAST: Final = 6
"""Of so many of the shortest spans is what values are in doubt by seen."""


def rate_of(
    function: Callable[[float], float],
    t: float,
    low: float,
    high: float,
    span: float,
    longest: float = math.inf,
) -> float:
    """Return the derivative of a function, which is smooth from `low` to `high`, at t.

    Parameters
    ----------
    function : callable
        Of time, s; asked from `low`, included, up to `high`, which is not.
    t : float
        When, s.
    low, high : float
        Between which times it is smooth, s; ``low <= t``.
    span : float
        How much time there is, s: what takes some millionth of it is resolved, and far less.
    longest : float, optional
        The first span that is tried, s, of those that are tried without.

    Returns
    -------
    float
        The rate, in units of the function, 1/s. Where both degrees agree nowhere, as of what has
        few digits, that of the longest span over which values are in no more doubt.

    Examples
    --------
    >>> import math
    >>> rate = rate_of(lambda t: math.sin(1e3 * t), 0.25, 0.0, math.inf, 1.0)
    >>> abs(rate / (1e3 * math.cos(1e3 * 0.25)) - 1.0) < 1e-9
    True
    """
    first = first_span(low, high, span)
    if not first > 0.0:
        return 0.0
    least = max(SHORTEST * span, 2.0 * math.ulp(t))
    forward = high - t >= t - low
    tried = list[tuple[float, float]]()
    h = min(first, longest)
    while h >= least or not tried:
        rate, off, rounding = beside(function, t, h, low, high)
        if off <= AGREE * abs(rate) + rounding:
            return rate
        tried.append((rate, off * h))
        h /= 4.0
    for way in (1.0, -1.0) if forward else (-1.0, 1.0):
        if (found := from_one_side(function, t, way, first, least, low, high)) is not None:
            return found
    # values are known to fewer digits than they have: the longest span with no more doubt than that
    noise = max(doubt for _, doubt in tried[-LAST:])
    return next(rate for rate, doubt in tried if not doubt > noise)


def first_span(low: float, high: float, span: float) -> float:
    """Return the longest span that is tried, s; 0 where there is no room for any."""
    first = min(LONGEST * span, (high - low) / 16.0)
    return ODD * 2.0 ** math.floor(math.log2(first)) if first > 0.0 else 0.0


def longest_near(
    function: Callable[[float], float], t: float, low: float, high: float, span: float
) -> float:
    """Return the longest span that serves somewhere in the part of the time that t is in.

    The arguments are those of `rate_of`. It is the same for all t of the part, in any order.
    """
    first = first_span(low, high, span)
    cell = span / CELLS
    begin = math.floor(t / cell) * cell
    most = 0.0
    for place in PLACES:
        at = begin + place * cell
        h = first
        while most < h and h >= SHORTEST * span and low <= at < high:
            rate, off, rounding = beside(function, at, h, low, high)
            if off <= AGREE * abs(rate) + rounding:
                most = h
            h /= 4.0
    return most if most > 0.0 else math.inf


def beside(
    function: Callable[[float], float], t: float, h: float, low: float, high: float
) -> tuple[float, float, float]:
    """Return the rate as `around` does, or, where that has no room, as `aside` does."""
    if t - 3.0 * h >= low and t + 3.0 * h < high:
        return around(function, t, h)
    return aside(function, t, h if high - t >= t - low else -h)


def from_one_side(
    function: Callable[[float], float],
    t: float,
    way: float,
    first: float,
    least: float,
    low: float,
    high: float,
) -> float | None:
    """Return the rate on one side of what is not smooth, where two spans agree on it."""
    before = math.nan
    h = first
    while h >= least:
        if low <= t + 6.0 * way * h < high:
            rate, off, rounding = aside(function, t, way * h)
            may = AGREE * abs(rate) + rounding
            if off <= may and abs(rate - before) <= may:
                return rate
            before = rate if off <= may else math.nan
        h /= 4.0
    return None


def around(function: Callable[[float], float], t: float, h: float) -> tuple[float, float, float]:
    """Return the rate from both sides, by how much it is in doubt, and what of that is rounding."""
    here = function(t)
    after = [function(t + j * h) for j in (1, 2, 3)]
    before = [function(t - j * h) for j in (1, 2, 3)]
    ahead = [b - a for a, b in zip(before, after, strict=True)]
    rate = (45.0 * ahead[0] - 9.0 * ahead[1] + ahead[2]) / (60.0 * h)
    lower = (8.0 * ahead[0] - ahead[1]) / (12.0 * h)
    mean = [0.5 * (a + b) for a, b in zip(before, after, strict=True)]
    between = (15.0 * mean[0] - 6.0 * mean[1] + mean[2]) / 10.0
    rounding = NOISE * EPS * max(map(abs, (here, *after, *before))) / h
    return rate, abs(rate - lower) + beyond(abs(between - here) / h, rounding), rounding


def beyond(off: float, rounding: float) -> float:
    """Return what is more than rounding."""
    return off if off > rounding else 0.0


def aside(function: Callable[[float], float], t: float, h: float) -> tuple[float, float, float]:
    """Return the same from one side, that of `h`."""
    f = [function(t + j * h) for j in range(7)]
    rate = (
        -147.0 * f[0] + 360.0 * f[1] - 450.0 * f[2] + 400.0 * f[3] - 225.0 * f[4] + 72.0 * f[5]
    ) / (60.0 * h) - f[6] / (6.0 * h)
    lower = (-137.0 * f[0] + 300.0 * f[1] - 300.0 * f[2] + 200.0 * f[3] - 75.0 * f[4]) / (60.0 * h)
    lower += 12.0 * f[5] / (60.0 * h)
    rounding = 8.0 * NOISE * EPS * max(map(abs, f)) / abs(h)
    return rate, abs(rate - lower), rounding
