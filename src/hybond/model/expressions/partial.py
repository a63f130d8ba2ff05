"""Expressions that have no value of some numbers: roots, logarithms, quotients, tables that end."""

from __future__ import annotations

from hybond.model.expressions.tree import Binary, Call, Expr, Number, Table, walk

PARTIAL = frozenset({"sqrt", "log", "log10", "asin", "acos", "mod", "exp", "sinh", "cosh"})
"""Functions that have no finite value of some numbers."""


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
