"""Expressions as Modelica text."""

from __future__ import annotations

from collections.abc import Callable

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
    to_text,
)

_LEVEL = {"or": 1, "and": 2, "not": 3, "rel": 4, "+": 5, "*": 6, "^": 7, "atom": 8}
_SAME = "sin cos tan asin acos atan sinh cosh tanh exp log log10 sqrt abs sign floor ceil atan2"
_PLAIN = frozenset(_SAME.split())
Resolve = Callable[[str, bool], str]
"""A canonical name, and whether it stands in ``pre()``, to Modelica text."""


def modelica(e: Expr, resolve: Resolve) -> str:
    """Return an expression as Modelica text.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> modelica(parse("if a < 0 then -(b + 1)^2 else hypot(a, b)"), lambda n, prior: n)
    'if a < 0 then -(b + 1)^2 else sqrt(a^2 + b^2)'
    """
    return _text(e, resolve, False)[0]


def inner(e: Expr, resolve: Resolve) -> str:
    """Return an expression that may stand within a product or a comparison."""
    text, level = _text(e, resolve, False)
    return text if level >= _LEVEL["atom"] else f"({text})"


def number(value: float) -> str:
    """Return a number as Modelica writes it.

    Examples
    --------
    >>> number(2.0), number(1e-7), number(-0.5)
    ('2', '1e-07', '-0.5')
    """
    if value == int(value) and abs(value) < 1e15:
        return str(int(value))
    return repr(float(value))


def _text(e: Expr, resolve: Resolve, prior: bool) -> tuple[str, int]:
    def at(child: Expr, level: int) -> str:
        text, own = _text(child, resolve, prior)
        return text if own >= level else f"({text})"

    match e:
        case Number(value=value):
            return number(value), _LEVEL["atom"] if value >= 0 else _LEVEL["+"]
        case Bool(value=truth):
            return ("true" if truth else "false"), _LEVEL["atom"]
        case Name(path=path):
            text = resolve(path, prior)
            return text, _LEVEL["atom"] if " " not in text else 0
        case Pre(arg=arg):
            return _text(arg, resolve, True)
        case Neg(arg=arg):
            return f"-{at(arg, _LEVEL['*'])}", _LEVEL["+"]
        case Not(arg=arg):
            return f"not {at(arg, _LEVEL['atom'])}", _LEVEL["not"]
        case Binary(op="^"):
            return f"{at(e.left, 8)}^{at(e.right, 8)}", _LEVEL["^"]
        case Binary(op=("+" | "-") as op):
            right = _LEVEL["*"] if op == "-" or _signed(e.right) else _LEVEL["+"]
            return f"{at(e.left, _LEVEL['+'])} {op} {at(e.right, right)}", _LEVEL["+"]
        case Binary(op=op):
            return f"{at(e.left, _LEVEL['*'])}{op}{at(e.right, _LEVEL['^'])}", _LEVEL["*"]
        case Compare(op=op):
            sign = {"==": "==", "!=": "<>"}.get(op, op)
            return f"{at(e.left, _LEVEL['+'])} {sign} {at(e.right, _LEVEL['+'])}", _LEVEL["rel"]
        case And(args=args):
            return " and ".join(at(a, _LEVEL["not"]) for a in args), _LEVEL["and"]
        case Or(args=args):
            return " or ".join(at(a, _LEVEL["and"]) for a in args), _LEVEL["or"]
        case If(cond=cond, then=then, orelse=orelse):
            parts = [_text(x, resolve, prior)[0] for x in (cond, then, orelse)]
            return f"if {parts[0]} then {parts[1]} else {parts[2]}", 0
        case Call(function=function, args=args):
            return _call(function, [_text(a, resolve, prior)[0] for a in args], args, at)
        case Table():
            return _text(_as_choice(e), resolve, prior)
    raise ModelError(
        f"{to_text(e)} has no form in Modelica",
        code="HB-E680",
        where="the Modelica text",
        hint="write it in another way",
    )


def _signed(e: Expr) -> bool:
    return isinstance(e, Neg) or (isinstance(e, Number) and e.value < 0)


def _call(
    function: str, texts: list[str], args: tuple[Expr, ...], at: Callable[[Expr, int], str]
) -> tuple[str, int]:
    if function in ("min", "max"):
        found = texts[0]
        for text in texts[1:]:
            found = f"{function}({found}, {text})"
        return found, _LEVEL["atom"]
    if function == "hypot":
        return f"sqrt({at(args[0], 8)}^2 + {at(args[1], 8)}^2)", _LEVEL["atom"]
    if function == "mod":
        # without events of its own: floor() would be one at each period
        a, b = at(args[0], 7), at(args[1], 7)
        return f"{a} - {b}*floor({a}/{b})", _LEVEL["+"]
    assert function in _PLAIN
    return f"{function}({', '.join(texts)})", _LEVEL["atom"]


def _as_choice(e: Table) -> Expr:
    """Return a table of straight lines as nested choices."""
    if e.extrapolate != "linear":
        raise ModelError(
            "a table without a value outside its points has no form in Modelica",
            code="HB-E680",
            where="the Modelica text",
            hint='extrapolate = "linear"',
        )
    pieces: list[Expr] = []
    for k in range(len(e.x) - 1):
        slope = (e.y[k + 1] - e.y[k]) / (e.x[k + 1] - e.x[k])
        if e.slope:
            pieces.append(Number(slope))
            continue
        away = Binary("-", e.arg, Number(e.x[k]))
        pieces.append(Binary("+", Number(e.y[k]), Binary("*", Number(slope), away)))
    found = pieces[-1]
    for k in range(len(pieces) - 2, -1, -1):
        found = If(Compare("<", e.arg, Number(e.x[k + 1])), pieces[k], found)
    return found
