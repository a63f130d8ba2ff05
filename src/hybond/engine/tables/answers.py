"""The tables of a model with answers in Python: what printed programs have as functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hybond.engine.expressions.code import run_pair_code
from hybond.engine.expressions.pairs import Stack
from hybond.engine.model import Model
from hybond.engine.tables.code import Code
from hybond.engine.tables.columns import ModelTables
from hybond.model.expressions import compile_expression


class Answers:
    """What a model answers, by closures, and of pairs by the instructions of the library."""

    def __init__(self, tables: ModelTables) -> None:
        index, size = tables.slots.index, tables.slots.size
        self.machines, self.states = tables.machines, tables.states
        self.stored, self.outputs = tables.stored, tables.outputs
        self.nodes, self.bonds, self.rules = tables.nodes, tables.bonds, tables.rules
        self.values: list[Callable[[Sequence[float]], float]] = [
            compile_expression(e, index, pre_offset=size) for e in tables.values.all
        ]
        self._code = Code(index, size)
        self._begins = [self._code.add(e, paired=True) for e in tables.pairs]

    def pair(self, k: int, s: Stack) -> None:
        """Leave pair k on top of the stack."""
        run_pair_code(self._code.instructions, self._begins[k], self._code.numbers, s)


def answered(tables: ModelTables) -> Model:
    """Return a model that the runtime can be run with in Python."""
    m = Model()
    for name, number in tables.numbers.items():
        setattr(m, name, number)
    for name, whole in tables.ints.items():
        setattr(m, name, list(whole))
    for name, numbers in tables.floats.items():
        setattr(m, name, list(numbers))
    m.answers = Answers(tables)
    missing = [n for n, v in vars(m).items() if v is None]
    assert not missing, missing
    return m
