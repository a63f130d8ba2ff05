"""How large a slope would be whatever the angles in it are.

The cosine of a quarter turn is 6e-17 and not zero. Left as an entry of a matrix, such a remainder
says that a horizontal lever moves its load sideways, and a rank may hang on it.
"""

from __future__ import annotations

from hybond.model.expressions import Binary, Call, Expr, Neg, Number
from hybond.model.expressions.tree import fold


def size_by_angles(e: Expr) -> Expr | None:
    """Return the size of `e` with each sine and cosine counted as 1; None if it has none.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(size_by_angles(parse("2*sin(a)*b - c")))
    abs(2)*1*abs(b) + abs(c)
    >>> size_by_angles(parse("a - b"))
    """
    size, turns = fold(e, _size)
    return size if turns else None


def _size(e: Expr, _prior: bool, below: list[tuple[Expr, bool]]) -> tuple[Expr, bool]:
    """Return the size of a node and whether it has angles, given those of its subexpressions."""
    if isinstance(e, Call) and e.function in ("sin", "cos"):
        return Number(1.0), True
    if any(turns for _, turns in below):
        if isinstance(e, Neg):
            return below[0]
        if isinstance(e, Binary) and e.op in "+-*":
            op = "*" if e.op == "*" else "+"
            return Binary(op, below[0][0], below[1][0]), True
        if isinstance(e, Binary) and e.op == "/" and not below[1][1]:
            return Binary("/", below[0][0], below[1][0]), True
    return Call("abs", (e,)), False
