"""Whether one linear differential relation follows from others: exactly, modulo a large prime.

Relations with constant coefficients are rows of polynomials in the time derivative ``D``. A
relation vanishes on all motions that the others allow if and only if it is a combination of them
with polynomial factors (J. C. Willems, *Paradigms and puzzles in the theory of dynamical
systems*, IEEE Trans. Automatic Control 36(3), 1991). Coefficients are the model's own decimals,
taken exactly, in the field of integers modulo a prime of 61 bits: no tolerance is involved, and an
accidental zero has a chance of about 1e-18 per test.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from fractions import Fraction

from hybond.equations.symbolic.rational import Rational

PRIME = 2**61 - 1
ONE = "1"
"""The column of constants; its derivative is zero."""

Column = tuple[Hashable, int]
"""What is differentiated, and how often."""
Relation = dict[Column, int]


def residue(value: float | Fraction | int) -> int:
    """Return a number in the field; a float is the decimal that it prints as.

    Examples
    --------
    >>> residue(0.5) * 2 % PRIME
    1
    """
    exact = value if isinstance(value, int | Fraction) else Fraction(repr(float(value)))
    return exact.numerator % PRIME * pow(exact.denominator, -1, PRIME) % PRIME


def evaluate(c: Rational, values: Mapping[str, int]) -> int:
    """Return a coefficient in the field.

    Examples
    --------
    >>> a = Rational.atom("a")
    >>> evaluate((a + 1) / (a - 1), {"a": 3})
    2
    """
    total = residue(c.coefficient)
    for atom, k in c.monomial:
        total = total * pow(values[atom], k, PRIME) % PRIME
    for factor, k in c.factors.items():
        inner = 0
        for monomial, number in factor.ordered():
            term = residue(number)
            for atom, power in monomial:
                term = term * pow(values[atom], power, PRIME) % PRIME
            inner = (inner + term) % PRIME
        total = total * pow(inner, k, PRIME) % PRIME
    return total


class Module:
    """All consequences of some relations: combinations with polynomial factors.

    The relations are kept with distinct leading columns (highest derivative first, then the
    order in which columns came): the weak Popov form of T. Mulders and A. Storjohann, *On
    lattice reduction for polynomial matrices*, J. Symbolic Computation 35(4), 2003, which is a
    Groebner basis of the module. A relation belongs to it if and only if it reduces to nothing.

    Examples
    --------
    ``y = 0`` does not follow from ``y' + y = 0``, the converse does:

    >>> decay, rest = {("y", 0): 1, ("y", 1): 1}, {("y", 0): 1}
    >>> Module([decay]).contains(rest), Module([rest]).contains(decay)
    (False, True)
    """

    def __init__(self, relations: Iterable[Relation]) -> None:
        self._rank: dict[Hashable, int] = {}
        self._rows: dict[Hashable, tuple[int, Relation]] = {}
        """By leading column: the order of its derivative, and the row, with one there."""
        self._add({(ONE, 1): 1})
        for row in relations:
            self._add(row)

    def contains(self, row: Relation) -> bool:
        """Whether a relation follows."""
        left = dict(row)
        while left:
            key, order = self._lead(left)
            if key not in self._rows or self._rows[key][0] > order:
                return False
            self._reduce(left, key, order)
        return True

    def _lead(self, row: Relation) -> Column:
        rank = self._rank
        for key, _ in row:
            rank.setdefault(key, len(rank))
        return max(row, key=lambda at: (at[1], rank[at[0]]))

    def _reduce(self, row: Relation, key: Hashable, order: int) -> None:
        """Take a multiple of a kept row from `row`, so that its leading term vanishes."""
        low, other = self._rows[key]
        factor = row[key, order]
        for (k, n), c in other.items():
            at = (k, n + order - low)
            value = (row.get(at, 0) - factor * c) % PRIME
            if value:
                row[at] = value
            else:
                row.pop(at, None)

    def _add(self, row: Relation) -> None:
        left = dict(row)
        while left:
            key, order = self._lead(left)
            kept = self._rows.get(key)
            if kept is not None and kept[0] <= order:
                self._reduce(left, key, order)
                continue
            inverse = pow(left[key, order], -1, PRIME)
            self._rows[key] = (order, {at: c * inverse % PRIME for at, c in left.items()})
            if kept is None:
                return
            # the new row leads at a lower order: the old one goes on without its leading term
            left = kept[1]
