"""Sparse polynomials: division, content and hashing, against SymPy and by multiplying back."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.equations.symbolic.polynomial import Polynomial, divide

sympy = pytest.importorskip("sympy")

monomials = st.dictionaries(st.sampled_from("xyz"), st.integers(1, 3), max_size=3).map(
    lambda d: tuple(sorted(d.items(), reverse=True))
)
polynomials = st.dictionaries(monomials, st.fractions(-5, 5, max_denominator=4), max_size=5).map(
    Polynomial
)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(polynomials, polynomials)
def test_a_product_divides_exactly(p: Polynomial, q: Polynomial) -> None:
    if q:
        assert divide(p * q, q) == p
    else:
        with pytest.raises(ZeroDivisionError):
            divide(p, q)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(polynomials, polynomials, st.booleans())
def test_division_is_exact_just_when_sympy_has_no_remainder(
    p: Polynomial, q: Polynomial, product: bool
) -> None:
    if not q:
        return
    if product:
        p = p * q + Polynomial.constant(len(p) % 2)
    x, y, z = sympy.symbols("x y z")
    symbols = {"x": x, "y": y, "z": z}

    def other(f: Polynomial):
        total = sum(
            sympy.Rational(c.numerator, c.denominator) * sympy.prod([symbols[n] ** k for n, k in m])
            for m, c in f.terms.items()
        )
        return sympy.Poly(total, x, y, z, domain="QQ")

    quotient, remainder = sympy.div(other(p), other(q))
    found = divide(p, q)
    assert (found is not None) == remainder.is_zero
    if found is not None:
        assert other(found) == quotient


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(polynomials)
def test_split_multiplies_back(p: Polynomial) -> None:
    c, m, rest = p.split()
    assert rest.scaled(c, m) == p
    if p:
        assert math.gcd(*[int(x) for x in rest.terms.values()]) == 1
        assert rest.ordered()[0][1] > 0
        assert all(not all(n in dict(k) for k in rest.terms) for n in rest.atoms())


def test_equal_polynomials_have_equal_hashes() -> None:
    x, y = Polynomial.atom("x"), Polynomial.atom("y")
    p, q = (x + y) * (x - y), y * -y + x * x
    assert p == q and hash(p) == hash(q) and len({p, q}) == 1
    assert (x - x) == Polynomial({}) and not (x - x)
