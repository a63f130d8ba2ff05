"""The typed tree as Java."""

from __future__ import annotations

import math

from hybond.translate.braces import ATOM, UNARY, Text
from hybond.translate.c_printer import decimal, helper_of
from hybond.translate.chapters import Chapters
from hybond.translate.lines import block_comment, line_comments, prose, wrapped
from hybond.translate.reserved import permitted
from hybond.translate.tree import (
    FLOAT,
    Binary,
    Constant,
    Function,
    Member,
    Module,
    Record,
    Type,
    Word,
)

_TYPES = {
    "int": "int",
    "float": "double",
    "bool": "boolean",
    "Text": "String",
    "Floats": "double[]",
    "Ints": "int[]",
    "void": "void",
}
_EXACT = {
    "sqrt": "Math.sqrt",
    "fabs": "Math.abs",
    "floor": "Math.floor",
    "ceil": "Math.ceil",
    "copysign": "Math.copySign",
    "isfinite": "Double.isFinite",
    "isnan": "Double.isNaN",
    "abs": "Math.abs",
}
"""Functions whose results are exact, or rounded correctly; the others come from StrictMath, which
gives the same bits everywhere."""


class JavaPrinter(Chapters):
    """A printer of Java: static methods and nested classes."""

    null = "null"
    member = "."
    width = 95

    def type_name(self, t: Type) -> str:
        """Return a type."""
        if t.kind in ("record", "Records"):
            return t.record if t.kind == "record" else f"{t.record}[]"
        return _TYPES[t.kind]

    def declarator(self, name: str, t: Type) -> str:
        """Return the declaration of a variable."""
        return f"{self.type_name(t)} {permitted(name)}"

    def signature(self, f: Function) -> str:
        """Return the head of a method."""
        given = ", ".join(self.declarator(name, t) for name, t in f.signature.parameters)
        return f"private static {self.type_name(f.signature.result)} {f.name}({given})"

    def text(self, value: str) -> str:
        """Return a literal."""
        return java_text(value)

    def number(self, value: float) -> str:
        """Return a literal."""
        return java_number(value)

    def named(self, name: str, t: Type) -> str:
        """Return how a constant is called."""
        special = {"math.inf": math.inf, "math.nan": math.nan, "math.pi": math.pi}
        return java_number(special[name]) if name in special else name

    def word(self, e: Word, args: list[str]) -> Text:
        """Return a call of the Java library, of a helper, or an operator."""
        listed = ", ".join(args)
        match e.word:
            case "float" | "int":
                kind = "double" if e.word == "float" else "int"
                return f"({kind}) {self.inside(e.args[0], UNARY)}", UNARY
            case "quotient":
                return self.expression(Binary("/", e.args[0], e.args[1], FLOAT))
            case "fmod":
                return self.expression(Binary("%", e.args[0], e.args[1], FLOAT))
            case "record":
                return f"new {e.type.record}()", ATOM
            case "records":
                return f"new {e.type.record}[{listed}]", ATOM
            case "floats" | "ints":
                return f"new {'double' if e.word == 'floats' else 'int'}[{listed}]", ATOM
            case "min" | "max":
                return f"{helper_of(e.word, e.type)}({listed})", ATOM
            case "empty" | "put_text" | "put_number" | "put_int" | "put_line":
                return f"{e.word}({listed})", ATOM
        return f"{_EXACT.get(e.word, f'StrictMath.{e.word}')}({listed})", ATOM

    # chapters

    def chapter(self, module: Module) -> list[str]:
        """Return what of a module is needed: constants, records, methods, as they stand there."""
        lines: list[str] = []
        for name in module.order:
            constant = module.constants.get(name)
            if constant is not None and constant.name in self.reached.constants:
                lines += [""] if constant.above or not lines or lines[-1].startswith("}") else []
                lines += self.constant(constant)
            record = module.records.get(name)
            if record is not None and name in self.reached.records and not record.given:
                lines += ["", *self.record(record)]
            f = module.functions.get(name)
            if f is not None and f.name in self.reached.functions and f.body is not None:
                lines += ["", *self.defined(f)]
            elif f is not None and self.given.get(name):
                lines += ["", *self.given[name]]
        return [ascii_only(line) for line in lines]

    def constant(self, c: Constant) -> list[str]:
        """Return a constant."""
        lines = line_comments(c.above, 0)
        head = f"private static final {self.type_name(c.type)} {c.name} = "
        match c.value:
            case tuple():
                lines += line_comments((c.behind,) if c.behind else (), 0)
                return [*lines, *wrapped(f"{head}{{{java_list(c.value)}}};", 0)]
            case bool():
                text = f"{head}{'true' if c.value else 'false'};"
            case str():
                text = f"{head}{java_text(c.value)};"
            case int():
                text = f"{head}{c.value};"
            case _:
                text = f"{head}{java_number(c.value)};"
        return [*lines, *self.noted(text, c.behind)]

    def record(self, record: Record) -> list[str]:
        """Return a record as a class."""
        lines = block_comment(prose(record.doc), opener="/**") if record.doc else []
        lines.append(f"private static final class {record.name} {{")
        return [*lines, *self.fields(record), "}"]

    def field(self, record: Record, m: Member) -> str:
        """Return the declaration of a field."""
        return self.declarator(m.name, m.type)

    def definition(self, f: Function) -> list[str]:
        """Return a method."""
        head = wrapped(self.signature(f) + " {", 0)
        return [*self.documented(f.doc, f.above, opener="/**"), *head, *self.body(f), "}"]


def java_number(value: float) -> str:
    """Return a literal that is read back as the same number.

    Examples
    --------
    >>> java_number(1e-12), java_number(2.0), java_number(-math.inf)
    ('1e-12', '2.0', 'Double.NEGATIVE_INFINITY')
    """
    if math.isinf(value):
        return f"Double.{'POSITIVE' if value > 0 else 'NEGATIVE'}_INFINITY"
    if math.isnan(value):
        return "Double.NaN"
    return decimal(value)


def java_text(value: str) -> str:
    r"""Return a text as a literal in ASCII.

    Examples
    --------
    >>> print(java_text('\u03ba "so"\n'))
    "\u03ba \"so\"\n"
    """
    marks = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t"}
    units = value.encode("utf-16-be")
    found = []
    for k in range(0, len(units), 2):
        code = units[k] * 256 + units[k + 1]
        plain_one = 32 <= code < 127
        found.append(marks.get(chr(code), chr(code) if plain_one else f"\\u{code:04x}"))
    return f'"{"".join(found)}"'


def java_list(values: tuple[int, ...] | tuple[float, ...]) -> str:
    """Return numbers as they stand in an array."""
    whole = all(type(v) is int for v in values)
    return ", ".join(str(v) if whole else java_number(float(v)) for v in values)


_LETTERS = {"Ω": "ohm", "µ": "u", "δ": "delta", "×": "x", "κ": "kappa", "ν": "nu", "θ": "theta"}


def ascii_only(line: str) -> str:
    """Return a line of code or comment that any encoding of the source reads.

    Examples
    --------
    >>> ascii_only("// 5 Ω·m")
    '// 5 ohm.m'
    """
    if line.isascii():
        return line
    said = "".join(_LETTERS.get(c, c) for c in line).replace("·", ".").replace("²", "^2")
    return said.encode("ascii", "replace").decode("ascii")
