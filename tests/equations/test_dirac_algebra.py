"""Signals with an impulse part: order is lexicographic, other arithmetic is refused."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.modes.dirac import DIRAC, Pair, still

NUMBERS = st.integers(-4, 4).map(float)


def pair(finite: float, impulse: float, before: float | None = None) -> Pair:
    return Pair(finite, impulse, finite if before is None else before, abs(finite), abs(impulse))


def key(p: Pair) -> tuple[float, float]:
    return p.impulse, p.finite


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
@settings(derandomize=True, database=None)
def test_order_is_lexicographic(a, b, c, d) -> None:
    x, y = pair(a, b), pair(c, d)
    assert DIRAC.compare("<")(x, y) == (key(x) < key(y))
    assert DIRAC.compare("<=")(x, y) == (key(x) <= key(y))
    assert DIRAC.compare(">")(x, y) == (key(x) > key(y))
    assert DIRAC.compare(">=")(x, y) == (key(x) >= key(y))
    assert key(DIRAC.call["min"](x, y)) == min(key(x), key(y))
    assert key(DIRAC.call["max"](x, y)) == max(key(x), key(y))
    assert key(DIRAC.call["abs"](x)) == max(key(x), (-b, -a))
    assert DIRAC.call["sign"](x).finite == (key(x) > (0, 0)) - (key(x) < (0, 0))


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
@settings(derandomize=True, database=None)
def test_pairs_are_a_vector_space(a, b, c, d, k) -> None:
    x, y = pair(a, b), pair(c, d)
    total = DIRAC.add(DIRAC.mul(still(k), x), DIRAC.neg(y))
    assert key(total) == (k * b - d, k * a - c)
    if k:
        assert key(DIRAC.div(x, still(k))) == (b / k, a / k)


def test_three_way_min_and_max() -> None:
    parts = [pair(5.0, -1.0), pair(-9.0, 1.0), pair(0.0, 0.0)]
    assert DIRAC.call["min"](*parts) is parts[0]
    assert key(DIRAC.call["max"](*parts)) == (1.0, -9.0)


def test_rounding_of_an_impulse_does_not_hide_the_finite_part() -> None:
    p = Pair(1.0, 1e-16, 1.0, 1.0, 1.0)
    assert not p.impulsive
    assert p.sign == 1
    assert DIRAC.sub(p, still(2.0)).sign == -1


MEANINGLESS = {
    "product of impulses": lambda: DIRAC.mul(pair(0, 1), pair(0, 1)),
    "factor that jumps": lambda: DIRAC.mul(pair(0, 1), pair(1, 0, before=2)),
    "factor that jumps, turned": lambda: DIRAC.mul(pair(1, 0, before=2), pair(0, 1)),
    "division by an impulse": lambda: DIRAC.div(still(1), pair(0, 1)),
    "division by what jumps": lambda: DIRAC.div(pair(0, 1), pair(1, 0, before=2)),
    "power": lambda: DIRAC.pow(pair(0, 1), still(2)),
    "exponent": lambda: DIRAC.pow(still(2), pair(0, 1)),
    "sin": lambda: DIRAC.call["sin"](pair(0, 1)),
    "sqrt": lambda: DIRAC.call["sqrt"](pair(4, 1)),
    "table": lambda: DIRAC.table((0.0, 1.0), (0.0, 1.0), "hold")(pair(0, 1)),
}


@pytest.mark.parametrize("what", MEANINGLESS)
def test_meaningless_operations_are_refused(what) -> None:
    with pytest.raises(hb.ModelError) as caught:
        MEANINGLESS[what]()
    assert caught.value.code == "HB-J101"


def test_what_keeps_its_meaning() -> None:
    assert key(DIRAC.mul(pair(2, 1), pair(3, 0))) == (3, 6)
    # a jump of the factor does not matter where there is no impulse
    assert DIRAC.mul(pair(2, 0), pair(3, 0, before=5)).finite == 6
    assert key(DIRAC.mul(pair(2, 1), still(0))) == (0, 0)
    assert key(DIRAC.pow(pair(2, 1), still(1))) == (1, 2)
    assert math.isclose(DIRAC.call["sin"](pair(1, 0)).finite, math.sin(1))


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
