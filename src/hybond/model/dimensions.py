"""The dimension of an expression, and what does not fit in it."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

from hybond.errors import UnitError
from hybond.model.expressions.parse import TIMERS
from hybond.model.expressions.slots import plain, settled
from hybond.model.expressions.text import to_text
from hybond.model.expressions.tree import (
    And,
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    fold,
    walk,
)
from hybond.names import did_you_mean
from hybond.records import dataclass
from hybond.units import DIMENSIONLESS, Dimension, parse_unit


@dataclass(frozen=True, slots=True)
class _Plain:
    """A number without a unit; it may stand for a quantity of any dimension."""


@dataclass(frozen=True, slots=True)
class _Scaled:
    """A quantity times plain numbers, which may have carried a unit."""

    dimension: Dimension


class Loose(Dimension):
    """The dimension of a signal whose rate has plain numbers as factors: it contradicts nothing.

    Examples
    --------
    >>> Loose(parse_unit("V")[1].exponents) == parse_unit("V")[1]
    True
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Dimension) and self.exponents == other.exponents

    def __hash__(self) -> int:
        return hash(Dimension(self.exponents))


_PLAIN = _Plain()
_TIME = parse_unit("s")[1]
RATED = ("sin", "cos", "tan", "exp")
"""Functions that are taken of a frequency times a time."""
_Found = Dimension | _Scaled | _Plain | None


def infer_dimension(
    e: Expr,
    lookup: Callable[[str], Dimension | None],
    *,
    where: str = "",
    certain: bool = False,
) -> Dimension | None:
    """Return the dimension of `e`, or None where it is unknown.

    A number without a unit fits everywhere: ``x + 1`` has the dimension of ``x``, and in
    ``sin(314*time)`` the number may be a frequency. A number times a quantity keeps the dimension
    of the quantity; a number times a dimensionless value is again just a number, so ``5*sin(w)``
    may be a voltage. An unknown factor makes a product unknown.

    Parameters
    ----------
    lookup : callable
        From a path to its dimension, or None where it is unknown.
    where : str
        Path of the expression in the model, for messages.
    certain : bool
        Return None as well where a plain number is a factor, which may carry a unit.

    Raises
    ------
    UnitError
        HB-U102 if two dimensions meet that should be the same, HB-U106 for a dimension where a
        plain number has to stand.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> from hybond.units import parse_unit
    >>> units = {"m": "kg", "v": "m/s", "h": "m"}
    >>> lookup = lambda path: parse_unit(units[path])[1]
    >>> print(infer_dimension(parse("0.5*m*v^2"), lookup))
    J
    >>> infer_dimension(parse("m + h"), lookup, where="ball.law")
    Traceback (most recent call last):
        ...
    hybond.errors.UnitError: HB-U102 at ball.law: 'm' in kg and 'h' in m do not add up
      try: give both sides the same unit
    """

    def node(e: Expr, prior: bool, below: list[_Found]) -> _Found:
        return _node(e, below, lookup, where)

    found = fold(e, node)
    return _known(found) if not certain else found if isinstance(found, Dimension) else None


def _known(found: _Found) -> Dimension | None:
    """Return the dimension, None for an unknown one and for a plain number."""
    if isinstance(found, _Scaled):
        return found.dimension
    return found if isinstance(found, Dimension) else None


def _shown(e: Expr) -> str:
    text = to_text(e)
    return repr(text if len(text) <= 60 else text[:57] + "...")


def _same(args: tuple[Expr, ...], below: list[_Found], verb: str, where: str) -> _Found:
    """Return the one dimension of values that have to agree."""
    result: _Found = _PLAIN
    first: tuple[Expr, Dimension] | None = None
    for e, found in zip(args, below, strict=True):
        dimension = _known(found)
        if dimension is None:
            if found is None and first is None:
                result = None
        elif first is None:
            first, result = (e, dimension), found
        elif first[1] != dimension and (isinstance(found, _Scaled) or isinstance(result, _Scaled)):
            # the number in 100*q may be a stiffness: it contradicts nothing
            first, result = (
                (first, result) if isinstance(result, Dimension) else ((e, dimension), found)
            )
        elif first[1] != dimension:
            why = f"{_shown(first[0])} in {first[1]} and {_shown(e)} in {dimension} do not {verb}"
            hint = "give both sides the same unit"
            if any(_number_times_more(side) for side in (first[0], e)):
                hint += "; a unit of several symbols stands in brackets, as in 2 [N*m]"
            raise UnitError(why, code="HB-U102", where=where, hint=hint)
    return result


def instead_of(name: str, known: list[str]) -> str:
    """Return a remedy for a name that is not known, which may be a unit or the time.

    Examples
    --------
    >>> instead_of("m", ["T"]), instead_of("t", ["T", "time"])
    ("known names: T; if 'm' is a unit, it stands in brackets: 2 [N*m]", 'the time is named time')
    >>> instead_of("C", ["C.e", "C.q", "T"])
    "did you mean 'C.e', 'C.q'?"
    """
    if name == "t" and "time" in known:
        return "the time is named time"
    if name in TIMERS:
        return TIMERS[name]
    own = sorted({k for k in known if k.startswith(f"{name}.")} if "." not in name else ())
    hint = f"did you mean {', '.join(map(repr, own[:3]))}?" if own else did_you_mean(name, known)
    if own and name not in _COMPOUND:
        # an element, which is no value: one of its values is meant
        return hint
    try:
        parse_unit(name)
    except UnitError:
        if hint.startswith("did you") or not name.isidentifier():
            return hint
        return f"{hint}; a value of its own is declared under parameters" if hint else ""
    brackets = f"if {name!r} is a unit, it stands in brackets: 2 [{_COMPOUND.get(name, name)}]"
    return f"{hint}; {brackets}" if hint else brackets


def powered(name: str) -> str:
    """Return a remedy for the power of a unit that is written as ``s2``, else nothing.

    Examples
    --------
    >>> powered("s2"), powered("R2")
    ("if a unit is meant, write 's^2'", '')
    """
    match = re.fullmatch(r"([a-zA-Z]+)([2-9])", name)
    try:
        known = match is not None and bool(parse_unit(match[1]))
    except UnitError:
        known = False
    return f"if a unit is meant, write '{match[1]}^{match[2]}'" if match and known else ""


_COMPOUND = {"m": "N*m", "s": "m/s", "rad": "rad/s", "N": "N*m"}
"""Units in which a symbol is often met behind another one."""


def _number_times_more(e: Expr) -> bool:
    """Return whether it may be a number in two units of which one was read as a name."""
    match e:
        case Binary("*" | "/", Number(_, Dimension())):
            return True
        case Neg(inner) | Binary("*" | "/", inner, _):
            return _number_times_more(inner)
    return False


def _number_only(e: Expr, found: _Found, of: str, where: str) -> None:
    if isinstance(found, Dimension) and found != DIMENSIONLESS:
        why = f"{of} takes a plain number, {_shown(e)} is in {found}"
        text = to_text(e)[:40]
        hint = f"divide by a reference: ({text})/(1 [{found}])"
        if found == _TIME and of in RATED:
            hint = f"write {of}(1*{text}), where the 1 is a frequency in rad/s, or {hint}"
        raise UnitError(why, code="HB-U106", where=where, hint=hint)


def _product(a: _Found, b: _Found, sign: int) -> _Found:
    if a is None or b is None:
        return None
    x, y = _known(a), _known(b)
    if x is None and y is None:
        return _PLAIN
    dimension = (x or DIMENSIONLESS) * (y or DIMENSIONLESS) ** sign
    if isinstance(a, Dimension) and isinstance(b, Dimension):
        return dimension
    return _PLAIN if dimension == DIMENSIONLESS else _Scaled(dimension)


def _exponent(e: Expr) -> Fraction | None:
    """Return the value of a literal exponent such as ``-2`` or ``1/2``."""
    match e:
        case Number(number, None) if abs(value := plain(number)) < 100:
            near = Fraction(value).limit_denominator(12)
            return near if float(near) == value else None
        case Neg(arg):
            inner = _exponent(arg)
            return None if inner is None else -inner
        case Binary("/", Number(a, None), Number(b, None)):
            one, other = plain(a), plain(b)
            return Fraction(one) / Fraction(other) if other and abs(one / other) < 100 else None
    return None


def _power(base: _Found, n: Fraction) -> _Found:
    if isinstance(base, Dimension):
        return base**n
    return _Scaled(base.dimension**n) if isinstance(base, _Scaled) else base


def _node(
    e: Expr, below: list[_Found], lookup: Callable[[str], Dimension | None], where: str
) -> _Found:
    match e:
        case Name(path):
            found = lookup(path)
            return _Scaled(Dimension(found.exponents)) if isinstance(found, Loose) else found
        case Number(_, dimension):
            return _PLAIN if dimension is None else dimension
        case Pre() | Neg():
            return below[0]
        case Binary("+" | "-", left, right):
            return _same((left, right), below, "add up", where)
        case Binary("*"):
            return _product(below[0], below[1], 1)
        case Binary("/"):
            return _product(below[0], below[1], -1)
        case Binary("^", left, right):
            _number_only(right, below[1], "an exponent", where)
            n = _exponent(right)
            if n is not None:
                if below[0] not in (None, _PLAIN, DIMENSIONLESS):
                    for number, _ in walk(right):
                        if isinstance(number, Number):
                            settled(number.value, "the unit of a power")
                return _power(below[0], n)
            _number_only(left, below[0], "a base with a variable exponent", where)
            return None if below[0] is None else _PLAIN
        case Compare(_, left, right):
            _same((left, right), below, "compare", where)
            return None
        case If(_, then, orelse):
            return _same((then, orelse), below[1:], "fit in one `if`", where)
        case Call(function, args):
            return _call(function, args, below, where)
        case And() | Or() | Not() | Bool():
            return None
    return None


def _call(function: str, args: tuple[Expr, ...], below: list[_Found], where: str) -> _Found:
    match function:
        case "sqrt":
            return _power(below[0], Fraction(1, 2))
        case "abs" | "floor" | "ceil":
            return below[0]
        case "min" | "max" | "hypot" | "mod":
            return _same(args, below, f"fit in one {function}", where)
        case "atan2":
            _same(args, below, "fit in one atan2", where)
            return _PLAIN
        case "sign":
            return _PLAIN
    _number_only(args[0], below[0], function, where)
    return _PLAIN
