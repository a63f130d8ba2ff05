"""Forms of a course whose parts have bounds where it has, and so have their rates.

A range is found part by part (`engine.expressions.course_ranges`), as if parts did not hang
together: ``1/cosh(u)`` is between 0 and 1, but its rate is one number without bound by another.
In ``2*exp(-abs(u))/(1 + exp(-2*abs(u)))`` all parts and their rates are small numbers. These forms
tell what may happen between samples; what does happen is read from the expression itself.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.model.expressions import Binary, Call, Expr, Neg, Number, simplify
from hybond.model.expressions.stable import stable
from hybond.model.expressions.tree import transform

NONE: Final = Number(0.0)
ONE: Final = Number(1.0)
TWO: Final = Number(2.0)


def bounded(e: Expr) -> Expr:
    """Return an expression of the same value whose parts have bounds where it has.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(bounded(parse("3/cosh(u)^2")))
    3*(2*exp(-abs(u))/(1 + exp(-(2*abs(u)))))^2
    >>> print(bounded(parse("exp(u)/(1 + exp(u))^2")))
    exp(-abs(u))/(1 + exp(-abs(u)))^2
    """
    return transform(stable(e), _in_parts)


def _in_parts(e: Expr) -> Expr:
    """Return what has no range of its own as what has: ``max(u, 0) + log(1 + exp(-abs(u)))``."""
    match e:
        case Call("softplus", (u,)):
            rest = Binary("+", ONE, _decay(u))
            return Binary("+", Call("max", (u, NONE)), Call("log", (rest,)))
        case Call("log_cosh", (u,)):
            twice = _in_parts(Call("softplus", (Binary("*", TWO, u),)))
            return Binary("-", twice, Binary("+", u, Number(math.log(2.0))))
        case Call("expm1", (u,)):
            return Binary("-", Call("exp", (u,)), ONE)
        case Call("log1p", (u,)):
            return Call("log", (Binary("+", ONE, u),))
        case Binary("-", u, Call("max", (Number(0.0), same))) if u == same:
            return Call("min", (u, NONE))
        case Binary("-", u, Binary("*", Number(2.0), Call("max", (Number(0.0), same)))) if (
            u == same
        ):
            return Neg(Call("abs", (u,)))
        case Binary("+", Call("exp", (a,)), Call("exp", (b,))):
            return _two_exponentials(a, b) or e
        case Binary("/", Number(0.0), _):
            return e
        case Binary("/", above, below):
            under = _under_one(below)
            if under is not None:
                return under if above == ONE else Binary("*", above, under)
    return e


def _decay(u: Expr) -> Expr:
    return Call("exp", (Neg(Call("abs", (u,))),))


def _under_one(e: Expr) -> Expr | None:
    """Return 1 by what grows as exponentials do, if it is that or is made of that."""
    match e:
        case Call("cosh", (u,)):
            twice = Neg(Binary("*", TWO, Call("abs", (u,))))
            rest = Binary("+", ONE, Call("exp", (twice,)))
            return Binary("/", Binary("*", TWO, _decay(u)), rest)
        case Binary("+", Number(1.0), Call("exp", (Neg(Call("abs", _)),))):
            return None
        case Binary("+", Number(1.0), Call("exp", (u,))) | Binary(
            "+", Call("exp", (u,)), Number(1.0)
        ):
            above = Call("exp", (Neg(Call("max", (u, NONE))),))
            return Binary("/", above, Binary("+", ONE, _decay(u)))
        case Binary("^", below, Number() as n) if n.value > 0.0:
            under = _under_one(below)
            return None if under is None else Binary("^", under, n)
        case Binary("*", a, b):
            left, right = _under_one(a), _under_one(b)
            if left is None and right is None:
                return None
            return Binary("*", left or Binary("/", ONE, a), right or Binary("/", ONE, b))
    return None


def _two_exponentials(a: Expr, b: Expr) -> Expr | None:
    """Return the sum of two exponentials that are not small both, if they are such two."""
    match a, b:
        case Neg(Call("max", (Number(0.0), u))), Call("min", (same, Number(0.0))) if u == same:
            return Binary("+", ONE, _decay(u))
    return Binary("*", TWO, Call("cosh", (a,))) if _are_opposite(a, b) else None


def _are_opposite(a: Expr, b: Expr) -> bool:
    """Whether two expressions can be seen to differ in their signs alone."""
    match a, b:
        case Binary("-", x, y), Binary("-", v, w) if x == w and y == v:
            return True
        case Binary("/" | "*" as p, x, y), Binary("/" | "*" as q, v, w) if p == q:
            return (y == w and _are_opposite(x, v)) or (x == v and _are_opposite(y, w))
    return simplify(Neg(a)) == simplify(b) or simplify(Neg(b)) == simplify(a)
