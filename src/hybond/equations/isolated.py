"""Whether a slope is zero at points only, by its form: what structure must not take for none.

The slope of ``v*abs(v)^3`` is zero at 0 and beside it is not; that of ``max(0, v)`` is zero along a
half line. A formula of powers alone is analytic wherever no size or sign turns, so it is zero at
points only or everywhere between: one value that is not zero tells the two apart. What ends in a
limit, as ``tanh(v)`` or ``exp(v)`` do, is left out: numbers have no slope there, along a ray.
"""

from __future__ import annotations

import math
from functools import partial

from hybond.equations.rounding import rounding
from hybond.model.expressions import (
    Binary,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Number,
    Pre,
    compile_expression,
    names,
    simplify,
)
from hybond.model.expressions.slots import is_slotted, plain
from hybond.model.expressions.tree import transform, walk

_MOST = 4
"""Sizes, signs and choices that are gone through on both sides, at the most: 16 formulas."""
_ROUNDING = 1e-9
"""Part of what its rounding is measured by that a value must be: at numbers about 1 a formula has
some 1e-15 of that."""
_AT = (0.6180339887, -1.4142135624, 2.7182818285, -0.3010299957)
"""Where it is asked: both signs, and no whole numbers, since these are where laws have zeros."""
_NEXT = 1.0594630944
"""What the value of a name is more than that of the one before: differences are not zero."""
_GROWS = ("sinh", "cosh")
"""Functions without a limit; as denominators they have one."""


def isolated(slope: Expr) -> bool:
    """Whether a slope that is zero somewhere is so at points only; False where that is not known.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> isolated(parse("5*abs(v/40)^4")), isolated(parse("1 + sign(v)")), isolated(parse("exp(v)"))
    (True, False, False)
    """
    if not all(_is_algebraic(part) for part, _ in walk(slope)):
        return False
    formulas = _formulas(transform(slope, _as_it_is), _MOST)
    return formulas is not None and all(map(_is_somewhere, formulas))


def _is_algebraic(e: Expr) -> bool:
    """Whether a part is made of powers, or of what grows without a limit both ways."""
    match e:
        case Number() | Name() | Pre() | Neg() | Compare() | If():
            return True
        case Binary("^", _, power):
            return isinstance(power, Number)
        case Binary("/", _, below):
            grows = (isinstance(p, Call) and p.function in _GROWS for p, _ in walk(below))
            return not any(grows)
        case Binary():
            return True
        case Call(function):
            return function in ("abs", "sign", "sqrt", *_GROWS)
    return False


def _as_it_is(e: Expr) -> Expr:
    """Return a number that follows from parameters as a plain one, and write down if it is zero."""
    if isinstance(e, Number) and is_slotted(e):
        return Number(plain(e.value) if e.value != 0.0 else 0.0, e.dimension)
    return e


def _formulas(e: Expr, left: int) -> list[Expr] | None:
    """Return the formulas an expression is made of, one for each way it turns; None: too many."""
    turn = _first_turn(e)
    if turn is None:
        return [simplify(e)]
    if left == 0:
        return None
    found: list[Expr] = []
    for above in (True, False):
        side = partial(_on_side, turn=turn, above=above)
        below = _formulas(transform(e, side), left - 1)
        if below is None:
            return None
        found += below
    return found


def _first_turn(e: Expr) -> Expr | None:
    """Return a condition, or else what a size or sign is taken of in which nothing turns."""
    found = None
    for part, _ in walk(e):
        if isinstance(part, If):
            return part.cond
        if isinstance(part, Call) and part.function in ("abs", "sign"):
            found = part.args[0]
    return found


def _on_side(part: Expr, turn: Expr, *, above: bool) -> Expr:
    """Return a part where what turns is true, or more than zero, and where it is not."""
    match part:
        case If(cond, then, orelse) if cond == turn:
            return then if above else orelse
        case Call("abs", (under,)) if under == turn:
            return under if above else Neg(under)
        case Call("sign", (under,)) if under == turn:
            return Number(1.0 if above else -1.0)
    return part


def _is_somewhere(e: Expr) -> bool:
    """Whether a formula has a value that is neither zero nor rounding."""
    slot = {name: k for k, name in enumerate(sorted(names(e)))}
    many = len(slot)
    value = compile_expression(e, slot, pre_offset=many)
    terms = compile_expression(rounding(e), slot, pre_offset=many)
    for at in _AT:
        v = [at * _NEXT**k for k in range(2 * many)]
        found, size = float(value(v)), float(terms(v))
        if math.isfinite(found) and found != 0.0 and abs(found) > _ROUNDING * size:
            return True
    return False
