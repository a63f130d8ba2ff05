"""What the printed languages share: statements in braces, expressions with precedence."""

from __future__ import annotations

from collections.abc import Mapping

from hybond.translate.effects import Effects, reads
from hybond.translate.lines import block_comment, line_comments, plain, prose, wrapped
from hybond.translate.placing import Places, places
from hybond.translate.reserved import permitted
from hybond.translate.tree import (
    Assign,
    Augment,
    Binary,
    Block,
    Call,
    Choice,
    Do,
    Element,
    Expr,
    Field,
    For,
    Function,
    Global,
    If,
    Jump,
    Local,
    Notes,
    Return,
    Statement,
    Type,
    Unary,
    Value,
    While,
    Word,
)
from hybond.translate.walks import statements, within

ATOM, UNARY = 15, 14
BITS = frozenset(("&", "|", "^", "<<", ">>"))
_RANK: Mapping[str, int] = {
    **dict.fromkeys(("*", "/", "//", "%"), 13),
    **dict.fromkeys(("+", "-"), 12),
    **dict.fromkeys(("<<", ">>"), 11),
    **dict.fromkeys(("<", "<=", ">", ">="), 10),
    **dict.fromkeys(("==", "!="), 9),
    "&": 8,
    "^": 7,
    "|": 6,
    "and": 5,
    "or": 4,
}
CHOICE = 3
UNREAD = "turn"
"""What ``_`` is called, the variable of a loop that nothing reads."""

Text = tuple[str, int]
"""Printed expression, and how strongly its outermost operator binds."""


class Braces:
    """A printer of statements and expressions; what differs is in its subclasses.

    Parameters
    ----------
    effects : Effects
        Of the program that is printed.
    """

    null = "NULL"
    member = "->"

    def __init__(self, effects: Effects) -> None:
        self.effects = effects
        self.places = Places()
        self.function = ""
        self.used: set[str] = set()
        """Words that need a helper in the printed text."""

    def type_name(self, t: Type) -> str:
        """Return the name of a type."""
        raise NotImplementedError

    def declarator(self, name: str, t: Type) -> str:
        """Return the declaration of a variable, without a value."""
        raise NotImplementedError

    def text(self, value: str) -> str:
        """Return a literal of text."""
        raise NotImplementedError

    def number(self, value: float) -> str:
        """Return a literal of a number with a fraction."""
        raise NotImplementedError

    def named(self, name: str, t: Type) -> str:
        """Return how a constant is called."""
        raise NotImplementedError

    def called(self, name: str) -> str:
        """Return how a function is called."""
        return name

    def passed(self, _name: str) -> list[str]:
        """Return what a function is given before its arguments."""
        return []

    def word(self, e: Word, args: list[str]) -> Text:
        """Return the call of what every language has."""
        raise NotImplementedError

    def empty(self, t: Type) -> str:
        """Return the value of a variable before it has one."""
        return {"int": "0", "float": "0.0", "bool": "false", "Text": '""'}.get(t.kind, self.null)

    # expressions

    def said(self, e: Expr) -> str:
        """Return an expression as text."""
        return self.expression(e)[0]

    def inside(self, e: Expr, rank: int) -> str:
        """Return an expression as an operand: in brackets if it binds less than `rank`."""
        text, own = self.expression(e)
        return f"({text})" if own < rank else text

    def expression(self, e: Expr) -> Text:
        """Return an expression and how strongly it binds."""
        match e:
            case Value():
                return self.literal(e), ATOM
            case Local(name):
                return permitted(name), ATOM
            case Global(name, t):
                return self.named(name, t), ATOM
            case Field(base, name):
                return f"{self.inside(base, ATOM)}{self.member}{permitted(name)}", ATOM
            case Element(base, index):
                return f"{self.inside(base, ATOM)}[{self.said(index)}]", ATOM
            case Unary(op, arg):
                mark = {"not": "!"}.get(op, op)
                text = self.inside(arg, UNARY)
                return f"{mark}({text})" if text.startswith("-") else f"{mark}{text}", UNARY
            case Binary(op, left, right):
                return self.binary(op, left, right)
            case Choice(cond, then, orelse):
                texts = (self.inside(x, CHOICE + 1) for x in (cond, then))
                return f"{' ? '.join(texts)} : {self.inside(orelse, CHOICE)}", CHOICE
            case Call(function, args):
                passed = [*self.passed(function), *(self.said(a) for a in args)]
                return f"{self.called(function)}({', '.join(passed)})", ATOM
            case Word():
                return self.word(e, [self.said(a) for a in e.args])

    def binary(self, op: str, left: Expr, right: Expr) -> Text:
        """Return ``left op right``; some brackets are there for the reader and the compiler."""
        rank = _RANK[op]
        a, b = rank, rank + 1
        if op in BITS or op in ("==", "!="):
            a = b = UNARY if op in BITS else _RANK["<"] + 1
            same = isinstance(left, Binary) and left.op == op and op in "&|^"
            a = rank if same else a
        elif op == "or":
            a = b = _RANK["and"] + 1
            a = rank if isinstance(left, Binary) and left.op == "or" else a
        sign = {"and": "&&", "or": "||", "//": "/"}.get(op, op)
        right_text = self.inside(right, b)
        return f"{self.inside(left, a)} {sign} {right_text}", rank

    def literal(self, e: Value) -> str:
        """Return a literal."""
        match e.value:
            case None:
                return self.null
            case bool():
                return "true" if e.value else "false"
            case int():
                return str(e.value)
            case float():
                return self.number(e.value)
        return self.text(e.value)

    # statements

    def body(self, f: Function) -> list[str]:
        """Return the lines of a function's body."""
        assert f.body is not None
        self.places = places(f)
        self.function = f.name
        return self.block(f.body, 4)

    def block(self, block: Block, indent: int) -> list[str]:
        """Return the lines of a block."""
        lines: list[str] = []
        for s in block.statements:
            notes = s.notes
            if notes.gap:
                lines.append("")
            lines += line_comments(notes.above, indent)
            for name, t in self.places.before.get(id(s), ()):
                lines.append(f"{' ' * indent}{self.declarator(name, t)} = {self.empty(t)};")
            lines += self.statement(s, indent)
        return lines + line_comments(block.below, indent)

    def statement(self, s: Statement, indent: int) -> list[str]:
        """Return the lines of a statement."""
        match s:
            case If():
                return self.branches(s, indent)
            case While(cond, body, notes):
                return self.braced(f"while ({self.said(cond)})", body, notes, indent)
            case For():
                return self.braced(self.loop(s), s.body, s.notes, indent)
            case Jump("pass", notes):
                return line_comments((notes.behind,), indent) if notes.behind else []
            case Jump(word, notes):
                return self.line(f"{word};", notes, indent)
            case Return(value, notes):
                text = "return;" if value is None else f"return {self.said(value)};"
                return self.line(text, notes, indent)
            case Do(call, notes):
                return self.line(f"{self.said(call)};", notes, indent)
            case Augment(op, target, value, notes):
                return self.line(self.augmented(op, target, value), notes, indent)
            case Assign(target, value, notes):
                place = self.said(target)
                if id(s) in self.places.first:
                    assert isinstance(target, Local)
                    place = self.declarator(target.name, target.type)
                return self.line(f"{place} = {self.said(value)};", notes, indent)

    def augmented(self, op: str, target: Expr, value: Expr) -> str:
        """Return ``target op= value;``."""
        one = isinstance(value, Value) and value.value == 1 and target.type.kind == "int"
        if one and op in "+-":
            return f"{self.said(target)}{op * 2};"
        return f"{self.said(target)} {'/' if op == '//' else op}= {self.said(value)};"

    def line(self, text: str, notes: Notes, indent: int) -> list[str]:
        """Return one statement, with the comment behind it."""
        lines = wrapped(text, indent)
        if not notes.behind:
            return lines
        comment = f"  // {plain(notes.behind)}".rstrip("\\")
        if len(lines[-1]) + len(comment) <= 99:
            return [*lines[:-1], lines[-1] + comment]
        return [*line_comments((notes.behind,), indent), *lines]

    def braced(self, head: str, body: Block, notes: Notes, indent: int) -> list[str]:
        """Return a loop."""
        lines = self.line(f"{head} {{", notes, indent)
        return [*lines, *self.block(body, indent + 4), f"{' ' * indent}}}"]

    def branches(self, s: If, indent: int) -> list[str]:
        """Return ``if``, ``else if`` and ``else``."""
        pad = " " * indent
        lines: list[str] = []
        for k, (cond, body) in enumerate(s.branches):
            notes = s.notes if k == 0 else s.branch_notes[k - 1]
            head = "if" if k == 0 else "} else if"
            if k:
                lines += line_comments(notes.above, indent + 4)
            shown = Notes(notes.line, (), notes.behind)
            lines += self.line(f"{head} ({self.said(cond)}) {{", shown, indent)
            lines += self.block(body, indent + 4)
        if s.orelse is not None:
            notes = s.branch_notes[-1]
            lines += self.line("} else {", Notes(notes.line, (), notes.behind), indent)
            lines += line_comments(notes.above, indent + 4)
            lines += self.block(s.orelse, indent + 4)
        return [*lines, f"{pad}}}"]

    def loop(self, s: For) -> str:
        """Return the head of a ``for``; a bound that its body could change is kept first."""
        name = UNREAD if s.name == "_" else permitted(s.name)
        bound, kept = self.said(s.stop), ""
        if self.moves(s):
            kept = f", {name}_end = {bound}"
            bound = f"{name}_end"
        elif self.expression(s.stop)[1] <= _RANK["<"]:
            bound = f"({bound})"
        sign = "<" if s.step > 0 else ">"
        if s.step == -1 and isinstance(s.stop, Unary) and bound == "-1":
            sign, bound = ">=", "0"
        step = {1: f"{name}++", -1: f"{name}--"}.get(s.step, f"{name} += {s.step}")
        if s.step < -1:
            step = f"{name} -= {-s.step}"
        return f"for (int {name} = {self.said(s.start)}{kept}; {name} {sign} {bound}; {step})"

    def moves(self, s: For) -> bool:
        """Say whether a loop's body could change its bound, or the bound is worth keeping."""
        if any(isinstance(e, Call) for e in within(s.stop)):
            return True
        names = {e.name for e in within(s.stop) if isinstance(e, Local)}
        for inner in statements(s.body):
            target = inner.target if isinstance(inner, Assign | Augment) else None
            if isinstance(target, Local) and target.name in names:
                return True
        return bool(reads(s.stop) & self.effects.of_block(s.body))

    # what stands around functions

    def documented(self, doc: str, above: tuple[str, ...], *, opener: str = "/*") -> list[str]:
        """Return the comment of a function or record."""
        lines = line_comments(above, 0)
        if doc:
            lines += block_comment(prose(doc), opener=opener)
        return lines
