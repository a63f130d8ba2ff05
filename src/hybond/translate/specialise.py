"""A program without what a model does not need: conditions that are known, and what follows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from hybond.translate.effects import Effects
from hybond.translate.modules import Program
from hybond.translate.reach import Uses, function_uses, uses_of
from hybond.translate.tree import (
    BOOL,
    Assign,
    Augment,
    Binary,
    Block,
    Call,
    Choice,
    Do,
    Expr,
    Field,
    For,
    Function,
    Global,
    If,
    Jump,
    Local,
    Return,
    Statement,
    Unary,
    Value,
    While,
    Word,
)
from hybond.translate.walks import blocks, of_statement, statements

Facts = Mapping[tuple[str, str], int]
"""Whole numbers that fields of records have: record and name of the field to the number."""

_COMPARED = {
    "<": int.__lt__,
    "<=": int.__le__,
    ">": int.__gt__,
    ">=": int.__ge__,
    "==": int.__eq__,
    "!=": int.__ne__,
}


Made = tuple[str, tuple[tuple[tuple[str, str], int], ...]]
"""What tells a function without what facts rule out: its name, and the facts that concern it."""


class Specialist:
    """Makes programs without the branches and loops that facts rule out; keeps what it made.

    Only conditions are decided; sizes and indices stay as they were written. Variables that
    nothing reads afterwards go, too.

    Parameters
    ----------
    effects : Effects
        What its functions change.
    uses : mapping, optional
        What they use, if it is known.
    bodies : mapping, optional
        Their bodies, where those of `program` are left out.
    known : mapping, optional
        What functions use that were made before. Such a function is made without its body: who
        needs that asks `opened`.
    """

    def __init__(
        self,
        program: Program,
        effects: Effects,
        *,
        uses: Mapping[str, Uses] | None = None,
        bodies: Mapping[str, Block] | None = None,
        known: Mapping[Made, Uses] | None = None,
    ) -> None:
        self.program = program
        self.effects = effects
        self.uses = uses_of(program) if uses is None else uses
        self.made: dict[Made, Function] = {}
        self.made_uses: dict[int, Uses] = {}
        """By the identity of the function."""
        self._bodies = bodies
        self._known = known or {}
        self._unread: dict[int, tuple[Function, Facts]] = {}
        """Functions without their bodies: of what they are made, and by which facts."""
        self._opened: dict[int, Function] = {}
        self._constants = {
            c.name: c.value for c in program.constants.values() if type(c.value) is int
        }

    def program_for(self, facts: Facts) -> tuple[Program, dict[str, Uses]]:
        """Return the program where these facts hold, and what its functions use.

        A function that the same of these facts concern is the same object in all programs.
        """
        modules = []
        uses: dict[str, Uses] = {}
        for m in self.program.modules:
            functions = {name: self._function(f, facts) for name, f in m.functions.items()}
            modules.append(replace(m, functions=functions))
            uses.update((f.name, self.made_uses[id(f)]) for f in functions.values())
        return Program(tuple(modules)), uses

    def opened(self, f: Function) -> Function:
        """Return a function that was made, with its body."""
        if id(f) not in self._unread:
            return f
        if id(f) not in self._opened:
            self._opened[id(f)] = self._made_of(*self._unread[id(f)])
        return self._opened[id(f)]

    def _function(self, f: Function, facts: Facts) -> Function:
        fields = sorted(self.uses[f.name].fields & facts.keys())
        mine = {place: facts[place] for place in fields}
        key = f.name, tuple(mine.items())
        made = self.made.get(key)
        if made is None:
            known = self._known.get(key)
            made = replace(f) if known is not None else self._made_of(f, mine)
            if known is not None and f.body is not None:
                self._unread[id(made)] = f, mine
            self.made[key] = made
            self.made_uses[id(made)] = function_uses(made) if known is None else known
        return made

    def _made_of(self, f: Function, facts: Facts) -> Function:
        if self._bodies is not None and f.body is not None:
            f = replace(f, body=self._bodies[f.name])
        return _Specialiser(facts, self._constants, self.effects).function(f) if facts else f


class _Specialiser:
    def __init__(self, facts: Facts, constants: Mapping[str, int], effects: Effects) -> None:
        self.facts = facts
        self.constants = constants
        self.effects = effects

    def function(self, f: Function) -> Function:
        if f.body is None:
            return f
        body = self.block(f.body)
        while True:
            read = _read(body)
            fewer = self.without_stores(body, read)
            if fewer == body:
                return replace(f, body=body)
            body = fewer

    # what is known

    def number(self, e: Expr) -> int | None:
        """Return the value of a whole number, if it is known."""
        match e:
            case Value(value=int() as value) if not isinstance(value, bool):
                return value
            case Global(name):
                return self.constants.get(name)
            case Field(base, name):
                return self.facts.get((base.type.record, name))
            case Unary(op="-", arg=arg):
                known = self.number(arg)
                return None if known is None else -known
        return None

    def condition(self, e: Expr) -> Expr:
        """Return a condition without the parts that are known; a `Value` if it is known."""
        match e:
            case Unary(op="not", arg=arg):
                inner = self.condition(arg)
                if isinstance(inner, Value):
                    return Value(not inner.value, BOOL)
                return replace(e, arg=inner)
            case Binary(op=op, left=left, right=right) if op in _COMPARED:
                a, b = self.number(left), self.number(right)
                if a is not None and b is not None:
                    return Value(bool(_COMPARED[op](a, b)), BOOL)
            case Binary(op="and" | "or" as op, left=left, right=right):
                decides = op == "or"
                first, second = self.condition(left), self.condition(right)
                if isinstance(first, Value):
                    return first if first.value is decides else second
                if isinstance(second, Value):
                    if second.value is not decides:
                        return first
                    if not self.effects.of(first):
                        return second
                return Binary(op, first, second, BOOL)
        return e

    def expression(self, e: Expr) -> Expr:
        """Return an expression without choices that are known."""
        match e:
            case Choice(cond, then, orelse):
                known = self.condition(cond)
                a, b = self.expression(then), self.expression(orelse)
                if isinstance(known, Value):
                    return a if known.value else b
                return Choice(known, a, b, e.type)
            case Binary():
                if e.type == BOOL:
                    return self.condition(e)
                return replace(e, left=self.expression(e.left), right=self.expression(e.right))
            case Call() | Word():
                return replace(e, args=tuple(self.expression(a) for a in e.args))
        return e

    # statements

    def block(self, block: Block) -> Block:
        found: list[Statement] = []
        for s in block.statements:
            found += self.statement(s)
            if found and _ends(found[-1]):
                break
        return Block(tuple(found), block.below)

    def statement(self, s: Statement) -> list[Statement]:
        match s:
            case If():
                return self.branches(s)
            case While(cond, body):
                known = self.condition(cond)
                if isinstance(known, Value) and known.value is False:
                    return []
                return [replace(s, cond=known, body=self.block(body))]
            case For(start=start, stop=stop, step=step):
                a, b = self.number(start), self.number(stop)
                if a is not None and b is not None and (b - a) * step <= 0:
                    return []
                return [replace(s, body=self.block(s.body))]
            case Assign() | Augment():
                return [replace(s, value=self.expression(s.value))]
            case Return(value) if value is not None:
                return [replace(s, value=self.expression(value))]
        return [s]

    def branches(self, s: If) -> list[Statement]:
        kept: list[tuple[Expr, Block]] = []
        notes = []
        orelse = s.orelse
        last = s.branch_notes[-1:] if s.orelse is not None else ()
        for k, (cond, body) in enumerate(s.branches):
            known = self.condition(cond)
            if isinstance(known, Value) and known.value is False:
                continue
            if isinstance(known, Value):
                orelse = body
                last = (s.notes if k == 0 else s.branch_notes[k - 1],)
                break
            kept.append((known, self.block(body)))
            notes.append(s.notes if k == 0 else s.branch_notes[k - 1])
        rest = None if orelse is None else self.block(orelse)
        if not kept:
            return [] if rest is None else self.inline(rest, s)
        if rest is not None and not rest.statements:
            rest, last = None, ()
        first = replace(notes[0], above=s.notes.above, gap=s.notes.gap)
        return [If(tuple(kept), rest, first, (*notes[1:], *last))]

    def inline(self, block: Block, s: If) -> list[Statement]:
        """Return the statements of a branch that is always taken."""
        if not block.statements:
            return []
        first = block.statements[0]
        notes = replace(first.notes, above=(*s.notes.above, *first.notes.above), gap=s.notes.gap)
        return [replace(first, notes=notes), *block.statements[1:]]

    def without_stores(self, block: Block, read: frozenset[str]) -> Block:
        """Return a block without variables that nothing reads; calls that change something stay."""
        found: list[Statement] = []
        for s in block.statements:
            own = s.target if isinstance(s, Assign | Augment) else None
            unread = isinstance(own, Local) and own.name not in read
            if unread and isinstance(s, Assign | Augment):
                changes = bool(self.effects.of(s.value))
                if not changes:
                    continue
                if isinstance(s.value, Call):
                    found.append(Do(s.value, s.notes))
                    continue
            found.append(self.inner(s, read))
        return Block(tuple(found), block.below)

    def inner(self, s: Statement, read: frozenset[str]) -> Statement:
        match s:
            case If():
                branches = tuple((c, self.without_stores(b, read)) for c, b in s.branches)
                rest = None if s.orelse is None else self.without_stores(s.orelse, read)
                return replace(s, branches=branches, orelse=rest)
            case While() | For():
                return replace(s, body=self.without_stores(s.body, read))
        return s


def _ends(s: Statement) -> bool:
    """Whether nothing behind a statement is reached."""
    match s:
        case Return():
            return True
        case Jump(word):
            return word != "pass"
        case If():
            ends = [bool(b.statements) and _ends(b.statements[-1]) for b in blocks(s)]
            return s.orelse is not None and all(ends)
    return False


def _read(body: Block) -> frozenset[str]:
    """Return the variables that are read, not only given values."""
    found: set[str] = set()
    for s in statements(body):
        own = s.target if isinstance(s, Assign | Augment) else None
        names = [e.name for e in of_statement(s) if isinstance(e, Local)]
        if isinstance(own, Local):
            names.remove(own.name)
        found.update(names)
    return frozenset(found)


def deciding(program: Program) -> frozenset[tuple[str, str]]:
    """Return the fields, by record and name, that stand in conditions or bounds of loops."""
    found: set[tuple[str, str]] = set()
    for f in program.functions.values():
        for s in statements(f.body) if f.body is not None else ():
            for e in of_statement(s):
                match e:
                    case Choice(cond):
                        asked: tuple[Expr, ...] = (cond,)
                    case Binary() if e.type == BOOL:
                        asked = (e.left, e.right)
                    case _:
                        asked = (s.start, s.stop) if isinstance(s, For) else ()
                found.update((a.base.type.record, a.name) for a in asked if isinstance(a, Field))
    return frozenset(found)
