"""Volumes of oil whose steps crept, though a shut valve beside them does nothing at all."""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.testing import random_recipe

SMALL, LARGE, K = 2.0e-14, 3.0e-13, 1.0e-6
RESTS = 5.8e6
PUMPED, W = 3.5e-6, 713.0
VALVES = {
    "clamped": "3e-8*sqrt(max(0,e))",
    "branched": "if e > 0 then 3e-8*sqrt(e) else 0",
    "relief": "if e > 2e5 then 3e-8*sqrt(e-2e5) else 0",
    "clamped relief": "3e-8*sqrt(max(0,e-2e5))",
}


def beside_a_shut_valve(valve: str, turned: bool, first: bool) -> hb.Model:
    """Two volumes level through an orifice; a valve to a higher pressure is shut all the time."""
    m = hb.Model("shut", domain="hydraulic")
    shut = {"j": hb.One(), "V": hb.R({"f": valve}), "P": hb.Se("9e6")}
    if first:
        m.add(**shut)
    m.add(
        S=hb.Sf(f"{PUMPED!r}*sin({W!r}*time)"),
        n=hb.Zero(),
        A=hb.C(f"{LARGE!r} m^3/Pa", e=f"{RESTS!r} Pa"),
        k=hb.Zero(),
        B=hb.C(f"{SMALL!r} m^3/Pa", e=f"{RESTS!r} Pa"),
        o=hb.One(),
        O=hb.R({"f": f"{K!r}*sign(e)*sqrt(abs(e))"}),
    )
    if not first:
        m.add(**shut)
    m.bond("S -> n -> A", "k -> B", "k -> o -> n" if turned else "n -> o -> k", "o -> O")
    m.bond("n -> j -> P", "j -> V")
    return m


@functools.cache
def apart_at(t: float) -> float:
    """Return the pressure at the orifice, of a smooth root u: 2 u u' = pumped/LARGE - u K/both."""
    both = SMALL * LARGE / (SMALL + LARGE)

    # what passes is what fills the second volume as fast; how it settles is over in microseconds
    def rate(at: float, y: np.ndarray) -> list[float]:
        u = float(y[0])
        drives = PUMPED * math.sin(W * at) / LARGE - K / both * u
        return [drives * abs(u) / (2.0 * (u * u + 1e-12))]

    passes = PUMPED * SMALL / (SMALL + LARGE)
    begin = 0.1 / W
    end = solve_ivp(
        rate, (begin, t), [passes * math.sin(0.1) / K], method="Radau", rtol=1e-9, atol=1e-13
    )
    u = float(end.y[0, -1])
    return u * abs(u)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("valve", list(VALVES))
@pytest.mark.parametrize(("turned", "first"), [(False, False), (True, True)])
@pytest.mark.sampled(1)
def test_orifice_between_volumes_does_not_creep_beside_a_shut_valve(
    solver: str, valve: str, turned: bool, first: bool
) -> None:
    t = 0.02
    run = hb.simulate(beside_a_shut_valve(VALVES[valve], turned, first), until=t, solver=solver)
    held = run["A.q"].at(t) + run["B.q"].at(t)
    pumped = PUMPED * (1.0 - math.cos(W * t)) / W
    assert held == pytest.approx((SMALL + LARGE) * RESTS + pumped, rel=1e-9)
    passes = PUMPED * math.sin(W * t) * SMALL / (SMALL + LARGE)
    apart = run["A.e"].at(t) - run["B.e"].at(t)
    assert apart == pytest.approx(math.copysign((passes / K) ** 2, passes), rel=1e-2)
    assert apart == pytest.approx(apart_at(t), rel=1e-3)
    assert run["V.f"].at(t) == 0.0
    assert run.status == "ok"
    assert run.audit().holds()
    assert run.stats["steps"] < 1500


@pytest.mark.parametrize("seed", [102003304, 102005050, 102503475])
def test_differences_beside_roots_shift_the_state(seed: int) -> None:
    """One that the state swallows gave slopes of nothing by nothing: HB-N201 by radau."""
    recipe = random_recipe(seed)
    run = hb.simulate(recipe.model(), until=recipe.until, solver="radau")
    assert run.status == "ok"
    assert run.stats["steps"] < 1500
