"""Sparse polynomials in many named atoms, with exact coefficients.

A monomial is a tuple of ``(atom, exponent)`` with the atoms in falling order of their names. The
comparison that Python has for such tuples is then the lexicographic monomial order in which later
names weigh more: two monomials differ first where one has the later atom, or more of the same one.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Mapping
from fractions import Fraction

Monomial = tuple[tuple[str, int], ...]
"""Atoms in falling order with their exponents, none zero; ``()`` is one."""

Coefficient = int | Fraction
"""Exact numbers; whole ones are mostly ints, which are ten times as fast."""


def times(a: Monomial, b: Monomial) -> Monomial:
    """Return the product; exponents may be negative, and those that meet at zero vanish.

    Examples
    --------
    >>> times((("b", 1), ("a", 2)), (("c", 1), ("a", -2)))
    (('c', 1), ('b', 1))
    """
    if not a:
        return b
    if not b:
        return a
    if a[-1][0] > b[0][0]:
        return a + b
    if b[-1][0] > a[0][0]:
        return b + a
    powers = dict(a)
    zero = False
    for atom, k in b:
        powers[atom] = k = powers.get(atom, 0) + k
        zero = zero or not k
    if zero:
        return tuple(sorted(((atom, k) for atom, k in powers.items() if k), reverse=True))
    return tuple(sorted(powers.items(), reverse=True))


def inverse(m: Monomial) -> Monomial:
    """Return the monomial with all exponents negated."""
    return tuple([(atom, -k) for atom, k in m])


def over(a: Monomial, b: Monomial) -> Monomial | None:
    """Return ``a / b``, or None where an exponent would be negative.

    Examples
    --------
    >>> over((("b", 1), ("a", 2)), (("a", 1),)), over((("a", 1),), (("b", 1),))
    ((('b', 1), ('a', 1)), None)
    """
    if not b:
        return a
    powers = dict(a)
    for atom, k in b:
        left = powers.get(atom, 0) - k
        if left < 0:
            return None
        powers[atom] = left
    # The order of `a` is kept, and `b` brings no atom that `a` has not.
    return tuple([(atom, k) for atom, k in powers.items() if k])


def common(monomials: Iterable[Monomial]) -> Monomial:
    """Return the greatest monomial that divides all of these; an exponent not there counts as 0.

    Examples
    --------
    >>> common([(("b", 1), ("a", 2)), (("a", 3),)]), common([(("a", -1),), ()])
    ((('a', 2),), (('a', -1),))
    """
    rest = iter(monomials)
    least = dict(next(rest))
    for m in rest:
        powers = dict(m)
        for atom in [*least, *(x for x in powers if x not in least)]:
            least[atom] = min(least.get(atom, 0), powers.get(atom, 0))
    return tuple(sorted(((atom, k) for atom, k in least.items() if k), reverse=True))


def _ratio(a: Coefficient, b: Coefficient) -> Coefficient:
    if type(a) is int and type(b) is int and a % b == 0:
        return a // b
    return Fraction(a) / b


class Polynomial:
    """A polynomial; immutable, hashable, equal if and only if it is the same polynomial.

    Examples
    --------
    >>> a, b = Polynomial.atom("a"), Polynomial.atom("b")
    >>> (a + b) * (a - b) == a**2 - b**2
    True
    >>> divide(a**3 - b**3, a - b)
    Polynomial(b^2 + b a + a^2)
    """

    __slots__ = ("_hash", "_probe", "terms")

    terms: dict[Monomial, Coefficient]
    """Zero coefficients are dropped."""

    def __init__(self, terms: Mapping[Monomial, Coefficient]) -> None:
        self.terms = {m: c for m, c in terms.items() if c}
        self._hash: int | None = None
        self._probe: int | None = None

    @staticmethod
    def atom(name: str) -> Polynomial:
        """Return the polynomial that is one atom."""
        return Polynomial({((name, 1),): 1})

    @staticmethod
    def constant(value: Coefficient) -> Polynomial:
        """Return a number as a polynomial."""
        return Polynomial({(): value})

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __len__(self) -> int:
        """Return the number of terms."""
        return len(self.terms)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Polynomial):
            return self.terms == other.terms
        return NotImplemented

    def __hash__(self) -> int:
        if self._hash is None:
            self._hash = hash(frozenset(self.terms.items()))
        return self._hash

    def __repr__(self) -> str:
        def one(m: Monomial, c: Coefficient) -> str:
            powers = [f"{atom}^{k}" if k != 1 else atom for atom, k in m]
            return " ".join([*([str(c)] if c != 1 or not m else []), *powers])

        return f"Polynomial({' + '.join(one(m, c) for m, c in self.ordered()) or '0'})"

    def ordered(self) -> list[tuple[Monomial, Coefficient]]:
        """Return the terms, the leading one first."""
        return sorted(self.terms.items(), key=lambda term: term[0], reverse=True)

    def atoms(self) -> set[str]:
        """Return the names of the atoms that occur."""
        return {atom for m in self.terms for atom, _ in m}

    def degrees(self) -> dict[str, int]:
        """Return the highest power of each atom."""
        found: dict[str, int] = {}
        for m in self.terms:
            for atom, k in m:
                if k > found.get(atom, 0):
                    found[atom] = k
        return found

    def __neg__(self) -> Polynomial:
        return Polynomial({m: -c for m, c in self.terms.items()})

    def __add__(self, other: Polynomial) -> Polynomial:
        total = dict(self.terms)
        for m, c in other.terms.items():
            total[m] = total.get(m, 0) + c
        return Polynomial(total)

    def __sub__(self, other: Polynomial) -> Polynomial:
        total = dict(self.terms)
        for m, c in other.terms.items():
            total[m] = total.get(m, 0) - c
        return Polynomial(total)

    def scaled(self, factor: Coefficient, monomial: Monomial = ()) -> Polynomial:
        """Return the polynomial times a number and a monomial."""
        if not monomial and factor == 1:
            return self
        return Polynomial({times(m, monomial): c * factor for m, c in self.terms.items()})

    def __mul__(self, other: Polynomial) -> Polynomial:
        few, many = (self, other) if len(self) <= len(other) else (other, self)
        if len(few) == 1:
            ((m, c),) = few.terms.items()
            return many.scaled(c, m)
        total: dict[Monomial, Coefficient] = {}
        for m, c in few.terms.items():
            for n, d in many.terms.items():
                both = times(m, n)
                total[both] = total.get(both, 0) + c * d
        return Polynomial(total)

    def __pow__(self, power: int) -> Polynomial:
        if power < 0:
            raise ValueError("a polynomial to a negative power is no polynomial")
        result, square = Polynomial.constant(1), self
        while power:
            if power & 1:
                result = result * square
            power >>= 1
            if power:
                square = square * square
        return result

    def content(self) -> Coefficient:
        """Return the number that `primitive` leaves out: with the sign of the leading term.

        Examples
        --------
        >>> Polynomial({(("b", 1),): Fraction(-1, 2), (("a", 1),): Fraction(3, 4)}).content()
        Fraction(-1, 4)
        """
        if not self.terms:
            return 0
        values = self.terms.values()
        size: Coefficient = math.gcd(*[c.numerator for c in values])
        below = math.lcm(*[c.denominator for c in values])
        if below != 1:
            size = Fraction(size.numerator, below)
        return size if self.terms[max(self.terms)] > 0 else -size

    def split(self) -> tuple[Coefficient, Monomial, Polynomial]:
        """Return content, greatest monomial factor, and the primitive rest, whose product this is.

        The rest has whole coefficients without common divisor, its leading one is positive, and no
        atom divides it. Zero is split as ``(0, (), 1)``.

        Examples
        --------
        >>> a, b = Polynomial.atom("a"), Polynomial.atom("b")
        >>> ((a**2 * b).scaled(4) - (a * b).scaled(6)).split()
        (2, (('b', 1), ('a', 1)), Polynomial(2 a + -3))
        """
        if not self.terms:
            return 0, (), Polynomial.constant(1)
        content, shared = self.content(), self._shared()
        if content == 1 and not shared:
            return 1, (), self
        back = inverse(shared)
        rest = {times(m, back): _ratio(c, content).numerator for m, c in self.terms.items()}
        return content, shared, Polynomial(rest)

    def _shared(self) -> Monomial:
        rest = iter(self.terms)
        least = dict(next(rest))
        for m in rest:
            if not least:
                break
            powers = dict(m)
            least = {atom: min(k, powers[atom]) for atom, k in least.items() if atom in powers}
        return tuple(least.items())

    def evaluate(self, values: Mapping[str, float]) -> float:
        """Return the value as a float; KeyError names an atom without a value."""
        total = 0.0
        for m, c in self.terms.items():
            product = float(c)
            for atom, k in m:
                product *= values[atom] ** k
            total += product
        return total

    def probe(self) -> int:
        """Return the value at one fixed point of whole numbers; for whole coefficients only.

        If a primitive q divides p, then ``q.probe()`` divides ``p.probe()`` (Gauss's lemma), so
        this tells most failing divisions beforehand.
        """
        if self._probe is None:
            total = 0
            for m, c in self.terms.items():
                product = c.numerator
                for atom, k in m:
                    product *= _point(atom) ** k
                total += product
            self._probe = total
        return self._probe


def _point(atom: str) -> int:
    # Not `hash`, which differs from one run to the next: the same input takes the same path.
    from zlib import crc32

    return (crc32(atom.encode()) & 0xFFFF) + 2


def divide(p: Polynomial, q: Polynomial) -> Polynomial | None:
    """Return ``p / q`` if it is a polynomial, else None.

    Long division from the lowest terms up, which suits a heap; it ends because no quotient may have
    a higher power of an atom than p's less q's.

    Raises
    ------
    ZeroDivisionError
        If `q` is zero.

    Examples
    --------
    >>> a, b = Polynomial.atom("a"), Polynomial.atom("b")
    >>> divide(a**2 + a * b, a + b), divide(a**2 + b, a + b)
    (Polynomial(a), None)
    """
    if not q:
        raise ZeroDivisionError("division by the zero polynomial")
    if not p:
        return p
    least = min(q.terms)
    first = q.terms[least]
    room = p.degrees()
    for atom, k in q.degrees().items():
        room[atom] = room.get(atom, 0) - k
        if room[atom] < 0:
            return None
    others = [(m, c) for m, c in q.terms.items() if m != least]
    left = dict(p.terms)
    heap = list(left)
    heapq.heapify(heap)
    quotient: dict[Monomial, Coefficient] = {}
    while heap:
        m = heapq.heappop(heap)
        c = left.pop(m, 0)
        if not c:
            continue
        step = over(m, least)
        if step is None or any(k > room[atom] for atom, k in step):
            return None
        quotient[step] = factor = _ratio(c, first)
        for n, d in others:
            product = times(step, n)
            old = left.get(product)
            if old is None:
                heapq.heappush(heap, product)
                old = 0
            left[product] = old - factor * d
    return Polynomial(quotient)
