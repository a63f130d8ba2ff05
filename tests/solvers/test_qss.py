"""Quantised states: error bounds, numbers of events, stiffness, and whole models."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import hybond as hb
from hybond.errors import UsageError
from hybond.solvers import StepFailure, make_solver
from hybond.solvers.qss import METHODS
from hybond.solvers.qss_quanta import leaves, place

NAMES = list(METHODS)
DECAY = np.array([[-1.0]])
DAMPED = np.array([[0.0, 1.0], [-4.0, -0.8]])
TRIANGLE = np.array([[-1.0, 0.5, 0.0], [0.0, -2.0, 1.0], [0.3, 0.0, -0.5]])
STIFF = np.array([[0.0, 1.0], [-1e5, -1e5 - 1.0]])
"""Eigenvalues -1 and -1e5."""


def started(name, field, y, *, tol, t_bound=10.0, relative=0.0, **options):
    solver = METHODS[name](
        lambda a, b: tol + relative * np.abs(b), rtol=max(tol, relative), **options
    )
    solver.start(field, 0.0, np.array(y, dtype=float), t_bound=t_bound, jumped=True)
    return solver


def run(solver, t_end, *, most=200_000):
    steps = []
    while not steps or steps[-1].t1 < t_end:
        steps.append(solver.step(t_end))
        assert len(steps) <= most
    return steps


def linear(matrix, constant=0.0):
    return lambda t, y: matrix @ y + constant


def kofman(matrix, quantum):
    """The bound of Kofman 2002: ``|V| |Re(L)^-1 L| |V^-1| dQ``."""
    values, vectors = np.linalg.eig(matrix)
    gain = np.abs(vectors) @ np.diag(np.abs(values / values.real)) @ np.abs(np.linalg.inv(vectors))
    return gain @ np.full(len(matrix), quantum)


def tolerance_of(name):
    return {1: 1e-2, 2: 1e-4, 3: 1e-6}[METHODS[name].order]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("matrix", [DECAY, DAMPED, TRIANGLE], ids=["decay", "damped", "triangle"])
@pytest.mark.parametrize("name", NAMES)
def test_linear_systems_stay_within_kofmans_bound_at_all_times(name, matrix):
    tol = tolerance_of(name)
    y = np.array([1.0, -0.7, 0.4])[: len(matrix)]
    steps = run(started(name, linear(matrix), y, tol=tol, t_bound=6.0), 6.0)
    bound = kofman(matrix, tol)
    worst = np.zeros(len(matrix))
    for step in steps[:: max(len(steps) // 300, 1)]:
        for part in (0.5, 1.0):
            t = step.t0 + part * (step.t1 - step.t0)
            worst = np.maximum(worst, np.abs(step.interpolant(t) - expm(matrix * t) @ y))
    assert (worst <= bound).all()
    # and it is quantisation that is measured, not something far more exact
    assert worst.max() > 1e-2 * tol


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", NAMES)
def test_events_grow_with_the_root_of_the_quantum_that_the_order_says(name):
    order = METHODS[name].order
    coarse = {1: 1e-2, 2: 1e-3, 3: 1e-5}[order]
    counts = [
        len(run(started(name, linear(DAMPED), [1.0, 0.0], tol=tol), 4.0))
        for tol in (coarse, coarse / 10.0)
    ]
    assert math.log10(counts[1] / counts[0]) == pytest.approx(1.0 / order, rel=0.12)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["liqss1", "liqss2", "liqss3"])
def test_linearly_implicit_methods_do_not_see_the_fast_time_constant(name):
    tol = {1: 1e-3, 2: 1e-5, 3: 1e-6}[METHODS[name].order]
    y = np.array([1.0, 0.0])
    steps = run(started(name, linear(STIFF), y, tol=tol), 5.0)
    slow = run(started(name, linear(DECAY), [1.0], tol=tol), 5.0)
    # one or two events of the fast state for each one of the slow
    assert len(steps) < 5 * len(slow)
    for step in steps[:: len(steps) // 100 + 1]:
        assert np.abs(step.y1 - expm(STIFF * step.t1) @ y).max() < 3.0 * tol


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["qss2", "qss3"])
def test_explicit_methods_chatter_in_a_stiff_system(name):
    solver = started(name, linear(STIFF), [1.0, 0.0], tol=1e-5)
    steps = [solver.step(5.0) for _ in range(3000)]
    # 3000 events, more than LIQSS needs for all of it, and hardly any time has passed
    assert steps[-1].t1 < 0.2
    assert np.abs(steps[-1].y1 - expm(STIFF * steps[-1].t1) @ [1.0, 0.0]).max() < 3e-5


def pendulum(t, y):
    return np.array([y[1], -np.sin(y[0])])


def van_der_pol(t, y):
    return np.array([y[1], 100.0 * (1.0 - y[0] ** 2) * y[1] - y[0]])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss2", "liqss3"])
def test_pendulum(name):
    steps = run(started(name, pendulum, [2.0, 0.0], tol=1e-5), 5.0)
    exact = solve_ivp(pendulum, (0.0, 5.0), [2.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13)
    assert np.abs(steps[-1].y1 - exact.y[:, -1]).max() < 1e-4


@pytest.mark.slow
def test_stiff_van_der_pol_through_two_relaxations():
    steps = run(started("liqss3", van_der_pol, [2.0, 0.0], tol=1e-4, t_bound=200.0), 200.0)
    exact = solve_ivp(van_der_pol, (0.0, 200.0), [2.0, 0.0], method="Radau", rtol=1e-12, atol=1e-12)
    assert np.abs(steps[-1].y1 - exact.y[:, -1]).max() < 1e-3
    assert min(s.y1[0] for s in steps) < -1.9
    assert len(steps) < 5000


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", NAMES)
def test_an_input_that_is_a_function_of_time_is_followed(name):
    # y' = -y + sin 20 t from rest
    def exact(t):
        return (np.sin(20 * t) - 20 * np.cos(20 * t) + 20 * np.exp(-t)) / 401

    tol = {1: 1e-3, 2: 1e-5, 3: 1e-6}[METHODS[name].order]
    steps = run(started(name, lambda t, y: np.sin(20 * t) - y, [0.0], tol=tol), 3.0)
    worst = max(
        abs(step.interpolant(t)[0] - exact(t))
        for step in steps
        for t in (0.5 * (step.t0 + step.t1), step.t1)
    )
    assert worst < 2.0 * tol


def test_an_input_that_varies_only_now_and_then_is_not_taken_for_a_constant():
    # constant where the field is learnt, and a narrow smooth pulse of area 0.1 pi^(1/2) later
    def field(t, y):
        return np.array([np.exp(-(((t - 5.0) / 0.1) ** 2)) - 0.1 * y[0]])

    steps = run(started("qss3", field, [1.0], tol=1e-6), 10.0)
    exact = solve_ivp(field, (0, 10), [1.0], rtol=1e-12, atol=1e-13, max_step=0.01).y[0, -1]
    assert steps[-1].y1[0] == pytest.approx(exact, abs=2e-5)


@pytest.mark.parametrize("name", NAMES)
def test_a_field_affine_where_it_is_learnt_and_not_elsewhere(name):
    # y' = -max(y, 1): e^-t times 3 down to 1 at t = log 3, then a straight line
    tol = tolerance_of(name)
    steps = run(started(name, lambda t, y: -np.maximum(y, 1.0), [3.0], tol=tol, t_bound=1.5), 1.5)
    assert steps[-1].y1[0] == pytest.approx(1.0 - (1.5 - math.log(3.0)), abs=3.0 * tol)


def test_an_affine_field_is_asked_once_per_step():
    steps = run(started("qss2", linear(TRIANGLE), [1.0, 0.0, 0.0], tol=1e-4), 5.0)
    # learning: value, a column per state, two points elsewhere
    assert steps[0].evaluations == 1 + 3 + 2 + 1
    assert all(s.evaluations == 1 for s in steps[1:])


@pytest.mark.parametrize("part", [1e-3, 0.4, 1.0])
@pytest.mark.parametrize("field", [linear(DAMPED), pendulum], ids=["linear", "pendulum"])
@pytest.mark.parametrize("name", NAMES)
def test_retry_cuts_the_same_polynomial_off(name, field, part):
    solver = started(name, field, [1.0, 0.0], tol=1e-3)
    for _ in range(7):
        step = solver.step(10.0)
    t = step.t0 + part * (step.t1 - step.t0)
    again = solver.retry(t)
    assert (again.t0, again.t1, again.evaluations) == (step.t0, t, 0)
    assert again.y1 == pytest.approx(step.interpolant(t), rel=1e-13, abs=1e-15)
    # what is left of the step is the same motion: it ends at the same event
    if part < 1.0:
        rest = solver.step(10.0)
        assert rest.t1 == pytest.approx(step.t1, rel=1e-9)
        assert rest.y1 == pytest.approx(step.y1, rel=1e-9)


def test_steps_end_at_the_quantum_events_of_single_states():
    # Two states that do not know each other: the events of both, as of each alone.
    def ends(matrix, y):
        steps = run(started("qss2", linear(matrix), y, tol=1e-3), 3.0)
        return [s.t1 for s in steps[:-1]]

    both = ends(np.diag([-1.0, -0.3]), [1.0, 2.0])
    alone = sorted(ends(np.array([[-1.0]]), [1.0]) + ends(np.array([[-0.3]]), [2.0]))
    assert len(both) == len(alone)
    assert both == pytest.approx(alone, rel=1e-9)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("n", [4, 30])
@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss3"])
def test_quadratures_of_a_ladder(name, n):
    # Cells that exchange heat with their neighbours and lose the square of theirs: what the sum of
    # squares has lost is the quadrature, whatever the course of the cells.
    ladder = -2.0 * np.eye(n) + np.eye(n, k=1) + np.eye(n, k=-1)

    def field(t, y):
        rate = ladder @ y[:n]
        return np.append(rate, -2.0 * y[:n] @ rate)

    def scale(a, b):
        return np.append(np.full(n, 1e-5), np.inf)

    solver = METHODS[name](scale, rtol=1e-5)
    y = np.zeros(n + 1)
    y[0], y[1] = 1.0, -0.5
    solver.start(field, 0.0, y, t_bound=2.0, jumped=True)
    end = run(solver, 2.0)[-1].y1
    exact = expm(2.0 * ladder) @ y[:n]
    assert end[:n] == pytest.approx(exact, abs=1e-4)
    assert end[n] == pytest.approx(y[:n] @ y[:n] - exact @ exact, abs=1e-4)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("part", [0.07, 0.4, 0.9])
@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss2", "liqss3"])
def test_a_step_cut_off_keeps_the_energies_of_a_field_of_time(name, part):
    # A mass pushed by a growing force: what the force has done is what the mass has more.
    def field(t, y):
        return np.array([0.5 * t + 1.0, (0.5 * t + 1.0) * y[0]])

    solver = METHODS[name](lambda a, b: np.array([1e-5, np.inf]), rtol=1e-5)
    solver.start(field, 0.0, np.array([-1.0, 0.0]), t_bound=4.0, jumped=True)
    # the first events make up for what a start does not know: that the field is one of time
    steps = [solver.step(4.0) for _ in range(2)]
    cut = steps[-1].t0 + part * (steps[-1].t1 - steps[-1].t0)
    after = solver.retry(cut)
    rest = run(solver, 4.0)[-1]
    for t, y in ((after.t1, after.y1), (rest.t1, rest.y1)):
        speed = -1.0 + t + 0.25 * t * t
        assert y[0] == pytest.approx(speed, abs=1e-5)
        # the integral of the force times a quantum, by which a quantised speed may be off
        bound = 1e-5 * (t + 0.25 * t * t)
        assert y[1] == pytest.approx(0.5 * (speed**2 - 1.0), abs=bound)


def test_an_event_that_cuts_a_step_leaves_the_audit_right():
    m = hb.Model("pushed", domain="translational")
    m.add(S=hb.Se("0.5 [N/s]*time + 1 [N]"), j=hb.One(), L=hb.I(1, f=-1.0))
    m.bond("S -> j -> L")
    m.machine("A", states={"a": [], "b": []}, start="a", rules=["a -> b when j.f > 0"])
    done = hb.simulate(m, until=4.0, solver="qss3", rtol=1e-6)
    assert len(done.events) == 2
    assert done.audit().energy < 1e-6


def test_a_quadrature_makes_no_events():
    def with_quadrature(t, y):
        return np.array([y[1], -y[0], 1e6 * y[0] ** 2])

    counts = []
    for field, y in (
        (lambda t, y: np.array([y[1], -y[0]]), [1.0, 0.0]),
        (with_quadrature, [1.0, 0.0, 0.0]),
    ):
        solver = METHODS["qss3"](lambda a, b: np.array([1e-5, 1e-5, np.inf])[: a.size], rtol=1e-5)
        solver.start(field, 0.0, np.array(y), t_bound=3.0, jumped=True)
        steps = run(solver, 3.0)
        counts.append(len(steps))
    assert counts[0] == counts[1]
    assert steps[-1].y1[2] == pytest.approx(1e6 * (1.5 + np.sin(6.0) / 4.0), rel=1e-4)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("unit", [1e-9, 1e9])
@pytest.mark.parametrize("name", ["qss3", "liqss2"])
def test_units_do_not_matter(name, unit):
    def count(time, size):
        solver = METHODS[name](lambda a, b: 1e-4 * size + 0.0 * b, rtol=1e-4)
        solver.start(
            lambda t, y: DAMPED @ y / time, 0.0, np.array([size, 0.0]), t_bound=time, jumped=True
        )
        return len(run(solver, 3.0 * time))

    assert abs(count(unit, 1.0) - count(1.0, 1.0)) <= 1
    assert abs(count(1.0, unit) - count(1.0, 1.0)) <= 1


def test_logarithmic_quantisation_follows_the_size_of_the_state():
    # y' = -y over four decades: as many events in each
    steps = run(started("qss2", linear(DECAY), [1.0], tol=1e-30, relative=1e-3), math.log(1e4))
    counts = np.histogram([s.t1 for s in steps], bins=4)[0]
    assert counts.max() - counts.min() <= 2
    assert steps[-1].y1[0] == pytest.approx(1e-4, rel=1e-2)


@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss2"])
def test_a_state_without_a_size_gets_going(name):
    # All zero, and so is the scale: y' = 1 - y from rest.
    solver = METHODS[name](lambda a, b: 1e-4 * np.abs(b), rtol=1e-4)
    solver.start(linear(DECAY, 1.0), 0.0, np.zeros(1), t_bound=5.0, jumped=True)
    steps = run(solver, 5.0, most=2000)
    assert steps[-1].y1[0] == pytest.approx(1.0 - math.exp(-5.0), rel=1e-3)


def test_a_small_push_leaves_the_quantised_states_alone_and_a_large_one_does_not():
    counts = []
    for push in (0.0, 1e-9, 1e-2):
        solver = started("qss2", linear(DAMPED), [1.0, 0.0], tol=1e-4)
        n = 0
        while (step := solver.step(4.0)).t1 < 4.0:
            solver.start(linear(DAMPED), step.t1, step.y1 + push, t_bound=10.0, jumped=False)
            n += 1
            if push == 1e-2:
                assert solver.step(4.0).y0 == pytest.approx(step.y1 + push)
                break
        counts.append(n)
    assert abs(counts[1] - counts[0]) <= 3


def test_max_step_bounds_every_step():
    steps = run(started("qss3", linear(DECAY), [1.0], tol=1e-1, max_step=0.05), 2.0)
    assert max(s.t1 - s.t0 for s in steps) <= 0.05 * (1 + 1e-9)
    with pytest.raises(ValueError, match="max_step"):
        METHODS["qss3"](lambda a, b: a, rtol=1e-3, max_step=0.0)


def test_a_solution_that_ends_is_an_underflow_with_its_state():
    # y' = y^2, y(0) = 1 is 1/(1 - t)
    solver = started(
        "qss2", lambda t, y: np.array([0.0, y[1] ** 2]), [0.5, 1.0], tol=1e-9, relative=1e-2
    )
    with pytest.raises(StepFailure) as caught:
        run(solver, 2.0)
    assert caught.value.code in ("HB-N201", "HB-N202")
    assert caught.value.component == 1
    assert caught.value.t == pytest.approx(1.0, abs=0.05)


def test_aliases_and_refusals():
    def scale(a, b):
        return 1e-3 + 0.0 * b

    assert make_solver("qss", scale=scale, rtol=1e-3).name == "qss3"
    assert make_solver("liqss", scale=scale, rtol=1e-3).name == "liqss2"
    with pytest.raises(UsageError) as caught:
        make_solver("qss3", scale=scale, rtol=1e-3, step=0.1)
    assert caught.value.code == "HB-S104"
    with pytest.raises(UsageError) as caught:
        make_solver("qss4", scale=scale, rtol=1e-3)
    assert caught.value.code == "HB-S101"


coefficient = st.floats(-10, 10, allow_nan=False).map(lambda a: 0.0 if abs(a) < 1e-3 else a)


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.floats(-0.9, 0.9), st.lists(coefficient, min_size=1, max_size=3))
def test_leaving_a_band_is_the_first_root_that_numpy_finds(d0, rest):
    d = [d0, *rest]
    roots = []
    for level in (1.0, -1.0):
        shifted = [d0 - level, *rest]
        found = np.roots(shifted[::-1])
        roots += [r.real for r in found if abs(r.imag) < 1e-9 * max(abs(r), 1.0) and r.real > 0]
    s = leaves(d, 1.0)
    if math.isinf(s):
        assert not roots
        return
    value = np.polynomial.polynomial.polyval(s, d)
    assert abs(value) == pytest.approx(1.0, rel=1e-6)
    inside = np.polynomial.polynomial.polyval(np.linspace(0.0, s, 400), d)
    assert np.abs(inside).max() <= 1.0 + 1e-6


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(
    st.floats(-2, 2),
    st.lists(st.floats(-5, 5), min_size=1, max_size=3),
    st.floats(-1e4, -0.1),
    st.floats(1e-4, 0.5),
)
def test_a_placed_quantised_state_is_touched_in_time_and_never_far(x, u, a, quantum):
    q, h = place(x, u, a, quantum=quantum)
    n = len(u)
    motion = [x]
    for k in range(n):
        motion.append((a * q[k] + u[k]) / (k + 1))
    d = np.array(motion) - np.array([*q, 0.0])
    rounding = 1e-9 * (abs(x) + sum(map(abs, u)) + quantum)
    if math.isfinite(h):
        assert abs(d[0]) == pytest.approx(0.5 * quantum, abs=rounding)
        # x - q = c (s - h)^n: a root of that multiplicity, and inside half the band until then
        c = motion[n]
        expected = [c * math.comb(n, k) * (-h) ** (n - k) for k in range(n + 1)]
        for k in range(n):
            assert d[k] * h**k == pytest.approx(expected[k] * h**k, abs=rounding)
    elif q[0] != x:
        # an equilibrium: q keeps its distance, and the highest derivative is zero
        assert abs(d[0]) <= 0.5 * quantum + rounding
        assert motion[n] / abs(a) ** n == pytest.approx(0.0, abs=rounding)


CASES = ["bouncing_ball_newton", "diode_inductor", "clutch", "coulomb_friction", "half_bridge"]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("example", CASES)
@pytest.mark.parametrize(("name", "rtol"), [("qss3", 1e-5), ("liqss2", 1e-4)])
def test_examples_agree_with_runge_kutta(example, name, rtol):
    model = hb.load(f"examples/{example}.toml")
    run = hb.simulate(model, solver=name, rtol=rtol)
    exact = hb.simulate(model, solver="rk45", rtol=1e-10)
    assert run.status == exact.status == "ok"
    assert len(run.events) == len(exact.events)
    for ours, theirs in itertools.zip_longest(run.events, exact.events):
        assert ours.steps[-1].mode == theirs.steps[-1].mode
        assert ours.t == pytest.approx(theirs.t, rel=20.0 * rtol, abs=0.0)
        size = np.abs([e.after for e in exact.events]).max(axis=0)
        assert (np.abs(ours.after - theirs.after) <= 20.0 * rtol * size + 1e-12).all()
    energies, exactly = (sum(r.energies(s)[-1] for s in r.segments) for r in (run, exact))
    assert (np.abs(energies - exactly) <= 20.0 * rtol * np.abs(exactly).max()).all()
