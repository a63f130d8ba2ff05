"""Parts of control against closed forms and against what a computer does, step by step."""

import math

import numpy as np
import pytest
import scipy
from library.alone import alone, guards
from scipy.optimize import brentq

import hybond as hb


def test_a_step_is_at_its_time() -> None:
    run = alone("control.step", 2, at=0.5, before=-1, after=3)
    assert run["p.out"].at([0, 0.4999, 0.5, 2]).tolist() == [-1, -1, 3, 3]


def test_what_integrates_a_step_begins_exactly_there() -> None:
    m = hb.Model("sum")
    m.add(s=hb.Submodel("control.step", at=0.37))
    m.signal(area=hb.Integral("s.out"))
    assert hb.simulate(m, until=1)["area"].at(1) == pytest.approx(0.63, rel=1e-13)


def test_a_ramp_has_two_corners() -> None:
    run = alone("control.ramp", 4, at=1, duration=2, before=5, after=1)
    assert run["p.out"].at([0.5, 1.5, 2, 3, 4]) == pytest.approx([5, 4, 3, 1, 1])


def test_a_sine_is_one() -> None:
    run = alone("control.sine", 1, amplitude=2, frequency=3, phase=0.4, offset=5)
    expected = [5 + 2 * math.sin(6 * math.pi * t + 0.4) for t in (0.1, 0.77)]
    assert run["p.out"].at([0.1, 0.77]) == pytest.approx(expected, rel=1e-13)


def test_pulses_have_their_edges() -> None:
    run = alone("control.pulse", 4.2, period=1, duty=0.25, phase=0.5, high=3, low=-1)
    assert run["p.out"].at([0.4, 0.6, 0.8, 1.6, 1.8]).tolist() == [-1, 3, -1, 3, -1]


@pytest.mark.parametrize(("a", "b"), [(0.3, 0.0), (0.2, 0.5), (0.9, -0.25)])
def test_a_pulse_ends_where_the_sawtooth_meets_the_duty(a: float, b: float) -> None:
    run = alone("control.pwm", 1, period=0.25, duty=f"{a} + {b}*time")
    # rising with each period, falling at t = period*(k + duty(t))
    ends = [0.25 * (k + a) / (1 - 0.25 * b) for k in range(4)]
    edges = sorted([0.25, 0.5, 0.75, *ends])
    assert [t for t in guards(run) if t < 1] == pytest.approx(edges, abs=1e-10)
    assert run["p.out"].at([e + 1e-3 for e in ends]).tolist() == [0, 0, 0, 0]
    assert run["p.out"].at([e - 1e-3 for e in ends]).tolist() == [1, 1, 1, 1]


@pytest.mark.parametrize(("duty", "out"), [(-0.2, 0), (0, 0), (1, 1), (1.5, 1)])
def test_a_duty_at_its_ends_gives_no_edges(duty: float, out: int) -> None:
    run = alone("control.pwm", 1, period=0.1, duty=duty)
    assert run["p.out"].at(np.linspace(0.01, 0.99, 37)).tolist() == [out] * 37
    assert guards(run) == []


@pytest.mark.slow
def test_a_duty_that_ripples_is_met_where_it_is_at_that_instant() -> None:
    # a lag behind the output feeds the duty: d = 0.8 - 0.5*f, f at the end of its rise
    m = hb.Model("loop")
    m.add(f=hb.Submodel("control.lag", T=0.2, inputs={"u": "p.out"}))
    m.add(p=hb.Submodel("control.pwm", period=0.01, inputs={"duty": "0.8 - 0.5*f.out"}))
    m.signal(area=hb.Integral("p.out"))
    run = hb.simulate(m, until=4, rtol=1e-8)

    def beside(d: float) -> float:
        rise, whole = math.exp(-d * 0.05), math.exp(-0.05)
        return 0.8 - 0.5 * (1 - rise) / (1 - whole) - d

    duty = brentq(beside, 0, 1)
    assert run["area"].at(4) - run["area"].at(3) == pytest.approx(duty, rel=1e-6)


def test_a_comparator_has_two_thresholds() -> None:
    run = alone("control.comparator", 1, u="sin(2*pi*time)", upper=0.5, lower=-0.8)
    falls = 0.5 + math.asin(0.8) / (2 * math.pi)
    assert guards(run) == pytest.approx([1 / 12, falls], rel=1e-10)
    assert run["p.out"].at([0.05, 0.5, 0.7]).tolist() == [0, 1, 0]


@pytest.mark.parametrize(("level", "upper", "lower"), [(0, 0, 0), (0.5, 0.5, 0.5), (0, 0.5, 0)])
def test_a_comparator_lets_go_of_what_has_come_back_to_rest_at_its_threshold(
    level: float, upper: float, lower: float
) -> None:
    run = alone(
        "control.comparator", 4, u=f"{level} + max(sin(pi*time), 0)", upper=upper, lower=lower
    )
    assert run["p.out"].at([0.5, 1.5, 2.5, 3.5]).tolist() == [1, 0, 1, 0]


def test_a_three_point_switch_lets_go_of_what_has_come_back_to_rest_at_its_threshold() -> None:
    run = alone("control.three_point", 4, u="sin(pi*time)*mod(floor(time), 2)", on=0.5, off=0)
    assert run["p.out"].at([0.5, 1.5, 2.5, 3.5]).tolist() == [0, -1, 0, -1]
    run = alone("control.three_point", 4, u="max(sin(pi*time), 0)", on=0, off=0)
    assert run["p.out"].at([0.5, 1.5, 2.5, 3.5]).tolist() == [1, 0, 1, 0]


def test_a_three_point_switch_goes_forward_rests_and_goes_back() -> None:
    run = alone("control.three_point", 1, u="2*sin(2*pi*time)", on=1, off=0.5)
    on, off = math.asin(0.5) / (2 * math.pi), 0.5 - math.asin(0.25) / (2 * math.pi)
    assert guards(run) == pytest.approx([on, off, 0.5 + on, 0.5 + off], rel=1e-9)
    assert run["p.out"].at([0.05, 0.25, 0.5, 0.75, 0.99]).tolist() == [0, 1, 0, -1, 0]


def test_a_limiter_says_when_it_acts() -> None:
    run = alone("control.limiter", 4, u="time - 2", low=-1, high=0.5)
    assert run["p.out"].at([0, 1.5, 4]).tolist() == [-1, -0.5, 0.5]
    assert run["p.saturated"].at([0, 1.5, 4]).tolist() == [1, 0, 1]


def test_a_lag_is_an_exponential() -> None:
    run = alone("control.lag", 2, u=3, gain=2, T=0.4, start=1)
    assert run["p.out"].at(0.7) == pytest.approx(6 - 5 * math.exp(-0.7 / 0.4), rel=1e-8)


def test_a_rate_limiter_goes_straight_and_bends_in() -> None:
    run = alone("control.rate_limiter", 1, u=1, rise=2, T=0.05)
    bend = (1 - 2 * 0.05) / 2
    assert run["p.out"].at(0.3) == pytest.approx(0.6, rel=1e-9)
    left = 0.1 * math.exp(-(0.7 - bend) / 0.05)
    assert run["p.out"].at(0.7) == pytest.approx(1 - left, rel=1e-6)
    run = alone("control.rate_limiter", 1, u=-1, fall=0.5)
    assert run["p.out"].at(0.8) == pytest.approx(-0.4, rel=1e-9)


@pytest.mark.slow
def test_a_delay_is_the_rational_function_that_it_says() -> None:
    run = alone("control.delay", 2, u=1, T=0.5)
    t, y = scipy.signal.step(([-0.5 / 3, 1], [0.25 / 6, 1 / 3, 1]), T=np.linspace(0, 2, 401))
    assert run["p.out"].at(t) == pytest.approx(y, abs=1e-6)
    ramp = alone("control.delay", 5, u="time", T=0.5)
    assert ramp["p.out"].at(5) == pytest.approx(4.5, abs=1e-7)


def test_the_phase_of_a_delay_is_right_to_two_degrees_up_to_the_frequency_it_says() -> None:
    w = 2 * math.pi * 0.25
    _, _, phase = scipy.signal.bode(([-1 / 3, 1], [1 / 6, 2 / 3, 1]), [w])
    assert phase[0] == pytest.approx(-math.degrees(w), abs=2)


def test_a_pi_controller_leads_its_integral_back_at_the_limit() -> None:
    given = {"kp": 1, "ki": 1, "high": 2, "tracking": 0.5}
    run = alone("control.pi", 5, error="if time < 3 then 1 else -1", **given)
    # free until 1 + I = 2, then I' = 1 - (I - 1)/0.5; from t = 3 free again
    wound = 1.5 - 0.5 * math.exp(-2 * 2)
    assert run["p.integral"].at([0.5, 1]) == pytest.approx([0.5, 1], rel=1e-6)
    assert run["p.integral"].at(3) == pytest.approx(wound, rel=1e-6)
    assert run["p.out"].at(2.9) == 2
    assert run["p.out"].at(4) == pytest.approx(-1 + wound - 1, rel=1e-6)


def test_a_pid_controller_knows_the_rate() -> None:
    run = alone("control.pid", 1, error="3*time", kp=2, ki=4, kd=0.5, filter=0.05)
    for t in (0.1, 0.8):
        rate = 3 * (1 - math.exp(-t / 0.05))
        assert run["p.out"].at(t) == pytest.approx(6 * t + 6 * t**2 + 0.5 * rate, rel=1e-7)


def test_a_controller_a_limiter_and_a_motor_are_one_loop_of_signals() -> None:
    m = hb.Model("speed control", domain="electrical")
    m.add(ref=hb.Submodel("control.ramp", duration=0.1, after="50 rad/s", before="0 rad/s"))
    given = {"kp": "0.2 V*s/rad", "ki": "5 V/rad", "low": "-12 V", "high": "12 V", "start": "0 V"}
    m.add(c=hb.Submodel("control.pi", inputs={"error": "ref.out - motor.speed"}, **given))
    m.add(v=hb.Submodel("electrical.voltage_source", inputs={"u": "c.out"}))
    m.add(motor=hb.Submodel("electrical.dc_motor"), zero=hb.Submodel("electrical.ground"))
    m.bond("v.plus -> motor.plus", "motor.minus -> v.minus", "v.minus -> zero.pin")
    run = hb.simulate(m, until=2)
    assert run["motor.speed"].at(2) == pytest.approx(50, rel=1e-6)
    assert run["c.out"].unit == "V"
    assert run["c.out"].at(2) == pytest.approx(0.05 * 50 + 1e-5 * 50 / 0.05, rel=1e-6)


def test_limiters_that_need_each_other_are_refused() -> None:
    m = hb.Model("loop")
    m.add(a=hb.Submodel("control.limiter", inputs={"u": "b.out"}))
    m.add(b=hb.Submodel("control.limiter", inputs={"u": "2*a.out"}))
    with pytest.raises(hb.ModelError, match=r"a\.u -> b\.out -> b\.u -> a\.out") as caught:
        m.flatten()
    assert caught.value.code == "HB-M122"


def test_a_latch_is_set_and_reset() -> None:
    given = {"set": "time >= 1 and time < 2 or time >= 4", "reset": "time >= 3"}
    run = alone("control.latch", 5, **given)
    assert run["p.out"].at([0.5, 1.5, 2.5, 3.5, 4.5]).tolist() == [0, 1, 1, 0, 0]


def test_a_toggle_changes_with_each_rise() -> None:
    run = alone("control.toggle", 8, u="mod(time, 2) >= 1")
    assert run["p.out"].at(np.arange(8) + 0.5).tolist() == [0, 1, 1, 0, 0, 1, 1, 0]


def test_a_timer_waits_without_a_pause_and_begins_anew() -> None:
    u = "time >= 1 and time < 1.6 or time >= 2 and time < 4 or time >= 5"
    run = alone("control.timer", 6.5, u=u, T=0.75)
    assert run["p.out"].at([1.5, 2.7, 2.8, 3.9, 4.1, 5.7, 5.8]).tolist() == [0, 0, 1, 1, 0, 0, 1]
    assert run["p.waited"].at([1.5, 1.7, 2.5, 4.5]) == pytest.approx([0.5, 0, 0.5, 0], abs=1e-12)
    assert [t for t in guards(run) if 2 < t < 4] == pytest.approx([2.75], rel=1e-12)


def test_dead_time_keeps_both_switches_off_between() -> None:
    run = alone("control.dead_time", 3, command="time >= 1 and time < 2", T=0.1)
    at = [0.05, 0.15, 0.95, 1.05, 1.15, 1.95, 2.05, 2.15]
    assert run["p.upper"].at(at).tolist() == [0, 0, 0, 0, 1, 1, 0, 0]
    assert run["p.lower"].at(at).tolist() == [0, 1, 1, 0, 0, 0, 0, 1]


def test_the_gates_of_a_bridge_follow_each_other_by_a_sixth_of_a_period() -> None:
    run = alone("control.six_pulse", 0.06, alpha=0.4)
    period = 0.02
    for k in range(6):
        fires = (math.pi / 6 + 0.4 + k * math.pi / 3) / (2 * math.pi) * period
        ends = fires + 1.5 / (2 * math.pi) * period
        at = [period + fires - 1e-6, period + fires + 1e-6, period + ends - 1e-6]
        gate = run[f"p.gate_{k + 1}"]
        assert gate.at([*at, period + ends + 1e-6]).tolist() == [0, 1, 1, 0], k


def test_a_sampler_holds_what_it_read() -> None:
    run = alone("control.sampler", 1, u="time^2", every=0.25, phase=0.1, start=-1)
    found = run["p.out"].at([0.05, 0.2, 0.4, 0.99])
    assert found == pytest.approx([-1, 0.01, 0.35**2, 0.85**2], rel=1e-12)


@pytest.mark.parametrize("delay", [0.05, 0.2])
def test_a_sampled_delay_is_exact(delay: float) -> None:
    run = alone("control.sampled_delay", 1.7, u="time^2", every=0.2, delay=delay, start=-1)
    assert run["p.out"].at(delay / 2) == -1
    for k in range(7):
        out = run["p.out"].at([0.2 * k + delay + 1e-6, 0.2 * (k + 1) + delay - 1e-6])
        assert out == pytest.approx([(0.2 * k) ** 2] * 2, rel=1e-12, abs=1e-15)


def test_a_sampled_pi_controller_does_what_its_program_says() -> None:
    kp, ki, h = 2.0, 5.0, 0.05
    m = hb.Model("loop")
    given = {"kp": kp, "ki": ki, "every": h, "low": 0, "high": 1.2}
    m.add(c=hb.Submodel("control.sampled_pi", inputs={"error": "1 - y.out"}, **given))
    m.add(y=hb.Submodel("control.lag", T=0.5, inputs={"u": "c.out"}))
    run = hb.simulate(m, until=2, rtol=1e-10, atol=1e-12)
    y = integral = 0.0
    for k in range(40):
        error = 1 - y
        integral = min(max(integral + ki * h * error, 0), 1.2)
        out = min(max(kp * error + integral, 0), 1.2)
        assert run["c.out"].at(k * h + h / 2) == pytest.approx(out, rel=1e-7), k
        y = out + (y - out) * math.exp(-h / 0.5)
    assert run["y.out"].at(2) == pytest.approx(y, rel=1e-7)


def test_a_sampled_filter_goes_a_part_of_the_way() -> None:
    run = alone("control.sampled_filter", 1, u=1, every=0.1, weight=0.3)
    assert run["p.out"].at(0.75) == pytest.approx(1 - 0.7**8, rel=1e-12)


def test_a_counter_counts_what_it_sees() -> None:
    run = alone("control.counter", 4.05, u="mod(time, 1) >= 0.5", every=0.1, start=7)
    assert run["p.out"].at([0.3, 1.0, 2.0, 4.0]).tolist() == [7, 8, 9, 11]
    assert alone("control.counter", 4.05, u="mod(time, 1) >= 0.95", every=0.1)["p.out"].at(4) == 0


@pytest.mark.parametrize(
    "part, given",
    [
        ("pi", {"kp": 1, "low": -1, "high": 1}),
        ("pid", {"kp": 10, "kd": "10 s", "low": -1, "high": 1}),
    ],
)
def test_without_an_integral_a_limit_leaves_nothing_behind(
    part: str, given: dict[str, object]
) -> None:
    """What the limit led back stayed there for ever: 1.1 m for 5."""
    m = hb.Model("reaches", domain="translational")
    m.add(push=hb.Se("ctl.out*(1 [N])"), v=hb.One(), mass=hb.I("1 kg"), drag=hb.R("1 N*s/m"))
    m.bond("push -> v -> mass", "v -> drag")
    m.signal(x=hb.Integral("v.f"))
    m.add(ctl=hb.Submodel(f"control.{part}", ki=0, inputs={"error": "5 - x/(1 [m])"}, **given))
    run = hb.simulate(m, 60)
    assert run["x"].at(60) == pytest.approx(5.0, abs=1e-6) and run.final["ctl.integral"] == 0.0
