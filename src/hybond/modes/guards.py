"""Guards, compiled once: their truth for given signals."""

from __future__ import annotations

from collections.abc import Callable

from hybond.errors import ModelError
from hybond.model.expressions import compile_expression
from hybond.model.graph import Rule
from hybond.modes.dirac import DIRAC, Pairs
from hybond.programs.program import Program

Guard = Callable[[Pairs], object]


class Guards:
    """The guards of one program."""

    def __init__(self, program: Program) -> None:
        self._slots = program.slots
        self._compiled: dict[Rule, Guard] = {}

    def holds(self, rule: Rule, pairs: Pairs, where: str = "") -> bool:
        """Return the truth of a guard, with the place added to a refusal."""
        found = self._compiled.get(rule)
        if found is None:
            slots = self._slots
            found = compile_expression(rule.guard, slots.index, DIRAC, pre_offset=slots.size)
            self._compiled[rule] = found
        try:
            return bool(found(pairs))
        except ModelError as error:
            error.where = where or rule.text
            error.why = f"{error.why} (in the guard {rule.text!r})"
            raise
