"""Sampled signals of time at their own instants: k*T is one instant with what names that number.

The oracle computes with fractions.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import floor, pi, sin

import pytest

import hybond as hb

PERIODS = ["0.1", "0.2", "0.3", "1/3", "1e-3", "7e-6"]
MANY = 60
BESIDE = 7
"""The instant, in periods, that a guard names by its decimal number."""


def clock(period: str, offset: str, every: int, source: str) -> hb.Model:
    """Return a clock that counts periods by `floor`, `mod` and a comparison with half of one."""
    m = hb.Model("clock", domain="electrical")
    m.add(S=hb.Se(source), R=hb.R("1 ohm"), i=hb.One())
    m.bond("S -> i -> R")
    at = {"every": f"{every}*({period}) [s]", "phase": f"({offset})*({period}) [s]"}
    m.signal(
        many=hb.Sampled(f"floor(time/({period}))", **at),
        next=hb.Sampled(f"ceil(time/({period}))", **at),
        part=hb.Sampled(f"mod(time, {period})", **at),
        half=hb.Sampled(f"if mod(time, {period}) >= ({period})/2 then 1 else 0", **at),
    )
    named = float(BESIDE * Fraction(period))
    rules = [f"before -> after when time >= {named!r} [s]"]
    m.machine("q", states={"before": [], "after": []}, start="before", rules=rules)
    return m


@pytest.mark.parametrize("source", ["1 V", "1 V*floor(time/({}))"])
@pytest.mark.parametrize("offset", ["0", "1/4", "1/2"])
@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize("period", PERIODS)
def test_clock_ticks_at_decimal_times(period: str, every: int, offset: str, source: str) -> None:
    t = Fraction(period)
    step, phase = every * t, Fraction(offset) * t
    run = hb.simulate(
        clock(period, offset, every, source.format(period)),
        until=float(phase + (MANY + Fraction(1, 2)) * step),
    )
    held = run.sample(
        [float(phase + (k + Fraction(1, 4)) * step) for k in range(MANY)],
        ["many", "next", "part", "half"],
    )
    for k in range(MANY):
        now = phase + k * step
        whole = floor(now / t)
        rest = now - whole * t
        assert held["many"][k] == whole
        assert held["next"][k] == whole + 1  # from the instant on, at 0 as well
        assert abs(held["part"][k] - float(rest)) <= 1e-14 * float(now + t)
        assert held["half"][k] == (2 * rest >= t)


MOVES: dict[str, Callable[[float], float]] = {
    "time": lambda t: t,
    "sin(2*pi*time)": lambda t: sin(2 * pi * t),
    "time - 0.3": lambda t: t - 0.3,
    "abs(time - 0.6)": lambda t: abs(t - 0.6),
}


@pytest.mark.parametrize("law", MOVES)
def test_what_goes_through_zero_at_an_instant_does_not_jump(law: str) -> None:
    m = hb.Model("moves", domain="electrical")
    m.add(S=hb.Se("1 V"), R=hb.R("1 ohm"), i=hb.One())
    m.bond("S -> i -> R")
    m.signal(k=hb.Sampled(law, every=0.1))
    run = hb.simulate(m, until=1.25)
    for n in range(12):
        assert run["k"].at(n * 0.1 + 0.05) == MOVES[law](n * 0.1)
