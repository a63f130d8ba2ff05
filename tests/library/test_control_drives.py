"""What drives motors: axes, current control, encoders, commutation, against closed forms."""

import math
from functools import cache

import numpy as np
import pytest
from library.alone import alone
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import hybond as hb

THIRD = 2 * math.pi / 3


def phases(size: str, angle: str) -> dict[str, str]:
    """Return three phases as expressions, each a third of a turn after the one before."""
    return {p: f"{size}*cos({angle} - {k}*2*pi/3)" for k, p in enumerate("abc")}


def test_park_sees_three_phases_as_two_numbers() -> None:
    mixed = {p: f"0.7 + {text}" for p, text in phases("5", "(30*time + 0.4)").items()}
    run = alone("control.park", 1, angle="30*time", **mixed)
    t = np.linspace(0, 1, 7)
    assert run["p.d"].at(t) == pytest.approx(5 * math.cos(0.4), rel=1e-12)
    assert run["p.q"].at(t) == pytest.approx(5 * math.sin(0.4), rel=1e-12)
    assert run["p.zero"].at(t) == pytest.approx(0.7, rel=1e-12)
    assert run["p.alpha"].at(t) == pytest.approx(5 * np.cos(30 * t + 0.4), abs=1e-12)
    assert run["p.beta"].at(t) == pytest.approx(5 * np.sin(30 * t + 0.4), abs=1e-12)


def test_inverse_park_makes_three_phases() -> None:
    run = alone("control.inverse_park", 1, angle="20*time", d=3, q=4)
    t = np.linspace(0, 1, 7)
    for k, phase in enumerate("abc"):
        expected = 5 * np.cos(20 * t + math.atan2(4, 3) - k * THIRD)
        assert run[f"p.{phase}"].at(t) == pytest.approx(expected, abs=1e-12), phase


@cache
def controlled(part: str) -> hb.Model:
    """A machine driven at a speed, its currents controlled with ideal voltages up to `top`."""
    m = hb.Model("drive", domain="electrical", parameters={"top": "1000 V"})
    park = "" if part.startswith("sampled") else "_park"  # which is quicker to make ready here
    m.add(m=hb.Submodel(f"electrical.pmsm{park}"))
    wanted = {"d": "-2 [A]", "q": "6 [A]", "i_d": "m.i_d", "i_q": "m.i_q", "v_max": "top"}
    m.add(reg=hb.Submodel(f"control.{part}", inputs={"speed": "4*m.speed", **wanted}))
    turned = {"d": "reg.v_d", "q": "reg.v_q", "angle": "m.electrical_angle"}
    m.add(u=hb.Submodel("control.inverse_park", inputs=turned))
    for phase in "abc":
        m.add(**{f"V_{phase}": hb.Se(f"u.{phase}"), phase: hb.Zero()})
        m.bond(f"V_{phase} -> {phase} -> m.{phase}")
    m.add(drive=hb.Sf("50 rad/s", domain="rotational"), w=hb.One(domain="rotational"))
    m.bond("drive -> w -> m.shaft")
    return m


@pytest.mark.slow
def test_decoupled_currents_follow_by_an_exponential() -> None:
    """A step of what `"control.dq_current"` wants, with the machine's own values."""
    run = hb.simulate(controlled("dq_current"), until="6 ms", rtol=1e-8, atol=1e-10)
    for t in (0.0005, 0.002, 0.006):
        part = 1 - math.exp(-1000 * t)
        found = [run["m.i_d"].at(t), run["m.i_q"].at(t)]
        assert found == pytest.approx([-2 * part, 6 * part], rel=1e-6), t


@pytest.mark.slow
def test_a_voltage_that_does_not_suffice_keeps_its_direction_and_does_not_wind_up() -> None:
    r, l_d, l_q, psi, w, tracking, top = 0.5, 2e-3, 4e-3, 0.1, 200.0, 1e-3, 24.5

    def rates(_: float, x: np.ndarray) -> list[float]:
        i_d, i_q, s_d, s_q = x
        e_d, e_q = -2 - i_d, 6 - i_q
        raw = 1000 * l_d * e_d + s_d - w * l_q * i_q, 1000 * l_q * e_q + s_q
        raw = raw[0], raw[1] + w * (l_d * i_d + psi)
        part = min(1, top / math.hypot(*raw))
        v_d, v_q = part * raw[0], part * raw[1]
        return [
            (v_d - r * i_d + w * l_q * i_q) / l_d,
            (v_q - r * i_q - w * (l_d * i_d + psi)) / l_q,
            1000 * r * e_d + (v_d - raw[0]) / tracking,
            1000 * r * e_q + (v_q - raw[1]) / tracking,
        ]

    run = hb.simulate(
        controlled("dq_current"), until="5 ms", rtol=1e-7, atol=1e-9, parameters={"top": top}
    )
    told = solve_ivp(rates, (0, 0.005), [0] * 4, rtol=1e-9, atol=1e-11, t_eval=[0.001, 0.005])
    for k, name in enumerate(("m.i_d", "m.i_q", "reg.integral_d", "reg.integral_q")):
        assert run[name].at([0.001, 0.005]) == pytest.approx(told.y[k], rel=1e-5, abs=1e-6), name
    assert run["reg.scale"].at(0.001) < 0.9


def test_a_sampled_current_controller_does_what_its_program_says() -> None:
    """`"control.sampled_dq_current"` on a machine whose axes are linear at a constant speed."""
    r, l_d, l_q, psi, w, top, h = 0.5, 2e-3, 4e-3, 0.1, 200.0, 24.5, 1e-4
    a = np.array([[-r / l_d, w * l_q / l_d], [-w * l_d / l_q, -r / l_q]])
    step = expm(a * h)
    run = hb.simulate(
        controlled("sampled_dq_current"),
        until="4 ms",
        rtol=1e-8,
        atol=1e-10,
        parameters={"top": top},
    )
    i, s = np.zeros(2), np.zeros(2)
    for k in range(40):
        error = np.array([-2, 6]) - i
        s = s + 1000 * r * h * error
        raw = 1000 * np.array([l_d, l_q]) * error + s
        raw += w * np.array([-l_q * i[1], l_d * i[0] + psi])
        part = min(1, top / math.hypot(*raw))
        s = s + (part - 1) * raw * h / 1e-3
        rest = -np.linalg.solve(a, (part * raw - [0, w * psi]) / [l_d, l_q])
        i = rest + step @ (i - rest)
        at = (k + 1) * h - 1e-9
        assert [run[f"reg.v_{x}"].at(at) for x in "dq"] == pytest.approx(part * raw, rel=1e-6), k
        assert [run[f"m.i_{x}"].at(at) for x in "dq"] == pytest.approx(i, rel=1e-3, abs=1e-5)


def test_an_encoder_shows_quarters_of_its_lines() -> None:
    run = alone("control.encoder", 4, lines=2, angle="if time < 3 then time else 6 - time")
    quarter = 2 * math.pi / 8
    for t in (0.3, 1, 1.8, 2.5, 2.9, 3.5, 3.9):
        angle = t if t < 3 else 6 - t
        place = math.floor(angle / quarter)
        found = [run[f"p.{s}"].at(t) for s in ("count", "a", "b", "index")]
        assert found == [place, place % 4 in (0, 1), place % 4 in (1, 2), place == 0], t
        assert run["p.measured"].at(t) == pytest.approx(place * quarter)


@pytest.mark.parametrize(("speed", "seen"), [(6.0, True), (40.0, False)])
def test_a_decoder_counts_what_it_can_tell(speed: float, seen: bool) -> None:
    # 8 quarters in a turn, looks every 0.1 s: up to one quarter between two looks can be told
    m = hb.Model("count")
    turn = f"{speed}*(if time < 1 then time else 2 - time)"
    m.add(e=hb.Submodel("control.encoder", lines=2, inputs={"angle": f"0.1 + {turn}"}))
    eyes = {"a": "e.a", "b": "e.b"}
    m.add(d=hb.Submodel("control.quadrature_decoder", every=0.1, start=100, inputs=eyes))
    run = hb.simulate(m, until=2)
    places = [
        math.floor(8 * (0.1 + speed * (t if t < 1 else 2 - t)) / (2 * math.pi))
        for t in np.arange(20) * 0.1
    ]
    moved = np.diff(places)
    told = np.where(moved % 4 == 3, -1, np.where(moved % 4 == 2, 0, moved % 4))
    assert bool(np.all(told == moved)) == seen
    count = 100 + np.concatenate([[0], np.cumsum(told)])
    at = np.arange(20) * 0.1 + 0.05
    assert run["d.count"].at(at) == pytest.approx(count)
    assert run["d.missed"].at(1.99) == np.sum(moved % 4 == 2)
    assert run["d.rate"].at(at[1:]) == pytest.approx(told / 0.1)


def test_a_phase_locked_loop_finds_angle_and_frequency() -> None:
    def error(_: float, x: np.ndarray) -> list[float]:
        behind = math.sin(x[0])
        return [2 * math.pi * 2 - 280 * behind - x[1], 40000 * behind]

    run = alone("control.pll", 0.1, amplitude=10, **phases("10", "(104*pi*time + 0.8)"))
    told = solve_ivp(error, (0, 0.1), [0.8, 0], rtol=1e-10, atol=1e-12, t_eval=[0.005, 0.02, 0.1])
    for k, t in enumerate((0.005, 0.02, 0.1)):
        behind = 104 * math.pi * t + 0.8 - run["p.angle"].at(t)
        assert behind == pytest.approx(told.y[0][k], abs=1e-7), t
    assert run["p.frequency"].at(0.1) == pytest.approx(52, abs=1e-3)


def test_volts_follow_hertz_up_to_the_limit() -> None:
    given = {"ratio": 6, "boost": 10, "limit": 100}
    run = alone("control.volts_per_hertz", 2, frequency="20 [1/s^2]*time - 10 [Hz]", **given)
    for t in (0.1, 0.5, 1.5, 1.95):
        hertz = 20 * t - 10
        size = min(10 + 6 * abs(hertz), 100)
        angle = 2 * math.pi * (10 * t * t - 10 * t)
        for k, phase in enumerate("abc"):
            expected = size * math.cos(angle - k * THIRD)
            assert run[f"p.{phase}"].at(t) == pytest.approx(expected, abs=1e-6), (t, phase)


def test_commutation_follows_the_flat_parts() -> None:
    # one electrical turn a second; the table of every textbook, from 30 degrees on
    halls = {
        f"hall_{p}": f"sin(2*pi*time - {lag}) > 0"
        for p, lag in zip("abc", ("pi/6", "5*pi/6", "-pi/2"))
    }
    table = [(1, 6), (1, 2), (3, 2), (3, 4), (5, 4), (5, 6)]
    run = alone("control.six_step", 1, **halls)
    back = alone("control.six_step", 1, reverse=1, **halls)
    idle = alone("control.six_step", 1, chop=0, **halls)
    for k, (upper, lower) in enumerate(table):
        t = ((60 * k + 60) / 360) % 1
        on = [g for g in range(1, 7) if run[f"p.gate_{g}"].at(t)]
        assert on == sorted((upper, lower)), k
        turned = {1: 4, 4: 1, 3: 6, 6: 3, 5: 2, 2: 5}
        on = [g for g in range(1, 7) if back[f"p.gate_{g}"].at(t)]
        assert on == sorted((turned[upper], turned[lower])), k
        assert [g for g in range(1, 7) if idle[f"p.gate_{g}"].at(t)] == [lower]


def test_microsteps_go_round_a_circle() -> None:
    run = alone("control.microstep", 4, microsteps=4, steps="time")
    t = np.linspace(0.03, 3.97, 23)
    held = np.floor(4 * t) / 4
    assert run["p.a"].at(t) == pytest.approx(np.cos(np.pi / 2 * held), abs=1e-12)
    assert run["p.b"].at(t) == pytest.approx(np.sin(np.pi / 2 * held), abs=1e-12)


@pytest.mark.parametrize(("l_d", "l_q"), [(2e-3, 4e-3), (3e-3, 3e-3), (5e-3, 2e-3)])
def test_no_other_angle_of_the_current_makes_more_torque(l_d: float, l_q: float) -> None:
    run = alone("control.mtpa", 2, current="40 [A/s]*time - 30 [A]", L_d=l_d, L_q=l_q)
    for t in (0.2, 1.2, 2):
        amperes = 40 * t - 30
        angle = np.linspace(0, math.pi, 20001) * math.copysign(1, amperes)
        d, q = abs(amperes) * np.cos(angle), abs(amperes) * np.sin(angle)
        torque = 0.1 * q + (l_d - l_q) * d * q
        best = np.argmax(np.abs(torque))
        assert run["p.d"].at(t) == pytest.approx(d[best], abs=2e-4 * abs(amperes))
        assert run["p.q"].at(t) == pytest.approx(q[best], abs=2e-4 * abs(amperes))


def test_perturb_and_observe_climbs_to_the_power_of_the_data_sheet() -> None:
    m = hb.Model("solar", domain="electrical")
    m.add(s=hb.Submodel("electrical.solar_module"), sink=hb.Se("track.out"), zero=hb.Se(0))
    given = {"every": 0.01, "step": 0.25, "start": 25, "high": 40}
    inputs = {"power": "s.delivered"}
    m.add(track=hb.Submodel("control.mppt", inputs=inputs, **given), top=hb.Zero(), low=hb.Zero())
    m.bond("sink -> top -> s.plus", "s.minus -> low", "zero -> low")
    run = hb.simulate(m, until=1)
    volts = run["track.out"].at(np.arange(60) * 0.01 + 0.405)
    assert np.abs(volts - 30.4).max() <= 2 * 0.25
    assert run["s.delivered"].at(0.99) == pytest.approx(30.4 * 8.24, rel=1e-3)


def test_a_sampled_rate_limiter_goes_by_equal_steps() -> None:
    u = "if time < 1 then 1 else -1"
    run = alone("control.sampled_rate_limiter", 2, u=u, every=0.1, rise=4, fall=2.5)
    y = 0.0
    for k in range(20):
        # at an instant the input still is what it was before
        aim = 1 if 0.1 * k < 1.05 else -1
        y += min(max(aim - y, -0.25), 0.4)
        assert run["p.out"].at(0.1 * k + 0.05) == pytest.approx(y, abs=1e-12), k


@pytest.mark.parametrize("behind", [0.5, -1.1])
def test_three_phases_have_constant_powers(behind: float) -> None:
    volts = {f"v_{p}": f"3 [V] + {t}" for p, t in phases("20 [V]", "(90*time)").items()}
    amperes = {f"i_{p}": t for p, t in phases("4 [A]", f"(90*time - {behind})").items()}
    run = alone("control.three_phase_power", 1, **volts, **amperes)
    t = np.linspace(0, 1, 9)
    assert run["p.active"].at(t) == pytest.approx(1.5 * 80 * math.cos(behind), rel=1e-12)
    assert run["p.reactive"].at(t) == pytest.approx(1.5 * 80 * math.sin(behind), rel=1e-12)
    assert run["p.factor"].at(0.3) == pytest.approx(math.cos(behind))
    assert run["p.active"].unit == "W"
