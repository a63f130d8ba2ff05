"""Text to tree: a precedence-climbing parser with bounded input."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from itertools import pairwise
from typing import NoReturn

from hybond.errors import ExpressionError, UnitError
from hybond.model.expressions.as_in_circuits import called_as_in_circuits
from hybond.model.expressions.lines import lines_between, number_of
from hybond.model.expressions.tree import (
    FUNCTIONS,
    GATHER,
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
    children,
    depth,
    names,
    uses_pre,
    walk,
)
from hybond.names import did_you_mean
from hybond.records import dataclass
from hybond.units import parse_quantity, parse_unit

KEPT = 4096
"""Texts whose trees are kept: a model is flattened again with every set of parameters."""
MAX_LENGTH = 10_000
MAX_NESTING = 100
# A chain `a + b + c + ...` is one level deep to a reader but one level per term in the tree. A
# compiled tree costs one frame of Python's stack per level, its derivative up to three.
MAX_DEPTH = 200

LINES = "table"
"""The function of an argument and of points, which is written out as a sum."""
KEYWORDS = frozenset({"if", "then", "else", "and", "or", "not", "true", "false"})

_TOKEN = re.compile(
    r"""\s*(?:
      (?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?:\s*(?P<unit>\[[^\[\]]*\]))?
    | (?P<name>
        (?:(?:"[^"\n]*"|'[^'\n]*')(?=\.\w)|[^\W\d]\w*(?:\[[^\[\]]*\])?)
        (?:\.\w+(?:\[[^\[\]]*\])?)*
      )
    | (?P<string>"[^"\n]*"|'[^'\n]*')
    | (?P<brackets>\[[^\[\]]*\])
    | (?P<mark>\*\*|<=|>=|==|!=|[-+*/^()<>,%°])
    )""",
    re.VERBOSE,
)

_IF, _OR, _AND, _NOT, _COMPARE, _SUM, _PRODUCT, _NEG, _POWER = range(1, 10)
_LEFT = {"or": _OR, "and": _AND, "+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT}
_LEFT |= dict.fromkeys(("<", "<=", ">", ">=", "==", "!="), _COMPARE)
_LEFT |= {"^": _POWER, "if": _IF}


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str  # number, name, string, mark (keywords too) or end
    text: str
    at: int
    unit: str | None = None

    def __str__(self) -> str:
        return "the end" if self.kind == "end" else repr(self.text[:40])


def _is_unit(text: str) -> bool:
    try:
        parse_unit(text)
    except UnitError:
        return False
    return True


_COMMA = re.compile(r"(?<![\w.])(\d+)(,)(\d+(?:[eE][+-]?\d+)?)")
"""A number as half of the world writes it: 1,5."""
TIMERS = dict.fromkeys(
    ("after", "dwell", "elapsed", "timer"),
    "a part, control.timer, counts the time spent in a state, and is 1 once that is over",
)
"""How the time spent in a state is asked for, as a name or as a function."""
_WRITTEN = {
    "ln": "the natural logarithm is log(x)",
    **dict.fromkeys(("pow", "power"), "a power is a^b"),
    **dict.fromkeys(("step", "heaviside"), "write if time >= 1 s then 1 else 0"),
    **dict.fromkeys(("sat", "clip", "clamp", "limit"), "write min(max(x, low), high)"),
    "round": "write floor(x + 0.5)",
    **dict.fromkeys(
        ("np.float64", "np.float32", "np.int64"),
        "a number of NumPy is put into a text by float(x), or without !r",
    ),
    **dict.fromkeys(("integral", "int", "integrate"), "an integral is a signal of its own kind"),
    **dict.fromkeys(
        ("der", "deriv", "derivative", "ddt", "diff"),
        "what is stored changes at the rate of the flow of its C, of the effort of its I",
    ),
    **dict.fromkeys(
        ("delay", "delayed"),
        "a delay is a part: control.sampled_delay of samples, control.delay approximately",
    ),
    **dict.fromkeys(
        ("mean", "average", "rms", "peak", "std"),
        "what is measured of a run is no signal: hybond measure, run[...].mean()",
    ),
    **TIMERS,
}
"""How functions of other languages are written here."""


def parse(text: str, *, where: str = "") -> Expr:
    """Parse an expression.

    Parameters
    ----------
    text : str
        The expression. From weakest to strongest: ``if c then a else b`` (or ``a if c else b``),
        ``or``, ``and``, ``not``, comparisons, ``+ -``, ``* /``, unary ``-``, ``^`` (or ``**``).
    where : str
        Path of the expression in the model, for messages.

    Raises
    ------
    ExpressionError
        HB-E101 syntax, HB-E102 unit after a number, HB-E103 unknown function, HB-E104 number of
        arguments, HB-E106 misplaced text, HB-E107 too long or too deep.

    Notes
    -----
    A number may be followed by one unit symbol (``10 mA``, ``5 cm^2``) or by any unit in brackets
    (``9.81 [m/s^2]``), parentheses by a unit in brackets. Without brackets ``5 m/s`` is 5 metres
    divided by the name ``s``. A name may have an index, ``cell[3].q``, with no space before it;
    ``sum``, ``any``, ``all``, ``min`` and ``max`` take ranges of them, ``sum(cell[1..9].q)``.
    Names of states and bonds stand in quotes of either kind, ``floor.state == 'open'``.

    Examples
    --------
    >>> parse("ball.p <= 0 and pre(floor.f) > 5 cm")  # doctest: +ELLIPSIS
    And(args=(Compare(op='<=', left=Name(path='ball.p'), right=Number(value=0.0, ...
    >>> parse("2 * (x + ")
    Traceback (most recent call last):
        ...
    hybond.errors.ExpressionError: HB-E101: expected a value, found the end at column 10
        2 * (x +
                 ^
      try: write a number, a name or a formula there, or take out what asks for a value
    """
    if len(text) > MAX_LENGTH:
        why = f"the expression has {len(text)} characters, the limit is {MAX_LENGTH}"
        raise ExpressionError(why, code="HB-E107", where=where, hint="split it into signals")
    try:
        return _whole(text)
    except ExpressionError:
        # once more, to say where
        return _Parser(text, where).whole()


@lru_cache(KEPT)
def _whole(text: str) -> Expr:
    return _Parser(text, "").whole()


class _Parser:
    def __init__(self, text: str, where: str) -> None:
        self.text = text
        self.where = where
        self.depth = 0
        self.tokens = self.split()
        self.at = 0

    def split(self) -> list[_Token]:
        tokens: list[_Token] = []
        end = len(self.text.rstrip())
        at = 0
        while at < end:
            match = _TOKEN.match(self.text, at)
            if match is None:
                at += len(self.text[at:]) - len(self.text[at:].lstrip())
                self.strange(at)
            at = match.end()
            kind = "number" if match["number"] else str(match.lastgroup)
            word = match[kind]
            if kind == "brackets" and not (tokens and tokens[-1].text == ")"):
                self.strange(match.start(kind))
            if kind == "mark" and word == "**":
                word = "^"
            start = match.start(kind)
            if kind == "string":
                word = word[1:-1]
            elif word.startswith("'"):  # a text in a file may stand in double quotes itself
                word = word.replace("'", '"', 2)
            if word in KEYWORDS and kind == "name":
                kind = "mark"
            tokens.append(_Token(kind, word, start, match["unit"]))
        tokens.append(_Token("end", "", len(self.text)))
        return tokens

    def strange(self, at: int) -> NoReturn:
        found = self.text[at]
        hint = {
            "=": "compare with <, <=, > or >=; an expression cannot assign",
            **dict.fromkeys("\"'", 'close the quotes: "contact->v".e'),
            "&": "write and between conditions",
            "|": "write or between conditions",
            "!": "write not before a condition",
            "?": "write if condition then a else b",
            "[": "brackets hold a unit, 9.8 [m/s] or (x) [m], or, with no space, an index, c[3].q",
        }.get(found, "write arithmetic, comparisons, and, or, not, if, functions and pre(...)")
        law = re.fullmatch(r"\s*([efpq])\s*", self.text[:at]) if found == "=" else None
        if law:
            value = self.text[at + 1 :].strip()
            hint = f"where a law is meant, it stands in braces: {{ {law[1]} = {value!r} }}"
        self.fail(f"found {found!r}, which is not part of an expression,", at, hint=hint)

    @property
    def now(self) -> _Token:
        return self.tokens[self.at]

    def take(self) -> _Token:
        token = self.tokens[self.at]
        self.at += token.kind != "end"
        return token

    def is_mark(self, text: str) -> bool:
        return self.now.kind == "mark" and self.now.text == text

    def expect(self, text: str, *, opened: _Token) -> None:
        if not self.is_mark(text):
            back = f" to close {opened.text!r} of column {self.column(opened.at)}"
            hint = f"write {text} there: {self.text[: self.now.at].strip()[-30:]}{text}"
            if text in ("then", "else"):
                hint = "write if c then a else b"
            self.fail(f"expected {text!r}{back}, found {self.now}", self.now.at, hint=hint)
        self.take()

    def column(self, at: int) -> int:
        return at - (self.text.rfind("\n", 0, at) + 1) + 1

    def fail(self, why: str, at: int, *, code: str = "HB-E101", hint: str = "") -> NoReturn:
        start = self.text.rfind("\n", 0, at) + 1
        line = self.text[start:].split("\n", 1)[0].replace("\t", " ")
        row = self.text.count("\n", 0, at)
        place = (
            f"line {row + 1}, " if "\n" in self.text.strip() else ""
        ) + f"column {at - start + 1}"
        cut = max(0, at - start - 50)
        shown = line[cut : cut + 80].rstrip()
        raise ExpressionError(
            f"{why} at {place}\n    {shown}\n    {' ' * (at - start - cut)}^",
            code=code,
            where=self.where,
            hint=hint,
        )

    def whole(self) -> Expr:
        if self.now.kind == "end":
            self.fail("the expression is empty,", 0, hint="write a number, a name or a formula")
        e = self.expression(_IF)
        if self.now.kind != "end":
            hint = f"take out what stands from {self.now} on"
            if self.now.kind in ("name", "number", "string") or self.now.text == "(":
                hint = "write * for a product"
            comma = _COMMA.search(self.text)
            if comma and comma.start(2) == self.now.at:
                hint = f"a decimal fraction has a point: {comma[1]}.{comma[3]}"
            self.fail(f"expected an operator or the end, found {self.now}", self.now.at, hint=hint)
        if depth(e) > MAX_DEPTH:
            why = f"more than {MAX_DEPTH} operators follow one another"
            self.fail(why, 0, code="HB-E107", hint="split it into signals")
        self.check_texts(e)
        return e

    def expression(self, level: int) -> Expr:
        """Parse operators that bind at least as strongly as `level`."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            why = f"the expression is nested more than {MAX_NESTING} deep"
            self.fail(why, self.now.at, code="HB-E107", hint="split it into signals")
        e = self.operators(self.prefix(level), level)
        self.depth -= 1
        return e

    def operators(self, e: Expr, level: int) -> Expr:
        while self.now.kind == "mark" and _LEFT.get(self.now.text, 0) >= level:
            op = self.take()
            here = _LEFT[op.text]
            if op.text == "if":
                cond = self.expression(_OR)
                self.expect("else", opened=op)
                return If(cond, e, self.expression(_IF))
            if here in (_OR, _AND):
                args = [e, self.expression(here + 1)]
                while self.is_mark(op.text):
                    self.take()
                    args.append(self.expression(here + 1))
                e = And(tuple(args)) if here == _AND else Or(tuple(args))
            elif here == _COMPARE:
                e = Compare(op.text, e, self.expression(_SUM))
                if self.now.kind == "mark" and _LEFT.get(self.now.text) == _COMPARE:
                    hint = "write a < b and b < c"
                    self.fail(
                        f"comparisons cannot be chained: found {self.now}", self.now.at, hint=hint
                    )
            elif here == _POWER:
                e = Binary("^", e, self.expression(_NEG))
            else:
                e = Binary(op.text, e, self.expression(here + 1))
        return e

    def prefix(self, level: int) -> Expr:
        token = self.take()
        if token.kind == "number":
            return self.number(token)
        if token.kind == "name":
            return self.named(token)
        if token.kind == "string":
            return String(token.text)
        match token.text if token.kind == "mark" else "":
            case "(":
                e = self.expression(_IF)
                self.expect(")", opened=token)
                return self.in_unit(e)
            case "-":
                following = self.tokens[self.at]
                if following.kind == "number":
                    number = self.number(self.take())
                    if not self.is_mark("^"):
                        return Number(-number.value, number.dimension)
                    return Neg(self.operators(number, _POWER))
                return Neg(self.expression(_NEG))
            case "+":
                return self.expression(_NEG)
            case "true" | "false":
                return Bool(token.text == "true")
            case "not" if level <= _NOT:
                return Not(self.expression(_NOT))
            case "if" if level <= _IF:
                cond = self.expression(_OR)
                self.expect("then", opened=token)
                then = self.expression(_IF)
                self.expect("else", opened=token)
                return If(cond, then, self.expression(_IF))
            case "if" | "not":
                hint = "put it in parentheses"
                self.fail(f"{token} does not bind strongly enough here,", token.at, hint=hint)
        hint = "write a number, a name or a formula there, or take out what asks for a value"
        self.fail(f"expected a value, found {token}", token.at, hint=hint)

    def number(self, token: _Token) -> Number:
        unit = token.unit
        following = self.now
        if unit is None and (following.kind == "name" or following.text in ("%", "°")):
            symbol = self.take()
            unit = symbol.text
            if self.is_mark("(") or "." in unit:
                self.not_a_unit(token, symbol, "")
            power = re.compile(r"\s*(?:\^|\*\*)\s*(-?[0-9]+)(?![0-9.eE\[])").match(
                self.text, symbol.at + len(unit)
            )
            if power is not None:
                unit += "^" + power[1]
                self.take()
                if self.take().text == "-":
                    self.take()
        try:
            quantity = parse_quantity(f"{token.text} {unit or ''}")
        except UnitError as error:
            if unit is None:
                self.fail(error.why, token.at, hint=error.hint)
            if token.unit is None:
                if error.code == "HB-U105":
                    self.fail(error.why, token.at, code="HB-E102", hint=error.hint)
                hint = "" if error.code == "HB-U104" else error.hint
                self.not_a_unit(token, following, hint)
            at = self.text.index("[", token.at)
            self.fail(error.why, at, code="HB-E102", hint=error.hint)
        return Number(quantity.value, None if unit is None else quantity.dimension)

    def in_unit(self, e: Expr) -> Expr:
        """Return what stands in parentheses times the unit behind them, if there is one."""
        if self.now.kind != "brackets":
            return e
        token = self.take()
        try:
            one = parse_quantity(f"1 {token.text}")
        except UnitError as error:
            self.fail(error.why, token.at, code="HB-E102", hint=error.hint)
        return Binary("*", e, Number(one.value, one.dimension))

    def not_a_unit(self, number: _Token, symbol: _Token, hint: str) -> NoReturn:
        call = "(...)" if self.is_mark("(") else ""
        product = f"for a product write {number.text[:40]}*{symbol.text[:40]}{call}"
        compound = re.fullmatch(r"did you mean '([^']*[*/^][^']*)'\?", hint)
        if compound:  # `2 N*m` would be 2 newton times m
            rest = self.text[symbol.at + len(symbol.text) :]
            unit = compound[1] + rest if _is_unit(compound[1] + rest) else compound[1]
            hint = f"write {number.text[:40]} [{unit}]"
        remedy = f"{hint}; {product}" if hint and not hint.startswith("known") else product
        why = f"{symbol} after the number {number.text[:40]} is not a unit"
        self.fail(why, symbol.at, code="HB-E102", hint=remedy)

    def named(self, token: _Token) -> Expr:
        if not self.is_mark("("):
            return Number(math.pi) if token.text == "pi" else Name(token.text)
        if token.text not in ("pre", *FUNCTIONS, *GATHER, LINES):
            hint = called_as_in_circuits(token.text, self.text[token.at + len(token.text) :])
            hint = hint or _WRITTEN.get(token.text.lower(), "")
            hint = hint or did_you_mean(token.text, ["pre", LINES, *FUNCTIONS, *GATHER])
            self.fail(f"unknown function {token}", token.at, code="HB-E103", hint=hint)
        opened = self.take()
        args: list[Expr] = []
        if not self.is_mark(")"):
            args.append(self.expression(_IF))
            while self.is_mark(","):
                self.take()
                args.append(self.expression(_IF))
        self.expect(")", opened=opened)
        if token.text in (*GATHER, "min", "max") and any(".." in n for a in args for n in names(a)):
            return self.in_unit(Call(token.text, tuple(args)))
        if token.text in GATHER:
            hint = f"write {token.text}(cell[1..10].q), with a range of members"
            self.fail(
                f"{token.text} takes members of an array", token.at, code="HB-E104", hint=hint
            )
        if token.text == LINES:
            return self.in_unit(self.lines(token, args))
        least, most = FUNCTIONS.get(token.text, (1, 1))
        if not least <= len(args) <= most:
            needs = str(least) if least == most else f"{least} to {most}"
            why = f"{token.text} takes {needs} argument{'s' * (most > 1)}, not {len(args)},"
            arguments = ", ".join("abcdef"[: max(least, 1)])
            hint = f"write {token.text}({arguments})"
            self.fail(why, token.at, code="HB-E104", hint=hint)
        if token.text != "pre":
            return self.in_unit(Call(token.text, tuple(args)))
        if uses_pre(args[0]):
            hint = "the a priori value of an a priori value is not kept"
            self.fail("pre(...) stands inside pre(...)", token.at, hint=hint)
        return Pre(args[0])

    def lines(self, token: _Token, args: list[Expr]) -> Expr:
        """Return what joins points by straight lines, and holds the values at both ends."""
        at, values = args[1::2], args[2::2]
        if len(args) < 5 or len(args) % 2 == 0:
            why = "table takes an argument and two or more points"
            self.fail(why, token.at, code="HB-E104", hint="write table(x, x0, y0, x1, y1)")
        places = [number_of(e) for e in at]
        known = [x for x in places if x is not None]
        if len(known) < len(places):
            why = "a point of the table is not at a number"
            self.fail(why, token.at, code="HB-E104", hint="values may be expressions, x may not")
        if any(b <= a for a, b in pairwise(known)):
            why = "the points of the table do not ascend"
            self.fail(why, token.at, code="HB-E104", hint="sort them, each x once")
        return lines_between(args[0], at, values, held=True)

    def check_texts(self, e: Expr) -> None:
        """Refuse a text anywhere but beside == or !=."""
        if not any(token.kind == "string" for token in self.tokens):
            return
        for node, _ in [(None, False), *walk(e)]:
            below = (e,) if node is None else children(node)
            if isinstance(node, Compare) and node.op in ("==", "!="):
                continue
            for child in below:
                if isinstance(child, String):
                    at = next(t.at for t in self.tokens if t.text == child.text)
                    hint = 'compare it: machine.state == "open"'
                    self.fail(
                        f'the text "{child.text[:40]}" is no value', at, code="HB-E106", hint=hint
                    )
