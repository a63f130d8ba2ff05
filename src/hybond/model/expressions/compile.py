"""Tree to nested closures, over any algebra of values."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any

from hybond.errors import ExpressionError
from hybond.model.expressions.algebra import FLOATS, Algebra, Closure, same
from hybond.model.expressions.rounded_roots import cleared_roots
from hybond.model.expressions.stable import stable
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
from hybond.records import dataclass
from hybond.units import try_quantity


def compile_expression(
    e: Expr, slot: Mapping[str, int], algebra: Algebra | None = None, *, pre_offset: int
) -> Closure:
    """Return `e` as a function of one flat vector of values.

    Parameters
    ----------
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
    form = cleared_roots(stable(e)) if "cleared" in used.call else e
    return used.wrap(fold(form, _Compiler(slot, used, pre_offset).node))


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
                raise ExpressionError(why, code="HB-E106", where="expression", hint=hint)
        raise TypeError(type(e).__name__)

    def index(self, path: str, prior: bool) -> int:
        at = self.slot.get(path)
        if at is None:
            hint = did_you_mean(path, self.slot)
            if try_quantity("1 " + path) is not None:
                hint = "a unit of several symbols stands in brackets: 5 [m/s]"
            raise ExpressionError(
                f"unknown name {path!r}", code="HB-E105", where="expression", hint=hint
            )
        return at + self.pre_offset if prior else at

    def read(self, e: Name, prior: bool) -> Closure:
        at = self.index(e.path, prior)
        pre = self.algebra.pre
        if prior and pre is not same:
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
