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
    used = _Used()
    used.note(function.body)
    parameters = {name for name, _ in function.signature.parameters}
    types: dict[str, Type] = {}
    for e, loops in _locals(function.body, frozenset()):
        if e.name not in loops and e.name not in parameters:
            types.setdefault(e.name, e.type)
    for name, type_ in types.items():
        first = _assigned_first(function.body, name, used)
        if first is not None:
            found.first.update(id(s) for s in first)
            continue
        s = _innermost(function.body, name, used)
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


@dataclass(frozen=True, slots=True)
class _Used:
    """Names of variables, by the identity of what uses them; not of loops inside their loop."""

    itself: dict[int, set[str]] = field(default_factory=dict)
    """Of statements, blocks inside them left out."""
    within: dict[int, set[str]] = field(default_factory=dict)
    """Of blocks."""

    def note(self, block: Block) -> set[str]:
        """Note what a block and all that is in it use; return the names."""
        names: set[str] = set()
        for s in block.statements:
            own = {e.name for e in of_statement(s) if isinstance(e, Local)}
            below = [self.note(b) for b in blocks(s)]
            if isinstance(s, For):
                for found in (own, *below):
                    found.discard(s.name)
            self.itself[id(s)] = own
            names.update(own, *below)
        self.within[id(block)] = names
        return names

    def users(self, block: Block, name: str) -> list[tuple[Statement, bool, list[Block]]]:
        """Return who uses a variable: the statement, whether itself, and which of its blocks."""
        found = []
        for s in block.statements:
            own = name in self.itself[id(s)]
            inner = [b for b in blocks(s) if name in self.within[id(b)]]
            if own or inner:
                found.append((s, own, inner))
        return found


def _assigned_first(block: Block, name: str, variables: _Used) -> list[Statement] | None:
    """Return the assignments that can declare a variable: one for each block that uses it.

    None if there is a use that they would not reach.
    """
    used = variables.users(block, name)
    first = used[0][0]
    if isinstance(first, Assign) and isinstance(first.target, Local) and first.target.name == name:
        return [first]
    if any(own for _, own, _ in used):
        return None
    found: list[Statement] = []
    for _, _, inner in used:
        for b in inner:
            below = _assigned_first(b, name, variables)
            if below is None:
                return None
            found += below
    return found


def _innermost(block: Block, name: str, variables: _Used) -> Statement:
    """Return the first statement with a use in the innermost block that has all uses."""
    used = variables.users(block, name)
    s, own, inner = used[0]
    if len(used) == 1 and not own and len(inner) == 1:
        return _innermost(inner[0], name, variables)
    return s
