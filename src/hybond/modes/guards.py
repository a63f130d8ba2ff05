"""Guards, compiled once: their truth at an instant, and what a locator follows over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import ModelError
from hybond.model.expressions import (
    Binary,
    Call,
    Compare,
    Expr,
    Neg,
    Pre,
    comparisons,
    compile_expression,
    transform,
)
from hybond.model.graph import Rule
from hybond.modes.dirac import DIRAC, Pairs
from hybond.programs.program import Program

Vector = NDArray[np.float64]
Scalar = Callable[[Sequence[float]], float]
Columns = Callable[[Sequence[Vector]], Vector]
Guard = Callable[[Pairs], object]


@dataclass(frozen=True, slots=True)
class Followed:
    """A guard as a function of the signals while time passes, over floats and over arrays.

    `atoms` are the differences of its comparisons; `sizes` what the magnitudes of their two sides
    add up to.
    """

    rule: Rule
    test: Scalar
    atoms: tuple[Scalar, ...]
    arrays: tuple[Columns, ...]
    array_test: Columns
    sizes: tuple[Columns, ...]


class Guards:
    """The guards of one program.

    Rules are told apart by identity: to hash a guard takes longer than to ask it.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self._compiled: dict[int, tuple[Rule, Guard]] = {}
        self._followed: dict[int, Followed] = {}

    def holds(self, rule: Rule, pairs: Pairs, where: str = "") -> bool:
        """Return the truth of a guard, with the place added to a refusal."""
        known = self._compiled.get(id(rule))
        if known is None:
            slots = self.program.slots
            guard = compile_expression(rule.guard, slots.index, DIRAC, pre_offset=slots.size)
            known = self._compiled[id(rule)] = rule, guard
        try:
            return bool(known[1](pairs))
        except ModelError as error:
            error.where = where or rule.text
            error.why = f"{error.why} (in the guard {rule.text!r})"
            raise

    def followed(self, rule: Rule) -> Followed:
        """Return what a locator needs of a guard; while time passes, ``pre(a)`` is ``a``."""
        found = self._followed.get(id(rule))
        if found is None:
            found = self._followed[id(rule)] = _follow(self.program, rule)
        return found


def seen_in_motion(rule: Rule) -> tuple[Expr, list[Expr]]:
    """Return a guard as it is while time passes, and the differences of its comparisons."""
    guard = transform(rule.guard, _without_pre)
    compared = [c for c in comparisons(guard) if isinstance(c, Compare)]
    return guard, [Binary("-", c.left, c.right) for c in compared]


def _follow(program: Program, rule: Rule) -> Followed:
    guard, differences = seen_in_motion(rule)
    return Followed(
        rule,
        program.compile(guard),
        tuple(program.compile(d) for d in differences),
        tuple(program.compile_arrays(d) for d in differences),
        program.compile_arrays(guard),
        tuple(program.compile_arrays(magnitude(d)) for d in differences),
    )


def magnitude(e: Expr) -> Expr:
    """Return what the magnitudes of the terms of `e` add up to."""
    match e:
        case Binary(op="+" | "-"):
            return Binary("+", magnitude(e.left), magnitude(e.right))
        case Binary(op="*"):
            return Binary("*", magnitude(e.left), magnitude(e.right))
        case Neg():
            return magnitude(e.arg)
        case _:
            return Call("abs", (e,))


def _without_pre(e: Expr) -> Expr:
    return e.arg if isinstance(e, Pre) else e
