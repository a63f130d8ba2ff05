"""Which signals of a model may rest on a level, all digits of it: those that no bond is solved for.

Sources, what computes with them, and truths are what they are written as. What is a sum of voltages
and currents has their rounding, and is on either side of a level where it slides along it.
"""

from __future__ import annotations

from hybond.model.builder import Model
from hybond.model.expressions import Expr, Name, parse
from hybond.model.expressions.tree import walk
from hybond.model.parts import Part

DEEPEST = 16
"""Signals that read one another."""


def has_levels(e: Expr, model: Model, deep: int = 0) -> bool:
    """Whether an expression reads sources, time, parameters and states of machines alone."""
    return all(_is_given(x.path, model, deep) for x, _ in walk(e) if isinstance(x, Name))


def _is_given(path: str, model: Model, deep: int) -> bool:
    owner, _, variable = path.rpartition(".")
    if variable == "state" or path == "time":
        return True
    if not owner:
        law = model.signals.get(path)
        return law is None or (deep < DEEPEST and has_levels(parse(str(law)), model, deep + 1))
    part = model.elements.get(owner)
    if not isinstance(part, Part) or (part.kind, variable) not in (("Se", "e"), ("Sf", "f")):
        return False
    value = part.value
    if value is None or deep >= DEEPEST:
        return False
    return not isinstance(value, str) or has_levels(parse(value), model, deep + 1)
