"""Numbers that are expressions of parameters, against the same sums done plainly."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb
from hybond.engine.tables import tables_of, written_tables
from hybond.model.expressions import (
    Name,
    Number,
    compile_expression,
    differentiate,
    parse,
    simplify,
    substitute,
)
from hybond.model.expressions.slots import Slots, Slotted
from hybond.model.flatten import flatten
from hybond.model.written import Writing, Written

VALUES = {"a": 3.0, "b": 0.7, "n": 2.0, "same": 3.0}
OTHERS = {"a": -1.25, "b": 5.5, "n": 3.0, "same": 2.0}


def followed(values: dict[str, float]) -> tuple[Slots, dict[str, Number]]:
    slots = Slots(values)
    return slots, {k: slots.follow(k, Number(v)) for k, v in values.items()}


def at(tree: object, values: dict[str, float]) -> float:
    slots = {f"p:{k}": i for i, k in enumerate(values)}
    found: float = compile_expression(tree, slots, pre_offset=0)(list(values.values()))  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize(
    "text",
    [
        "a + b*2 - b/a",
        "-(a - b)*1 + 0",
        "a^n + 2^b",
        "sin(a) + sqrt(abs(b)) + atan2(a, b)",
        "min(a, b, 2) + max(a*b, 1) + mod(7, n)",
        "hypot(a, b)*sign(a)",
        "a - a + same*b",
    ],
)
def test_a_number_is_what_its_expression_gives(text: str) -> None:
    """The value is that of plain numbers, to the last bit; with others it is theirs."""
    _, numbers = followed(VALUES)
    found = simplify(substitute(parse(text), numbers))
    assert isinstance(found, Number)
    assert isinstance(found.value, Slotted)
    for values in (VALUES, OTHERS):
        plain = simplify(substitute(parse(text), {k: Number(v) for k, v in values.items()}))
        assert isinstance(plain, Number)
        assert at(found.value.tree, values) == plain.value
        if values is VALUES:
            assert found.value.value == plain.value


def test_python_sums_are_followed() -> None:
    _, numbers = followed(VALUES)
    a, b = numbers["a"].value, numbers["b"].value
    found = (2.0 - a) / b + abs(-a) ** 2 - 1.0 / b
    plain = (2.0 - 3.0) / 0.7 + abs(-3.0) ** 2 - 1.0 / 0.7
    assert found.value == plain
    assert at(found.tree, OTHERS) == (2.0 + 1.25) / 5.5 + 1.25**2 - 1.0 / 5.5


def test_equal_values_are_kept_apart() -> None:
    """Two parameters, or a parameter and a number, of one value do not merge."""
    _, numbers = followed(VALUES)
    a, same = numbers["a"], numbers["same"]
    assert a != same
    assert len({a, same, Number(3.0)}) == 3
    assert a == Number(numbers["a"].value)
    assert len({a, Number(numbers["a"].value)}) == 1


def test_what_is_asked_is_written_down() -> None:
    slots, numbers = followed(VALUES)
    a, b = numbers["a"].value, numbers["b"].value
    assert a > 1.0
    assert not a < b
    assert b
    assert a == 3.0
    assert not a <= 0.0
    said = {str(e) for e in slots.conditions}
    assert said == {"p:a > 1", "p:b != 0", "p:a >= p:b", "p:a == 3", "p:a > 0"}


def test_neutral_terms_are_kept() -> None:
    """What may be changed is kept where it is 0 or 1: the product with 1 has the same bits."""
    slots, numbers = followed({"one": 1.0, "zero": 0.0})
    tree = simplify(substitute(parse("one*x + zero"), numbers))
    assert str(differentiate(tree, "x")) == "1"
    assert [str(e) for e in slots.conditions] == ["p:one != 0"]
    assert compile_expression(tree, {"x": 0}, pre_offset=0)([math.pi]) == math.pi


def test_a_product_with_zero_is_part_of_the_model() -> None:
    slots, numbers = followed({"zero": 0.0})
    assert simplify(substitute(parse("zero*x"), numbers)) == Number(0.0)
    assert [str(e) for e in slots.conditions] == ["p:zero == 0"]


def test_a_parameter_made_of_others_says_so() -> None:
    m = hb.Model("rc", domain="electrical")
    m.parameter(R="5 ohm", tau="R*C", C="1 mF")
    m.add(c=hb.C("tau/R"), r=hb.R("R"))
    m.bond("c -> r")
    slots = Slots(["R", "C", "tau"])
    graph = flatten(m, {}, slots)
    assert list(slots.parameters) == ["R", "C", "tau"]
    made_of = slots.parameters["tau"].made_of
    assert made_of is not None
    assert str(made_of) == "p:R*p:C"
    law = graph.nodes[graph.by_path["c"]].law
    assert law is not None
    assert law.matrix is not None
    (row,) = law.matrix
    assert isinstance(row[0], Slotted)
    assert at(row[0].tree, {"R": 2.0, "tau": 8.0}) == 0.25


PARTS = [*hb.library.names()]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", PARTS)
def test_tables_of_a_part_follow_each_of_its_parameters(name: str) -> None:
    """Numbers written into tables are those of tables made anew, where these have one shape."""
    model = hb.library.part(name)
    values = {k: v for k, v in model.flatten().parameters.items() if isinstance(v, float)}
    slots = Slots()
    graph = flatten(model, {}, slots)
    options = {"until": 1.0, "solver": "exact", "calling": True}
    tables = tables_of(graph, **options)
    writing = Writing(slots)
    for path, value in values.items():
        row = writing.row({path: 1.17 * value + 0.1 * (value == 0.0)})
        if row is None:
            continue
        written = Written(graph, writing, row)
        found = written_tables(tables, written.put(graph), written)
        given = dict(zip(slots.parameters, row, strict=True))
        plain = tables_of(flatten(model, {path: given[path]}), **options)
        for column, numbers in plain.floats.items():
            # expressions that are one by chance are merged; numbers have columns of their own
            if len(found.floats[column]) == len(numbers) and found.ints == plain.ints:
                assert found.floats[column] == numbers, (path, column)


@pytest.mark.parametrize("text", ["log(a/b + 1)", "exp(b) - 1", "sqrt(a^2 + b^2)", "log(cosh(b))"])
def test_what_is_written_into_a_slot_is_what_the_file_with_that_number_gives(text: str) -> None:
    """To the last bit, in numbers and in arrays: log1p and hypot are other numbers."""
    model = hb.Model("m")
    model.parameter(a=1e3, b=0.1, c=text)
    model.add(s=hb.Se("c"), r=hb.R(1))
    model.bond("s -> r")
    slots = Slots()
    flatten(model, {}, slots)
    given = np.linspace(1e-3, 1.1, 200)
    fits, found = Writing(slots, [Name("p:c")]).of({"b": given}, len(given))
    assert fits.all()
    for b, value in zip(given.tolist(), found[:, 0].tolist(), strict=True):
        assert value == flatten(model, {"b": b}).parameters["c"]


def test_a_plain_number_is_never_made_unseen() -> None:
    """Whoever wants one has it written down: functions, arrays of NumPy, whole numbers."""
    for wants in (math.sin, np.float64, int, lambda x: np.array([x], dtype=float), complex):
        slots, numbers = followed({"a": 3.0, "b": 2.0})
        wants(numbers["a"].value)
        assert [str(e) for e in slots.conditions] == ["p:a == 3"]
        assert list(slots.fixed) == ["a"]
    slots, numbers = followed({"a": 3.0})
    total = np.float64(2.0) * numbers["a"].value + np.array(1.0)[()]
    assert isinstance(total, Slotted) and str(total.tree) == "2*p:a + 1"
    assert not slots.conditions
