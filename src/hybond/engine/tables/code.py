"""Expressions of a model as the instructions that `engine.expressions.code` runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import partial

from hybond.engine.expressions import code as c
from hybond.engine.expressions.functions import (
    ACOS,
    ASIN,
    ATAN,
    ATAN2,
    CEIL,
    CLEARED,
    COS,
    COSH,
    EXP,
    EXPM1,
    FLOOR,
    LOG,
    LOG1P,
    LOG10,
    LOG_COSH,
    MOD,
    SIN,
    SINH,
    SOFTPLUS,
    SQRT,
    TAN,
    TANH,
)
from hybond.engine.tables.expressions import number_of
from hybond.errors import ModelError
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
from hybond.model.expressions.rounded_roots import cleared_roots
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.stable import stable
from hybond.model.expressions.tree import fold
from hybond.records import dataclass

ONE = {
    "sin": SIN,
    "cos": COS,
    "tan": TAN,
    "asin": ASIN,
    "acos": ACOS,
    "atan": ATAN,
    "sinh": SINH,
    "cosh": COSH,
    "tanh": TANH,
    "exp": EXP,
    "log": LOG,
    "log10": LOG10,
    "sqrt": SQRT,
    "floor": FLOOR,
    "ceil": CEIL,
}
"""Functions of one number by the codes of `portable.functions`."""
_FORMS = {
    "softplus": SOFTPLUS,
    "log_cosh": LOG_COSH,
    "expm1": EXPM1,
    "log1p": LOG1P,
}
"""What stands for a form of several."""
TWO = {"atan2": ATAN2, "mod": MOD}
_ARITHMETIC = {"+": c.ADD, "-": c.SUBTRACT, "*": c.MULTIPLY, "/": c.DIVIDE, "^": c.RAISE}
_COMPARISON = {
    "<": c.LESS,
    "<=": c.LESS_OR_EQUAL,
    ">": c.GREATER,
    ">=": c.GREATER_OR_EQUAL,
    "==": c.EQUAL,
    "!=": c.UNEQUAL,
}
_CALLED = {
    "abs": c.ABSOLUTE,
    "sign": c.SIGN,
    "hypot": c.LENGTH,
    "min": c.LEAST,
    "max": c.GREATEST,
}
_Part = tuple[list[int], int]
"""Instructions, and how many places of the stack they need."""


@dataclass(slots=True)
class Code:
    """Instructions of many expressions, and the numbers that they read.

    Parameters
    ----------
    slot : mapping
        Canonical names to slots.
    size : int
        Slots; the a priori values that numbers read stand so many further on.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> code = Code({"x": 3}, 8)
    >>> code.add(parse("2*x + pre(x)"), paired=False)
    0
    >>> code.instructions
    [1, 0, 37, 3, 2, 11, 4, 0]
    >>> code.numbers
    [2.0]
    """

    slot: Mapping[str, int]
    size: int
    instructions: list[int] = field(default_factory=list)
    numbers: list[float] = field(default_factory=list)
    _place: dict[float, int] = field(default_factory=dict)

    def add(self, e: Expr, *, paired: bool) -> int:
        """Add an expression, on pairs or on numbers; return where it begins.

        Raises
        ------
        ModelError
            HB-E636 for one that needs a deeper stack than there is.
        """
        # pairs know themselves what is rounding of their terms
        form = stable(e) if paired else cleared_roots(stable(e))
        instructions, depth = fold(form, partial(self._node, paired=paired))
        if depth > c.DEEPEST:
            raise ModelError(
                f"an expression needs {depth} intermediate values at once",
                code="HB-E636",
                where="expressions",
                hint=f"at most {c.DEEPEST}: write sums and products from left to right, "
                "what is long first",
            )
        begin = len(self.instructions)
        self.instructions += instructions
        self.instructions.append(c.END)
        return begin

    def _node(self, e: Expr, prior: bool, below: list[_Part], *, paired: bool) -> _Part:
        match e:
            case Name(path):
                what = c.PRIOR if prior and paired else c.SIGNAL
                return [what, self.slot[path] + (self.size if prior and not paired else 0)], 1
            case Number(value) | Bool(value):
                return [c.NUMBER, self._number(number_of(value))], 1
            case Binary(op, _, right):
                if not paired and op == "^" and isinstance(right, Number) and right.value == 2.0:
                    return _then(below[:1], c.SQUARE)
                if not paired and op != "^" and isinstance(right, Number | Name):
                    # one instruction for a number or a signal and the operator behind it
                    (what, which), _ = below[1]
                    first = c.ADD_NUMBER if what == c.NUMBER else c.ADD_SIGNAL
                    return _then(below[:1], first + _ARITHMETIC[op] - c.ADD, which)
                return _then(below, _ARITHMETIC[op])
            case Neg():
                return _then(below, c.NEGATE)
            case Compare(op):
                return _then(below, _COMPARISON[op])
            case Call(function):
                return self._call(function, below)
            case Pre():
                return below[0]
            case Not():
                return _then(below, c.DENY)
            case Table(_, x, y, extrapolate, slope):
                at = len(self.numbers)
                self.numbers += [float(len(x)), float(extrapolate == "linear"), *x, *y]
                return _then(below, c.SLOPE if slope else c.READ, at)
            case If():
                (test, n), (then, i), (other, j) = below
                chosen = [*test, c.SKIP_UNLESS, len(then) + 2, *then, c.SKIP, len(other), *other]
                return chosen, max(n, i, j)
            case And() | Or():
                return self._decided(below, every=isinstance(e, And))
        raise TypeError(type(e).__name__)

    def _call(self, function: str, below: Sequence[_Part]) -> _Part:
        if function == "cleared":
            (code, depth), (size, deep) = below
            rounded = [c.SKIP_UNLESS_BELOW, len(size) + 2, *size, c.APPLY_TO_TWO, CLEARED]
            return [*code, *rounded], max(depth, deep + 1)
        if function in ONE:
            return _then(below, c.APPLY, ONE[function])
        if function in _FORMS:
            return _then(below, c.APPLY, _FORMS[function])
        if len(below) == 1:
            return _then(below, _CALLED[function]) if function in ("abs", "sign") else below[0]
        part = below[0]
        for other in below[1:]:
            which = (c.APPLY_TO_TWO, TWO[function]) if function in TWO else (_CALLED[function],)
            part = _then([part, other], *which)
        return part

    def _decided(self, below: Sequence[_Part], *, every: bool) -> _Part:
        """Return instructions that stop at the first part that decides."""
        last, depth = below[-1]
        code = [*last, c.AFFIRM]
        stop = c.SKIP_UNLESS if every else c.SKIP_IF
        decided = [c.NUMBER, self._number(0.0 if every else 1.0)]
        for part, deep in reversed(below[:-1]):
            code = [*part, stop, len(code) + 2, *code, c.SKIP, len(decided), *decided]
            depth = max(depth, deep)
        return code, depth

    def _number(self, value: float) -> int:
        own = is_slotted(value) or (value == value and value != 0.0)
        at = self._place.get(value) if own else None
        if at is None:
            at = len(self.numbers)
            self.numbers.append(value)
            self._place[value] = at
        return at


def check_depths(expressions: Sequence[Expr], slot: Mapping[str, int]) -> None:
    """Refuse expressions on pairs for which the stack has no room.

    Raises
    ------
    ModelError
        HB-E636.
    """
    code = Code(slot, len(slot))
    for e in expressions:
        code.add(e, paired=True)


def _then(below: Sequence[_Part], *instruction: int) -> _Part:
    """Return what is below, one after the other, then an instruction.

    The first part goes on: of a long sum it is all that stands before.
    """
    code, depth = below[0]
    for k in range(1, len(below)):
        part, deep = below[k]
        code += part
        depth = max(depth, deep + k)
    code += instruction
    return code, depth
