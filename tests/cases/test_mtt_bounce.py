"""MTT's bouncing ball and rod: converged solutions, not those of the published plots."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp


@pytest.mark.sampled(1)
def test_ball_with_air_drag(simulate, solver):
    run = simulate("bouncing_ball_air", solver=solver)
    times = [e.t for e in run.events[1:5]]
    assert times[0] == pytest.approx(1.864375, abs=6e-7)
    assert times[1] == pytest.approx(2.204838, abs=6e-7)
    assert run["v.f"].at(times[0]) == pytest.approx(-8.289518, abs=2e-6)
    assert run["v.f"].at(times[1]) == pytest.approx(6.881578, abs=2e-6)
    assert run["height"].at(2.028492) == pytest.approx(-0.862574, abs=2e-6)
    assert run["v.f"].at(2.028492) == pytest.approx(0.0, abs=1e-4)
    assert run["height"].at(2.736340) == pytest.approx(1.667543, abs=2e-6)
    t = np.linspace(3.4, 6.5, 20001)
    heights = run["height"].at(t)
    peaks = [h for a, h, b in zip(heights, heights[1:], heights[2:], strict=False) if a < h > b]
    assert peaks[:2] == pytest.approx([0.579465, 0.237059], abs=2e-6)


def test_ball_with_air_drag_comes_to_rest(simulate):
    run = simulate("bouncing_ball_air", until=40.0)
    assert run["height"].at(40.0) == pytest.approx(-0.0981, abs=1e-6)
    assert run.mode == {"floor": "touching"}


@pytest.mark.sampled(1)
def test_the_rod_keeps_its_energy(simulate, solver):
    run = simulate("bouncing_rod", solver=solver, rtol=1e-9)
    assert run.events[1].t == pytest.approx(1.3764358, abs=6e-8)
    t = np.linspace(0.0, 10.0, 500)
    kinetic = 0.5 * run["vy.f"].at(t) ** 2 + run["w.f"].at(t) ** 2 / 6.0
    springs = (run["floor1.q"].at(t) ** 2 + run["floor2.q"].at(t) ** 2) / 0.02
    energy = kinetic + springs + 9.81 * run["y"].at(t)
    assert energy == pytest.approx(98.1, rel=1e-5)


@pytest.mark.slow
def test_the_rod_against_another_integrator(simulate):
    """While a tip is below ground its spring is as long as it is deep."""
    run = simulate("bouncing_rod", rtol=1e-10)

    def field(t, z):
        y, th, v, w = z
        one, two = y + math.sin(th), y - math.sin(th)
        f1, f2 = 100.0 * max(-one, 0.0), 100.0 * max(-two, 0.0)
        return [v, w, -9.81 + f1 + f2, 3.0 * math.cos(th) * (f1 - f2)]

    other = solve_ivp(
        field, (0.0, 5.0), [10.0, math.pi / 4, 0.0, 0.0], method="DOP853",
        rtol=1e-12, atol=1e-12, max_step=5e-3, dense_output=True,
    )  # fmt: skip
    for t in (1.5, 2.0, 3.0, 4.0, 4.3, 5.0):
        y, th, v, w = other.sol(t)
        found = [run[n].at(t) for n in ("y", "theta", "vy.f", "w.f")]
        assert found == pytest.approx([y, th, v, w], rel=1e-5, abs=1e-5)
