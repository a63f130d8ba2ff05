"""Pumps, pipes, controllers and modes of an instant as strangers write them, in closed form."""

from __future__ import annotations

import math
from itertools import accumulate

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb


def times(run: hb.Result) -> list[float]:
    """Return the times of what happened after the start."""
    return [event.t for event in run.events[1:]]


def test_an_unloading_valve_keeps_a_polytropic_accumulator_between_two_pressures() -> None:
    pump, load, n, p_atm = 4e-4, 1e-4, 1.25, 101325.0
    m = hb.Model("unloading", domain="hydraulic")
    m.add(tank=hb.Submodel("hydraulic.atmosphere"), takes=hb.Sf(-load), n=hb.Zero())
    flow = {"flow": f'if unload.state == "no" then {pump} else 0'}
    m.add(pump=hb.Submodel("hydraulic.flow_source", inputs=flow))
    m.add(acc=hb.Submodel("hydraulic.accumulator", V_gas="2 L", precharge="80 bar", n=n))
    m.bond("tank.port -> pump.inlet", "pump.outlet -> n", "n -> acc.port", "takes -> n")
    rules = ["no -> yes when acc.pressure >= 150 [bar]", "yes -> no when acc.pressure <= 110 [bar]"]
    m.machine("unload", states={"no": [], "yes": []}, start="no", rules=rules)
    run = hb.simulate(m, until=20)

    def volume(p: float) -> float:
        return 2e-3 * (1 - ((80e5 + p_atm) / (p + p_atm)) ** (1 / n))

    swing = volume(150e5) - volume(110e5)
    first = volume(150e5) / (pump - load)
    expected = list(accumulate([first] + [swing / load, swing / (pump - load)] * 2))
    assert times(run)[: len(expected)] == pytest.approx(expected, rel=1e-7)


def test_a_piston_pump_with_two_check_valves_gives_its_stroke_in_each_turn() -> None:
    area, crank, compliance = 1e-3, 0.02, 1e-9
    m = hb.Model("piston pump", domain="hydraulic", parameters={"w": 2 * math.pi * 10})
    m.add(moves=hb.Sf(f"{area * crank}*w*sin(w*time)"), ch=hb.Zero())
    m.add(tank=hb.Submodel("hydraulic.atmosphere"), suck=hb.Submodel("hydraulic.check_valve"))
    m.add(press=hb.Submodel("hydraulic.check_valve", cracking="0.5 bar"))
    m.add(vessel=hb.Submodel("hydraulic.volume", C=compliance, p_0="2 bar"))
    m.bond("moves -> ch", "tank.port -> suck.inlet", "suck.outlet -> ch")
    m.bond("ch -> press.inlet", "press.outlet -> vessel.port")
    run = hb.simulate(m, until=1.0)
    filled = [2e5 + turns * 2 * area * crank / compliance for turns in (1, 5, 10)]
    assert run["vessel.pressure"].at([0.05, 0.45, 1.0]) == pytest.approx(filled, rel=1e-7)
    assert len(times(run)) == 20


def test_four_tanks_that_fill_alike_overflow_in_one_event() -> None:
    m = hb.Model("tanks", domain="hydraulic")
    m.add({"s[1..4]": hb.Sf(1e-3), "n[1..4]": hb.Zero(), "c[1..4]": hb.C(1e-6)})
    m.add({"d[1..4]": hb.One(law="diode"), "r[1..4]": hb.R("1e6*i")})
    m.add(behind=hb.Se(1e4), common=hb.Zero())
    m.bond("s[1..4] -> n[1..4] -> c[1..4]", "n[1..4] -> d[1..4] -> common")
    m.bond("d[1..4] -> r[1..4]", "behind -> common")
    run = hb.simulate(m, until=30)
    found = [run[f"c[{k}].e"].at(30.0) for k in range(1, 5)]
    # where rounding of all that is stored by then lets it hold
    assert times(run) == pytest.approx([10.0], rel=2e-12)
    expected = [1e4 + 1e3 * k * (1 - math.exp(-20 / k)) for k in range(1, 5)]
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_valve_that_shuts_sends_a_wave_through_ten_pieces_of_a_line() -> None:
    n, inertance, compliance, R, shut, p, q = 10, 5e6, 1e-11, 2e5, 0.1, 5e5, 1e-3
    m = hb.Model("line", domain="hydraulic")
    m.add({"i[1..10]": hb.One(), "l[1..10]": hb.I(inertance, f=q), "r[1..10]": hb.R(R)})
    drop = [p - R * q * (k + 1) for k in range(n)]
    m.add({"n[1..10]": hb.Zero(), "c[1..10]": hb.C(compliance, e=drop)})
    m.add(S=hb.Se(p), valve=hb.One(), out=hb.R(drop[-1] / q))
    m.bond("S -> i[1]", "i[1..10] -> l[1..10]", "i[1..10] -> r[1..10]", "i[1..10] -> n[1..10]")
    m.bond("n[1..10] -> c[1..10]", "n[1..9] -> i[2..10]", "n[10] -> valve -> out")
    states, rules = {"open": ["valve"], "shut": []}, [f"open -> shut when time >= {shut}"]
    m.machine("V", states=states, start="open", rules=rules)
    rates = np.zeros((2 * n, 2 * n))
    for k in range(n):
        rates[k, k], rates[k, n + k], rates[n + k, k] = (
            -R / inertance,
            -1 / inertance,
            1 / compliance,
        )
        if k:
            rates[k, n + k - 1], rates[n + k - 1, k] = 1 / inertance, -1 / compliance
    rest = np.array([0.0] * n + [p] * n)
    begins = np.array([q] * n + drop)
    t = shut + 0.03 * np.arange(1, 6)
    expected = [(rest + expm(rates * (at - shut)) @ (begins - rest))[-1] for at in t]
    run = hb.simulate(m, until=0.3)
    assert run["c[10].e"].at(t) == pytest.approx(expected, rel=1e-6)


def test_a_sampled_pid_with_a_sample_of_delay_is_its_difference_equation() -> None:
    T, steps = 0.01, 60
    m = hb.Model("sampled", domain="translational")
    m.add(M=hb.I(2), v=hb.One(), k=hb.C(0.01), F=hb.Se("act"), d=hb.R(1))
    m.bond("F -> v -> M", "v -> k", "v -> d")
    m.signal(x=hb.Integral("v.f"), error="1 - x", before=hb.Sampled("error", every=T))
    m.signal(total=hb.Sampled("total + error*0.01", every=T), act=hb.Sampled("u", every=T))
    pid = "300*error + 500*total + 20*(error - before)/0.01"
    m.signal(u=hb.Sampled(pid, every=T))
    run = hb.simulate(m, until=steps * T)
    moves = expm(np.array([[0, 1, 0], [-50, -0.5, 0.5], [0, 0, 0]]) * T)
    y, total, before, u = np.zeros(3), 0.0, 0.0, 0.0
    for _ in range(steps):
        error = 1 - y[0]
        y[2] = u
        u = 300 * error + 500 * total + 20 * (error - before) / T
        total, before = total + error * T, error
        y = moves @ y
    assert run["x"].at(steps * T) == pytest.approx(y[0], rel=1e-8)


def test_a_relay_with_a_band_swings_at_the_period_of_its_switching_map() -> None:
    band, tau = 0.1, 0.5
    m = hb.Model("relay", domain="translational")
    m.add(F=hb.Se('if R.state == "up" then 1.0 else -1.0'), v=hb.One(), M=hb.I(tau), b=hb.R(1))
    m.bond("F -> v -> M", "v -> b")
    m.signal(x=hb.Integral("v.f"))
    rules = [f"up -> down when x >= {band}", f"down -> up when x <= -{band}"]
    m.machine("R", states={"up": [], "down": []}, start="up", rules=rules)
    run = hb.simulate(m, until=40)

    def misses(half: float) -> float:
        """From the lower end of the band at ``-speed`` to the upper one at ``speed``."""
        left = math.exp(-half / tau)
        speed = (1 - left) / (1 + left)
        return half - (1 + speed) * tau * (1 - left) - 2 * band

    half = brentq(misses, 0.1, 5, xtol=1e-14)
    ends = times(run)
    assert ends[-1] - ends[-3] == pytest.approx(2 * half, rel=1e-7)


def test_a_brake_that_tightens_where_the_drum_comes_to_rest_holds_the_load() -> None:
    m = hb.Model("winch", domain="rotational")
    m.add(M=hb.Se("if time < 1 [s] then 30 else 0"), w=hb.One(), J=hb.I(0.5), load=hb.Se(-10))
    m.add(brake=hb.One(law="coulomb", limit="if time < 2 [s] then 5 else 80"))
    m.bond("M -> w -> J", "load -> w", "w -> brake")
    run = hb.simulate(m, until=4)
    assert run["J.f"].at([1.0, 1.5]) == pytest.approx([30.0, 15.0], rel=1e-9)
    assert abs(run["J.f"].at(4.0)) < 1e-9


def test_a_relief_valve_opens_in_the_mythical_mode_of_an_actuator_shut_off() -> None:
    """Both valves shut would stop the piston by an impulse, and it opens the relief valve."""
    area, mass, drag, R, wide, p, p_set = 1e-3, 100.0, 50.0, 1e9, 1e8, 1e6, 5e6
    m = hb.Model("actuator", domain="hydraulic")
    m.add(S=hb.Se(p), intake=hb.One(), R=hb.R(R), cyl=hb.Zero(), relief=hb.One(), wide=hb.R(wide))
    m.add(holds=hb.Se(p_set), A=hb.TF(1 / area), v=hb.One(domain="translational"))
    m.add(M=hb.I(mass, f=-2, domain="translational"), b=hb.R(drag, domain="translational"))
    m.bond("S -> intake -> cyl", "intake -> R", "cyl -> relief -> wide", "relief -> holds")
    m.bond("cyl -> A -> v -> M", "v -> b")
    rules = ["open -> shut when time >= 0.01"]
    m.machine("I", states={"open": ["intake"], "shut": []}, start="open", rules=rules)
    rules = ["shut -> open when relief.e > 0", "open -> shut when relief.f < 0"]
    m.machine("relieves", states={"shut": [], "open": ["relief"]}, start="shut", rules=rules)
    run = hb.simulate(m, until=0.6)
    rate = (R * area**2 + drag) / mass
    v = p * area / mass / rate + (-2 - p * area / mass / rate) * math.exp(-0.01 * rate)
    assert run["v.f"].at(0.01, side="left") == pytest.approx(v, rel=1e-9)
    rate, push = (wide * area**2 + drag) / mass, p_set * area / mass
    ends = 0.01 + math.log((push - v * rate) / push) / rate
    assert times(run) == pytest.approx([0.01, ends], rel=1e-9)
    assert [s.kind for s in run.events[1].steps] == ["mythical", "continuous"]


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1.0, 1e6, 1e12])
def test_a_coil_behind_a_diode_empties_into_its_capacitor_in_any_unit(size: float) -> None:
    """The current ends at its first zero; the diode conducts again at five volts of its unit."""
    m = hb.Model("ring")
    m.add(V=hb.Se(5 * size), d=hb.One(law="diode"), L=hb.I(1e-3 * size), n=hb.Zero())
    m.add(C=hb.C(1e-6 / size), R=hb.R(1e3 * size))
    m.bond("V -> d -> n", "d -> L", "n -> C", "n -> R")
    run = hb.simulate(m, until=2e-3)
    damping = 500.0
    w = math.sqrt(1e9 - damping**2)

    def state(t: float) -> tuple[float, float]:
        """Current and voltage: both ring about 5 mA and 5 V."""
        fades = math.exp(-damping * t)
        first = (damping * -5 + 0.0) / w
        v = 5 + fades * (-5 * math.cos(w * t) + first * math.sin(w * t))
        slope = fades * (
            (damping * 5 + w * first) * math.cos(w * t)
            + (5 * w - damping * first) * math.sin(w * t)
        )
        return v / 1e3 + 1e-6 * slope, v

    ends = brentq(lambda t: state(t)[0], 0.5 * math.pi / w, 1.5 * math.pi / w, xtol=1e-16)
    again = ends + 1e-3 * math.log(state(ends)[1] / 5)
    assert times(run)[:2] == pytest.approx([ends, again], rel=1e-9)


def test_three_machines_follow_one_another_within_one_instant() -> None:
    m = hb.Model("steps", domain="electrical")
    m.add(V=hb.Se(10), n=hb.Zero(), i=hb.One(), inside=hb.R(5), C=hb.C(1e-2))
    m.add({"s[1..3]": hb.One(), "r[1..3]": hb.R("5*2^i")})
    m.bond("V -> i -> n", "i -> inside", "n -> C", "n -> s[1..3] -> r[1..3]")
    guards = ["n.e >= 5", 'A.state == "on"', "s[2].on and s[1].on"]
    for name, k, guard in zip("ABD", (1, 2, 3), guards, strict=True):
        states = {"off": [], "on": [f"s[{k}]"]}
        m.machine(name, states=states, start="off", rules=[f"off -> on when {guard}"])
    run = hb.simulate(m, until=0.5)
    begins, G = 5e-2 * math.log(2), 1 / 5 + 1 / 10 + 1 / 20 + 1 / 40
    assert times(run) == pytest.approx([begins], rel=1e-9)
    expected = 2 / G + (5 - 2 / G) * math.exp(-(0.2 - begins) * G / 1e-2)
    assert run["C.e"].at(0.2) == pytest.approx(expected, rel=1e-9)
