"""Periods and runs that end where a law jumps with time, against closed forms and quadrature."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad

import hybond as hb


def lag(rate: str, P: float = 0.5) -> hb.Model:
    m = hb.Model("lag", parameters={"P": P})
    m.signal(x=hb.Integral(rate))
    return m


@pytest.mark.parametrize("P", [0.25, 0.3, 1.0])
def test_a_comparison_with_a_sawtooth_turns_with_the_sawtooth_itself(P: float) -> None:
    """At P both jump, and they are one: x' = (1 for 0.2 s in each period) - x."""
    model = lag("(if mod(time, P) < 0.2 then 1 else 0) - x", P)
    orbit = hb.periodic(model, wrt=["P"])
    assert orbit.state.signals["x"] == pytest.approx(np.expm1(0.2) / np.expm1(P), rel=1e-9)
    by = -np.expm1(0.2) * np.exp(P) / np.expm1(P) ** 2
    assert orbit.derivative("x", "P") == pytest.approx(by, rel=1e-8)
    # from rest, within the fourth period: each pulse began when its period did
    t = 3 * P + 0.22
    s = hb.sensitivities(model, t, wrt=["P"], of=["x"])
    pulses = [(n * P, n * P + 0.2) for n in range(4)]
    grown = sum(np.exp(b - t) - np.exp(a - t) for a, b in pulses)
    moved = sum(n * (np.exp(b - t) - np.exp(a - t)) for n, (a, b) in enumerate(pulses))
    assert s.y[-1, 0] == pytest.approx(grown, rel=1e-7)
    assert s.final("x", "P") == pytest.approx(moved, rel=1e-7) and s.notes == ()


@pytest.mark.parametrize("P", [0.3, 2.0])
def test_slopes_that_jump_at_the_end_of_the_period_are_those_before_it(P: float) -> None:
    """x' = 1 - (1 + t/P) x: also how fast a variation shrinks jumps there."""

    def steady(p: float) -> float:
        grown = quad(
            lambda s: np.exp(s + s * s / (2 * p) - 1.5 * p), 0.0, p, epsabs=1e-14, epsrel=1e-13
        )
        return float(grown[0]) / (1.0 - np.exp(-1.5 * p))

    orbit = hb.periodic(lag("1 - (1 + mod(time, P)/P)*x", P), wrt=["P"])
    assert orbit.values == pytest.approx([np.exp(-1.5 * P)], rel=1e-12)
    assert orbit.state.signals["x"] == pytest.approx(steady(P), rel=1e-9)
    h = 1e-3
    x1, x2, x3, x4 = (steady(P + k * h) for k in (1, -1, 2, -2))
    by = (8 * (x1 - x2) - (x3 - x4)) / (12 * h)
    assert orbit.derivative("x", "P") == pytest.approx(by, rel=1e-7)


@pytest.mark.parametrize("P", [0.3, 0.7, 1.1])
def test_what_follows_a_source_jumps_with_it_at_the_end_of_the_period(P: float) -> None:
    """A comparison with a bond variable: no law of time jumps, and the rate does."""
    m = hb.Model("half", parameters={"P": P})
    m.add(V=hb.Se("sin(2*pi*time/P)"), r=hb.R(1.0), j=hb.One())
    m.bond("V -> j -> r")
    m.signal(x=hb.Integral("(if V.e > 0 then 1 else 0) - x"))
    for multiple in (1, 3):
        orbit = hb.periodic(m, wrt=["P"], multiple=multiple)
        e = np.exp(P / 2)
        assert orbit.state.signals["x"] == pytest.approx(1 / (e + 1), rel=1e-7)
        assert orbit.derivative("x", "P") == pytest.approx(-e / 2 / (e + 1) ** 2, rel=1e-6)


@pytest.mark.slow
def test_steep_is_no_jump() -> None:
    """A square wave but for its edges, the last one in the middle of its rise at the end."""
    P, k = 0.5, 1e4
    orbit = hb.periodic(lag(f"tanh({k}*sin(2*pi*time/P)) - x", P), wrt=["P"])
    assert orbit.derivative("x", "P") == pytest.approx(-1 / (2 * np.cosh(P / 4)) ** 2, rel=1e-4)
    # what cannot be told from a jump any more is said to be told badly
    orbit = hb.periodic(lag("tanh(1e9*sin(2*pi*time/P)) - x", P), wrt=["P"])
    assert any("fewer digits" in note for note in orbit.notes)


def test_a_run_that_ends_where_a_law_jumps_has_derivatives_to_one_side() -> None:
    P = 0.5
    model = lag("mod(time, P)/P - x", P)
    s = hb.sensitivities(model, 2 * P, wrt=["P"], of=["x"])
    (note,) = s.notes
    assert "by P perhaps to one side only: the run ends where a law jumps" in note and note in str(
        s
    )
    assert hb.gradient(model, hb.Final("x"), 2 * P, wrt=["P"]).notes == s.notes

    def end(p: float) -> float:
        """x at 1 s, with jumps at p and 2 p before it."""
        edges = [0.0, p, min(2 * p, 1.0), 1.0]
        teeth = itertools.pairwise(edges)
        return float(sum(np.exp(b - 1) * (b - a - 1) + np.exp(a - 1) for a, b in teeth) / p)

    h = 1e-6
    later, sooner = (end(P + h) - end(P)) / h, (end(P - h) - end(P)) / -h
    assert s.final("x", "P") == pytest.approx(later, rel=1e-5)
    assert abs(later - sooner) > 0.5
    # a little before it and behind it there are two sides
    for until in (0.999, 1.001):
        assert hb.sensitivities(model, until, wrt=["P"]).notes == ()


@pytest.mark.parametrize("rtol", [1e-8, 1e-11])
def test_a_jump_in_a_step_that_is_nearly_none_counts(rtol: float) -> None:
    """A staircase of three steps a period; a machine beside it has runs end steps elsewhere."""
    P, t = 0.5, 1.13
    m = hb.Model("stairs", parameters={"P": P})
    m.signal(x=hb.Integral("floor(3*mod(time, P)/P) - x"), c=hb.Integral("1"))
    rules = ["a -> b when c > 0.777", "b -> a when c < 0.1"]
    m.machine("k", states={"a": [], "b": []}, start="a", rules=rules)
    s = hb.sensitivities(m, t, wrt=["P"], of=["x"], rtol=rtol)
    thirds = [(k, min(k + 1, 3 * t / P)) for k in range(int(3 * t / P) + 1)]
    ends = [(k % 3, a * P / 3, b * P / 3, a / 3, b / 3 if b == k + 1 else 0.0)
            for k, (a, b) in enumerate(thirds)]  # fmt: skip
    x = sum(c * (np.exp(b - t) - np.exp(a - t)) for c, a, b, _, _ in ends)
    by = sum(c * (q * np.exp(b - t) - p * np.exp(a - t)) for c, a, b, p, q in ends)
    assert s.y[-1, 0] == pytest.approx(x, rel=1e-6)
    assert s.final("x", "P") == pytest.approx(by, rel=1e-6)
