"""How a sum of given numbers would move if these moved: what tells a small one from rounding.

A coefficient that is a small difference of large terms may be the current of a leak, or nothing:
two gears whose ratios are 3/7 and 7/3 undo each other, but for rounding of the decimals. How large
the terms are does not tell which. If each number that is given moves by the same small part of
itself, at random up or down, a leak moves by as much of itself; what is rounding of the numbers
moves by as much of the terms. So each entry has a derivative beside it, along a direction that is
drawn from the given numbers themselves (forward mode of differentiation, in place of the repeated
runs of stochastic arithmetic: J. Vignes, *Mathematics and Computers in Simulation* 35, 1993). Equal
numbers move alike: a ratio stands in two rows of its gear, and power is conserved whatever it is.

There are two directions, as two terms that do move apart may by chance move alike along one.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.twofold import LARGEST, SPLIT

UNITS: Final = 2.0**53
"""Units of the last binary digit in a number, about."""
ONE_WAY: Final = 0.6180339887498949
"""By what numbers that differ in their last digit move apart: any irrational number does, and this
is the worst to approximate by fractions."""
OTHER_WAY: Final = 0.41421356237309503
"""Another one, likewise."""


def drift_of(value: float, way: float) -> float:
    """Return how far a given number moves along a direction, at most by itself.

    What has no more than 26 binary digits, as a sign, a count or 1000, is given exactly and stays.
    """
    if not math.fabs(value) < LARGEST:
        return 0.0
    part = SPLIT * value
    upper = part - (part - value)
    lower = value - upper
    if lower == 0.0:
        return 0.0
    return value * (2.0 * math.fmod(math.fabs(lower / upper) * UNITS * way, 1.0) - 1.0)
