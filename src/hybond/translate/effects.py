"""What functions change: which arrays and records are only read, and what order matters.

C leaves open in which order the parts of an expression are evaluated, and wants to know what a
function does not change. Both follow from what is assigned, through all calls.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from hybond.translate.errors import PortableError
from hybond.translate.memory import makers
from hybond.translate.modules import Program
from hybond.translate.tree import (
    Assign,
    Augment,
    Binary,
    Block,
    Call,
    Choice,
    Element,
    Expr,
    Field,
    Function,
    Local,
    Return,
    Statement,
    Word,
)
from hybond.translate.walks import expressions, of_statement, parts, statements, within

Holder = tuple[str, str, str]
"""What keeps a reference: ("local", function, name), ("field", record, name), ("result", f, "")."""


@dataclass
class Effects:
    """What is known of a program."""

    written: set[Holder] = field(default_factory=set)
    """References through which something is changed."""
    changes: dict[str, frozenset[str]] = field(default_factory=dict)
    """Of each function: the fields, ``Mode.stored``, and the kinds of arrays, ``Floats``, that a
    call of it may change; ``put`` if it writes text."""
    makers: frozenset[str] = frozenset()
    """Functions that are given the arena that they take memory from; see `memory`."""

    def of(self, e: Expr) -> frozenset[str]:
        """Return what the evaluation of an expression changes."""
        found: frozenset[str] = frozenset()
        for part in within(e):
            if isinstance(part, Call):
                found |= self.changes[part.function]
            elif isinstance(part, Word) and part.word.startswith("put_"):
                found |= {"put"}
        return found

    def of_block(self, block: Block) -> frozenset[str]:
        """Return what a block changes."""
        found: frozenset[str] = frozenset()
        for s in statements(block):
            found |= _assigned(s)
            for e in expressions(s):
                found |= self.of(e)
        return found


def effects_of(program: Program, roots: Iterable[str] = ()) -> Effects:
    """Return what the functions of a program change.

    Parameters
    ----------
    roots : iterable of str
        Functions that are called from outside, where their results may be changed.

    Raises
    ------
    PortableError
        HB-E601 where the order of evaluation would matter, or a table of the model is changed.
    """
    found = Effects(makers=makers(program))
    found.written.update(("result", name, "") for name in roots)
    _close_changes(found, program)
    _close_written(found, program)
    for record in program.records.values():
        for member in record.members:
            if record.given and ("field", record.name, member.name) in found.written:
                raise PortableError(
                    f"{record.name}.{member.name} is given by the model, and changed",
                    place=record.place,
                )
    for f in program.functions.values():
        if f.body is not None:
            for s in statements(f.body):
                _check_order(s, f, found)
    return found


def _assigned(s: Statement) -> frozenset[str]:
    if isinstance(s, Assign | Augment):
        match s.target:
            case Field(base, name):
                return frozenset([f"{base.type.record}.{name}"])
            case Element(base):
                return frozenset([str(base.type)])
    return frozenset()


def _close_changes(found: Effects, program: Program) -> None:
    functions = program.functions
    calls: dict[str, set[str]] = {}
    for f in functions.values():
        own: set[str] = set()
        calls[f.name] = set()
        if f.body is None:
            for _, t in f.signature.parameters:
                record = program.records.get(t.record)
                if t.kind == "record" and record is not None and not record.given:
                    own |= {f"{t.record}.{m.name}" for m in record.members}
                    own |= {str(m.type) for m in record.members if m.type.is_array}
        else:
            for s in statements(f.body):
                own |= _assigned(s)
                for e in of_statement(s):
                    if isinstance(e, Call):
                        calls[f.name].add(e.function)
                    elif isinstance(e, Word) and e.word.startswith("put_"):
                        own.add("put")
        found.changes[f.name] = frozenset(own)
    again = True
    while again:
        again = False
        for name, called in calls.items():
            total = found.changes[name].union(*(found.changes[c] for c in called))
            again = again or total != found.changes[name]
            found.changes[name] = total


def _sources(e: Expr, f: str) -> list[Holder]:
    """Return what keeps the thing that a reference means, or something that it is part of."""
    match e:
        case Local(name):
            return [("local", f, name)]
        case Field(base, name):
            return [("field", base.type.record, name), *_sources(base, f)]
        case Element(base):
            return _sources(base, f)
        case Choice(_, then, orelse):
            return [*_sources(then, f), *_sources(orelse, f)]
        case Call(function):
            return [("result", function, "")]
    return []


def _close_written(found: Effects, program: Program) -> None:
    """Find the references through which something is changed.

    If a reference comes from another, what is changed through it is changed through the other too.
    """
    origin: dict[Holder, set[Holder]] = {}

    def comes(to: Holder, source: Iterable[Holder]) -> None:
        origin.setdefault(to, set()).update(source)

    functions = program.functions
    for f in functions.values():
        if f.body is None:
            for name, t in f.signature.parameters:
                record = program.records.get(t.record)
                if t.kind == "record" and record is not None and not record.given:
                    found.written.add(("local", f.name, name))
            continue
        for s in statements(f.body):
            match s:
                case Assign(target, value) if value.type.is_reference:
                    match target:
                        case Local(name):
                            comes(("local", f.name, name), _sources(value, f.name))
                        case Field(base, name):
                            comes(("field", base.type.record, name), _sources(value, f.name))
                            found.written.update(_sources(base, f.name))
                        case Element(base):
                            found.written.update(_sources(value, f.name))
                            found.written.update(_sources(base, f.name))
                case Assign(target) | Augment(target=target):
                    if isinstance(target, Field | Element):
                        found.written.update(_sources(target.base, f.name))
                case Return(value) if value is not None and value.type.is_reference:
                    comes(("result", f.name, ""), _sources(value, f.name))
            for e in of_statement(s):
                if isinstance(e, Call):
                    names = functions[e.function].signature.parameters
                    for arg, (name, t) in zip(e.args, names):
                        if t.is_reference:
                            comes(("local", e.function, name), _sources(arg, f.name))
    waiting = list(found.written)
    while waiting:
        for other in origin.get(waiting.pop(), ()):
            if other not in found.written:
                found.written.add(other)
                waiting.append(other)


def reads(e: Expr) -> frozenset[str]:
    """Return the fields and kinds of arrays that an expression reads itself, not by calls."""
    found = set()
    for part in within(e):
        match part:
            case Field(base, name):
                found.add(f"{base.type.record}.{name}")
            case Element(base):
                found.add(str(base.type))
    return frozenset(found)


def _check_order(s: Statement, f: Function, effects: Effects) -> None:
    changing = [e for e in expressions(s) if effects.of(e)]
    for e in changing:
        _check_parts(e, s, f, effects)
    if changing and isinstance(s, Assign | Augment) and isinstance(s.target, Field | Element):
        target = s.target
        seen = frozenset().union(*(reads(p) for p in parts(target)))
        if isinstance(s, Augment):
            seen = reads(target)
        changed = effects.of(s.value) & seen
        if changed or effects.of(target):
            raise _out_of_order(s, f, changed)


def _check_parts(e: Expr, s: Statement, f: Function, effects: Effects) -> None:
    """Look at an expression that changes something."""
    below = parts(e)
    changes = [effects.of(part) for part in below]
    sequenced = isinstance(e, Choice) or (isinstance(e, Binary) and e.op in ("and", "or"))
    if not sequenced and len(below) > 1:
        for i, changed in enumerate(changes):
            for j, other in enumerate(below):
                clash = changed & (reads(other) | changes[j]) if changed and i != j else None
                if clash:
                    raise _out_of_order(s, f, clash)
    for part, changed in zip(below, changes):
        if changed:
            _check_parts(part, s, f, effects)


def _out_of_order(s: Statement, f: Function, what: Iterable[str]) -> PortableError:
    file = f.place.partition(":")[0]
    named = ", ".join(sorted(what))
    return PortableError(
        f"a call changes {named}, which this statement also reads",
        place=f"{file}:{s.notes.line}",
        hint="call it first, and keep its result in a variable",
    )
