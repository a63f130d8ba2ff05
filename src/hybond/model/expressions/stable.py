"""Forms of the same value in which no number on the way is too large, and no small one is lost.

``log(1 + exp(x))`` is x where the exponential has no number any more, and the exponential itself
where beside 1 nothing is left of it. ``softplus`` and ``log_cosh`` are no functions of the
language: they stand where an expression is evaluated, and in no text.

Source: W. Kahan, "Branch cuts for complex elementary functions", 1987, on ``log(1 + x)``.
"""

from __future__ import annotations

from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import Binary, Call, Expr, Neg, Number, transform, walk

_STEEP = ("exp", "cosh")
"""Functions that are beyond all numbers of what is not."""


def stable(e: Expr) -> Expr:
    """Return an expression of the same value that has it wherever that is a number.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(stable(parse("k*log(1 + exp(x/w))")))
    k*softplus(x/w)
    >>> print(stable(parse("exp(x)/(1 + exp(x))")))
    1/(1 + exp(-x))
    """
    if not any(isinstance(part, Call) and part.function in _STEEP for part, _ in walk(e)):
        return e
    return transform(e, _stabler)


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
    return e


def _stabler(e: Expr) -> Expr:
    match e:
        case Call("log", (Call("cosh", (u,)),)):
            return Call("log_cosh", (u,))
        case Call("log", (under,)):
            beside = beside_one(under)
            return e if beside is None else Call("softplus", (beside,))
        case Binary("/", Call("exp", (u,)) as above, below) if beside_one(below) == u:
            assert isinstance(above, Call)
            one = Number(1.0)
            return Binary("/", one, Binary("+", one, Call("exp", (Neg(u),))))
    return e


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
