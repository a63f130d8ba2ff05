"""Walks over the typed tree: expressions of a statement, statements of a block."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

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
    If,
    Return,
    Statement,
    Unary,
    While,
    Word,
)

_PARTS: dict[type, Callable[[Any], tuple[Expr, ...]]] = {
    Field: lambda e: (e.base,),
    Element: lambda e: (e.base, e.index),
    Unary: lambda e: (e.arg,),
    Binary: lambda e: (e.left, e.right),
    Choice: lambda e: (e.cond, e.then, e.orelse),
    Call: lambda e: e.args,
    Word: lambda e: e.args,
}
"""By type: most expressions have no parts, and a match would ask them for each of these first."""


def parts(e: Expr) -> tuple[Expr, ...]:
    """Return the direct subexpressions of an expression, in reading order."""
    of = _PARTS.get(type(e))
    return () if of is None else of(e)


def within(e: Expr) -> list[Expr]:
    """Return an expression and all that it is made of."""
    found: list[Expr] = []
    _add_within(e, found)
    return found


def _add_within(e: Expr, found: list[Expr]) -> None:
    found.append(e)
    of = _PARTS.get(type(e))
    if of is not None:
        for part in of(e):
            _add_within(part, found)


def expressions(s: Statement) -> tuple[Expr, ...]:
    """Return the expressions that a statement evaluates itself, blocks inside it left out."""
    match s:
        case Assign() | Augment():
            return (s.target, s.value)
        case If():
            return tuple(cond for cond, _ in s.branches)
        case While():
            return (s.cond,)
        case For():
            return (s.start, s.stop)
        case Return():
            return () if s.value is None else (s.value,)
        case Do():
            return (s.call,)
    return ()


def blocks(s: Statement) -> tuple[Block, ...]:
    """Return the blocks inside a statement."""
    match s:
        case If():
            inner = tuple(block for _, block in s.branches)
            return inner if s.orelse is None else (*inner, s.orelse)
        case While() | For():
            return (s.body,)
    return ()


def statements(block: Block) -> Iterator[Statement]:
    """Yield all statements of a block, those inside others too."""
    for s in block.statements:
        yield s
        for inner in blocks(s):
            yield from statements(inner)


def every(block: Block) -> Iterator[Expr]:
    """Yield all expressions of a block, and all that they are made of."""
    for s in statements(block):
        yield from of_statement(s)


def of_statement(s: Statement) -> list[Expr]:
    """Return the expressions of a statement, blocks inside it left out, and their parts."""
    found: list[Expr] = []
    for e in expressions(s):
        _add_within(e, found)
    return found
