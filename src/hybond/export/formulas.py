"""Expressions of a model as the typed tree that the printers print.

Guards, laws and signals are infix expressions on the vector `v` of values; at a jump they are calls
on a stack of pairs (`engine.expressions.pairs`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from hybond.model import expressions as e
from hybond.model.expressions.rounded_roots import cleared_roots
from hybond.model.expressions.stable import stable
from hybond.model.expressions.tree import Table, fold
from hybond.translate.tree import (
    BOOL,
    FLOAT,
    FLOATS,
    INT,
    Binary,
    Block,
    Call,
    Choice,
    Do,
    Element,
    Expr,
    Field,
    Global,
    If,
    Local,
    Notes,
    Statement,
    Type,
    Unary,
    Value,
    Word,
)

V = Local("v", FLOATS)
STACK = Local("s", Type("record", "Stack"))
ARRAY = "parameter"
"""What the array of parameters is called in print."""
PARAMETERS = Global(ARRAY, FLOATS)
"""Parameters, and what follows from them, in one array."""
TOP = Element(Field(STACK, "finite", FLOATS), Field(STACK, "top", INT), FLOAT)
WAS = Element(Field(STACK, "before", FLOATS), Field(STACK, "top", INT), FLOAT)
PRIOR = "PRE"
"""The name of the offset of a priori values."""
LINE = Notes(0)
_WORDS = frozenset(
    ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "log10")
    + ("sqrt", "floor", "ceil", "atan2", "hypot")
)
_CALLED = {
    "sign": "sign_of",
    "mod": "modulo",
    "min": "least_of",
    "max": "greatest_of",
    "softplus": "softplus",
    "log_cosh": "log_cosh",
    "expm1": "exp_less_one",
    "log1p": "log_beside_one",
    "cleared": "cleared_of_rounding",
}
_PAIRED = {
    "+": "add",
    "-": "subtract",
    "*": "multiply",
    "/": "divide",
    "^": "raise_to",
    "<": "less",
    "<=": "less_or_equal",
    ">": "greater",
    ">=": "greater_or_equal",
    "==": "equal",
    "!=": "unequal",
    "abs": "absolute",
    "sign": "put_sign",
    "hypot": "length",
    "min": "least",
    "max": "greatest",
}


@dataclass
class Formulas:
    """The expressions of one model."""

    slot: Mapping[str, str]
    """Canonical names to identifiers of their slots."""
    parameter: Mapping[str, str] = field(default_factory=dict)
    """Names of parameters, and of numbers that follow from them, to identifiers of their places."""
    tables: dict[tuple[float, ...], str] = field(default_factory=dict)
    """Tables that expressions read, arguments then values, by identifier; filled on the way."""
    calls: set[str] = field(default_factory=set)
    """Portable functions that the expressions call."""
    read: set[str] = field(default_factory=set)
    """Slots that they read."""

    def number(self, tree: e.Expr) -> Expr:
        """Return an expression as a number; what is true counts 1."""
        return _number(fold(cleared_roots(stable(tree)), self._node))

    def truth(self, tree: e.Expr) -> Expr:
        """Return an expression as a condition; a number is true unless it is zero."""
        return _truth(fold(cleared_roots(stable(tree)), self._node))

    def _node(self, node: e.Expr, prior: bool, below: list[Expr]) -> Expr:
        match node:
            case e.Number(value):
                return _literal(value)
            case e.Bool(value):
                return Value(value, BOOL)
            case e.Name(path):
                return self._name(path, prior)
            case e.Pre():
                return below[0]
            case e.Neg():
                return Unary("-", _number(below[0]), FLOAT)
            case e.Not():
                return Unary("not", _truth(below[0]), BOOL)
            case e.Binary(op="^", right=e.Number(value=2.0)):
                return self._square(_number(below[0]))
            case e.Binary(op="^"):
                return Word("pow", tuple(map(_number, below)), FLOAT)
            case e.Binary(op):
                return Binary(op, _number(below[0]), _number(below[1]), FLOAT)
            case e.Compare(op):
                return Binary(op, _number(below[0]), _number(below[1]), BOOL)
            case e.And() | e.Or():
                op = "and" if isinstance(node, e.And) else "or"
                found = _truth(below[0])
                for part in below[1:]:
                    found = Binary(op, found, _truth(part), BOOL)
                return found
            case e.If():
                c, a, b = below
                both = a.type == b.type == BOOL
                if both:
                    return Choice(_truth(c), a, b, BOOL)
                return Choice(_truth(c), _number(a), _number(b), FLOAT)
            case Table():
                return self._table(node, _number(below[0]))
            case e.Call(function):
                return self._call(function, [_number(b) for b in below])
        raise TypeError(type(node).__name__)

    def _name(self, path: str, prior: bool) -> Expr:
        if path in self.parameter:
            return Element(PARAMETERS, Global(self.parameter[path], INT), FLOAT)
        index: Expr = Global(self.slot[path], INT)
        self.read.add(path)
        if prior:
            index = Binary("+", Global(PRIOR, INT), index, INT)
        value = Element(V, index, FLOAT)
        if path.startswith(("on:", "in:", "at:")):
            return Binary("!=", value, Value(0.0, FLOAT), BOOL)
        return value

    def _square(self, base: Expr) -> Expr:
        if isinstance(base, Element):
            return Binary("*", base, base, FLOAT)
        return self._called("square", (base,))

    def _called(self, function: str, args: tuple[Expr, ...]) -> Expr:
        self.calls.add(function)
        return Call(function, args, FLOAT)

    def _call(self, function: str, args: list[Expr]) -> Expr:
        if function == "abs":
            return Word("fabs", tuple(args), FLOAT)
        if function in _WORDS:
            return Word(function, tuple(args), FLOAT)
        found = args[0]
        if len(args) == 1:
            return self._called(_CALLED[function], (found,))
        for other in args[1:]:
            found = self._called(_CALLED[function], (found, other))
        return found

    def _table(self, node: Table, at: Expr) -> Expr:
        points: tuple[float, ...] = (*node.x, *node.y)
        name = self.tables.setdefault(points, f"POINTS_{len(self.tables)}")
        function = "slope_of_table" if node.slope else "read_table"
        goes_on = Value(node.extrapolate == "linear", BOOL)
        begin = Value(len(node.x), INT), Global(name, FLOATS), Value(0, INT)
        return self._called(function, (*begin, goes_on, at))

    # on pairs

    def pairs(self, tree: e.Expr) -> Block:
        """Return the calls that leave an expression on top of the stack of pairs."""
        code: list[Statement] = fold(stable(tree), self._paired)
        return Block(tuple(code))

    def _do(self, function: str, *args: Expr) -> Statement:
        self.calls.add(function)
        return Do(Call(function, (STACK, *args), Type("void")), LINE)

    def _paired(self, node: e.Expr, prior: bool, below: list[list[Statement]]) -> list[Statement]:
        match node:
            case e.Number(value):
                return [self._do("push_number", _literal(value))]
            case e.Bool(value):
                return [self._do("push_truth", Value(value, BOOL))]
            case e.Name(path) if path in self.parameter:
                return [self._do("push_number", self._name(path, prior))]
            case e.Name(path):
                self.read.add(path)
                push = "push_prior" if prior else "push_signal"
                return [self._do(push, Global(self.slot[path], INT))]
            case e.Pre():
                return below[0]
            case e.Neg():
                return [*below[0], self._do("negate")]
            case e.Not():
                return [*below[0], self._do("deny")]
            case e.Binary(op) | e.Compare(op):
                return [*below[0], *below[1], self._do(_PAIRED[op])]
            case e.And() | e.Or():
                return self._decided(below, every=isinstance(node, e.And))
            case e.If():
                return [*below[0], self._branch(below[1], below[2])]
            case Table():
                return [*below[0], self._read_pair(node)]
            case e.Call(function):
                return self._paired_call(function, below)
        raise TypeError(type(node).__name__)

    def _branch(self, then: list[Statement], orelse: list[Statement]) -> Statement:
        self.calls.add("pop_truth")
        holds = Call("pop_truth", (STACK,), BOOL)
        return If(((holds, Block(tuple(then))),), Block(tuple(orelse)), LINE, (LINE,))

    def _decided(self, below: list[list[Statement]], *, every: bool) -> list[Statement]:
        code = [*below[-1], self._do("affirm")]
        known = [self._do("push_truth", Value(not every, BOOL))]
        for part in reversed(below[:-1]):
            code = [*part, self._branch(code, known) if every else self._branch(known, code)]
        return code

    def _read_pair(self, node: Table) -> Statement:
        now, was = self._table(node, TOP), self._table(node, WAS)
        return self._do("put_read", now, was)

    def _paired_call(self, function: str, below: list[list[Statement]]) -> list[Statement]:
        if function in ("min", "max"):
            code = below[0]
            for part in below[1:]:
                code = [*code, *part, self._do(_PAIRED[function])]
            return code
        code = [s for part in below for s in part]
        if function in _PAIRED:
            return [*code, self._do(_PAIRED[function])]
        apply = "apply" if len(below) == 1 else "apply_to_two"
        return [*code, self._do(apply, Global(function.upper(), INT))]


def _literal(value: float) -> Expr:
    if value < 0.0 or (value == 0.0 and str(value).startswith("-")):
        return Unary("-", Value(-value, FLOAT), FLOAT)
    return Value(float(value), FLOAT)


def _number(tree: Expr) -> Expr:
    if isinstance(tree, Value) and tree.type == BOOL:
        return Value(float(tree.value is True), FLOAT)
    if tree.type == BOOL:
        return Choice(tree, Value(1.0, FLOAT), Value(0.0, FLOAT), FLOAT)
    return tree


def _truth(tree: Expr) -> Expr:
    return tree if tree.type == BOOL else Binary("!=", tree, Value(0.0, FLOAT), BOOL)
