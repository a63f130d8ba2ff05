"""A mass at rest that a force sets off late, as a power of the time since: it begins there.

The step that ended where the force begins ended some last places of time behind it: what had moved
there by 1e-45 was a size, and no step was small enough beside the last places of time (HB-N201).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

UNTIL = 3.0
SPRINGS = {
    "none": ("", 0.0, 0.0),
    "straight": ("5*x", 5.0, 5.0),
    "bent": ("if x > 0 then 5*x else 20*x", 20.0, 5.0),
    "both ways": ("5*abs(x)", -5.0, 5.0),
    "pulls": ("3*min(x, 0)", 3.0, 0.0),
}
"""What they are written as, and stiffness below and above zero."""


def pushed(at: float, power: float, spring: str, way: int, mass: float, turned: bool) -> hb.Model:
    """Return a mass that stands until `at`."""
    m = hb.Model("late", domain="translational")
    law = SPRINGS[spring][0]
    push = hb.Se(f"{way}*max(0, time - {at})^{power}")
    if turned:
        m.add(v=hb.One(), m=hb.I(mass), push=push)
        m.bond("m -> v", "push -> v")
    else:
        m.add(push=push, m=hb.I(mass), v=hb.One())
        m.bond("push -> v -> m")
    m.signal(x=hb.Integral("v.f"))
    if law:
        m.add(spring=hb.Se(law))
        m.bond("v -> spring")
    return m


def followed(at: float, power: float, spring: str, way: int, mass: float) -> np.ndarray:
    """Return speed and place at the end by SciPy; where the force only grows, x keeps its sign."""
    stiffness = SPRINGS[spring][2 if way > 0 else 1]

    def rates(t: float, y: np.ndarray) -> list[float]:
        return [(way * t**power - stiffness * y[1]) / mass, y[0]]

    s = solve_ivp(rates, (0, UNTIL - at), [0, 0], "DOP853", rtol=1e-12, atol=1e-15)
    return np.asarray(s.y[:, -1])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("spring", SPRINGS)
@pytest.mark.parametrize("at", [0.0, 0.3, 1.0, 1.9, 2.123])
def test_a_mass_that_a_power_of_time_sets_off_late(at: float, spring: str, solver: str) -> None:
    """Free ones are a closed form: v = s^(p+1)/(p+1)/m."""
    for k, power in enumerate((1.5, 2.5, 3, 4)):
        for way in (1, -1):
            mass = (1.0, 1e3)[k % 2]
            m = pushed(at, power, spring, way, mass, turned=(k + way) % 3 == 0)
            run = hb.simulate(m, UNTIL, solver=solver, max_steps=4000)
            want = followed(at, power, spring, way, mass)
            assert run.audit().holds()
            assert float(run["v.f"].at(UNTIL)) == pytest.approx(want[0], rel=3e-6)
            assert float(run["x"].at(UNTIL)) == pytest.approx(want[1], rel=3e-6)
            if at > 0:
                assert float(run["v.f"].at(0.99 * at)) == 0.0
            if spring == "none":
                s = UNTIL - at
                closed = way * s ** (power + 1) / (power + 1) / mass
                assert float(run["v.f"].at(UNTIL)) == pytest.approx(closed, rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("at", [0.3, 1.9, 2.123])
@pytest.mark.parametrize("power", [1.5, 2.5, 4])
def test_one_store_alone_that_time_fills_late(at: float, power: float, solver: str) -> None:
    """Nothing but one state: a tank below a feed, q = s^(p+1)/(p+1)."""
    m = hb.Model("late", domain="hydraulic")
    m.add(feed=hb.Sf(f"1e-3*max(0, time - {at})^{power}"), n=hb.Zero(), tank=hb.C(1e-4))
    m.bond("feed -> n -> tank")
    run = hb.simulate(m, UNTIL, solver=solver, max_steps=4000)
    closed = 1e-3 * (UNTIL - at) ** (power + 1) / (power + 1)
    assert float(run["tank.q"].at(UNTIL)) == pytest.approx(closed, rel=1e-6)
    assert float(run["tank.q"].at(0.99 * at)) == 0.0
    assert run.audit().holds()
