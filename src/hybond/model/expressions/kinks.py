"""Where an expression has a kink or a jump, which its derivative does not tell, or no value."""

from __future__ import annotations

import math
from itertools import combinations, pairwise

from hybond.model.expressions.bounds import bounds_of
from hybond.model.expressions.differentiate import simplify
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import (
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Number,
    Table,
    fold,
    names,
    transform,
    walk,
    with_children,
)

_SQUARE = Number(2.0)
_STRAIGHT = 1e-14
"""Slopes that differ by no more than this part of them are those of one line."""
PARTIAL = frozenset({"sqrt", "log", "log10", "asin", "acos", "mod", "exp", "sinh", "cosh"})
"""Functions that have no finite value of some numbers."""


def turning(e: Expr) -> list[Expr]:
    """Return what changes its sign where an expression has a kink or a jump.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [str(a) for a in turning(parse("abs(q - 1) + max(q, 2)"))]
    ['q - 1', 'q - 2']
    """
    found: list[Expr] = []
    for part, _ in walk(transform(e, _without_smooth)):
        match part:
            case Call(function="abs"):
                found.append(part.args[0])
            case Call(function="min" | "max"):
                found += [Binary("-", a, b) for a, b in combinations(part.args, 2)]
            case Table():
                found += [Binary("-", part.arg, Number(x)) for x in _corners(part)]
            case _:
                found += _leaping(part)
    return [e for e in dict.fromkeys(found) if names(e)]


def _without_smooth(e: Expr) -> Expr:
    """Return a power of a size that is smooth where that is zero as one that does not turn.

    From the square on it has a curvature there, which is all that steps ask for.
    """
    match e:
        case Binary("^", Call("abs", (under,)), Number(power)) if _is_smooth(power):
            return Binary("^", under, _SQUARE)
    return e


def _is_smooth(power: float) -> bool:
    return not is_slotted(power) and power >= 2.0


def leaping(e: Expr) -> list[Expr]:
    """Return those of `turning` at which it may jump, and not only bend.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [str(a) for a in leaping(parse("abs(q - 1) + sign(q - 2)"))]
    ['q - 2']
    """
    found = [h for part, _ in walk(e) for h in _leaping(part)]
    return [e for e in dict.fromkeys(found) if names(e)]


def _leaping(part: Expr) -> list[Expr]:
    match part:
        case Compare():
            return [Binary("-", part.left, part.right)]
        case Call(function="sign"):
            return [part.args[0]]
        case Call(function="floor" | "ceil"):
            return [_whole(part.args[0])]
        case Call(function="mod"):
            return [_whole(Binary("/", *part.args))]
    return []


def jumping(e: Expr) -> list[Expr]:
    """Return what jumps in an expression, by one at least: signs, whole numbers, truths.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [str(a) for a in jumping(parse("abs(q) + sign(q - 1) + mod(q, 2)"))]
    ['sign(q - 1)', 'mod(q, 2)/2']
    """
    found: list[Expr] = []
    for part, _ in walk(e):
        match part:
            case Compare():
                found.append(If(part, Number(1.0), Number(0.0)))
            case Call(function="sign" | "floor" | "ceil"):
                found.append(part)
            case Call(function="mod"):
                found.append(Binary("/", part, part.args[1]))
    return [e for e in dict.fromkeys(found) if names(e)]


def ending(e: Expr) -> list[Expr]:
    """Return what an expression has no value below zero of: what it takes roots of.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [str(a) for a in ending(parse("sqrt(q - 1) + q^1.5 + q^2 + sqrt(abs(q)/2)"))]
    ['q - 1', 'q']
    """
    found: list[Expr] = []
    for part, _ in walk(e):
        match part:
            case Call(function="sqrt"):
                found.append(part.args[0])
            case Binary("^", left, Number(value)) if _may_be_a_root(value):
                found.append(left)
    return [e for e in dict.fromkeys(found) if names(e) and bounds_of(_moving(e))[0] < 0.0]


def rooted(e: Expr) -> list[Expr]:
    """Return what roots are taken of the size of: at its zero an expression has no finite slope.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [str(a) for a in rooted(parse("sign(q)*sqrt(abs(q)/2) + abs(p - 1)^0.5 + abs(x)^2"))]
    ['q', 'p - 1']
    >>> rooted(parse("q/sqrt(sqrt(q^2 + 1e-4))"))
    []
    """
    found: list[Expr] = []
    for part, _ in walk(e):
        match part:
            case Call(function="sqrt"):
                under = part.args[0]
            case Binary("^", left, Number(value)) if _may_be_a_root(value) and value < 1.0:
                under = left
            case _:
                continue
        if bounds_of(under)[0] > 0.0:
            continue
        sizes = [p.args[0] for p, _ in walk(under) if isinstance(p, Call) and p.function == "abs"]
        found += sizes or [under]
    return [e for e in dict.fromkeys(found) if names(e)]


def clipped(e: Expr) -> list[Expr]:
    """Return those of `turning` at which a limit ends that a root is taken of.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [str(a) for a in clipped(parse("k*sqrt(max(q, 0)/2) + max(p, 1)"))]
    ['q - 0']
    """
    found: list[Expr] = []
    for part, _ in walk(e):
        match part:
            case Call(function="sqrt"):
                under = part.args[0]
            case Binary("^", left, Number(value)) if _may_be_a_root(value) and value < 1.0:
                under = left
            case _:
                continue
        for p, _ in walk(under):
            if isinstance(p, Call) and p.function in ("min", "max"):
                found += [Binary("-", a, b) for a, b in combinations(p.args, 2)]
    return [e for e in dict.fromkeys(found) if names(e)]


def meets(e: Expr, turn: Expr) -> bool:
    """Whether an expression has one value on both sides of where a name is zero, by its form.

    Parameters
    ----------
    e : Expr
        Any expression.
    turn : Expr
        One of `turning`, simplified; of what is no name nothing is known.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> meets(parse("3*sign(q)*sqrt(abs(q)/p)"), parse("q"))
    True
    >>> meets(parse("sign(q)*sqrt(abs(q) + 1)"), parse("q"))
    False
    """
    name = turn.arg if isinstance(turn, Neg) else turn
    if not isinstance(name, Name):
        return False
    return simplify(_beside(e, name, True)) == simplify(_beside(e, name, False))


def _beside(e: Expr, name: Name, above: bool) -> Expr:
    """Return an expression with a name at zero, and what asks for its sign just beside it."""

    def again(node: Expr, _: bool, below: list[Expr]) -> Expr:
        match node:
            case Name() if node == name:
                return Number(0.0)
            case Call(function="sign") | Compare():
                asked = simplify(_leaping(node)[0])
                if asked not in (name, Neg(name)):
                    return with_children(node, tuple(below))
                positive = above == (asked == name)
                if isinstance(node, Call):
                    return Number(1.0 if positive else -1.0)
                return Bool(positive == (node.op in (">", ">=")))
        return with_children(node, tuple(below)) if below else node

    return fold(e, again)


def _may_be_a_root(power: float) -> bool:
    """Whether a power of what is below zero has no value; of a parameter nobody knows."""
    return is_slotted(power) or (power > 0.0 and power % 1.0 != 0.0)


def _moving(e: Expr) -> Expr:
    """Return a product without its constant factors: where it has its sign, they have no say."""
    match e:
        case Binary("*", left, right) if not names(left):
            return _moving(right)
        case Binary("*" | "/", left, right) if not names(right):
            return _moving(left)
    return e


def _corners(table: Table) -> list[float]:
    """Return where a table is bent: a point on a straight line is no corner.

    Of points that follow from parameters nobody knows whether they are on one.
    """
    if any(is_slotted(a) for a in (*table.x, *table.y)):
        return list(table.x[1:-1])
    points = list(zip(table.x, table.y, strict=True))
    slopes = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(points)]
    sides = zip(table.x[1:-1], pairwise(slopes), strict=True)
    return [x for x, (left, right) in sides if not math.isclose(left, right, rel_tol=_STRAIGHT)]


def _whole(e: Expr) -> Expr:
    """Return what changes its sign where an expression is a whole number."""
    return Call("sin", (Binary("*", Number(math.pi), e),))


def may_lack_value(e: Expr) -> bool:
    """Return whether an expression may lack a finite value of finite numbers, by its form.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [may_lack_value(parse(text)) for text in ("p/q", "p/2", "q^2 + abs(p)", "sqrt(q)")]
    [True, False, False, True]
    """
    return any(is_partial(part) for part, _ in walk(e))


def is_partial(e: Expr) -> bool:
    """Return whether an operation has no finite value of some finite numbers."""
    match e:
        case Call():
            return e.function in PARTIAL
        case Binary("/", _, right):
            return not (isinstance(right, Number) and right.value != 0.0)
        case Binary("^", _, right):
            return not (isinstance(right, Number) and right.value in (1.0, 2.0, 3.0))
        case Table():
            return e.extrapolate == "error"
        case _:
            return False
