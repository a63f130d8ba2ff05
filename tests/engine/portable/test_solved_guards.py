"""Guards that are polynomials of a step: their roots, and the instants that these are."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb
from hybond.engine.guards.quartic import make_quartic, solve_monotone, solve_quartic, turns

G = 9.81


def coefficients(factor: float, *roots: complex) -> list[float]:
    """Return ``x^0 ... x^4`` of a polynomial with these roots."""
    found = np.real(factor * np.poly(roots))[::-1]
    return [*found.tolist(), *[0.0] * (5 - len(found))]


@pytest.mark.parametrize(
    ("roots", "between"),
    [
        ((0.25,), (0.25,)),
        ((0.125, 0.75), (0.125, 0.75)),
        ((-3.0, 0.5, 1.5), (0.5,)),
        ((0.1, 0.2, 0.3, 0.9), (0.1, 0.2, 0.3, 0.9)),
        ((0.5, 0.5 + 1e-3, 7.0), (0.5, 0.5 + 1e-3)),
        ((0.4 + 0.1j, 0.4 - 0.1j, 0.8), (0.8,)),
        ((0.5, 0.5, 0.5), (0.5,)),
        ((2.0, 3.0), ()),
    ],
)
@pytest.mark.parametrize("factor", [1.0, -1e6])
def test_roots_of_a_quartic_are_those_it_was_made_of(roots, between, factor) -> None:
    q = make_quartic()
    solve_quartic(q, coefficients(factor, *roots), 0)
    assert q.root[: q.roots] == pytest.approx(between, abs=1e-5 if len(set(roots)) < 3 else 1e-12)


def test_a_quartic_turns_where_its_derivative_is_zero() -> None:
    q = make_quartic()
    solve_quartic(q, coefficients(3.0, 0.2, 0.6), 0)
    assert q.turn[: q.turns] == pytest.approx([0.4], abs=1e-12)


def test_one_that_does_not_turn_has_its_root_at_once() -> None:
    c = coefficients(2.0, 1.0 / 3.0, -1.0)
    q = make_quartic()
    assert not turns(c, 0) and turns(coefficients(1.0, 0.2, 0.6), 0)
    solve_monotone(q, c, 0)
    assert q.roots == 1 and q.root[0] == pytest.approx(1.0 / 3.0, abs=1e-15)


def thrown(speed: float, rule: str) -> hb.Model:
    """Return a body that is thrown upwards, and a machine that sees where it is."""
    m = hb.Model("thrown", domain="translational", parameters={"w": "1 m/s"})
    m.add(weight=hb.Se(-G), body=hb.I(1.0, p=speed), v=hb.One(), seen=hb.One())
    m.add(nothing=hb.Se(0.0), block=hb.R(1.0))
    m.bond("weight -> v -> body", "nothing -> seen -> block")
    m.signal(height=hb.Integral("v.f", start=0.0))
    m.machine("eye", states={"waits": [], "saw": ["seen"]}, start="waits", rules=[rule])
    return m


@pytest.mark.parametrize("solver", ["rk45", "exact", "radau"])
@pytest.mark.parametrize("wide", [1.0, 1e-3, 1e-9])
def test_a_window_between_two_comparisons_is_seen_on_the_way_up(wide: float, solver: str) -> None:
    """However narrow: the body is above 1 m first at the lesser root of its parabola."""
    m = thrown(10.0, f"waits -> saw when height >= 1 and height <= {1.0 + wide!r}")
    run = hb.simulate(m, until="1.5 s", solver=solver)
    first = (10.0 - math.sqrt(100.0 - 2.0 * G)) / G
    assert [e.t for e in run.events[1:]] == [pytest.approx(first, abs=1e-12)]


@pytest.mark.parametrize("solver", ["rk45", "exact"])
def test_what_holds_on_the_way_down_only_is_seen_there(solver: str) -> None:
    m = thrown(10.0, "waits -> saw when height <= 1 and v.f < 0")
    run = hb.simulate(m, until="3 s", solver=solver)
    last = (10.0 + math.sqrt(100.0 - 2.0 * G)) / G
    assert [e.t for e in run.events[1:]] == [pytest.approx(last, abs=1e-12)]


def test_a_line_of_time_and_an_input_is_a_polynomial_too() -> None:
    """A ramp of 0.5 m/s from 4.5 m at 0.5 s on meets ``11 t - g t^2/2``."""
    m = thrown(10.0, "waits -> saw when height + w*time >= ramp")
    m.input(ramp=hb.Input(table=[(0.0, 4.5), (0.5, 4.5), (2.5, 5.5)], linear=True))
    run = hb.simulate(m, until="1 s")
    met = (10.5 - math.sqrt(10.5**2 - 2.0 * G * 4.25)) / G
    assert [e.t for e in run.events if e.cause == "guard"] == [pytest.approx(met, abs=1e-12)]
