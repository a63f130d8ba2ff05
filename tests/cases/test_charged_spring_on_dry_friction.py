"""A spring that begins beyond what friction can hold, the limit being that of a normal force."""

from __future__ import annotations

import math

import pytest

import hybond as hb


def element(x: float, *, mass: bool) -> hb.Model:
    m = hb.Model("spring and friction", domain="translational")
    m.add(spring=hb.C("0.001 m/N", q=f"{x} m"), v=hb.One(law="coulomb", limit="0.5*load.e"))
    m.add(n=hb.One(), weight=hb.Se("20 N"), load=hb.C("0.001 m/N", q="0.02 m"), body=hb.I("2 kg"))
    m.bond("v -> spring", "weight -> n -> load", "n -> body")
    if mass:
        m.add(mass=hb.I("1 kg"))
        m.bond("v -> mass")
    return m


@pytest.mark.parametrize("x", [0.1, -0.1])
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_without_a_mass_it_goes_to_the_limit_at_once(solver: str, x: float) -> None:
    """From 100 N to 0.5 * 20 N: of 5 J there are 0.05 J left, and it rests."""
    run = hb.simulate(element(x, mass=False), 0.1, solver=solver)
    sign = 1.0 if x > 0.0 else -1.0
    assert run["spring.e"].at(0.1) == pytest.approx(10.0 * sign, rel=1e-12)
    assert run["v.e"].at(0.1) == pytest.approx(-10.0 * sign, rel=1e-12)
    assert run["v.f"].at(0.1) == 0.0
    jump = next(s.energy for s in run.events[0].steps if s.energy is not None and s.energy.lost)
    assert jump.lost == pytest.approx(4.95, rel=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize("x", [0.1, -0.1])
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_with_a_mass_it_slides_with_the_limit_from_the_start(solver: str, x: float) -> None:
    """It swings about where the spring has 10 N, half a period long: from 100 N to -80 N."""
    run = hb.simulate(element(x, mass=True), 0.09, solver=solver)
    sign = 1.0 if x > 0.0 else -1.0
    assert run["v.e"].at(0.05) == pytest.approx(-10.0 * sign, rel=1e-9)
    half = 10.0 * sign + 90.0 * sign * math.cos(1000.0**0.5 * 0.09)
    assert run["spring.e"].at(0.09) == pytest.approx(half, rel=1e-6)
    assert run.audit().holds()
