r"""Rational functions to formulas for people: text, LaTeX, Markdown, SymPy.

A function becomes an expression tree, and the printers of the expression language write it: what is
derived looks like what a person wrote.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import reduce
from typing import Any

from hybond.equations.symbolic.polynomial import Coefficient, Monomial, Polynomial
from hybond.equations.symbolic.rational import Rational
from hybond.model.expressions import Binary, Call, Expr, Name, Neg, Number, names, transform
from hybond.model.expressions import to_latex as expr_latex
from hybond.model.expressions import to_text as expr_text

SIMPLE = 12
"""Numerator and denominator up to this are shown as a fraction, longer numbers as a decimal."""


def natural(atom: str) -> tuple[Any, ...]:
    """Return a sorting key that puts R2 before R10 and small letters among capitals.

    Examples
    --------
    >>> sorted(["R10", "b", "R2", "C"], key=natural)
    ['b', 'C', 'R2', 'R10']
    """
    parts = re.split(r"([0-9]+)", atom)
    return (*((int(p), "") if p.isdigit() else (0, p.lower()) for p in parts), (0, atom))


def to_expr(
    r: Rational,
    *,
    name: Callable[[str], str] = str,
    meaning: Mapping[str, Expr] | None = None,
    order: Callable[[str], Any] = natural,
) -> Expr:
    """Return an expression tree with this value, laid out for reading.

    Whole numbers and small fractions go into numerator and denominator, other coefficients are
    decimals: ``v^2/2``, ``0.35*v``. The sign stands in front; a difference is turned so that it
    needs none.

    Parameters
    ----------
    name : callable
        What to call an atom, or a name inside a formula that an atom stands for.
    meaning : mapping of str to Expr
        The formulas of atoms that are not names (`Atoms.meaning`).
    order : callable
        Sorting key of atoms; the default is alphabetical. Give the order of declaration to get
        ``m*g`` where m was declared first.

    Examples
    --------
    >>> R1, R2 = Rational.atom("R1"), Rational.atom("R2")
    >>> str(to_expr(-1 / (1 / R1 - 1 / R2)))
    'R1*R2/(R1 - R2)'
    """
    negative, size = _Layout(name, meaning or {}, order).tree(r)
    return _minus(size) if negative else size


def to_text(
    r: Rational,
    *,
    name: Callable[[str], str] = str,
    meaning: Mapping[str, Expr] | None = None,
    order: Callable[[str], Any] = natural,
) -> str:
    """Write `r` in the expression language; parameters as in `to_expr`.

    Examples
    --------
    >>> R, C = Rational.atom("p:R"), Rational.atom("p:pad.C")
    >>> to_text(-1 / (R * C), name=lambda atom: atom[2:], order=["p:R", "p:pad.C"].index)
    '-1/(R*pad.C)'
    >>> to_text(R * Rational.of(0.1) - C * Rational.of(0.25))
    '0.1*p:R - 0.25*p:pad.C'
    """
    return expr_text(to_expr(r, name=name, meaning=meaning, order=order))


def to_latex(
    r: Rational,
    *,
    name: Callable[[str], str] = str,
    meaning: Mapping[str, Expr] | None = None,
    order: Callable[[str], Any] = natural,
) -> str:
    r"""Write `r` for LaTeX's math mode; parameters as in `to_expr`.

    Examples
    --------
    >>> R, C = Rational.atom("motor.R"), Rational.atom("C_pad")
    >>> print(to_latex(-1 / (R * C), order=["motor.R", "C_pad"].index))
    -\frac{1}{R_{\mathrm{motor}} \, C_{\mathrm{pad}}}
    """
    negative, size = _Layout(name, meaning or {}, order).tree(r)
    return expr_latex(Neg(size) if negative else size)


def to_sympy(
    r: Rational,
    *,
    name: Callable[[str], str] = str,
    meaning: Mapping[str, Expr] | None = None,
) -> Any:
    """Return `r` as a SymPy expression in real symbols; every number is exact.

    An atom that stands for a formula becomes that formula where SymPy has the function, else a
    symbol called by its text.

    Raises
    ------
    ImportError
        Without SymPy: install ``hybond[symbolic]``.
    """
    import sympy

    formulas = meaning or {}

    def symbol(text: str) -> Any:
        return sympy.Symbol(text, real=True)

    def atom(key: str) -> Any:
        formula = formulas.get(key)
        return symbol(name(key)) if formula is None else _sympy(formula, symbol, name)

    symbols = {key: atom(key) for key in sorted(r.atoms())}

    def number(c: Coefficient) -> Any:
        return sympy.Rational(c.numerator, c.denominator)

    def product(m: Monomial) -> Any:
        return sympy.Mul(*[symbols[key] ** k for key, k in m])

    def total(f: Polynomial) -> Any:
        return sympy.Add(*[number(c) * product(m) for m, c in f.ordered()])

    factors = [total(f) ** k for f, k in r.factors.items()]
    return sympy.Mul(number(r.coefficient), product(r.monomial), *factors)


_SYMPY = {"abs": "Abs", "min": "Min", "max": "Max", "ceil": "ceiling", "mod": "Mod"} | {
    f: f
    for f in "sin cos tan asin acos atan sinh cosh tanh exp log sqrt sign floor atan2".split()  # noqa: SIM905
}


def _sympy(e: Expr, symbol: Callable[[str], Any], name: Callable[[str], str]) -> Any:
    import sympy

    def below(child: Expr) -> Any:
        return _sympy(child, symbol, name)

    match e:
        case Number():
            exact = Rational.of(e.value).coefficient
            rational = sympy.Rational(exact.numerator, exact.denominator)
            return sympy.pi if e.value == math.pi else rational
        case Name(path):
            return symbol(name(path))
        case Neg(arg):
            return -below(arg)
        case Binary(op, left, right):
            a, b = below(left), below(right)
            match op:
                case "+":
                    return a + b
                case "-":
                    return a - b
                case "*":
                    return a * b
                case "/":
                    return a / b
            return a**b
        case Call(function, args) if function in _SYMPY:
            return getattr(sympy, _SYMPY[function])(*[below(arg) for arg in args])
    return symbol(expr_text(_renamed(e, name)))


def _renamed(e: Expr, name: Callable[[str], str]) -> Expr:
    return transform(e, lambda n: Name(name(n.path)) if isinstance(n, Name) else n)


def _minus(e: Expr) -> Expr:
    """Put a minus before the first factor, where it needs no parentheses."""
    match e:
        case Binary(op, left, right) if op in "*/":
            return Binary(op, _minus(left), right)
        case Number(value) if value != math.pi:
            return Number(-value)
    return Neg(e)


def _product(parts: Iterable[Expr]) -> Expr:
    found = list(parts)
    return reduce(lambda a, b: Binary("*", a, b), found) if found else Number(1.0)


def _decimal(value: Fraction) -> bool:
    """Say whether a float prints this very number in few digits."""
    try:
        return value < 10**15 and Fraction(repr(float(value))) == value
    except OverflowError:
        return False


def _simple(size: Fraction) -> bool:
    if size.denominator == 1:
        return True
    return max(size.numerator, size.denominator) <= SIMPLE and size.denominator not in (5, 10)


def _parts(size: Fraction, *, decimals: bool = False) -> tuple[Fraction, Fraction]:
    """Split a positive coefficient into what is shown above and below the line.

    Examples
    --------
    >>> sizes = [Fraction(x) for x in ("1/2", "0.35", "100/981", "7/60")]
    >>> [tuple(map(float, _parts(size))) for size in sizes]
    [(1.0, 2.0), (0.35, 1.0), (1.0, 9.81), (0.35, 3.0)]
    """
    whole = Fraction(size.numerator), Fraction(size.denominator)
    if _simple(size) and not (decimals and _decimal(size)):
        return whole
    rest = size.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    for above, below in ((size * rest, Fraction(rest)), (Fraction(1), 1 / size)):
        if _decimal(above) and _decimal(below) and below < 100:
            return above, below
    return whole


class _Layout:
    """Builds the tree of one function."""

    def __init__(
        self, name: Callable[[str], str], meaning: Mapping[str, Expr], order: Callable[[str], Any]
    ) -> None:
        self.name = name
        self.meaning = meaning
        self.order = order

    def tree(self, r: Rational) -> tuple[bool, Expr]:
        """Return whether there is a minus in front, and the rest."""
        if r.is_zero:
            return False, Number(0.0)
        negative = r.coefficient < 0
        above, below = _parts(abs(Fraction(r.coefficient)))
        sums = sorted(
            ((self.terms(f), k) for f, k in r.factors.items()),
            key=lambda part: (len(part[0]), [self.key(m) for m, _ in part[0]]),
        )
        shown: list[tuple[list[tuple[Monomial, Coefficient]], int]] = []
        for terms, k in sums:
            # A difference reads from its plus: b - a, not -(a - b); its sign goes in front.
            if terms[0][1] < 0:
                terms = [(m, -c) for m, c in terms]
                negative ^= k % 2 == 1
            shown.append((terms, k))
        turnable = [at for at, (f, k) in enumerate(shown) if k % 2 and any(c < 0 for _, c in f)]
        if negative and turnable:
            at = next((at for at in turnable if shown[at][1] > 0), turnable[0])
            shown[at] = [(m, -c) for m, c in shown[at][0]], shown[at][1]
            negative = False
        single = len(shown) == 1 and shown[0][1] == 1 and not any(k > 0 for _, k in r.monomial)
        if single and above.denominator != 1 and any(abs(c) != 1 for _, c in shown[0][0]):
            # 0.1*a + 0.25*b is kept as 0.05*(2*a + 5*b): give the decimals back to their terms.
            shown = [([(m, c * above) for m, c in shown[0][0]], 1)]
            above = Fraction(1)
        top = self.powers(m for m in r.monomial if m[1] > 0)
        bottom = self.powers((atom, -k) for atom, k in r.monomial if k < 0)
        top += [self.power(self.sum(terms), k) for terms, k in shown if k > 0]
        bottom += [self.power(self.sum(terms), -k) for terms, k in shown if k < 0]
        if above != 1 or not top:
            top.insert(0, Number(float(above)))
        if below != 1:
            bottom.insert(0, Number(float(below)))
        whole = _product(top)
        return negative, Binary("/", whole, _product(bottom)) if bottom else whole

    def terms(self, f: Polynomial) -> list[tuple[Monomial, Coefficient]]:
        """Return the terms in reading order: high degrees first, then by name."""
        return sorted(f.terms.items(), key=lambda term: self.key(term[0]))

    def key(self, m: Monomial) -> tuple[Any, ...]:
        # A caller's `order` need not know the atoms that stand for formulas.
        powers = [(atom, k) for atom, k in m for _ in range(k)]
        plain = sorted(self.order(atom) for atom, _ in powers if atom not in self.meaning)
        return -len(powers), plain, sorted(atom for atom, _ in powers if atom in self.meaning)

    def sum(self, terms: list[tuple[Monomial, Coefficient]]) -> Expr:
        """Return a sum, the first positive term in front."""
        first = next((k for k, (_, c) in enumerate(terms) if c > 0), 0)
        decimals = any(not _simple(abs(Fraction(c))) for _, c in terms)
        total: Expr | None = None
        for m, c in [terms[first], *terms[:first], *terms[first + 1 :]]:
            above, below = _parts(abs(Fraction(c)), decimals=decimals)
            parts = self.powers(m)
            if above != 1 or not parts:
                parts.insert(0, Number(float(above)))
            term = _product(parts)
            if below != 1:
                term = Binary("/", term, Number(float(below)))
            if total is None:
                total = _minus(term) if c < 0 else term
            else:
                total = Binary("-" if c < 0 else "+", total, term)
        return Number(0.0) if total is None else total

    def powers(self, m: Iterable[tuple[str, int]]) -> list[Expr]:
        """Return the powers of atoms: constants such as pi, then names, then formulas."""

        def rank(atom: str) -> tuple[int, Any]:
            formula = self.meaning.get(atom)
            if formula is None:
                return 1, self.order(atom)
            return 2 if names(formula) else 0, atom

        ordered = sorted(m, key=lambda part: rank(part[0]))
        return [self.power(self.atom(atom), k) for atom, k in ordered]

    def power(self, base: Expr, k: int) -> Expr:
        return base if k == 1 else Binary("^", base, Number(float(k)))

    def atom(self, atom: str) -> Expr:
        formula = self.meaning.get(atom)
        return Name(self.name(atom)) if formula is None else _renamed(formula, self.name)
