"""Where printed C has its memory from: which functions are given an arena, and which find one.

Memory belongs to an arena, one of each engine, so that any number of engines live in a process.
All that a program makes knows its arena, so a function that has a record at hand asks that. Only
functions that make the first records have none: they are given the arena.
"""

from __future__ import annotations

from hybond.translate.modules import Program
from hybond.translate.tree import Call, Function, Word
from hybond.translate.walks import every

TAKING = frozenset(("floats", "ints", "record", "records"))
"""Words that take memory."""


def at_hand(f: Function, program: Program) -> str:
    """Return the first parameter that is a record of the arena, or an empty text.

    It is there, not None: no parameter of a portable function may be None.
    """
    for name, t in f.signature.parameters:
        record = program.records.get(t.record)
        if t.kind == "record" and record is not None and not record.given:
            return name
    return ""


def makers(program: Program) -> frozenset[str]:
    """Return the functions that take memory, or call one that does, with no record at hand."""
    found: set[str] = set()
    calls: dict[str, set[str]] = {}
    for f in program.functions.values():
        if f.body is None or at_hand(f, program):
            continue
        used = list(every(f.body))
        calls[f.name] = {e.function for e in used if isinstance(e, Call)}
        if any(isinstance(e, Word) and e.word in TAKING for e in used):
            found.add(f.name)
    while True:
        more = {name for name, called in calls.items() if called & found} - found
        if not more:
            return frozenset(found)
        found |= more
