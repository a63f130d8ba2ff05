"""Rates of functions of which nothing but values is known, against their derivatives."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import hybond as hb
from hybond.model.inputs import Called
from hybond.model.rate_of_function import rate_of

Time = Callable[[float], float]

SMOOTH: dict[str, tuple[Time, Time, float]] = {
    "sine": (math.sin, math.cos, 1e-12),
    "whole periods": (
        lambda t: math.sin(2 * math.pi * t),
        lambda t: 2 * math.pi * math.cos(2 * math.pi * t),
        1e-9,
    ),
    "fast": (lambda t: math.sin(1e5 * t), lambda t: 1e5 * math.cos(1e5 * t), 1e-8),
    "slow on much": (lambda t: 1e3 + t, lambda t: 1.0, 1e-9),
    "fifth power": (lambda t: t**5, lambda t: 5 * t**4, 1e-12),
    "constant": (lambda t: 7.0, lambda t: 0.0, 0.0),
    "rectified": (
        lambda t: abs(math.sin(314 * t)),
        lambda t: 314 * math.cos(314 * t) * math.copysign(1.0, math.sin(314 * t)),
        1e-9,
    ),
    "narrow pulse": (
        lambda t: math.exp(-(((t - 0.3) / 1e-4) ** 2)),
        lambda t: -2 * (t - 0.3) / 1e-8 * math.exp(-(((t - 0.3) / 1e-4) ** 2)),
        1e-9,
    ),
}


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("span", [1e-3, 1.0, 100.0])
def test_a_rate_is_that_of_the_function_on_any_scale_of_time(name: str, span: float) -> None:
    function, derivative, part = SMOOTH[name]
    times = [span * k / 17 for k in range(17)] + ([0.3, 0.30004, 0.2999] if span > 0.5 else [])
    size = max(abs(derivative(t)) for t in times) * max(span, 1.0)  # times are rounded
    for t in times:
        found = rate_of(function, t, 0.0, span, span)
        assert abs(found - derivative(t)) <= part * size, (t, found, derivative(t))


def test_a_rate_is_asked_where_the_function_is_smooth() -> None:
    asked = list[float]()

    def function(t: float) -> float:
        asked.append(t)
        return 5.0 - t if t < 0.25 else 3.0 * t * t

    called = Called(function, (0.25,), 1.0)
    for t, piece, rate in [(0.0, 0, -1.0), (0.25, 0, -1.0), (0.25, 1, 1.5), (1.0, 1, 6.0)]:
        asked.clear()
        assert called.rate(t, piece) == pytest.approx(rate, rel=1e-10)
        assert min(asked) >= (0.0, 0.25)[piece] and max(asked) <= (0.25, 1.0)[piece]
        assert piece or max(asked) < 0.25
    assert called.rate(1.5, 1) == pytest.approx(9.0, rel=1e-10)  # a run that goes on


@pytest.mark.parametrize("speed", [10.0, 100.0])
@pytest.mark.parametrize("turned", [False, True])
def test_a_rate_that_is_asked_at_many_times_is_asked_for_little(speed: float, turned: bool) -> None:
    """Each cost 35 calls, of which 28 found out anew how fast the function moves."""
    sign = -1.0 if turned else 1.0
    asked = list[float]()

    def function(t: float) -> float:
        asked.append(t)
        return sign * math.sin(speed * t)

    called = Called(function, (), 300.0)
    times = np.linspace(0.0, 300.0, 2000)
    rates = [called.rate(t, 0) for t in map(float, times)]
    assert np.abs(rates - sign * speed * np.cos(speed * times)).max() < 1e-9 * speed
    assert len(asked) < 15 * len(times) and min(asked) >= 0.0 and max(asked) <= 300.0


def test_a_rate_is_the_same_in_whatever_order_it_is_asked_and_by_whatever_run() -> None:
    def function(t: float) -> float:
        burst = math.sin(1e4 * t) * math.exp(-(((t - 4.0) / 1e-2) ** 2))
        return math.sin(t) + burst + (t * t if t < 2.0 else 7.0)

    def rate(t: float) -> float:
        inside = math.exp(-(((t - 4.0) / 1e-2) ** 2))
        burst = 1e4 * math.cos(1e4 * t) - (t - 4.0) / 5e-5 * math.sin(1e4 * t)
        return math.cos(t) + burst * inside + (2.0 * t if t < 2.0 else 0.0)

    times = [10.0 * k / 101 for k in range(101)] + [4.0 + 1e-3 * k for k in range(-30, 31)]
    long, short = Called(function, (2.0,), 10.0), Called(function, (2.0,), 3.0)
    one = {t: long.rate(t, long.piece(t)) for t in times}
    for t in times:
        if t < 3.0:
            short.rate(t, short.piece(t))
    # a copy for a run that ends elsewhere begins with what it finds out itself
    again = replace(short, end=10.0)
    assert [again.rate(t, again.piece(t)) for t in reversed(times)] == [*one.values()][::-1]
    for t, found in one.items():
        assert found == pytest.approx(rate(t), rel=1e-9, abs=1e-9), t


@pytest.mark.parametrize("frequency", [50.0, 1e5, 1e6])
@pytest.mark.parametrize("turned", [False, True])
def test_the_current_of_a_capacitor_on_a_function_is_that_of_its_rate(
    frequency: float, turned: bool
) -> None:
    """It was 7 % off at 100 kHz, and nothing but noise at 1 MHz: the span was 1 us always."""
    w = 2 * math.pi * frequency

    def voltage(t: float) -> float:
        assert 0.0 <= t <= 2.0 / frequency
        return math.sin(w * t) if t < 0.7 / frequency else 2.0 - math.cos(w * t)

    m = hb.Model("fed", domain="electrical")
    m.add(j=hb.Zero(), c=hb.C(1e-9), s=hb.Se("-u" if turned else "u"), r=hb.R(1e3))
    m.bond("j -> s" if turned else "s -> j", "j -> c", "j -> r")
    if turned:
        m.input(u=hb.Input(function=lambda t: -voltage(t), breaks=[0.7 / frequency]))
    else:
        m.input(u=hb.Input(function=voltage, breaks=[0.7 / frequency]))
    run = hb.simulate(m, 2.0 / frequency)
    for part in np.linspace(0.0, 1.99, 12):
        t = float(part) / frequency
        rate = math.cos(w * t) if t < 0.7 / frequency else math.sin(w * t)
        assert run["c.f"].at(t) == pytest.approx(1e-9 * w * rate, abs=1e-9 * w * 1e-9)
    assert run.status == "ok"
