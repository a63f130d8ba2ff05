"""Straight lines between points, as a sum: ``table(x, x0, y0, x1, y1, ...)``.

Each line adds its slope times how far the argument has gone along it, from one point to the next.
So units are checked as those of any sum, values may be expressions of parameters or signals, and
corners are those of ``min`` and ``max``.
"""

from __future__ import annotations

from collections.abc import Sequence

from hybond.model.expressions.tree import Binary, Call, Expr, Neg, Number


def lines_between(x: Expr, at: Sequence[Expr], values: Sequence[Expr], *, held: bool) -> Expr:
    """Return the lines that join values at ascending arguments.

    Parameters
    ----------
    x : Expr
        Where to read them.
    at, values : sequence of Expr
        The points.
    held : bool
        Whether the value beyond an end is that of the end; else the line there goes on.
    """
    terms = [values[0]]
    for k in range(1, len(at)):
        inner = x
        if k > 1 or held:
            inner = Call("max", (inner, at[k - 1]))
        if k < len(at) - 1 or held:
            inner = Call("min", (inner, at[k]))
        rise, run = (Binary("-", of[k], of[k - 1]) for of in (values, at))
        along = Binary("-", inner, at[k - 1])
        terms.append(Binary("*", Binary("/", rise, run), along))
    return summed(terms)


def number_of(e: Expr) -> float | None:
    """Return the number that a point is at, its sign before it or not; None if it is none."""
    match e:
        case Number(value):
            return float(value)
        case Neg(Number(value)):
            return -float(value)
    return None


def summed(terms: Sequence[Expr]) -> Expr:
    """Return a sum by halves, so that many terms are no deep expression."""
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return Binary("+", summed(terms[:half]), summed(terms[half:]))
