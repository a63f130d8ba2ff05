"""Guards that never hold, by their form: a size below zero, a sine above its amplitude, numbers."""

from __future__ import annotations

from hybond.model.expressions import And, Binary, Bool, Compare, Expr, Or
from hybond.model.expressions.bounds import bounds_of


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
