"""Tables of arguments: what functions that turn in next to no time read in laws and sources.

Such a function does something where its argument is largest or smallest and nothing elsewhere: a
step looks there (`engine.methods.implicit.hidden_peaks`). Of a law those that are one effort or
flow are not among them, as its slopes say that it reads it, and what time alone does is foreseen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.tables.beforehand import Beforehand
from hybond.engine.tables.courses import PLANT, TURNING
from hybond.model.expressions import Binary, Call, Expr, Number, names, uses_pre
from hybond.model.expressions.tree import walk

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hybond.engine.tables.columns import ModelTables

STEEP = 4.0
"""A power from which on something is next to nothing but close to where its base is largest."""


def put_arguments(t: ModelTables) -> None:
    """Put the arguments there, each once."""
    before = Beforehand(t)
    found: dict[Expr, None] = {}
    for column, of_law in (("source_value", False), ("dynamic_value", True)):
        for number in t.ints[column]:
            for e in _arguments(t.values.all[number]) if number >= 0 else ():
                if _moves(before, e, of_law):
                    found[e] = None
    t.ints["argument_value"] = [t.values.number(e) for e in found]
    t.numbers["arguments"] = len(found)


def _arguments(e: Expr) -> Iterator[Expr]:
    for part, prior in walk(e):
        if prior:
            continue
        match part:
            case Call(function, (argument, *_)) if function in TURNING:
                yield argument
            case Binary(op="^", left=base, right=Number(power)) if abs(power) >= STEEP:
                yield base


def _moves(before: Beforehand, e: Expr, of_law: bool) -> bool:
    """Whether the plant moves an argument in a way that slopes of its law do not tell of."""
    moved = [n for n in names(e) if n.startswith(PLANT) or n == "time" or n[:2] in ("s:", "u:")]
    if uses_pre(e) or before.covers(e) or not moved:
        return False
    alone = len(moved) == 1 and moved[0].startswith(("e:", "f:"))
    return not (of_law and alone)
