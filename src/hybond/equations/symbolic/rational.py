"""Rational functions kept as products of powers, so that the pivots of an elimination cancel."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from hybond.equations.symbolic.polynomial import (
    Coefficient,
    Monomial,
    Polynomial,
    common,
    divide,
    inverse,
    times,
)

Factors = dict[Polynomial, int]
"""Sums (primitive, more than one term) to their powers; denominators are negative."""


class Rational:
    """A coefficient, times atoms to whole powers, times sums to whole powers.

    No greatest common divisors are computed. A sum is put over the least common multiple of the
    factored denominators and divided by each of their factors as often as that goes. In a Gauss
    elimination this is fraction-free elimination (Bareiss 1968, Sylvester's identity): a previous
    pivot always cancels. Zero is recognised without fail, since its numerator is the zero
    polynomial; the form of anything else is not unique, and ``==`` compares values.

    Parameters
    ----------
    monomial : Monomial
        Atoms with exponents of any sign.
    factors : dict of Polynomial to int
        Primitive polynomials of two or more terms; powers are not zero. Nothing is checked here:
        build a Rational with `atom`, `of` and arithmetic.

    Examples
    --------
    >>> R1, R2 = Rational.atom("R1"), Rational.atom("R2")
    >>> parallel = 1 / (1 / R1 + 1 / R2)
    >>> parallel == R1 * R2 / (R1 + R2)
    True
    >>> (parallel * (R1 + R2) / R1 - R2).is_zero
    True
    >>> parallel.evaluate({"R1": 2.0, "R2": 2.0})
    1.0
    """

    __slots__ = ("coefficient", "factors", "monomial")

    def __init__(self, coefficient: Coefficient, monomial: Monomial, factors: Factors) -> None:
        self.coefficient = coefficient
        self.monomial = monomial
        self.factors = factors

    @staticmethod
    def atom(name: str) -> Rational:
        """Return one atom."""
        return Rational(1, ((name, 1),), {})

    @staticmethod
    def of(number: int | float | Fraction) -> Rational:
        """Return a number; a float is the decimal that it prints as, so 0.1 is 1/10.

        Raises
        ------
        ValueError
            If the number is not finite.

        Examples
        --------
        >>> Rational.of(0.1).coefficient
        Fraction(1, 10)
        """
        if isinstance(number, int):
            return Rational(int(number), (), {})
        exact = number if isinstance(number, Fraction) else Fraction(repr(float(number)))
        return Rational(exact.numerator if exact.denominator == 1 else exact, (), {})

    @staticmethod
    def from_polynomial(p: Polynomial) -> Rational:
        """Return a polynomial, its content and monomial taken out."""
        c, m, rest = p.split()
        return Rational(c, m, {rest: 1} if len(rest) > 1 else {})

    @property
    def is_zero(self) -> bool:
        """Whether this is the zero function; exact."""
        return not self.coefficient

    @property
    def numerator(self) -> Polynomial:
        """The numerator, multiplied out, with the coefficient."""
        above = tuple((atom, k) for atom, k in self.monomial if k > 0)
        return _expanded(self.coefficient, above, {f: k for f, k in self.factors.items() if k > 0})

    @property
    def denominator(self) -> Factors:
        """The factors of the denominator, single atoms among them, to their positive powers."""
        atoms = {Polynomial.atom(atom): -k for atom, k in self.monomial if k < 0}
        return atoms | {f: -k for f, k in self.factors.items() if k < 0}

    @property
    def length(self) -> int:
        """How long this is to write: the number of atoms and of terms in sums; 0 for ±1."""
        number = self.coefficient not in (1, -1)
        return number + len(self.monomial) + sum(len(f) for f in self.factors)

    def atoms(self) -> set[str]:
        """Return the names of the atoms that occur."""
        found = {atom for atom, _ in self.monomial}
        return found.union(*[f.atoms() for f in self.factors])

    def __bool__(self) -> bool:
        return bool(self.coefficient)

    def __repr__(self) -> str:
        parts = [str(self.coefficient), *(f"{atom}^{k}" for atom, k in self.monomial)]
        parts += [f"{f!r}^{k}" for f, k in self.factors.items()]
        return f"Rational({' '.join(parts)})"

    def __eq__(self, other: object) -> bool:
        same = _coerced(other)
        return NotImplemented if same is None else (self - same).is_zero

    # Equal functions may be written differently, so no cheap hash agrees with `==`.
    __hash__ = None  # type: ignore[assignment]

    def __neg__(self) -> Rational:
        return Rational(-self.coefficient, self.monomial, self.factors)

    def __add__(self, other: Rational | int | Fraction) -> Rational:
        b = _coerced(other)
        return NotImplemented if b is None else _sum(self, b)

    __radd__ = __add__

    def __sub__(self, other: Rational | int | Fraction) -> Rational:
        b = _coerced(other)
        return NotImplemented if b is None else _sum(self, -b)

    def __rsub__(self, other: int | Fraction) -> Rational:
        return -self + other

    def __mul__(self, other: Rational | int | Fraction) -> Rational:
        b = _coerced(other)
        return NotImplemented if b is None else _product(self, b)

    __rmul__ = __mul__

    def __truediv__(self, other: Rational | int | Fraction) -> Rational:
        b = _coerced(other)
        return NotImplemented if b is None else _product(self, b.reciprocal())

    def __rtruediv__(self, other: int | Fraction) -> Rational:
        return self.reciprocal() * other

    def __pow__(self, power: int) -> Rational:
        if power <= 0:
            return self.reciprocal() ** -power if power else ONE
        atoms = tuple([(atom, k * power) for atom, k in self.monomial])
        factors = {f: k * power for f, k in self.factors.items()}
        return Rational(self.coefficient**power, atoms, factors)

    def reciprocal(self) -> Rational:
        """Return one over this; ZeroDivisionError for zero."""
        c = self.coefficient
        if c != 1 and c != -1:
            c = _plain(1 / Fraction(c))
        return Rational(c, inverse(self.monomial), {f: -k for f, k in self.factors.items()})

    def evaluate(self, values: Mapping[str, float]) -> float:
        """Return the value as a float.

        Raises
        ------
        KeyError
            For an atom without a value.
        ZeroDivisionError
            Where the denominator vanishes.
        """
        try:
            total, below = float(self.coefficient), 1.0
            for atom, k in self.monomial:
                if k > 0:
                    total *= values[atom] ** k
                else:
                    below *= values[atom] ** -k
            for f, k in self.factors.items():
                if k > 0:
                    total *= f.evaluate(values) ** k
                else:
                    below *= f.evaluate(values) ** -k
            return total / below
        except (OverflowError, ZeroDivisionError):
            # Numbers on the way left the range of floats: the slow way has no such range.
            numbers = {atom: Rational.of(Fraction(values[atom])) for atom in self.atoms()}
            return float(self.substitute(numbers).coefficient)

    def substitute(self, mapping: Mapping[str, Rational]) -> Rational:
        """Return this with atoms replaced, all at once.

        Raises
        ------
        ZeroDivisionError
            If the denominator becomes zero.

        Examples
        --------
        >>> R, G = Rational.atom("R"), Rational.atom("G")
        >>> (1 / (R + 1)).substitute({"R": 1 / G}) == G / (G + 1)
        True
        """
        result = Rational(self.coefficient, (), {}) * _replaced(self.monomial, mapping)
        for f, k in self.factors.items():
            total = ZERO
            for m, c in f.ordered():
                total = total + Rational(c, (), {}) * _replaced(m, mapping)
            result = result * total**k
        return result


ZERO = Rational(0, (), {})
ONE = Rational(1, (), {})


def _plain(c: Coefficient) -> Coefficient:
    return c.numerator if c.denominator == 1 else c


def _coerced(other: object) -> Rational | None:
    if type(other) is Rational:
        return other
    return Rational.of(other) if isinstance(other, int | Fraction) else None


def _replaced(m: Monomial, mapping: Mapping[str, Rational]) -> Rational:
    result = Rational(1, tuple([(atom, k) for atom, k in m if atom not in mapping]), {})
    for atom, k in m:
        if atom in mapping:
            result = result * mapping[atom] ** k
    return result


def _expanded(c: Coefficient, m: Monomial, factors: Factors) -> Polynomial:
    result = Polynomial({m: c})
    for f, k in factors.items():
        result = result * (f if k == 1 else f**k)
    return result


def _exactly(p: Polynomial, q: Polynomial) -> Polynomial | None:
    """Return ``p / q`` of primitive polynomials, where it is one."""
    if len(q) == 1:
        return p if q.probe() == 1 else None
    test = q.probe()
    if test and p.probe() % test:
        return None
    return divide(p, q)


def _raise(factors: Factors, f: Polynomial, k: int) -> None:
    power = factors.get(f, 0) + k
    if power:
        factors[f] = power
    else:
        factors.pop(f, None)


def _product(a: Rational, b: Rational) -> Rational:
    c = a.coefficient * b.coefficient
    if not c:
        return ZERO
    if type(c) is Fraction:
        c = _plain(c)
    monomial = times(a.monomial, b.monomial)
    if not b.factors:
        return Rational(c, monomial, a.factors)
    if not a.factors:
        return Rational(c, monomial, b.factors)
    factors = dict(a.factors)
    for f, k in b.factors.items():
        _raise(factors, f, k)
    for f in b.factors:
        for g in a.factors:
            # What one brings may hide, multiplied out, in what the other brings.
            if factors.get(f, 0) * factors.get(g, 0) < 0:
                _cancel(factors, f, g)
    return Rational(c, monomial, factors)


def _cancel(factors: Factors, f: Polynomial, g: Polynomial) -> None:
    """Where one of two factors divides the other, split that one."""
    big, small = (f, g) if len(f) >= len(g) else (g, f)
    rest = _exactly(big, small)
    if rest is None and len(f) == len(g):
        big, small = small, big
        rest = _exactly(big, small)
    if rest is not None:
        k = factors.pop(big)
        _raise(factors, small, k)
        _raise(factors, rest, k)


def _sum(a: Rational, b: Rational) -> Rational:
    if not b.coefficient:
        return a
    if not a.coefficient:
        return b
    if a.monomial == b.monomial and a.factors == b.factors:
        c = a.coefficient + b.coefficient
        return Rational(_plain(c), a.monomial, a.factors) if c else ZERO
    above, below = a.factors, b.factors
    if above and below:
        above, below = _refined(above, below)
    # What both have is kept aside: the lower power of each factor, which in a denominator is the
    # least common multiple.
    shared: Factors = {}
    for f in [*above, *(g for g in below if g not in above)]:
        k = min(above.get(f, 0), below.get(f, 0))
        if k:
            shared[f] = k
    monomial = common((a.monomial, b.monomial)) if a.monomial != b.monomial else a.monomial
    back = inverse(monomial)
    total = _expanded(a.coefficient, times(a.monomial, back), _less(above, shared)) + _expanded(
        b.coefficient, times(b.monomial, back), _less(below, shared)
    )
    c, extra, rest = total.split()
    if not c:
        return ZERO
    for f, k in list(shared.items()):
        while k < 0 and len(rest) > 1:
            found = _exactly(rest, f)
            if found is None:
                break
            rest, k = found, k + 1
            _raise(shared, f, 1)
    if len(rest) > 1:
        _raise(shared, rest, 1)
        for f in list(shared):
            # The other way round: the sum is a factor of what was multiplied out.
            if shared.get(rest, 0) > 0 and shared.get(f, 0) < 0 and len(f) >= len(rest):
                _cancel(shared, f, rest)
    return Rational(_plain(c), times(monomial, extra), shared)


def _less(factors: Factors, shared: Factors) -> Factors:
    left = dict(factors)
    for f, k in shared.items():
        _raise(left, f, -k)
    return left


def _refined(above: Factors, below: Factors) -> tuple[Factors, Factors]:
    """Split denominators of one operand that the other's divide, so that their lcm is smaller."""
    mine = [f for f, k in above.items() if k < 0 and f not in below]
    theirs = [f for f, k in below.items() if k < 0 and f not in above]
    if not mine or not theirs:
        return above, below
    above, below = dict(above), dict(below)
    for f in mine:
        for g in theirs:
            if f not in above or g not in below:
                continue
            holder, big, small = (above, f, g) if len(f) >= len(g) else (below, g, f)
            rest = _exactly(big, small)
            if rest is not None:
                k = holder.pop(big)
                _raise(holder, small, k)
                _raise(holder, rest, k)
    return above, below
