"""Machines on three phases against Park's equations, the equivalent circuit and closed forms."""

import cmath
import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.integrate import simpson, solve_ivp

import hybond as hb

THREE = ("a - m.a", "b - m.b", "c - m.c")
LAGS = (0, 2 * math.pi / 3, 4 * math.pi / 3)


def on_three_phases(part: str, volts: list[str], speed: float | None, **values: float) -> hb.Model:
    """A machine on three stiff sources, its shaft free, or driven at a speed."""
    m = hb.Model("drive", domain="electrical")
    m.add(m=hb.Submodel(part, **values))
    for phase, text in zip("abc", volts):
        m.add(**{f"V_{phase}": hb.Se(text), phase: hb.Zero()})
        m.bond(f"V_{phase} -> {phase}")
    if speed is not None:
        m.add(drive=hb.Sf(speed, domain="rotational"), w=hb.One(domain="rotational"))
        m.bond("drive -> w")
    return m


def cosines(size: float, angle: str) -> list[str]:
    return [f"{size}*cos({angle} - {k}*2*pi/3)" for k in range(3)]


PM = {"p": 4, "psi": 0.1, "r": 0.5, "l_d": 2e-3, "l_q": 4e-3, "j": 1e-3, "drag": 1e-4}


def park(v_d: float, v_q: float, x: np.ndarray) -> list[float]:
    """The textbook's equations of a salient machine: rates of i_d, i_q, speed, angle."""
    i_d, i_q, speed, _ = x
    w = PM["p"] * speed
    torque = 1.5 * PM["p"] * (PM["psi"] * i_q + (PM["l_d"] - PM["l_q"]) * i_d * i_q)
    return [
        (v_d - PM["r"] * i_d + w * PM["l_q"] * i_q) / PM["l_d"],
        (v_q - PM["r"] * i_q - w * (PM["l_d"] * i_d + PM["psi"])) / PM["l_q"],
        (torque - PM["drag"] * speed) / PM["j"],
        speed,
    ]


def test_a_salient_machine_in_the_steady_state_has_the_torque_of_the_textbook() -> None:
    # driven at 50 rad/s on voltages that are (v_d, v_q) = (-12, 30) in the rotor's axes
    w, v_d, v_q = 200.0, -12.0, 30.0
    volts = cosines(math.hypot(v_d, v_q), f"({w}*time + {math.atan2(v_q, v_d)})")
    i_d, i_q = np.linalg.solve(
        [[PM["r"], -w * PM["l_q"]], [w * PM["l_d"], PM["r"]]], [v_d, v_q - w * PM["psi"]]
    )
    torque = 1.5 * 4 * (0.1 * i_q + (2e-3 - 4e-3) * i_d * i_q)
    m = on_three_phases("electrical.pmsm", volts, 50.0)
    for way in every_way(m, *THREE, "w - m.shaft")[::3]:
        run = hb.simulate(way, until="0.2 s", rtol=1e-7)
        found = [run[f"m.{n}"].at(0.2) for n in ("i_d", "i_q", "v_d", "v_q", "torque")]
        assert found == pytest.approx([i_d, i_q, v_d, v_q, torque], rel=1e-5), way.name
        heat = 1.5 * PM["r"] * (i_d**2 + i_q**2)
        assert run["m.heat"].at(0.2) == pytest.approx(heat, rel=1e-5)
        assert run["m.power"].at(0.2) == pytest.approx(heat + 50 * torque, rel=1e-5)
        for lag, phase in zip(LAGS, "abc"):
            now = (complex(i_d, i_q) * cmath.exp(1j * (w * 0.2 - lag))).real
            assert run[f"m.current_{phase}"].at(0.2) == pytest.approx(now, abs=1e-4)


def test_a_salient_machine_runs_up_as_parks_equations_do_and_keeps_energy() -> None:
    def rates(t: float, x: np.ndarray) -> list[float]:
        behind = 60 * t * t - PM["p"] * x[3]
        return park(30 * math.cos(behind), 30 * math.sin(behind), x)

    m = on_three_phases("electrical.pmsm", cosines(30, "60*time^2"), None, speed0=3, angle0=0.2)
    run = hb.simulate(every_way(m, *THREE)[5], until="0.15 s", rtol=1e-9, atol=1e-11)
    at = [0.03, 0.15]
    told = solve_ivp(rates, (0, 0.15), [0, 0, 3, 0.2], rtol=1e-9, atol=1e-11, t_eval=at)
    for k, name in enumerate(("i_d", "i_q", "speed", "angle")):
        assert run[f"m.{name}"].at(at) == pytest.approx(told.y[k], rel=2e-6, abs=1e-6), name
    audit = run.audit()
    assert audit.energy < 1e-7 and audit.power < 1e-12


def test_parks_axes_and_the_field_of_energy_are_one_machine() -> None:
    runs = []
    for part in ("electrical.pmsm", "electrical.pmsm_park"):
        m = on_three_phases(part, cosines(30, "60*time^2"), None, speed0=3, angle0=0.2)
        way = every_way(m, *THREE)[0 if part == "electrical.pmsm" else 7]
        runs.append(hb.simulate(way, until="0.1 s", rtol=1e-8, atol=1e-10))
    for name in ("i_d", "i_q", "flux_d", "flux_q", "v_d", "v_q", "torque", "power", "heat"):
        one, two = (run[f"m.{name}"].at(0.1) for run in runs)
        assert one == pytest.approx(two, rel=1e-5), name
    assert runs[1].audit().energy < 1e-7


def test_a_salient_machine_without_salience_is_the_synchronous_motor() -> None:
    same = {"psi": 0.08, "L_d": 3e-3, "L_q": 3e-3, "angle0": 0.1}
    other = {"psi": 0.08, "L": 3e-3, "angle0": 0.1}
    volts = cosines(20, "80*time")
    m = on_three_phases("electrical.pmsm", volts, None, **same)
    one = hb.simulate(every_way(m, *THREE)[0], until=0.1)
    two = on_three_phases("electrical.synchronous_motor", volts, None, **other)
    run = hb.simulate(every_way(two, *THREE)[0], until=0.1)
    for name in ("i_d", "i_q", "speed", "current_b"):
        assert one[f"m.{name}"].at(0.1) == pytest.approx(run[f"m.{name}"].at(0.1), rel=1e-4), name


IM = {"p": 2, "R_s": 0.435, "R_r": 0.816, "L_ls": 2e-3, "L_lr": 2e-3, "L_m": 69.3e-3, "J": 0.089}


def circuit(slip: float, volts: float, w: float) -> tuple[complex, float]:
    """Return stator current and torque of the equivalent circuit of a phase."""
    core = 1j * w * IM["L_m"]
    cage = math.inf if slip == 0 else IM["R_r"] / slip + 1j * w * IM["L_lr"]
    behind = core if slip == 0 else core * cage / (core + cage)
    stator = volts / (IM["R_s"] + 1j * w * IM["L_ls"] + behind)
    if slip == 0:
        return stator, 0.0
    rotor = stator * core / (core + cage)
    return stator, 1.5 * IM["p"] / w * abs(rotor) ** 2 * IM["R_r"] / slip


@pytest.mark.sampled(1)
@pytest.mark.parametrize("slip", [0.03, 0.6, 0.0, -0.04])
@pytest.mark.slow
def test_an_induction_machine_has_the_current_and_torque_of_its_equivalent_circuit(
    slip: float,
) -> None:
    w = 100 * math.pi
    m = on_three_phases(
        "electrical.induction_machine", cosines(311, "100*pi*time"), w / 2 * (1 - slip)
    )
    current, torque = circuit(slip, 311, w)
    for way in every_way(m, *THREE, "w - m.shaft")[:: 3 if slip == 0.03 else 15]:
        run = hb.simulate(way, until="0.8 s", rtol=1e-6)
        assert run["m.torque"].at(0.8) == pytest.approx(torque, rel=1e-3, abs=2e-3), way.name
        found = [run[f"m.i_{axis}"].at(0.8) for axis in ("alpha", "beta")]
        assert found == pytest.approx([current.real, current.imag], abs=0.01)
    assert run["m.torque"].unit == "N*m"


def test_the_steepest_torque_is_where_kloss_has_it() -> None:
    # without stator resistance: breakdown torque and slip in closed form, from Thevenin's circuit
    w, volts = 100 * math.pi, 311.0
    reach = IM["L_m"] / (IM["L_m"] + IM["L_ls"])
    leak = w * (IM["L_lr"] + IM["L_ls"] * reach)
    top = 1.5 * IM["p"] / w * (reach * volts) ** 2 / (2 * leak)
    steep = IM["R_r"] / leak
    for slip in (steep, 0.3 * steep):
        m = on_three_phases(
            "electrical.induction_machine",
            cosines(volts, "100*pi*time"),
            w / 2 * (1 - slip),
            R_s=1e-9,
        )
        # its flux would keep a constant part for hours: begin with the steady state's
        part = hb.library.part("electrical.induction_machine")
        core, cage = 1j * w * IM["L_m"], IM["R_r"] / slip + 1j * w * IM["L_lr"]
        stator = volts / (1j * w * IM["L_ls"] + core * cage / (core + cage))
        rotor = -stator * core / (core + cage)
        for name, s, r in (("a", stator.real, rotor.real), ("b", stator.imag, rotor.imag)):
            part.elements[f"field_{name}"] = hb.I(part.elements["field_a"].value, f=[s, r])
        m.elements["m"] = hb.Submodel(part, R_s=1e-9)
        run = hb.simulate(every_way(m, *THREE, "w - m.shaft")[6], until="20 ms", rtol=1e-8)
        kloss = 2 * top / (slip / steep + steep / slip)
        assert run["m.torque"].at([0.001, 0.02]) == pytest.approx([kloss, kloss], rel=1e-6)


def test_an_induction_machine_starts_as_the_textbooks_equations_do() -> None:
    inverse = np.linalg.inv(
        [[IM["L_ls"] + IM["L_m"], IM["L_m"]], [IM["L_m"], IM["L_lr"] + IM["L_m"]]]
    )
    w = 100 * math.pi

    def rates(t: float, x: np.ndarray) -> list[float]:
        stator, rotor = complex(x[0], x[1]), complex(x[2], x[3])
        i_s, i_r = inverse @ [stator, rotor]
        ds = 311 * cmath.exp(1j * w * t) - IM["R_s"] * i_s
        dr = -IM["R_r"] * i_r + 1j * IM["p"] * x[4] * rotor
        torque = 1.5 * IM["p"] * (stator.conjugate() * i_s).imag
        return [ds.real, ds.imag, dr.real, dr.imag, torque / IM["J"]]

    m = on_three_phases("electrical.induction_machine", cosines(311, "100*pi*time"), None)
    run = hb.simulate(every_way(m, *THREE)[2], until="0.1 s", rtol=1e-9, atol=1e-10)
    told = solve_ivp(rates, (0, 0.1), [0] * 5, rtol=1e-9, atol=1e-11).y[:, -1]
    i_s, i_r = inverse @ [complex(*told[:2]), complex(*told[2:4])]
    found = {"i_alpha": i_s.real, "i_beta": i_s.imag, "i_r_alpha": i_r.real, "i_r_beta": i_r.imag}
    found |= {"speed": told[4], "flux": math.hypot(told[2], told[3])}
    for name, value in found.items():
        assert run[f"m.{name}"].at(0.1) == pytest.approx(value, rel=1e-6), name
    audit = run.audit()
    assert audit.energy < 1e-7 and audit.power < 1e-12


def test_star_points_that_float_leave_the_currents_alone() -> None:
    # common voltage of the three phases drives nothing
    lifted = [f"7 + {v}" for v in cosines(30, "80*time")]
    for part, name in (("electrical.pmsm", "i_q"), ("electrical.induction_machine", "i_beta")):
        low, high = (
            hb.simulate(every_way(on_three_phases(part, v, None), *THREE)[0], until="20 ms")
            for v in (cosines(30, "80*time"), lifted)
        )
        assert high[f"m.{name}"].at(0.02) == pytest.approx(low[f"m.{name}"].at(0.02), rel=1e-6)
        total = sum(high[f"m.current_{p}"].at(0.02) for p in "abc")
        assert total == pytest.approx(0, abs=1e-12)


def rectified(part: str | hb.Model, **values: float) -> hb.Result:
    """Run a generator at a constant speed on a diode bridge and a resistance."""
    m = hb.Model("generator", domain="electrical")
    m.add(m=hb.Submodel(part, **values), bridge=hb.Submodel("electrical.three_phase_bridge"))
    m.add(top=hb.Zero(), low=hb.Zero(), zero=hb.Se(0), load=hb.R(5), i=hb.One())
    m.add(drive=hb.Sf(100, domain="rotational"), w=hb.One(domain="rotational"))
    m.bond("drive -> w -> m.shaft", "bridge.plus -> top -> i -> low -> bridge.minus")
    m.bond("i -> load", "zero -> low", *(f"m.{p} -> bridge.{p}" for p in "abc"))
    return hb.simulate(m, until="20 ms", rtol=1e-8)


def test_diodes_open_phases_of_a_field_as_those_of_single_coils() -> None:
    # one is coils in phases, the other a field at rest
    one = rectified("electrical.synchronous_motor", L=2e-3)
    two = rectified("electrical.pmsm", L_d=2e-3, L_q=2e-3)
    for name in ("load.f", "m.torque", "m.current_a", "m.i_d"):
        for t in (0.002, 0.0111, 0.02):
            assert two[name].at(t) == pytest.approx(one[name].at(t), rel=1e-5, abs=1e-5), name
    salient = rectified("electrical.pmsm")
    assert salient.audit().energy < 1e-7
    assert len([e for e in salient.events if e.cause == "guard"]) >= 12


def test_a_machine_that_has_flux_feeds_a_bridge() -> None:
    part = hb.library.part("electrical.induction_machine")
    coils = part.elements["field_a"].value
    part.elements["field_a"] = hb.I(coils, f=[0, 10])
    run = rectified(part)
    t = np.linspace(0, 0.02, 2001)
    work, heat = run["load.e*load.f"].at(t), run["m.heat"].at(t)
    shaft = -100 * run["m.torque"].at(t)
    # what the shaft gives and the field loses is in the load and in the windings
    stored = [
        sum(
            0.75 * (2e-3 * run[f"m.i_{x}"].at(t) ** 2 + 2e-3 * run[f"m.i_r_{x}"].at(t) ** 2)
            + 0.75 * 69.3e-3 * (run[f"m.i_{x}"].at(t) + run[f"m.i_r_{x}"].at(t)) ** 2
            for x in ("alpha", "beta")
        )
        for t in (1e-9, 0.02)
    ]
    given = simpson(shaft, dx=1e-5) + stored[0] - stored[1]
    assert simpson(work + heat, dx=1e-5) == pytest.approx(given, rel=1e-4)
