"""Batteries, supercapacitors, solar modules, fuel cells against closed forms and SciPy."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

JOINTS = ("s.plus - top", "bottom - s.minus")


def at_load(part: hb.Submodel, load: object) -> hb.Model:
    """A part with something between its ends, which is the bond that counts into the load."""
    m = hb.Model("bench", domain="electrical")
    m.add(s=part, load=load, i=hb.One(), top=hb.Zero(), bottom=hb.Zero(), zero=hb.Se(0))
    m.bond("top -> i -> bottom", "i -> load", "zero -> bottom")
    return m


CURVE = [3.0, 3.45, 3.54, 3.60, 3.64, 3.69, 3.77, 3.87, 3.96, 4.06, 4.18]


@pytest.mark.parametrize("slow", [0.02, 0.0])
def test_a_cell_relaxes_by_two_exponentials(slow: float) -> None:
    # 2 A for 100 s, then nothing
    part = hb.Submodel("electrical.battery_cell", soc0=0.55, R_2=slow, C_2=5000)
    m = at_load(part, hb.Sf("2*pulse"))
    m.input(pulse=hb.Input(table=[[0, 1], [100, 0]]))
    pairs = [(0.015, 2000.0), *([(slow, 5000.0)] if slow else [])]
    for way in every_way(m, *JOINTS):
        run = hb.simulate(way, until=400, rtol=1e-9)
        for t in (20.0, 99.9, 130.0, 400.0):
            soc = 0.55 - 2 * min(t, 100) / 9000
            volts = np.interp(soc, np.linspace(0, 1, 11), CURVE) - (0.06 if t < 100 else 0)
            for r, c in pairs:
                built = 2 * r * (1 - math.exp(-min(t, 100) / (r * c)))
                volts -= built * math.exp(-max(t - 100, 0) / (r * c))
            assert run["s.voltage"].at(t) == pytest.approx(volts, rel=1e-7), (way.name, t)
            assert run["s.soc"].at(t) == pytest.approx(soc, rel=1e-9)
        assert run["s.current"].at(50) == pytest.approx(-2)
        assert run.audit().energy < 1e-8


def test_a_cell_says_when_it_is_empty_and_full() -> None:
    m = at_load(hb.Submodel("electrical.battery_cell", soc0=0.1), hb.Sf("amperes"))
    m.input(amperes=hb.Input(table=[[0, 5], [400, -10]]))
    run = hb.simulate(every_way(m, *JOINTS)[0], until=1500)
    # 900 C are there and 2000 C are drawn; from -1100 C 10 A take 110 s to zero, 900 s more to full
    told = {e.t: e for e in run.events}
    times = [t for t in told if t not in (0, 400)]
    assert times == pytest.approx([180, 510, 1410], rel=1e-9)
    assert run["s.empty"].at([100, 200, 500, 520]).tolist() == [0, 1, 1, 0]
    assert run["s.full"].at([1400, 1420]).tolist() == [0, 1]
    low = 3.0 + (3.45 - 3.0) * -1100 / 900
    assert run["s.no_load"].at(400) == pytest.approx(low, rel=1e-9)


def test_a_supercapacitor_takes_up_charge_by_its_own_voltage() -> None:
    # no slow branch to speak of: charge C*v + k*v^2/2 of a constant current
    part = hb.Submodel("electrical.supercapacitor", v0=0.5, R_slow=1e12, R_leak=1e12)
    m = at_load(part, hb.Sf(-20))
    before = 270 * 0.5 + 190 * 0.5**2 / 2
    for way in every_way(m, *JOINTS):
        run = hb.simulate(way, until=30, rtol=1e-9)
        v = (-270 + math.sqrt(270**2 + 2 * 190 * (before + 600))) / 190
        assert run["s.inside"].at(30) == pytest.approx(v, rel=1e-8), way.name
        assert run["s.voltage"].at(30) == pytest.approx(v + 20 * 2.5e-3, rel=1e-8)
        stored = 270 * v**2 / 2 + 190 * v**3 / 3 + 100 * 0.5**2 / 2
        assert run["s.energy"].at(30) == pytest.approx(stored, rel=1e-7)
    assert run.audit().energy < 1e-9


def test_a_supercapacitor_sags_into_its_slow_branch() -> None:
    def rates(_: float, x: np.ndarray) -> list[float]:
        node = (x[0] / 2.5e-3 + x[1] / 0.9) / (1 / 2.5e-3 + 1 / 0.9 + 1 / 9e3)
        return [
            (node - x[0]) / 2.5e-3 / (270 + 190 * x[0]),
            (node - x[1]) / 0.9 / 100,
        ]

    part = hb.library.part("electrical.supercapacitor")
    part.elements["depth"] = hb.C("C_slow", e=0)
    run = hb.simulate(
        every_way(at_load(hb.Submodel(part, v0=2.0), hb.Sf(0)), *JOINTS)[1],
        until=600,
        rtol=1e-8,
        solver="radau",
    )
    told = solve_ivp(rates, (0, 600), [2, 0], method="Radau", rtol=1e-9, atol=1e-11)
    found = [run[f"s.{n}"].at(600) for n in ("inside", "voltage")]
    node = (told.y[0, -1] / 2.5e-3 + told.y[1, -1] / 0.9) / (1 / 2.5e-3 + 1 / 0.9 + 1 / 9e3)
    assert found == pytest.approx([told.y[0, -1], node], rel=1e-7)


SHEET = {"V_oc": 37.8, "I_sc": 8.89, "V_mp": 30.4, "I_mp": 8.24}


def model_of(sheet: dict[str, float]) -> tuple[float, float, float]:
    v_oc, i_sc, v_mp, i_mp = sheet.values()
    a = (2 * v_mp - v_oc) / (i_mp / (i_sc - i_mp) + math.log(1 - i_mp / i_sc))
    return a, v_mp / i_mp - a / (i_sc - i_mp), i_sc / math.expm1(v_oc / a)


@pytest.mark.parametrize(
    "values", [{}, {"irradiance": 300.0, "temperature": 330.0, "alpha": 4e-3, "G_p": 0.01}]
)
def test_a_solar_module_lies_on_its_implicit_curve(values: dict[str, float]) -> None:
    inputs = {k: values[k] for k in ("irradiance", "temperature") if k in values}
    given = {k: values[k] for k in ("alpha", "G_p") if k in values}
    a, r_s, i_0 = model_of(SHEET)
    sun, warm = inputs.get("irradiance", 1000), inputs.get("temperature", 298.15)
    photo = sun / 1000 * (8.89 + given.get("alpha", 0) * (warm - 298.15))
    a *= warm / 298.15
    i_0 *= (warm / 298.15) ** 3 * math.exp(1.12 / 8.617333262e-5 * (1 / 298.15 - 1 / warm))

    def rest(i: float, v: float) -> float:
        e = v + i * r_s
        return photo - i_0 * math.expm1(e / a) - e * given.get("G_p", 0) - i

    m = at_load(hb.Submodel("electrical.solar_module", inputs=inputs, **given), hb.Se("volts"))
    m.input(volts=hb.Input(table=[[0, -1], [1, 39]], linear=True))
    for way in every_way(m, *JOINTS):
        run = hb.simulate(way, until=1)
        for volts in (-0.5, 15, 25, 30.4, 34, 38.5):
            amperes = brentq(rest, -60, 20, args=(volts,), xtol=1e-13)
            t = (volts + 1) / 40
            assert run["s.current"].at(t) == pytest.approx(-amperes, rel=1e-6, abs=1e-7), way.name
            assert run["s.delivered"].at(t) == pytest.approx(volts * amperes, rel=1e-6, abs=1e-5)


def test_a_solar_module_keeps_what_its_data_sheet_says() -> None:
    m = at_load(hb.Submodel("electrical.solar_module"), hb.Se("volts"))
    m.input(volts=hb.Input(table=[[0, 0], [1, 37.8]], linear=True))
    run = hb.simulate(every_way(m, *JOINTS)[0], until=1)
    t = np.array([0, 30.4 / 37.8, 1])
    assert run["s.current"].at(t) == pytest.approx([-8.89, -8.24, 0], abs=1e-6)
    # no power is larger than that of the data: its slope there is zero
    near = np.array([30.2, 30.4, 30.6]) / 37.8
    power = run["s.delivered"].at(near)
    assert power[1] == pytest.approx(30.4 * 8.24, rel=1e-6)
    assert abs(power[2] - power[0]) / 0.4 < 0.01 * 8.24
    assert power[1] > max(power[0], power[2])


@pytest.mark.parametrize(
    ("data", "where"), [({"V_mp": 18.0}, "a"), ({"I_mp": 9.0}, "a"), ({"V_mp": 34.5}, "R_s")]
)
def test_data_that_no_diode_has_is_refused(data: dict[str, float], where: str) -> None:
    m = at_load(hb.Submodel("electrical.solar_module", **data), hb.R(3))
    with pytest.raises(hb.ModelError, match="has no finite value") as caught:
        every_way(m, *JOINTS)[0].flatten()
    assert (caught.value.code, caught.value.where) == ("HB-M110", f"s.{where}")


def test_a_solar_module_on_a_resistance_and_on_a_capacitor() -> None:
    a, r_s, i_0 = model_of(SHEET)

    def rest(i: float) -> float:
        return 8.89 - i_0 * math.expm1(i * (3 + r_s) / a) - i

    m = at_load(hb.Submodel("electrical.solar_module"), hb.R(3))
    run = hb.simulate(every_way(m, *JOINTS)[2], until=1)
    assert run["s.current"].at(0.5) == pytest.approx(-brentq(rest, 0, 9), rel=1e-7)
    run = hb.simulate(every_way(at_load(m.elements["s"], hb.C("1 mF")), *JOINTS)[2], until=1)
    assert run["s.voltage"].at(1) == pytest.approx(37.8, rel=1e-6)


def test_a_fuel_cell_has_its_three_losses_and_shows_the_resistance_at_once() -> None:
    m = at_load(hb.Submodel("electrical.fuel_cell"), hb.Sf("amperes"))
    m.input(amperes=hb.Input(table=[[0, 10], [1, 60]]))

    def volts(i: float) -> float:
        losses = 0.03 * math.log(1 + i / 0.02) + 3e-3 * i - 0.05 * math.log(1 - i / 90)
        return 40 * (1.03 - losses)

    for way in every_way(m, *JOINTS):
        run = hb.simulate(way, until=2, rtol=1e-9)
        assert run["s.voltage"].at([0.99, 2]) == pytest.approx([volts(10), volts(60)], rel=1e-7)
        at_once = 40 * (3e-3 * 50 - 0.05 * (math.log(1 - 60 / 90) - math.log(1 - 10 / 90)))
        jump = run["s.voltage"].at(1 - 1e-9) - run["s.voltage"].at(1 + 1e-9)
        assert jump == pytest.approx(at_once, rel=1e-5), way.name
        power = 40 * 1.03 * 60
        assert run["s.delivered + s.losses"].at(2) == pytest.approx(power, rel=1e-7)
        assert run["s.hydrogen"].at(2) == pytest.approx(40 * 60 / (2 * 96485.33212), rel=1e-9)
    assert run["s.hydrogen"].unit == "mol/s"
