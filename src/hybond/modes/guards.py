"""Guards, compiled once: their truth at an instant, and what a locator follows over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables.guards import magnitude, seen_in_motion
from hybond.errors import ModelError
from hybond.model.expressions import Expr, compile_expression
from hybond.model.graph import Rule
from hybond.modes.dirac import DIRAC, Pairs
from hybond.programs.program import Program

Vector = NDArray[np.float64]
Scalar = Callable[[Sequence[float]], float]
Columns = Callable[[Sequence[Vector]], Vector]
Guard = Callable[[Pairs], object]


class Followed(Protocol):
    """A guard as a function of the signals while time passes, over floats and over arrays.

    `atoms` are the differences of its comparisons, `arrays` the same at many instants; `sizes` what
    the magnitudes of their two sides add up to.
    """

    @property
    def rule(self) -> Rule: ...  # noqa: D102

    @property
    def test(self) -> Scalar: ...  # noqa: D102

    @property
    def atoms(self) -> tuple[Scalar, ...]: ...  # noqa: D102

    @property
    def arrays(self) -> tuple[Columns, ...]: ...  # noqa: D102

    @property
    def array_test(self) -> Columns: ...  # noqa: D102

    @property
    def sizes(self) -> tuple[Columns, ...]: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class Given:
    """A guard that is followed by functions that are there."""

    rule: Rule
    test: Scalar
    atoms: tuple[Scalar, ...]
    arrays: tuple[Columns, ...]
    array_test: Columns
    sizes: tuple[Columns, ...]


class Compiled:
    """The guard of a rule, its forms made when they are asked for: a run in the kernel needs none.

    Parameters
    ----------
    program : Program
    rule : Rule
    """

    def __init__(self, program: Program, rule: Rule) -> None:
        self.program = program
        self.rule = rule

    @cached_property
    def _seen(self) -> tuple[Expr, list[Expr]]:
        return seen_in_motion(self.rule)

    @cached_property
    def test(self) -> Scalar:
        """Whether it holds."""
        return self.program.compile(self._seen[0])

    @cached_property
    def array_test(self) -> Columns:
        """Whether it holds, at many instants."""
        return self.program.compile_arrays(self._seen[0])

    @cached_property
    def atoms(self) -> tuple[Scalar, ...]:
        """The differences of its comparisons."""
        return tuple(self.program.compile(d) for d in self._seen[1])

    @cached_property
    def arrays(self) -> tuple[Columns, ...]:
        """The same at many instants."""
        return tuple(self.program.compile_arrays(d) for d in self._seen[1])

    @cached_property
    def sizes(self) -> tuple[Columns, ...]:
        """What the magnitudes of the two sides of each comparison add up to."""
        return tuple(self.program.compile_arrays(magnitude(d)) for d in self._seen[1])


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
            found = self._followed[id(rule)] = Compiled(self.program, rule)
        return found
