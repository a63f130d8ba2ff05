"""What of a program is needed to call some of its functions."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from hybond.export.translate.modules import Program
from hybond.export.translate.tree import Call, Field, Global, Type, Word
from hybond.export.translate.walks import every


@dataclass(frozen=True, slots=True)
class Reached:
    """Names of what is needed.

    Parameters
    ----------
    functions, constants, records : frozenset of str
    words : frozenset of str
        Words and functions of `math`, conversions too.
    fields : frozenset of (str, str)
        Record and name of each field that is read or written.
    """

    functions: frozenset[str]
    constants: frozenset[str]
    records: frozenset[str]
    words: frozenset[str]
    fields: frozenset[tuple[str, str]]


def reached(program: Program, roots: Iterable[str]) -> Reached:
    """Return what calls of `roots` need."""
    functions = program.functions
    done: set[str] = set()
    constants: set[str] = set()
    types: set[Type] = set()
    words: set[str] = set()
    fields: set[tuple[str, str]] = set()
    waiting = list(roots)
    while waiting:
        name = waiting.pop()
        if name in done:
            continue
        done.add(name)
        f = functions[name]
        types.update([f.signature.result, *(t for _, t in f.signature.parameters)])
        if f.body is None:
            continue
        for e in every(f.body):
            types.add(e.type)
            match e:
                case Call(function):
                    waiting.append(function)
                case Global(named):
                    constants.add(named)
                case Field(base, member):
                    fields.add((base.type.record, member))
                case Word(word, _, t):
                    words.add(_word(word, t))
    records = _records(program, types, fields)
    return Reached(
        frozenset(done),
        frozenset(constants),
        frozenset(records),
        frozenset(words),
        frozenset(fields),
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
