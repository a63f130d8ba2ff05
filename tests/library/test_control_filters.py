"""Filters, limits and means over windows against closed forms."""

import math
from itertools import pairwise

import numpy as np
import pytest
import scipy
from library.alone import alone, guards

import hybond as hb


@pytest.mark.parametrize(("lead", "lag"), [(0.4, 0.1), (0.05, 0.2)])
def test_a_lead_lag_answers_a_step_as_its_fraction_does(lead: float, lag: float) -> None:
    run = alone("control.lead_lag", 1, u=2, gain=3, lead=lead, lag=lag)
    for t in (0, 0.1, 0.8):
        expected = 6 * (1 + (lead / lag - 1) * math.exp(-t / lag))
        assert run["p.out"].at(t) == pytest.approx(expected, rel=1e-7), t


@pytest.mark.parametrize("damping", [0.2, 1.5])
def test_a_second_order_filter_is_four_fractions(damping: float) -> None:
    w = 2 * math.pi * 3
    run = alone("control.second_order", 0.5, u=1, frequency=3, damping=damping)
    t = np.linspace(0, 0.5, 26)
    below = [1, 2 * damping * w, w * w]
    above = {
        "low": [w * w],
        "band": [2 * damping * w, 0],
        "high": [1, 0, 0],
        "notch": [1, 0, w * w],
    }
    for name, top in above.items():
        _, y = scipy.signal.step((top, below), T=t)
        assert run[f"p.{name}"].at(t) == pytest.approx(y, abs=2e-6), name


@pytest.mark.parametrize(("depth", "damping"), [(0.0, 0.3), (0.25, 0.5)])
def test_a_notch_lets_its_depth_pass(depth: float, damping: float) -> None:
    w = 2 * math.pi * 50
    run = alone("control.notch", 0.06, u=1, frequency=50, depth=depth, damping=damping)
    fraction = ([1, 2 * depth * damping * w, w * w], [1, 2 * damping * w, w * w])
    t, y = scipy.signal.step(fraction, T=np.linspace(0, 0.06, 61))
    assert run["p.out"].at(t) == pytest.approx(y, abs=1e-6)
    # what stays of a sine of the middle frequency
    run = alone("control.notch", 0.3, u="sin(100*pi*time)", damping=damping, depth=depth)
    assert run["p.out"].at([0.3, 0.295]) == pytest.approx([0, -depth], abs=1e-6)


def test_a_dead_zone_lets_pass_what_is_beyond() -> None:
    run = alone("control.dead_zone", 4, u="time - 2", low=-1, high=0.5)
    assert run["p.out"].at([0, 1.5, 2.2, 4]).tolist() == [-1, 0, 0, 1.5]
    assert run["p.dead"].at([0, 1.5, 2.2, 4]).tolist() == [0, 1, 1, 0]


def test_a_quantiser_rounds_to_its_levels() -> None:
    run = alone("control.quantiser", 1, u="2*time - 1", step=0.25)
    t = np.linspace(0.013, 0.987, 40)
    assert run["p.out"].at(t) == pytest.approx(np.floor((2 * t - 1) / 0.25 + 0.5) * 0.25)
    assert np.abs(run["p.error"].at(t)).max() <= 0.125


def test_what_integrates_a_quantiser_has_the_area_of_its_stairs() -> None:
    m = hb.Model("stairs")
    m.add(p=hb.Submodel("control.quantiser", step=0.5, inputs={"u": "3*time"}))
    m.signal(area=hb.Integral("p.out"))
    run = hb.simulate(m, until=1)
    # levels 0, 0.5, ..., 3 change at 3*t = 0.25 + 0.5*k
    edges = [0, *((0.25 + 0.5 * k) / 3 for k in range(6)), 1]
    area = sum(0.5 * k * (b - a) for k, (a, b) in enumerate(pairwise(edges)))
    assert run["area"].at(1) == pytest.approx(area, rel=1e-9)


def test_a_converter_gives_whole_numbers() -> None:
    run = alone("control.adc", 1, u="6*time - 2", every=0.1, bits=3, low=-1, high=3)
    for k in range(10):
        level = math.floor((0.6 * k - 2 + 1) / 0.5 + 0.5 + 1e-9)
        at = 0.1 * k + 0.05
        assert run["p.code"].at(at) == min(max(level, 0), 7), k
        assert run["p.out"].at(at) == pytest.approx(-1 + 0.5 * min(max(level, 0), 7))
        assert run["p.clipped"].at(at) == (level < 0 or level > 7)


def test_a_delay_line_is_exact_at_its_instants() -> None:
    run = alone("control.delay_line", 1, u="time^2", delay=0.4, start=-1)
    for k in range(16):
        assert run["p.out"].at(0.025 * k + 0.01) == -1, k
    for k in range(16, 40):
        found = run["p.out"].at([0.025 * k + 1e-6, 0.025 * (k + 1) - 1e-6])
        assert found == pytest.approx([(0.025 * k - 0.4) ** 2] * 2, rel=1e-9, abs=1e-15), k


def test_a_mean_is_that_of_the_period_before() -> None:
    run = alone("control.mean", 1, u="3*time^2", period=0.25, start=9)
    assert run["p.out"].at(0.2) == 9
    for k in (1, 2, 3):
        mean = ((0.25 * k) ** 3 - (0.25 * (k - 1)) ** 3) / 0.25
        assert run["p.out"].at(0.25 * k + 0.1) == pytest.approx(mean, rel=1e-9)


def test_effective_values_of_a_sine_with_an_offset() -> None:
    run = alone("control.rms", 0.05, u="3 + 4*sin(100*pi*time + 0.3)", period=0.02)
    found = [run[f"p.{name}"].at(0.03) for name in ("mean", "out", "ripple")]
    assert found == pytest.approx([3, math.sqrt(9 + 8), math.sqrt(8)], rel=1e-7)
    assert run["p.out"].at(0.01) == 0


def test_windows_that_move_look_back_as_far_as_they_say() -> None:
    m = hb.Model("windows")
    given = {"window": 0.4, "start": 2}
    m.add(mean=hb.Submodel("control.moving_mean", inputs={"u": "3*time^2"}, **given))
    m.add(rms=hb.Submodel("control.moving_rms", inputs={"u": "3*time^2"}, **given))
    run = hb.simulate(m, until=1, rtol=1e-10)
    for k in (0, 1, 7, 15, 16, 17, 39):
        t = 0.025 * k
        first, before = max(t - 0.4, 0), max(0.4 - t, 0)
        mean = (t**3 - first**3 + 2 * before) / 0.4
        square = (9 * (t**5 - first**5) / 5 + 4 * before) / 0.4
        assert run["mean.out"].at(t + 0.012) == pytest.approx(mean, rel=1e-8), k
        assert run["rms.out"].at(t + 0.012) == pytest.approx(math.sqrt(square), rel=1e-8), k


def test_an_integrator_waits_at_its_stops() -> None:
    u = "if time < 2 then 1 else if time < 3 then -0.5 else -3"
    run = alone("control.integrator", 5, u=u, low=-1, high=1.5)
    found = run["p.out"].at([1, 1.5, 2, 3, 3.5, 5])
    assert found == pytest.approx([1, 1.5, 1.5, 1, -0.5, -1], abs=1e-8)
    assert run["p.rate"].at([1.8, 4.5]).tolist() == [0, 0]


def test_a_clamped_pi_controller_waits_then_slides_along_its_limit() -> None:
    # with error = 3 - time and kp = 1 the output waits at 2 until t = 1, and the gain takes 1/s
    # off; an integral of 0.5*error is too slow to slide along the limit, and is free from there
    given = {"kp": 1, "ki": 0.5, "low": -1, "high": 2}
    run = alone("control.pi_clamped", 3, error="3 - time", **given)
    assert run["p.integral"].at([0.5, 1]) == pytest.approx([0, 0], abs=1e-9)
    for t in (1.5, 2.9):
        free = 0.5 * (3 * t - t * t / 2 - 2.5)
        assert run["p.integral"].at(t) == pytest.approx(free, rel=1e-6)
    # one of 2*error slides until 2*error = 1, at t = 2.5
    run = alone("control.pi_clamped", 3, error="3 - time", **(given | {"ki": 2}))
    assert [(s.t0, s.t1) for s in run.sliding] == [(pytest.approx(1), pytest.approx(2.5))]
    assert run["p.out"].at([0.5, 1.2, 2.4]) == pytest.approx([2, 2, 2], abs=1e-6)
    assert run["p.integral"].at([1.2, 2.4]) == pytest.approx([0.2, 1.4], abs=1e-6)
    integral_at_the_end = 1.5 + 2 * (0.5**2 / 2)
    assert run["p.out"].at(3) == pytest.approx(integral_at_the_end, abs=1e-6)


def test_a_clamped_pi_controller_leaves_its_limit_when_the_error_turns() -> None:
    given = {"kp": 0.5, "ki": 2, "low": -1, "high": 1}
    run = alone("control.pi_clamped", 3, error="if time < 2 then 1 else -1", **given)
    # 0.5 + 2*time reaches 1 at 0.25 with the integral 0.5, which is all there is at t = 2
    assert run["p.integral"].at([0.1, 2]) == pytest.approx([0.2, 0.5], rel=1e-6)
    assert run["p.out"].at(2.1) == pytest.approx(-0.5 + 0.5 - 0.2, rel=1e-6)
    assert run["p.out"].at(3) == -1


def test_crossings_of_zero_are_timed() -> None:
    run = alone("control.period_meter", 2.2, u="sin(2*pi*(2*time + time^2/2)) - 0.2", band=0.1)
    rises = [t for t in guards(run) if run["p.positive"].at(t + 1e-4) == 1]
    phase = math.asin(0.3) / (2 * math.pi)
    first = -2 + math.sqrt(4 + 2 * phase)
    assert rises[0] == pytest.approx(first, rel=1e-9)
    expected = [-2 + math.sqrt(4 + 2 * (k + phase)) for k in range(7)]
    assert rises == pytest.approx(expected, rel=1e-9)
    for k in range(1, len(rises) - 1):
        between = rises[k + 1] - 0.01
        assert run["p.period"].at(between) == pytest.approx(rises[k] - rises[k - 1], rel=1e-9)
        assert run["p.frequency"].at(between) == pytest.approx(1 / (rises[k] - rises[k - 1]))
    assert run["p.period"].at([0.01, rises[1] - 0.01]).tolist() == [0, 0]


def test_a_biquad_is_the_filter_of_its_coefficients() -> None:
    b, a = scipy.signal.butter(2, 0.2)
    given = {"b0": b[0], "b1": b[1], "b2": b[2], "a1": a[1], "a2": a[2]}
    run = alone("control.sampled_biquad", 1, u="1 + sin(30*time)", every=0.025, **given)
    expected = scipy.signal.lfilter(b, a, 1 + np.sin(30 * 0.025 * np.arange(40)))
    assert run["p.out"].at(0.025 * np.arange(40) + 0.01) == pytest.approx(expected, abs=1e-12)


def test_a_sampled_pid_controller_does_what_its_program_says() -> None:
    given = {"kp": 2, "ki": 5, "kd": 0.1, "filter": 0.03, "low": -1, "high": 2.5}
    run = alone("control.sampled_pid", 2, error="cos(3*time)", every=0.05, **given)
    integral = rate = 0.0
    for k in range(40):
        error, last = math.cos(0.15 * k), math.cos(0.15 * (k - 1))
        rate = (0.03 * rate + (error - last if k else 0)) / 0.08
        integral = min(max(integral + 5 * 0.05 * error, -1), 2.5)
        out = min(max(2 * error + integral + 0.1 * rate, -1), 2.5)
        assert run["p.out"].at(0.05 * k + 0.02) == pytest.approx(out, abs=1e-12), k
        assert run["p.rate"].at(0.05 * k + 0.02) == pytest.approx(rate, abs=1e-12), k
