"""Where the variables of a function are declared in languages whose blocks are scopes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from hybond.translate.tree import Assign, Block, For, Function, Local, Statement, Type
from hybond.translate.walks import blocks, of_statement


@dataclass(frozen=True, slots=True)
class Places:
    """Declarations, by the identity of statements of the tree."""

    first: set[int] = field(default_factory=set)
    """Assignments that declare their target."""
    before: dict[int, list[tuple[str, Type]]] = field(default_factory=dict)
    """What is declared ahead of a statement, because its first values come from inside it."""


def places(function: Function) -> Places:
    """Return where each variable is declared: as late and as deep inside as its uses allow.

    A variable that several blocks use, each of them assigning it first, is declared in each.
    """
    found = Places()
    if function.body is None:
        return found
    parameters = {name for name, _ in function.signature.parameters}
    types: dict[str, Type] = {}
    for e, loops in _locals(function.body, frozenset()):
        if e.name not in loops and e.name not in parameters:
            types.setdefault(e.name, e.type)
    for name, type_ in types.items():
        first = _assigned_first(function.body, name)
        if first is not None:
            found.first.update(id(s) for s in first)
            continue
        s = _innermost(function.body, name)
        found.before.setdefault(id(s), []).append((name, type_))
    return found


def _locals(block: Block, loops: frozenset[str]) -> Iterator[tuple[Local, frozenset[str]]]:
    for s in block.statements:
        for e in of_statement(s):
            if isinstance(e, Local):
                yield e, loops
        inner = loops | {s.name} if isinstance(s, For) else loops
        for inside in blocks(s):
            yield from _locals(inside, inner)


def _uses(s: Statement, name: str) -> tuple[bool, list[Block]]:
    """Return whether a statement itself uses a variable, and which of its blocks do."""
    if isinstance(s, For) and s.name == name:
        return False, []
    own = any(isinstance(e, Local) and e.name == name for e in of_statement(s))
    return own, [b for b in blocks(s) if _used_in(b, name)]


def _used_in(block: Block, name: str) -> bool:
    return any(own or inner for own, inner in (_uses(s, name) for s in block.statements))


def _assigned_first(block: Block, name: str) -> list[Statement] | None:
    """Return the assignments that can declare a variable: one for each block that uses it.

    None if there is a use that they would not reach.
    """
    used = [(s, *_uses(s, name)) for s in block.statements]
    used = [(s, own, inner) for s, own, inner in used if own or inner]
    first = used[0][0]
    if isinstance(first, Assign) and isinstance(first.target, Local) and first.target.name == name:
        return [first]
    if any(own for _, own, _ in used):
        return None
    found: list[Statement] = []
    for _, _, inner in used:
        for b in inner:
            below = _assigned_first(b, name)
            if below is None:
                return None
            found += below
    return found


def _innermost(block: Block, name: str) -> Statement:
    """Return the first statement with a use in the innermost block that has all uses."""
    used = [(s, *_uses(s, name)) for s in block.statements]
    used = [(s, own, inner) for s, own, inner in used if own or inner]
    s, own, inner = used[0]
    if len(used) == 1 and not own and len(inner) == 1:
        return _innermost(inner[0], name)
    return s
