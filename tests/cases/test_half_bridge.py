"""Half bridge: 24 V at a duty of 0.6 on 1 mH and 2 ohm; period 100 us."""

import math

import pytest

V, R, L, PERIOD, DUTY = 24.0, 2.0, 1e-3, 100e-6, 0.6
TAU = L / R


def exact(t):
    """From rest at t = 0, where the upper switch closes."""
    x = math.exp(-PERIOD / TAU)
    low = V / R * (math.exp(DUTY * PERIOD / TAU) - 1) * x / (1 - x)  # of the periodic motion
    k = math.floor(t / PERIOD + 1e-9)
    start = low * (1 - x**k)
    since = t - k * PERIOD
    on = min(since, DUTY * PERIOD)
    i = V / R + (start - V / R) * math.exp(-on / TAU)
    return i * math.exp(-(since - on) / TAU)


def test_against_the_closed_form(simulate, solver):
    run = simulate("half_bridge", solver=solver)
    assert run.status == "ok"
    for k in range(30):
        for part in (0.0, 0.2, 0.6, 0.8):
            t = (k + part) * PERIOD
            assert run["L.f"].at(t) == pytest.approx(exact(t), rel=1e-6, abs=1e-9)
    assert run["L.f"].at(3e-3) == pytest.approx(exact(3e-3), rel=1e-6)


def test_edges_are_hit(simulate, modes_of):
    run = simulate("half_bridge")
    edges = [e.t for e in run.events[1:]]
    want = sorted([(k + DUTY) * PERIOD for k in range(30)] + [k * PERIOD for k in range(1, 31)])
    assert edges == pytest.approx(want, rel=1e-12)
    for k, event in enumerate(run.events[1:]):
        state = ("high",) if k % 2 else ("low",)
        assert modes_of(run, event) == [(state, "continuous")]
        assert event.cause == "input"
        assert (event.before == event.after).all()
    assert run["out.e"].at(30e-6) == pytest.approx(24.0)
    assert run["out.e"].at(80e-6) == pytest.approx(0.0, abs=1e-12)


def test_mean_of_the_periodic_motion(simulate):
    """Over one period of the periodic motion the mean is duty * V / R."""
    run = simulate("half_bridge", until="10 ms")
    edge = math.exp(-PERIOD / TAU)
    low = run["L.f"].at(10e-3)
    assert low == pytest.approx(
        V / R * (math.exp(DUTY * PERIOD / TAU) - 1) * edge / (1 - edge), rel=1e-6
    )


@pytest.mark.parametrize(("solver", "order"), [("euler", 1), ("rk4", 4)])
def test_fixed_steps_converge(solver, order, simulate):
    errors = [
        abs(
            simulate("half_bridge", until=1e-3, solver=solver, step=h)["L.f"].at(9.6e-4)
            - exact(9.6e-4)
        )
        for h in (20e-6, 10e-6)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)
