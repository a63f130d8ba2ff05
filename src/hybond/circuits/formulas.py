"""Expressions of netlists: read, evaluated and written as hybond writes them; never run as code."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from hybond.circuits.notices import Line
from hybond.circuits.numerals import NUMERAL, is_ambiguous, numeral, scaled
from hybond.errors import FileError

DEEPEST = 60
"""Brackets and operators inside one another."""


@dataclass(frozen=True, slots=True)
class Number:
    """A plain number."""

    value: float


@dataclass(frozen=True, slots=True)
class Parameter:
    """The name of a parameter, in lower case."""

    name: str


@dataclass(frozen=True, slots=True)
class Applied:
    """A function or operator with its arguments."""

    word: str
    arguments: tuple[Formula, ...]


Formula = Number | Parameter | Applied

_TOKEN = re.compile(
    rf"\s*(?:(?P<number>{NUMERAL.pattern.replace('?P<scale>', '').replace('?P<unit>', '')})"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_.]*)|(?P<sign>\*\*|<=|>=|==|!=|&&|\|\||[-+*/^()?:,<>!]))",
    re.IGNORECASE,
)
_FOR_POINT = re.compile(r"(\d+)([a-zA-Z])(\d+)")
"""``4k7``, as it is written on schematics."""
_BINDS = {
    "||": 1,
    "&&": 2,
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
_COMPARES: dict[str, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
_ONE: dict[str, Callable[[float], float]] = {
    "sqrt": math.sqrt,
    "abs": abs,
    "exp": math.exp,
    "log": math.log,
    "log10": math.log10,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "sinh": math.sinh,
    "cosh": math.cosh,
    "tanh": math.tanh,
    "floor": math.floor,
    "ceil": math.ceil,
    "sign": lambda x: float((x > 0) - (x < 0)),
}


def _power(a: float, b: float) -> float:
    if a < 0.0 and b % 2.0 != 0.0:
        raise ValueError(f"a power of {a:g}, of which some simulators take the magnitude")
    return float(a**b)


_TWO: dict[str, Callable[[float, float], float]] = {
    "atan2": math.atan2,
    "hypot": math.hypot,
    "min": min,
    "max": max,
    "^": _power,
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
_ALIASES = {"ln": "log", "sgn": "sign", "arctan": "atan", "pow": "^", "ternary_fcn": "if"}
_ARGUMENTS = {
    **dict.fromkeys(_ONE, 1),
    **dict.fromkeys(("atan2", "hypot", "min", "max", "^"), 2),
    "if": 3,
}


def read_formula(text: str, line: Line) -> Formula:
    """Return the expression of a text: a number, or anything in braces, quotes or bare.

    Raises
    ------
    FileError
        HB-F131.

    Examples
    --------
    >>> line = Line("x.cir", 1, "")
    >>> write(read_formula("{2*pi*f0}", line), {"f0": "f0"}.__getitem__)
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
    while len(inner) > 1 and (inner[0], inner[-1]) in (("{", "}"), ("'", "'"), ('"', '"')):
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

    def whole(self) -> Formula:
        if not self.tokens:
            raise self.refuse("a number or an expression is missing")
        formula = self.choice()
        if self.at < len(self.tokens):
            point = _FOR_POINT.fullmatch(self.text.strip())
            hint = f"write {point[1]}.{point[3]}{point[2]}" if point else ""
            raise self.refuse(f"{self.peek()!r} is left over in {self.text!r}", hint)
        return formula

    def choice(self) -> Formula:
        condition = self.operators(0)
        if self.peek() != "?":
            return condition
        self.take("?")
        then = self.choice()
        self.take(":")
        return Applied("if", (condition, then, self.choice()))

    def operators(self, lowest: int) -> Formula:
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
            left = Applied(word, (left, self.operators(binds)))
            if word == "^" and self.peek() in ("^", "**"):
                raise self.refuse(
                    f"a^b^c is (a^b)^c to some simulators, and a^(b^c) to others: {self.text!r}",
                    "write brackets",
                )

    def operand(self) -> Formula:
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
            return Applied("neg" if word == "-" else "not", (inner,))
        if word == "(":
            inner = self.choice()
            self.take(")")
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
                raise self.refuse(f"the number {word} is too large")
            return Number(value)
        if kind != "name":
            raise self.refuse(f"{word!r} stands where a value is needed in {self.text!r}")
        name = word.lower()
        if self.peek() != "(":
            return Number(math.pi) if name == "pi" else Parameter(name)
        return self.call(name)

    def call(self, name: str) -> Formula:
        self.take("(")
        arguments = [self.choice()]
        while self.peek() == ",":
            self.take(",")
            arguments.append(self.choice())
        self.take(")")
        name = _ALIASES.get(name, name)
        wanted = _ARGUMENTS.get(name)
        if wanted is None:
            raise self.refuse(
                f"the function {name!r} is not known here", "known: " + ", ".join(_ARGUMENTS)
            )
        if len(arguments) != wanted:
            raise self.refuse(f"{name!r} takes {wanted} arguments, not {len(arguments)}")
        return Applied(name, tuple(arguments))

    def take(self, word: str) -> None:
        if self.peek() != word:
            raise self.refuse(f"{word!r} is missing in {self.text!r}")
        self.at += 1


def names_in(formula: Formula) -> Iterator[str]:
    """Yield the names of parameters in a formula."""
    if isinstance(formula, Parameter):
        yield formula.name
    elif isinstance(formula, Applied):
        for inner in formula.arguments:
            yield from names_in(inner)


def size(formula: Formula) -> int:
    """Return how many parts a formula has."""
    return 1 + (sum(map(size, formula.arguments)) if isinstance(formula, Applied) else 0)


def substitute(formula: Formula, known: Mapping[str, Formula]) -> Formula:
    """Return a formula with parameters replaced by formulas."""
    if isinstance(formula, Parameter):
        return known.get(formula.name, formula)
    if isinstance(formula, Applied):
        return Applied(formula.word, tuple(substitute(a, known) for a in formula.arguments))
    return formula


def evaluate(formula: Formula, known: Mapping[str, float]) -> float:
    """Return the value of a formula.

    Raises
    ------
    KeyError
        A parameter that is not known.
    ArithmeticError, ValueError
        A value that does not exist, such as a division by zero.
    """
    if isinstance(formula, Number):
        return formula.value
    if isinstance(formula, Parameter):
        return known[formula.name]
    word = formula.word
    if word == "if":
        condition, then, otherwise = formula.arguments
        return evaluate(then if evaluate(condition, known) else otherwise, known)
    values = [evaluate(a, known) for a in formula.arguments]
    if word == "neg":
        return -values[0]
    if word == "not":
        return float(not values[0])
    if word in ("&&", "||"):
        return float(all(values) if word == "&&" else any(values))
    if word in _COMPARES:
        return float(_COMPARES[word](*values))
    value = float(_ONE[word](*values) if word in _ONE else _TWO[word](*values))
    if not math.isfinite(value):
        raise OverflowError("the value is not finite")
    return value


_CONDITIONS = frozenset({*_COMPARES, "&&", "||", "not"})
_STRENGTH = {"+": 5, "-": 5, "*": 6, "/": 6, "neg": 7, "^": 8}


def write(formula: Formula, name: Callable[[str], str]) -> str:
    """Return a formula as an expression of hybond.

    Parameters
    ----------
    name : callable
        From the name in the netlist to the one in the model.
    """
    return _write(formula, name)[0]


def _write(formula: Formula, name: Callable[[str], str]) -> tuple[str, int]:
    """Return the text and how strongly its outermost operator binds."""
    if isinstance(formula, Number):
        if formula.value == math.pi:
            return "pi", 9
        text = repr(formula.value)
        text = text.removesuffix(".0")
        return text, 9 if formula.value >= 0 else 7
    if isinstance(formula, Parameter):
        return name(formula.name), 9
    word = formula.word
    parts = [_write(a, name) for a in formula.arguments]
    if word == "if":
        condition = _as_condition(formula.arguments[0], parts[0][0])
        return f"(if {condition} then {parts[1][0]} else {parts[2][0]})", 9
    if word in _CONDITIONS:
        return f"(if {_condition(formula, name)} then 1 else 0)", 9
    if word == "neg":
        return f"-{_within(parts[0], 7)}", 7
    if word in _STRENGTH:
        binds = _STRENGTH[word]
        left = _within(parts[0], binds + (word == "^"))
        right = _within(parts[1], binds + (word in ("-", "/")))
        return (f"{left} {word} {right}" if binds == 5 else f"{left}{word}{right}"), binds
    return f"{word}({', '.join(p[0] for p in parts)})", 9


def _within(part: tuple[str, int], least: int) -> str:
    return part[0] if part[1] >= least else f"({part[0]})"


def _as_condition(formula: Formula, text: str) -> str:
    if isinstance(formula, Applied) and formula.word in _CONDITIONS:
        return text.removeprefix("(if ").removesuffix(" then 1 else 0)")
    return f"abs({text}) > 0"


def _condition(formula: Applied, name: Callable[[str], str]) -> str:
    parts = [_write(a, name)[0] for a in formula.arguments]
    if formula.word in ("==", "!="):
        test = f"abs({parts[0]} - ({parts[1]})) {'<=' if formula.word == '==' else '>'} 0"
        return test
    if formula.word in _COMPARES:
        return f"{parts[0]} {formula.word} {parts[1]}"
    inner = [
        f"({_as_condition(a, text)})" for a, text in zip(formula.arguments, parts, strict=True)
    ]
    if formula.word == "not":
        return f"not {inner[0]}"
    return f" {'and' if formula.word == '&&' else 'or'} ".join(inner)
