"""Guards as they are while time passes: what a locator follows."""

from __future__ import annotations

from functools import reduce

from hybond.model.expressions import (
    Binary,
    Call,
    Compare,
    Expr,
    If,
    Neg,
    Number,
    Pre,
    comparisons,
    transform,
)


def seen_in_motion(asked: Expr) -> tuple[Expr, list[Expr]]:
    """Return a guard as it is while time passes, and the differences of its comparisons."""
    guard = transform(asked, _without_pre)
    compared = [c for c in comparisons(guard) if isinstance(c, Compare)]
    return guard, [Binary("-", c.left, c.right) for c in compared]


def magnitude(e: Expr) -> Expr:
    """Return what the magnitudes of the terms of `e` add up to."""
    match e:
        case Binary(op="+" | "-"):
            return Binary("+", magnitude(e.left), magnitude(e.right))
        case Binary(op="*"):
            return Binary("*", magnitude(e.left), magnitude(e.right))
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


def _without_pre(e: Expr) -> Expr:
    return e.arg if isinstance(e, Pre) else e
