"""Two windings that are nearly one, of which one carries no current: the other is a plain coil.

Each rate is a difference of terms that are 1/(1 - k^2) times as large, and nothing decays by them.
"""

import math
from collections.abc import Callable

import pytest

import hybond as hb

HENRY, OHM, OMEGA, VOLT = 1e-3, 0.1, 314.0, 10.0
SOURCE = f"{VOLT}*sin({OMEGA}*time/(1 s))"


def flux(t: float) -> float:
    """Return that of a coil behind a resistor at a sine, from rest."""
    size = OHM * OHM + (OMEGA * HENRY) ** 2
    swing = OHM * math.sin(OMEGA * t) - OMEGA * HENRY * math.cos(OMEGA * t)
    decay = OMEGA * HENRY * math.exp(-OHM / HENRY * t)
    return HENRY * VOLT * (swing + decay) / size


def coils(k: float, *, turned: bool) -> hb.Model:
    """Return the circuit; of its bonds some may point the other way."""
    m = hb.Model("coils", domain="electrical")
    m.add(core=hb.I([[HENRY, k * HENRY], [k * HENRY, HENRY]]))
    m.add(a=hb.One(), b=hb.One(), s=hb.Se(SOURCE), ra=hb.R(OHM), z=hb.Sf(0.0))
    m.bond("s -> a", "ra -> a" if turned else "a -> ra", "a -> core.1")
    m.bond("core.2 -> b" if turned else "b -> core.2", "z -> b")
    return m


def plates(k: float, *, turned: bool) -> hb.Model:
    """Return the dual: a field of two capacitors, one of them at no voltage."""
    m = hb.Model("plates", domain="electrical")
    m.add(field=hb.C([[HENRY, k * HENRY], [k * HENRY, HENRY]]))
    m.add(a=hb.Zero(), b=hb.Zero(), s=hb.Sf(SOURCE), ga=hb.G(OHM), z=hb.Se(0.0))
    m.bond("s -> a", "ga -> a" if turned else "a -> ga", "a -> field.1")
    m.bond("field.2 -> b" if turned else "b -> field.2", "z -> b")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("k", [0.999, 0.99999, 0.999999])
@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
@pytest.mark.parametrize("model", [coils, plates])
def test_what_one_winding_carries(
    model: Callable[..., hb.Model], k: float, rtol: float, *, turned: bool
) -> None:
    run = hb.simulate(model(k, turned=turned), 0.02, rtol=rtol)
    # what is propagated is exact at the ends of steps, whatever the tolerance
    (piece,) = run.segments
    off = [abs(y[0] - flux(t)) for t, y in zip(piece.t, piece.y, strict=True)]
    assert max(off) <= 1e-10 * max(abs(y[0]) for y in piece.y)


@pytest.mark.parametrize("rtol", [1e-7, 1e-8, 1e-9])
def test_windings_of_which_one_feeds_a_rectifier(rtol: float) -> None:
    m = hb.Model("rectifier", domain="electrical")
    m.add(core=hb.I([[HENRY, 0.999999 * HENRY], [0.999999 * HENRY, HENRY]]))
    m.add(a=hb.One(), b=hb.One(), s=hb.Se(SOURCE), ra=hb.R(OHM))
    m.add(d=hb.One(law="diode"), o=hb.Zero(), c=hb.C(1e-4), load=hb.R(100.0))
    m.bond("s -> a", "a -> ra", "a -> core.1", "b -> core.2")
    m.bond("b -> d -> o -> c", "o -> load")
    run = hb.simulate(m, 0.02, rtol=rtol)
    # `radau` at 1e-10; 4e-4 off before
    assert float(run["c.e"].at(0.01)) == pytest.approx(3.91320246, rel=2e-8)
