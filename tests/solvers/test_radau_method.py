"""Radau IIA: order, stiff problems, Jacobian, quadratures, landing."""

import math

import numpy as np
import pytest

from hybond.solvers import StepFailure
from hybond.solvers.implicit import RadauIIA
from hybond.solvers.newton import Factors


def relative(rtol, atol):
    def scale(y0, y1):
        return atol + rtol * np.maximum(np.abs(y0), np.abs(y1))

    return scale


def run(solver, t_end, steps=None):
    steps = [] if steps is None else steps
    while not steps or steps[-1].t1 < t_end:
        steps.append(solver.step(t_end))
    return steps


def started(field, y, t_end, *, rtol=1e-6, atol=1e-9, **options):
    solver = RadauIIA(relative(rtol, atol), rtol=rtol, **options)
    solver.start(field, 0.0, np.asarray(y, dtype=float), t_bound=t_end, jumped=True)
    return solver


def robertson(t, y):
    a, b, c = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return np.array([b - a, a - b - c, c])


def test_robertson_against_the_published_reference():
    # Hairer and Wanner's test set at t = 40: digits agreed by many codes.
    solver = started(robertson, [1.0, 0.0, 0.0], 40.0, rtol=1e-7, atol=1e-12)
    steps = run(solver, 40.0)
    assert steps[-1].y1 == pytest.approx(
        np.array([0.7158270688, 9.185534765e-6, 0.2841637457]), rel=1e-5
    )
    assert steps[-1].y1.sum() == pytest.approx(1.0, abs=1e-12)
    assert sum(s.evaluations for s in steps) < 1500


def test_prothero_robinson_at_any_stiffness():
    # y' = lambda (y - g(t)) + g'(t) has the solution g whatever lambda.
    for stiffness in (1e2, 1e5, 1e8):

        def field(t, y, k=stiffness):
            return -k * (y - math.sin(t)) + math.cos(t)

        steps = run(started(field, [0.0], 3.0, rtol=1e-6, atol=1e-7), 3.0)
        assert steps[-1].y1[0] == pytest.approx(math.sin(3.0), abs=2e-6)
        assert len(steps) < 60


@pytest.mark.slow
def test_van_der_pol_against_scipy():
    from scipy.integrate import solve_ivp

    def field(t, y):
        return np.array([y[1], 1e3 * ((1 - y[0] ** 2) * y[1]) - y[0]])

    reference = solve_ivp(field, (0, 2000), [2.0, 0.0], method="Radau", rtol=1e-10, atol=1e-12)
    theirs = solve_ivp(field, (0, 2000), [2.0, 0.0], method="Radau", rtol=1e-6, atol=1e-8)
    steps = run(started(field, [2.0, 0.0], 2000.0, rtol=1e-6, atol=1e-8), 2000.0)
    assert steps[-1].y1 == pytest.approx(reference.y[:, -1], rel=1e-4)
    assert len(steps) < 1.1 * theirs.t.size
    assert sum(s.evaluations for s in steps) < 1.2 * theirs.nfev
    assert all(s.error <= 1.0 for s in steps)


def test_the_error_follows_the_tolerance():
    errors = []
    tolerances = [1e-4, 1e-6, 1e-8]
    for tol in tolerances:
        solver = started(lambda t, y: np.array([y[1], -y[0]]), [1, 0], 6.0, rtol=tol, atol=tol)
        errors.append(np.abs(run(solver, 6.0)[-1].y1 - [math.cos(6.0), -math.sin(6.0)]).max())
    assert all(error < 30 * tol for error, tol in zip(errors, tolerances, strict=True))
    assert errors[2] < 1e-2 * errors[0]


@pytest.mark.parametrize("rate", [-1.0, 1.0])
def test_the_tolerance_follows_a_state_that_decays_or_grows(rate):
    # Over 17 decades of y a scale frozen at the start would be useless one way or the other.
    rtol = 1e-6
    solver = started(lambda t, y: rate * y, [1.0], 40.0, rtol=rtol, atol=0.0)
    steps = run(solver, 40.0)
    assert steps[-1].y1[0] == pytest.approx(math.exp(rate * 40.0), rel=200 * rtol)
    sizes = np.array([s.t1 - s.t0 for s in steps[8:-1]])
    assert sizes.max() < 1.6 * sizes.min()


def test_a_quadrature_does_not_dilute_the_norm():
    # Ten uncontrolled components must not let the controlled one err more.
    def scale(y0, y1):
        s = np.full(y0.shape, np.inf)
        s[0] = 1e-8
        return s

    counts = []
    for extra in (0, 10):

        def field(t, y):
            return np.concatenate(([math.cos(t) * y[0]], np.full(y.size - 1, y[0])))

        solver = RadauIIA(scale, rtol=1e-8)
        solver.start(field, 0.0, np.ones(1 + extra), t_bound=5.0, jumped=True)
        counts.append(len(run(solver, 5.0)))
    assert counts[0] == counts[1]


def test_given_jacobian_saves_evaluations_and_changes_nothing_else():
    def jacobian(t, y):
        return np.array(
            [
                [-0.04, 1e4 * y[2], 1e4 * y[1]],
                [0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1]],
                [0.0, 6e7 * y[1], 0.0],
            ]
        )

    plain = run(started(robertson, [1.0, 0.0, 0.0], 40.0), 40.0)
    given = run(started(robertson, [1.0, 0.0, 0.0], 40.0, jacobian=jacobian), 40.0)
    assert given[-1].y1 == pytest.approx(plain[-1].y1, rel=1e-5)
    assert sum(s.evaluations for s in given) < sum(s.evaluations for s in plain)


def test_differences_agree_with_the_jacobian_of_a_badly_scaled_field():
    def field(t, y):
        return np.array([1e8 * y[0] * y[1], y[1] ** 2 / 1e-9, y[2]])

    y = np.array([1e-6, 3e-9, 0.0])
    solver = RadauIIA(relative(1e-6, 1e-18), rtol=1e-6)
    solver.start(field, 0.0, y, t_bound=1.0, jumped=True)
    expected = np.array([[1e8 * y[1], 1e8 * y[0], 0.0], [0.0, 2 * y[1] / 1e-9, 0.0], [0, 0, 1.0]])
    assert solver._differences(0.0, y) == pytest.approx(expected, rel=1e-6)


def test_differences_stay_where_the_field_is_defined():
    # sqrt(y) at y = 0 has no values below; the motion is upwards by the other term.
    def field(t, y):
        return np.array([1.0 - 0.1 * math.sqrt(y[0]) if y[0] >= 0.0 else math.nan])

    steps = run(started(field, [0.0], 1.0), 1.0)
    assert np.isfinite(steps[-1].y1).all()


def test_order_of_the_dense_output():
    # Collocation at three points: the local error of the cubic is h^4.
    errors = []
    for h in (0.4, 0.2):
        solver = RadauIIA(lambda a, b: np.full(1, 1e-3), rtol=1e-3, max_step=h)
        solver.start(lambda t, y: y * math.cos(t), 0.3, np.exp([math.sin(0.3)]), t_bound=9.0,
                     jumped=True)  # fmt: skip
        solver.h = h
        step = solver.step(0.3 + h)
        assert step.t1 == 0.3 + h
        t = np.linspace(step.t0, step.t1, 33)
        errors.append(np.abs(step.interpolant(t)[0] - np.exp(np.sin(t))).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.7)


def test_a_retry_of_several_inner_steps_is_one_continuous_step():
    # Past the last step a kick makes one step of this size impossible.
    def kicked(t, y):
        return np.array([-y[0] + 100.0 * math.exp(-(((t - 0.6) / 0.01) ** 2))])

    solver = started(kicked, [1.0], 2.0)
    solver.h = 0.05
    step = solver.step(0.05)
    again = solver.retry(0.7)
    assert (again.t0, again.t1) == (step.t0, 0.7)
    t = np.linspace(again.t0, 0.7, 701)
    dense = again.interpolant(t)[0]
    assert np.array_equal(dense, np.array([again.interpolant(s)[0] for s in t]))
    from scipy.integrate import quad

    kick, _ = quad(
        lambda s: math.exp(s - 0.7) * 100.0 * math.exp(-(((s - 0.6) / 0.01) ** 2)),
        0.0, 0.7, points=[0.55, 0.6, 0.65],
    )  # fmt: skip
    assert again.y1[0] == pytest.approx(math.exp(-0.7) + kick, rel=1e-4)
    assert np.abs(np.diff(dense)).max() < 0.2


def test_a_failed_retry_leaves_the_solver_at_the_end_of_the_step():
    def field(t, y):
        return np.array([math.nan if t > 1.0 else -y[0]])

    solver = started(field, [1.0], 1.0)
    step = run(solver, 1.0)[-1]
    with pytest.raises(StepFailure) as caught:
        solver.retry(1.2)
    assert caught.value.code == "HB-N202"
    assert solver.retry(step.t1).t1 == step.t1


def test_after_a_jump_nothing_is_remembered():
    def evaluations(field_after, jumped):
        solver = started(lambda t, y: -y, [1.0], 10.0)
        steps = [solver.step(10.0) for _ in range(5)]
        solver.start(field_after, steps[-1].t1, steps[-1].y1, t_bound=10.0, jumped=jumped)
        return run(solver, steps[-1].t1 + 1.0)[-1]

    # A jump to a field ten thousand times stiffer, with the Jacobian of the old one useless.
    end = evaluations(lambda t, y: -1e4 * (y - 1.0), True)
    assert end.y1[0] == pytest.approx(1.0, abs=1e-6)


def riccati(t, y):
    return y**2 * math.cos(t)


def test_order_of_the_ends():
    # Nonlinear, not autonomous, not stiff: the classical order. Solution 1/(1.5 - sin t).
    errors = []
    for n in (24, 48):
        # Errors of any size pass, but what Newton's iteration leaves must not be seen.
        solver = RadauIIA(lambda a, b: np.ones(1), max_step=2.0 / n)
        solver._enough = 1e-11
        solver.start(riccati, 0.0, np.array([1 / 1.5]), t_bound=2.0, jumped=True)
        steps = []
        while not steps or steps[-1].t1 < 2.0 - 1e-9:
            solver.h = 2.0 / n
            steps.append(solver.step(2.0))
        assert len(steps) == n
        errors.append(max(abs(s.y1[0] - 1.0 / (1.5 - math.sin(s.t1))) for s in steps))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.35)


def linear_circuit():
    # A capacitor behind a tau of 1e-4 s, fed by a slow sine; a second, slow one behind it.
    tau, w = 1e-4, 3.0

    def field(t, y):
        return np.array([(math.sin(w * t) - y[0]) / tau])

    def solution(t):
        # Particular solution plus the transient from y(0) = 1.
        a, b = 1.0 / (1.0 + (w * tau) ** 2), -w * tau / (1.0 + (w * tau) ** 2)
        return a * np.sin(w * t) + b * np.cos(w * t) + (1.0 - b) * np.exp(-t / tau)

    return field, solution


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_a_stiff_rc_against_its_closed_form(rtol):
    field, solution = linear_circuit()
    steps = run(started(field, [1.0], 2.0, rtol=rtol, atol=rtol), 2.0)
    ends = np.array([(s.t1, s.y1[0]) for s in steps])
    assert np.abs(ends[:, 1] - solution(ends[:, 0])).max() < 6.0 * rtol
    # The steps outgrow the time constant as soon as the transient is over.
    assert max(s.t1 - s.t0 for s in steps) > 50 * 1e-4
    # Linear: one Jacobian, and once the stages are foreseen well one iteration a step.
    assert sum(s.evaluations for s in steps) < 9 * len(steps)


def test_the_dense_output_follows_a_slow_solution_over_stiff_steps():
    field, solution = linear_circuit()
    steps = run(started(field, [1.0], 2.0, rtol=1e-6, atol=1e-6), 2.0)
    for step in steps:
        t = np.linspace(step.t0, step.t1, 17)
        assert np.abs(step.interpolant(t)[0] - solution(t)).max() < 1e-3


@pytest.mark.sampled(1)
@pytest.mark.parametrize("t_end", [0.3, 40.0, 1e6])
def test_robertson_against_scipy_at_tight_tolerance(t_end):
    from scipy.integrate import solve_ivp

    def jacobian(t, y):
        return np.array(
            [
                [-0.04, 1e4 * y[2], 1e4 * y[1]],
                [0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1]],
                [0.0, 6e7 * y[1], 0.0],
            ]
        )

    reference = solve_ivp(
        robertson, (0, t_end), [1.0, 0, 0], method="Radau", jac=jacobian, rtol=1e-11, atol=1e-16
    )
    steps = run(started(robertson, [1.0, 0.0, 0.0], t_end, rtol=1e-9, atol=1e-14), t_end)
    assert steps[-1].y1 == pytest.approx(reference.y[:, -1], rel=2e-7)


@pytest.mark.slow
def test_the_error_is_proportional_to_the_tolerance():
    # Van der Pol's equation, through the fast transitions, against scipy at 1e-12.
    from scipy.integrate import solve_ivp

    def field(t, y):
        return np.array([y[1], 50.0 * (1 - y[0] ** 2) * y[1] - y[0]])

    reference = solve_ivp(field, (0, 60), [2.0, 0.0], method="Radau", rtol=1e-12, atol=1e-13)
    errors, tolerances = [], [1e-4, 1e-5, 1e-6, 1e-7, 1e-8]
    for tol in tolerances:
        steps = run(started(field, [2.0, 0.0], 60.0, rtol=tol, atol=1e-2 * tol), 60.0)
        errors.append(abs(steps[-1].y1[0] - reference.y[0, -1]))
    slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
    # The error estimate is of order 3, the method of order 5: between 1 and 5/4.
    assert 0.8 < slope < 1.5


@pytest.mark.parametrize("m", [1, 4, 60, 61])
def test_the_split_system_is_the_whole_one(m):
    from hybond.solvers.collocation import collocation

    rng = np.random.default_rng(m)
    jacobian = rng.normal(size=(m, m)) * 10.0 ** rng.uniform(-2, 4, size=(m, 1))
    residual = rng.normal(size=(3, m))
    h = 0.01
    whole = np.kron(collocation().inverse / h, np.eye(m)) - np.kron(np.eye(3), jacobian)
    expected = np.linalg.solve(whole, residual.reshape(-1)).reshape(3, m)
    ours = Factors(jacobian, h).correct(residual)
    assert ours == pytest.approx(expected, rel=1e-8, abs=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("m", [30, 80])
def test_a_heat_equation_decays_as_its_slowest_mode(m):
    # Discrete Laplacian: the first mode is an eigenvector, 4 sin^2(pi/2(m+1)) its rate.
    rate = 4.0 * math.sin(math.pi / (2 * (m + 1))) ** 2 * (m + 1) ** 2

    def field(t, y):
        left, right = np.append(0.0, y[:-1]), np.append(y[1:], 0.0)
        return (left - 2.0 * y + right) * (m + 1) ** 2

    first = np.sin(math.pi * np.arange(1, m + 1) / (m + 1))
    steps = run(started(field, first, 0.3, rtol=1e-7, atol=1e-9), 0.3)
    assert steps[-1].y1 == pytest.approx(first * math.exp(-0.3 * rate), rel=1e-5)


def with_energy(t, y):
    # A stiff relaxation to sin t, and the integral of its square and of its motion.
    rate = -1e4 * (y[1] - math.sin(t)) + math.cos(t)
    return np.array([y[1] ** 2, rate, y[1] * rate])


def only_the_second(y0, y1):
    return np.array([np.inf, 1e-8 + 1e-8 * max(abs(y0[1]), abs(y1[1])), np.inf])


def test_quadratures_are_as_accurate_as_the_stages():
    solver = RadauIIA(only_the_second, rtol=1e-8)
    solver.start(with_energy, 0.0, np.zeros(3), t_bound=3.0, jumped=True)
    steps = run(solver, 3.0)
    y1 = steps[-1].y1
    assert y1[0] == pytest.approx(1.5 - math.sin(6.0) / 4.0, abs=1e-6)
    assert y1[2] == pytest.approx(0.5 * math.sin(3.0) ** 2, abs=1e-6)
    for step in steps[:: len(steps) // 5]:
        middle = 0.5 * (step.t0 + step.t1)
        expected = 0.5 * middle - math.sin(2 * middle) / 4.0
        assert step.interpolant(middle)[0] == pytest.approx(expected, abs=1e-5)


def test_quadratures_have_no_columns_in_the_jacobian():
    states = []

    def watched(t, y):
        states.append(y.copy())
        return with_energy(t, y)

    solver = RadauIIA(only_the_second, rtol=1e-8)
    solver.start(watched, 0.0, np.zeros(3), t_bound=3.0, jumped=True)
    states.clear()
    matrix = solver._matrix(0.0, solver._y)
    assert matrix == pytest.approx(np.array([[-1e4]]), rel=1e-6)
    assert len(states) == 1
    assert states[0][1] != 0.0
    assert states[0][0] == states[0][2] == 0.0


def test_a_given_jacobian_loses_rows_and_columns_of_quadratures():
    calls = []

    def jacobian(t, y):
        calls.append(t)
        rate = -1e4 * (y[1] - math.sin(t)) + math.cos(t)
        return np.array([[0, 2 * y[1], 0], [0, -1e4, 0], [0, rate - 1e4 * y[1], 0]])

    solver = RadauIIA(only_the_second, rtol=1e-8, jacobian=jacobian)
    solver.start(with_energy, 0.0, np.zeros(3), t_bound=3.0, jumped=True)
    assert run(solver, 3.0)[-1].y1[0] == pytest.approx(1.5 - math.sin(6.0) / 4.0, abs=1e-6)
    # Linear in what is controlled: one Jacobian serves the whole run, and a jump forgets it.
    assert calls == [0.0]
    solver.start(with_energy, 3.0, np.zeros(3), t_bound=4.0, jumped=True)
    run(solver, 4.0)
    assert calls == [0.0, 3.0]


def test_a_power_that_is_not_finite_is_named():
    def field(t, y):
        return np.array([math.inf if t > 1.0 else 1.0, -y[1], 0.0])

    solver = RadauIIA(only_the_second, rtol=1e-8)
    solver.start(field, 0.0, np.ones(3), t_bound=3.0, jumped=True)
    with pytest.raises(StepFailure) as caught:
        run(solver, 3.0)
    assert (caught.value.code, caught.value.component) == ("HB-N202", 0)
    assert caught.value.t == pytest.approx(1.0, abs=1e-9)


def test_rejections_and_errors_are_told():
    def kicked(t, y):
        return np.array([-y[0] + 1e3 * math.exp(-(((t - 1.0) / 1e-2) ** 2))])

    steps = run(started(kicked, [1.0], 2.0, max_step=0.05), 2.0)
    assert sum(s.rejected for s in steps) > 0
    assert all(0.0 < s.error <= 1.0 for s in steps)
    kick = 1e3 * 1e-2 * math.sqrt(math.pi) * math.exp(-1.0 + 0.25e-4)
    assert steps[-1].y1[0] == pytest.approx(math.exp(-2.0) + kick, rel=1e-5)


def test_a_retry_inside_a_stiff_step_is_one_cheap_step():
    field, solution = linear_circuit()
    solver = started(field, [1.0], 2.0, rtol=1e-7, atol=1e-7)
    while solver._t < 0.5:
        step = solver.step(2.0)
    hint = solver.h
    t_event = step.t0 + 0.37 * (step.t1 - step.t0)
    again = solver.retry(t_event)
    assert again.y1[0] == pytest.approx(solution(t_event), abs=1e-7)
    # No Jacobian; at most two iterations, because the stages are those of the step.
    assert again.evaluations <= 7
    assert again.rejected == 0
    assert again.error <= 1.0
    assert solver.h == hint


def test_a_state_that_leaves_zero_without_an_absolute_tolerance():
    solver = RadauIIA(lambda a, b: 1e-6 * np.maximum(np.abs(a), np.abs(b)), rtol=1e-6)
    solver.start(lambda t, y: np.array([-y[0], y[0] - y[1]]), 0.0, np.array([1.0, 0.0]),
                 t_bound=1.0, jumped=True)  # fmt: skip
    y1 = run(solver, 1.0)[-1].y1
    assert y1 == pytest.approx([math.exp(-1.0), math.exp(-1.0)], rel=1e-5)


def test_another_goes_on_where_one_stands():
    field, solution = linear_circuit()
    one, other = (started(field, [1.0], 2.0, rtol=1e-7, atol=1e-7) for _ in range(2))
    while one._t < 0.5:
        one.step(2.0)
    other.resume(one.state())
    stands = one.state()
    assert (other.h, other.state().h_before, other.state().error_before) == (
        one.h,
        stands.h_before,
        stands.error_before,
    )
    step = other.step(2.0)
    # a Jacobian and what it takes to iterate without foresight, but no first step and no rejection
    assert (step.t0, step.rejected) == (one._t, 0)
    assert step.t1 == pytest.approx(one.step(2.0).t1, rel=1e-2)
    y1 = run(other, 2.0)[-1].y1
    assert y1[0] == pytest.approx(solution(2.0), abs=1e-6)
