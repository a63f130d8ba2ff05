"""Oscillator with Coulomb friction: m = k = F = 1, x(0) = 12, v(0) = 6."""

import math

import pytest

TURNING = [13.317821, -11.317821, 9.317821, -7.317821, 5.317821, -3.317821, 1.317821]
REST = 0.682179


def test_turning_points_and_rest(simulate, modes_of, solver):
    run = simulate("coulomb_friction", solver=solver)
    assert run.status == "ok"
    stops = run.events[1:]
    found = [run["spring.q"].at(e.t) for e in stops]
    assert found == pytest.approx([*TURNING, REST], abs=2e-6)
    first = math.atan2(6.0, 13.0)
    assert [e.t for e in stops] == pytest.approx([first + k * math.pi for k in range(8)], rel=1e-6)
    for k, event in enumerate(stops[:-1]):
        to = "left" if k % 2 == 0 else "right"
        assert modes_of(run, event) == [(("stick",), "mythical"), ((to,), "continuous")]
    assert modes_of(run, stops[-1]) == [(("stick",), "continuous")]
    assert run["spring.q"].at(25.0) == pytest.approx(REST, abs=2e-6)
    assert run["v.f"].at(25.0) == pytest.approx(0.0, abs=1e-9)
    assert abs(run["rub.e"].at(25.0)) == pytest.approx(REST, abs=2e-6)


def test_higher_breakaway_force_holds_earlier(simulate):
    """At 1.317821 the spring pulls with more than 1 N, but less than 1.5 N."""
    run = simulate("coulomb_friction", parameters={"Fb": "1.5 N"})
    assert run.mode == {"face": "stick"}
    assert run["spring.q"].at(25.0) == pytest.approx(1.317821, abs=2e-6)


# the first turning point is an amplitude: on the circle RK4 loses it with h^6 a step, so order 5
@pytest.mark.parametrize(("solver", "order"), [("euler", 1), ("rk4", 5)])
def test_fixed_steps_converge(solver, order, simulate):
    exact = math.sqrt(13.0**2 + 6.0**2) - 1.0
    errors = [
        abs(
            simulate("coulomb_friction", until=1.0, solver=solver, step=h).segments[0].y[-1, 1]
            - exact
        )
        for h in (0.02, 0.01)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.7)
