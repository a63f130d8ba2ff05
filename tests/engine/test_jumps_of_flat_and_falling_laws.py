"""Jumps of what is stored where its law has no slope, or falls: roots by bisection, and by a flow.

What a mode leaves out between storages is a resistance that is next to nothing: it drives what is
stored to the first state at which nothing is missing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import permutations, product

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

FLAT: dict[str, Callable[[float], float]] = {
    "q^3": lambda q: q**3,
    "q^3/(1 + q^2)": lambda q: q**3 / (1 + q * q),
    "q^5": lambda q: q**5,
    "q*abs(q)": lambda q: q * abs(q),
    "sign(q)*abs(q)^1.5": lambda q: math.copysign(abs(q) ** 1.5, q),
}


def storage(law: str, start: float, *, dual: bool) -> hb.C | hb.I:
    if dual:
        return hb.I({"f": law.replace("q", "p")}, p=start)
    return hb.C({"e": law}, q=start)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", FLAT)
@pytest.mark.parametrize(("turned", "dual"), list(product([False, True], repeat=2)))
def test_a_source_fills_what_has_no_slope_at_zero(law: str, turned: bool, dual: bool) -> None:
    for level in (5.0, -5.0, 1e3, 1e-3):
        m = hb.Model("filled")
        m.add(x=storage(law, 0.0, dual=dual), V=hb.Sf(level) if dual else hb.Se(level))
        m.add(n=hb.One() if dual else hb.Zero())
        m.bond("n -> V" if turned else "V -> n", "n -> x")
        q = brentq(lambda x, level=level: FLAT[law](x) - level, -1e6, 1e6, xtol=1e-15)
        got = hb.simulate(m, 1e-3)["x.p" if dual else "x.q"].at(0.0)
        assert got == pytest.approx(q, rel=1e-9)


@pytest.mark.parametrize("laws", [("q^3", "q^3/(1 + q^2)"), ("q^5", "2*q"), ("q^3", "q^3")])
@pytest.mark.parametrize("turned", [False, True])
def test_charge_is_shared_from_where_a_law_has_no_slope(
    laws: tuple[str, str], turned: bool
) -> None:
    known = {**FLAT, "2*q": lambda q: 2 * q}
    one, other = (known[law] for law in laws)
    for order, starts in product(permutations(range(2)), [(0.0, 1.0), (0.0, -3.0), (2.0, 0.0)]):
        m = hb.Model("shared")
        for k in order:
            m.add(**{f"x{k}": storage(laws[k], starts[k], dual=False)})
        m.add(n=hb.Zero())
        m.bond("x0 -> n" if turned else "n -> x0", "n -> x1")
        total = sum(starts)
        q = brentq(lambda x, t=total: one(x) - other(t - x), -40.0, 40.0, xtol=1e-16)
        run = hb.simulate(m, 1e-3)
        assert run["x0.q"].at(0.0) == pytest.approx(q, rel=1e-8)
        assert run["x0.q"].at(0.0) + run["x1.q"].at(0.0) == pytest.approx(total, rel=1e-14)


@pytest.mark.parametrize("order", list(permutations(range(2))))
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("laws", [("q^3", "2*q^3"), ("q^3", "q^5"), ("q^3/(1 + q^2)", "q^3")])
def test_charges_that_cancel_leave_nothing_where_laws_have_no_slope(laws, turned, order) -> None:
    m = hb.Model("cancel")
    for k in order:
        m.add(**{f"x{k}": storage(laws[k], (1.0, -1.0)[k], dual=False)})
    m.add(n=hb.Zero())
    m.bond("x0 -> n" if turned else "n -> x0", "n -> x1")
    run = hb.simulate(m, 1e-3)
    assert run["x0.q"].at(0.0) == pytest.approx(0.0, abs=1e-15)
    assert run["x1.q"].at(0.0) == pytest.approx(0.0, abs=1e-15)


def test_what_is_nearly_gone_meets_the_law_of_the_other_to_its_own_digits() -> None:
    m = hb.Model("nearly")
    m.add(x0=hb.C({"e": "q^3"}, q=1.0), x1=hb.C({"e": "2*q"}, q=-0.999), n=hb.Zero())
    m.bond("n -> x0", "n -> x1")
    run = hb.simulate(m, 1e-3)
    q = brentq(lambda x: 2 * x - (1.0 - 0.999 - x) ** 3, -1.0, 1.0, xtol=1e-25, rtol=1e-14)
    assert run["x1.q"].at(0.0) == pytest.approx(q, rel=1e-8)


def falling(q: float) -> float:
    return q**3 - q


def led(rate: Callable[[list[float]], list[float]], start: list[float]) -> float:
    found = solve_ivp(lambda _, x: rate(x), (0, 400), start, "LSODA", rtol=1e-10, atol=1e-12)
    return float(found.y[0, -1])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("level", [0.1, -0.3, 0.38, 1.0])
@pytest.mark.parametrize("dual", [False, True])
def test_a_source_drives_what_is_stored_over_a_law_that_falls(level: float, dual: bool) -> None:
    for start in (0.0, 0.3, -0.57, 0.9, -1.2):
        m = hb.Model("driven")
        m.add(x=storage("q^3 - q", start, dual=dual), V=hb.Sf(level) if dual else hb.Se(level))
        m.add(n=hb.One() if dual else hb.Zero())
        m.bond("V -> n -> x")
        got = hb.simulate(m, 1e-3)["x.p" if dual else "x.q"].at(0.0)
        assert got == pytest.approx(led(lambda x: [level - falling(x[0])], [start]), rel=1e-6)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("size", "a", "b"),
    [(1.0, 0.0, 0.5), (1.0, 0.0, -0.5), (3.0, 0.2, 0.0), (10.0, 0.5, 0.1), (0.5, -1.2, 3.0)],
)
def test_charge_goes_over_a_law_that_falls(size: float, a: float, b: float, turned: bool) -> None:
    m = hb.Model("over")
    m.add(a=hb.C({"e": "q^3 - q"}, q=a), b=hb.C(size, q=b), n=hb.Zero())
    m.bond("a -> n" if turned else "n -> a", "n -> b")
    q = led(lambda x: [x[1] / size - falling(x[0]), falling(x[0]) - x[1] / size], [a, b])
    run = hb.simulate(m, 1e-3)
    assert run["a.q"].at(0.0) == pytest.approx(q, rel=1e-6)
    assert run["a.q"].at(0.0) + run["b.q"].at(0.0) == pytest.approx(a + b, abs=1e-14)
