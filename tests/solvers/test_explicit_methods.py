"""Order, dense output and tolerance of the explicit methods."""

import math

import numpy as np
import pytest

from hybond.solvers import make_solver
from hybond.solvers.control import error_norm, worst_component
from hybond.solvers.dopri import _TABLE, DormandPrince
from hybond.solvers.euler import ForwardEuler
from hybond.solvers.rk4 import ClassicRK4


def loose(y0, y1):
    return np.full(y0.shape, 1e30)


def constant_steps(name, h):
    """Return a solver that makes steps of exactly `h`, for orders to be measured."""
    if name == "rk45":
        return DormandPrince(loose, max_step=h)
    return {"euler": ForwardEuler, "rk4": ClassicRK4}[name](h)


def run(solver, field, y, t_end, t=0.0):
    solver.start(field, t, np.asarray(y, dtype=float), t_bound=t_end, jumped=True)
    solver.h = getattr(solver, "_max_step", 1.0)
    steps = []
    while not steps or steps[-1].t1 < t_end:
        steps.append(solver.step(t_end))
    return steps


# A nonlinear, non-autonomous problem with a closed solution. (With y' = y cos t the leading
# error terms of Dormand and Prince's method all but vanish, and it looks like order 6.)
def riccati(t, y):
    return y**2 * math.cos(t)


def solution(t):
    return 1.0 / (1.5 - np.sin(t))


ORDERS = [("euler", 1, 1), ("rk4", 4, 3), ("rk45", 5, 4)]


@pytest.mark.parametrize(("name", "order", "dense_order"), ORDERS)
def test_order_of_the_ends(name, order, dense_order):
    errors = []
    for n in (80, 160):
        steps = run(constant_steps(name, 2.0 / n), riccati, [1 / 1.5], 2.0)
        assert len(steps) == n
        # The largest over the run: at a single time the error may pass through zero.
        errors.append(max(abs(s.y1[0] - solution(s.t1)) for s in steps))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)
    assert make_solver_order(name) == order


def make_solver_order(name):
    step = None if name == "rk45" else 0.1
    return make_solver(name, scale=loose, rtol=1.0, step=step).order


@pytest.mark.parametrize(("name", "order", "dense_order"), ORDERS)
def test_order_of_the_dense_output(name, order, dense_order):
    # The local error of dense output of order p is h^(p+1); over one step from exact data.
    errors = []
    for h in (0.2, 0.1):
        step = run(constant_steps(name, h), riccati, [solution(-0.4)], h - 0.4, t=-0.4)[0]
        t = np.linspace(step.t0, step.t1, 33)
        errors.append(np.abs(step.interpolant(t)[0] - solution(t)).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(dense_order + 1, abs=0.5)


@pytest.mark.parametrize(("name", "order", "dense_order"), ORDERS)
def test_polynomials_of_the_order_are_exact(name, order, dense_order):
    rng = np.random.default_rng(1)
    p = np.polynomial.Polynomial(rng.normal(size=order + 1))
    slope = p.deriv()
    steps = run(constant_steps(name, 0.7), lambda t, y: np.array([slope(t)]), [p(0.0)], 2.0)
    assert steps[-1].y1[0] == pytest.approx(p(2.0), rel=1e-13)
    assert len(steps) == 3


@pytest.mark.parametrize(("name", "order", "dense_order"), ORDERS)
def test_the_dense_output_reproduces_polynomials_of_its_order(name, order, dense_order):
    p = np.polynomial.Polynomial(np.arange(1.0, dense_order + 2.0))
    slope = p.deriv()
    step = run(constant_steps(name, 0.7), lambda t, y: np.array([slope(t)]), [p(0.0)], 0.7)[0]
    t = np.linspace(0.0, 0.7, 9)
    assert step.interpolant(t)[0] == pytest.approx(p(t), rel=1e-13)


def test_the_table_satisfies_its_conditions():
    c = np.array([0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1])
    assert _TABLE[:7].sum(axis=1) == pytest.approx(c)
    assert _TABLE[7].sum() == pytest.approx(0.0, abs=1e-15)
    assert _TABLE[8:].sum(axis=0) == pytest.approx(_TABLE[6], abs=1e-15)
    # Smooth across steps: the slope at the end is the seventh stage.
    assert np.arange(1, 5) @ _TABLE[8:] == pytest.approx(np.eye(7)[6], abs=1e-14)
    for power in range(1, 6):
        assert _TABLE[6] @ c ** (power - 1) == pytest.approx(1 / power)


def test_the_table_is_that_of_scipy():
    from scipy.integrate import RK45

    assert np.array_equal(_TABLE[8:], RK45.P.T)
    assert np.array_equal(_TABLE[6, :6], RK45.B)
    assert np.array_equal(np.abs(_TABLE[7]), np.abs(RK45.E))


def orbit(t, y):
    r3 = math.hypot(y[0], y[1]) ** 3
    return np.array([y[2], y[3], -y[0] / r3, -y[1] / r3])


def kepler(eccentricity):
    return [1.0 - eccentricity, 0.0, 0.0, math.sqrt((1 + eccentricity) / (1 - eccentricity))]


def relative(rtol, atol):
    def scale(y0, y1):
        return atol + rtol * np.maximum(np.abs(y0), np.abs(y1))

    return scale


def test_the_error_follows_the_tolerance():
    # One revolution of a Kepler orbit of eccentricity 0.5 ends where it began.
    errors, costs = [], []
    tolerances = [1e-4, 1e-6, 1e-8, 1e-10]
    for tol in tolerances:
        solver = DormandPrince(relative(tol, tol))
        y = np.array(kepler(0.5))
        solver.start(orbit, 0.0, y, t_bound=2 * math.pi, jumped=True)
        steps = []
        while not steps or steps[-1].t1 < 2 * math.pi:
            steps.append(solver.step(2 * math.pi))
        errors.append(np.abs(steps[-1].y1 - y).max())
        costs.append(sum(s.evaluations for s in steps))
        assert all(s.error <= 1.0 for s in steps)
    slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
    assert slope == pytest.approx(1.0, abs=0.15)
    assert errors[1] < 1e-3
    # Two decades of tolerance cost 100^(1/5) = 2.5 times the steps.
    assert costs[3] / costs[2] == pytest.approx(2.5, abs=0.3)


def test_costs_about_as_much_as_scipys():
    from scipy.integrate import solve_ivp

    tol = 1e-7
    theirs = solve_ivp(orbit, (0.0, 6.0), kepler(0.3), rtol=tol, atol=tol, method="RK45")
    solver = DormandPrince(relative(tol, tol))
    solver.start(orbit, 0.0, np.array(kepler(0.3)), t_bound=6.0, jumped=True)
    steps = []
    while not steps or steps[-1].t1 < 6.0:
        steps.append(solver.step(6.0))
    assert sum(s.evaluations for s in steps) <= 1.15 * theirs.nfev
    assert steps[-1].y1 == pytest.approx(theirs.y[:, -1], abs=50 * tol)


def test_an_accepted_step_costs_six_evaluations():
    solver = DormandPrince(relative(1e-6, 1e-6))
    solver.start(orbit, 0.0, np.array(kepler(0.0)), t_bound=6.0, jumped=True)
    first, second = solver.step(6.0), solver.step(6.0)
    # The derivative and the trial of the first step belong to the start.
    assert first.evaluations == 8 + 6 * first.rejected
    assert second.evaluations == 6 * (1 + second.rejected)
    assert solver.retry(0.5 * (second.t0 + second.t1)).evaluations == 6


def test_a_step_into_the_undefined_is_rejected_and_made_smaller():
    # y' = -sqrt(y) leaves its domain when a step of any size overshoots y = 0 at t = 2.
    solver = DormandPrince(relative(1e-6, 1e-9))
    solver.start(lambda t, y: -np.sqrt(y), 0.0, np.ones(1), t_bound=1.99, jumped=True)
    solver.h = 1.9
    step = solver.step(1.99)
    assert step.rejected > 0
    assert step.y1[0] == pytest.approx((1 - step.t1 / 2) ** 2, abs=1e-5)


def test_large_finite_values_are_not_taken_for_infinite_ones():
    # Their squares overflow.
    solver = DormandPrince(lambda y0, y1: 1e-6 * np.abs(y1))
    solver.start(lambda t, y: -y, 0.0, np.array([1e200]), t_bound=1.0, jumped=True)
    steps = []
    while not steps or steps[-1].t1 < 1.0:
        steps.append(solver.step(1.0))
    assert steps[-1].y1[0] == pytest.approx(1e200 * math.exp(-1.0), rel=1e-5)


def test_rejections_are_counted():
    # A kick of width 1e-2 that the step size before it does not foresee.
    def kicked(t, y):
        return np.array([-y[0] + 1e3 * math.exp(-(((t - 1.0) / 1e-2) ** 2))])

    solver = DormandPrince(relative(1e-6, 1e-6), max_step=0.05)
    solver.start(kicked, 0.0, np.ones(1), t_bound=2.0, jumped=True)
    steps = []
    while not steps or steps[-1].t1 < 2.0:
        steps.append(solver.step(2.0))
    assert sum(s.rejected for s in steps) > 0
    kick = 1e3 * 1e-2 * math.sqrt(math.pi) * math.exp(-1.0)
    assert steps[-1].y1[0] == pytest.approx(math.exp(-2.0) + kick, rel=1e-4)


@pytest.mark.parametrize("method", [ForwardEuler, ClassicRK4])
def test_the_grid_does_not_drift_and_is_kept_after_a_shortened_step(method):
    solver = method(0.1)
    solver.start(lambda t, y: -y, 0.05, np.ones(1), t_bound=1e4, jumped=True)
    ends = [solver.step(1e4).t1 for _ in range(1000)]
    assert ends == [0.05 + k * 0.1 for k in range(1, 1001)]
    solver.start(lambda t, y: -y, 1.0, np.ones(1), t_bound=1e4, jumped=False)
    assert solver.step(1.03).t1 == 1.03
    assert solver.step(9.0).t1 == 1.1
    # An end within rounding of the grid is a point of the grid: no sliver of a step.
    assert solver.step(1.2 - 1e-15).t1 == 1.2 - 1e-15
    assert solver.step(9.0).t1 == pytest.approx(1.3)


@pytest.mark.parametrize("method", [ForwardEuler, ClassicRK4])
def test_after_a_retry_the_grid_goes_on(method):
    solver = method(0.1)
    solver.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    solver.step(1.0)
    solver.step(1.0)
    solver.retry(0.15)
    assert solver.step(1.0).t1 == pytest.approx(0.2)
    assert solver.step(1.0).t1 == pytest.approx(0.3)


def test_euler_is_the_textbook_recursion():
    solver = ForwardEuler(0.1)
    solver.start(lambda t, y: -2.0 * y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    steps = [solver.step(1.0) for _ in range(10)]
    assert steps[-1].y1[0] == pytest.approx(0.8**10, rel=1e-13)
    assert sum(s.evaluations for s in steps) == 10
    assert steps[0].interpolant(0.025)[0] == pytest.approx(0.95)


def test_rk4_is_the_taylor_polynomial_on_the_test_equation():
    h = 0.3
    solver = ClassicRK4(h)
    solver.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    step = solver.step(1.0)
    assert step.y1[0] == pytest.approx(1 - h + h**2 / 2 - h**3 / 6 + h**4 / 24, rel=1e-15)


def test_the_norm_ignores_what_is_not_controlled():
    assert error_norm(np.array([2.0, 1e9]), np.array([1.0, np.inf])) == 2.0
    assert error_norm(np.array([2.0, 0.0]), np.array([1.0, 0.0])) == pytest.approx(math.sqrt(2.0))
    assert error_norm(np.array([2.0]), np.array([np.inf])) == 0.0
    assert error_norm(np.array([2.0]), np.array([0.0])) == math.inf
    assert worst_component(np.array([1.0, 5.0]), np.array([1.0, np.inf])) == 0
    assert worst_component(np.zeros(2), np.ones(2)) is None


def test_steps_that_time_cannot_resolve_are_refused():
    from hybond.solvers import StepFailure

    solver = ForwardEuler(1e-12)
    solver.start(lambda t, y: -y, 1e6, np.ones(1), t_bound=2e6, jumped=True)
    with pytest.raises(StepFailure) as caught:
        solver.step(2e6)
    assert caught.value.code == "HB-N201"
