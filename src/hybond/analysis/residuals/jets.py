"""Columns of knowns and their time derivatives, from coefficients with ``D`` in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hybond.analysis.residuals.sensor_rows import D, Known
from hybond.analysis.residuals.unit_pivots import has_rate
from hybond.equations.ring import Row
from hybond.equations.symbolic.polynomial import Polynomial
from hybond.equations.symbolic.rational import Rational


@dataclass(frozen=True, slots=True)
class Jet:
    """A known or one of its derivatives."""

    column: int
    """The column of the known."""
    order: int
    """How often it is differentiated."""


class Jets:
    """Numbers the jets that occur, lower orders and earlier columns first come, first served."""

    def __init__(self, known: Mapping[int, Known]) -> None:
        self.known = known
        self.jets: list[Jet] = []
        self._number: dict[Jet, int] = {}

    def number(self, jet: Jet) -> int:
        """Return the column of a jet."""
        if jet not in self._number:
            self._number[jet] = len(self.jets)
            self.jets.append(jet)
        return self._number[jet]

    def split(self, row: Row[Rational]) -> Row[Rational]:
        """Return a row of knowns as a row of jets; derivatives of constants are dropped."""
        found: Row[Rational] = {}
        for k, c in row.items():
            for order, part in by_order(c).items():
                if not (order and self.known[k].constant):
                    found[self.number(Jet(k, order))] = part
        return found

    def name(self, number: int) -> str:
        """Return what a jet is called: a prime per derivative."""
        jet = self.jets[number]
        return self.known[jet.column].name + "'" * jet.order


def by_order(c: Rational) -> dict[int, Rational]:
    """Return the coefficients of a polynomial in ``D``.

    Examples
    --------
    >>> R, C, D = (Rational.atom(a) for a in ("R", "C", "d/dt"))
    >>> parts = by_order((1 + R * C * D) / R)
    >>> parts[0] == 1 / R, parts[1] == C
    (True, True)
    """
    if not has_rate(c):
        return {0: c}
    below = Rational.of(1)
    for factor, power in c.denominator.items():
        below = below * Rational.from_polynomial(factor) ** power
    terms: dict[int, dict[tuple[tuple[str, int], ...], object]] = {}
    for monomial, number in c.numerator.terms.items():
        order = dict(monomial).get(D, 0)
        rest = tuple((atom, k) for atom, k in monomial if atom != D)
        terms.setdefault(order, {})[rest] = number
    return {
        order: Rational.from_polynomial(Polynomial(part)) / below  # type: ignore[arg-type]
        for order, part in sorted(terms.items())
    }
