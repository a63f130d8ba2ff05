"""Exact rational functions, against SymPy, exact arithmetic at points, and determinants."""

import math
from fractions import Fraction
from itertools import permutations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.equations.symbolic.polynomial import Polynomial, divide
from hybond.equations.symbolic.rational import ONE, ZERO, Rational
from hybond.equations.symbolic.read import Atoms
from hybond.equations.symbolic.show import to_sympy, to_text
from hybond.model.expressions import Binary, Expr, Name, Neg, Number, parse

sympy = pytest.importorskip("sympy")

ATOMS = ("a", "b", "motor.R", "t_off")
SYMBOLS = {name: sympy.Symbol(name, real=True) for name in ATOMS}
POINT = {"a": 3, "b": -7, "motor.R": 11, "t_off": 13}

leaves = st.one_of(
    st.sampled_from(ATOMS).map(Name),
    st.sampled_from([0.0, 1.0, 2.0, -3.0, 0.1, 0.25, 9.81]).map(Number),
)
trees = st.recursive(
    leaves,
    lambda below: st.one_of(
        st.builds(Binary, st.sampled_from("+-*/"), below, below),
        st.builds(Binary, st.just("^"), below, st.sampled_from([2.0, 3.0, -1.0]).map(Number)),
        st.builds(Neg, below),
    ),
    max_leaves=9,
)


class Undefined(Exception):
    """The tree divides by zero."""


def in_sympy(e: Expr):
    match e:
        case Number(value):
            return sympy.Rational(repr(value))
        case Name(path):
            return SYMBOLS[path]
        case Neg(arg):
            return -in_sympy(arg)
        case Binary(op, left, right):
            a, b = in_sympy(left), in_sympy(right)
            if op == "^":
                if b < 0 and sympy.cancel(a) == 0:
                    raise Undefined
                return a**b
            if op == "/":
                if sympy.cancel(b) == 0:
                    raise Undefined
                return a / b
            return {"+": a + b, "-": a - b, "*": a * b}[op]
    raise AssertionError(e)


def at_point(e: Expr, point: dict[str, int]) -> Fraction:
    """Evaluate a tree exactly; ZeroDivisionError where it has no value."""
    match e:
        case Number(value):
            return Fraction(repr(value))
        case Name(path):
            return Fraction(point[path])
        case Neg(arg):
            return -at_point(arg, point)
        case Binary("^", left, Number(power)):
            return at_point(left, point) ** int(power)
        case Binary(op, left, right):
            a, b = at_point(left, point), at_point(right, point)
            if op == "/":
                return a / b
            return {"+": a + b, "-": a - b, "*": a * b}[op]
    raise AssertionError(e)


def exact(r: Rational, point: dict[str, int]) -> Fraction:
    def value(p: Polynomial) -> Fraction:
        return sum(
            (c * math.prod(Fraction(point[x]) ** k for x, k in m) for m, c in p.terms.items()),
            Fraction(0),
        )

    return value(r.numerator) / math.prod(value(f) ** k for f, k in r.denominator.items())


def matrix_inverse(rows: list[list[Rational]]) -> list[list[Rational]]:
    n = len(rows)
    work = [[*row, *(ONE if i == j else ZERO for j in range(n))] for i, row in enumerate(rows)]
    for k in range(n):
        at = next(i for i in range(k, n) if not work[i][k].is_zero)
        work[k], work[at] = work[at], work[k]
        pivot = work[k][k]
        work[k] = [x / pivot for x in work[k]]
        for i in range(n):
            if i != k and not work[i][k].is_zero:
                c = work[i][k]
                work[i] = [x - c * y for x, y in zip(work[i], work[k])]
    return [row[n:] for row in work]


@settings(max_examples=80, deadline=None)
@given(trees)
def test_any_formula_is_that_of_sympy(e: Expr) -> None:
    atoms = Atoms()
    r = atoms.read(e)
    try:
        reference = sympy.together(in_sympy(e))
    except Undefined:
        assert atoms.meaning  # the division by zero became an atom
        return
    assert not atoms.meaning
    reduced = sympy.cancel(reference)
    assert r.is_zero == (reduced == 0)
    assert sympy.cancel(to_sympy(r) - reduced) == 0


@settings(max_examples=30, deadline=None)
@given(trees, trees)
def test_substitution_is_that_of_sympy(e: Expr, f: Expr) -> None:
    atoms = Atoms()
    r, s = atoms.read(e), atoms.read(f)
    if atoms.meaning:
        return
    reference = sympy.cancel(in_sympy(e))
    _, below = sympy.fraction(reference)
    put = {SYMBOLS["a"]: in_sympy(f), SYMBOLS["b"]: SYMBOLS["a"]}
    mapping = {"a": s, "b": Rational.atom("a")}
    if sympy.cancel(below.subs(put, simultaneous=True)) == 0:
        with pytest.raises(ZeroDivisionError):
            r.substitute(mapping)
        return
    try:
        replaced = r.substitute(mapping)
    except ZeroDivisionError:
        # Allowed only where the unreduced denominator vanishes too.
        whole = to_sympy(Rational(1, (), {})) * sympy.prod(
            [to_sympy(Rational.from_polynomial(f)) for f in r.denominator]
        )
        assert sympy.cancel(whole.subs(put, simultaneous=True)) == 0
        return
    expected = reference.subs(put, simultaneous=True)
    assert sympy.cancel(to_sympy(replaced) - expected) == 0


@settings(max_examples=100, deadline=None)
@given(trees, trees, trees)
def test_ring_axioms(e: Expr, f: Expr, g: Expr) -> None:
    atoms = Atoms()
    a, b, c = atoms.read(e), atoms.read(f), atoms.read(g)
    assert ((a + b) + c - (a + (b + c))).is_zero
    assert a + b == b + a
    assert (a * b) * c == a * (b * c)
    assert a * b == b * a
    assert (a + b) * c == a * c + b * c
    assert (a - a).is_zero
    assert a + ZERO == a * ONE == a
    if not a.is_zero:
        assert a / a == 1
        assert (1 / a) * a == ONE
        assert b / a * a == b
        assert a**-2 == 1 / (a * a)
    else:
        with pytest.raises(ZeroDivisionError):
            b / a
    # `==` is built on the same sums: it must be able to say no.
    assert a != a + 1
    if not atoms.meaning and all(
        exact(Rational.from_polynomial(d), POINT) for r in (a, b) for d in r.denominator
    ):
        assert exact(a, POINT) == exact(b, POINT) or a != b


@settings(max_examples=100, deadline=None)
@given(trees)
def test_value_is_that_of_the_formula(e: Expr) -> None:
    atoms = Atoms()
    r = atoms.read(e)
    if atoms.meaning:
        return
    try:
        expected = at_point(e, POINT)
    except ZeroDivisionError:
        return
    assert exact(r, POINT) == expected
    # Numerator and denominator are sums of whole numbers here: two roundings or so in all.
    if all(len(str(c)) < 12 for f in r.factors for c in f.terms.values()):
        assert r.evaluate(POINT) == pytest.approx(float(expected), rel=1e-13, abs=0)


@settings(max_examples=100, deadline=None)
@given(trees, trees)
def test_form_is_normal(e: Expr, f: Expr) -> None:
    r = Atoms().read(e) * Atoms().read(f) + Atoms().read(f)
    for factor, k in r.factors.items():
        assert k and len(factor) > 1
        assert factor.split() == (1, (), factor)
        assert all(type(c) is int for c in factor.terms.values())
    names = [x for x, _ in r.monomial]
    assert names == sorted(set(names), reverse=True)
    assert all(k for _, k in r.monomial)
    # No factor of the denominator is left in the numerator.
    for factor in r.denominator:
        assert r.is_zero or divide(r.numerator, factor) is None


def test_values_on_the_way_may_leave_the_range_of_floats() -> None:
    a, b = Rational.atom("a"), Rational.atom("b")
    assert (a**2 / b**2).evaluate({"a": 1e-200, "b": 2e-200}) == pytest.approx(0.25, rel=1e-15)
    assert (a**2 / b**2).evaluate({"a": 3e200, "b": 1e200}) == pytest.approx(9.0, rel=1e-15)
    tall = 1 / (10**400 * a + b)
    assert (tall * 10**399).evaluate({"a": 1.0, "b": 1.0}) == pytest.approx(0.1, rel=1e-15)
    with pytest.raises(ZeroDivisionError):
        (1 / (a - b)).evaluate({"a": 1.0, "b": 1.0})


# Products of few sums, some multiplied out, so that operands share factors openly and hidden.
_a, _b, _r = (Polynomial.atom(x) for x in ATOMS[:3])
_one = Polynomial.constant(1)
SUMS = (_a + _b, _a - _b, _a + _one, _a * _r - _b, _b - _r)


def of_sums(open_powers: list[int], hidden: set[int], power: int) -> Rational:
    r = math.prod((Rational.from_polynomial(f) ** k for f, k in zip(SUMS, open_powers)), start=ONE)
    multiplied = math.prod((SUMS[k] for k in hidden), start=_one)
    return r * Rational.from_polynomial(multiplied) ** power


shared = st.builds(
    of_sums,
    st.lists(st.integers(-2, 2), min_size=5, max_size=5),
    st.sets(st.integers(0, 4), max_size=2),
    st.sampled_from([-1, 1, -2]),
)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(shared, shared)
def test_operands_with_factors_in_common(p: Rational, q: Rational) -> None:
    x, y = exact(p, POINT), exact(q, POINT)
    assert exact(p + q, POINT) == x + y
    assert exact(p - q, POINT) == x - y
    assert exact(p * q, POINT) == x * y
    assert exact(p / q, POINT) == x / y
    assert ((p + q) - q - p).is_zero
    assert Atoms().read(parse(to_text(p))) == p


def test_sum_cancels_against_what_was_multiplied_out() -> None:
    a, b, c, d = map(Rational.atom, "abcd")
    hidden = 1 / (a * c + a * d + b * c + b * d)  # one factor, as far as anyone has seen
    r = a * hidden + b * hidden
    assert r.factors == {(c + d).numerator: -1}
    # The least common multiple is found although one factor is hidden in the other.
    r = hidden + 1 / (a + b)
    assert r.denominator == {(a + b).numerator: 1, (c + d).numerator: 1}
    assert r.numerator == (c + d + 1).numerator
    assert ((a + b) * (a + b + c) * hidden).factors == {
        (a + b + c).numerator: 1,
        (c + d).numerator: -1,
    }


def test_numbers_are_exact_decimals() -> None:
    assert Rational.of(0.1) + Rational.of(0.2) == Fraction(3, 10)
    assert Rational.of(1e-300) * Rational.of(10**300) == 1
    assert (Rational.of(9.81) * 100).coefficient == 981
    with pytest.raises(ValueError):
        Rational.of(math.nan)


def test_inverse_of_a_general_matrix_is_cofactors_over_the_determinant() -> None:
    n = 4
    inverse = matrix_inverse([[Rational.atom(f"m{i}{j}") for j in range(n)] for i in range(n)])
    determinant = {}
    for order in permutations(range(n)):
        swaps = sum(order[i] > order[j] for i in range(n) for j in range(i + 1, n))
        monomial = tuple(sorted([(f"m{i}{order[i]}", 1) for i in range(n)], reverse=True))
        determinant[monomial] = (-1) ** swaps
    _, _, whole = Polynomial(determinant).split()
    for i, row in enumerate(inverse):
        for j, x in enumerate(row):
            # Every earlier pivot has cancelled: nothing but the determinant is left below.
            assert x.denominator == {whole: 1}
            assert len(x.numerator) == math.factorial(n - 1)
            assert not {f"m{j}{k}" for k in range(n)} & x.numerator.atoms()
            assert not {f"m{k}{i}" for k in range(n)} & x.numerator.atoms()


@pytest.mark.slow
@settings(max_examples=4, deadline=None)
@given(st.lists(st.sampled_from([*ATOMS, "0", "1", "-2", "a*b", "1/a"]), min_size=16, max_size=16))
def test_inverse_of_a_random_matrix_is_that_of_sympy(entries: list[str]) -> None:
    rows = [[Atoms().read(parse(x)) for x in entries[k : k + 4]] for k in range(0, 16, 4)]
    matrix = sympy.Matrix(4, 4, [to_sympy(x) for row in rows for x in row])
    if sympy.cancel(matrix.det(method="berkowitz")) == 0:
        with pytest.raises(StopIteration):
            matrix_inverse(rows)
        return
    inverse = sympy.Matrix(4, 4, [to_sympy(x) for row in matrix_inverse(rows) for x in row])
    assert (matrix * inverse).applyfunc(sympy.cancel) == sympy.eye(4)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("n", [2, 3, 5])
def test_determinant_of_a_ladder(n: int) -> None:
    """Nodes to ground through G, to the next one through R: pivots, and their product."""
    G = [Rational.atom(f"G{k}") for k in range(n)]
    Y = [1 / Rational.atom(f"R{k}") for k in range(n + 1)]
    pivot = determinant = G[0] + Y[0] + Y[1]
    for k in range(1, n):
        pivot = G[k] + Y[k] + Y[k + 1] - Y[k] ** 2 / pivot
        determinant = determinant * pivot
    y = [1 / sympy.Symbol(f"R{k}", real=True) for k in range(n + 1)]
    matrix = sympy.diag(*[sympy.Symbol(f"G{k}", real=True) + y[k] + y[k + 1] for k in range(n)])
    for k in range(n - 1):
        matrix[k, k + 1] = matrix[k + 1, k] = -y[k + 1]
    expected = sympy.together(sympy.expand(matrix.det(method="berkowitz")))
    above, below = sympy.fraction(expected)
    mine = sympy.expand(to_sympy(Rational.from_polynomial(determinant.numerator)) * below)
    under = sympy.prod(
        [to_sympy(Rational.from_polynomial(f)) ** k for f, k in determinant.denominator.items()]
    )
    assert sympy.expand(mine - above * under) == 0
    # The pivots' denominators have cancelled: only the R are left.
    assert not any(k < 0 for k in determinant.factors.values())


def test_long_rc_ladder_keeps_its_two_neighbours() -> None:
    """Currents eliminated from 50 sections give the tridiagonal state matrix, in 100 letters."""
    n = 50
    R = [Rational.atom(f"R{k}") for k in range(n)]
    C = [Rational.atom(f"C{k}") for k in range(n)]
    # Unknowns i_k = (v_{k-1} - v_k)/R_k, then C_k dv_k/dt = i_k - i_{k+1}, from the last section.
    current: dict[int, Rational] = {}
    rows: list[dict[int, Rational]] = []
    for k in reversed(range(n)):
        own = {k - 1: 1 / R[k], k: -1 / R[k]}
        total = {j: own.get(j, ZERO) - current.get(j, ZERO) for j in {*own, *current}}
        rows.insert(0, {j: x / C[k] for j, x in total.items()})
        current = own
    for k, row in enumerate(rows):
        assert row.keys() == {j for j in (k - 1, k, k + 1) if j < n}
        assert row[k - 1] == 1 / (R[k] * C[k])
        if k + 1 < n:
            assert row[k] == -(R[k] + R[k + 1]) / (C[k] * R[k] * R[k + 1])
            assert row[k + 1] == 1 / (R[k + 1] * C[k])
