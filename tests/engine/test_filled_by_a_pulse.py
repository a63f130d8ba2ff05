"""Tanks that stand empty until a pulse fills them: the slope of the outlet has no bound before.

Beside an edge one matrix serves not all stages of an implicit step, and what is left of one that
was made on it makes every correction next to nothing. SciPy integrates the same equations, in
pieces that see the pulse; what a pulse brings is known in closed form.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ("auto", "radau", "rk45")


def bell(width: float) -> tuple[str, Callable[[float], float]]:
    """A bell about 0.5 s that brings ``sqrt(pi)/2`` C."""
    return (
        f"{0.5 / width} A*exp(-((time/(1 s) - 0.5)/{width!r})^2)",
        lambda t: 0.5 / width * math.exp(-min(((t - 0.5) / width) ** 2, 700.0)),
    )


PULSES = {
    "narrow": bell(1e-3),
    "wide": bell(1e-2),
    "triangle": (
        "500 A*max(0, 1 - abs(time/(1 s) - 0.5)/1e-3)",
        lambda t: 500.0 * max(0.0, 1.0 - abs(t - 0.5) / 1e-3),
    ),
    "polynomial": (
        "500 A*max(0, 1 - ((time/(1 s) - 0.5)/1e-3)^2)^2",
        lambda t: 500.0 * max(0.0, 1.0 - ((t - 0.5) / 1e-3) ** 2) ** 2,
    ),
}
BROUGHT = {
    "narrow": 0.5 * math.sqrt(math.pi),
    "wide": 0.5 * math.sqrt(math.pi),
    "triangle": 0.5,
    "polynomial": 500.0 * 1e-3 * 16.0 / 15.0,
}


def tank(source: str, level: float) -> hb.Model:
    m = hb.Model("tank", domain="electrical")
    m.add(S=hb.Sf(source), c=hb.C("1 F", e=f"{level} V"), n=hb.Zero())
    m.add(o=hb.R({"f": "1 [A/V^0.5]*sqrt(e)"}))
    m.bond("S -> n -> c", "n -> o")
    return m


@cache
def meant(pulse: str) -> float:
    """Return what is there at 1 s; what comes before four widths is less than 1e-8 of all."""
    rate = PULSES[pulse][1]
    y = np.array([0.0])
    width = 1e-2 if pulse == "wide" else 1e-3
    places = (*(0.5 + k * width for k in (-4.0, -1.0, 0.0, 1.0, 6.0)), 1.0)
    for a, b in pairwise(places):
        y = solve_ivp(
            lambda t, y: [rate(t) - math.copysign(math.sqrt(abs(y[0])), y[0])],
            (a, b),
            y,
            method="DOP853",
            rtol=1e-9,
            atol=1e-13,
        ).y[:, -1]
    return float(y[0])


@pytest.mark.parametrize("level", [0.0, 0.04])
@pytest.mark.parametrize("pulse", list(PULSES))
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_pulse_fills_it(solver: str, pulse: str, level: float) -> None:
    """From 0.04 V it is empty after 0.4 s; radau alone said 3e-42 V after the narrow bell."""
    run = hb.simulate(tank(PULSES[pulse][0], level), 1.0, solver=solver, max_steps=20000)
    assert run["c.e"].at(1.0) == pytest.approx(meant(pulse), rel=2e-7)
    assert not run.warnings


@pytest.mark.parametrize("pulse", ["narrow", "wide"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_it_is_read_between_its_points(solver: str, pulse: str) -> None:
    """What flowed in is there, or has flowed out; nowhere is there less than nothing."""
    run = hb.simulate(tank(PULSES[pulse][0], 0.0), 1.0, solver=solver)
    came = float(run["S.f"].integral())
    assert came == pytest.approx(BROUGHT[pulse], rel=1e-6)
    assert float(run["o.f"].integral()) == pytest.approx(came - run["c.q"].at(1.0), rel=1e-6)
    levels = run.sample(np.linspace(0.0, 1.0, 1001), ["c.e"])["c.e"]
    assert levels.min() > -1e-12
    assert run.audit().holds()
    assert "o" in str(run.losses())
