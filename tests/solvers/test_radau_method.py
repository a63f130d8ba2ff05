"""Radau IIA on stiff problems, and the bridge to SciPy's tolerances."""

import math

import numpy as np
import pytest

from hybond.solvers import StepFailure
from hybond.solvers.implicit import RadauIIA


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


def test_van_der_pol_against_scipy():
    from scipy.integrate import solve_ivp

    def field(t, y):
        return np.array([y[1], 1e3 * ((1 - y[0] ** 2) * y[1]) - y[0]])

    reference = solve_ivp(field, (0, 2000), [2.0, 0.0], method="Radau", rtol=1e-10, atol=1e-12)
    theirs = solve_ivp(field, (0, 2000), [2.0, 0.0], method="Radau", rtol=1e-6, atol=1e-8)
    steps = run(started(field, [2.0, 0.0], 2000.0, rtol=1e-6, atol=1e-8), 2000.0)
    assert steps[-1].y1 == pytest.approx(reference.y[:, -1], rel=1e-4)
    assert len(steps) < 2 * theirs.t.size


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
