"""A tank that is empty is filled again, whatever else moves in the model.

What is filled and what it rests on have their kinks at one instant. A step that was repeated to end
there had the second one at its very beginning, by what its stages were off: steps led nowhere
beside a tank that it is not even connected to (HB-N409), or took half a minute.
"""

import math
from typing import Literal

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

TANKS = [
    (0.15762993183061516, 0.3, 0.4, 0.9445135671894389, 1.6642506167896733),
    (0.5, 0.2, 0.9, 1.3, 2.0),
    (2e-3, 0.1, 0.02, 0.01, 40.0),
]
"""Capacity, first level, outlet, inflow and its frequency."""


def filled(tank: tuple[float, ...], beside: bool, turned: bool) -> hb.Model:
    """Return a tank that a pump fills half of the time, maybe beside one that runs out."""
    capacity, level, outlet, inflow, often = tank
    m = hb.Model("tanks")
    sign = "-" if turned else ""
    m.add(s=hb.Sf(f"{sign}{inflow}*max(0, sin({often}*time))"), a=hb.Zero())
    m.add(A=hb.C(capacity, q=capacity * level), o=hb.R({"f": f"{outlet}*sqrt(max(e, 0))"}))
    m.bond("a -> s" if turned else "s -> a", "a -> A", "a -> o")
    if beside:
        m.add(b=hb.Zero(), B=hb.C(4.3, q=0.86), p=hb.R({"f": "0.0802*sqrt(max(e, 0))"}))
        m.bond("b -> B", "b -> p")
    return m


def levels_of(tank: tuple[float, ...], ts: np.ndarray) -> np.ndarray:
    """Return its levels, from one kink of the pump to the next."""
    capacity, level, outlet, inflow, often = tank

    def rate(t: float, h: np.ndarray) -> list[float]:
        pumped = inflow * max(0.0, math.sin(often * t))
        return [(pumped - outlet * math.sqrt(max(h[0], 0.0))) / capacity]

    out = np.empty(len(ts))
    half = math.pi / often
    for k in range(math.ceil(ts[-1] / half)):
        span = (k * half, (k + 1) * half)
        run = solve_ivp(rate, span, [level], "Radau", rtol=1e-10, atol=1e-13, dense_output=True)
        within = (ts >= span[0]) & (ts <= span[1])
        out[within] = run.sol(ts[within])[0]
        level = max(float(run.y[0, -1]), 0.0)
    return out


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of the oracle, where nothing is off
@pytest.mark.sampled(4)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize("beside", [True, False], ids=["beside", "alone"])
@pytest.mark.parametrize("tank", TANKS, ids=["met", "sooner", "small"])
def test_it_is_filled_again(
    tank: tuple[float, ...],
    beside: bool,
    turned: bool,
    solver: Literal["auto", "radau", "rk45"],
) -> None:
    until = 5.3 * math.pi / tank[4]
    ts = np.linspace(0.0, until, 102)[1:-1]
    right = levels_of(tank, ts)
    assert right.min() < 1e-9 < 1e-3 < right[-1]
    run = hb.simulate(filled(tank, beside, turned), until, solver=solver, max_steps=5000)
    assert run.status == "ok" and run.audit().holds()
    assert np.abs(run["A.e"].at(ts.tolist()) - right).max() < 1e-6 * right.max()
    if beside:
        out = (math.sqrt(0.2) - 0.0802 * ts / 8.6) ** 2
        assert run["B.e"].at(ts.tolist()) == pytest.approx(out, rel=1e-6)
