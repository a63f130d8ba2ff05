"""A flow through ``k*f*abs(f)`` that follows what others do is driven by less than their error."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

C, K, G, END = 2.5e-4, 1.6e-3, 2.2e-3, 0.85
TIMES = np.array([1e-5, 0.01, 0.2, 0.5, END])


def tanks(*, solver: str, signal: bool, turned: bool, dual: bool) -> hb.Result:
    """Two tanks, the first of which is full, joined by a rough pipe; the second leaks."""
    m = hb.Model("tanks")
    if dual:
        m.add(
            a=hb.I(C, p=-4.0 * C if turned else 4.0 * C),
            b=hb.I(C),
            leak=hb.R(G),
            m1=hb.One(),
            m2=hb.One(),
        )
        m.add(pipe=hb.Zero(), rough=hb.R({"f": f"{K}*e*abs(e)"}))
        m.bond("m1 -> a" if not turned else "a -> m1", "m2 -> b", "m2 -> leak", "pipe -> rough")
        m.bond("m1 -> pipe", "pipe -> m2")
    else:
        m.add(a=hb.C(C, q=4.0 * C), b=hb.C(C), leak=hb.G(G), m1=hb.Zero(), m2=hb.Zero())
        m.add(pipe=hb.One(), rough=hb.R({"e": f"{K}*f*abs(f)"}))
        m.bond("m1 -> a" if not turned else "a -> m1", "m2 -> b", "m2 -> leak", "pipe -> rough")
        m.bond("m1 -> pipe", "pipe -> m2")
    if signal:
        m.signal(area=hb.Integral("b.p" if dual else "b.q"))
    return hb.simulate(m, END, solver=solver)


@functools.cache
def levels() -> tuple[np.ndarray, np.ndarray]:
    """Return what is in the second tank and what flows to it, found with the flow as a state."""

    def rates(_: float, y: np.ndarray) -> list[float]:
        total, flow = y
        leaks = G * 0.5 * (total - C * K * flow * flow) / C
        return [-leaks, (leaks - 2.0 * flow) / (2.0 * C * K * flow)]

    start = [4.0 * C, np.sqrt(4.0 / K)]
    found = solve_ivp(rates, (0.0, END), start, "Radau", TIMES, rtol=1e-11, atol=1e-18)
    total, flow = found.y
    return 0.5 * (total - C * K * flow * flow), flow


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("signal", [False, True])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("dual", [False, True])
def test_two_tanks_joined_by_a_rough_pipe_empty_as_one(
    solver: str, signal: bool, turned: bool, dual: bool
) -> None:
    """Steps were as short as the settling, the flow went to and fro, and the run was refused."""
    run = tanks(solver=solver, signal=signal, turned=turned, dual=dual)
    held, flow = levels()
    stored, moved = ("b.p", "pipe.e") if dual else ("b.q", "pipe.f")
    assert run[stored].at(TIMES.tolist()) == pytest.approx(held, rel=1e-7)
    assert run[moved].at(TIMES[:3].tolist()) == pytest.approx(flow[:3], rel=1e-4)
    assert run.stats["steps"] < 500
