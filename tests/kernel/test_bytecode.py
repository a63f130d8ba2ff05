"""Expressions in the kernel give what the reference gives."""

import ctypes
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
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
from hybond.modes.dirac import DIRAC, Pairs

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


@pytest.mark.slow
@given(trees(), st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6))
@settings(max_examples=500, deadline=None)
def test_the_kernel_gives_what_the_reference_gives(kernel, tree, v):
    want = float(compile_expression(tree, SLOT, pre_offset=3)(v))
    got = evaluated(kernel, tree, v)
    if math.isnan(want):
        assert math.isnan(got)
    else:
        # functions of the C library may differ from Python's in the last place
        assert got == want or got == pytest.approx(want, rel=1e-12)


SIGNS = st.sampled_from(["<", "<=", ">", ">=", "==", "!="])


def quantities():
    """Return expressions that are numbers: what a guard may compare."""
    number = st.sampled_from([-1.0, 0.0, 1.0, 2.0, 0.5]).map(Number)
    name = st.sampled_from(["x", "y", "z"]).map(Name)

    def grow(inner):
        calls = [
            st.builds(Call, st.just(f), st.lists(inner, min_size=low, max_size=most).map(tuple))
            for f, (low, most) in ((f, (a, min(b, 3))) for f, (a, b) in FUNCTIONS.items())
        ]
        arithmetic = st.builds(Binary, st.sampled_from("+-*/^"), inner, inner)
        chosen = st.builds(If, st.builds(Compare, SIGNS, inner, inner), inner, inner)
        return st.builds(Neg, inner) | arithmetic | st.one_of(calls) | chosen

    leaf = number | name | name.map(Pre) | st.sampled_from(TABLES)
    return st.recursive(leaf, grow, max_leaves=5)


def guards():
    """Return truths of numbers: what a guard may be."""
    compared = st.builds(Compare, SIGNS, quantities(), quantities())

    def join(inner):
        several = st.lists(inner, min_size=2, max_size=3).map(tuple)
        return st.builds(And, several) | st.builds(Or, several) | st.builds(Not, inner)

    return st.recursive(compared, join, max_leaves=4)


class Signals(ctypes.Structure):
    """`hb_signals`."""

    _fields_ = (
        *((name, ctypes.c_void_p) for name in ("finite", "before", "impulse", "size")),
        ("slots", ctypes.c_int32),
    )


class Five(ctypes.Structure):
    """`hb_pair`."""

    _fields_ = tuple(
        (name, ctypes.c_double) for name in ("finite", "impulse", "before", "size", "impulse_size")
    )


NUMBERS = st.sampled_from([-1.0, 0.0, 1e-14, 1.0, 1.0 + 1e-14, 2.5])
THREE = st.lists(NUMBERS, min_size=3, max_size=3)


def paired(kernel, tree, given):
    """Return what the kernel makes of an expression of signals, None if it has no meaning."""
    book = Book(SLOT, pre_offset=3)
    place = book.add(tree)
    code, constants = book.arrays()
    arrays = [np.array(a, dtype=float) for a in given]
    signals = Signals(*(a.ctypes.data for a in arrays), 3)
    result = Five()
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (code[place:], constants)]
    if not kernel.hb_paired(*pointers, ctypes.byref(signals), ctypes.byref(result)):
        return None
    return result


@pytest.mark.slow
@given(
    guards(),
    THREE,
    THREE,
    st.lists(st.sampled_from([0.0, 0.0, -1.0, 1e-14, 3.0]), min_size=3, max_size=3),
    st.lists(st.sampled_from([0.0, 1.0, 1e3]), min_size=3, max_size=3),
)
@settings(max_examples=500, deadline=None)
def test_guards_hold_as_settling_asks_them(kernel, tree, now, before, impulse, more):
    size = [abs(a) + b for a, b in zip(now, more, strict=True)]
    pairs = Pairs(now, before, impulse, size)
    try:
        want = bool(compile_expression(tree, SLOT, DIRAC, pre_offset=3)(pairs))
    except hb.ModelError:
        want = None
    got = paired(kernel, tree, (now, before, impulse, size))
    assert (None if got is None else got.finite != 0.0) == want


@pytest.mark.slow
@given(
    quantities(), THREE, THREE, st.lists(st.sampled_from([0.0, 1.0, -2.0]), min_size=3, max_size=3)
)
@settings(max_examples=500, deadline=None)
def test_expressions_of_impulses(kernel, tree, now, before, impulse):
    size = [abs(a) for a in now]
    try:
        want = compile_expression(tree, SLOT, DIRAC, pre_offset=3)(
            Pairs(now, before, impulse, size)
        )
    except hb.ModelError:
        want = None
    got = paired(kernel, tree, (now, before, impulse, size))
    if want is None:
        assert got is None
        return
    for name in ("finite", "impulse", "before", "size", "impulse_size"):
        a, b = getattr(got, name), getattr(want, name)
        assert a == b or a == pytest.approx(b, rel=1e-12, nan_ok=True), name


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
