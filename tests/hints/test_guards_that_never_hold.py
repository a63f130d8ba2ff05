"""Guards that never hold, by their form (HB-H111). Oracle: guards tried at many random values."""

from __future__ import annotations

import random

import pytest

import hybond as hb
from hybond.hints.never import never_holds
from hybond.model.expressions import compile_expression, parse
from hybond.model.expressions.bounds import bounds_of
from hybond.model.expressions.tree import names

NEVER = [
    "abs(x) < 0",
    "2*sin(x) > 3",
    "x^2 + 1 <= 0",
    "x*x < 0",
    "-abs(x) > 0",
    "tanh(x) - 2 >= 0",
    "abs(x)/4 < -1",
    "1 > 2",
    "x > 0 and sqrt(abs(y)) < 0",
    "abs(x) < 0 or exp(y) < -1",
    "3 - cos(y)*(-2) < 1",
]
MAY = [
    "abs(x) <= 0.5",
    "2*sin(x) > 1",
    "x^3 < 0",
    "x*y < 0",
    "abs(x) > 0 or abs(x) < 0",
    "tanh(x) > 0.5",
    "not (abs(x) < 0)",
    "x < y",
]


@pytest.mark.parametrize("text", [*NEVER, *MAY])
def test_it_is_never_where_no_values_make_it_true(text: str) -> None:
    guard = parse(text)
    read = sorted(names(guard))
    at = compile_expression(guard, {name: k for k, name in enumerate(read)}, pre_offset=0)
    dice = random.Random(7)
    tried = [at([dice.gauss(0.0, 10.0 ** dice.uniform(-3, 1)) for _ in read]) for _ in range(400)]
    assert any(tried) == (text in MAY)
    assert never_holds(guard) == (text in NEVER)


BOUNDED = ["2 - 3*tanh(x)", "abs(x)*2 + cos(y)", "-(x^2)/4", "sign(x)*-3"]
BOUNDED += ["sqrt(sqrt(x^2 + 4))", "max(sin(x), 0.5)", "min(x^2 + 1, cosh(y) + 2)"]
BOUNDED += ["(x^2 + 2)*(abs(y) + 3)", "(x^2 + 2)/(abs(y) + 3)", "max(x, 1)*max(-y, 0)"]


@pytest.mark.sampled(10)
@pytest.mark.parametrize("text", BOUNDED)
def test_no_value_is_beyond_its_bounds(text: str) -> None:
    e = parse(text)
    low, high = bounds_of(e)
    at = compile_expression(e, {"x": 0, "y": 1}, pre_offset=0)
    dice = random.Random(3)
    values = [at([dice.gauss(0.0, 5.0), dice.gauss(0.0, 5.0)]) for _ in range(300)]
    assert low <= min(values) and max(values) <= high and low < high


def test_a_machine_with_such_a_guard_is_hinted_at() -> None:
    m = hb.Model("switch", domain="electrical")
    m.add(V=hb.Se("10 V"), R=hb.R("1 ohm"), n=hb.One())
    m.bond("V -> n -> R")
    rules = ["on -> off when abs(n.f) < 0 A", "off -> on when time > 1 s"]
    m.machine("s", states={"on": ["n"], "off": []}, start="on", rules=rules)
    found = [h for h in m.check().hints if h.code == "HB-H111"]
    assert [h.where for h in found] == ["machines.s"] and "abs(n.f) < 0 A" in found[0].why
