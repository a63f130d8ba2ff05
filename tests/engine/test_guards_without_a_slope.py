"""Guards that have no slope where they cross: a cube at zero crosses, though nothing leads it.

The states that such a guard reads may be in motion. Its threshold is no place to rest at unless
they rest.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

METHODS = ["exact", "rk45", "radau"]
ACROSS = [
    "(C.e/(1 [V]) - 0.5)^3 < 0",
    "0 >= (C.e/(1 [V]) - 0.5)^3",
    "not (tanh(C.e/(1 [V]) - 0.5)^3 > 0)",
    "(C.e/(1 [V]) - 0.5)^5 < 0 and C.e < 0.9 [V]",
]
NEVER = ["(C.e/(1 [V]) - 1)^3 >= 0", "(C.e/(1 [V]) - 1)^2 <= 0", "(1 - C.e/(1 [V]))^5 <= 0"]


def instants(m: hb.Model, guard: str, method: str, until: float) -> list[float]:
    """Return when a machine fired whose guard this is."""
    m.machine("w", states={"no": [], "yes": []}, start="no", rules=[f"no -> yes when {guard}"])
    run = hb.simulate(m, until=until, solver=method)
    return [event.t for event in run.events[1:]]


def swings(turned: bool) -> hb.Model:
    """Return a capacitor of cos(t) volts beside its coil."""
    m = hb.Model("lc", domain="electrical")
    m.add(C=hb.C("1 F", e="1 V"), L=hb.I("1 H"), i=hb.One())
    m.bond(*(["i -> C", "L -> i"] if turned else ["C -> i", "i -> L"]))
    return m


def charges(turned: bool) -> hb.Model:
    """Return a capacitor that charges to 1 V, and is never there."""
    m = hb.Model("rc", domain="electrical")
    m.add(S=hb.Se("1 V"), R=hb.R("1 ohm"), C=hb.C("1 F"), i=hb.One())
    m.bond("S -> i", "i -> R", "i -> C")
    if turned:
        m = hb.Model("rc", domain="electrical")
        m.add(S=hb.Se("-1 V"), R=hb.R("1 ohm"), C=hb.C("1 F"), i=hb.One())
        m.bond("i -> S", "R -> i", "i -> C")
    return m


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("guard", ACROSS)
@pytest.mark.parametrize("turned", [False, True])
def test_cubes_that_cross_fire_where_they_do(turned: bool, guard: str, method: str) -> None:
    (found,) = instants(swings(turned), guard, method, 7)
    assert found == pytest.approx(math.pi / 3, abs=1e-8)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("guard", NEVER)
@pytest.mark.parametrize("turned", [False, True])
def test_cubes_that_come_to_rest_do_not_fire(turned: bool, guard: str, method: str) -> None:
    assert instants(charges(turned), guard, method, 40) == []
