"""Tree to nested closures, over any algebra of values."""

from __future__ import annotations

import math
import operator
from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from hybond.errors import ExpressionError
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
    String,
    Table,
    fold,
)
from hybond.names import did_you_mean
from hybond.units import try_quantity

Closure = Callable[[Any], Any]
Points = tuple[float, ...]


def _same(value: Any) -> Any:
    return value


@dataclass(frozen=True, slots=True)
class Algebra:
    """What the operations of the language mean on one kind of value.

    No operation may raise on floats out of range; an algebra of other values may refuse, and then
    the closure passes its exception on.

    Parameters
    ----------
    add, sub, mul, div, pow, neg : callable
        Arithmetic.
    compare : callable
        ``compare(op)`` returns the function of two values for ``"<"``, ``"<="``, ``">"``,
        ``">="``, ``"=="`` or ``"!="``.
    and_, or_, not_ : callable
        Logic of two values (one for `not_`). A value may be a number: nonzero is true.
    where : callable
        ``where(c, a, b)``, `a` where `c` is true, else `b`.
    call : mapping
        From each name of `FUNCTIONS` to its function.
    const : callable
        The value of a Python float or bool of the text.
    table, slope : callable
        ``table(x, y, extrapolate)`` returns the function of one value that reads the table;
        `slope` likewise reads the slope of its segments.
    pre : callable
        Applied to every value read inside `Pre`.
    lazy : bool
        Values are single and have a truth value: `if`, `and` and `or` evaluate only what they
        need, and `where`, `and_` and `or_` are not called.
    wrap : callable
        Applied once to the finished closure.
    """

    add: Callable[[Any, Any], Any]
    sub: Callable[[Any, Any], Any]
    mul: Callable[[Any, Any], Any]
    div: Callable[[Any, Any], Any]
    pow: Callable[[Any, Any], Any]
    neg: Callable[[Any], Any]
    compare: Callable[[str], Callable[[Any, Any], Any]]
    and_: Callable[[Any, Any], Any]
    or_: Callable[[Any, Any], Any]
    not_: Callable[[Any], Any]
    where: Callable[[Any, Any, Any], Any]
    call: Mapping[str, Callable[..., Any]]
    const: Callable[[float], Any]
    table: Callable[[Points, Points, str], Closure]
    slope: Callable[[Points, Points, str], Closure]
    pre: Callable[[Any], Any] = _same
    lazy: bool = False
    wrap: Callable[[Closure], Closure] = _same


def compile_expression(
    e: Expr, slot: Mapping[str, int], algebra: Algebra | None = None, *, pre_offset: int
) -> Closure:
    """Return `e` as a function of one flat vector of values.

    Parameters
    ----------
    e : Expr
    slot : mapping of str to int
        Where each name lies in the vector.
    algebra : Algebra
        `FLOATS` (the default), `ARRAYS` or another.
    pre_offset : int
        The a priori value of a name lies at ``slot[name] + pre_offset``.

    Returns
    -------
    callable
        ``f(v)``; `v` is anything that integers index: a list of floats, or for `ARRAYS` an array
        of shape (slots, ...) .

    Raises
    ------
    ExpressionError
        HB-E105 for a name that is not in `slot`, HB-E106 for a text.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> f = compile_expression(parse("2*x - pre(x)"), {"x": 0}, pre_offset=1)
    >>> f([3.0, 1.0])
    5.0
    """
    used = FLOATS if algebra is None else algebra
    return used.wrap(fold(e, _Compiler(slot, used, pre_offset).node))


_FIELD = {"+": "add", "-": "sub", "*": "mul", "/": "div", "^": "pow"}


class _Constant:
    """A closure that ignores its argument; the compiler folds what is made of these."""

    __slots__ = ("value",)

    def __init__(self, value: Any) -> None:
        self.value = value

    def __call__(self, v: Any) -> Any:
        return self.value


@dataclass(frozen=True, slots=True)
class _Compiler:
    slot: Mapping[str, int]
    algebra: Algebra
    pre_offset: int

    def node(self, e: Expr, prior: bool, fs: list[Closure]) -> Closure:
        """Return the closure of one node, given those of its subexpressions."""
        algebra = self.algebra
        match e:
            case Number(value) | Bool(value):
                return _Constant(algebra.const(value))
            case Name():
                return self.read(e, prior)
            case Pre():
                return fs[0]
            case Neg():
                return self.unary(algebra.neg, fs[0])
            case Not():
                return self.unary(algebra.not_, fs[0])
            case Table(_, x, y, extrapolate, slope):
                make = algebra.slope if slope else algebra.table
                return self.unary(make(x, y, extrapolate), fs[0])
            case Binary(op):
                fast = self.fast(e, fs[0], fs[1], prior) if algebra is FLOATS else None
                return fast or self.binary(getattr(algebra, _FIELD[op]), fs[0], fs[1])
            case Compare(op):
                return self.binary(algebra.compare(op), fs[0], fs[1])
            case And() | Or():
                return self.logic(fs, every=isinstance(e, And))
            case If():
                c, a, b = fs
                if algebra.lazy:
                    return lambda v: a(v) if c(v) else b(v)
                where = algebra.where
                return lambda v: where(c(v), a(v), b(v))
            case Call(function):
                return self.call(algebra.call[function], fs)
            case String(text):
                why = f'the text "{text}" has no value'
                hint = 'compare it with the state of a machine: machine.state == "open"'
                raise ExpressionError(why, code="HB-E106", hint=hint)
        raise TypeError(type(e).__name__)

    def index(self, path: str, prior: bool) -> int:
        at = self.slot.get(path)
        if at is None:
            hint = did_you_mean(path, self.slot)
            if try_quantity("1 " + path) is not None:
                hint = "a unit of several symbols stands in brackets: 5 [m/s]"
            raise ExpressionError(f"unknown name {path!r}", code="HB-E105", hint=hint)
        return at + self.pre_offset if prior else at

    def read(self, e: Name, prior: bool) -> Closure:
        at = self.index(e.path, prior)
        pre = self.algebra.pre
        if prior and pre is not _same:
            return lambda v: pre(v[at])
        # About half the time of a lambda.
        return operator.itemgetter(at) if self.algebra is FLOATS else lambda v: v[at]

    def unary(self, f: Closure, a: Closure) -> Closure:
        if isinstance(a, _Constant) and self.algebra is FLOATS:
            return _Constant(f(a.value))
        return lambda v: f(a(v))

    def binary(self, f: Callable[[Any, Any], Any], a: Closure, b: Closure) -> Closure:
        if isinstance(b, _Constant):
            second = b.value
            if isinstance(a, _Constant) and self.algebra is FLOATS:
                return _Constant(f(a.value, second))
            return lambda v: f(a(v), second)
        if isinstance(a, _Constant):
            first = a.value
            return lambda v: f(first, b(v))
        return lambda v: f(a(v), b(v))

    def fast(self, e: Binary, a: Closure, b: Closure, prior: bool) -> Closure | None:
        """Return a closure of native operators for the common shapes, or None.

        The results are the same to the last bit: ``x - c`` is ``x + (-c)``, and a sum or a product
        of two commutes.
        """
        op = e.op
        if isinstance(a, _Constant) and isinstance(b, _Constant):
            return None
        i = self.index(e.left.path, prior) if isinstance(e.left, Name) else -1
        j = self.index(e.right.path, prior) if isinstance(e.right, Name) else -1
        if op == "^":
            if not isinstance(b, _Constant) or b.value != 2.0:
                return None
            return (lambda v: v[i] * v[i]) if i >= 0 else _square(a)
        if isinstance(b, _Constant) and op in "+-*":
            a, b, i, j = b, a, j, i
            if op == "-":
                a, op = _Constant(-a.value), "+"
        if isinstance(a, _Constant):
            c = a.value
            if j >= 0:
                shapes: dict[str, Closure] = {
                    "+": lambda v: c + v[j],
                    "-": lambda v: c - v[j],
                    "*": lambda v: c * v[j],
                }
            else:
                shapes = {
                    "+": lambda v: c + b(v),
                    "-": lambda v: c - b(v),
                    "*": lambda v: c * b(v),
                }
        elif i >= 0 and j >= 0:
            shapes = {
                "+": lambda v: v[i] + v[j],
                "-": lambda v: v[i] - v[j],
                "*": lambda v: v[i] * v[j],
            }
        else:
            shapes = {
                "+": lambda v: a(v) + b(v),
                "-": lambda v: a(v) - b(v),
                "*": lambda v: a(v) * b(v),
            }
            if isinstance(b, _Constant) and b.value != 0.0:
                c = b.value
                shapes["/"] = lambda v: a(v) / c
        return shapes.get(op)

    def logic(self, fs: list[Closure], *, every: bool) -> Closure:
        if self.algebra.lazy:
            if len(fs) == 2:
                f, g = fs
                if every:
                    return lambda v: bool(f(v)) and bool(g(v))
                return lambda v: bool(f(v)) or bool(g(v))

            def decide(v: Any) -> bool:
                for f in fs:
                    if bool(f(v)) is not every:
                        return not every
                return every

            return decide
        join = self.algebra.and_ if every else self.algebra.or_
        first, rest = fs[0], fs[1:]

        def joined(v: Any) -> Any:
            value = first(v)
            for f in rest:
                value = join(value, f(v))
            return value

        return joined

    def call(self, f: Callable[..., Any], fs: list[Closure]) -> Closure:
        if len(fs) == 1:
            return self.unary(f, fs[0])
        if len(fs) == 2:
            return self.binary(f, fs[0], fs[1])
        return lambda v: f(*[g(v) for g in fs])


def _square(a: Closure) -> Closure:
    def squared(v: Any) -> Any:
        value = a(v)
        return value * value

    return squared


def _quiet(exact: Callable[..., float], ufunc: Callable[..., Any]) -> Callable[..., float]:
    """Return `exact`, with NumPy's nan or infinity where the function of `math` raises."""

    def total(*args: float) -> float:
        try:
            return exact(*args)
        except (ValueError, OverflowError, ZeroDivisionError):
            with np.errstate(all="ignore"):
                return float(ufunc(*[float(a) for a in args]))

    return total


def _div(a: float, b: float) -> float:
    try:
        return a / b
    except ZeroDivisionError:
        if a != a or a == 0.0:
            return math.nan
        return math.copysign(math.inf, a) * math.copysign(1.0, b)


def _least(*args: float) -> float:
    low = args[0]
    for a in args[1:]:
        if a < low or a != a:
            low = a
    return low


def _most(*args: float) -> float:
    high = args[0]
    for a in args[1:]:
        if a > high or a != a:
            high = a
    return high


def _sign(a: float) -> float:
    return 1.0 if a > 0.0 else -1.0 if a < 0.0 else abs(a) * 0.0


def _segment(x: Points, at: float, extrapolate: str) -> int:
    """Return the index of the segment that holds `at`, or -1 where there is none."""
    if at != at or (extrapolate == "error" and not x[0] <= at <= x[-1]):
        return -1
    return min(max(bisect_right(x, at) - 1, 0), len(x) - 2)


def _slopes(x: Points, y: Points) -> list[float]:
    return [(y[k + 1] - y[k]) / (x[k + 1] - x[k]) for k in range(len(x) - 1)]


def _table(x: Points, y: Points, extrapolate: str) -> Callable[[float], float]:
    slopes = _slopes(x, y)

    def read(at: float) -> float:
        k = _segment(x, at, extrapolate)
        return y[k] + slopes[k] * (at - x[k]) if k >= 0 else math.nan

    return read


def _slope(x: Points, y: Points, extrapolate: str) -> Callable[[float], float]:
    slopes = _slopes(x, y)

    def read(at: float) -> float:
        k = _segment(x, at, extrapolate)
        return slopes[k] if k >= 0 else math.nan

    return read


def _segments(x: Any, at: Any, extrapolate: str) -> tuple[Any, Any]:
    outside = np.isnan(at)
    if extrapolate == "error":
        outside |= (at < x[0]) | (at > x[-1])
    return np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2), outside


def _table_arrays(x: Points, y: Points, extrapolate: str) -> Closure:
    xs, ys, slopes = np.array(x), np.array(y), np.array(_slopes(x, y))

    def read(at: Any) -> Any:
        k, outside = _segments(xs, at, extrapolate)
        return np.where(outside, np.nan, ys[k] + slopes[k] * (at - xs[k]))

    return read


def _slope_arrays(x: Points, y: Points, extrapolate: str) -> Closure:
    xs, slopes = np.array(x), np.array(_slopes(x, y))

    def read(at: Any) -> Any:
        k, outside = _segments(xs, at, extrapolate)
        return np.where(outside, np.nan, slopes[k])

    return read


_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}

_UFUNC: dict[str, Callable[..., Any]] = {
    **{f: getattr(np, f) for f in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")},
    **{f: getattr(np, f) for f in ("log10", "sqrt", "sign", "floor", "ceil", "hypot", "mod")},
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "abs": np.abs,
}


def _real(ufunc: Callable[..., Any]) -> Callable[..., Any]:
    # bool - bool is an error in NumPy and bool + bool is `or`: a comparison counts as 0 or 1.
    return lambda *args: ufunc(*args, dtype=np.float64)


def _fold(ufunc: Callable[[Any, Any], Any]) -> Callable[..., Any]:
    def folded(*args: Any) -> Any:
        value = args[0]
        for a in args[1:]:
            value = ufunc(value, a)
        return value

    return folded


def _no_warnings(f: Closure) -> Closure:
    def quiet(v: Any) -> Any:
        with np.errstate(all="ignore"):
            return f(v)

    return quiet


FLOATS = Algebra(
    add=operator.add,
    sub=operator.sub,
    mul=operator.mul,
    div=_div,
    pow=_quiet(math.pow, np.power),
    neg=operator.neg,
    compare=_COMPARE.__getitem__,
    and_=lambda a, b: bool(a) and bool(b),
    or_=lambda a, b: bool(a) or bool(b),
    not_=operator.not_,
    where=lambda c, a, b: a if c else b,
    call={
        **{
            f: _quiet(getattr(math, f), _UFUNC[f])
            for f in _UFUNC
            if f not in ("abs", "sign", "floor", "ceil", "mod")
        },
        "abs": math.fabs,
        "sign": _sign,
        "floor": _quiet(lambda a: float(math.floor(a)), np.floor),
        "ceil": _quiet(lambda a: float(math.ceil(a)), np.ceil),
        "mod": _quiet(operator.mod, np.mod),
        "min": _least,
        "max": _most,
    },
    const=_same,
    table=_table,
    slope=_slope,
    lazy=True,
)
"""Python floats: lazy, and nan or an infinity where the mathematics has no value."""

ARRAYS = Algebra(
    add=_real(np.add),
    sub=_real(np.subtract),
    mul=_real(np.multiply),
    div=_real(np.true_divide),
    pow=_real(np.power),
    neg=_real(np.negative),
    compare=_COMPARE.__getitem__,
    and_=np.logical_and,
    or_=np.logical_or,
    not_=np.logical_not,
    where=lambda c, a, b: np.where(np.not_equal(c, 0), a, b),
    call={
        **{f: _real(ufunc) for f, ufunc in _UFUNC.items()},
        "min": _fold(np.minimum),
        "max": _fold(np.maximum),
    },
    const=cast("Callable[[float], Any]", np.asarray),
    table=_table_arrays,
    slope=_slope_arrays,
    wrap=_no_warnings,
)
"""NumPy arrays, elementwise; the same values as `FLOATS`."""
