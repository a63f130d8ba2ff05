"""Forms of the same value in which no number on the way is too large, and no small one is lost.

``log(1 + exp(x))`` is x where the exponential has no number any more, and the exponential itself
where beside 1 nothing is left of it; a quotient of sums of exponentials has a value where both
have none, and the length of what is 1e200 both ways is no more than 1.5e200. Of ``exp(x) - 1`` and
``log(1 + x)`` near x = 0 nothing is left beside the 1 but its rounding: the law of a diode at rest.
``softplus``, ``log_cosh``, ``expm1`` and ``log1p`` are no functions of the language: they stand
where an expression is evaluated, and in no text.

Source: W. Kahan, "Branch cuts for complex elementary functions", 1987, on ``log(1 + x)``.
"""

from __future__ import annotations

import math

from hybond.model.expressions.exponentials import (
    Term,
    adds_up,
    difference,
    is_number,
    is_whole,
    largest,
    minus,
    over,
    scaled,
    steep,
    terms_of,
    times,
    total,
)
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import Binary, Call, Expr, Neg, Number, calls, transform

_MENDED = frozenset(("exp", "sinh", "cosh", "sqrt", "log", "log10"))
"""Functions without which there is nothing to be said in another way."""


def stable(e: Expr) -> Expr:
    """Return an expression of the same value that has it wherever that is a number.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(stable(parse("k*log(1 + exp(x/w))")))
    k*softplus(x/w)
    >>> print(stable(parse("exp(x)/(1 + exp(x)) - sinh(x)/cosh(x)")))
    1/(1 + exp(-x)) - tanh(x)
    >>> print(stable(parse("sqrt(x^2 + y^2) + log(k*exp(x))")))
    hypot(x, y) + (log(k) + x)
    >>> print(stable(parse("k*(exp(x/w) - 1) + w*log(y/k + 1)")))
    k*expm1(x/w) + w*log1p(y/k)
    """
    return e if _MENDED.isdisjoint(calls(e)) else transform(e, _stabler)


def familiar(e: Expr) -> Expr:
    """Return an expression in functions of the language alone: what was before `stable`.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(familiar(stable(parse("log(exp(x) + 1) + log(cosh(x))"))))
    log(1 + exp(x)) + log(cosh(x))
    """
    return transform(e, _more_familiar)


def _more_familiar(e: Expr) -> Expr:
    match e:
        case Call("softplus", (u,)):
            return Call("log", (Binary("+", Number(1.0), Call("exp", (u,))),))
        case Call("log_cosh", (u,)):
            return Call("log", (Call("cosh", (u,)),))
        case Call("expm1", (u,)):
            return Binary("-", Call("exp", (u,)), Number(1.0))
        case Call("log1p", (u,)):
            return Call("log", (Binary("+", Number(1.0), u),))
    return e


def _stabler(e: Expr) -> Expr:
    match e:
        case Call("log", (under,)):
            return _logarithm(under) or e
        case Call("log10", (under,)):
            found = _logarithm(under)
            return e if found is None else Binary("/", found, Number(math.log(10.0)))
        case Call("sqrt", (under,)):
            return _root(under) or e
        case Binary("^", base, Number() as power) if is_number(power) and power.value < 1.0:
            return _root_of_sum(base, power.value) or e
        case Binary("-", a, b):
            return _less_one(a, b) or e
        case Binary("+", a, b):
            return _less_one(b, minus(a)) or _less_one(a, minus(b)) or e
        case Binary("/", above, below):
            return _quotient(above, below) or e
        case Binary("*", Call("exp", (u,)), Call("exp", (v,))):
            return Call("exp", (total(u, v),))
        case Binary("*", Binary("/", a, below), b) | Binary("*", b, Binary("/", a, below)):
            return _quotient(times(a, b), below) or e
    return e


def _less_one(a: Expr, b: Expr) -> Expr | None:
    """Return the difference of an exponential and 1, both times the same; None of another one."""
    for first, second in ((a, b), (b, a)):
        factor, u = _times_exponential(first)
        if u is not None and second == factor:
            found = times(factor, Call("expm1", (u,)))
            return found if first is a else minus(found)
    return None


def _times_exponential(e: Expr) -> tuple[Expr, Expr | None]:
    """Return factor and exponent of an exponential, no exponent if it is none."""
    match e:
        case Call("exp", (u,)):
            return Number(1.0), u
        case Binary("*", factor, Call("exp", (u,))) | Binary("*", Call("exp", (u,)), factor):
            return factor, u
    return e, None


def _logarithm(e: Expr) -> Expr | None:
    """Return the logarithm of a sum of exponentials, or of a number over one; None of others.

    That of what is beside 1 as well.
    """
    beside = beside_one(e)
    if beside is not None:
        return Call("softplus", (beside,))
    match e:
        case Call("cosh", (u,)):
            return Call("log_cosh", (u,))
        case Binary("/", above, below) if is_number(above):
            found = _logarithm(below)
            if found is not None:
                return minus(found) if is_number(above, 1.0) else Binary("-", _log(above), found)
    terms = terms_of(e)
    if not steep(terms):
        return _beside_a_number(e)
    if len(terms) == 1:
        ((a, u),) = terms
        return u if is_number(a, 1.0) else total(_log(a), u)
    numbers = all(is_number(a) for a, _ in terms) and any(is_number(u, 0.0) for _, u in terms)
    if len(terms) == 2 and numbers:
        return _of_two(*terms)
    most = largest(terms)
    return total(most, Call("log", (scaled(terms, most),)))


def _beside_a_number(e: Expr) -> Expr | None:
    """Return the logarithm of 1 and something beside it; None of anything else."""
    match e:
        case Binary("+", one, u) if is_number(one, 1.0):
            return Call("log1p", (u,))
        case Binary("+", u, one) if is_number(one, 1.0):
            return Call("log1p", (u,))
        case Binary("-", one, u) if is_number(one, 1.0):
            return Call("log1p", (minus(u),))
    return None


def _of_two(first: Term, second: Term) -> Expr:
    """Return the logarithm of a number and an exponential, factors above zero: none is lost.

    Of two that both vary the larger one has to stand in front, or it is lost beside the other.
    """
    (a, u), (b, v) = (second, first) if is_number(second[1], 0.0) else (first, second)
    assert isinstance(a, Number)
    assert isinstance(b, Number)
    shift = Number(math.log(b.value) - math.log(a.value))
    rest = Call("softplus", (total(difference(v, u), shift),))
    return total(total(u, Number(math.log(a.value))), rest)


def _quotient(above: Expr, below: Expr) -> Expr | None:
    """Return the quotient of two sums of exponentials, None of others.

    Both without the largest one of the denominator, which may be a power of a sum.
    """
    match above, below:
        case Call("exp", (u,)), _ if beside_one(below) == u:
            one = Number(1.0)
            return Binary("/", one, Binary("+", one, Call("exp", (Neg(u),))))
        case Call("sinh", (u,)), Call("cosh", (v,)) if u == v:
            return Call("tanh", (u,))
        case Call("cosh", (u,)), Call("sinh", (v,)) if u == v:
            return Binary("/", Number(1.0), Call("tanh", (u,)))
        case Binary("^", a, n), Binary("^", b, m) if n == m and is_whole(n):
            found = _quotient(a, b)
            return None if found is None else Binary("^", found, n)
    base, power = below, 1.0
    # a power of a power is none of its base: the root of a square is not what was squared
    if isinstance(base, Binary) and base.op == "^":
        raised = base.right
        if isinstance(raised, Number) and is_number(raised):
            base, power = base.left, raised.value
    down = terms_of(base)
    if not steep(down):
        return None
    up = terms_of(above)
    if not steep(up):
        return None
    most = largest(down)
    under = scaled(down, most)
    under = under if base is below else Binary("^", under, Number(power))
    return over(scaled(up, times(Number(power), most)), under)


def _root(e: Expr) -> Expr | None:
    """Return the root of an exponential, or of a sum of squares; None of others."""
    terms = terms_of(e)
    if len(terms) == 1 and steep(terms):
        ((a, u),) = terms
        half = Call("exp", (Binary("/", u, Number(2.0)),))
        return half if is_number(a, 1.0) else Binary("*", Call("sqrt", (a,)), half)
    sides = _sides(e)
    if sides is None or all(isinstance(s, Number) for s in sides):
        return _root_of_sum(e, 0.5) if sides is None else None
    if len(sides) == 1:
        return Call("abs", (sides[0],))
    found = sides[0]
    for side in sides[1:]:
        found = Call("hypot", (found, side))
    return found


def _root_of_sum(e: Expr, power: float) -> Expr | None:
    """Return a power below one of a sum of exponentials, the largest in front; None of others.

    That one may have a number where the sum has none any more.
    """
    terms = terms_of(e)
    if not steep(terms) or not adds_up(terms):
        return None
    most = largest(terms)
    under = scaled(terms, most)
    root = Call("sqrt", (under,)) if power == 0.5 else Binary("^", under, Number(power))
    return Binary("*", root, Call("exp", (times(Number(power), most),)))


def _sides(e: Expr) -> list[Expr] | None:
    """Return of what a sum is the squares, None if it is another one."""
    match e:
        case Binary("+", left, right):
            first, second = _sides(left), _sides(right)
            return None if first is None or second is None else first + second
        case Binary("^", base, two) if is_number(two, 2.0):
            return [base]
        case Binary("*", left, right) if left == right:
            return [left]
        case Number() if is_number(e):
            return [Number(math.sqrt(e.value))]
    return None


def _log(a: Expr) -> Expr:
    return Call("log", (a,))


def beside_one(e: Expr) -> Expr | None:
    """Return u of ``1 + exp(u)``, None of anything else.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(beside_one(parse("exp(2*x) + 1")), beside_one(parse("2 + exp(x)")))
    2*x None
    """
    match e:
        case Binary("+", Number() as one, Call("exp", (u,))) if _is_one(one):
            return u
        case Binary("+", Call("exp", (u,)), Number() as one) if _is_one(one):
            return u
    return None


def _is_one(e: Number) -> bool:
    return not is_slotted(e.value) and e.dimension is None and e.value == 1.0
