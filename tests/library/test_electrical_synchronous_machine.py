"""A machine with field winding and dampers against its linear equations and two reactions."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.linalg import expm

import hybond as hb

W = 100 * math.pi
R, L_L, L_MD, L_MQ, R_F, L_F, M = 0.6, 4e-3, 57e-3, 32e-3, 5.0, 1.2, 0.2
L_D, L_Q = L_L + L_MD, L_L + L_MQ
JOINTS = ("a - m.a", "b - m.b", "c - m.c", "hot - m.field_plus", "m.field_minus - cold")

# flux linkages of d, q, field, damper d, damper q by their currents; the field is linked by three
# phases, which the amplitudes of an axis count as 1.5
FLUX = np.zeros((5, 5))
FLUX[np.ix_([0, 2, 3], [0, 2, 3])] = [
    [L_D, M, L_MD],
    [1.5 * M, L_F, 1.5 * M],
    [L_MD, M, L_MD + 4e-3],
]
FLUX[np.ix_([1, 4], [1, 4])] = [[L_Q, L_MQ], [L_MQ, L_MQ + 4e-3]]
LOSS = np.diag([R, R, R_F, 1.0, 1.0])
TURN = np.zeros((5, 5))
TURN[0, 1], TURN[1, 0] = -W, W


def on_the_grid(v_d: float, v_q: float, field: float) -> hb.Model:
    """The machine turned at its synchronous speed on a grid that stands at a load angle."""
    m = hb.Model("grid", domain="electrical")
    m.add(m=hb.Submodel("electrical.synchronous_machine"), hot=hb.Zero(), cold=hb.Zero())
    size, ahead = math.hypot(v_d, v_q), math.atan2(v_q, v_d)
    for k, phase in enumerate("abc"):
        text = f"{size}*cos(100*pi*time + {ahead} - {k}*2*pi/3)"
        m.add(**{f"V_{phase}": hb.Se(text), phase: hb.Zero()})
        m.bond(f"V_{phase} -> {phase}")
    m.add(E=hb.Se(field), zero=hb.Se(0), drive=hb.Sf(W / 2, domain="rotational"))
    m.add(w=hb.One(domain="rotational"))
    m.bond("E -> hot", "zero -> cold", "drive -> w")
    return m


def begun(i_d: float, i_q: float, field: float) -> hb.Model:
    """The part with currents that flow at the start, where its field faces winding a."""
    part = hb.library.part("electrical.synchronous_machine")
    stored = FLUX @ [i_d, i_q, field, 0, 0] * [1.5, 1.5, 1, 1.5, 1.5]
    law = part.elements["field"].value
    part.elements["field"] = hb.C(law, q=[*stored, 0], domain="rotational")
    return part


def test_its_windings_follow_five_linear_equations() -> None:
    volts = np.array([-120, 290, 30, 0, 0])
    inverse = np.linalg.inv(FLUX)
    a = -inverse @ (LOSS + TURN @ FLUX)
    rest = -np.linalg.solve(a, inverse @ volts)
    m = on_the_grid(-120, 290, 30)
    for way in every_way(m, *JOINTS, "w - m.shaft")[:2]:
        run = hb.simulate(way, until="0.03 s", rtol=1e-7)
        for t in (0.004, 0.03):
            now = rest - expm(a * t) @ rest
            found = [run[f"m.{n}"].at(t) for n in ("i_d", "i_q", "i_f", "i_kd", "i_kq")]
            assert found == pytest.approx(now, rel=1e-5, abs=1e-4), way.name
            flux = FLUX @ now
            torque = 1.5 * 2 * (flux[0] * now[1] - flux[1] * now[0])
            assert run["m.torque"].at(t) == pytest.approx(torque, rel=1e-5, abs=1e-4)
            assert run["m.flux_d"].at(t) == pytest.approx(flux[0], rel=1e-5)
            heat = np.array([1.5 * R, 1.5 * R, R_F, 1.5, 1.5]) @ now**2
            assert run["m.heat"].at(t) == pytest.approx(heat, rel=1e-5)
    assert run.audit().power < 1e-12


def test_its_power_is_that_of_two_reactions() -> None:
    # without stator resistance, begun in the steady state: 40 degrees ahead of the grid
    load, volts, amperes = math.radians(40), 320.0, 6.0
    emf = W * M * amperes
    v_d, v_q = volts * math.sin(load), volts * math.cos(load)
    i_d, i_q = (v_q - emf) / (W * L_D), -v_d / (W * L_Q)
    part = begun(i_d, i_q, amperes)
    m = on_the_grid(v_d, v_q, R_F * amperes)
    m.elements["m"] = hb.Submodel(part, R=1e-12)
    run = hb.simulate(every_way(m, *JOINTS, "w - m.shaft")[1], until="20 ms", rtol=1e-8)
    power = -1.5 * (
        emf * volts * math.sin(load) / (W * L_D)
        + volts**2 / 2 * (1 / (W * L_Q) - 1 / (W * L_D)) * math.sin(2 * load)
    )
    for t in (0.001, 0.02):
        assert run["m.torque"].at(t) * W / 2 == pytest.approx(power, rel=1e-6)
        assert run["m.power"].at(t) == pytest.approx(power, rel=1e-6)


def test_at_no_load_the_field_gives_the_voltage() -> None:
    m = hb.Model("no load", domain="electrical")
    m.add(m=hb.Submodel(begun(0, 0, 5)), hot=hb.Zero(), cold=hb.Zero())
    m.add(E=hb.Se(25), zero=hb.Se(0), drive=hb.Sf(W / 2, domain="rotational"))
    m.add(w=hb.One(domain="rotational"), star=hb.Zero())
    m.bond("E -> hot", "zero -> cold", "drive -> w", "cold -> star")
    for phase in "abc":
        m.add(**{phase: hb.Zero(), f"r_{phase}": hb.Submodel("electrical.resistor", R=1e4)})
        m.bond(f"{phase} -> r_{phase}.plus", f"r_{phase}.minus -> star")
    run = hb.simulate(
        every_way(m, *JOINTS, "w - m.shaft")[0], until="20 ms", rtol=1e-6, solver="radau"
    )
    t = np.array([0.003, 0.008, 0.0131, 0.02])
    emf = -W * M * 25 / R_F * np.sin(W * t)
    assert run["r_a.voltage"].at(t) == pytest.approx(emf, abs=0.3)
    assert run["m.i_f"].at(0.02) == pytest.approx(5, rel=1e-3)
