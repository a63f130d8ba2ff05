"""Ranges of expressions over intervals of time hold all that lies in them, and are no wider soon.

The oracle is the expression itself, at many points, and its differences.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.engine.answers import value
from hybond.engine.expressions.course_parts import OTHER, SINES, find_kinds, range_parts
from hybond.engine.expressions.course_ranges import make_ranges
from hybond.engine.tables import answered, tables_of
from hybond.engine.words import floats, ints

OF_TIME = (
    *("sin(3*t)", "cos(t*t)", "tan(t/2)", "asin(sin(t)/2)", "acos(cos(t)/3)", "atan(5*t - 2)"),
    *("sinh(t)", "cosh(t - 0.5)", "tanh(8*t - 3)", "exp(-t*t)", "log(1 + t)", "log10(2 + sin(t))"),
    *("sqrt(1 + t)", "atan2(sin(t), 2 + t)", "hypot(sin(t), t)", "abs(sin(5*t))*t"),
    *("min(sin(t), cos(t), 0.4)*exp(t)", "max(t*t, 0.3)^1.5", "1/(1 + 9*(t - 0.4)^2)"),
    *("(1 + t)^-3", "(t - 0.5)^3*exp(t)", "(2 + sin(t))^(1 + t/2)", "sin(t)^2/(2 + cos(3*t))"),
    *("mod(t, 7)*exp(t)", "(if t > 9 then exp(t) else sin(t)^5)*exp(t)", "-exp(t)/(3 - t)"),
    *("(if not t < 9 or t < 0.2 and t > -1 then exp(t) else cos(t)^3)*exp(t)",),
    *("floor(t)*exp(t)", "sign(t + 1)*exp(-t)", "ceil(t)^2*exp(t)"),
)
WINDOWS = ((0.05, 0.07), (0.3, 0.45), (0.1, 0.9), (0.5, 0.5), (1.1, 1.9))


def made(expression: str) -> Any:
    m = hb.Model()
    m.signal(x=hb.Integral(expression))
    m.signal(t="time/(1 s)")
    tables = tables_of(m.flatten(), until=2.0)
    return answered(tables)


def test_integrals_of_integrals_are_laid_out_once_each() -> None:
    """However deep they are, and however often the rate of one reads the next."""
    n = 400
    rates = {f"a{k}": f"sin(a{k + 1})*a{k + 1}" if k + 1 < n else "1" for k in range(n)}
    m = hb.Model()
    m.signal(x=hb.Integral("exp(a0)"), **{name: hb.Integral(rate) for name, rate in rates.items()})
    tables = tables_of(m.flatten(), until=1.0)
    assert tables.numbers["course_signals"] == n
    assert tables.numbers["course_nodes"] < 4 * n


@pytest.mark.parametrize("expression", OF_TIME)
def test_a_range_holds_what_lies_in_it(expression: str) -> None:
    m = made(expression)
    assert m.courses >= 1  # kinks are courses too, behind it
    r = make_ranges(m.course_nodes, m.course_plants)
    v = floats(2 * m.slots)
    root = m.course_root[0]
    for a, b in WINDOWS:
        range_parts(m, r, v, a, b)
        times = np.linspace(a, b, 400)
        found = []
        for t in times:
            v[0] = float(t)
            found.append(value(m, m.course_value[0], v))
        size = max(map(abs, found))
        assert min(found) >= r.low[root] - 1e-12 * size
        assert max(found) <= r.high[root] + 1e-12 * size
        jumps = any(word in expression for word in ("floor", "ceil", "if"))
        if b > a and not (jumps and math.floor(a) != math.floor(b)):
            slopes = np.diff(found) / np.diff(times)
            steps = slopes[np.abs(slopes) < 1e3]
            assert steps.min() >= r.low_rate[root] - 1e-8 * size
            assert steps.max() <= r.high_rate[root] + 1e-8 * size
    range_parts(m, r, v, 0.3, 0.3 + 1e-6)
    assert r.high[root] - r.low[root] < 1e-3  # as narrow as what lies in it, before long


def test_what_has_no_value_somewhere_is_unbounded() -> None:
    for expression in ("1/(t - 0.5)", "log(t - 0.5)*exp(t)", "tan(3.2*t)", "(t - 0.5)^-2*exp(t)"):
        m = made(expression)
        r = make_ranges(m.course_nodes, m.course_plants)
        range_parts(m, r, floats(2 * m.slots), 0.45, 0.55)
        root = m.course_root[0]
        assert math.inf in (-r.low[root], r.high[root])


@pytest.mark.parametrize(
    ("expression", "kind", "fastest"),
    [
        ("sin(3*t)", SINES, 3.0),
        ("sin(t*2 + 1)*cos(-5*t)", SINES, 7.0),
        ("t*sin(4*t/2)^3", SINES, 6.0),
        ("(1 + cos(2*t))*t^2", SINES, 2.0),
        ("sin(t*t)", OTHER, None),
        ("exp(-t)", OTHER, None),
        ("1/(2 + sin(t))", OTHER, None),
    ],
)
def test_sines_of_lines_are_told_from_what_else_moves(
    expression: str, kind: int, fastest: float | None
) -> None:
    """A product is as fast as its factors together."""
    m = made(expression)
    kinds, fast = ints(m.course_nodes), floats(m.course_nodes)
    find_kinds(m, make_ranges(m.course_nodes, m.course_plants), kinds, fast)
    assert kinds[m.course_root[0]] == kind
    if fastest is not None:
        assert fast[m.course_root[0]] == pytest.approx(fastest)
