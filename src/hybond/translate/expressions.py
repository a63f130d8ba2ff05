"""Expressions of portable Python: from `ast` to the typed tree."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from hybond.translate.errors import PortableError
from hybond.translate.tree import (
    BOOL,
    FLOAT,
    FLOATS,
    INT,
    INTS,
    NONE,
    TEXT,
    VOID,
    Binary,
    Call,
    Choice,
    Constant,
    Element,
    Expr,
    Field,
    Global,
    Local,
    Record,
    Signature,
    Type,
    Unary,
    Value,
    Word,
)

ONE_FLOAT = frozenset(
    [
        "sqrt",
        "exp",
        "expm1",
        "log",
        "log10",
        "log1p",
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan",
        "sinh",
        "cosh",
        "tanh",
        "fabs",
        "floor",
        "ceil",
    ]
)
TWO_FLOATS = frozenset(["atan2", "hypot", "pow", "fmod", "copysign"])
TESTS = frozenset(["isfinite", "isnan"])
MATH_CONSTANTS = frozenset(["inf", "nan", "pi"])

WORDS: Mapping[str, tuple[tuple[Type, ...], Type]] = {
    "floats": ((INT,), FLOATS),
    "ints": ((INT,), INTS),
    "quotient": ((FLOAT, FLOAT), FLOAT),
    "put_text": ((TEXT,), VOID),
    "put_number": ((FLOAT,), VOID),
    "put_int": ((INT,), VOID),
    "put_line": ((), VOID),
}
"""The words with fixed types; `records` and `some` have a rule of their own."""
OTHER_WORDS = frozenset(
    [
        "record",
        "given",
        "records",
        "some",
        "float_table",
        "int_table",
        "Text",
        "Floats",
        "Ints",
        "Records",
        "Outside",
    ]
)

ARITHMETIC: Mapping[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.BitAnd: "&",
    ast.BitOr: "|",
    ast.BitXor: "^",
    ast.LShift: "<<",
    ast.RShift: ">>",
}
_COMPARISONS: Mapping[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Is: "is",
    ast.IsNot: "is not",
}
MOST = 2**31 - 1


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What names mean outside functions, for one module."""

    file: str
    constants: Mapping[str, Constant]
    records: Mapping[str, Record]
    functions: Mapping[str, Signature]
    words: frozenset[str]
    """Words that the module imports."""


@dataclass
class Scope:
    """The variables of a function while it is read."""

    around: Surroundings
    types: dict[str, Type] = field(default_factory=dict)
    assigned: set[str] = field(default_factory=set)
    read: set[str] = field(default_factory=set)

    def refuse(self, node: ast.AST, why: str, hint: str = "") -> PortableError:
        """Return the refusal of a node."""
        place = f"{self.around.file}:{getattr(node, 'lineno', 0)}"
        return PortableError(why, place=place, hint=hint)


def fits(given: Type, wanted: Type) -> bool:
    """Say whether a value of type `given` goes where `wanted` is.

    Examples
    --------
    >>> fits(INT, FLOAT), fits(FLOAT, INT), fits(NONE, FLOATS), fits(NONE, INT)
    (True, False, True, False)
    """
    if given == wanted or (given == INT and wanted == FLOAT):
        return True
    return given == NONE and wanted.is_reference


def expression(node: ast.expr, scope: Scope) -> Expr:
    """Return the typed tree of an expression.

    Raises
    ------
    PortableError
    """
    read = _READERS.get(type(node))
    if read is None:
        what = type(node).__name__
        raise scope.refuse(node, f"{what} is not an expression of the subset")
    return read(node, scope)


def of_type(node: ast.expr, wanted: Type, scope: Scope) -> Expr:
    """Return an expression that goes where `wanted` is."""
    e = expression(node, scope)
    if not fits(e.type, wanted):
        hint = "write float(...) or int(...)" if {e.type, wanted} <= {INT, FLOAT} else ""
        raise scope.refuse(node, f"{wanted} is wanted, {ast.unparse(node)!r} is {e.type}", hint)
    return e


def condition(node: ast.expr, scope: Scope) -> Expr:
    """Return an expression that is true or false."""
    e = expression(node, scope)
    if e.type != BOOL:
        why = f"{ast.unparse(node)!r} is {e.type}, not true or false"
        raise scope.refuse(node, why, "compare it: n != 0, x is not None")
    return e


def _constant(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.Constant)
    value = node.value
    if isinstance(value, bool):
        return Value(value, BOOL)
    if isinstance(value, int):
        if value > MOST:
            raise scope.refuse(node, f"{value} does not fit 32 bits")
        return Value(value, INT)
    if isinstance(value, float):
        return Value(value, FLOAT)
    if isinstance(value, str):
        return Value(value, TEXT)
    if value is None:
        return Value(None, NONE)
    raise scope.refuse(node, f"{value!r} is not a value of the subset")


def _name(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.Name)
    name = node.id
    if name in scope.types:
        if name not in scope.assigned:
            why = f"{name!r} may have no value here"
            raise scope.refuse(node, why, "assign it before, on every way to this line")
        scope.read.add(name)
        return Local(name, scope.types[name])
    known = scope.around.constants.get(name)
    if known is not None:
        return Global(known.name, known.type)
    raise scope.refuse(node, f"{name!r} is neither a variable nor a constant")


def _attribute(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.Attribute)
    if isinstance(node.value, ast.Name) and node.value.id == "math":
        if node.attr in MATH_CONSTANTS:
            return Global(f"math.{node.attr}", FLOAT)
        raise scope.refuse(node, f"math.{node.attr} is not in the subset")
    base = expression(node.value, scope)
    if base.type.kind != "record":
        raise scope.refuse(node, f"{ast.unparse(node.value)!r} is {base.type}, not a record")
    member = scope.around.records[base.type.record].member(node.attr)
    if member is None:
        raise scope.refuse(node, f"{base.type} has no field {node.attr!r}")
    return Field(base, member.name, member.type)


def _subscript(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.Subscript)
    if isinstance(node.slice, ast.Slice | ast.Tuple):
        raise scope.refuse(node, "slices are not in the subset", "copy in a loop")
    base = expression(node.value, scope)
    if not base.type.is_array:
        raise scope.refuse(node, f"{ast.unparse(node.value)!r} is {base.type}, not an array")
    index = of_type(node.slice, INT, scope)
    if isinstance(index, Unary) and isinstance(index.arg, Value):
        raise scope.refuse(node, "an index counts from the beginning")
    return Element(base, index, base.type.element)


def _unary(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.UnaryOp)
    if isinstance(node.op, ast.Not):
        return Unary("not", condition(node.operand, scope), BOOL)
    arg = expression(node.operand, scope)
    if isinstance(node.op, ast.USub) and arg.type in (INT, FLOAT):
        return Unary("-", arg, arg.type)
    if isinstance(node.op, ast.Invert) and arg.type == INT:
        return Unary("~", arg, INT)
    raise scope.refuse(node, f"{ast.unparse(node)!r} is not in the subset")


def _binary(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.BinOp)
    op = ARITHMETIC.get(type(node.op))
    if op is None:
        hint = "math.pow, or a product" if isinstance(node.op, ast.Pow) else ""
        raise scope.refuse(node, f"{ast.unparse(node)!r} is not in the subset", hint)
    left, right = expression(node.left, scope), expression(node.right, scope)
    return arithmetic(op, left, right, node, scope)


def arithmetic(op: str, left: Expr, right: Expr, node: ast.AST, scope: Scope) -> Expr:
    """Return ``left op right``, its types checked."""
    types = {left.type, right.type}
    if not types <= {INT, FLOAT}:
        raise scope.refuse(node, f"{op} of {left.type} and {right.type}")
    if op == "/" and types == {INT}:
        raise scope.refuse(node, "/ of two whole numbers", "float(a) / b, or a // b")
    if op not in "+-*/" and types != {INT}:
        hint = "math.fmod, math.floor" if op in ("//", "%") else ""
        raise scope.refuse(node, f"{op} of {left.type} and {right.type}", hint)
    return Binary(op, left, right, FLOAT if FLOAT in types else INT)


def _compare(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.Compare)
    if len(node.ops) != 1:
        raise scope.refuse(node, "a chain of comparisons", "a < b and b < c")
    op = _COMPARISONS.get(type(node.ops[0]))
    left, right = expression(node.left, scope), expression(node.comparators[0], scope)
    if op in ("is", "is not"):
        if right.type != NONE or not left.type.is_reference:
            raise scope.refuse(node, "`is` is for None alone")
        return Binary("==" if op == "is" else "!=", left, right, BOOL)
    types = {left.type, right.type}
    if types == {TEXT} and op in ("==", "!=") and right == Value("", TEXT):
        empty = Word("empty", (left,), BOOL)
        return empty if op == "==" else Unary("not", empty, BOOL)
    numbers = types <= {INT, FLOAT}
    if op is None or not (numbers or (types == {BOOL} and op in ("==", "!="))):
        raise scope.refuse(node, f"{left.type} is compared with {right.type}")
    return Binary(op, left, right, BOOL)


def _logic(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.BoolOp)
    op = "and" if isinstance(node.op, ast.And) else "or"
    result = condition(node.values[0], scope)
    for value in node.values[1:]:
        result = Binary(op, result, condition(value, scope), BOOL)
    return result


def _choice(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.IfExp)
    cond = condition(node.test, scope)
    then, orelse = expression(node.body, scope), expression(node.orelse, scope)
    for a, b in ((then, orelse), (orelse, then)):
        if fits(a.type, b.type):
            return Choice(cond, then, orelse, b.type)
    raise scope.refuse(node, f"either {then.type} or {orelse.type}")


def _call(node: ast.expr, scope: Scope) -> Expr:
    assert isinstance(node, ast.Call)
    if node.keywords or any(isinstance(a, ast.Starred) for a in node.args):
        raise scope.refuse(node, "arguments are given by position")
    called = node.func
    if isinstance(called, ast.Attribute):
        if isinstance(called.value, ast.Name) and called.value.id == "math":
            return _math(called.attr, node, scope)
        raise scope.refuse(node, f"{ast.unparse(called)!r} is not a function of the subset")
    if not isinstance(called, ast.Name):
        raise scope.refuse(node, f"{ast.unparse(called)!r} is not a function of the subset")
    return _named_call(called.id, node, scope)


def _named_call(name: str, node: ast.Call, scope: Scope) -> Expr:
    around = scope.around
    if name in scope.types:
        raise scope.refuse(node, f"{name!r} is a variable")
    if name in around.functions:
        signature = around.functions[name]
        wanted = tuple(t for _, t in signature.parameters)
        return Call(signature.name, _arguments(name, wanted, node, scope), signature.result)
    if name in around.records:
        _arguments(name, (), node, scope)
        return Word("record", (), Type("record", name))
    if name in ("float", "int", "abs", "min", "max"):
        return _builtin(name, node, scope)
    if name not in around.words:
        hint = f"import {name}" if name in WORDS or name in OTHER_WORDS else ""
        raise scope.refuse(node, f"{name!r} is not a function of the subset", hint)
    if name == "records":
        return _records(node, scope)
    if name == "some":
        (arg,) = _of_any_type(name, 1, node, scope)
        if arg.type.kind != "record":
            raise scope.refuse(node, f"some() of {arg.type}")
        return arg
    if name not in WORDS:
        raise scope.refuse(node, f"{name!r} does not stand in a function")
    types, result = WORDS[name]
    return Word(name, _arguments(name, types, node, scope), result)


def _arguments(
    name: str, types: tuple[Type, ...], node: ast.Call, scope: Scope
) -> tuple[Expr, ...]:
    if len(node.args) != len(types):
        raise scope.refuse(node, f"{name} takes {len(types)} arguments, not {len(node.args)}")
    return tuple(of_type(a, t, scope) for a, t in zip(node.args, types))


def _of_any_type(name: str, count: int, node: ast.Call, scope: Scope) -> tuple[Expr, ...]:
    if len(node.args) != count:
        raise scope.refuse(node, f"{name} takes {count} arguments, not {len(node.args)}")
    return tuple(expression(a, scope) for a in node.args)


def _math(name: str, node: ast.Call, scope: Scope) -> Expr:
    for names, count, result in ((ONE_FLOAT, 1, FLOAT), (TWO_FLOATS, 2, FLOAT), (TESTS, 1, BOOL)):
        if name in names:
            args = _arguments(f"math.{name}", (FLOAT,) * count, node, scope)
            return Word(name, args, result)
    raise scope.refuse(node, f"math.{name} is not in the subset")


def _builtin(name: str, node: ast.Call, scope: Scope) -> Expr:
    args = _of_any_type(name, 2 if name in ("min", "max") else 1, node, scope)
    types = {a.type for a in args}
    if not types <= {INT, FLOAT} or (len(types) == 2):
        shown = " and ".join(str(a.type) for a in args)
        raise scope.refuse(node, f"{name} of {shown}", "two of one type: float(i)")
    match name:
        case "float":
            return args[0] if args[0].type == FLOAT else Word("float", args, FLOAT)
        case "int":
            return args[0] if args[0].type == INT else Word("int", args, INT)
    return Word(name, args, args[0].type)


def _records(node: ast.Call, scope: Scope) -> Expr:
    if len(node.args) != 2 or not isinstance(node.args[0], ast.Name):
        raise scope.refuse(node, "records() takes a record and a number")
    name = node.args[0].id
    if name not in scope.around.records:
        raise scope.refuse(node, f"{name!r} is not a record")
    return Word("records", (of_type(node.args[1], INT, scope),), Type("Records", name))


_READERS: Mapping[type[ast.expr], Callable[[ast.expr, Scope], Expr]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.Subscript: _subscript,
    ast.UnaryOp: _unary,
    ast.BinOp: _binary,
    ast.Compare: _compare,
    ast.BoolOp: _logic,
    ast.IfExp: _choice,
    ast.Call: _call,
}
