"""Methods of integration by the library: orders, tolerances, stiffness, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb


def system(start: dict[str, float], **rates: str) -> hb.Model:
    """Return integrals alone, beside an idle circuit."""
    m = hb.Model("system")
    m.add(c=hb.C(1.0), g=hb.G(1.0))
    m.bond("c -> g")
    m.signal(**{name: hb.Integral(rate, start=start[name]) for name, rate in rates.items()})
    return m


def riccati() -> hb.Model:
    """y = 1/(1.5 - sin t), neither linear nor autonomous."""
    return system({"y": 1 / 1.5}, y="y^2*cos(1*time)")


def off_riccati(run: hb.Result, t: np.ndarray) -> float:
    return float(np.abs(run["y"].at(t.tolist()) - 1.0 / (1.5 - np.sin(t))).max())


@pytest.mark.parametrize(
    ("solver", "order", "between"),
    [("euler", 1, 2), ("rk4", 4, 4), ("rk45", 5, 5)],
)
def test_orders_at_ends_of_steps_and_between(solver: str, order: int, between: int) -> None:
    ends, dense = [], []
    for n in (80, 160):
        h = 2.0 / n
        # errors of any size pass where the longest step is what limits steps
        fixed = {"step": h} if solver in ("euler", "rk4") else {"max_step": h, "atol": 0.1}
        run = hb.simulate(riccati(), 2.0, solver=solver, rtol=1e-9, **fixed)
        (segment,) = run.segments
        ends.append(off_riccati(run, segment.t))
        inner = segment.t[:-1] + 0.4 * np.diff(segment.t)
        dense.append(off_riccati(run, inner))
    assert math.log2(ends[0] / ends[1]) == pytest.approx(order, abs=0.5)
    # between steps the error at their ends is there as well
    assert math.log2(dense[0] / dense[1]) >= min(order, between) - 0.6


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_the_error_follows_the_tolerance(solver: str) -> None:
    """One revolution of a Kepler orbit of eccentricity 0.5 ends where it began."""
    start = {"x": 0.5, "y": 0.0, "u": 0.0, "v": math.sqrt(3.0)}
    m = system(start, x="u", y="v", u="-x/hypot(x, y)^3", v="-y/hypot(x, y)^3")
    tolerances = [1e-4, 1e-6, 1e-8, 1e-10]
    errors = []
    for tol in tolerances:
        run = hb.simulate(m, 2 * math.pi, solver=solver, rtol=tol, atol=tol)
        errors.append(max(abs(run.final[k] - a) for k, a in start.items()))
    slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
    assert 0.8 < slope < 1.5
    assert errors[1] < 1e-3


ROBERTSON = {
    "x": "1e4*y*z - 0.04*x",
    "y": "0.04*x - 1e4*y*z - 3e7*y^2",
    "z": "3e7*y^2",
}


def test_robertson_against_the_published_digits() -> None:
    """Hairer and Wanner's test set at t = 40: digits agreed by many codes."""
    m = system({"x": 1.0, "y": 0.0, "z": 0.0}, **ROBERTSON)
    run = hb.simulate(m, 40.0, solver="radau", rtol=1e-8, atol=1e-13)
    found = [run.final[k] for k in "xyz"]
    assert found == pytest.approx([0.7158270688, 9.185534765e-6, 0.2841637457], rel=1e-6)
    assert sum(found) == pytest.approx(1.0, abs=1e-12)
    assert run.stats["steps"] < 300


@pytest.mark.parametrize("stiffness", [1e2, 1e5, 1e8])
def test_prothero_and_robinson_at_any_stiffness(stiffness: float) -> None:
    """y' = lambda (y - g(t)) + g'(t) has the solution g whatever lambda."""
    m = system({"y": 0.0}, y=f"-{stiffness}*(y - sin(1*time)) + cos(1*time)")
    run = hb.simulate(m, 3.0, solver="radau", rtol=1e-6, atol=1e-7)
    assert run.final["y"] == pytest.approx(math.sin(3.0), abs=2e-6)
    assert run.stats["steps"] < 80


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("rate", [-1.0, 1.0])
def test_the_tolerance_follows_a_state_that_grows(solver: str, rate: float) -> None:
    m = system({"y": 1.0}, y=f"{rate}*y")
    run = hb.simulate(m, 20.0, solver=solver, rtol=1e-6)
    size = math.exp(20.0) if rate > 0 else 1.0
    assert run.final["y"] == pytest.approx(math.exp(rate * 20.0), abs=200e-6 * size)


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_a_kick_that_no_step_before_foresees_is_resolved(solver: str) -> None:
    m = system({"y": 1.0}, y="-y + 1000*exp(-((time - 1)/0.01)^2)")
    run = hb.simulate(m, 2.0, solver=solver, rtol=1e-7, max_step=0.05)
    kick = 1e3 * 1e-2 * math.sqrt(math.pi) * math.exp(-1.0 + 0.25e-4)
    assert run.final["y"] == pytest.approx(math.exp(-2.0) + kick, rel=1e-5)
    assert run.stats["rejected"] > 0


@pytest.mark.parametrize("n", [30, 70])
def test_a_heat_equation_decays_as_its_slowest_mode(n: int) -> None:
    k = (n + 1.0) ** 2
    first = np.sin(math.pi * np.arange(1, n + 1) / (n + 1))
    near = [[f"y{j}" for j in (i - 1, i + 1) if 0 <= j < n] for i in range(n)]
    rates = {f"y{i}": f"{k}*({' + '.join(own)} - 2*y{i})" for i, own in enumerate(near)}
    m = system({f"y{i}": float(a) for i, a in enumerate(first)}, **rates)
    run = hb.simulate(m, 0.1, solver="radau", rtol=1e-7)
    decay = math.exp(-0.1 * 4.0 * math.sin(math.pi / (2 * (n + 1))) ** 2 * k)
    assert [run.final[f"y{i}"] for i in range(n)] == pytest.approx(first * decay, rel=1e-4)


@pytest.mark.slow
def test_van_der_pol_through_its_fast_transitions() -> None:
    m = system({"y": 2.0, "v": 0.0}, y="v", v="50*(1 - y^2)*v - y")

    def field(t: float, y: np.ndarray) -> list[float]:
        return [y[1], 50.0 * (1 - y[0] ** 2) * y[1] - y[0]]

    true = solve_ivp(field, (0, 60), [2.0, 0.0], method="Radau", rtol=1e-11, atol=1e-12)
    run = hb.simulate(m, 60.0, solver="radau", rtol=1e-8, atol=1e-10)
    assert run.final["y"] == pytest.approx(true.y[0, -1], abs=1e-5)


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_a_motion_that_ends_stops_the_run_there(solver: str) -> None:
    """y' = y^2 from 1 is 1/(1 - t): there is no motion beyond 1 s."""
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(system({"y": 1.0}, y="y^2"), 2.0, solver=solver)
    assert caught.value.code in ("HB-N201", "HB-N202")
    assert caught.value.partial.t_end == pytest.approx(1.0, abs=1e-3)
