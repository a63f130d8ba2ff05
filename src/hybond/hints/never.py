"""Guards that never hold, by their form: a size below zero, a sine above its amplitude, numbers."""

from __future__ import annotations

import math

from hybond.model.expressions import And, Binary, Bool, Call, Compare, Expr, Neg, Number, Or
from hybond.model.expressions.slots import is_slotted

Bounds = tuple[float, float]
ANY: Bounds = (-math.inf, math.inf)


def never_holds(e: Expr) -> bool:
    """Whether a guard holds for no values of what it reads.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [never_holds(parse(text)) for text in ("abs(v) < 0", "abs(v) <= 0", "2*sin(w) > 3")]
    [True, False, True]
    >>> never_holds(parse("x > 0 and abs(v) < -1")), never_holds(parse("x > 0 or abs(v) < -1"))
    (True, False)
    """
    match e:
        case Bool(value):
            return not value
        case And(args):
            return any(never_holds(a) for a in args)
        case Or(args):
            return all(never_holds(a) for a in args)
        case Compare():
            low, high = bounds_of(Binary("-", e.left, e.right))
            if e.op in (">", ">="):
                return high < 0.0 or (high == 0.0 and e.op == ">")
            if e.op in ("<", "<="):
                return low > 0.0 or (low == 0.0 and e.op == "<")
    return False


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
        case Binary("^", _, Number(value)) if not is_slotted(value) and value % 2.0 == 0.0:
            return 0.0, math.inf
        case Call(function="abs" | "sqrt" | "exp" | "cosh" | "hypot"):
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
