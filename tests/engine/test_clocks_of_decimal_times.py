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


@pytest.mark.sampled(3)
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


RESETS = {
    "mod": ("mod(time, T) > 0.4*T", Fraction(2, 5)),
    "part of a period": ("mod(time, T)/T >= 0.25", Fraction(1, 4)),
    "floor": ("time - T*floor(time/T) > 0.4*T", Fraction(2, 5)),
    "ceil": ("T*ceil(time/T) - time < 0.6*T", Fraction(2, 5)),
    "within a condition": ("(if mod(time, T) > 0.4*T then 1 else 0) > 0.5", Fraction(2, 5)),
    "turned round": ("not (mod(time, T) <= 0.4*T)", Fraction(2, 5)),
    "sine": ("sin(2*pi*time/T) < 0", Fraction(1, 2)),
}
"""What ends a pulse that begins with each period, and the part of it that it lasts."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("period", [*PERIODS, "0.7"])
@pytest.mark.parametrize("reset", RESETS)
def test_a_clock_sets_what_a_ramp_of_its_own_period_resets(reset: str, period: str) -> None:
    guard, part = RESETS[reset]
    m = hb.Model("latch", domain="electrical", parameters={"T": float(Fraction(period))})
    m.add(V=hb.Se("1 V"), s=hb.One(), L=hb.I("1 H"))
    m.bond("V -> s -> L")
    m.input(clock=hb.Input(pwm={"period": "T", "duty": 0.05}))
    rules = ["off -> on when clock > 0.5", f"on -> off when {guard}"]
    m.machine("latch", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    run = hb.simulate(m, until=float((MANY + Fraction(9, 10)) * Fraction(period)))
    edges = [(k + p) * Fraction(period) for k in range(MANY + 1) for p in (0, part)]
    assert [e.t for e in run.events] == pytest.approx([float(t) for t in edges], rel=1e-11)


def test_a_gate_that_opens_with_a_clock_is_seen_with_it() -> None:
    # the phase of the clock is where the gate opens: one instant, whatever rounds it
    m = hb.Model("fired", domain="electrical")
    m.add(V=hb.Se("u"), s=hb.One(law="thyristor", gate="mod(time, 0.3) < 0.1"), R=hb.R("1 ohm"))
    m.bond("V -> s -> R")
    m.input(u=hb.Input(pwm={"period": 0.3, "duty": 0.5, "high": 1, "low": -1}))
    run = hb.simulate(m, until=0.3 * MANY + 0.05)
    assert len(run.events) == 2 * MANY + 1
    assert run["s.f"].mean(end=0.3 * MANY) == pytest.approx(0.5, rel=1e-12)
