"""A flow through ``k*f*abs(f)`` that follows what others do is driven by less than their error."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

C, K, G, END = 2.5e-4, 1.6e-3, 2.2e-3, 0.85
TIMES = np.array([1e-5, 0.01, 0.0456, 0.2, 0.5, 0.6706, END])


def tanks(solver: str, *, signal: bool, turned: bool, dual: bool) -> hb.Result:
    """Two tanks, the first of which is full, joined by a rough pipe; the second leaks."""
    m = hb.Model("tanks")
    one = "a -> m1" if turned else "m1 -> a"
    full = (-4.0 if turned else 4.0) * C
    if dual:
        m.add(a=hb.I(C, p=full), b=hb.I(C), leak=hb.R(G), m1=hb.One(), m2=hb.One())
        m.add(pipe=hb.Zero(), rough=hb.R({"f": f"{K}*e*abs(e)"}))
    else:
        m.add(a=hb.C(C, q=4.0 * C), b=hb.C(C), leak=hb.G(G), m1=hb.Zero(), m2=hb.Zero())
        m.add(pipe=hb.One(), rough=hb.R({"e": f"{K}*f*abs(f)"}))
    m.bond(one, "m2 -> b", "m2 -> leak", "pipe -> rough", "m1 -> pipe", "pipe -> m2")
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
@pytest.mark.parametrize(("signal", "turned"), [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("dual", [False, True])
def test_two_tanks_joined_by_a_rough_pipe_empty_as_one(
    solver: str, signal: bool, turned: bool, dual: bool
) -> None:
    """Steps were as short as the settling, and the flow went to and fro."""
    run = tanks(solver, signal=signal, turned=turned, dual=dual)
    held, flow = levels()
    stored, moved = ("b.p", "rough.e") if dual else ("b.q", "rough.f")
    assert run[stored].at(TIMES.tolist()) == pytest.approx(held, rel=1e-7)
    assert run[moved].at(TIMES.tolist()) == pytest.approx(flow, rel=5e-4)
    assert run.stats["steps"] < 250
    assert not run.warnings


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_flow_that_comes_to_rest_and_returns_follows_its_source(solver: str) -> None:
    """It was shown below zero where it nowhere is, and steps swung."""
    c, k = 1e-3, 1e-2
    m = hb.Model("filled")
    m.add(s=hb.Sf("1 + sin(1 [rad/s]*time)"), a=hb.C(c), b=hb.C(c), m1=hb.Zero(), m2=hb.Zero())
    m.add(pipe=hb.One(), rough=hb.R({"e": f"{k}*f*abs(f)"}))
    m.bond("s -> m1", "m1 -> a", "m1 -> pipe", "pipe -> rough", "pipe -> m2", "m2 -> b")
    run = hb.simulate(m, 6, solver=solver)
    times = np.linspace(0.1, 6.0, 60)
    half, slope = 0.5 * (1.0 + np.sin(times)), 0.5 * np.cos(times)
    # to first order in what the pipe delays it by, 1e-5 s: the second is 1e-10
    flow = half - k * c * half * slope
    assert run["rough.f"].at(times.tolist()) == pytest.approx(flow, abs=5e-6)
    assert min(run["rough.f"].at(times.tolist())) > 0.0
    assert not run.warnings
    assert run.stats["steps"] < 400


def test_a_flow_that_is_driven_by_rounding_is_said_to_be_off() -> None:
    """Both tanks are all but empty: what drives the flow is a last place of what they hold."""
    m = hb.Model("tanks")
    m.add(a=hb.C(C, q=4.0 * C), b=hb.C(C), leak=hb.G(G), m1=hb.Zero(), m2=hb.Zero())
    m.add(pipe=hb.One(), rough=hb.R({"e": f"{K}*f*abs(f)"}))
    m.bond("m1 -> a", "m2 -> b", "m2 -> leak", "pipe -> rough", "m1 -> pipe", "pipe -> m2")
    run = hb.simulate(m, 4, solver="radau")
    assert abs(run.final["a.q"]) < 1e-10
    assert any("its flow is off by" in each for each in run.warnings)


def test_friction_that_breaks_loose_within_a_step_does_not_swing() -> None:
    """LuGre: the speed moved by a twentieth within a step, and was said to be off by that."""
    m = hb.Model("stick and slip")
    m.add(drive=hb.Sf(0.1), spring=hb.C(0.5), mass=hb.I(1), m1=hb.Zero(), m2=hb.One())
    bristle = "(mass.f - 1e5*abs(mass.f)*z/(1 + 0.5*exp(-(mass.f/1e-3)^2)))"
    m.add(friction=hb.Se(f"-(1e5*z + 316.2*{bristle} + 0.4*mass.f)"))
    m.signal(z=hb.Integral(bristle))
    m.bond("drive -> m1", "m1 -> spring", "m1 -> m2", "m2 -> mass", "friction -> m2")

    def rates(_: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        loose = v - 1e5 * abs(v) * z / (1.0 + 0.5 * np.exp(-((v / 1e-3) ** 2)))
        return [0.1 - v, 2.0 * x - 1e5 * z - 316.2 * loose - 0.4 * v, loose]

    found = solve_ivp(rates, (0.0, 8.0), [0.0] * 3, "Radau", [7.0, 8.0], rtol=1e-10, atol=1e-14)
    run = hb.simulate(m, 8, solver="radau")
    assert run["mass.f"].at([7.0, 8.0]) == pytest.approx(found.y[1], abs=1e-7)
    assert not run.warnings
