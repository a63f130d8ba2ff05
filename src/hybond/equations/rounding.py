"""What rounding of a law is measured by: how much of it the last digits of its terms make.

``cosh(e/U) - 1`` is worth as little as its 1 near rest, ``f + f*abs(f)/1 A`` as little as its first
term where both cancel. Errors are followed from the leaves to the root, to first order.

Source: N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, chapter 3.3 (running
error analysis).
"""

from __future__ import annotations

from hybond.model.expressions import (
    Binary,
    Call,
    Expr,
    If,
    Name,
    Neg,
    Number,
    Pre,
    Table,
    differentiate,
    simplify,
    substitute,
)
from hybond.model.expressions.stable import familiar, stable
from hybond.model.expressions.tree import fold

_ZERO = Number(0.0)


def rounding(e: Expr) -> Expr:
    """Return what, times the unit of rounding, bounds the rounding of `e` as it is evaluated.

    Numbers are exact, names are known to rounding. Near a point where a function has no slope the
    bound has no value.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(rounding(parse("a - 2*b")))
    abs(a) + 2*abs(b)
    >>> print(rounding(parse("exp(a) - 1")))
    abs(exp(a))*abs(a) + abs(exp(a) - 1)
    """
    return simplify(familiar(fold(stable(simplify(e)), _bound)))


def rounding_of_law(e: Expr) -> Expr:
    """Return the same of a law that is zero at a solution, sums with numbers counted.

    ``(2*x - abs(x + 1) + abs(x - 1))/2`` is flat about zero, where what is left of it is the
    rounding of 1: beside a number, which is exact, a sum is rounded to what it is.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(rounding_of_law(parse("a + 1")))
    abs(a) + abs(a + 1)
    """
    return simplify(familiar(fold(stable(simplify(e)), _bound_of_law)))


def _bound_of_law(e: Expr, prior: bool, below: list[Expr]) -> Expr:
    bound = _bound(e, prior, below)
    beside = isinstance(e, Binary) and e.op in "+-" and _ZERO in below and bound != _ZERO
    return _sum(bound, _size(e)) if beside else bound


def _bound(e: Expr, prior: bool, below: list[Expr]) -> Expr:
    """Return the bound of a node, given those of its subexpressions."""
    match e:
        case Name():
            return _size(Pre(e) if prior else e)
        case Pre() | Neg():
            return below[0]
        case Binary():
            return _of_binary(e, below)
        case If(cond):
            return If(cond, below[1], below[2])
        case Table(arg) if not e.slope:
            slope = Table(arg, e.x, e.y, e.extrapolate, slope=True)
            near = Table(arg, e.x, _nearby(e.y), e.extrapolate)
            return _sum(_sum(_times(_size(slope), below[0]), _size(e)), _size(near))
        case Call(function, args):
            return _of_call(e, function, args, below)
    return _ZERO


def _nearby(y: tuple[float, ...]) -> tuple[float, ...]:
    """Return the largest magnitudes among neighbours: a value is found from that of a corner."""
    return tuple(max(map(abs, y[max(k - 1, 0) : k + 2])) for k in range(len(y)))


def _of_binary(e: Binary, below: list[Expr]) -> Expr:
    a, b = e.left, e.right
    if e.op in "+-":
        return _sum(below[0], below[1])
    if e.op == "*":
        return _sum(_times(_size(b), below[0]), _times(_size(a), below[1]))
    if e.op == "/":
        own = _over(below[0], _size(b))
        return own if below[1] == _ZERO else _sum(own, _over(_times(_size(e), below[1]), _size(b)))
    slope = _size(differentiate(Binary("^", Name("law:base"), b), "law:base"))
    by_base = _times(substitute(slope, {"law:base": a}), below[0])
    return _sum(by_base, _size(e))


def _of_call(e: Call, function: str, args: tuple[Expr, ...], below: list[Expr]) -> Expr:
    if function in ("abs", "sign", "floor", "ceil"):
        return below[0] if function == "abs" else _ZERO
    if len(args) == 1:
        slope = _size(differentiate(Call(function, (Name("law:arg"),)), "law:arg"))
        return _sum(_times(substitute(slope, {"law:arg": args[0]}), below[0]), _size(e))
    if function in ("min", "max"):
        return Call("max", tuple(below))
    total: Expr = _size(e)
    for part in below:
        total = _sum(total, part)
    return total


def _size(e: Expr) -> Expr:
    return simplify(Call("abs", (e,)))


def _sum(a: Expr, b: Expr) -> Expr:
    return simplify(Binary("+", a, b))


def _times(a: Expr, b: Expr) -> Expr:
    return simplify(Binary("*", a, b))


def _over(a: Expr, b: Expr) -> Expr:
    return simplify(Binary("/", a, b))
