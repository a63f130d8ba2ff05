"""Currents that laws make zero where Newton solves: their own value is rounding of the others."""

import numpy as np
import pytest
from scipy.integrate import simpson

import hybond as hb


def machine(name: str, speed: float, **values: float) -> hb.Model:
    """A machine of three phases that is turned at a speed, its phases free."""
    m = hb.Model("machine", domain="electrical")
    m.add(m=hb.Submodel(name, **values), drive=hb.Sf(speed, domain="rotational"))
    m.add(w=hb.One(domain="rotational"), low=hb.Zero(), ground=hb.Se(0))
    m.bond("drive -> w -> m.shaft", "ground -> low")
    return m


def on_a_bridge(name: str) -> hb.Result:
    m = machine(name, 100)
    m.add(bridge=hb.Submodel("electrical.three_phase_bridge"), i=hb.One(), load=hb.R(5))
    m.bond(*(f"m.{p} -> bridge.{p}" for p in "abc"))
    m.bond("bridge.plus -> i -> low -> bridge.minus", "i -> load")
    return hb.simulate(m, until="5 ms", rtol=1e-8)


@pytest.mark.slow
def test_a_machine_in_the_axes_of_its_rotor_feeds_a_diode_bridge() -> None:
    run = on_a_bridge("electrical.pmsm_park")
    other = on_a_bridge("electrical.pmsm")
    for name in ("load.f", "m.torque", "m.current_a", "m.i_d"):
        for t in (0.002, 0.0041, 0.005):
            assert run[name].at(t) == pytest.approx(other[name].at(t), rel=1e-6), (name, t)
    t = np.linspace(0, 0.005, 2501)
    heat = run["load.e*load.f"].at(t) + run["m.heat"].at(t)
    stored = 0.75 * (2e-3 * run["m.i_d"].at(0.005) ** 2 + 4e-3 * run["m.i_q"].at(0.005) ** 2)
    shaft = -100 * run["m.torque"].at(t)
    assert simpson(shaft - heat, dx=2e-6) == pytest.approx(stored, rel=1e-5)


def test_three_diodes_of_a_star_leave_a_phase_of_it_open() -> None:
    # the machine's star on three diodes to one node, two phases back: a phase at a time is open
    runs = []
    for name in ("electrical.pmsm_park", "electrical.pmsm"):
        m = machine(name, 60, L_d=3e-3, L_q=3e-3)
        for p in "ab":
            m.add(**{f"d_{p}": hb.One(law="diode"), f"r_{p}": hb.R(2)})
            m.bond(f"m.{p} -> d_{p} -> low", f"d_{p} -> r_{p}")
        m.bond("low -> m.c")
        runs.append(hb.simulate(m, until="20 ms", rtol=1e-8))
    for n in ("d_a.f", "d_b.f", "m.torque"):
        for t in (0.003, 0.0111, 0.02):
            assert runs[0][n].at(t) == pytest.approx(runs[1][n].at(t), rel=1e-6, abs=1e-7)


def test_an_inverter_that_is_shut_off_lets_the_machine_feed_its_supply() -> None:
    # all channels off at 400 rad/s: six diodes onto 100 V
    runs = []
    for name in ("electrical.pmsm_park", "electrical.pmsm"):
        m = machine(name, 400)
        m.add(legs=hb.Submodel("electrical.three_phase_inverter", inputs={"enable": 0}))
        m.add(top=hb.Zero(), V=hb.Se(100))
        m.bond("V -> top -> legs.plus", "legs.minus -> low", *(f"legs.{p} -> m.{p}" for p in "abc"))
        runs.append(hb.simulate(m, until="3 ms", rtol=1e-8))
    for n in ("V.f", "m.current_b", "m.torque"):
        for t in (0.0011, 0.002, 0.003):
            assert runs[0][n].at(t) == pytest.approx(runs[1][n].at(t), rel=1e-6, abs=1e-6)
    assert runs[0]["V.f"].at(0.003) < 0.0
