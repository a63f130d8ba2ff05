"""`auto` goes over to implicit steps where explicit ones lead nowhere, whatever two stages say.

Friction that saturates between the stages of a step looks a third as steep as it is, and two
capacitors that are level to the last digit do not move at all: 60 000 steps within a millisecond,
or HB-N409.
"""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from engine.test_slow_beside_fast_in_steps import beside_bent
from scipy.integrate import solve_ivp

import hybond as hb

STRENGTH = 30.0
UNTIL = 4.0


def push(t: float) -> float:
    return 2.0 * math.sin(3.0 * t)


@functools.cache
def held_by_dry_friction() -> float:
    """Return where a body of 1 kg on a spring ends that Coulomb's friction of 1 N holds."""
    t, x = 0.0, 0.0
    while t < UNTIL:
        # it rests until what pushes is more than the friction
        ahead = np.linspace(t, UNTIL, 400_001)
        free = np.nonzero(np.abs(2.0 * np.sin(3.0 * ahead) - STRENGTH * x) > 1.0)[0]
        if free.size == 0:
            break
        t = float(ahead[free[0]])
        way = math.copysign(1.0, push(t) - STRENGTH * x)
        x, t = slides(x, t, way)
    return x


def slides(x: float, t: float, way: float) -> tuple[float, float]:
    """Return where and when it comes to a stop."""

    def rates(s: float, y: np.ndarray) -> list[float]:
        return [y[1], push(s) - STRENGTH * y[0] - way]

    def stops(_: float, y: np.ndarray) -> float:
        return float(y[1]) * way

    stops.terminal, stops.direction = True, -1.0  # type: ignore[attr-defined]
    y = [x, way * 1e-12]
    run = solve_ivp(rates, (t, UNTIL), y, "DOP853", rtol=1e-10, atol=1e-13, events=stops)
    return float(run.y[0, -1]), float(run.t[-1])


LAWS = {
    "that is cut off": "min(max(f/1e-7, -1), 1)",
    "like a root": "f/sqrt(f^2 + 1e-18)",
    "like an angle": "2*atan(f/1e-8)/pi",
    "like a quotient": "f/(1e-8 + abs(f))",
}


@pytest.mark.parametrize("name", LAWS)
def test_friction(name: str) -> None:
    m = hb.Model("held")
    m.add(F=hb.Se("2*sin(3*time)"), v=hb.One(), i=hb.I(1.0), c=hb.C(1.0 / STRENGTH))
    m.add(r=hb.R({"e": LAWS[name]}))
    m.bond("F -> v -> i", "v -> c", "v -> r")
    run = hb.simulate(m, UNTIL, max_steps=10_000)
    # the last two come to their limit slowly: a part in 1e5 of it is left at the speeds there are
    assert run["c.q"].at(UNTIL) == pytest.approx(held_by_dry_friction(), rel=1e-4)


@pytest.mark.parametrize("r", [1e-13, 1e-17])
def test_capacitors_that_are_level(r: float) -> None:
    """What joins them has nothing to do but for a leak, a part in 1e18 of it."""
    m = hb.Model("level")
    m.add(a=hb.C(1.0, e=3.0), b=hb.C(1.0, e=3.0), na=hb.Zero(), nb=hb.Zero(), s=hb.One())
    m.add(r=hb.R(r), l=hb.R(1e6))
    m.bond("na -> a", "nb -> b", "na -> s -> nb", "s -> r", "nb -> l")
    beside_bent(m)
    run = hb.simulate(m, 2e6, max_steps=2000)
    assert run["a.e"].at(2e6) == pytest.approx(3.0 * math.exp(-1.0), rel=1e-7)
