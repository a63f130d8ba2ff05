"""Evaporator with inertia in its overflow: a relaxation cycle, not a sliding motion."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

AREA, HEAD, EDGE, DRAIN, FEED, LOSS = 0.5, 9810.0, 0.8, 4e-5, 8e-3, 2.5e5


def cycles(inertia, until):
    """Return the instants of opening, one per cycle, and the highest level after the first."""

    def field(t, z):
        pressure = HEAD * z[0]
        return [
            (FEED - DRAIN * math.sqrt(pressure) - z[1]) / AREA,
            (pressure - LOSS * z[1]) / inertia,
        ]

    def filling(t, z):
        return [(FEED - DRAIN * math.sqrt(HEAD * z[0])) / AREA]

    def edge(t, z):
        return z[0] - EDGE

    edge.terminal, edge.direction = True, 1.0
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    fill = solve_ivp(filling, (0.0, until), [0.6], events=edge, **options)
    edge.direction = -1.0
    part = solve_ivp(field, (0.0, until), [EDGE, 0.0], events=edge, dense_output=True, **options)
    length = float(part.t[-1])
    levels = part.sol(np.linspace(0.0, length, 2000))[0]
    # closing resets the flow, and the level stands at the edge: every cycle is the same
    first = float(fill.t[-1])
    return np.arange(first, until, length), float(levels.max()) - EDGE


def opened(run):
    states = [run.graph.mode_names(e.steps[-1].mode)["overflow"] for e in run.events]
    return [e for e, s in zip(run.events, states, strict=True) if s == "runs"]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_every_cycle_is_the_same(rtol, simulate):
    run = simulate("evaporator", rtol=rtol)
    expected, overshoot = cycles(1e6, run.until)
    assert not run.sliding
    assert len(opened(run)) == len(expected)
    tolerance = max(10.0 * rtol, 1e-7)
    assert [e.t for e in opened(run)] == pytest.approx(list(expected), rel=tolerance)
    # each closing, but no opening, resets the flow
    resets = [e for e in run.events if any(s.impulses for s in e.steps)]
    assert len(resets) == len(expected) - 1
    # by which it opens again at once: being closed is a pinnacle
    assert len(run.events) == 1 + len(expected)
    assert {tuple(s.kind for s in e.steps) for e in resets} == {("pinnacle", "continuous")}
    t = np.linspace(expected[0], run.until, 4000)
    assert run["level"].at(t).max() - EDGE == pytest.approx(overshoot, rel=1e-4)


@pytest.mark.slow
def test_overshoot_is_proportional_to_the_inertia(simulate):
    """For a small inertia; the overshoot here is about 7 mm."""
    found = []
    for inertia in (2e5, 4e5):
        run = simulate("evaporator", parameters={"length": f"{inertia} kg/m^4"}, until=24.0)
        expected, overshoot = cycles(inertia, 24.0)
        assert len(opened(run)) == len(expected)
        t = np.linspace(expected[0], expected[1], 2000)
        found.append(run["level"].at(t).max() - EDGE)
        assert found[-1] == pytest.approx(overshoot, rel=1e-5)
    assert found[1] / found[0] == pytest.approx(2.0, rel=0.02)


@pytest.mark.slow
def test_an_edge_below_both_steady_levels_keeps_the_pipe_running(simulate):
    """The pipe takes so little that the level stays above the edge."""
    run = simulate(
        "evaporator", parameters={"loss": "4e6 Pa*s/m^3"}, until=1500.0, rtol=1e-8, solver="radau"
    )
    assert len(opened(run)) == 1
    level = run["level"].at(1500.0)
    assert EDGE < level < (FEED / DRAIN) ** 2 / HEAD
    assert DRAIN * math.sqrt(HEAD * level) + HEAD * level / 4e6 == pytest.approx(FEED, rel=1e-4)
