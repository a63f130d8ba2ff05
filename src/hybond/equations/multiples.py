"""Expressions that are multiples of each other.

A limited gain that reads a difference has two slopes, ``s`` and ``-s``: one number that is not
known, and not two. If it reads its own value as well, one of them is ``1 + s``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from hybond.equations.one_sign import one_sign
from hybond.model.expressions import Binary, Expr, If, Neg, Number
from hybond.records import dataclass

_ONE = Number(1.0)


@dataclass(frozen=True)
class Multiple:
    """An expression as ``beside + times * e``, where `like` is the first such one that is of e.

    `sign` is that of e, wherever it is told: 1, -1 or 0.
    """

    like: int
    times: float
    beside: float
    sign: int


def multiples(found: Sequence[Expr]) -> list[Multiple]:
    """Return of each expression what it is a multiple of.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> found = multiples([parse("-2*exp(x)"), parse("1 + exp(x)*6")])
    >>> [(m.like, m.times, m.beside) for m in found]
    [(0, -2.0, 0.0), (0, 6.0, 1.0)]
    """
    first: dict[Expr, int] = {}
    told = []
    for i, e in enumerate(found):
        beside, rest = _apart(e)
        times, rest = _split(rest)
        like = i if _is_zero(times) else first.setdefault(rest, i)
        told.append(Multiple(like, times, beside, one_sign(rest)))
    many = Counter(part.like for part in told)
    # what stands alone is as it is: of `1 - s` more is known than of both
    return [
        part if many[part.like] > 1 else Multiple(i, 1.0, 0.0, one_sign(e))
        for i, (e, part) in enumerate(zip(found, told, strict=True))
    ]


def _apart(e: Expr) -> tuple[float, Expr]:
    """Return the number that an expression has as a term, and the rest of it."""
    match e:
        case Neg(a):
            beside, rest = _apart(a)
            return -beside, Neg(rest)
        case Binary("+", Number(value), rest) | Binary("+", rest, Number(value)):
            return value, rest
        case Binary("-", rest, Number(value)):
            return -value, rest
        case Binary("-", Number(value), rest):
            return value, Neg(rest)
    return 0.0, e


def _split(e: Expr) -> tuple[float, Expr]:
    """Return a number, and what an expression is a multiple of by it."""
    match e:
        case Number(value):
            return value, _ONE
        case Neg(a):
            factor, rest = _split(a)
            return -factor, rest
        case Binary("*", a, b):
            (k, left), (n, right) = _split(a), _split(b)
            return k * n, _product(left, right)
        case Binary("/", a, b):
            (k, left), (n, right) = _split(a), _split(b)
            if not _is_zero(n):
                return k / n, left if right is _ONE else Binary("/", left, right)
        case Binary("+" | "-" as op, a, b):
            (k, left), (n, right) = _split(a), _split(b)
            if not _is_zero(k):
                ratio = n / k if op == "+" else -n / k
                return k, Binary("+", left, _product(Number(ratio), right))
        case If(cond, then, orelse):
            (k, one), (n, other) = _split(then), _split(orelse)
            if _is_zero(k):
                return n, If(cond, Number(0.0), other)
            return k, If(cond, one, _product(Number(n / k), other))
    return 1.0, e


def _product(a: Expr, b: Expr) -> Expr:
    if a is _ONE:
        return b
    return a if b is _ONE else Binary("*", a, b)


def _is_zero(factor: float) -> bool:
    """Whether a number is zero; one that follows from parameters writes down that it was asked."""
    return bool(factor == 0.0)
