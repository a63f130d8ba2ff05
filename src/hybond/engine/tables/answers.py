"""The tables of a model with answers in Python: what printed programs have as functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hybond.engine.expressions import pairs
from hybond.engine.model import Model
from hybond.engine.tables.code import ONE, TWO
from hybond.engine.tables.columns import ModelTables
from hybond.model.expressions import (
    And,
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    Table,
    compile_expression,
)
from hybond.model.expressions.algebra import FLOATS

BINARY = {
    "+": pairs.add,
    "-": pairs.subtract,
    "*": pairs.multiply,
    "/": pairs.divide,
    "^": pairs.raise_to,
}
COMPARE = {
    "<": pairs.less,
    "<=": pairs.less_or_equal,
    ">": pairs.greater,
    ">=": pairs.greater_or_equal,
    "==": pairs.equal,
    "!=": pairs.unequal,
}


class Answers:
    """What a model answers, by closures and walks over its expressions."""

    def __init__(self, tables: ModelTables) -> None:
        self.tables = tables
        self.index = tables.slots.index
        self.size = tables.slots.size
        self.machines, self.states = tables.machines, tables.states
        self.stored, self.outputs = tables.stored, tables.outputs
        self.nodes, self.bonds, self.rules = tables.nodes, tables.bonds, tables.rules
        self.values: list[Callable[[Sequence[float]], float]] = [
            compile_expression(e, self.index, pre_offset=self.size) for e in tables.values.all
        ]

    def pair(self, k: int, s: pairs.Stack) -> None:
        """Leave pair k on top of the stack."""
        self._walk(self.tables.pairs[k], s, prior=False)

    def _walk(self, e: Expr, s: pairs.Stack, *, prior: bool) -> None:
        match e:
            case Number(value) | Bool(value):
                pairs.push_number(s, float(value))
            case Name(path):
                (pairs.push_prior if prior else pairs.push_signal)(s, self.index[path])
            case Pre(arg):
                self._walk(arg, s, prior=True)
            case Neg(arg):
                self._walk(arg, s, prior=prior)
                pairs.negate(s)
            case Not(arg):
                self._walk(arg, s, prior=prior)
                pairs.deny(s)
            case Binary(op, left, right):
                self._walk(left, s, prior=prior)
                self._walk(right, s, prior=prior)
                BINARY[op](s)
            case Compare(op, left, right):
                self._walk(left, s, prior=prior)
                self._walk(right, s, prior=prior)
                COMPARE[op](s)
            case And(args) | Or(args):
                self._decide(args, s, prior=prior, every=isinstance(e, And))
            case If(cond, then, orelse):
                self._walk(cond, s, prior=prior)
                self._walk(then if pairs.pop_truth(s) else orelse, s, prior=prior)
            case Table(arg, x, y, extrapolate, slope):
                self._walk(arg, s, prior=prior)
                read = (FLOATS.slope if slope else FLOATS.table)(x, y, extrapolate)
                pairs.put_read(s, float(read(s.finite[s.top])), float(read(s.before[s.top])))
            case Call(function, args):
                self._call(function, args, s, prior=prior)

    def _decide(self, args: Sequence[Expr], s: pairs.Stack, *, prior: bool, every: bool) -> None:
        for a in args:
            self._walk(a, s, prior=prior)
            if pairs.pop_truth(s) is not every:
                pairs.push_truth(s, not every)
                return
        pairs.push_truth(s, every)

    def _call(self, function: str, args: Sequence[Expr], s: pairs.Stack, *, prior: bool) -> None:
        self._walk(args[0], s, prior=prior)
        if function in ONE:
            pairs.apply(s, ONE[function])
        elif function == "abs":
            pairs.absolute(s)
        elif function == "sign":
            pairs.put_sign(s)
        for a in args[1:]:
            self._walk(a, s, prior=prior)
            if function in TWO:
                pairs.apply_to_two(s, TWO[function])
            elif function == "hypot":
                pairs.length(s)
            elif function == "min":
                pairs.least(s)
            else:
                pairs.greatest(s)


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
