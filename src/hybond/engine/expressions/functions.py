"""Functions of one or two numbers that give nan or an infinity where they have no value."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.words import quotient

SIN: Final = 0
COS: Final = 1
TAN: Final = 2
ASIN: Final = 3
ACOS: Final = 4
ATAN: Final = 5
SINH: Final = 6
COSH: Final = 7
TANH: Final = 8
EXP: Final = 9
LOG: Final = 10
LOG10: Final = 11
SQRT: Final = 12
FLOOR: Final = 13
CEIL: Final = 14
ATAN2: Final = 15
MOD: Final = 16
SOFTPLUS: Final = 17
LOG_COSH: Final = 18
EXPM1: Final = 19
LOG1P: Final = 20
CLEARED: Final = 21
MOST: Final = 709.782712893384
"""The logarithm of the largest number: exp() of more is infinite."""
MOST_HALVED: Final = 710.4758600739439
"""That of twice as much: sinh() and cosh() of more are infinite."""
LOG_OF_TWO: Final = 0.6931471805599453
ROUNDED: Final = 1e-9
"""What the logarithm of a power is known to."""
BELOW: Final = 64.0 * EPSILON
"""Part of its terms by which a sum under a root may be below nothing by rounding."""


def sign_of(a: float) -> float:
    """Return -1, 0 or 1; nan of nan."""
    return 1.0 if a > 0.0 else -1.0 if a < 0.0 else math.fabs(a) * 0.0


def power(a: float, b: float) -> float:
    """Return a to the power of b."""
    if b == 0.0 or a == 1.0:
        return 1.0
    if b == 2.0:
        return a * a
    if b == 3.0:
        return a * a * a
    if a != a or b != b:
        return math.nan
    size = math.fabs(a)
    if not math.isfinite(b):
        # an infinite power is even
        if size == 1.0:
            return 1.0
        return math.inf if (size > 1.0) == (b > 0.0) else 0.0
    odd = math.copysign(1.0, a) < 0.0 and math.fabs(math.fmod(b, 2.0)) == 1.0
    if size == 0.0 or not math.isfinite(size):
        limit = 0.0 if (size == 0.0) == (b > 0.0) else math.inf
        return -limit if odd else limit
    if a < 0.0 and math.floor(b) != b:
        return math.nan
    if b * math.log(size) > MOST + ROUNDED:
        return -math.inf if odd else math.inf
    if b * math.log(size) > MOST - ROUNDED:
        # within rounding of the largest number: the last factors one by one
        part = math.pow(size, 0.5 * b)
        whole = part * part
        return -whole if odd else whole
    return math.pow(a, b)


def exponential(a: float) -> float:
    """Return e to the power of a."""
    return math.inf if a > MOST else math.exp(a)


def modulo(a: float, b: float) -> float:
    """Return what is left of a after whole multiples of b, with the sign of b."""
    if b == 0.0 or not math.isfinite(a):
        return math.nan
    rest = math.fmod(a, b)
    if rest == 0.0:
        return math.copysign(0.0, b)
    return rest + b if (rest < 0.0) != (b < 0.0) else rest


def logarithm(a: float) -> float:
    """Return the natural logarithm."""
    return math.log(a) if a > 0.0 else -math.inf if a == 0.0 else math.nan


def softplus(a: float) -> float:
    """Return ``log(1 + exp(a))``."""
    return max(a, 0.0) + math.log1p(math.exp(-math.fabs(a)))


def log_cosh(a: float) -> float:
    """Return ``log(cosh(a))``."""
    size = math.fabs(a)
    if size < 1.0:
        half = math.sinh(0.5 * size)
        return math.log1p(2.0 * half * half)
    return size + (math.log1p(math.exp(-2.0 * size)) - LOG_OF_TWO)


def exp_less_one(a: float) -> float:
    """Return ``exp(a) - 1``."""
    return math.inf if a > MOST else math.expm1(a)


def log_beside_one(a: float) -> float:
    """Return ``log(1 + a)``."""
    return math.log1p(a) if a > -1.0 else logarithm(1.0 + a)


def cleared_of_rounding(a: float, size: float) -> float:
    """Return a, or nothing where it is below that by rounding of terms of a size."""
    return 0.0 if a < 0.0 and a >= -BELOW * size and math.isfinite(size) else a


def function_of(which: int, a: float, b: float) -> float:
    """Return one of the functions above; `b` is read by those of two numbers."""
    if which == SIN:
        return math.sin(a) if math.isfinite(a) else math.nan
    if which == COS:
        return math.cos(a) if math.isfinite(a) else math.nan
    if which == TAN:
        return math.tan(a) if math.isfinite(a) else math.nan
    if which == ASIN:
        return math.asin(a) if math.fabs(a) <= 1.0 else math.nan
    if which == ACOS:
        return math.acos(a) if math.fabs(a) <= 1.0 else math.nan
    if which == ATAN:
        return math.atan(a)
    if which == SINH:
        return math.sinh(a) if math.fabs(a) <= MOST_HALVED else a * math.inf
    if which == COSH:
        return math.cosh(a) if math.fabs(a) <= MOST_HALVED else math.fabs(a) * math.inf
    if which == TANH:
        return math.tanh(a)
    if which == EXP:
        return exponential(a)
    if which == LOG:
        return logarithm(a)
    if which == LOG10:
        return math.log10(a) if a > 0.0 else logarithm(a)
    if which == SQRT:
        return math.sqrt(a) if a >= 0.0 else math.nan
    if which == FLOOR:
        return float(math.floor(a)) if math.isfinite(a) else a
    if which == CEIL:
        return float(math.ceil(a)) if math.isfinite(a) else a
    if which == SOFTPLUS:
        return softplus(a)
    if which == LOG_COSH:
        return log_cosh(a)
    if which == EXPM1:
        return exp_less_one(a)
    if which == LOG1P:
        return log_beside_one(a)
    if which == ATAN2:
        return math.atan2(a, b)
    if which == CLEARED:
        return cleared_of_rounding(a, b)
    if which == MOD:
        return modulo(a, b)
    return math.nan


def ratio(a: float, b: float) -> float:
    """Return a/b; the sign of a zero b does not count."""
    if b != 0.0:
        return quotient(a, b)
    return math.nan if a == 0.0 else math.copysign(math.inf, a)
