"""Numbers that know how they came about from the parameters of a model.

While a model is flattened for an export, the values of its parameters are `Traced`. Arithmetic with
them gives more of them, and where a comparison decides what the model is made of, it is written
down as a condition: for other values of the parameters that meet all conditions the model is made
of the same parts, with other numbers in them.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from hybond.model.expressions.tree import (
    Binary,
    Call,
    Compare,
    Expr,
    Name,
    Neg,
    Not,
    Number,
    names,
)
from hybond.units import Dimension

PREFIX = "p:"
"""What the name of a parameter begins with in a tree, before its dotted path."""
_OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
_PLAIN: Mapping[str, Callable[[float, float], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "^": operator.pow,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


@dataclass(frozen=True, slots=True)
class Followed:
    """A parameter that is followed.

    Parameters
    ----------
    path : str
    start : float
        Its value in the model, SI.
    dimension : Dimension or None
    made_of : Expr or None
        What it is where nobody sets it, in parameters; None if it is a number.
    """

    path: str
    start: float
    dimension: Dimension | None
    made_of: Expr | None


class Trail:
    """What became of the parameters of a model while it was flattened.

    Parameters
    ----------
    wanted : collection of str
        Dotted paths of the parameters that are followed.
    """

    def __init__(self, wanted: Collection[str]) -> None:
        self.wanted = wanted
        self.parameters: dict[str, Followed] = {}
        """In an order in which each is made of those before it."""
        self.conditions: dict[Expr, None] = {}
        """What was true of the parameters where the model's parts were chosen."""
        self.lost: dict[str, str] = {}
        """Parameters whose values went where nothing is followed, and what that is."""

    def follow(self, path: str, number: Number) -> Number:
        """Return the value of a parameter as one that is followed, if it is wanted."""
        if path not in self.wanted:
            return number
        made_of = number.value.tree if isinstance(number.value, Traced) else None
        start = float(number.value)
        self.parameters[path] = Followed(path, start, number.dimension, made_of)
        return Number(Traced(start, Name(PREFIX + path), self), number.dimension)

    def note(self, condition: Expr, *, holds: bool) -> None:
        """Write down what was asked, and the answer."""
        if not holds:
            condition = (
                Compare(_OPPOSITE[condition.op], condition.left, condition.right)
                if isinstance(condition, Compare)
                else Not(condition)
            )
        self.conditions[condition] = None


class Traced(float):
    """A number, the expression of parameters that it is, and where that is written down.

    Two of them are equal if they have one value and are one expression: what two parameters give is
    kept apart, even while it has the same value.

    Examples
    --------
    >>> trail = Trail(["R", "C"])
    >>> r, c = (trail.follow(k, Number(v)).value for k, v in (("R", 2.0), ("C", 3.0)))
    >>> 1 / (r * c), str((1 / (r * c)).tree)
    (0.16666666666666666, '1/(p:R*p:C)')
    >>> r > 1, [str(e) for e in trail.conditions]
    (True, ['p:R > 1'])
    """

    __slots__ = ("trail", "tree")
    tree: Expr
    trail: Trail

    def __new__(cls, value: float, tree: Expr, trail: Trail) -> Traced:
        """Return `value`, which `tree` is."""
        self = super().__new__(cls, value)
        self.tree = tree
        self.trail = trail
        return self

    def _with(self, op: str, other: object, *, swapped: bool = False) -> Any:
        if not isinstance(other, int | float):
            return NotImplemented
        left, right = (tree_of(other), self.tree) if swapped else (self.tree, tree_of(other))
        a, b = float(self), float(other)
        value = _PLAIN[op](*((b, a) if swapped else (a, b)))
        tree = _short(op, left, right)
        if isinstance(tree, Number) or isinstance(value, complex):
            return value
        return Traced(value, tree, self.trail)

    def __add__(self, other: object) -> Any:
        return self._with("+", other)

    def __radd__(self, other: object) -> Any:
        return self._with("+", other, swapped=True)

    def __sub__(self, other: object) -> Any:
        return self._with("-", other)

    def __rsub__(self, other: object) -> Any:
        return self._with("-", other, swapped=True)

    def __mul__(self, other: object) -> Any:
        return self._with("*", other)

    def __rmul__(self, other: object) -> Any:
        return self._with("*", other, swapped=True)

    def __truediv__(self, other: object) -> Any:
        return self._with("/", other)

    def __rtruediv__(self, other: object) -> Any:
        return self._with("/", other, swapped=True)

    def __pow__(self, other: object, _: object = None) -> Any:
        return self._with("^", other)

    def __rpow__(self, other: object, _: object = None) -> Any:
        return self._with("^", other, swapped=True)

    def __neg__(self) -> Traced:
        return Traced(-float(self), _negative(self.tree), self.trail)

    def __pos__(self) -> Traced:
        return self

    def __abs__(self) -> Traced:
        return Traced(abs(float(self)), Call("abs", (self.tree,)), self.trail)

    def _asked(self, op: str, other: object) -> Any:
        if not isinstance(other, int | float):
            return NotImplemented
        holds = _PLAIN[op](float(self), float(other))
        tree = tree_of(other)
        if tree != self.tree and math.isfinite(other):
            self.trail.note(Compare(op, self.tree, tree), holds=holds)
        return holds

    def __lt__(self, other: object) -> Any:
        return self._asked("<", other)

    def __le__(self, other: object) -> Any:
        return self._asked("<=", other)

    def __gt__(self, other: object) -> Any:
        return self._asked(">", other)

    def __ge__(self, other: object) -> Any:
        return self._asked(">=", other)

    def __eq__(self, other: object) -> Any:
        if not isinstance(other, Traced):
            return self._asked("==", other)
        same = float(self) == float(other) and self.trail is other.trail
        return same and self.tree == other.tree

    def __ne__(self, other: object) -> Any:
        equal = self.__eq__(other)
        return equal if equal is NotImplemented else not equal

    def __bool__(self) -> bool:
        return bool(self._asked("!=", 0.0))

    def __hash__(self) -> int:
        # not that of the number: a table of numbers must not take one for the other
        return hash((float(self), self.tree, id(self.trail)))


def tree_of(value: float) -> Expr:
    """Return a number as an expression of parameters."""
    return value.tree if isinstance(value, Traced) else Number(float(value))


def give_up(values: Iterable[float], why: str) -> None:
    """Write down that nothing is followed where these numbers go: into `why`."""
    for value in values:
        if isinstance(value, Traced):
            for name in sorted(names(value.tree)):
                value.trail.lost.setdefault(name.removeprefix(PREFIX), why)


def _negative(e: Expr) -> Expr:
    return e.arg if isinstance(e, Neg) else Neg(e)


def _short(op: str, a: Expr, b: Expr) -> Expr:
    """Return ``a op b`` without what changes nothing, to the last bit."""
    zero, one, minus = Number(0.0), Number(1.0), Number(-1.0)
    match op:
        case "+" if zero in (a, b):
            return b if a == zero else a
        case "+" | "-" if b == (a if op == "-" else _negative(a)):
            return zero
        case "-" if zero in (a, b):
            return a if b == zero else _negative(b)
        case "*" if zero in (a, b):
            return zero
        case "*" if one in (a, b):
            return b if a == one else a
        case "*" if minus in (a, b):
            return _negative(b if a == minus else a)
        case "/" if b == one:
            return a
        case "/" if a == zero:
            return zero
    return Binary(op, a, b)
