"""What time alone makes jump is known beforehand: no step is tried over it again and again.

A coil behind a square wave has a closed form, period by period. Written as an input its edges are
events; written in the source itself they took seven times the steps.
"""

import math

import pytest

import hybond as hb

U, R, L = 24.0, 0.5, 1e-3
PERIOD, DUTY, PERIODS = 1e-3, 0.3, 40
END = PERIODS * PERIOD + 0.6 * PERIOD
SQUARES = {
    "mod": f"if mod(time, {PERIOD}) < {DUTY * PERIOD} then {U} else 0",
    "floor": f"{U}*(if time/{PERIOD} - floor(time/{PERIOD}) < {DUTY} then 1 else 0)",
    "sign": f"{U / 2}*(1 + sign({DUTY} - mod(time/{PERIOD}, 1)))",
}


def coil(source, drag):
    m = hb.Model("coil", domain="electrical")
    m.add(V=hb.Se(source), L=hb.I(L), R=hb.R(drag), i=hb.One())
    m.bond("V -> i -> L", "i -> R")
    if source == "u":  # else its edges would be events, whatever reads it
        m.input(u=hb.Input(pwm={"period": PERIOD, "duty": DUTY, "high": U, "low": 0}))
    return m


def current():
    """The current at the end, in closed form."""
    on = math.exp(-R / L * DUTY * PERIOD)
    off = math.exp(-R / L * (1 - DUTY) * PERIOD)
    i = 0.0
    for _ in range(PERIODS):
        i = (U / R + (i - U / R) * on) * off
    return (U / R + (i - U / R) * on) * math.exp(-R / L * (0.6 - DUTY) * PERIOD)


@pytest.mark.parametrize("square", SQUARES)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_a_square_wave_takes_few_more_steps_than_an_input(square, solver):
    run = hb.simulate(coil(SQUARES[square], R), until=END, solver=solver)
    events = hb.simulate(coil("u", R), until=END, solver="radau" if solver == "radau" else "rk45")
    assert run["L.f"].at(END) == pytest.approx(current(), rel=1e-8)
    # two more at each edge, one next to it and one over it
    assert run.stats["steps"] <= events.stats["steps"] + 5 * PERIODS
    assert run.stats["rejected"] <= PERIODS


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_behind_a_law_that_bends(solver):
    bent = {"e": f"{R}*f*(1 + (f/40)^2)"}
    run = hb.simulate(coil(SQUARES["mod"], bent), until=END, solver=solver)
    events = hb.simulate(coil("u", bent), until=END, solver=solver)
    assert run["L.f"].at(END) == pytest.approx(events["L.f"].at(END), rel=1e-8)
    assert run.stats["steps"] <= events.stats["steps"] + 5 * PERIODS
    assert run.audit().holds() and not run.warnings


def test_many_edges_of_several_sources_are_each_met():
    """Three waves that have nothing in common: the area of each after five seconds is known."""
    parts = [(0.13, 0.4), (0.29, 0.7), (0.37, 0.15)]
    wave = " + ".join(f"(if mod(time, {p}) < {d * p} then 1 else 0)" for p, d in parts)
    m = hb.Model("sum", domain="translational")
    m.add(F=hb.Se(wave), m=hb.I("1 kg"), v=hb.One(), r=hb.R({"e": "0*f*abs(f)"}))
    m.bond("F -> v -> m", "v -> r")
    given = sum(int(5 / p) * d * p + min(5 - int(5 / p) * p, d * p) for p, d in parts)
    run = hb.simulate(m, until=5, solver="rk45")
    assert run["m.p"].at(5) == pytest.approx(given, rel=1e-10)
