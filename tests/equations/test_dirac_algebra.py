"""Signals with an impulse part: order is lexicographic, other arithmetic is refused."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.engine.expressions.code import run_pair_code
from hybond.engine.expressions.pairs import Stack, clear, make_stack
from hybond.engine.tables.code import Code
from hybond.model.expressions import parse

NUMBERS = st.integers(-4, 4).map(float)
SLOT = {"a": 0, "b": 1, "c": 2}
Pair = tuple[float, float, float]
"""Finite part, impulse, and what it was before."""
SOME = settings(max_examples=60, derandomize=True, database=None)


def pair(finite: float, impulse: float, before: float | None = None) -> Pair:
    return (finite, impulse, finite if before is None else before)


def evaluated(text: str, *pairs: Pair) -> Stack:
    """Return the stack with what an expression of a, b and c makes of pairs on top."""
    code = Code(SLOT, len(SLOT))
    begin = code.add(parse(text), paired=True)
    s = make_stack()
    s.now, s.jump, s.was = ([p[k] for p in pairs] for k in range(3))
    s.was_first, s.jumps = 0, True
    s.terms = [abs(p[0]) for p in pairs]
    s.prior_terms = s.terms
    clear(s)
    run_pair_code(code.instructions, begin, code.numbers, s)
    return s


def key(text: str, *pairs: Pair) -> tuple[float, float]:
    """Return impulse and finite part: by these pairs are in order."""
    s = evaluated(text, *pairs)
    assert not s.refused
    return s.impulse[s.top], s.finite[s.top]


def order(p: Pair) -> tuple[float, float]:
    return p[1], p[0]


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
@SOME
def test_order_is_lexicographic(a, b, c, d) -> None:
    x, y = pair(a, b), pair(c, d)
    for word, holds in (
        ("<", order(x) < order(y)),
        ("<=", order(x) <= order(y)),
        (">", order(x) > order(y)),
        (">=", order(x) >= order(y)),
        ("==", order(x) == order(y)),
        ("!=", order(x) != order(y)),
    ):
        assert key(f"a {word} b", x, y) == (0.0, float(holds))
    assert key("min(a, b)", x, y) == min(order(x), order(y))
    assert key("max(a, b)", x, y) == max(order(x), order(y))
    assert key("abs(a)", x) == max(order(x), (-b, -a))
    assert key("sign(a)", x) == (0.0, (order(x) > (0, 0)) - (order(x) < (0, 0)))


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
@SOME
def test_pairs_are_a_vector_space(a, b, c, d, k) -> None:
    x, y, factor = pair(a, b), pair(c, d), pair(k, 0.0)
    assert key("c*a - b", x, y, factor) == (k * b - d, k * a - c)
    if k:
        assert key("a/c", x, y, factor) == (b / k, a / k)


def test_three_way_min_and_max() -> None:
    parts = [pair(5.0, -1.0), pair(-9.0, 1.0), pair(0.0, 0.0)]
    assert key("min(a, b, c)", *parts) == (-1.0, 5.0)
    assert key("max(a, b, c)", *parts) == (1.0, -9.0)


def test_rounding_of_an_impulse_does_not_hide_the_finite_part() -> None:
    """Two impulses that cancel but for the last bit are none."""
    one, other = pair(1.0, 1.0), pair(2.0, 1.0 - 2**-53)
    assert key("a - b > 0", one, other) == (0.0, 0.0)
    assert key("a - b < 0", one, other) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("a*b", (pair(0, 1), pair(0, 1))),
        ("a*b", (pair(0, 1), pair(1, 0, before=2))),
        ("a*b", (pair(1, 0, before=2), pair(0, 1))),
        ("a/b", (pair(1, 0), pair(0, 1))),
        ("a/b", (pair(0, 1), pair(1, 0, before=2))),
        ("a^2", (pair(0, 1),)),
        ("2^a", (pair(0, 1),)),
        ("sin(a)", (pair(0, 1),)),
        ("sqrt(a)", (pair(4, 1),)),
        ("atan2(a, b)", (pair(1, 0), pair(4, 1))),
    ],
)
def test_meaningless_operations_are_refused(text, pairs) -> None:
    assert evaluated(text, *pairs).refused


def test_what_keeps_its_meaning() -> None:
    assert key("a*b", pair(2, 1), pair(3, 0)) == (3, 6)
    # a jump of the factor does not matter where there is no impulse
    assert key("a*b", pair(2, 0), pair(3, 0, before=5)) == (0, 6)
    assert key("a*0", pair(2, 1)) == (0, 0)
    assert key("a^1", pair(2, 1)) == (1, 2)
    assert key("sin(a)", pair(1, 0)) == (0, math.sin(1))
    assert key("pre(a)", pair(2, 1, before=7)) == (0, 7)


def inelastic(guard: str, *, extra=None) -> hb.Model:
    """Two masses become one at t = 1: the joint's effort is an impulse of 1 N s."""
    m = hb.Model("inelastic")
    m.add(a=hb.I(2.0, f=1.0), b=hb.I(2.0), v=hb.One(), w=hb.One(), j=hb.Zero())
    m.bond("v -> a", "w -> b", "v -> j -> w")
    m.machine(
        "lock",
        states={"free": [], "shut": ["j"]},
        start="free",
        rules=["free -> shut when time >= 1"],
    )
    m.machine("see", states={"no": [], "yes": []}, start="no", rules=[f"no -> yes when {guard}"])
    m.signal(**(extra or {}))
    return m


@pytest.mark.parametrize(
    ("guard", "seen"),
    [
        ("j.e > 1e9", True),  # an impulse is larger than any force
        ("j.e < -1e9", False),
        ("abs(j.e) > 5 + 0.5*b.p", True),
        ("-j.e < -1e9", True),
        ("min(j.e, 3) > 2.9", True),
        ("max(-j.e, 3) > 3.1", False),
        ("b.e - j.e > 1e-9", False),  # equal impulses cancel
        ("2*j.e > 1.5*b.e", True),
        ("pre(a.f)*j.e > 1e9", True),
        ("pre(j.e) > 0", False),
    ],
)
def test_guards_on_an_impulse(guard, seen) -> None:
    run = hb.simulate(inelastic(guard), until=2.0)
    assert run.mode["see"] == ("yes" if seen else "no")


@pytest.mark.parametrize(
    "guard",
    ["j.e*j.e > 1", "a.f*j.e > 1", "1/j.e > 1", "sin(j.e) > 2", "j.e^2 > 1", "sqrt(abs(j.e)) > 1"],
)
def test_guards_without_meaning_are_refused(guard) -> None:
    with pytest.raises(hb.ModelError) as caught:
        hb.simulate(inelastic(guard), until=2.0)
    assert caught.value.code == "HB-J101"
    assert guard in str(caught.value)
    assert "see" in caught.value.where
    assert "t = 1" in caught.value.where


def test_integrated_impulse_is_its_area() -> None:
    run = hb.simulate(
        inelastic("j.e > 1e9", extra={"s": hb.Integral("3*j.e", start=0.5)}), until=2.0
    )
    assert math.isclose(run["s"].at(1.5), 0.5 + 3 * 1.0, rel_tol=1e-12)
    assert math.isclose(run["s"].at(0.5), 0.5, rel_tol=1e-12)
