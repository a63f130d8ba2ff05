"""What of a program is needed to call some of its functions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from hybond.export.translate.modules import Program
from hybond.export.translate.tree import Call, Field, Global, Type
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
    records: set[str] = set()
    words: set[str] = set()
    fields: set[tuple[str, str]] = set()

    def take(t: Type) -> None:
        if t.record:
            records.add(t.record)

    waiting = list(roots)
    while waiting:
        name = waiting.pop()
        if name in done:
            continue
        done.add(name)
        f = functions[name]
        take(f.signature.result)
        for _, t in f.signature.parameters:
            take(t)
        if f.body is None:
            continue
        for e in every(f.body):
            take(e.type)
            match e:
                case Call(function):
                    waiting.append(function)
                case Global(named):
                    constants.add(named)
                case Field(base, member):
                    fields.add((base.type.record, member))
                case _ if hasattr(e, "word"):
                    words.add(_word(e.word, e.type))
    return Reached(
        frozenset(done),
        frozenset(constants),
        frozenset(records),
        frozenset(words),
        frozenset(fields),
    )


def _word(word: str, t: Type) -> str:
    """Return a word; of those that have two forms, also of which type it is."""
    return f"{word} {t}" if word in ("min", "max", "abs") else word
