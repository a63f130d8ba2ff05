"""Expressions as instructions of the kernel's stack machine (`c/bytecode.c`)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import (
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
    Table,
)
from hybond.model.expressions.tree import fold

OPERATIONS = [
    "end",
    "const",
    "slot",
    "add",
    "sub",
    "mul",
    "div",
    "pow",
    "neg",
    "square",
    "lt",
    "le",
    "gt",
    "ge",
    "eq",
    "ne",
    "not",
    "truth",
    "skip",
    "skip_unless",
    "skip_if",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "log10",
    "sqrt",
    "abs",
    "sign",
    "floor",
    "ceil",
    "atan2",
    "hypot",
    "mod",
    "min",
    "max",
    "table",
]
"""In the order of `enum hb_op`."""
CODE = {name: k for k, name in enumerate(OPERATIONS)}
DEPTH = 64
"""Values that the machine's stack holds."""
_BINARY = {"+": "add", "-": "sub", "*": "mul", "/": "div", "^": "pow"}
_COMPARE = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "ne"}


class Declined(Exception):
    """What the kernel was not made for; the reference goes on alone."""


class Book:
    """All expressions of a mode: one list of instructions, one of constants.

    Parameters
    ----------
    slot : mapping
        Canonical names to slots.
    pre_offset : int
        What is added for a name inside ``pre``.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> book = Book({"x": 3}, pre_offset=8)
    >>> book.add(parse("2*x + 1"))
    0
    >>> " ".join(str(k) for k in book.code)
    '1 0 2 3 5 1 1 3 0'
    >>> sorted(book.read)
    [3]
    """

    def __init__(self, slot: Mapping[str, int], *, pre_offset: int) -> None:
        self.slot = slot
        self.pre_offset = pre_offset
        self.code: list[int] = []
        self.values: list[float] = []
        self.read: set[int] = set()
        """Slots that some expression reads."""
        self._place: dict[float, int] = {}
        self._begun: dict[int, tuple[Expr, int]] = {}

    def copy(self) -> Book:
        """Return another book that begins with all that is in this one."""
        other = Book(self.slot, pre_offset=self.pre_offset)
        other.code, other.values = self.code.copy(), self.values.copy()
        other.read, other._place = self.read.copy(), self._place.copy()
        other._begun = self._begun.copy()
        return other

    def add(self, e: Expr) -> int:
        """Add an expression, if it is not there yet; return where it begins.

        Expressions are told apart by identity: to hash one takes longer than to read it.

        Raises
        ------
        Declined
            For what needs a deeper stack.
        """
        known = self._begun.get(id(e))
        if known is not None:
            return known[1]
        start = self._added(e)
        self._begun[id(e)] = e, start
        return start

    def _added(self, e: Expr) -> int:
        code, depth = fold(e, self._node)
        if depth > DEPTH:
            raise Declined("an expression is too deep")
        start = len(self.code)
        self.code += [*code, CODE["end"]]
        return start

    def arrays(self) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Return instructions and constants."""
        return np.array(self.code, dtype=np.int32), np.array(self.values or [0.0])

    def _constant(self, value: float) -> int:
        key = value if value == value and value != 0.0 else None
        if key is not None and key in self._place:
            return self._place[key]
        self.values.append(value)
        if key is not None:
            self._place[key] = len(self.values) - 1
        return len(self.values) - 1

    def _node(self, e: Expr, prior: bool, below: list[tuple[list[int], int]]) -> _Part:
        """Return the instructions of a node and the depth of stack that they need."""
        match e:
            case Number(value) | Bool(value):
                return [CODE["const"], self._constant(float(value))], 1
            case Name(path):
                at = self.slot[path] + (self.pre_offset if prior else 0)
                self.read.add(at)
                return [CODE["slot"], at], 1
            case Pre():
                return below[0]
            case Neg():
                return _then(below, "neg")
            case Not():
                return _then(below, "not")
            case Binary(op="^", right=Number(value=2.0)):
                return _then(below[:1], "square")
            case Binary(op):
                return _then(below, _BINARY[op])
            case Compare(op):
                return _then(below, _COMPARE[op])
            case Call(function, args):
                if len(args) <= 2:
                    return _then(below, function)
                part = below[0]
                for other in below[1:]:
                    part = _then([part, other], function)
                return part
            case Table(_, x, y, extrapolate, slope):
                at = len(self.values)
                head = [float(len(x)), float(extrapolate == "linear"), float(slope)]
                self.values += [*head, *x, *y]
                code, depth = below[0]
                return [*code, CODE["table"], at], depth
            case If():
                (c, n), (a, i), (b, j) = below
                chosen = [*c, CODE["skip_unless"], len(a) + 2, *a, CODE["skip"], len(b), *b]
                return chosen, max(n, i, j)
            case And() | Or():
                return self._logic(below, every=isinstance(e, And))
        raise Declined(f"{type(e).__name__} has no instruction")

    def _logic(self, below: list[tuple[list[int], int]], *, every: bool) -> _Part:
        """Return instructions that stop at the first part that decides."""
        last, depth = below[-1]
        code = [*last, CODE["truth"]]
        stop, answer = ("skip_unless", 0.0) if every else ("skip_if", 1.0)
        for part, deep in reversed(below[:-1]):
            decided = [CODE["const"], self._constant(answer)]
            code = [*part, CODE[stop], len(code) + 2, *code, CODE["skip"], len(decided), *decided]
            depth = max(depth, deep)
        return code, depth


_Part = tuple[list[int], int]


def _then(below: list[_Part], name: str) -> _Part:
    """Return what is below, one after the other, then an instruction."""
    code: list[int] = []
    depth = 0
    for k, (part, deep) in enumerate(below):
        code += part
        depth = max(depth, deep + k)
    return [*code, CODE[name]], depth
