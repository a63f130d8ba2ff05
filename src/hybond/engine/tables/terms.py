"""Comparisons, and rates of signals, that are sums of signals with constant factors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.tables.columns import FLOATS, INTS, put_rows
from hybond.engine.tables.expressions import number_of
from hybond.model.expressions import Binary, Bool, Expr, Name, Neg, Number
from hybond.model.expressions.slots import plain
from hybond.model.expressions.tree import fold
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

NO_SUM = (-1, 0.0)
"""The only term of what is no such sum."""


@dataclass(frozen=True, slots=True)
class Sum:
    """Signals with factors, and a constant beside them."""

    factors: dict[str, float]
    level: float

    def times(self, factor: float) -> Sum:
        """Return all of it with a factor."""
        return Sum({n: factor * a for n, a in self.factors.items()}, factor * self.level)

    def plus(self, other: Sum) -> Sum:
        """Return the sum of both."""
        factors = dict(self.factors)
        for name, a in other.factors.items():
            factors[name] = factors[name] + a if name in factors else a
        return Sum(factors, self.level + other.level)


def put_terms(t: ModelTables) -> None:
    """Put the terms of all comparisons into the tables, then those of rates of signals."""
    numbers = [*t.ints["atom_value"], *t.ints["integral_rate"]]
    found = [sum_of(t.values.all[k]) for k in numbers]
    index = t.slots.index
    rows = [
        [NO_SUM] if s is None else [(index[n], a) for n, a in sorted(s.factors.items())]
        for s in found
    ]
    put_rows(t, "term_first", rows, term_slot=INTS, term_factor=FLOATS)
    t.floats["atom_level"] = [0.0 if s is None else number_of(s.level) for s in found]


def sum_of(e: Expr) -> Sum | None:
    """Return an expression as a sum of signals, None if it is none.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> sum_of(parse("2*(a - b/4) - 3"))
    Sum(factors={'a': 2.0, 'b': -0.5}, level=-3.0)
    >>> sum_of(parse("a*b"))
    """

    def of(node: Expr, prior: bool, below: list[Sum | None]) -> Sum | None:
        parts = [s for s in below if s is not None]
        if prior or len(parts) < len(below):
            return None
        match node:
            case Name():
                return Sum({node.path: 1.0}, 0.0)
            case Number() | Bool():
                return Sum({}, number_of(node.value))
            case Neg():
                return parts[0].times(-1.0)
            case Binary(op="+"):
                return parts[0].plus(parts[1])
            case Binary(op="-"):
                return parts[0].plus(parts[1].times(-1.0))
            case Binary(op="*") if not parts[0].factors:
                return parts[1].times(parts[0].level)
            case Binary(op="*") if not parts[1].factors:
                return parts[0].times(parts[1].level)
            case Binary(op="/") if not parts[1].factors and plain(parts[1].level):
                return parts[0].times(1.0 / parts[1].level)
        return None

    return fold(e, of)
