"""Roots on both sides of rest, written as two roots: each is taken of the size of what decides.

Of ``if e > 0 then sqrt(e) else -sqrt(-e)`` each root has its values on one side alone, but the law
has them everywhere, as ``sign(e)*sqrt(abs(e))`` has. Within a branch what decides has one sign: it
is its size, or the opposite of that. So it is written there, and no root ends where the other
begins. A value is what it was, and what has none has none.
"""

from __future__ import annotations

from hybond.model.expressions.differentiate import simplify
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import Binary, Call, Compare, Expr, If, Neg, Number, transform


def sided_roots(e: Expr) -> Expr:
    """Return an expression of the same value whose roots are of sizes where a branch says so.

    Parameters
    ----------
    e : Expr

    Returns
    -------
    Expr
        The same one where there is nothing to be said in another way.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(sided_roots(parse("if e > 0 then k*sqrt(2*e/r) else -k*sqrt(-2*e/r)")))
    if e > 0 then k*sqrt(2*abs(e)/r) else -k*sqrt(2*abs(e)/r)
    >>> print(sided_roots(parse("if p < q then -sqrt(q - p) else sqrt(p - q)")))
    if p < q then -sqrt(abs(q - p)) else sqrt(abs(p - q))
    """
    return transform(e, _sided)


def _sided(e: Expr) -> Expr:
    match e:
        case If(Compare(">" | ">=" | "<" | "<=" as op, a, b), then, other):
            more, less = (a, b) if op[0] == ">" else (b, a)
            on_one, on_other = _of_size(then, more, less), _of_size(other, less, more)
            # what has a root on one side alone ends there
            return e if on_one == then or on_other == other else If(e.cond, on_one, on_other)
    return e


def _of_size(branch: Expr, more: Expr, less: Expr) -> Expr:
    """Return a branch in which one expression is no less than another: roots are of its size."""

    def under_root(part: Expr) -> Expr:
        match part:
            case Call("sqrt", (arg,)):
                return Call("sqrt", (_with_size(arg, more, less),))
            case Binary("^", base, Number(n)) if not is_slotted(n) and n != round(n):
                return Binary("^", _with_size(base, more, less), part.right)
        return part

    return transform(branch, under_root)


def _with_size(arg: Expr, more: Expr, less: Expr) -> Expr:
    """Return a product in which the factor that is the difference of the two is its size."""
    match arg:
        case Binary("*", a, b):
            left, right = _with_size(a, more, less), _with_size(b, more, less)
            if left != a:
                return Binary("*", left, b)
            return Binary("*", a, right) if right != b else _without_sign(arg, more, less)
        case Binary("/", a, b):
            left = _with_size(a, more, less)
            return Binary("/", left, b) if left != a else arg
        case Call("max", (Number(0.0), a) | (a, Number(0.0))):
            size = _with_size(a, more, less)
            return size if size != a else arg
        case Neg(a) if (bare := _with_size(a, less, more)) != a:
            return bare
    difference = simplify(Binary("-", more, less))
    return Call("abs", (arg,)) if simplify(arg) == difference else arg


def _without_sign(arg: Expr, more: Expr, less: Expr) -> Expr:
    """Return ``-2*e`` as ``2*abs(e)`` where e is not positive."""
    match arg:
        case Binary("*", Number() as n, b) if _is_negative(n):
            size = _with_size(b, less, more)
            if size != b:
                return Binary("*", Number(-n.value), size)
    return arg


def _is_negative(n: Number) -> bool:
    return not is_slotted(n.value) and n.value < 0.0
