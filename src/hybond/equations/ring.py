"""The two kinds of coefficients that elimination works with: numbers, and formulas in symbols.

An algorithm written on a `Ring` makes the numeric equations of a graph of any size and the
symbolic equations of one that a person reads, by the same steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Protocol, TypeVar

from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.read import Atoms
from hybond.errors import EquationError, NumericsError
from hybond.model.expressions import (
    Expr,
    Name,
    Number,
    compile_expression,
    names,
    simplify,
    substitute,
)

LONGEST = 2000
"""Terms of a formula at which symbols are given up: nobody reads it, and the next is longer."""
CANCELLATION = 1e-12
"""A sum of numbers below this part of its terms is a cancellation, hence zero."""

T = TypeVar("T")
Row = dict[int, T]
"""Column to coefficient; what the row means (an equation, a value) is said where it is used."""


class Ring(Protocol[T]):
    """Coefficients of one kind."""

    one: T
    values: Mapping[str, float]
    """The values of the names that coefficients may have, at which pivots are judged."""
    vanished: set[str]
    """Names of coefficients that are zero at these values, and were left out for it."""

    def of(self, number: float) -> T:
        """Return a number as a coefficient."""

    def read(self, e: Expr) -> T:
        """Return a formula as a coefficient."""

    def size(self, c: T) -> float:
        """Return the magnitude of a coefficient at the model's values."""

    def there(self, c: T) -> bool:
        """Whether a coefficient of an element is not zero; remember its names if it is."""

    def cost(self, c: T) -> int:
        """Return how long a coefficient is: short pivots make short formulas."""

    @property
    def meaning(self) -> dict[str, Expr]:
        """The formulas of atoms in coefficients that are not names."""

    def known(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return the model's values, these put over them, with those of all atoms."""

    def steady(self, c: T) -> bool:
        """Whether a coefficient is the same at all times: it reads parameters only."""

    def cleared(self, row: Row[T]) -> Row[T]:
        """Return a row multiplied through by denominators that are not steady."""

    def collect(self, parts: Iterable[tuple[T, Row[T]]]) -> Row[T]:
        """Return the sum of coefficient times row, without terms that vanish."""


class Numbers:
    """Coefficients are floats.

    Parameters
    ----------
    values : mapping
        Of every name that a coefficient reads: parameters, and the state if it modulates.
    called : function
        What the model calls such a name.
    """

    one = 1.0

    def __init__(self, values: Mapping[str, float], called: Callable[[str], str] = str) -> None:
        self.values = values
        self.called = called
        self.vanished: set[str] = set()

    def of(self, number: float) -> float:
        """Return the number."""
        return float(number)

    def read(self, e: Expr) -> float:
        """Return the value of a formula.

        Raises
        ------
        NumericsError
            HB-Q101 if it reads something that has no value here.
        """
        if isinstance(e, Number):
            return e.value
        known = {n: Number(self.values[n]) for n in sorted(names(e)) if n in self.values}
        value = simplify(substitute(e, known))
        if not isinstance(value, Number):
            missing = ", ".join(sorted(self.called(n) for n in names(value)))
            if not missing:  # a choice by a comparison whose value is known
                return float(compile_expression(value, {}, pre_offset=0)([]))
            shown = substitute(e, {n: Name(self.called(n)) for n in names(e)})
            raise NumericsError(
                f"the coefficient {shown} needs a value of {missing}",
                code="HB-Q101",
                where="the equations",
                hint="give the point at which the equations are wanted, or ask for symbols",
            )
        return value.value

    @property
    def meaning(self) -> dict[str, Expr]:
        """Nothing: numbers have no atoms."""
        return {}

    def known(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return the model's values with these over them."""
        return {**self.values, **values}

    def size(self, c: float) -> float:
        """Return the magnitude."""
        return abs(c)

    def there(self, c: float) -> bool:
        """Whether it is not zero."""
        return c != 0.0

    def cost(self, c: float) -> int:
        """Return 0 for what costs nothing to divide by."""
        return 0 if c in (1.0, -1.0) else 1

    def steady(self, c: float) -> bool:
        """Numbers are."""
        return True

    def cleared(self, row: Row[float]) -> Row[float]:
        """Numbers have no denominators."""
        return row

    def collect(self, parts: Iterable[tuple[float, Row[float]]]) -> Row[float]:
        """Return the sum; what cancels to rounding is dropped."""
        total: dict[int, float] = {}
        size: dict[int, float] = {}
        for c, row in parts:
            for k, d in row.items():
                term = c * d
                if k in total:
                    total[k] += term
                    size[k] += abs(term)
                else:
                    total[k] = term
                    size[k] = abs(term)
        return {k: v for k, v in total.items() if abs(v) > CANCELLATION * size[k]}


class Symbols:
    """Coefficients are rational functions of parameters and whatever modulates.

    Parameters
    ----------
    values : mapping
        Values at which a pivot must not vanish.
    """

    def __init__(self, values: Mapping[str, float]) -> None:
        self.values = values
        self.vanished: set[str] = set()
        self.atoms = Atoms()
        self.one = Rational.of(1)
        self._seen = 0
        self._all: Mapping[str, float] = values

    def of(self, number: float) -> Rational:
        """Return a number, exactly as its shortest decimal."""
        return Rational.of(number)

    def read(self, e: Expr) -> Rational:
        """Return a formula; what is not rational in it becomes an atom."""
        return self.atoms.read(e)

    @property
    def meaning(self) -> dict[str, Expr]:
        """The formulas of atoms that are not names."""
        return self.atoms.meaning

    def known(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return the model's values, these put over them, with those of all atoms."""
        return self.atoms.values({**self.values, **values})

    def size(self, c: Rational) -> float:
        """Return the magnitude at the model's values; 1 if those are not all known."""
        if len(self.atoms.meaning) != self._seen:
            self._seen = len(self.atoms.meaning)
            self._all = self.atoms.values(self.values)
        if any(a not in self._all for a in c.atoms()):
            return 1.0
        try:
            return abs(c.evaluate(self._all))
        except OverflowError:  # a number beyond what a float can be
            return math.inf

    def there(self, c: Rational) -> bool:
        """Whether it is not zero at the model's values; remember its names if it is."""
        if self.size(c) > 0.0:
            return True
        self.vanished |= c.atoms()
        return False

    def cost(self, c: Rational) -> int:
        """Return the number of terms."""
        return c.length

    def steady(self, c: Rational) -> bool:
        """Whether all atoms are parameters, or formulas of parameters."""
        return all(self._steady(atom) for atom in c.atoms())

    def _steady(self, atom: str) -> bool:
        if atom in self.atoms.meaning:
            return all(name.startswith("p:") for name in names(self.atoms.meaning[atom]))
        return atom.startswith("p:")

    def cleared(self, row: Row[Rational]) -> Row[Rational]:
        """Return a row multiplied through by denominators that are not steady."""
        least: dict[Any, int] = {}
        for c in row.values():
            for factor, power in c.denominator.items():
                if not all(self._steady(atom) for atom in factor.atoms()):
                    least[factor] = max(least.get(factor, 0), power)
        if not least:
            return row
        common = self.one
        for factor, power in least.items():
            common = common * Rational.from_polynomial(factor) ** power
        return {k: c * common for k, c in row.items()}

    def collect(self, parts: Iterable[tuple[Rational, Row[Rational]]]) -> Row[Rational]:
        """Return the sum; zero is decided exactly."""
        total: dict[int, Any] = {}
        for c, row in parts:
            for k, d in row.items():
                term = c * d
                if k not in total:
                    total[k] = term
                    continue
                total[k] = total[k] + term
                if total[k].length > LONGEST:
                    raise EquationError(
                        f"a coefficient has over {LONGEST} terms: a large network of resistors "
                        "has no short formula",
                        code="HB-Q104",
                        where="the equations",
                        hint="ask for numbers (symbolic=False, --numbers)",
                    )
        return {k: v for k, v in total.items() if not v.is_zero}


def substituted(ring: Ring[T], row: Row[T], values: Mapping[int, Row[T]]) -> Row[T]:
    """Return a row with columns replaced by their values, which are rows."""
    parts = [(c, values[k]) for k, c in row.items() if k in values]
    if not parts:
        return row
    rest = {k: c for k, c in row.items() if k not in values}
    return ring.collect([(ring.one, rest), *parts])
