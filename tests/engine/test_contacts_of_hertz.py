"""A mass that strikes a spring whose force is a power of how far it is pressed, from a flight.

The first step behind the touch goes along a power of the time. The two formulas of which its error
is estimated are nearly alike there, and it was off by eleven times as much as they said.
"""

import math
from typing import Literal

import pytest

import hybond as hb

RTOL = 1e-8


def thrown(mass: float, speed: float, stiffness: float, power: float, turned: bool) -> hb.Model:
    """Return a mass that flies towards a spring 1 m ahead of it."""
    m = hb.Model("thrown", domain="translational")
    away = "-" if turned else ""
    law = f"{stiffness}*max({away}q, 0)^{power}"
    m.add(v=hb.One(), I=hb.I(mass, p=mass * speed))
    m.add(k=hb.C({"e": f"{away}{law}"}, q=1.0 if turned else -1.0))
    m.bond("v -> I", "k -> v" if turned else "v -> k")
    return m


@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize("power", [1.5, 1.25, 2.5])
@pytest.mark.parametrize("stiffness", [10.0, 1e3, 1e6])
@pytest.mark.parametrize(("mass", "speed"), [(1.0, 1.0), (0.02, 3.7)])
def test_it_comes_back_as_fast_and_as_late(
    mass: float,
    speed: float,
    stiffness: float,
    power: float,
    turned: bool,
    solver: Literal["auto", "rk45", "radau"],
) -> None:
    part = 1.0 / (power + 1.0)
    pressed = ((power + 1.0) * mass * speed**2 / (2.0 * stiffness)) ** part
    pressing = 2.0 * pressed / speed * math.sqrt(math.pi)
    pressing *= math.gamma(1.0 + part) / math.gamma(0.5 + part)
    until = 2.0 / speed + pressing
    model = thrown(mass, speed, stiffness, power, turned)
    run = hb.simulate(model, until, solver=solver, rtol=RTOL)
    assert run.status == "ok" and run.audit().holds()
    assert run["v.f"].at(until) == pytest.approx(-speed, rel=6.0 * RTOL)
    # it is back where it has been thrown
    back = run["k.q"].at(until) * (-1.0 if turned else 1.0)
    assert back == pytest.approx(-1.0, rel=6.0 * RTOL)
    force = -run["k.e"].min() if turned else run["k.e"].max()
    assert force == pytest.approx(stiffness * pressed**power, rel=1e-5)
