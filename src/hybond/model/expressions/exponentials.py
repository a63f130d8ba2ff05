"""Sums of exponentials, taken apart: what overflows in them is a factor that all terms share.

``a*exp(u) + b*exp(v)`` is ``exp(m)`` times a sum in which no exponential is more than 1, with m the
larger of u and v. What is made of such sums is seldom as large as they are: a quotient loses the
factor, a logarithm makes m of it. A number beside them is a term whose exponent is 0.

Source: P. Blanchard, D. J. Higham, N. J. Higham, "Accurately computing the log-sum-exp and softmax
functions", IMA J. Numer. Anal. 41(4), 2021.
"""

from __future__ import annotations

import math

from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import Binary, Call, Expr, Neg, Number

_MOST = 9
"""Terms that a product of sums is written out to, at the most: three by three."""
_ONE, _ZERO, _HALF = Number(1.0), Number(0.0), Number(0.5)
Term = tuple[Expr, Expr]
"""Factor and exponent."""


def terms_of(e: Expr) -> list[Term]:
    """Return the terms of a sum, each a factor times an exponential; of what is none, itself.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [f"{a} exp({u})" for a, u in terms_of(parse("2*exp(x/w) - k*cosh(y) + z"))]
    ['2 exp(x/w)', '-(k*0.5) exp(y)', '-(k*0.5) exp(-y)', 'z exp(0)']
    """
    match e:
        case Call("exp", (u,)):
            return [(_ONE, u)]
        case Call("cosh", (u,)):
            return [(_HALF, u), (_HALF, minus(u))]
        case Call("expm1", (u,)):
            return [(_ONE, u), (minus(_ONE), _ZERO)]
        case Call("sinh", (u,)):
            # by its ratio to the other: no digit of a small one cancels
            half = times(_HALF, Call("tanh", (u,)))
            return [(half, u), (half, minus(u))]
        case Neg(arg):
            return [(minus(a), u) for a, u in terms_of(arg)]
        case Binary("+", left, right):
            return terms_of(left) + terms_of(right)
        case Binary("-", left, right):
            return terms_of(left) + [(minus(a), u) for a, u in terms_of(right)]
        case Binary("*", left, right):
            return _multiplied(e, terms_of(left), terms_of(right))
        case Binary("^", base, Number() as power) if is_number(power):
            # not written out: a small difference has its digits before it is squared
            terms = terms_of(base)
            if steep(terms) and (is_whole(power) or adds_up(terms)):
                most = largest(terms)
                under = Binary("^", scaled(terms, most), power)
                return [(under, times(power, most))]
        case Binary("/", left, right):
            below = terms_of(right)
            if len(below) == 1:
                ((b, v),) = below
                return [(over(a, b), difference(u, v)) for a, u in terms_of(left)]
    return [(e, _ZERO)]


def _multiplied(e: Expr, left: list[Term], right: list[Term]) -> list[Term]:
    if not (steep(left) or steep(right)) or len(left) * len(right) > _MOST:
        return [(e, _ZERO)]
    return [(times(a, b), total(u, v)) for a, u in left for b, v in right]


def steep(terms: list[Term]) -> bool:
    """Whether any of the terms has an exponential."""
    return any(u != _ZERO for _, u in terms)


def adds_up(terms: list[Term]) -> bool:
    """Whether no term is taken off the others, by its form: then rounding is never below zero."""
    return all(_is_above_zero(a) for a, _ in terms)


def _is_above_zero(a: Expr) -> bool:
    match a:
        case Number():
            return is_number(a)
        case Binary("*" | "/" | "+", left, right):
            return _is_above_zero(left) and _is_above_zero(right)
        case Binary("^", base, Number() as power):
            return _is_above_zero(base) or (is_whole(power) and power.value % 2.0 == 0.0)
    return isinstance(a, Call) and a.function in ("exp", "cosh", "sqrt")


def largest(terms: list[Term]) -> Expr:
    """Return the largest of the exponents."""
    exponents = tuple(dict.fromkeys(u for _, u in terms))
    if len(exponents) == 1:
        return exponents[0]
    if len(exponents) == 2 and exponents[1] == minus(exponents[0]):
        return Call("abs", (exponents[0],))
    return Call("max", exponents)


def scaled(terms: list[Term], by: Expr) -> Expr:
    """Return the sum without the factor ``exp(by)``.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> terms = terms_of(parse("k*exp(x) + 3"))
    >>> print(largest(terms), "|", scaled(terms, largest(terms)))
    max(x, 0) | k*exp(x - max(x, 0)) + 3*exp(-max(x, 0))
    """
    if len(terms) == 2 and terms[1] == (minus(terms[0][0]), _ZERO):
        # exp(u) - 1 is small where u is, whichever of both is the larger one
        (factor, u), _ = terms
        near = Call("expm1", (minus(Call("abs", (u,))),))
        rest = scaled([(factor, largest(terms))], by)
        return times(rest, minus(Binary("*", Call("sign", (u,)), near)))
    parts = []
    for a, u in terms:
        exponent = difference(u, by)
        parts.append(a if exponent == _ZERO else times(a, Call("exp", (exponent,))))
    found = parts[0]
    for part in parts[1:]:
        found = Binary("-", found, part.arg) if isinstance(part, Neg) else Binary("+", found, part)
    return found


def is_number(e: Expr, value: float | None = None) -> bool:
    """Whether it is a plain number: this one, or any above zero if none is named."""
    if not isinstance(e, Number) or is_slotted(e.value) or e.dimension is not None:
        return False
    return bool(e.value > 0.0) if value is None else bool(e.value == value)


def is_whole(e: Expr) -> bool:
    """Whether it is a plain whole number above zero: such powers have a value on both sides."""
    return is_number(e) and isinstance(e, Number) and e.value == math.floor(e.value)


def minus(a: Expr) -> Expr:
    """Return what an expression is with the other sign."""
    match a:
        case Neg(arg):
            return arg
        case Number() if not is_slotted(a.value):
            return a if a.value == 0.0 else Number(-a.value, a.dimension)
        case Binary("*" | "/" as op, Neg(arg), right):
            return Binary(op, arg, right)
    return Neg(a)


def total(a: Expr, b: Expr) -> Expr:
    """Return a sum, without what is nothing."""
    if is_number(a, 0.0):
        return b
    if is_number(b, 0.0):
        return a
    return difference(a, b.arg) if isinstance(b, Neg) else Binary("+", a, b)


def difference(a: Expr, b: Expr) -> Expr:
    """Return a difference, likewise."""
    if a == b:
        return _ZERO
    if is_number(b, 0.0):
        return a
    if is_number(a, 0.0):
        return minus(b)
    return Binary("+", a, b.arg) if isinstance(b, Neg) else Binary("-", a, b)


def times(a: Expr, b: Expr) -> Expr:
    """Return a product, without what is 1, the sign in front of it."""
    if is_number(a, 1.0):
        return b
    if is_number(b, 1.0):
        return a
    if is_number(a, -1.0) or isinstance(a, Neg):
        return minus(times(minus(a), b))
    return minus(times(a, b.arg)) if isinstance(b, Neg) else Binary("*", a, b)


def over(a: Expr, b: Expr) -> Expr:
    """Return a quotient, likewise."""
    return a if is_number(b, 1.0) else Binary("/", a, b)
