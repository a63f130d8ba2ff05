"""Roots of what is below nothing by rounding alone are those of nothing.

A tank drains through a hole half way up, ``sqrt(level - 0.25)``. It comes to rest at that level,
but a state is a number of its own, and the level that it gives may be a last place above 0.25 or
below it, where there is no root: no number may be between, and none at rest. So what is under a
root is taken for nothing where it is below it by no more than rounding of the terms of which it is
a sum.
"""

from __future__ import annotations

from functools import reduce

from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import Binary, Call, Expr, If, Neg, Number, transform, walk


def cleared_roots(e: Expr) -> Expr:
    """Return an expression whose roots of sums are cleared of what is rounding below nothing.

    ``cleared(u, size)`` is `u`, or nothing where that is less than nothing by rounding of `size`;
    it is no function of the language.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(cleared_roots(parse("k*sqrt(e - 0.25)")))
    k*sqrt(cleared(e - 0.25, abs(e) + abs(0.25)))
    >>> print(cleared_roots(parse("k*sqrt(e) + sqrt(max(0, e - a)) + sqrt(1 + e^2)")))
    k*sqrt(e) + sqrt(max(0, e - a)) + sqrt(1 + e^2)
    """
    return transform(e, _cleared)


def cleared(u: Expr) -> Expr:
    """Return what is under a root, cleared where it is a sum that may be below nothing.

    Of a least or a largest, and of branches, each by itself: a bound far away is no term of what
    it bounds.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(cleared(parse("min(e - a, 1e12)")))
    min(cleared(e - a, abs(e) + abs(a)), 1000000000000)
    """
    match u:
        case Call("min" | "max" as function, args) if _may_be_below(u):
            return Call(function, tuple(map(cleared, args)))
        case If(cond, then, other) if _may_be_below(u):
            return If(cond, cleared(then), cleared(other))
    return Call("cleared", (u, magnitude(u))) if _may_be_below(u) else u


def magnitude(e: Expr) -> Expr:
    """Return what the magnitudes of the terms of `e` add up to.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(magnitude(parse("2*(p - q)/rho")))
    abs(2)*(abs(p) + abs(q))/abs(rho)
    """
    match e:
        case Binary(op="+" | "-"):
            return Binary("+", magnitude(e.left), magnitude(e.right))
        case Binary(op="*"):
            return Binary("*", magnitude(e.left), magnitude(e.right))
        case Binary(op="/"):
            return Binary("/", magnitude(e.left), Call("abs", (e.right,)))
        case Neg() | Call(function="abs"):
            return magnitude(e.arg if isinstance(e, Neg) else e.args[0])
        case Call(function="sign"):
            return Number(1.0)
        case Call(function="floor" | "ceil"):
            return Binary("+", magnitude(e.args[0]), Number(1.0))
        case Call(function="mod"):
            return magnitude(e.args[1])
        case Call(function="min" | "max"):
            return reduce(lambda a, b: Binary("+", a, b), map(magnitude, e.args))
        case If():
            return Binary("+", magnitude(e.then), magnitude(e.orelse))
        case _:
            return Call("abs", (e,))


def _cleared(e: Expr) -> Expr:
    match e:
        case Call("sqrt", (u,)) if _may_be_below(u):
            return Call("sqrt", (cleared(u),))
        case Binary("^", u, Number(n)) if _is_root(n) and _may_be_below(u):
            return Binary("^", cleared(u), e.right)
    return e


def _is_root(n: float) -> bool:
    """Whether a power is none of what is below nothing, and is nothing where that is nothing."""
    return not is_slotted(n) and n > 0.0 and n != round(n)


def _may_be_below(u: Expr) -> bool:
    """Whether something is made of a sum, and may be below nothing by its form."""
    return not _is_positive(u) and any(isinstance(p, Binary) and p.op in "+-" for p, _ in walk(u))


def _is_positive(u: Expr) -> bool:
    """Whether something is not below nothing, whatever it is made of."""
    match u:
        case Number(x):
            return not is_slotted(x) and x >= 0.0
        case Call("abs" | "sqrt" | "exp" | "cosh" | "hypot"):
            return True
        case Call("max", args):
            return any(map(_is_positive, args))
        case Call("min", args):
            return all(map(_is_positive, args))
        case Binary("+" | "*" | "/", a, b):
            return _is_positive(a) and _is_positive(b)
        case Binary("^", _, Number(n)):
            return not is_slotted(n) and n == 2.0 * round(n / 2.0)
        case If(_, then, other):
            return _is_positive(then) and _is_positive(other)
    return False
