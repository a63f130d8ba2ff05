"""Expressions have their value where numbers on the way have none: guards, signals, parameters.

The oracle is the expression itself in decimals, with digits and exponents enough.
"""

from __future__ import annotations

import re
from decimal import Context, Decimal, localcontext

import numpy as np
import pytest

from hybond.engine.expressions.code import DEEPEST, run_code, run_pair_code
from hybond.engine.expressions.pairs import clear, make_stack
from hybond.engine.tables.code import Code
from hybond.model.expressions import compile_expression, parse
from hybond.model.expressions.algebra import ARRAYS

FORMS = (
    *("log(1 + exp(x))", "log(exp(x) + exp(-x))", "log(2*exp(x) + 3)", "log(exp(x))"),
    *("log(3*exp(x))", "x*exp(x)/(1 + exp(x))"),
    *("log(sinh(abs(x) + 1))", "log(cosh(x))", "log10(1 + exp(x))", "log(2 + 2*cosh(x))"),
    *("log(exp(x) + exp(2*x) + exp(-x))", "log((exp(x) + exp(-x))/2)", "log(exp(x) + 3) - x"),
    *("exp(x)/(1 + exp(x))", "(exp(x) - exp(-x))/(exp(x) + exp(-x))", "sinh(x)/cosh(x)"),
    *("cosh(x)/sinh(x + 0.5)", "sinh(x)/cosh(x)^2", "exp(x)/(1 + exp(x))^2"),
    *("(1 - exp(-x))/(1 + exp(-x))", "exp(2*x)/(exp(x) + 1)^2", "1/(1 + exp(x))*exp(x)"),
    *("log(exp(x)/(1 + exp(x)))", "log(1/(1 + exp(-x)))", "(2 + exp(x))/(3 - exp(-x) + exp(x))"),
    *("exp(x)*exp(-x/2 - 1)", "sqrt(exp(x))", "sqrt(4*exp(-x))", "1/cosh(x)^2"),
    *("sqrt((1e200*x)^2 + (3e199*x)^2)", "sqrt((1e-200*x)^2 + (2e-200*x)^2)"),
    *("sinh(x)^2/cosh(x)^2", "sinh(x)^3/cosh(x)^3", "cosh(x)^2/sinh(x - 0.5)^2"),
    *("sinh(x)^2/(1 + sinh(x)^2)", "sinh(x)*cosh(x)/(2 + cosh(x)^2)", "log(cosh(x)^2)"),
    *("(1 - sinh(x)^2)/cosh(x)^2", "sinh(-x)^2/cosh(x)^2 - sinh(x)*cosh(-x)/cosh(x)^2"),
    *("sqrt(1 + exp(x))", "sqrt(3 + 2*cosh(x))", "sqrt(exp(x) + exp(x/2))", "sqrt(cosh(x))"),
    *("(2 + exp(-x))^0.25", "x/sqrt(1 + exp(x))", "exp(x)/sqrt(1 + exp(2*x))"),
    "sqrt(1 + exp(x))*sinh(x)/cosh(x)",
    *("hypot(1e200*x, 1e201)", "sqrt((1e160*x)*(1e160*x))", "1e200*x/sqrt((1e200*x)^2 + 1e300)"),
)
AT = (-731.3, -709.9, -36.7, -1e-3, 0.0, 1e-9, 0.7, 300.0, 709.9, 733.1)
NAMED = {
    "exp": Decimal.exp,
    "log": Decimal.ln,
    "log10": Decimal.log10,
    "sqrt": Decimal.sqrt,
    "cosh": lambda x: (x.exp() + (-x).exp()) / 2,
    "sinh": lambda x: (x.exp() - (-x).exp()) / 2,
    "abs": abs,
    "hypot": lambda x, y: (x * x + y * y).sqrt(),
}


def meant(text: str, x: float) -> float:
    # digits enough for an exponential beside 1: exp(-x) begins at the 0.43 x-th
    with localcontext(Context(prec=40 + int(abs(x)) // 2, Emax=10**6, Emin=-(10**6))):
        exact = re.sub(r"(?<![a-z\d.])([\d.]+(e-?\d+)?)", r"Decimal('\1')", text.replace("^", "**"))
        found = eval(exact, {**NAMED, "Decimal": Decimal, "x": Decimal(x)})
        return float(found)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("text", FORMS)
def test_a_form_has_its_value_wherever_that_is_a_number(text: str) -> None:
    """As closures, on arrays, as instructions, and as pairs, of which guards are made."""
    e = parse(text)
    of_one = compile_expression(e, {"x": 0}, pre_offset=1)
    on_arrays = compile_expression(e, {"x": 0}, ARRAYS, pre_offset=1)([np.array(AT)])
    code = Code({"x": 0}, 1)
    plain, paired = code.add(e, paired=False), code.add(e, paired=True)
    for x, on_array in zip(AT, np.broadcast_to(on_arrays, len(AT)), strict=True):
        s = make_stack()
        s.now, s.was, s.jump, s.terms = [x], [x], [0.0], [abs(x)]
        s.prior_terms = s.terms
        clear(s)
        run_pair_code(code.instructions, paired, code.numbers, s)
        as_numbers = run_code(code.instructions, plain, code.numbers, [x, x], [0.0] * DEEPEST)
        near = {"rel": 1e-12, "abs": 4e-16 if text.startswith("log") or "exp" in text else 1e-300}
        for found in (of_one([x]), on_array, as_numbers, s.finite[s.top]):
            assert float(found) == pytest.approx(meant(text, x), **near), x
        assert s.refused == 0


@pytest.mark.parametrize(
    ("text", "at", "value"),
    [
        # the root of a square has no sign, and the larger of two is not lost beside the other
        ("exp(x)/((exp(x) - 3)^2)^0.5", 0.0, 0.5),
        ("cosh(x)/(sinh(x)^2)^0.5", -1.0, 1.0 / np.tanh(1.0)),
        ("exp(x)/((1 - exp(x))^2)^1.5", 1.0, np.e / (np.e - 1.0) ** 3),
        ("exp(x)/((1 - exp(x))^2)^1.5", -1.0, np.exp(-1.0) / (1.0 - np.exp(-1.0)) ** 3),
        # what is nearly taken off keeps its digits and its sign under roots and in powers
        ("sqrt(cosh(x) - 1)", 1e-9, 0.0),
        ("sqrt(cosh(x) - cosh(x))", 1.0, 0.0),
        ("exp(x)*(1 - exp(-x))^2/(1 + exp(x))", 1e-5, 5e-11),
        ("sinh(x)^3/(1 + cosh(x)^2)^1.5", -1000.0, -1.0),
        ("sinh(x)^3/cosh(x)^2/sinh(-x)", -900.0, -1.0),
        ("log(exp(1e200*x) + exp(3))", -0.95, 3.0),
        ("log(exp(3) + exp(1e200*x))", -0.95, 3.0),
        ("1e-12*log(exp(x/1e-12) + exp(1e-4))", -1.0, 1e-16),
        ("log(exp(x) + exp(x^2))", 40.0, 1600.0),
        ("log(exp(x) + exp(x^2))", 1.0, 1.0 + np.log(2.0)),
    ],
)
def test_another_form_is_of_the_same_value(text: str, at: float, value: float) -> None:
    of_one = compile_expression(parse(text), {"x": 0}, pre_offset=1)
    assert float(of_one([at])) == pytest.approx(value, rel=1e-13)


def test_what_is_beyond_all_numbers_is_more_than_one_that_is_not() -> None:
    code = Code({"x": 0}, 1)
    for text, holds in (
        ("exp(x) > 5", True),
        ("-cosh(x) < -5", True),
        ("exp(x) <= 5", False),
        ("exp(-x) < 5", True),
        ("1/(x - x) > 5", False),  # no value, not a large one
    ):
        s = make_stack()
        s.now, s.was, s.jump, s.terms = [800.0], [800.0], [0.0], [800.0]
        s.prior_terms = s.terms
        clear(s)
        run_pair_code(code.instructions, code.add(parse(text), paired=True), code.numbers, s)
        assert (s.finite[s.top] != 0.0) is holds, text


@pytest.mark.parametrize(
    "text",
    [
        *("exp(x) - 1", "1 - exp(-x)", "-1 + exp(2*x)", "3*exp(x/2) - 3", "0.5 - exp(x)*0.5"),
        *("log(1 + x)", "log(3*x + 1)", "log(1 - x)", "(exp(x) - 1)/(exp(x) + 1)"),
        *(
            "exp(x)/(exp(2*x) - 1)",
            "(1 - exp(-x))/cosh(x)",
            "x/(exp(x) - 1)",
            "log(1 + x^2)",
            "log10(1 - x)",
        ),
    ],
)
def test_what_is_left_of_a_1_has_its_own_digits(text: str) -> None:
    """The law of a diode at rest is worth more than the rounding of its 1."""
    e = parse(text)
    of_one = compile_expression(e, {"x": 0}, pre_offset=1)
    on_arrays = compile_expression(e, {"x": 0}, ARRAYS, pre_offset=1)
    code = Code({"x": 0}, 1)
    plain = code.add(e, paired=False)
    for x in (1e-14, -1e-13, 3e-9, -2e-5, 0.1, -0.3):
        as_numbers = run_code(code.instructions, plain, code.numbers, [x, x], [0.0] * DEEPEST)
        for found in (of_one([x]), on_arrays([np.array([x])])[0], as_numbers):
            assert float(found) == pytest.approx(meant(text, x), rel=4e-15, abs=0.0), x


def test_what_has_no_logarithm_beside_1_has_none() -> None:
    of_one = compile_expression(parse("log(1 + x)"), {"x": 0}, pre_offset=1)
    code = Code({"x": 0}, 1)
    plain = code.add(parse("log(1 + x)"), paired=False)
    for x, value in ((-1.0, -np.inf), (-2.0, np.nan), (np.inf, np.inf)):
        as_numbers = run_code(code.instructions, plain, code.numbers, [x, x], [0.0] * DEEPEST)
        assert of_one([x]) == pytest.approx(value, nan_ok=True)
        assert as_numbers == pytest.approx(value, nan_ok=True)
