"""Expressions in the kernel give what the reference gives."""

import ctypes
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.kernel.build import SOURCES
from hybond.kernel.bytecode import CODE, DEPTH, OPERATIONS, Book, Declined
from hybond.model.expressions import (
    FUNCTIONS,
    And,
    Binary,
    Call,
    Compare,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    Table,
    compile_expression,
)

SLOT = {"x": 0, "y": 1, "z": 2}
TABLES = [
    Table(Name("x"), (-1.0, 0.0, 2.0), (3.0, -1.0, 5.0), how, slope)
    for how in ("linear", "error")
    for slope in (False, True)
]


def evaluated(kernel, e, v):
    book = Book(SLOT, pre_offset=3)
    place = book.add(e)
    code, constants = book.arrays()
    values = np.array(v, dtype=float)
    f = kernel.hb_evaluate
    f.restype = ctypes.c_double
    pointer = [a.ctypes.data_as(ctypes.c_void_p) for a in (code[place:], constants, values)]
    return f(*pointer)


def trees():
    number = st.floats(-1e3, 1e3).map(Number) | st.sampled_from([Number(0.0), Number(2.0)])
    name = st.sampled_from(["x", "y", "z"]).map(Name)
    leaf = number | name | name.map(Pre) | st.sampled_from(TABLES)

    def grow(inner):
        truth = st.builds(
            Compare, st.sampled_from(["<", "<=", ">", ">=", "==", "!="]), inner, inner
        )
        several = st.lists(truth | inner, min_size=2, max_size=4).map(tuple)
        truth |= st.builds(And, several) | st.builds(Or, several) | st.builds(Not, truth)
        calls = [
            st.builds(Call, st.just(f), st.lists(inner, min_size=low, max_size=most).map(tuple))
            for f, (low, most) in ((f, (a, min(b, 4))) for f, (a, b) in FUNCTIONS.items())
        ]
        return (
            st.builds(Neg, inner)
            | st.builds(Binary, st.sampled_from("+-*/^"), inner, inner)
            | st.builds(If, truth, inner, inner)
            | st.one_of(calls)
            | truth
        )

    return st.recursive(leaf, grow, max_leaves=14)


@given(trees(), st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6))
@settings(max_examples=1500, deadline=None)
def test_the_kernel_gives_what_the_reference_gives(kernel, tree, v):
    want = float(compile_expression(tree, SLOT, pre_offset=3)(v))
    got = evaluated(kernel, tree, v)
    if math.isnan(want):
        assert math.isnan(got)
    else:
        # functions of the C library may differ from Python's in the last place
        assert got == want or got == pytest.approx(want, rel=1e-12)


@pytest.mark.parametrize("value", [-2.0, -1.0, -0.5, 0.0, 1.0, 2.0, 3.0, math.nan])
@pytest.mark.parametrize("table", TABLES, ids=lambda t: f"{t.extrapolate}, slope {t.slope}")
def test_tables_at_their_points_and_beyond(kernel, table, value):
    want = compile_expression(table, SLOT, pre_offset=3)([value])
    got = evaluated(kernel, table, [value] + [0.0] * 5)
    assert got == want or (math.isnan(got) and math.isnan(want))


def test_a_deep_expression_is_declined():
    deep = Name("x")
    for _ in range(DEPTH + 1):
        deep = Binary("+", Number(1.0), deep)
    with pytest.raises(Declined):
        Book(SLOT, pre_offset=3).add(deep)


def test_a_long_sum_is_not_deep(kernel):
    long = Name("x")
    for _ in range(2999):
        long = Binary("+", long, Name("x"))
    assert evaluated(kernel, long, [0.5] + [0.0] * 5) == 1500.0


def test_the_instructions_stand_in_the_order_of_the_header():
    header = (SOURCES / "hybond.h").read_text()
    body = header[header.index("enum hb_op {") :]
    listed = body[body.index("{") + 1 : body.index("}")].replace("\n", " ").split(",")
    assert [name.strip() for name in listed] == [f"HB_{name.upper()}" for name in OPERATIONS]
    assert len(CODE) == len(OPERATIONS)
