"""Parameters as slots: numbers that are expressions of them, while a model is made.

A parameter is followed as a `Slotted`: arithmetic with it gives more of them, so that what a model
is made of says how it follows from its parameters, and other numbers can be written there. Where a
comparison decides what the model is made of, it is written down as a condition; where a plain
number is wanted, that it is this one. Parameters that meet all conditions make the same model, with
other numbers in it: nothing becomes a plain number unseen.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Container, Mapping
from typing import Any, cast

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
from hybond.records import dataclass
from hybond.units import Dimension

PREFIX = "p:"
"""What the name of a parameter begins with in a tree, before its dotted path."""
NUMBERS_ONLY = "what is computed with plain numbers while the model is read"
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
class Slot:
    """A parameter that can be written.

    Parameters
    ----------
    path : str
    start : float
        Its value in the model, SI.
    dimension : Dimension or None
    made_of : Expr or None
        What it is where nobody writes it, in parameters; None if it is a number.
    """

    path: str
    start: float
    dimension: Dimension | None
    made_of: Expr | None


class Slots:
    """The slots of a model, and what was asked of them while it was made.

    Parameters
    ----------
    wanted : container of str, optional
        Dotted paths of the parameters that are slots; default: all.
    """

    def __init__(self, wanted: Container[str] | None = None, *, moving: bool = False) -> None:
        self.wanted = wanted
        self.moving = moving
        self.parameters: dict[str, Slot] = {}
        """In an order in which each is made of those before it."""
        self.conditions: dict[Expr, None] = {}
        """What is true of the parameters of all models that are made of the same parts."""
        self.fixed: dict[str, str] = {}
        """Parameters that cannot be another number, and what it goes into."""

    def follow(self, path: str, number: Number) -> Number:
        """Return the value of a parameter as its slot, if it is wanted."""
        if self.wanted is not None and path not in self.wanted:
            return number
        own = slot_of(number)
        made_of = None if own is None else own.tree
        start = plain(number.value)
        self.parameters[path] = Slot(path, start, number.dimension, made_of)
        return Number(slotted(start, Name(PREFIX + path), self), number.dimension)

    def note(self, condition: Expr, *, holds: bool) -> None:
        """Write down what was asked, and the answer."""
        if not holds:
            condition = (
                Compare(_OPPOSITE[condition.op], condition.left, condition.right)
                if isinstance(condition, Compare)
                else Not(condition)
            )
        self.conditions[condition] = None


class Slotted:
    """A number, and the expression of parameters that it is.

    Two of them are equal if they have one value and are one expression: what two parameters give is
    kept apart, even while it has the same value.

    Examples
    --------
    >>> slots = Slots()
    >>> r, c = (slots.follow(k, Number(v)).value for k, v in (("R", 2.0), ("C", 3.0)))
    >>> 1 / (r * c), str((1 / (r * c)).tree)
    (0.16666666666666666, '1/(p:R*p:C)')
    >>> r > 1, float(c), [str(e) for e in slots.conditions]
    (True, 3.0, ['p:R > 1', 'p:C == 3'])
    """

    __slots__ = ("slots", "tree", "value")
    __array_ufunc__ = None  # a number of NumPy beside it leaves the sum to it
    imag = 0.0

    def __init__(self, value: float, tree: Expr, slots: Slots) -> None:
        self.value = value
        self.tree = tree
        self.slots = slots

    @property
    def real(self) -> Slotted:
        """The number itself."""
        return self

    def settle(self, why: str) -> float:
        """Return the plain number, and write down that it is this one because of `why`."""
        self.slots.note(Compare("==", self.tree, Number(self.value)), holds=True)
        for name in sorted(names(self.tree)):
            self.slots.fixed.setdefault(name.removeprefix(PREFIX), why)
        return self.value

    def __float__(self) -> float:
        return self.settle(NUMBERS_ONLY)

    def __int__(self) -> int:
        return int(float(self))

    def __repr__(self) -> str:
        return repr(self.value)

    def __format__(self, spec: str) -> str:
        return format(self.value, spec)

    def _with(self, op: str, other: object, *, swapped: bool = False) -> Any:
        if isinstance(other, complex) and op in _COMPLEX:
            own = SlottedComplex(self, 0.0)
            return _COMPLEX[op](*((other, own) if swapped else (own, other)))
        if not isinstance(other, int | float | Slotted):
            return NotImplemented
        left, right = (tree_of(other), self.tree) if swapped else (self.tree, tree_of(other))
        a, b = self.value, plain(other)
        value = _PLAIN[op](*((b, a) if swapped else (a, b)))
        tree = _short(op, left, right)
        if isinstance(tree, Number) or isinstance(value, complex):
            return value
        return Slotted(value, tree, self.slots)

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

    def __neg__(self) -> Slotted:
        return Slotted(-self.value, _negative(self.tree), self.slots)

    def __pos__(self) -> Slotted:
        return self

    def __abs__(self) -> Slotted:
        return Slotted(abs(self.value), Call("abs", (self.tree,)), self.slots)

    def _asked(self, op: str, other: object) -> Any:
        if not isinstance(other, int | float | Slotted):
            return NotImplemented
        holds = _PLAIN[op](self.value, plain(other))
        tree = tree_of(other)
        if self.slots.moving and op in ("==", "!=") and tree != self.tree:
            return op == "!="
        if tree != self.tree and math.isfinite(plain(other)):
            self.slots.note(Compare(op, self.tree, tree), holds=holds)
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
        if not isinstance(other, Slotted):
            return self._asked("==", other)
        return self.value == other.value and self.slots is other.slots and self.tree == other.tree

    def __ne__(self, other: object) -> Any:
        equal = self.__eq__(other)
        return equal if equal is NotImplemented else not equal

    def __bool__(self) -> bool:
        return bool(self._asked("!=", 0.0))

    def __hash__(self) -> int:
        # not that of the number: a table of numbers must not take one for the other
        return hash((self.value, self.tree, id(self.slots)))


class SlottedComplex:
    """A complex number whose parts may follow from parameters: a factor of a wave.

    Examples
    --------
    >>> a = Slots().follow("A", Number(3.0)).value
    >>> turned = a * (1 - 2j) * 1j
    >>> turned.real, turned.imag, str(turned.imag.tree)
    (6.0, 3.0, 'p:A')
    """

    __slots__ = ("imag", "real")

    def __init__(self, real: Any, imag: Any) -> None:
        self.real = real
        self.imag = imag

    def __add__(self, other: Any) -> SlottedComplex:
        return _sum(self, other)

    def __radd__(self, other: Any) -> SlottedComplex:
        return _sum(other, self)

    def __mul__(self, other: Any) -> SlottedComplex:
        return _product(self, other)

    def __rmul__(self, other: Any) -> SlottedComplex:
        return _product(other, self)

    def __bool__(self) -> bool:
        return bool(self.real) or bool(self.imag)


def _sum(a: Any, b: Any) -> SlottedComplex:
    return SlottedComplex(a.real + b.real, a.imag + b.imag)


def _product(a: Any, b: Any) -> SlottedComplex:
    return SlottedComplex(a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real)


_COMPLEX: Mapping[str, Callable[[Any, Any], SlottedComplex]] = {
    "+": _sum,
    "*": _product,
}


def slotted(value: float, tree: Expr, slots: Slots) -> float:
    """Return a number that is an expression of parameters; it stands where numbers do."""
    return cast(float, Slotted(value, tree, slots))


def slot_of(value: object) -> Slotted | None:
    """Return a number, plain or in an expression, if it follows from parameters; else None."""
    found = value.value if isinstance(value, Number) else value
    return found if isinstance(found, Slotted) else None


def is_slotted(value: object) -> bool:
    """Whether a number, plain or in an expression, follows from parameters."""
    return slot_of(value) is not None


def plain(value: object) -> float:
    """Return a number as it is now, for who decides nothing by it."""
    return value.value if isinstance(value, Slotted) else float(value)  # type: ignore[arg-type]


def tree_of(value: object) -> Expr:
    """Return a number as an expression of parameters."""
    return value.tree if isinstance(value, Slotted) else Number(float(value))  # type: ignore[arg-type]


def settled(value: float, why: str) -> float:
    """Return a plain number; that it is this one is written down, with what it goes into."""
    slot = slot_of(value)
    return float(value) if slot is None else slot.settle(why)


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
