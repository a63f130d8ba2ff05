"""Whether an expression has one sign, whatever its variables are.

Each part has a range, as if its parts did not hang together: ``1 - tanh(u)^2`` lies between 0 and 1
for any u. What no range is known of may be any number.
"""

from __future__ import annotations

import math
from typing import Any, Final

from hybond.model.expressions import Binary, Call, Expr, If, Neg, Number
from hybond.model.expressions.slots import Slotted

Range = tuple[float, float]

ANY: Final[Range] = (-math.inf, math.inf)
WITHIN: Final[dict[str, Range]] = {
    "tanh": (-1.0, 1.0),
    "sin": (-1.0, 1.0),
    "cos": (-1.0, 1.0),
    "sign": (-1.0, 1.0),
    "exp": (0.0, math.inf),
    "sqrt": (0.0, math.inf),
    "cosh": (1.0, math.inf),
    "softplus": (0.0, math.inf),
    "log_cosh": (0.0, math.inf),
    "expm1": (-1.0, math.inf),
    "atan": (-0.5 * math.pi, 0.5 * math.pi),
}
"""Ranges of functions."""


def one_sign(e: Expr) -> int:
    """Return 1 if an expression is nowhere below zero, -1 if nowhere above, 0 if that is not told.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> one_sign(parse("12*1e3*(1 - tanh(1e3*(x - y))^2)")), one_sign(parse("-1/(1 + x^2)"))
    (1, -1)
    >>> one_sign(parse("1 - 3*x^2"))
    0
    """
    low, high = _range(e)
    return 1 if low >= 0.0 else -1 if high <= 0.0 else 0


def _range(e: Expr) -> Range:
    """Return the least and the greatest number that an expression may be, or beyond."""
    match e:
        case Number(value):
            return _of_number(value)
        case Neg(a):
            low, high = _range(a)
            return (-high, -low)
        case If(_, then, orelse):
            first, second = _range(then), _range(orelse)
            return (min(first[0], second[0]), max(first[1], second[1]))
        case Call("abs", (a,)):
            low, high = _range(a)
            return (max(0.0, low, -high), max(abs(low), abs(high)))
        case Call("min" | "max" as f, args):
            pairs = [_range(a) for a in args]
            pick = min if f == "min" else max
            return (pick(low for low, _ in pairs), pick(high for _, high in pairs))
        case Call(f, _):
            return WITHIN.get(f, ANY)
        case Binary(op, a, b):
            return _of_two(op, a, b)
    return ANY


def _of_number(value: Any) -> Range:
    if not isinstance(value, Slotted):
        return (value, value)
    # of a parameter the sign alone: it may have any other number
    if value > 0.0:
        return (0.0, math.inf)
    return (-math.inf, 0.0) if value < 0.0 else (0.0, 0.0)


def _of_two(op: str, a: Expr, b: Expr) -> Range:
    if op == "^":
        power = b.value if isinstance(b, Number) and isinstance(b.value, int | float) else 1.0
        if power % 2.0 != 0.0 or not power > 0.0:
            return ANY
        low, high = _range(a)
        return (0.0, max(abs(low), abs(high)) ** power)
    (a0, a1), (b0, b1) = _range(a), _range(b)
    match op:
        case "+":
            return _sum(a0, b0, -math.inf), _sum(a1, b1, math.inf)
        case "-":
            return _sum(a0, -b1, -math.inf), _sum(a1, -b0, math.inf)
        case "*":
            ends = [_product(x, y) for x in (a0, a1) for y in (b0, b1)]
            return (0.0, max(ends)) if a == b else (min(ends), max(ends))
        case "/" if b0 > 0.0 or b1 < 0.0:
            ends = [_product(x, 1.0 / y) for x in (a0, a1) for y in (b0, b1)]
            return (min(ends), max(ends))
        case "/" if b0 >= 0.0 or b1 <= 0.0:  # a divisor that may be zero has a sign all the same
            way = 1 if b0 >= 0.0 else -1
            sign = one_sign(a) * way
            return (0.0, math.inf) if sign > 0 else (-math.inf, 0.0) if sign < 0 else ANY
    return ANY


def _sum(a: float, b: float, where: float) -> float:
    total = a + b
    return where if math.isnan(total) else total


def _product(a: float, b: float) -> float:
    return 0.0 if a == 0.0 or b == 0.0 else a * b
