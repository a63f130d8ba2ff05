"""Guards that compare a product or a power with zero, as comparisons of what these are made of.

``x*x*x < 0`` says ``x < 0``, and ``abs(x) <= 0`` says that x is zero. The product is flat where it
crosses, and the magnitude touches zero at one instant: neither is seen by samples as exactly as the
zeros of x are. So the motion is followed by these; an instant is settled by the guard as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from hybond.model.expressions import (
    And,
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    Neg,
    Not,
    Number,
    Or,
    comparisons,
    transform,
)
from hybond.model.expressions.slots import is_slotted

_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_DENIED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}
_ZERO = Number(0.0)
_TRUE, _FALSE = Bool(True), Bool(False)
MOST_TURNING = 3
"""Factors of a product that change its sign, up to which all their signs are gone through."""
MOST_LEAVES = 16
"""Comparisons of one that is split, at the most."""


def factored_guard(guard: Expr) -> Expr:
    """Return a guard in which products and powers that are compared with zero are split.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> for text in ("x*x*x < 0", "abs(x - 1) <= 0", "x*abs(x) >= 0", "x^2*y < 0", "x*y > 1"):
    ...     print(factored_guard(parse(text)))
    x < 0
    x - 1 <= 0 and x - 1 >= 0
    x >= 0
    (x > 0 or x < 0) and y < 0
    x*y > 1
    """
    return transform(guard, _split)


def asks_both_sides(guard: Expr) -> bool:
    """Whether a guard asks whether something is zero, and not on which side of that.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> [asks_both_sides(parse(t)) for t in ("x <= 1 and x >= 1", "x <= 1 and y >= 1")]
    [True, False]
    """
    sides: dict[tuple[Expr, Expr], set[str]] = {}
    for c in comparisons(guard):
        if isinstance(c, Compare) and c.op in _TURNED:
            sides.setdefault((c.left, c.right), set()).add(c.op)
    return any({"<=", ">="} <= ops or {"<", ">"} <= ops for ops in sides.values())


def _split(e: Expr) -> Expr:
    if not isinstance(e, Compare) or e.op not in _TURNED:
        return e
    op, of = e.op, e.left
    if _is_zero(of):
        op, of = _TURNED[op], e.right
    elif not _is_zero(e.right):
        return e
    found = _sign(op, of)
    plain = found == Compare(op, of, _ZERO) or isinstance(found, Bool)
    return e if plain or _leaves(found) > MOST_LEAVES else found


def _is_zero(e: Expr) -> bool:
    return isinstance(e, Number) and e.value == 0.0 and not is_slotted(e.value)


def _leaves(e: Expr) -> int:
    return sum(map(_leaves, e.args)) if isinstance(e, (And, Or)) else 1


def _sign(op: str, e: Expr) -> Expr:
    """Return what says that `e` compares so with zero."""
    match e:
        case Neg():
            return _sign(_TURNED[op], e.arg)
        case Call(function="sign"):
            return _sign(op, e.args[0])
        case Call(function="min" | "max"):
            signs = [_sign(op, a) for a in e.args]
            if signs == [Compare(op, a, _ZERO) for a in e.args]:
                return Compare(op, e, _ZERO)  # one surface, along which a motion may slide
            each = (e.function == "min") == (op in (">", ">="))
            return (_all if each else _any)(signs)
        case Binary(op="*" | "/" | "^") | Call(function="abs" | "sqrt"):
            return _of_product(op, e)
        case Binary(op="+") | Call(function="hypot") if _is_magnitude(e):
            return _of_magnitude(op, [e])
    return Compare(op, e, _ZERO)


def _of_product(op: str, e: Expr) -> Expr:
    """Return the same of a product: its sign is that of its odd factors, unless one is zero."""
    factors = _factors(e)
    if factors is None:
        return Compare(op, e, _ZERO)
    turned = False
    bases: dict[Expr, bool] = {}
    for base, odd in factors:
        if isinstance(base, Number):
            turned = turned != (odd and base.value < 0.0)
        else:
            bases[base] = bases.get(base, False) != odd
    turning = [base for base, odd in bases.items() if odd]
    if len(turning) > MOST_TURNING or list(bases) == [e]:
        return Compare(op, e, _ZERO)
    way = _TURNED[op] if turned else op
    touching = [_of_magnitude(">", [base]) for base, odd in bases.items() if not odd]
    if not turning:
        within = {">=": _TRUE, "<": _FALSE, ">": _all(touching)}
        return within[way] if way in within else _denied(_all(touching))
    signs = reduce(_product_of_signs, [(_sign(">", b), _sign("<", b)) for b in turning])
    strict = _all([*touching, signs[0] if way in (">", "<=") else signs[1]])
    return strict if way in (">", "<") else _denied(strict)


def _product_of_signs(a: tuple[Expr, Expr], b: tuple[Expr, Expr]) -> tuple[Expr, Expr]:
    """Return what says that a product is more than zero, and less, given that of its factors."""
    more = _any([_all([a[0], b[0]]), _all([a[1], b[1]])])
    return more, _any([_all([a[0], b[1]]), _all([a[1], b[0]])])


def _factors(e: Expr) -> list[tuple[Expr, bool]] | None:
    """Return what a product is made of, and whether its sign changes with that; None: unknown."""
    match e:
        case Neg():
            below = _factors(e.arg)
            return None if below is None else [(Number(-1.0), True), *below]
        case Binary(op="*"):
            left, right = _factors(e.left), _factors(e.right)
            return None if left is None or right is None else left + right
        case Binary("/", left, Number() as below) if _is_known(below) and below.value != 0.0:
            above = _factors(left)
            return None if above is None else [*above, (below, True)]
        case Binary("^", base, Number() as power) if _is_known(power) and _is_whole(power.value):
            inner = _factors(base)
            odd = power.value % 2.0 == 1.0
            return None if inner is None else [(b, o and odd) for b, o in inner]
        case Call(function="abs"):
            inner = _factors(e.args[0])
            return None if inner is None else [(b, False) for b, _ in inner]
        case Call(function="sqrt") if _is_magnitude(e.args[0]):
            return _factors(e.args[0])
        case Call(function="sign"):
            return _factors(e.args[0])
        case Number():
            return [(e, True)] if _is_known(e) and e.value != 0.0 else None
    return [(e, True)]


def _is_known(e: Number) -> bool:
    return not is_slotted(e.value) and e.value == e.value


def _is_whole(power: float) -> bool:
    return 1.0 <= power <= 64.0 and power % 1.0 == 0.0


def _is_magnitude(e: Expr) -> bool:
    """Whether an expression is nowhere less than zero, and zero only where all of it is."""
    match e:
        case Call(function="abs" | "hypot"):
            return True
        case Call(function="sqrt"):
            return _is_magnitude(e.args[0])
        case Binary("^", _, Number() as power) if _is_known(power) and _is_whole(power.value):
            return power.value % 2.0 == 0.0 or _is_magnitude(e.left)
        case Binary(op="+"):
            return _is_magnitude(e.left) and _is_magnitude(e.right)
        case Binary("*", left, right):
            return left == right or (_is_magnitude(left) and _is_magnitude(right))
        case Binary("/", left, right):
            return _is_magnitude(left) and isinstance(right, Number) and _is_magnitude(right)
        case Number():
            return _is_known(e) and e.value > 0.0
    return False


def _of_magnitude(op: str, parts: Sequence[Expr]) -> Expr:
    """Return what says that a sum of magnitudes compares so with zero."""
    if op in (">=", "<"):
        return _TRUE if op == ">=" else _FALSE
    clear: list[Expr] = []
    for part in parts:
        match part:
            case Call(function="hypot"):
                clear.append(_of_magnitude(">", part.args))
            case Binary(op="+") if _is_magnitude(part):
                clear.append(_of_magnitude(">", [part.left, part.right]))
            case _ if _is_magnitude(part):
                clear.append(_of_product(">", part))
            case _:
                clear.append(_any([Compare(">", part, _ZERO), Compare("<", part, _ZERO)]))
    return _any(clear) if op == ">" else _denied(_any(clear))


def _all(args: Sequence[Expr]) -> Expr:
    return _joined(And, args, _FALSE, _TRUE)


def _any(args: Sequence[Expr]) -> Expr:
    return _joined(Or, args, _TRUE, _FALSE)


def _joined(kind: type[And] | type[Or], args: Sequence[Expr], ends: Expr, nothing: Expr) -> Expr:
    """Return all of some conditions, or any, without those that change nothing."""
    if ends in args:
        return ends
    left = tuple(dict.fromkeys(a for a in args if a != nothing))
    return nothing if not left else left[0] if len(left) == 1 else kind(left)


def _denied(e: Expr) -> Expr:
    """Return what is true where `e` is not."""
    match e:
        case And():
            return _any([_denied(a) for a in e.args])
        case Or():
            return _all([_denied(a) for a in e.args])
        case Bool():
            return Bool(not e.value)
        case Compare():
            return Compare(_DENIED[e.op], e.left, e.right)
    return Not(e)
