"""Terms of solved rows as expressions, with their signs in front."""

from __future__ import annotations

from typing import Any

from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.show import to_expr
from hybond.export.modelica.solve import Form
from hybond.model.expressions import Binary, Expr, Neg, Number, transform


def term(form: Form, coefficient: Any, name: str = "") -> Expr:
    """Return a coefficient of a row of `form`, times what stands under a canonical name."""
    factor = coefficient * Rational.atom(name) if name else coefficient
    return to_expr(factor, meaning=form.ring.meaning, order=_order)


def total(terms: list[Expr]) -> Expr:
    """Return a sum, without terms that are zero."""
    found: Expr | None = None
    for given in terms:
        e = transform(given, _sign_first)
        if e == Number(0.0):
            continue
        if found is None:
            found = e
        elif isinstance(e, Neg):
            found = Binary("-", found, e.arg)
        else:
            found = Binary("+", found, e)
    return Number(0.0) if found is None else found


def _order(atom: str) -> tuple[int, str]:
    return (0 if atom.startswith("p:") else 1, atom)


def _sign_first(e: Expr) -> Expr:
    """Return a product with its sign in front: ``-(a*b)`` rather than ``(-a)*b``."""
    match e:
        case Number(value=value) if value < 0.0:
            return Neg(Number(-value, e.dimension))
        case Binary(op=("*" | "/") as op, left=Neg(arg=left), right=Neg(arg=right)):
            return Binary(op, left, right)
        case Binary(op=("*" | "/") as op, left=Neg(arg=left)):
            return Neg(Binary(op, left, e.right))
        case Binary(op=("*" | "/") as op, right=Neg(arg=right)):
            return Neg(Binary(op, e.left, right))
        case Binary(op="+", right=Neg(arg=right)):
            return Binary("-", e.left, right)
        case Binary(op="-", right=Neg(arg=right)):
            return Binary("+", e.left, right)
        case Neg(arg=Neg(arg=inside)):
            return inside
    return e
