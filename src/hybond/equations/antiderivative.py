"""The energy of a storage in closed form, where a formula with points would take many.

A pendulum that turns over, or a magnet that pulls at each tooth, has a law that is a sum of sines
of what it stores, and needs more points with every turn. A contact of Hertz bends where it begins
to push, which has to be looked for.
"""

from __future__ import annotations

from hybond.model.expressions import Binary, Call, Expr, Name, Neg, Number, names, simplify
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import walk

Line = tuple[Expr, Expr]


def known_energy(law: Expr, name: str) -> Expr | None:
    """Return the integral of a law from zero to `name`, None if it takes no closed form.

    It does if there are waves in it, sines and cosines of a straight line, or what pushes one way,
    powers of ``max(line, 0)``; powers may stand beside them. A difference of two cosines is written
    as a product, which has its digits near zero, too. What pushes where nothing is stored is left
    to points, as the energy would be a difference; so is a gap or a power that is a parameter.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> str(known_energy(parse("3*sin(2*q)"), "q"))
    '3*(2*sin(2*q/2)*sin(2*q/2 + 0)/2)'
    >>> str(known_energy(parse("5*max(q - 2, 0)^1.5"), "q"))
    '5*(max(q - 2, 0)^2.5/2.5)'
    >>> known_energy(parse("3*q^2"), "q"), known_energy(parse("sin(q^2)"), "q")
    (None, None)
    """
    if not any(_is_wave(part, name) or _is_push(part, name) for part, _ in walk(law)):
        return None
    return _integral(law, name)


def _is_push(e: Expr, name: str) -> bool:
    """Whether it is ``max(line, 0)`` of a line that is not above zero where nothing is stored."""
    match e:
        case Call(function="max", args=(arg, Number(least))) if name in names(arg):
            line = _line(arg, name)
            if line is None or is_slotted(least) or least != 0.0:
                return False
            begin = simplify(line[1])
            return isinstance(begin, Number) and not is_slotted(begin.value) and begin.value <= 0.0
    return False


def _is_wave(e: Expr, name: str) -> bool:
    return isinstance(e, Call) and e.function in ("sin", "cos") and name in names(e)


def _integral(e: Expr, name: str) -> Expr | None:
    x = Name(name)
    if name not in names(e):
        return Binary("*", e, x)
    match e:
        case Name():
            return Binary("/", Binary("*", x, x), Number(2.0))
        case Neg(arg):
            one = _integral(arg, name)
            return None if one is None else Neg(one)
        case Binary(op="+" | "-" as op, left=left, right=right):
            one, other = _integral(left, name), _integral(right, name)
            return None if one is None or other is None else Binary(op, one, other)
        case Binary(op="*", left=left, right=right) if name not in names(left):
            one = _integral(right, name)
            return None if one is None else Binary("*", left, one)
        case Binary(op="*" | "/" as op, left=left, right=right) if name not in names(right):
            one = _integral(left, name)
            return None if one is None else Binary(op, one, right)
        case Binary(op="^", left=Name(), right=Number(degree)) if not is_slotted(degree):
            up = Number(degree + 1.0)
            whole = degree >= 2.0 and degree == int(degree)
            return Binary("/", Binary("^", x, up), up) if whole else None
        case Binary(op="^", left=Call() as push, right=Number(degree)) if _is_push(push, name):
            if is_slotted(degree) or degree <= 0.0:
                return None
            return _of_push(push, degree + 1.0, name)
        case Call(function="max") if _is_push(e, name):
            return _of_push(e, 2.0, name)
        case Call(function="sin" | "cos" as wave, args=(arg,)):
            line = _line(arg, name)
            return None if line is None else _of_wave(wave, line, x)
    return None


def _of_wave(wave: str, line: Line, x: Expr) -> Expr:
    """Return that of ``wave(slope*x + offset)``: ``2 sin(s x/2) wave(s x/2 + offset)/s``."""
    slope, offset = line
    half = Binary("/", Binary("*", slope, x), Number(2.0))
    middle = Call(wave, (Binary("+", half, offset),))
    product = Binary("*", Binary("*", Number(2.0), Call("sin", (half,))), middle)
    return Binary("/", product, slope)


def _of_push(push: Call, up: float, name: str) -> Expr:
    """Return ``max(line, 0)^up/(up*slope)``."""
    line = _line(push.args[0], name)
    assert line is not None
    slope = simplify(line[0])
    by: Expr = Number(up)
    if slope != Number(1.0):
        by = Binary("*", by, slope)
    return Binary("/", Binary("^", push, Number(up)), by)


def _line(e: Expr, name: str) -> Line | None:
    """Return slope and offset of a straight line, None if it is none."""
    if name not in names(e):
        return Number(0.0), e
    match e:
        case Name():
            return Number(1.0), Number(0.0)
        case Neg(arg):
            line = _line(arg, name)
            return None if line is None else (Neg(line[0]), Neg(line[1]))
        case Binary(op="+" | "-" as op, left=left, right=right):
            one, other = _line(left, name), _line(right, name)
            if one is None or other is None:
                return None
            if name not in names(right):
                return one[0], Binary(op, one[1], right)
            if name not in names(left):
                return (other[0] if op == "+" else Neg(other[0])), Binary(op, left, other[1])
            return Binary(op, one[0], other[0]), Binary(op, one[1], other[1])
        case Binary(op="*", left=left, right=right) if name not in names(left):
            line = _line(right, name)
            return None if line is None else _scaled(line, "*", left)
        case Binary(op="*" | "/" as op, left=left, right=right) if name not in names(right):
            line = _line(left, name)
            return None if line is None else _scaled(line, op, right)
    return None


def _scaled(line: Line, op: str, by: Expr) -> Line:
    slope, offset = line
    one: Expr = by if op == "*" and slope == Number(1.0) else Binary(op, slope, by)
    return one, offset if offset == Number(0.0) else Binary(op, offset, by)
