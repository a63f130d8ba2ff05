"""Sources as sums of what a matrix lets grow: generators."""

import numpy as np
import pytest
from scipy.linalg import expm

from hybond.engine.tables.generators import generators, of_name, terms_of
from hybond.model.expressions import compile_expression, parse


@pytest.mark.parametrize(
    "text",
    [
        "3",
        "2*time - 1",
        "time^3/7",
        "5*sin(3*time + 0.4)",
        "cos(2*time)*sin(5*time)^2",
        "exp(-2*time)*(1 + time*cos(time))",
        "exp(3*(time - 1000))",
        "sinh(time) - 2*cosh(time/3)",
        "a*time*sin(time) + a^2",
        "if 2 > 1 then sin(time) else sqrt(time)",
        "sqrt(2)*min(1, 3)*time",
    ],
)
def test_generators_are_what_they_stand_for(text):
    e = parse(text)
    terms = terms_of(e, of_name)
    assert isinstance(terms, dict)
    made = generators(terms, lambda name: "da" if name == "a" else None)
    row = np.zeros(len(made.expressions))
    for k, factor in made.row(terms).items():
        row[k] = factor
    index = {"time": 0, "a": 1, "da": 2}
    value = compile_expression(e, index, pre_offset=3)
    each = [compile_expression(g, index, pre_offset=3) for g in made.expressions]

    def at(t):
        v = [t, 0.5 - 2.0 * t, -2.0, 0.0, 0.0, 0.0]
        return value(v), np.array([g(v) for g in each])

    t, h = 0.7, 0.9
    before, g = at(t)
    after, then = at(t + h)
    assert row @ g == pytest.approx(before, rel=1e-12)
    assert expm(made.matrix * h) @ g == pytest.approx(then, rel=1e-11, abs=1e-300)
    assert row @ expm(made.matrix * h) @ g == pytest.approx(after, rel=1e-11)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("sqrt(time)", "sqrt of what varies"),
        ("1/time", "a division by what varies"),
        ("time^0.5", "a power that is no small whole number"),
        ("2^time", "a power of what varies"),
        ("sin(time^2)", "sin of what is no line in time"),
        ("if time > 1 then 1 else 2", "a condition that varies"),
        ("max(time, 1)", "max of what varies"),
        ("pre(a)", "an a priori value"),
        ("exp(1000)*exp(1000)*time", "a value that overflows"),
    ],
)
def test_what_has_no_generators_says_why(text, reason):
    assert terms_of(parse(text), of_name) == reason
