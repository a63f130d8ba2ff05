"""What every solver promises, whatever its method."""

import itertools
import math

import numpy as np
import pytest

from hybond.solvers import SOLVERS, StepFailure, make_solver
from hybond.solvers.choose import QUANTISED

OMEGA = np.array([[0.0, 1.0], [-1.0, 0.0]])

FIRST_ORDER = ("euler",)
"""Of these no more than two or three digits are asked, for the sake of time."""


def oscillator(t, y):
    return OMEGA @ y


def exact(t):
    return np.array([np.cos(t), -np.sin(t)])


def tolerance(rtol, atol=None):
    floor = rtol * 1e-3 if atol is None else atol

    def scale(y0, y1):
        return floor + rtol * np.maximum(np.abs(y0), np.abs(y1))

    return scale


def make(name, *, rtol=1e-6, step=0.01, max_step=math.inf):
    fixed = name in ("euler", "rk4")
    return make_solver(
        name,
        scale=tolerance(rtol),
        rtol=rtol,
        step=step if fixed else None,
        max_step=max_step,
    )


def run(solver, t_end):
    steps = []
    while not steps or steps[-1].t1 < t_end:
        steps.append(solver.step(t_end))
    return steps


@pytest.fixture(params=[n for n in SOLVERS if n not in QUANTISED])
def name(request):
    return request.param


def started(name, y=(1.0, 0.0), t=0.0, field=oscillator, t_bound=10.0, **options):
    solver = make(name, **options)
    solver.start(field, t, np.array(y), t_bound=t_bound, jumped=True)
    return solver


@pytest.mark.sampled(10)
def test_steps_follow_one_another_and_land_exactly(name):
    steps = run(started(name, t=0.1), 0.7)
    assert steps[0].t0 == 0.1
    assert steps[-1].t1 == 0.7
    for before, after in itertools.pairwise(steps):
        assert before.t1 == after.t0
        assert np.array_equal(before.y1, after.y0)
        assert before.t0 < before.t1


@pytest.mark.parametrize("t0", [0.0, 1e-12, 1e6 / 3])
@pytest.mark.parametrize("gap", [0.1, 1 / 3, 1e-7])
def test_lands_bit_for_bit_from_any_time(name, t0, gap):
    solver = started(name, t=t0, t_bound=t0 + 10.0, max_step=0.05)
    t_end = t0
    for _ in range(3):
        t_end += gap
        steps = run(solver, t_end)
        assert steps[-1].t1 == t_end
        assert isinstance(steps[-1].t1, float)


def test_lands_on_the_next_representable_time(name):
    solver = started(name, t=1.0)
    t_end = math.nextafter(1.0, 2.0)
    assert solver.step(t_end).t1 == t_end


@pytest.mark.sampled(4)
def test_interpolant_is_exact_at_both_ends(name):
    for step in run(started(name, y=(1 / 3, 0.1)), 1.0):
        assert np.array_equal(step.interpolant(step.t0), step.y0)
        assert np.array_equal(step.interpolant(step.t1), step.y1)
        middle = 0.5 * (step.t0 + step.t1)
        block = step.interpolant(np.array([step.t1, middle, step.t0]))
        assert block.shape == (2, 3)
        assert np.array_equal(block[:, 0], step.y1)
        assert np.array_equal(block[:, 2], step.y0)
        assert block[:, 1] == pytest.approx(step.interpolant(middle), rel=1e-14, abs=1e-15)
        assert step.interpolant(np.array(middle)).shape == (2,)
        assert step.interpolant(np.empty(0)).shape == (2, 0)


def test_changing_what_the_interpolant_returned_does_not_change_the_step(name):
    step = started(name).step(1.0)
    step.interpolant(step.t1)[:] = 99.0
    assert step.interpolant(step.t1)[0] < 2.0
    with pytest.raises(ValueError, match="read-only"):
        step.y1[0] = 1.0


def test_the_callers_state_is_copied(name):
    y = np.array([1.0, 0.0])
    solver = make(name)
    solver.start(oscillator, 0.0, y, t_bound=1.0, jumped=True)
    y[:] = 7.0
    assert solver.step(1.0).y0[0] == 1.0


@pytest.mark.sampled(6)
def test_a_field_may_reuse_its_result(name):
    buffer = np.empty(2)

    def reusing(t, y):
        np.matmul(OMEGA, y, out=buffer)
        return buffer

    ours = run(started(name, field=reusing), 0.5)[-1]
    other = run(started(name), 0.5)[-1]
    assert np.array_equal(ours.y1, other.y1)


@pytest.mark.sampled(7)
def test_evaluations_add_up_to_the_calls_made(name):
    calls = 0

    def counted(t, y):
        nonlocal calls
        calls += 1
        return oscillator(t, y)

    solver = started(name, field=counted)
    steps = run(solver, 1.0)
    total = sum(step.evaluations for step in steps)
    assert total == calls
    within = steps[-1].t0 + 0.99 * (1.0 - steps[-1].t0)
    assert solver.retry(within).evaluations == calls - total


@pytest.mark.sampled(4)
def test_same_input_same_bits(name):
    one, two = (run(started(name), 1.0) for _ in range(2))
    assert [s.t1 for s in one] == [s.t1 for s in two]
    assert all(np.array_equal(a.y1, b.y1) for a, b in zip(one, two, strict=True))


@pytest.mark.parametrize("part", [0.1, 0.5, 0.97, 1.0, 1.02])
def test_retry_ends_where_asked_as_accurately_as_the_step(name, part):
    solver = started(name, rtol=1e-7)
    for _ in range(4):
        step = solver.step(1.0)
    t_event = step.t0 + part * (step.t1 - step.t0)
    again = solver.retry(t_event)
    assert (again.t0, again.t1) == (step.t0, t_event)
    assert np.array_equal(again.y0, step.y0)

    def local(s):
        # The error of this step alone: the exact flow of the oscillator from its start.
        a = s.t1 - s.t0
        flow = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
        return float(np.abs(s.y1 - flow @ s.y0).max())

    assert local(again) <= max(1.3 * local(step), 1.5e-7)


@pytest.mark.sampled(7)
def test_retry_may_be_repeated_and_the_next_step_goes_on_from_it(name):
    solver = started(name)
    solver.step(1.0)
    step = solver.step(1.0)
    quarter = step.t0 + 0.25 * (step.t1 - step.t0)
    half = step.t0 + 0.5 * (step.t1 - step.t0)
    first = solver.retry(half)
    solver.retry(quarter)
    again = solver.retry(half)
    assert np.array_equal(first.y1, again.y1)
    after = solver.step(1.0)
    assert after.t0 == half
    assert np.array_equal(after.y0, again.y1)
    end = run(solver, 1.0)[-1]
    assert end.y1 == pytest.approx(exact(1.0), abs=2e-2 if name in FIRST_ORDER else 1e-5)


def test_retry_needs_a_step(name):
    solver = started(name)
    with pytest.raises(RuntimeError):
        solver.retry(0.1)
    step = solver.step(1.0)
    with pytest.raises(ValueError, match="later"):
        solver.retry(step.t0)
    solver.start(oscillator, step.t1, step.y1, t_bound=10.0, jumped=False)
    with pytest.raises(RuntimeError):
        solver.retry(step.t1 + 0.1)


def test_a_step_needs_a_start_and_a_later_end(name):
    with pytest.raises(RuntimeError):
        make(name).step(1.0)
    with pytest.raises(ValueError, match="later"):
        started(name, t=1.0).step(1.0)


@pytest.mark.sampled(4)
def test_continuing_is_cheaper_than_a_jump(name):
    def evaluations(jumped):
        solver = started(name)
        steps = run(solver, 0.5)
        solver.start(oscillator, 0.5, steps[-1].y1, t_bound=10.0, jumped=jumped)
        return sum(s.evaluations for s in run(solver, 1.0))

    if name == "euler":
        assert evaluations(False) == evaluations(True)
    else:
        assert evaluations(False) < evaluations(True)


def test_continuing_unchanged_gives_the_same_bits_as_not_stopping(name):
    through, told = started(name), started(name)
    for _ in range(6):
        a, b = through.step(5.0), told.step(5.0)
        told.start(oscillator, b.t1, b.y1, t_bound=10.0, jumped=False)
        assert a.t1 == pytest.approx(b.t1, rel=1e-14)
        assert b.y1 == pytest.approx(a.y1, rel=1e-13, abs=1e-13)


@pytest.mark.sampled(7)
def test_a_state_moved_without_a_jump_still_gets_its_own_derivative(name):
    solver = started(name)
    run(solver, 0.5)
    solver.start(oscillator, 0.5, exact(0.5), t_bound=10.0, jumped=False)
    assert run(solver, 1.0)[-1].y1 == pytest.approx(
        exact(1.0), abs=1e-2 if name in FIRST_ORDER else 1e-5
    )


@pytest.mark.sampled(7)
def test_the_number_of_states_may_change_at_a_jump(name):
    solver = started(name)
    run(solver, 0.5)
    solver.start(lambda t, y: -y, 0.5, np.ones(3), t_bound=1.0, jumped=True)
    assert run(solver, 1.0)[-1].y1 == pytest.approx(
        np.full(3, math.exp(-0.5)), abs=1e-2 if name in FIRST_ORDER else 1e-5
    )


@pytest.mark.sampled(8)
def test_a_jump_changes_the_field(name):
    # y' = 1 to t = 1, then y' = -2: a solver that kept the old derivative would be off.
    solver = make(name, step=0.25)
    solver.start(lambda t, y: np.ones(1), 0.0, np.zeros(1), t_bound=2.0, jumped=True)
    y = run(solver, 1.0)[-1].y1
    solver.start(lambda t, y: np.full(1, -2.0), 1.0, y, t_bound=2.0, jumped=True)
    assert run(solver, 2.0)[-1].y1[0] == pytest.approx(-1.0, abs=1e-12)


def test_a_model_without_states_passes_time(name):
    solver = started(name, y=(), field=lambda t, y: np.empty(0), max_step=0.3)
    steps = run(solver, 1.0)
    assert steps[-1].t1 == 1.0
    assert steps[0].interpolant(0.01).shape == (0,)
    assert steps[0].interpolant(np.array([0.0, 0.005])).shape == (0, 2)
    assert solver.retry(0.9995).t1 == 0.9995


def test_a_derivative_not_finite_at_the_start_is_refused_by_the_start(name):
    with pytest.raises(StepFailure) as caught:
        started(name, field=lambda t, y: np.array([0.0, np.nan]))
    assert caught.value.code == "HB-N202"
    assert caught.value.component == 1
    assert caught.value.exit_code == 3


def test_a_state_not_finite_is_refused_by_the_start(name):
    with pytest.raises(StepFailure) as caught:
        started(name, y=(np.inf, 0.0))
    assert (caught.value.code, caught.value.component) == ("HB-N202", 0)


@pytest.mark.sampled(3)
@pytest.mark.filterwarnings("error")
def test_where_the_derivative_ceases_to_exist_the_failure_names_the_state(name):
    # y1' = -sqrt(1 - t) has no value after t = 1.
    def field(t, y):
        return np.array([1.0, -np.sqrt(1.0 - t)])

    solver = started(name, field=field)
    with pytest.raises(StepFailure) as caught:
        run(solver, 2.0)
    failure = caught.value
    assert failure.code == "HB-N202"
    assert failure.component == 1
    assert failure.t == pytest.approx(1.0, abs=0.011)
    assert failure.h > 0.0
    assert "state 1" in str(failure)


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_underflow_says_when_and_which_state(adaptive):
    # y' = y^2, y(0) = 1 is 1/(1 - t): no solution beyond t = 1.
    solver = started(adaptive, y=(0.5, 1.0), field=lambda t, y: np.array([0.0, y[1] ** 2]))
    with pytest.raises(StepFailure) as caught:
        run(solver, 2.0)
    assert caught.value.code in ("HB-N201", "HB-N202")
    assert caught.value.component == 1
    assert caught.value.t == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_max_step_bounds_every_step(adaptive):
    solver = started(adaptive, max_step=0.1, rtol=1e-4)
    steps = run(solver, 2.0)
    assert max(s.t1 - s.t0 for s in steps) <= 0.1 * (1 + 1e-9)
    # The tolerance allows more, so that there is no step in vain.
    assert sum(s.t1 - s.t0 > 0.099 for s in steps) >= 18
    assert len(steps) <= 27


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_landing_does_not_spoil_the_step_size(adaptive):
    solver = started(adaptive)
    run(solver, 1.0)
    before = solver.h
    solver.start(oscillator, solver._t, solver._y, t_bound=10.0, jumped=False)
    solver.step(solver._t + 1e-6)
    assert solver.h >= 0.99 * before


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_the_hint_is_the_next_step_tried(adaptive):
    solver = started(adaptive)
    solver.h = 1e-3
    step = solver.step(1.0)
    assert step.t1 - step.t0 == pytest.approx(1e-3)
    with pytest.raises(ValueError, match="positive"):
        solver.h = 0.0


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_an_uncontrolled_quadrature_does_not_influence_the_steps(adaptive):
    # The integral of a wild function of time and state, with infinite scale.
    def with_quadrature(t, y):
        return np.array([y[1], -y[0], 1e6 * np.sign(np.sin(40.0 * t)) * y[0]])

    def scale(y0, y1):
        s = 1e-9 + 1e-6 * np.maximum(np.abs(y0), np.abs(y1))
        s[2:] = np.inf
        return s

    ends = []
    for field, y in ((oscillator, [1.0, 0.0]), (with_quadrature, [1.0, 0.0, 0.0])):
        solver = make_solver(adaptive, scale=scale, rtol=1e-6)
        solver.start(field, 0.0, np.array(y), t_bound=3.0, jumped=True)
        steps = run(solver, 3.0)
        ends.append([(s.t1, s.y1[0]) for s in steps])
        assert np.isfinite(steps[-1].y1).all()
    assert len(ends[0]) == len(ends[1])
    assert np.array(ends[1]) == pytest.approx(np.array(ends[0]), abs=1e-6)


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_with_nothing_controlled_steps_are_as_long_as_allowed(adaptive):
    solver = make_solver(adaptive, scale=lambda a, b: np.full(1, np.inf), rtol=1e-6, max_step=0.5)
    solver.start(lambda t, y: np.array([2.0 * t]), 0.0, np.zeros(1), t_bound=2.0, jumped=True)
    steps = run(solver, 20.0)
    assert steps[-1].y1[0] == pytest.approx(400.0, rel=1e-9)
    assert len(steps) < 60


@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
@pytest.mark.filterwarnings("error")
def test_a_scale_of_zero_where_nothing_happens(adaptive):
    solver = make_solver(adaptive, scale=lambda a, b: 1e-6 * np.abs(b), rtol=1e-6)
    solver.start(
        lambda t, y: np.array([0.0, -y[1]]), 0.0, np.array([0.0, 1.0]), t_bound=1.0, jumped=True
    )
    assert run(solver, 1.0)[-1].y1 == pytest.approx(np.array([0.0, math.exp(-1.0)]), rel=1e-5)


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("adaptive", ["rk45", "radau"])
def test_the_unit_of_time_does_not_matter(adaptive, unit):
    solver = make(adaptive)
    solver.start(
        lambda t, y: OMEGA @ y / unit, 0.0, np.array([0.0, 1.0]), t_bound=10.0 * unit, jumped=True
    )
    steps = run(solver, 10.0 * unit)
    reference = started(adaptive, y=(0.0, 1.0))
    assert abs(len(steps) - len(run(reference, 10.0))) <= 1
    assert steps[-1].y1 == pytest.approx([np.sin(10.0), np.cos(10.0)], abs=1e-4)
