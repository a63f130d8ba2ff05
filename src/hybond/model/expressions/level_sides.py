"""Whether an expression goes on where two things that it compares are equal, by its form.

An orifice by ISO 6358 asks which of two pressures is higher, and takes a root of what their ratio
leaves of one. That is zero where they are equal, whichever side is asked; computed, it is the root
of rounding, which would look like a jump to and fro.
"""

from __future__ import annotations

import math

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
    fold,
    walk,
    with_children,
)

_ROUNDING = 8.0 * 2.0**-53
"""Part of its terms that is the rounding of a difference of numbers."""
_ZERO = Number(0.0)
_ONE = Number(1.0)


def joins(e: Expr, turn: Expr) -> bool:
    """Whether an expression has one value on both sides of where a difference is zero.

    Parameters
    ----------
    e : Expr
        Any expression.
    turn : Expr
        What changes its sign there: a difference, or what is alone.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> joins(parse("if a > b then a*sqrt(1 - ((b/a - 0.2)/0.8)^2) else -b*sqrt(b - a)"),
    ...       parse("a - b"))
    True
    >>> joins(parse("sign(a - b)*sqrt(1.1 - min(a, b)/max(a, b))"), parse("a - b"))
    False
    """
    bare = simplify(turn)
    while isinstance(bare, Neg):
        bare = bare.arg
    if not isinstance(bare, Name | Binary):
        return False
    above = _beside(e, bare, True)
    return above is not None and above == _beside(e, bare, False)


def _beside(e: Expr, turn: Name | Binary, above: bool) -> Expr | None:
    """Return an expression with a difference at zero, and its sign that of one side.

    None where something else jumps there, or may do so.
    """
    first, second = _equal_there(turn)
    if any(part == first for part, _ in walk(second)):
        return None
    doubts = False

    def again(node: Expr, _: bool, below: list[Expr]) -> Expr:
        nonlocal doubts
        if node == first:
            return second
        if isinstance(node, Compare) or (isinstance(node, Call) and node.function == "sign"):
            way = _way(node, turn)
            if way != 0:
                positive = above == (way > 0)
                if isinstance(node, Call):
                    return Number(1.0 if positive else -1.0)
                return Bool(positive == (node.op in (">", ">=")))
        found = _at_level(with_children(node, tuple(below)) if below else node)
        if _leaps(found) and any(part == first for part, _ in walk(node)):
            doubts = True
        return found

    found = fold(e, again)
    return None if doubts else found


def _equal_there(turn: Name | Binary) -> tuple[Expr, Expr]:
    """Return what is to be replaced, and by what, where a difference is zero."""
    match turn:
        case Binary("-", left, Binary("-" | "+", first, Name() as apart)) if left == first:
            return apart, _ZERO
        case Binary("-", Binary("-" | "+", first, Name() as apart), right) if right == first:
            return apart, _ZERO
        case Binary("-", Number() as left, right):
            return right, left
        case Binary("-", left, right):
            return left, right
    return turn, _ZERO


def _leaps(e: Expr) -> bool:
    """Whether an operation jumps somewhere."""
    jumps = ("sign", "floor", "ceil", "mod")
    return isinstance(e, Compare) or (isinstance(e, Call) and e.function in jumps)


def _way(node: Compare | Call, turn: Expr) -> int:
    """Return 1 where a sign or a comparison is of a difference, -1 of minus it, else 0."""
    asked = (
        simplify(node.args[0])
        if isinstance(node, Call)
        else simplify(Binary("-", node.left, node.right))
    )
    if asked == turn:
        return 1
    match asked:
        case Binary("-", left, right) if Binary("-", right, left) == turn:
            return -1
        case Neg(arg) if arg == turn:
            return -1
    return 0


def _at_level(e: Expr) -> Expr:
    """Return an operation on what is equal as what it is, without its rounding."""
    match e:
        case Neg(Number(x)) if _is_plain(x):
            return Number(-x + 0.0)
        case Binary("-", left, right) if left == right:
            return _ZERO
        case Binary("/", left, right) if left == right and right != _ZERO:
            return _ONE
        case Binary(op, Number(x), Number(y)) if _is_plain(x) and _is_plain(y):
            return _computed(e, op, x, y)
        case Binary("*", left, right) if _ZERO in (left, right):
            return _ZERO
        case Binary("/", left, _) if left == _ZERO:
            return _ZERO
        case Binary("^", Number(x), _) if _is_plain(x) and x == 1.0:
            return _ONE
        case Binary("+", left, right) if left == _ZERO:
            return right
        case Binary("+" | "-", left, right) if right == _ZERO:
            return left
        case If(Bool(holds), then, orelse):
            return then if holds else orelse
        case If(_, then, orelse) if then == orelse:
            return then
        case Compare(op, Number(x), Number(y)) if _is_plain(x) and _is_plain(y):
            return _compared(e, op, x, y)
        case Compare(op, left, Binary("*", Number(part), right)) if left == right:
            return _compared(e, op, 1.0, part) if _is_part(part) else e
        case Compare(op, left, Binary("*", right, Number(part))) if left == right:
            return _compared(e, op, 1.0, part) if _is_part(part) else e
        case Call(function, args):
            return _called(e, function, args)
    return e


def _computed(e: Expr, op: str, x: float, y: float) -> Expr:
    """Return what an operation makes of two numbers; a difference that is rounding is none."""
    if op in ("+", "-"):
        total = x + y if op == "+" else x - y
        return _ZERO if abs(total) <= _ROUNDING * (abs(x) + abs(y)) else Number(total)
    if op == "*":
        return Number(x * y + 0.0)
    if op == "/" and y != 0.0:
        return Number(x / y + 0.0)
    if op == "^" and x >= 0.0 and (x > 0.0 or y > 0.0):
        return Number(math.pow(x, y))
    return e


def _compared(e: Expr, op: str, x: float, y: float) -> Expr:
    """Return what a comparison of two numbers says, where these are not nearly the same."""
    if abs(x - y) <= _ROUNDING * (abs(x) + abs(y)) or op not in ("<", "<=", ">", ">="):
        return e
    return Bool((x < y) == (op in ("<", "<=")))


def _called(e: Expr, function: str, args: tuple[Expr, ...]) -> Expr:
    """Return what a function makes of what is equal, or of numbers."""
    if function in ("min", "max"):
        kept = tuple(dict.fromkeys(args))
        if len(kept) == 1:
            return kept[0]
        known = [a.value for a in kept if isinstance(a, Number) and _is_plain(a.value)]
        if len(known) == len(kept):
            return Number(min(known) if function == "min" else max(known))
    elif function in ("sqrt", "abs") and isinstance(args[0], Number):
        x = args[0].value
        if _is_plain(x) and (x >= 0.0 or function == "abs"):
            return Number(math.sqrt(x) if function == "sqrt" else abs(x))
    return e


def _is_part(x: float) -> bool:
    """Whether a number makes less of a pressure, which is above zero where ratios of it count."""
    return _is_plain(x) and 0.0 < x < 1.0


def _is_plain(x: float) -> bool:
    return not is_slotted(x)
