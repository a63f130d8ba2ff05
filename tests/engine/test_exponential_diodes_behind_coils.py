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


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("back", [False, True])
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
