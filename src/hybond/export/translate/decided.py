"""What the numbers of a model decide: a program without the parts that it never comes to.

The numbers of a given record (how many laws of junctions a model has, which method it is run with)
are known when a program is printed. A condition that they decide is settled then; with it goes all
that only its other side calls. What is printed is the program of one model, not of all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from hybond.export.translate.modules import Program
from hybond.export.translate.tree import (
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
    Local,
    Module,
    Return,
    Statement,
    Unary,
    Value,
    While,
    Word,
)
from hybond.export.translate.walks import expressions, statements, within

_COMPARE = {
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
}


def decided(program: Program, record: str, numbers: Mapping[str, float]) -> Program:
    """Return a program without what the numbers of a record rule out.

    Parameters
    ----------
    program : Program
    record : str
        The record that the model brings along.
    numbers : mapping
        Its whole numbers, by field.

    Examples
    --------
    >>> from hybond.export.translate.modules import load_texts
    >>> text = '''
    ... from hybond.export.portable.words import given
    ... @given
    ... class Model:
    ...     laws: int
    ... def much(m: Model) -> int:
    ...     return 7
    ... def run(m: Model) -> int:
    ...     if m.laws > 0:
    ...         return much(m)
    ...     return 1
    ... '''
    >>> small = decided(load_texts({"run": text}), "Model", {"laws": 0})
    >>> from hybond.export.translate.reach import reached
    >>> sorted(reached(small, ["run"]).functions)
    ['run']
    """
    constants = {
        name: Value(c.value, c.type)
        for name, c in program.constants.items()
        if isinstance(c.value, int | bool)
    }
    facts = _Facts(record, numbers, constants)
    return Program(tuple(_module(m, facts) for m in program.modules))


@dataclass(frozen=True, slots=True)
class _Facts:
    record: str
    numbers: Mapping[str, float]
    constants: Mapping[str, Value]

    def of(self, e: Expr) -> Value | None:
        """Return the value of an expression, if it is known."""
        match e:
            case Value():
                return e
            case Global(name):
                return self.constants.get(name)
            case Field(base, name, t) if base.type.record == self.record and t.kind == "int":
                return Value(int(self.numbers[name]), t) if name in self.numbers else None
        return None


def _module(module: Module, facts: _Facts) -> Module:
    functions = {name: _function(f, facts) for name, f in module.functions.items()}
    return replace(module, functions=functions)


def _function(f: Function, facts: _Facts) -> Function:
    if f.body is None:
        return f
    body = _block(f.body, facts)
    while (smaller := _without_unread(body)) != body:
        body = smaller
    return replace(f, body=body)


# -- statements


def _block(block: Block, facts: _Facts) -> Block:
    found: list[Statement] = []
    for s in block.statements:
        kept = _statement(s, facts)
        found += kept
        if kept and _leaves(kept[-1]):
            break
    return Block(tuple(found), block.below)


def _leaves(s: Statement) -> bool:
    """Whether nothing behind a statement is ever reached."""
    match s:
        case Return():
            return True
        case If(branches, orelse):
            blocks = [b for _, b in branches]
            if orelse is None:
                return False
            return all(b.statements and _leaves(b.statements[-1]) for b in (*blocks, orelse))
    return False


def _statement(s: Statement, facts: _Facts) -> tuple[Statement, ...]:
    match s:
        case If():
            return _if(s, facts)
        case While(cond, body):
            cond = _fold(cond, facts)
            if _is(cond, False):
                return ()
            return (replace(s, cond=cond, body=_block(body, facts)),)
        case For(_, start, stop, step):
            low, high = facts.of(start), facts.of(stop)
            if low is not None and high is not None and step > 0 and low.value >= high.value:  # type: ignore[operator]
                return ()
            return (replace(s, body=_block(s.body, facts)),)
        case Assign() | Augment():
            return (replace(s, value=_fold(s.value, facts)),)
        case Return(value) if value is not None:
            return (replace(s, value=_fold(value, facts)),)
    return (s,)


def _if(s: If, facts: _Facts) -> tuple[Statement, ...]:
    notes = (s.notes, *s.branch_notes)
    branches, kept = [], []
    orelse = s.orelse
    for k, (cond, body) in enumerate(s.branches):
        cond = _fold(cond, facts)
        if _is(cond, False):
            continue
        if _is(cond, True):
            orelse = body
            break
        branches.append((cond, _block(body, facts)))
        kept.append(notes[k] if k < len(notes) else s.notes)
    inside = None if orelse is None else _block(orelse, facts)
    if not branches:
        return () if inside is None else inside.statements
    if inside is not None and not inside.statements:
        inside = None
    below = kept[1:] if inside is None else [*kept[1:], notes[-1]]
    return (If(tuple(branches), inside, kept[0], tuple(below)),)


def _is(e: Expr, truth: bool) -> bool:
    return isinstance(e, Value) and e.value is truth


# -- expressions


def _fold(e: Expr, facts: _Facts) -> Expr:
    """Return an expression with the conditions in it decided as far as they are."""
    match e:
        case Unary("not", arg):
            inner = _fold(arg, facts)
            return (
                Value(not inner.value, BOOL) if isinstance(inner, Value) else replace(e, arg=inner)
            )
        case Binary(op, left, right) if op in _COMPARE:
            a, b = facts.of(left), facts.of(right)
            if a is not None and b is not None and a.value is not None and b.value is not None:
                return Value(bool(_COMPARE[op](a.value, b.value)), BOOL)
        case Binary("and" | "or" as op, left, right):
            return _joined(op, _fold(left, facts), _fold(right, facts), e)
        case Choice(cond, then, orelse):
            cond = _fold(cond, facts)
            if isinstance(cond, Value):
                return _fold(then if cond.value else orelse, facts)
            return replace(e, cond=cond, then=_fold(then, facts), orelse=_fold(orelse, facts))
    return e


def _joined(op: str, left: Expr, right: Expr, e: Binary) -> Expr:
    idle = op == "and"  # what such a side leaves to the other one
    for one, other, first in ((left, right, True), (right, left, False)):
        if isinstance(one, Value):
            if one.value is idle:
                return other
            if first or not _acts(other):
                return one
    return replace(e, left=left, right=right)


def _acts(e: Expr) -> bool:
    """Whether the evaluation of an expression may do more than give its value."""
    return any(isinstance(part, Call | Word) for part in within(e))


# -- locals that nobody reads any more


def _without_unread(body: Block) -> Block:
    read: set[str] = set()
    for s in statements(body):
        for e in expressions(s):
            target = s.target if isinstance(s, Assign) else None
            for part in within(e):
                if isinstance(part, Local) and part is not target:
                    read.add(part.name)
    return _only(body, read)


def _only(block: Block, read: set[str]) -> Block:
    found: list[Statement] = []
    for s in block.statements:
        match s:
            case Assign(Local(name), value) if name not in read and not _calls(value):
                continue
            case Assign(Local(name), Call() as call, notes) if name not in read:
                found.append(Do(call, notes))
                continue
            case If():
                branches = tuple((c, _only(b, read)) for c, b in s.branches)
                orelse = None if s.orelse is None else _only(s.orelse, read)
                s = replace(s, branches=branches, orelse=orelse)
            case While() | For():
                s = replace(s, body=_only(s.body, read))
        found.append(s)
    return Block(tuple(found), block.below)


def _calls(e: Expr) -> bool:
    return any(isinstance(part, Call) for part in within(e))
