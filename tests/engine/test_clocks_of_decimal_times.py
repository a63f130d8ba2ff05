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
OFFSETS = ["0", "1/4", "1/2"]
"""Of clocks beside each other, in periods: no two of them tick at one instant."""
MANY = 60
BESIDE = 7
"""The instant, in periods, that a guard names by its decimal number."""


def clocks(period: str, every: int, source: str) -> hb.Model:
    """Return clocks that count periods by `floor`, `mod` and a comparison with half of one."""
    m = hb.Model("clocks", domain="electrical")
    m.add(S=hb.Se(source), R=hb.R("1 ohm"), i=hb.One())
    m.bond("S -> i -> R")
    for k, offset in enumerate(OFFSETS):
        at = {"every": f"{every}*({period}) [s]", "phase": f"({offset})*({period}) [s]"}
        formulas = {
            f"many{k}": f"floor(time/({period}))",
            f"next{k}": f"ceil(time/({period}))",
            f"part{k}": f"mod(time, {period})",
            f"half{k}": f"if mod(time, {period}) >= ({period})/2 then 1 else 0",
        }
        m.signal(**{name: hb.Sampled(formula, **at) for name, formula in formulas.items()})
    named = float(BESIDE * Fraction(period))
    rules = [f"before -> after when time >= {named!r} [s]"]
    m.machine("q", states={"before": [], "after": []}, start="before", rules=rules)
    return m


@pytest.mark.parametrize("source", ["1 V", "1 V*floor(time/({}))"])
@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize("period", PERIODS)
def test_clocks_tick_at_decimal_times(period: str, every: int, source: str) -> None:
    t = Fraction(period)
    step = every * t
    until = float((MANY + Fraction(1, 2)) * step + t)
    run = hb.simulate(clocks(period, every, source.format(period)), until=until)
    for k, offset in enumerate(OFFSETS):
        ticks = [Fraction(offset) * t + n * step for n in range(MANY)]
        names = [f"many{k}", f"next{k}", f"part{k}", f"half{k}"]
        many, after, part, half = run.sample([float(now + t / 4) for now in ticks], names).values()
        for n, now in enumerate(ticks):
            whole = floor(now / t)
            rest = now - whole * t
            assert many[n] == whole
            assert after[n] == whole + 1  # from the instant on, at 0 as well
            assert abs(part[n] - float(rest)) <= 1e-14 * float(now + t)
            assert half[n] == (2 * rest >= t)


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
