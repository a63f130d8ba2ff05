"""Between what an expression is, by its form: a sum of squares, a size, a sine."""

from __future__ import annotations

import math

from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import Binary, Call, Expr, Neg, Number

Bounds = tuple[float, float]
ANY: Bounds = (-math.inf, math.inf)


def bounds_of(e: Expr) -> Bounds:
    """Return between what an expression is, whatever it reads.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> bounds_of(parse("2 - 3*tanh(x)")), bounds_of(parse("abs(x) + y^2 + 1"))
    ((-1.0, 5.0), (1.0, inf))
    """
    match e:
        case Number(value) if not is_slotted(value) and math.isfinite(value):
            return float(value), float(value)
        case Neg(arg):
            low, high = bounds_of(arg)
            return -high, -low
        case Binary("+" | "-", left, right):
            a, b = bounds_of(left), bounds_of(right if e.op == "+" else Neg(right))
            return a[0] + b[0], a[1] + b[1]
        case Binary("*", Number(), other) | Binary("*" | "/", other, Number()):
            return _scaled(e, other)
        case Binary("*", left, right) if left == right:
            return 0.0, math.inf
        case Binary("*" | "/", left, right):
            return _of_signs(bounds_of(left)[0], bounds_of(right)[0], e.op)
        case Binary("^", _, Number(value)) if not is_slotted(value) and value % 2.0 == 0.0:
            return 0.0, math.inf
        case Call("sqrt", (arg,)):
            return math.sqrt(max(bounds_of(arg)[0], 0.0)), math.inf
        case Call("max", args):
            lows, highs = zip(*map(bounds_of, args), strict=True)
            return max(lows), max(highs)
        case Call("min", args):
            lows, highs = zip(*map(bounds_of, args), strict=True)
            return min(lows), min(highs)
        case Call(function="abs" | "exp" | "cosh" | "hypot"):
            return 0.0, math.inf
        case Call(function="sin" | "cos" | "tanh" | "sign"):
            return -1.0, 1.0
    return ANY


def _scaled(e: Binary, other: Expr) -> Bounds:
    """Return the bounds of a product with a number, or of a quotient by one."""
    number = e.left if isinstance(e.left, Number) and e.op == "*" else e.right
    assert isinstance(number, Number)
    if is_slotted(number.value) or number.value == 0.0:
        return ANY
    factor = number.value if e.op == "*" else 1.0 / number.value
    a, b = (factor * end for end in bounds_of(other))
    return min(a, b), max(a, b)


def _of_signs(left: float, right: float, op: str) -> Bounds:
    """Return the bounds of a product or a quotient, of what both sides are not below."""
    if left < 0.0 or right < 0.0:
        return ANY
    low = left * right if op == "*" and left > 0.0 and right > 0.0 else 0.0
    return low, math.inf
