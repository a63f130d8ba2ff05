"""Guards on functions that jump, as comparisons of what they jump at.

``sign(x) >= 0`` says ``x >= 0``, and ``floor(x) >= 2`` says ``x >= 2``. Such a comparison has
values between: it is seen where it comes near to zero, and where it comes to rest there.
"""

from __future__ import annotations

import math

from hybond.model.expressions import And, Call, Compare, Expr, Number, Or, names, transform
from hybond.model.expressions.slots import is_slotted

_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
LARGEST = 2.0**50
"""Of a whole number, to which one may be added."""


def plain_guard(guard: Expr) -> Expr:
    """Return a guard in which signs, whole parts and bounded values are compared so.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> for text in ("sign(x - 1) >= 0", "0 < sign(x)", "ceil(x/2) > 1.5", "max(x, 1) > 1"):
    ...     print(plain_guard(parse(text)))
    x - 1 >= 0
    x > 0
    x/2 > 1
    x > 1
    """
    return transform(guard, _plain)


def _plain(e: Expr) -> Expr:
    if not isinstance(e, Compare) or e.op not in _TURNED:
        return e
    op, left, right = e.op, e.left, e.right
    if isinstance(right, Call):
        op, left, right = _TURNED[op], right, left
    if not isinstance(left, Call) or not isinstance(right, Number) or is_slotted(right.value):
        return e
    if right.value != right.value or not math.fabs(right.value) < LARGEST:
        return e
    if all(name == "time" for name in names(left)):
        return e
    if left.function == "sign":
        return _of_sign(op, left.args[0], right) or e
    if left.function in ("floor", "ceil"):
        return _of_whole(left.function, op, left.args[0], right)
    if left.function in ("min", "max"):
        return _of_bounded(left, op, right) or e
    return e


def _of_sign(op: str, x: Expr, right: Number) -> Expr | None:
    """Return what the sign of x says of x; None where it is always so, or never."""
    c = right.value
    up = op in (">", ">=")
    if op in (">", "<="):
        # of -1, 0 and 1 those that are more, or those that are not
        more = {1.0: 0.0 <= c < 1.0, 0.0: -1.0 <= c < 0.0}
    else:
        more = {1.0: 0.0 < c <= 1.0, 0.0: -1.0 < c <= 0.0}
    zero = Number(0.0)
    if more[1.0]:
        return Compare(">" if up else "<=", x, zero)
    if more[0.0]:
        return Compare(">=" if up else "<", x, zero)
    return None


def _of_whole(function: str, op: str, x: Expr, right: Number) -> Expr:
    """Return what the whole part of x says of x."""
    c = right.value
    if function == "floor":
        # floor(x) >= n says x >= n
        n = math.ceil(c) if op in (">=", "<") else math.floor(c) + 1
        return Compare(">=" if op in (">", ">=") else "<", x, Number(float(n)))
    # ceil(x) > n says x > n
    n = math.floor(c) if op in (">", "<=") else math.ceil(c) - 1
    return Compare(">" if op in (">", ">=") else "<=", x, Number(float(n)))


def _of_bounded(call: Call, op: str, right: Number) -> Expr | None:
    """Return what the least or the greatest says of those that are no numbers, if one is."""
    numbers = [a for a in call.args if isinstance(a, Number)]
    others = [a for a in call.args if not isinstance(a, Number)]
    if not numbers or not others or any(is_slotted(a.value) for a in numbers):
        return None
    c = right.value
    holds = {">": "__gt__", ">=": "__ge__", "<": "__lt__", "<=": "__le__"}[op]
    said = [getattr(a.value, holds)(c) for a in numbers]
    each = (call.function == "min") == (op in (">", ">="))
    if any(s != each for s in said):
        return None
    compared = tuple(Compare(op, a, right) for a in others)
    return compared[0] if len(compared) == 1 else And(compared) if each else Or(compared)
