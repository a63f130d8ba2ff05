"""What the arithmetic of floating point leaves: the constants by which all rooms measure it."""

from typing import Final

EPSILON: Final = 2.220446049250313e-16
"""From one to the next larger number."""
SMALLEST: Final = 2.2250738585072014e-308
"""The smallest number that has all its digits."""
UNDERFLOW: Final = SMALLEST / EPSILON
"""What any law may be off by: numbers near the smallest ones have fewer digits."""
CANCELS: Final = 1e-13
"""What is below this part of its terms is what rounding leaves of zero."""
AT_KINK: Final = 1e-9
"""Part of its terms below which what changes its sign at a kink is zero."""
