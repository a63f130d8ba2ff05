"""What of a program is needed to call some of its functions."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from hybond.translate.modules import Program
from hybond.translate.tree import Call, Field, Function, Global, Type, Word
from hybond.translate.walks import every


@dataclass(frozen=True, slots=True)
class Reached:
    """Names of what is needed."""

    functions: frozenset[str]
    constants: frozenset[str]
    records: frozenset[str]
    words: frozenset[str]
    """Words and functions of `math`, conversions too."""
    fields: frozenset[tuple[str, str]]
    """Record and name of each field that is read or written."""


@dataclass(frozen=True, slots=True)
class Uses:
    """What one function uses: calls in the order in which they stand there."""

    calls: tuple[str, ...]
    constants: frozenset[str]
    types: frozenset[Type]
    words: frozenset[str]
    fields: frozenset[tuple[str, str]]


def uses_of(program: Program) -> dict[str, Uses]:
    """Return what each function uses."""
    return {f.name: function_uses(f) for f in program.functions.values()}


def function_uses(f: Function) -> Uses:
    """Return what one function uses."""
    calls: dict[str, None] = {}
    constants: set[str] = set()
    types = {f.signature.result, *(t for _, t in f.signature.parameters)}
    words: set[str] = set()
    fields: set[tuple[str, str]] = set()
    for e in every(f.body) if f.body is not None else ():
        types.add(e.type)
        match e:
            case Call(function):
                calls[function] = None
            case Global(named):
                constants.add(named)
            case Field(base, member):
                fields.add((base.type.record, member))
            case Word(word, _, t):
                words.add(_word(word, t))
    named_types = frozenset(t for t in types if t.record)
    return Uses(
        tuple(calls), frozenset(constants), named_types, frozenset(words), frozenset(fields)
    )


def reached(program: Program, roots: Iterable[str], uses: Mapping[str, Uses]) -> Reached:
    """Return what calls of `roots` need."""
    done: dict[str, Uses] = {}
    waiting = list(roots)
    while waiting:
        name = waiting.pop()
        if name not in done:
            done[name] = uses[name]
            waiting.extend(uses[name].calls)
    found = done.values()
    types = frozenset[Type]().union(*(u.types for u in found))
    fields = frozenset[tuple[str, str]]().union(*(u.fields for u in found))
    return Reached(
        frozenset(done),
        frozenset[str]().union(*(u.constants for u in found)),
        frozenset(_records(program, types, fields)),
        frozenset[str]().union(*(u.words for u in found)),
        fields,
    )


def _records(
    program: Program, types: Iterable[Type], fields: Collection[tuple[str, str]]
) -> set[str]:
    """Return the records of some types, and those that their fields lead to."""
    found: set[str] = set()
    waiting = [t.record for t in types if t.record]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            for member in program.records[name].members:
                if member.type.record and (name, member.name) in fields:
                    waiting.append(member.type.record)
    return found


def _word(word: str, t: Type) -> str:
    """Return a word; of those that have two forms, also of which type it is."""
    return f"{word} {t}" if word in ("min", "max", "abs") else word
