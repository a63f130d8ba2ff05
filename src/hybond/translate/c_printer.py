"""The typed tree as C99."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from hybond.translate.braces import ATOM, UNARY, Text
from hybond.translate.chapters import Chapters
from hybond.translate.lines import block_comment, line_comments, prose, wrapped
from hybond.translate.memory import TAKING, at_hand
from hybond.translate.reserved import permitted
from hybond.translate.tree import (
    FLOAT,
    Binary,
    Constant,
    Function,
    Local,
    Member,
    Module,
    Record,
    Type,
    Word,
)
from hybond.translate.walks import every

_TYPES = {
    "int": "int ",
    "float": "double ",
    "bool": "bool ",
    "Text": "const char *",
    "Floats": "double *",
    "Ints": "int *",
    "void": "void ",
}


class CPrinter(Chapters):
    """A printer of C99."""

    held: Mapping[str, int] = {}
    """Tables that the model's record holds itself, and their sizes; others it points to."""
    beside: Sequence[str] = ()
    """Declarations of what the model's record holds beside its tables."""
    placed: Mapping[str, str] = {}
    """Constants that stand in that record, and how they are read."""

    def type_name(self, t: Type) -> str:
        """Return a type, ready to stand before a name."""
        if t.kind in ("record", "Records"):
            return f"{t.record} {'*' if t.kind == 'record' else '**'}"
        return _TYPES[t.kind]

    def _typed(self, name: str, t: Type, holder: tuple[str, str, str]) -> str:
        name = permitted(name)
        if t.is_reference and holder not in self.effects.written:
            if t.kind == "Records":
                return f"{t.record} *const *{name}"
            return f"const {self.type_name(t)}{name}"
        return f"{self.type_name(t)}{name}"

    def declarator(self, name: str, t: Type) -> str:
        """Return the declaration of a local variable."""
        return self._typed(name, t, ("local", self.function, name))

    def signature(self, f: Function) -> str:
        """Return the head of a function."""
        given = [
            self._typed(name, t, ("local", f.name, name)) for name, t in f.signature.parameters
        ]
        given = ["Arena *arena", *given] if f.name in self.effects.makers else given
        result = self._typed(f.name, f.signature.result, ("result", f.name, ""))
        return f"static {result}({', '.join(given) or 'void'})"

    def text(self, value: str) -> str:
        """Return a literal."""
        return c_text(value)

    def number(self, value: float) -> str:
        """Return a literal."""
        return c_number(value)

    def named(self, name: str, t: Type) -> str:
        """Return how a constant is called."""
        special = {"math.inf": "HUGE_VAL", "math.nan": "(double)NAN", "math.pi": c_number(math.pi)}
        return special.get(name) or self.placed.get(name, name)

    def passed(self, name: str) -> list[str]:
        """Return the arena, for a function that is to take memory from it."""
        return [self.arena()] if name in self.effects.makers else []

    @property
    def finds_arena(self) -> bool:
        """Whether a function that is printed asks a record for its arena."""
        made = self.effects.makers
        for name in self.reached.functions - made:
            uses = self.uses[name]
            if uses.words & TAKING or made.intersection(uses.calls):
                return True
        return False

    def arena(self) -> str:
        """Return the arena, where a function is printed."""
        if self.function in self.effects.makers:
            return "arena"
        name = at_hand(self.program.functions[self.function], self.program)
        return f"arena_of({permitted(name)})"

    def word(self, e: Word, args: list[str]) -> Text:
        """Return a call of the C library, of a helper, or an operator."""
        listed = ", ".join(args)
        match e.word:
            case "float" | "int":
                kind = "double" if e.word == "float" else "int"
                return f"({kind}){self.inside(e.args[0], UNARY)}", UNARY
            case "quotient":
                return self.expression(Binary("/", e.args[0], e.args[1], FLOAT))
            case "record":
                return f"take({self.arena()}, 1, sizeof({e.type.record}))", ATOM
            case "records":
                return f"take({self.arena()}, {listed}, sizeof({e.type.record} *))", ATOM
            case "floats" | "ints":
                return f"{e.word}({self.arena()}, {listed})", ATOM
            case "abs":
                return f"{'abs' if e.type.kind == 'int' else 'fabs'}({listed})", ATOM
            case "min" | "max":
                return f"{helper_of(e.word, e.type)}({listed})", ATOM
        return f"{e.word}({listed})", ATOM

    # chapters

    def typedefs(self) -> list[str]:
        """Return the names of all records, which may refer to each other."""
        names = [n for m in self.program.modules for n in m.records if n in self.reached.records]
        return [f"typedef struct {name} {name};" for name in names]

    def chapter(self, module: Module) -> list[str]:
        """Return what of a module is needed: constants, records, functions, as they stand there."""
        lines: list[str] = []
        whole: list[Constant] = []

        def flush() -> None:
            if whole:
                lines.extend(["", *self.enumeration(whole)])
                whole.clear()

        early = self.forward(module)
        for name in module.order:
            constant = module.constants.get(name)
            if constant is not None and constant.name in self.reached.constants:
                if constant.type.kind == "int":
                    whole.append(constant)
                    continue
                flush()
                lines += (
                    ["", *self.constant(constant)] if constant.above else self.constant(constant)
                )
            record = module.records.get(name)
            if record is not None and name in self.reached.records:
                flush()
                lines += ["", *self.record(record)]
            f = module.functions.get(name)
            if f is not None and self.given.get(name):
                flush()
                lines += ["", *self.given[name]]
            elif f is not None and f.name in self.reached.functions and f.body is not None:
                flush()
                if early:
                    lines += ["", *early]
                    early = []
                lines += ["", *self.defined(f)]
        flush()
        return lines

    def forward(self, module: Module) -> list[str]:
        """Return declarations of the functions that are called before they are defined."""
        defined: set[str] = set()
        early: list[str] = []
        printed = [
            f
            for name in module.order
            if (f := module.functions.get(name)) is not None
            and f.name in self.reached.functions
            and f.body is not None
        ]
        own = {f.name: f for f in printed}
        for f in printed:
            defined.add(f.name)
            for called in self.uses[f.name].calls:
                if called in own and called not in defined:
                    defined.add(called)
                    early += wrapped(self.signature(own[called]) + ";", 0)
        return early

    def enumeration(self, constants: list[Constant]) -> list[str]:
        """Return whole numbers as one enumeration."""
        if len(constants) == 1 and not constants[0].behind:
            c = constants[0]
            return [*line_comments(c.above, 0), f"enum {{ {c.name} = {c.value} }};"]
        lines = [*line_comments(constants[0].above, 0), "enum {"]
        for k, c in enumerate(constants):
            if k:
                lines += line_comments(c.above, 4)
            comma = "," if k + 1 < len(constants) else ""
            lines += self.noted(f"    {c.name} = {c.value}{comma}", c.behind)
        return [*lines, "};"]

    def constant(self, c: Constant) -> list[str]:
        """Return a constant that is not a whole number."""
        lines = line_comments(c.above, 0)
        if isinstance(c.value, tuple):
            lines += line_comments((c.behind,) if c.behind else (), 0)
            return [*lines, *c_table(c.name, c.value)]
        match c.value:
            case bool():
                text = f"static const bool {c.name} = {'true' if c.value else 'false'};"
            case str():
                text = f"static const char *const {c.name} = {c_text(c.value)};"
            case _:
                text = f"static const double {c.name} = {c_number(float(c.value))};"
        return [*lines, *self.noted(text, c.behind)]

    def record(self, record: Record) -> list[str]:
        """Return a record."""
        lines = block_comment(prose(record.doc)) if record.doc else []
        lines.append(f"struct {record.name} {{")
        fields = self.fields(record)
        if record.given and self.beside:
            fields += ["", *self.beside]
        return [*lines, *(fields or ["    int nothing;"]), "};"]

    def field(self, record: Record, m: Member) -> str:
        """Return the declaration of a field."""
        if record.given and m.name in self.held:
            return f"double {permitted(m.name)}[{self.held[m.name]}]"
        return self._typed(m.name, m.type, ("field", record.name, m.name))

    def definition(self, f: Function) -> list[str]:
        """Return a function."""
        head = wrapped(self.signature(f), 0)
        assert f.body is not None
        read = {e.name for e in every(f.body) if isinstance(e, Local)}
        unread = [permitted(name) for name, _ in f.signature.parameters if name not in read]
        body = self.body(f)
        if f.name in self.effects.makers and not any("arena" in line for line in body):
            unread = ["arena", *unread]
        unused = [f"    (void){name};" for name in unread]
        return [*self.documented(f.doc, f.above), *head, "{", *unused, *body, "}"]


def helper_of(word: str, t: Type) -> str:
    """Return the helper for the smaller or larger of two numbers."""
    name = "smaller" if word == "min" else "larger"
    return f"{name}_int" if t.kind == "int" else name


def c_number(value: float) -> str:
    """Return a literal that is read back as the same number.

    Examples
    --------
    >>> c_number(1e-12), c_number(2.0), c_number(-math.inf)
    ('1e-12', '2.0', '-HUGE_VAL')
    """
    if math.isinf(value):
        return "HUGE_VAL" if value > 0 else "-HUGE_VAL"
    if math.isnan(value):
        return "(double)NAN"
    return decimal(value)


def decimal(value: float) -> str:
    """Return a finite number as C and Java read it, in few characters.

    Examples
    --------
    >>> decimal(1e13), decimal(1.5e-09), decimal(100.0), decimal(0.1)
    ('1e13', '1.5e-9', '100.0', '0.1')
    """
    text = repr(value)
    if "e" not in text:
        if not text.endswith("00000.0"):
            return text
        digits = text.removesuffix(".0")
        kept = digits.rstrip("0")
        lead = len(kept.lstrip("-"))
        if lead > 1:
            sign, body = kept[: len(kept) - lead], kept[len(kept) - lead :]
            kept = f"{sign}{body[0]}.{body[1:]}"
        return f"{kept}e{len(digits.lstrip('-')) - 1}"
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}"


def c_text(value: str) -> str:
    r"""Return a text as a literal; C reads it as UTF-8.

    Examples
    --------
    >>> print(c_text('say "so"\n'))
    "say \"so\"\n"
    """
    marks = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "?": "\\?"}
    shown = (marks.get(c, c if c >= " " else f"\\{ord(c):03o}") for c in value)
    return f'"{"".join(shown)}"'


def c_table(name: str, values: tuple[int, ...] | tuple[float, ...]) -> list[str]:
    r"""Return a table of numbers.

    Examples
    --------
    >>> print("\n".join(c_table("NODES", (0.0, 0.5))))
    static const double NODES[2] = {0.0, 0.5};
    """
    whole = all(type(v) is int for v in values)
    kind = "int" if whole else "double"
    listed = ", ".join(str(v) if whole else c_number(float(v)) for v in values)
    return wrapped(f"static const {kind} {name}[{len(values)}] = {{{listed}}};", 0)
