"""Expressions as instructions say what their trees say, on numbers and on pairs."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest
from example_runs import NAMES, example

from hybond.engine.answers import value
from hybond.engine.expressions.code import DEEPEST, run_code, run_pair_code
from hybond.engine.expressions.functions import power
from hybond.engine.expressions.pairs import Stack, clear, make_stack
from hybond.engine.tables import answered, tables_of
from hybond.engine.tables.code import Code
from hybond.errors import ModelError
from hybond.model.expressions import Binary, Expr, Name, Number, compile_expression, parse

TEXTS = [
    "a + b - c*a/b",
    "a^b + c^2 + (-a)^3",
    "-a < b and (b >= c or not a == 1) or c != 2",
    "a if b > 0 else c if a > 0 else -b",
    "abs(a) + sign(b)*floor(c) - ceil(a)",
    "min(a, b, c) + max(a, b, c) - hypot(a, b)",
    "sin(a) + cos(b)*tan(c) + asin(a) + acos(b) + atan(c)",
    "sinh(a) + cosh(b) - tanh(c) + exp(a) + log(b) + log10(c) + sqrt(a)",
    "atan2(a, b) + mod(c, b)",
    "pre(a)*pre(b + c) - a",
    "(1 if a > 0 and b > 0 else 0) + (a > b)*c",
    "0*a + 1e300*b*1e10 - 1/c",
    "exp(709.5 + 0*a) + 10^308 + (0*a - 1)^3",
    "exp(709.7827 + 0*a) + sinh(710.2 + 0*b) - cosh(0*c - 710.2)",
    "10^(308.2547 + 0*a) + 10^(308.2548 + 0*b)",
]
VALUES = [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 1e3, -1e-3, math.nan, math.inf, -math.inf]
SLOT = {"a": 0, "b": 1, "c": 2}


@pytest.mark.parametrize("text", TEXTS)
def test_numbers_are_those_of_the_closures(text: str) -> None:
    code = Code(SLOT, 3)
    begin = code.add(parse(text), paired=False)
    meant = compile_expression(parse(text), SLOT, pre_offset=3)
    draw = random.Random(text)
    for _ in range(300):
        v = [draw.choice(VALUES) for _ in range(6)]
        found = run_code(code.instructions, begin, code.numbers, v, [0.0] * DEEPEST)
        assert str(found) == str(float(meant(v))), v


@pytest.mark.parametrize("n", [2, 3])
def test_squares_and_cubes_are_right_to_the_last_places(n: int) -> None:
    draw = random.Random(n)
    for _ in range(1000):
        a = math.ldexp(draw.uniform(-1.0, 1.0), draw.randint(-300, 300))
        true = Fraction(a) ** n
        assert abs(Fraction(power(a, float(n))) - true) <= Fraction(n - 1, 2**52) * abs(true)
    assert math.isnan(power(math.nan, float(n)))
    assert power(1e200, float(n)) == math.inf
    assert power(-math.inf, float(n)) == (-math.inf if n == 3 else math.inf)
    assert math.copysign(1.0, power(-0.0, float(n))) == (-1.0 if n == 3 else 1.0)


def stack_with(draw: random.Random, n: int) -> Stack:
    """Return a stack whose signals are random; some jump."""
    s = make_stack()
    s.now = [draw.choice([*VALUES[:9], draw.gauss(0.0, 3.0)]) for _ in range(n)]
    s.was = [x if draw.random() < 0.5 else draw.gauss(0.0, 3.0) for x in s.now]
    s.was_first = 0
    s.jump = [draw.gauss(0.0, 1.0) if draw.random() < 0.3 else 0.0 for _ in range(n)]
    s.jumps = True
    s.terms = [abs(x) + abs(draw.gauss(0.0, 1.0)) for x in s.now]
    s.prior_terms = s.terms
    clear(s)
    return s


def top(s: Stack) -> tuple[str, ...]:
    columns = (s.finite, s.impulse, s.before, s.size, s.impulse_size)
    return (str(s.top), str(s.refused), *(str(c[s.top]) for c in columns))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", NAMES)
def test_expressions_of_an_example(name: str) -> None:
    tables = tables_of(example(name).flatten(), solver="rk45")
    size = tables.slots.size
    m = answered(tables)
    code = Code(tables.slots.index, size)
    draw = random.Random(name)
    rows = [[draw.gauss(0.0, 2.0) for _ in range(2 * size)] for _ in range(3)]
    for k, tree in enumerate(tables.values.all):
        begin = code.add(tree, paired=False)
        for v in rows:
            found = run_code(code.instructions, begin, code.numbers, v, [0.0] * DEEPEST)
            assert str(found) == str(value(m, k, v)), tables.values.text[k]
    for k, tree in enumerate(tables.pairs):
        begin = code.add(tree, paired=True)
        for _ in range(3):
            s = stack_with(draw, size)
            run_pair_code(code.instructions, begin, code.numbers, s)
            found = top(s)
            clear(s)
            m.answers.pair(k, s)
            assert found == top(s), k


def test_an_expression_that_is_too_deep_is_refused() -> None:
    deep: Expr = Binary("-", Number(1.0), Name("a"))  # needs one place: what is right of it is read
    for _ in range(DEEPEST - 1):
        deep = Binary("+", Name("a"), deep)
    Code({"a": 0}, 1).add(deep, paired=False)
    deep = Binary("+", Name("a"), deep)
    with pytest.raises(ModelError) as caught:
        Code({"a": 0}, 1).add(deep, paired=False)
    assert caught.value.code == "HB-E636"
