"""What sums and products are rounded by, against fractions."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest

from hybond.engine.algebra.blocks import Rows, fit_rows, make_rows
from hybond.engine.algebra.lu_twofold import lu_factor_twofold, lu_solve_twofold
from hybond.engine.algebra.twofold import product_rest, row_closely, sum_rest


def number(draw: random.Random, powers: int) -> float:
    return draw.choice((-1.0, 1.0)) * draw.uniform(1.0, 2.0) * 2.0 ** draw.randint(-powers, powers)


def test_a_sum_and_its_rest_are_exact() -> None:
    draw = random.Random(1)
    for _ in range(2000):
        a, b = number(draw, 60), number(draw, 60)
        assert Fraction(a) + Fraction(b) == Fraction(a + b) + Fraction(sum_rest(a, b, a + b))


def test_a_product_and_its_rest_are_exact() -> None:
    draw = random.Random(2)
    for _ in range(2000):
        a, b = number(draw, 200), number(draw, 200)
        assert Fraction(a) * Fraction(b) == Fraction(a * b) + Fraction(product_rest(a, b, a * b))


@pytest.mark.parametrize(
    ("a", "b"), [(1e300, 3.0), (1e200, 1e200), (math.inf, 2.0), (-1e308, 1e308), (0.0, 5.0)]
)
def test_beyond_the_numbers_nothing_is_made_of_it(a: float, b: float) -> None:
    assert product_rest(a, b, a * b) == 0.0
    assert math.isfinite(sum_rest(a, b, a + b))


def row(values: list[float], rests: list[float]) -> Rows:
    r = make_rows()
    fit_rows(r, 1, len(values))
    r.first.at[0], r.first.at[1] = 0, len(values)
    for i, value in enumerate(values):
        r.column.at[i], r.value.at[i], r.rest.at[i] = i, value, rests[i]
    return r


def test_rows_keep_their_digits_where_terms_cancel() -> None:
    draw = random.Random(3)
    for _ in range(300):
        values = [number(draw, 20) for _ in range(4)]
        rests = [v * draw.uniform(-1e-17, 1e-17) for v in values]
        x = [number(draw, 20) for _ in range(4)]
        # the last makes the sum a part in 1e9 to 1e14 of its terms
        x[3] = -sum(values[i] * x[i] for i in range(3)) / values[3]
        x[3] *= 1.0 + 10.0 ** draw.uniform(-14, -9)
        pairs = zip(values, rests, x, strict=True)
        true = sum((Fraction(v) + Fraction(s)) * Fraction(y) for v, s, y in pairs)
        assert row_closely(row(values, rests), 0, x) == pytest.approx(float(true), rel=1e-14)


def test_systems_are_solved_with_twice_the_digits() -> None:
    """Rows that fall apart by 1e18 sum to next to nothing: single numbers leave none of that."""
    draw = random.Random(4)
    for _ in range(50):
        n = 4
        fast = [number(draw, 2) * 1e18 for _ in range(n)]
        exact = [[Fraction(fast[j]) * (j != i) for j in range(n)] for i in range(n)]
        for j in range(n):
            leak = Fraction(draw.uniform(0.5, 2.0))
            exact[j][j] = -sum(exact[i][j] for i in range(n) if i != j) - leak
        x = [Fraction(number(draw, 3)) for _ in range(n)]
        right = [sum(p * q for p, q in zip(row, x, strict=True)) for row in exact]
        entries = [v for row in exact for v in row]
        a, rest = [float(v) for v in entries], [float(v - Fraction(float(v))) for v in entries]
        b, over = [float(v) for v in right], [float(v - Fraction(float(v))) for v in right]
        row = [0] * n
        lu_factor_twofold(n, a, rest, row)
        lu_solve_twofold(n, a, rest, row, b, over)
        assert b == pytest.approx([float(v) for v in x], rel=1e-9)
