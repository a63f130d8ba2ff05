"""Expressions of netlists: read, evaluated and written as hybond writes them; never run as code.

`MADE` has the functions of other simulators that are made of ours.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Final

from hybond.circuits.notices import Line
from hybond.circuits.numerals import NUMERAL, is_ambiguous, numeral, scaled
from hybond.errors import FileError
from hybond.files.place import shortened
from hybond.model.expressions import (
    And,
    Binary,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    compile_expression,
    substitute,
    transform,
)
from hybond.model.expressions.lines import lines_between
from hybond.model.expressions.parse import MAX_DEPTH
from hybond.model.expressions.tree import FUNCTIONS, children, depth, walk, with_children

DEEPEST = 60
"""Brackets and operators inside one another."""
LARGEST = 2000
"""Parts of an expression, functions put in."""

_TOKEN = re.compile(
    rf"\s*(?:(?P<number>{NUMERAL.pattern.replace('?P<scale>', '').replace('?P<unit>', '')})"
    r"|(?P<name>read#[0-9]+|[A-Za-z_][A-Za-z0-9_.]*)|(?P<sign>\*\*|<=|>=|==|!=|&&?|\|\|?|[-+*/^(){}?:,<>!]))",
    re.IGNORECASE,
)
_BINDS = {
    "||": 1,
    "|": 1,
    "&&": 2,
    "&": 2,
    "==": 3,
    "!=": 3,
    "<": 4,
    "<=": 4,
    ">": 4,
    ">=": 4,
    "+": 5,
    "-": 5,
    "*": 6,
    "/": 6,
    "^": 8,
}
_ALIASES = {"ln": "log", "sgn": "sign", "arctan": "atan", "pow": "^", "ternary_fcn": "if"}
_ALIASES |= {"arcsin": "asin", "arccos": "acos", "stp": "u", "nint": "round"}
_ARGUMENTS = {name: least for name, (least, _) in FUNCTIONS.items() if name != "mod"}
_PARTNERS = {"(": ")", "{": "}"}
"""Braces stand around the whole, or around parameters in an expression of voltages."""
_LINES = ("table", "pwl")
"""Functions of an argument and points; ``pwl`` goes on with the slopes at its ends."""


def _whole(x: Expr) -> Expr:
    """Return a number without what is behind its point."""
    return Binary("*", Call("sign", (x,)), Call("floor", (Call("abs", (x,)),)))


def _rounded(x: Expr) -> Expr:
    return Call("floor", (Binary("+", x, Number(0.5)),))


def _signed_power(x: Expr, y: Expr) -> Expr:
    """Return a power of the magnitude, with the sign."""
    return Binary("*", Call("sign", (x,)), Binary("^", Call("abs", (x,)), y))


def _is_true(x: Expr) -> Expr:
    """Return 1 for what is above one half, as gates of LTspice see it."""
    return If(Compare(">", x, Number(0.5)), Number(1.0), Number(0.0))


def _is_false(x: Expr) -> Expr:
    return If(Compare(">", x, Number(0.5)), Number(0.0), Number(1.0))


def _asinh(x: Expr) -> Expr:
    """Return the inverse of sinh, for large numbers of either sign alike."""
    size = Call("abs", (x,))
    root = Call("sqrt", (Binary("+", Binary("*", x, x), Number(1.0)),))
    return Binary("*", Call("sign", (x,)), Call("log", (Binary("+", size, root),)))


def _acosh(x: Expr) -> Expr:
    root = Call("sqrt", (Binary("-", Binary("*", x, x), Number(1.0)),))
    return Call("log", (Binary("+", x, root),))


def _atanh(x: Expr) -> Expr:
    parts = Binary("/", Binary("+", Number(1.0), x), Binary("-", Number(1.0), x))
    return Binary("*", Number(0.5), Call("log", (parts,)))


MADE: Final[Mapping[str, tuple[int, Callable[..., Expr]]]] = {
    "int": (1, _whole),
    "round": (1, _rounded),
    "pwrs": (2, _signed_power),
    "buf": (1, _is_true),
    "inv": (1, _is_false),
    "asinh": (1, _asinh),
    "acosh": (1, _acosh),
    "atanh": (1, _atanh),
}
"""Of how many arguments each is, and how it is written."""


_ARGUMENTS |= {"^": 2, "if": 3, "u": 1, "uramp": 1, "limit": 3}
_ARGUMENTS |= {name: many for name, (many, _) in MADE.items()}


def read_formula(text: str, line: Line) -> Expr:
    """Return the expression of a text: a number, or anything in braces, quotes or bare.

    Raises
    ------
    FileError
        HB-F131.

    Examples
    --------
    >>> line = Line("x.cir", 1, "")
    >>> str(read_formula("{2*pi*f0}", line))
    '2*pi*f0'
    >>> evaluate(read_formula("4.7k", line), {})
    4700.0
    >>> evaluate(read_formula("-2**2 + (3 > 2 ? 1m : 5)", line), {})
    -3.999
    """
    plain = numeral(text)
    if plain is not None:
        return Number(plain)
    inner = text.strip()
    while len(inner) > 1 and (inner[0], inner[-1]) in (("'", "'"), ('"', '"')):
        inner = inner[1:-1].strip()
    return _Parser(inner, line).whole()


class _Parser:
    """A parser by precedence; the levels of a formula are bounded."""

    def __init__(self, text: str, line: Line) -> None:
        self.line = line
        self.text = text
        self.tokens = list(self._split())
        self.at = 0
        self.depth = 0

    def _split(self) -> Iterator[tuple[str, str]]:
        at = 0
        while at < len(self.text):
            match = _TOKEN.match(self.text, at)
            if match is None or match.end() == at:
                if not self.text[at:].strip():
                    return
                raise self.refuse(f"{self.text[at : at + 20]!r} is not part of an expression")
            at = match.end()
            kind = match.lastgroup or "number"
            yield ("number" if match["number"] else kind), match.group().strip()

    def refuse(self, why: str, hint: str = "") -> FileError:
        return self.line.refuse(
            why, code="HB-F131", hint=hint or "write a number, or an expression in braces"
        )

    def peek(self) -> str:
        return self.tokens[self.at][1] if self.at < len(self.tokens) else ""

    def whole(self) -> Expr:
        if not self.tokens:
            raise self.refuse("a number or an expression is missing")
        formula = as_value(self.choice())
        if depth(formula) > MAX_DEPTH:
            raise self.refuse(f"more than {MAX_DEPTH} operators follow one another")
        if self.at < len(self.tokens):
            raise self.refuse(f"{self.peek()!r} is left over in {self.text!r}")
        return formula

    def choice(self) -> Expr:
        condition = self.operators(0)
        if self.peek() != "?":
            return condition
        self.take("?")
        then = self.choice()
        self.take(":")
        return _chosen(condition, then, self.choice())

    def operators(self, lowest: int) -> Expr:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.refuse(f"more than {DEEPEST} brackets and operators inside one another")
        left = self.operand()
        while True:
            word = "^" if self.peek() == "**" else self.peek()
            binds = _BINDS.get(word, 0)
            if not binds or binds <= lowest:
                self.depth -= 1
                return left
            self.at += 1
            left = _combined(word, left, self.operators(binds))
            if word == "^" and self.peek() in ("^", "**"):
                raise self.refuse(
                    f"a^b^c is (a^b)^c to some simulators, and a^(b^c) to others: {self.text!r}",
                    "write brackets",
                )

    def operand(self) -> Expr:
        if self.at == len(self.tokens):
            raise self.refuse(f"the expression {self.text!r} ends too early")
        kind, word = self.tokens[self.at]
        self.at += 1
        if word in ("-", "+", "!"):
            inner = self.operators(7 if word != "!" else 8)
            if word == "+":
                return inner
            if word == "-" and isinstance(inner, Number):
                return Number(-inner.value)
            return Neg(as_value(inner)) if word == "-" else Not(_as_condition(inner))
        if word in _PARTNERS:
            inner = self.choice()
            self.take(_PARTNERS[word])
            return inner
        if kind == "number":
            match = NUMERAL.fullmatch(word)
            assert match is not None
            if is_ambiguous(match):
                raise self.refuse(
                    f"{word}: A is ampere to some simulators, and 1e-18 to others",
                    "leave the unit out, or write the factor as 1e-18",
                )
            value = scaled(match)
            if not math.isfinite(value):
                raise self.refuse(f"the number {shortened(word, 40)} is too large")
            return Number(value)
        if kind != "name":
            raise self.refuse(f"{word!r} stands where a value is needed in {self.text!r}")
        name = word.lower()
        if self.peek() != "(":
            return Number(math.pi) if name == "pi" else Name(name)
        return self.call(name)

    def call(self, name: str) -> Expr:
        self.take("(")
        arguments = [self.choice()]
        while self.peek() == ",":
            self.take(",")
            arguments.append(self.choice())
        self.take(")")
        if name in self.line.functions:
            return self.defined(name, arguments)
        if name in _LINES:
            return self.lines(name, list(map(as_value, arguments)))
        name = _ALIASES.get(name, name)
        if name == "pwr":
            raise self.refuse(
                "pwr(x, y) of x below zero is a magnitude to some simulators, and has the sign of "
                "x to others",
                "write abs(x)**y, or pwrs(x, y) with the sign",
            )
        wanted = _ARGUMENTS.get(name)
        if name in ("min", "max") and len(arguments) > 2:
            wanted = len(arguments)
        if wanted is None:
            raise self.refuse(
                f"the function {name!r} is not known here",
                "known: " + ", ".join([*_ARGUMENTS, *_LINES]),
            )
        if len(arguments) != wanted:
            raise self.refuse(f"{name!r} takes {wanted} arguments, not {len(arguments)}")
        if name == "if":
            return _chosen(*arguments)
        if name == "u":
            return If(Compare(">", as_value(arguments[0]), Number(0.0)), Number(1.0), Number(0.0))
        if name == "uramp":
            return Call("max", (as_value(arguments[0]), Number(0.0)))
        if name == "limit":
            x, low, high = map(as_value, arguments)
            return Call(
                "min", (Call("max", (x, Call("min", (low, high)))), Call("max", (low, high)))
            )
        if name == "^":
            return _combined(name, *arguments)
        if name in MADE:
            return MADE[name][1](*map(as_value, arguments))
        return Call(name, tuple(map(as_value, arguments)))

    def lines(self, name: str, arguments: list[Expr]) -> Expr:
        """Return straight lines between points, as a sum of what each of them adds."""
        x, *points = arguments
        xs, ys = points[::2], points[1::2]
        if len(points) < 4 or len(points) % 2:
            raise self.refuse(f"{name!r} takes an argument and two or more points x, y")
        at = [e.value for e in xs if isinstance(e, Number)]
        if len(at) < len(xs):
            raise self.refuse(f"a point of {name!r} is not at a number", "write numbers there")
        if any(b <= a for a, b in pairwise(at)):
            raise self.refuse(f"the points of {name!r} do not ascend", "sort them, each x once")
        whole = lines_between(x, xs, ys, held=name == "table")
        if size(whole) > LARGEST:
            raise self.refuse(f"{name!r} has too many points for an expression of {LARGEST} parts")
        return whole

    def defined(self, name: str, arguments: list[Expr]) -> Expr:
        """Return the body of a function of the netlist with its arguments put in."""
        names, body = self.line.functions[name]
        if len(arguments) != len(names):
            raise self.refuse(f"{name!r} takes {len(names)} arguments, not {len(arguments)}")
        whole = substitute(body, dict(zip(names, map(as_value, arguments), strict=True)))
        if size(whole) > LARGEST:
            raise self.refuse(f"with its functions put in, it has more than {LARGEST} parts")
        return whole

    def take(self, word: str) -> None:
        if self.peek() != word:
            raise self.refuse(f"{word!r} is missing in {self.text!r}")
        self.at += 1


def as_value(e: Expr) -> Expr:
    """Return a condition as 1 or 0, and what is a number as it is."""
    return If(e, Number(1.0), Number(0.0)) if isinstance(e, Compare | And | Or | Not) else e


def _as_condition(e: Expr) -> Expr:
    """Return a number as the condition that it is not zero."""
    if isinstance(e, Compare | And | Or | Not):
        return e
    return Compare(">", Call("abs", (e,)), Number(0.0))


def _as_gate(e: Expr) -> Expr:
    """Return a number as the condition that it is above one half, as LTspice sees it."""
    return _as_condition(e) if as_value(e) is not e else Compare(">", e, Number(0.5))


def _chosen(condition: Expr, then: Expr, otherwise: Expr) -> Expr:
    return If(_as_condition(condition), as_value(then), as_value(otherwise))


def _combined(word: str, left: Expr, right: Expr) -> Expr:
    if word in ("&&", "||", "&", "|"):
        truth = _as_condition if len(word) == 2 else _as_gate
        return (And if word[0] == "&" else Or)((truth(left), truth(right)))
    a, b = as_value(left), as_value(right)
    if word in ("==", "!="):
        # numbers are not compared for being equal in a model
        away = Call("abs", (Binary("-", a, b),))
        return Compare("<=" if word == "==" else ">", away, Number(0.0))
    return Compare(word, a, b) if word[0] in "<>" else Binary(word, a, b)


def names_in(formula: Expr) -> Iterator[str]:
    """Yield the names of parameters in a formula, in reading order."""
    yield from (e.path for e, _ in walk(formula) if isinstance(e, Name))


def written(formula: Expr, names: Mapping[str, str]) -> str:
    """Return a formula as an expression of the model, whose parameters are called by `names`.

    Examples
    --------
    >>> written(read_formula("{2*F0}", Line("x.cir", 1, "")), {"f0": "F0"})
    '2*F0'
    """

    def named(e: Expr) -> Expr:
        match e:
            case Name(path):
                return Name(names[path])
            case Neg(Number(value)):
                return Number(-value)
        return e

    return str(transform(formula, named))


def size(formula: Expr) -> int:
    """Return how many parts a formula has."""
    return sum(1 for _ in walk(formula))


def evaluate(formula: Expr, known: Mapping[str, float]) -> float:
    """Return the value of a formula.

    Raises
    ------
    KeyError
        A parameter that is not known.
    ArithmeticError, ValueError
        A value that does not exist, such as a division by zero, also of a part.
    """
    match formula:
        case Number(value):
            return value
        case Name(path):
            return known[path]
        case If(condition, then, otherwise):
            return evaluate(then if evaluate(condition, known) else otherwise, known)
    parts = [evaluate(e, known) for e in children(formula)]
    if isinstance(formula, Binary) and formula.op == "^" and parts[0] < 0.0 and parts[1] % 2.0:
        raise ValueError(f"a power of {parts[0]:g}, of which some simulators take the magnitude")
    whole = with_children(formula, tuple(map(Number, parts)))
    value = float(compile_expression(whole, {}, pre_offset=0)([]))
    if not math.isfinite(value):
        raise OverflowError("the value is not finite")
    return value
