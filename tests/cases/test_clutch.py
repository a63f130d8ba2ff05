"""DC motor, clutch, load (the clutch of the MTT tool), and the rigid limit."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

# flux, rotor momentum, twist, load momentum, 1
OPEN = np.array(
    [
        [-10.0, -0.1, 0.0, 0.0, 1.0],
        [10.0, -0.01, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, -5.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0],
    ]
)
CLOSED = OPEN.copy()
CLOSED[1, 2] = -100.0
CLOSED[2, 1], CLOSED[2, 3] = 0.1, -1.0
CLOSED[3, 2] = 100.0


def exact(t):
    z = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    z = expm(OPEN * min(t, 5.0)) @ z
    if t > 5.0:
        z = expm(CLOSED * (min(t, 15.0) - 5.0)) @ z
    if t > 15.0:
        z[2] = 0.0
        z = expm(OPEN * (t - 15.0)) @ z
    return z


def test_published_speeds(simulate, solver):
    run = simulate("clutch", solver=solver)
    near = {"abs": 1e-6}
    assert run["w1.f"].at(5.0) == pytest.approx(0.381608, **near)
    for t, motor, load in [
        (6.0, 0.266659, 0.305830),
        (8.0, 0.197976, 0.198710),
        (10.0, 0.174813, 0.175090),
        (15.0, 0.164562, 0.164578),
    ]:
        assert run["w1.f"].at(t) == pytest.approx(motor, **near)
        assert run["w2.f"].at(t) == pytest.approx(load, **near)
    assert run["w1.f"].at(20.0) == pytest.approx(0.481893, **near)
    assert run["w1.f"].at(15.0) == pytest.approx(0.1639344, rel=0.005)


def test_load_peak(simulate, solver):
    run = simulate("clutch", solver=solver, until=6.0)
    t = np.linspace(5.25, 5.35, 2001)
    w = np.array(run["w2.f"].at(t))
    assert w.max() == pytest.approx(0.50356, abs=5e-6)
    assert t[w.argmax()] == pytest.approx(5.3021, abs=1e-4)


@pytest.mark.sampled(1)
def test_against_the_exact_solution(simulate, solver):
    run = simulate("clutch", solver=solver)
    t = np.linspace(0.0, 20.0, 57)
    found = run.sample(t.tolist(), ["winding.p", "rotor.p", "shaft.q", "load.p"], side="left")
    for k, a in enumerate(t):
        z = exact(a)
        for name, value in zip(found, z, strict=False):
            assert found[name][k] == pytest.approx(value, rel=1e-6, abs=1e-7)


def test_opening_loses_the_twist_only(simulate):
    run = simulate("clutch")
    assert [(e.t, e.cause) for e in run.events] == [(0.0, "start"), (5.0, "time"), (15.0, "time")]
    opening = run.events[2]
    paths = [s.path for s in run.graph.storages]
    for path, before, after in zip(paths, opening.before, opening.after, strict=False):
        assert after == (0.0 if path == "shaft.q" else before)
    twist = opening.before[paths.index("shaft.q")]
    assert opening.steps[0].energy.lost == pytest.approx(50.0 * twist**2, rel=1e-9)


def test_rigid_clutch_conserves_momentum(simulate, solver):
    run = simulate("clutch_rigid", solver=solver)
    before = run["w1.f"].at(5.0, side="left")
    assert before == pytest.approx(0.381608, abs=1e-6)
    for name in ("w1.f", "w2.f"):
        assert run[name].at(5.0) == pytest.approx(0.346916, abs=1.5e-6)
        assert run[name].at(5.0) == pytest.approx(10 * before / 11, rel=1e-12)
    closing = run.events[1]
    assert closing.steps[0].energy.lost == pytest.approx(0.5 * (10 / 11) * before**2, rel=1e-9)
    assert closing.steps[0].energy.source == 0.0
    assert run["w1.f - w2.f"].at(12.0) == pytest.approx(0.0, abs=1e-12)
    # engaged, the steady state is that of the elastic clutch
    assert run["w1.f"].at(14.99) == pytest.approx(0.1639344, rel=0.005)


def test_rigid_clutch_against_the_exact_solution(simulate):
    run = simulate("clutch_rigid")
    joined = np.array([[-10.0, -1.0, 1.0], [10.0 / 11.0, -5.1 / 11.0, 0.0], [0.0, 0.0, 0.0]])
    z = np.array([run["winding.p"].at(5.0), run["w1.f"].at(5.0), 1.0])
    for t in (5.5, 7.0, 10.0, 14.0):
        want = expm(joined * (t - 5.0)) @ z
        assert run["winding.p"].at(t) == pytest.approx(want[0], rel=1e-6)
        assert run["w2.f"].at(t) == pytest.approx(want[1], rel=1e-6)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("solver", "order"), [("euler", 1), ("rk4", 4)])
def test_fixed_steps_converge(solver, order, simulate):
    want = exact(4.0)[1]
    errors = [
        abs(simulate("clutch", until=4.0, solver=solver, step=h)["rotor.p"].at(4.0) - want)
        for h in (0.02, 0.01)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)
