"""Sine, cosine and tangent of parts of a turn that are known exactly, where numbers are folded.

No number of a computer is a quarter of a turn, and the cosine of the next one is 6e-17. Of an
angle of time that is rounding. As a number of a model it would say that a lever at a right angle
moves its load after all: what is structural must not hang on it.
"""

from __future__ import annotations

import math

TWELFTHS = 12
"""Parts of half a turn, of which angles are multiples; those of 15 and 75 degrees are not exact."""
OFF = 4.0 * 2.0**-53
"""Part of an angle by which rounding may put it beside a multiple: of degrees, and of their sum."""
LARGEST = 1e6
_SINES = {
    0: 0.0,
    2: 0.5,
    3: math.sqrt(0.5),
    4: math.sqrt(0.75),
    6: 1.0,
}
_TANGENTS = {0: 0.0, 2: math.sqrt(1.0 / 3.0), 3: 1.0, 4: math.sqrt(3.0)}


def exact_sin(x: float) -> float | None:
    """Return the sine of a multiple of 30 or 45 degrees, None of other angles.

    Examples
    --------
    >>> import math
    >>> exact_sin(math.pi), exact_sin(-math.pi/6), exact_sin(1.0)
    (0.0, -0.5, None)
    """
    n = _twelfths(x)
    return None if n is None else _sine(n)


def exact_cos(x: float) -> float | None:
    """Return the cosine of a multiple of 30 or 45 degrees, None of other angles.

    Examples
    --------
    >>> import math
    >>> exact_cos(math.pi/2), exact_cos(math.radians(240)), exact_cos(1.0)
    (0.0, -0.5, None)
    """
    n = _twelfths(x)
    return None if n is None else _sine(n + TWELFTHS // 2)


def exact_tan(x: float) -> float | None:
    """Return the tangent of a multiple of 30 or 45 degrees, None elsewhere and at a right angle.

    Examples
    --------
    >>> import math
    >>> exact_tan(math.pi/4), exact_tan(0.75*math.pi), exact_tan(math.pi/2)
    (1.0, -1.0, None)
    """
    n = _twelfths(x)
    if n is None:
        return None
    within = n % TWELFTHS
    if within in _TANGENTS:
        return _TANGENTS[within]
    return -_TANGENTS[TWELFTHS - within] if TWELFTHS - within in _TANGENTS else None


def _twelfths(x: float) -> int | None:
    """Return how many twelfths of half a turn an angle is, if it is so many but for rounding."""
    if not abs(x) <= LARGEST:
        return None
    n = round(x * TWELFTHS / math.pi)
    return n if abs(x - n * (math.pi / TWELFTHS)) <= OFF * abs(x) else None


def _sine(n: int) -> float | None:
    """Return the sine of so many twelfths of half a turn, if it is one of those known."""
    within = n % (2 * TWELFTHS)
    sign = 1.0
    if within >= TWELFTHS:
        within -= TWELFTHS
        sign = -1.0
    known = _SINES.get(min(within, TWELFTHS - within))
    return None if known is None else sign * known if known else 0.0
