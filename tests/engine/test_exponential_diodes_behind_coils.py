"""Shockley diodes in circuits with coils: what blocks leaves the saturation current alone.

Oracles are SciPy's: while such a diode conducts, what is across it is the unknown, and its current
an exponential of that; while it blocks there is next to none.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

SATURATION, THERMAL = 1e-12, 0.02585
DIODE = {"f": "1e-12*(exp(e/0.02585) - 1)"}
BEGINS = 0.1
"""Across a diode that begins to conduct, V: its current is still below 1e-10 A."""


def current(u: float) -> float:
    """Return the current of a diode with a voltage across it."""
    return SATURATION * math.expm1(u / THERMAL)


def pulses(
    source: Callable[[float], float], begin: float, end: float, coil: float, *, farads: float
) -> Callable[[float], float]:
    """Return the current through a diode, 10 ohm, a coil and perhaps a capacitor, from rest.

    One pulse, that begins after `begin`.
    """
    per_farad = 1.0 / farads if farads else 0.0

    def rates(t: float, y: list[float]) -> list[float]:
        u, q = y
        i = current(u)
        slope = SATURATION / THERMAL * math.exp(u / THERMAL)
        return [(source(t) - 10.0 * i - u - q * per_farad) / coil / slope, i]

    def blocks(_: float, y: list[float]) -> float:
        return y[0] - 0.999 * BEGINS

    blocks.terminal = True  # type: ignore[attr-defined]
    blocks.direction = -1.0  # type: ignore[attr-defined]
    first = brentq(lambda t: source(t) - BEGINS, begin, begin + 0.004, xtol=1e-16)
    made = solve_ivp(
        rates,
        (first, end),
        [BEGINS, 0.0],
        method="Radau",
        rtol=1e-9,
        atol=1e-12,
        dense_output=True,
        events=blocks,
    )

    def at(t: float) -> float:
        return current(made.sol(t)[0]) if first <= t <= made.t[-1] else 0.0

    return at


def half_wave(back: bool, *, farads: float = 0.0) -> hb.Model:
    """A sine through a diode onto a resistor and a coil."""
    m = hb.Model("half-wave")
    m.add(v=hb.Se("10*sin(2*pi*50*time)"), d=hb.R(DIODE), s=hb.One(), r=hb.R(10.0), l=hb.I(0.01))
    m.bond("v -> s -> r", "s -> l", "d -> s" if back else "s -> d")
    if farads:
        m.add(c=hb.C(farads))
        m.bond("s -> c")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("solver", "back"), [("auto", False), ("auto", True), ("radau", True), ("rk45", False)]
)
@pytest.mark.slow
def test_a_half_wave_with_a_coil_was_refused_where_the_diode_blocks(
    solver: str, back: bool
) -> None:
    """HB-N401, HB-N410 or accumulation of events, where it began to block or to conduct."""
    way = -1.0 if back else 1.0
    run = hb.simulate(half_wave(back), 0.05, solver=solver)
    begin = 0.03 if back else 0.02
    meant = pulses(lambda t: way * 10 * math.sin(100 * math.pi * t), begin, 0.05, 0.01, farads=0.0)
    assert run.status == "ok"
    for k in range(1, 20):
        t = begin + k * 0.001
        assert run["l.f"].at(t) == pytest.approx(way * meant(t), abs=1e-6)


@pytest.mark.parametrize("back", [False, True])
def test_what_blocks_follows_its_law_down_to_the_saturation_current(back: bool) -> None:
    """Before the diode conducts nothing moves: its current is that of the whole voltage."""
    way = -1.0 if back else 1.0
    run = hb.simulate(half_wave(back), 0.04)
    t = 0.02 + (0.01 if back else 0.0)
    for v in (-0.3, -0.1, -0.02, 0.1, 0.2):
        at = t + math.asin(v / 10.0) / (100 * math.pi)
        assert way * run["l.f"].at(at) == pytest.approx(current(v), rel=1e-4)
        assert run["d.e"].at(at) == pytest.approx(v, abs=1e-5)
    assert way * run["l.f"].at(t - 0.003) == pytest.approx(-SATURATION, rel=1e-5)


@pytest.mark.slow
def test_a_capacitor_is_charged_through_a_coil() -> None:
    run = hb.simulate(half_wave(False, farads=1e-3), 0.02)
    meant = pulses(lambda t: 10 * math.sin(100 * math.pi * t), 0.0, 0.02, 0.01, farads=1e-3)
    for k in range(1, 20):
        assert run["l.f"].at(k * 0.001) == pytest.approx(meant(k * 0.001), abs=1e-6)


def test_a_cell_in_the_sun_drives_a_coil() -> None:
    """The load has in the end what the cell has left: a diode, and two resistors, in its way."""
    m = hb.Model("cell")
    m.add(i=hb.Sf(3.0), n=hb.Zero(), d=hb.R({"f": "1e-9*(exp(e/0.035) - 1)"}), rp=hb.R(50.0))
    m.add(s=hb.One(), r=hb.R(0.32), l=hb.I(1e-3))
    m.bond("i -> n -> d", "n -> rp", "n -> s -> r", "s -> l")
    run = hb.simulate(m, 0.2)
    left = brentq(lambda v: 3.0 - 1e-9 * math.expm1(v / 0.035) - v / 50 - v / 0.32, 0.0, 0.9)
    assert run["l.f"].at(0.2) == pytest.approx(left / 0.32, rel=1e-8)


@pytest.mark.slow
def test_a_diode_that_takes_over_from_another_had_no_end_of_modes() -> None:
    """HB-N401, HB-N301: one blocks and leaves to the other what is stored, until it is nothing."""
    m = hb.Model("freewheeling")
    m.add(v=hb.Se("10*sin(2*pi*50*time)"), d=hb.R(DIODE), s=hb.One(), n=hb.Zero())
    m.add(w=hb.R({"f": "-1e-12*(exp(-e/0.02585) - 1)"}), j=hb.One(), r=hb.R(10.0), l=hb.I(0.01))
    m.bond("v -> s -> n -> j -> r", "s -> d", "n -> w", "j -> l")

    def rate(t: float, y: list[float]) -> list[float]:
        v = 10.0 * math.sin(100 * math.pi * t)
        n = brentq(lambda n: current(v - n) + current(-n) - y[0], -1.0, max(v, 0.0) + 0.1)
        return [(n - 10.0 * y[0]) / 0.01]

    meant = solve_ivp(
        rate, (0.0, 0.0108), [0.0], method="Radau", rtol=1e-9, atol=1e-12, dense_output=True
    )
    run = hb.simulate(m, 0.04)
    for k in range(1, 28):
        t = 0.0004 * k
        assert run["l.f"].at(t) == pytest.approx(meant.sol(t)[0], abs=1e-6)
        assert run["l.f"].at(t + 0.02) == pytest.approx(meant.sol(t)[0], abs=1e-6)


def bridge(inductance: float) -> hb.Model:
    """Four diodes behind 1 ohm, and a load of 100 ohm with a coil or without."""
    m = hb.Model("bridge")
    m.add(v=hb.Se("10*sin(2*pi*50*time)"), s=hb.One(), rs=hb.R(1.0), a=hb.Zero(), b=hb.Zero())
    m.add(p=hb.Zero(), q=hb.Zero(), load=hb.One(), r=hb.R(100.0))
    m.bond("v -> s -> a", "b -> s", "s -> rs", "p -> load -> q", "load -> r")
    for k, (x, y) in enumerate([("a", "p"), ("b", "p"), ("q", "a"), ("q", "b")]):
        m.add(**{f"j{k}": hb.One(), f"d{k}": hb.R(DIODE)})
        m.bond(f"{x} -> j{k} -> {y}", f"j{k} -> d{k}")
    if inductance:
        m.add(l=hb.I(inductance))
        m.bond("load -> l")
    return m


def test_four_laws_that_are_solved_together_had_no_solution_that_was_found() -> None:
    """HB-N301: with a resistor alone two of them have the current, and the source the rest."""
    run = hb.simulate(bridge(0.0), 0.02)
    for t in (0.001, 0.005, 0.012):
        v = 10.0 * abs(math.sin(100 * math.pi * t))
        i = run["r.f"].at(t)
        assert 101.0 * i + 2.0 * THERMAL * math.log1p(i / SATURATION) == pytest.approx(v, rel=1e-8)


@pytest.mark.slow
def test_a_bridge_with_a_coil_is_a_rectifier() -> None:
    """The diodes of a pair share alike: both pairs have closed forms given the coil's current."""

    def rate(t: float, y: list[float]) -> list[float]:
        v, i = 10.0 * math.sin(100 * math.pi * t), y[0] + 2.0 * SATURATION
        w = brentq(lambda w: v - i * math.tanh(w / (2 * THERMAL)) - w, -10.1, 10.1, xtol=1e-14)
        half = abs(w) / (2 * THERMAL)
        across = 2 * THERMAL * (half + math.log1p(math.exp(-2 * half)) - math.log(i / SATURATION))
        return [(across - 100.0 * y[0]) / 0.1]

    meant = solve_ivp(
        rate, (0.0, 0.03), [0.0], method="Radau", rtol=1e-9, atol=1e-12, dense_output=True
    )
    run = hb.simulate(bridge(0.1), 0.03)
    for k in range(1, 30):
        assert run["l.f"].at(0.001 * k) == pytest.approx(meant.sol(0.001 * k)[0], abs=1e-6)
