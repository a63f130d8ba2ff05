"""Devices with smooth laws and protecting ones, against Lambert's function and closed forms."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import lambertw

import hybond as hb

V_T = 1.380649e-23 * 300 / 1.602176634e-19


def in_series(volts: str, part: hb.Submodel, *, ohms: float) -> hb.Model:
    m = hb.Model("bench", domain="electrical")
    m.add(V=hb.Se(volts), hot=hb.Zero(), out=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), p=part)
    m.add(load=hb.Submodel("electrical.resistor", R=ohms))
    m.bond("V -> hot", "out -> load.plus", "load.minus -> cold", "zero -> cold")
    return m


def both_ends(m: hb.Model) -> list[hb.Model]:
    return every_way(m, "hot - p.plus", "p.minus - out")


def shockley(volts: float, ohms: float, i_s: float, v_n: float) -> float:
    """Current of a diode and a resistance in series (Banwell and Jayakumar 2000)."""
    x = i_s * ohms / v_n * math.exp((volts + i_s * ohms) / v_n)
    return v_n / ohms * lambertw(x).real - i_s


@pytest.mark.parametrize(("i_s", "n", "bulk"), [(1e-14, 1.0, 0.0), (2.5e-9, 1.75, 20.0)])
def test_an_exponential_diode_follows_lamberts_function(i_s: float, n: float, bulk: float) -> None:
    part = hb.Submodel("electrical.diode_exponential", I_s=i_s, n=n, R_s=bulk)
    for way in both_ends(in_series("5 [V]*sin(100*pi*time)", part, ohms=100)):
        run = hb.simulate(way, until="20 ms")
        for t in (0.001, 0.005, 0.0099, 0.012, 0.015):
            volts = 5 * math.sin(100 * math.pi * t)
            amperes = shockley(volts, 100 + bulk, i_s, n * V_T)
            assert run["p.current"].at(t) == pytest.approx(amperes, rel=1e-7, abs=1e-15), way.name
            assert run["p.voltage"].at(t) == pytest.approx(volts - 100 * amperes, abs=1e-9)
            assert run["p.junction"].at(t) == pytest.approx(volts - (100 + bulk) * amperes)


def test_a_surge_of_300_kv_through_an_exponential_diode_is_a_number() -> None:
    """Above I_max the law is a straight line through (V_max, I_max)."""
    part = hb.Submodel("electrical.diode_exponential", I_max="10 A")
    way = both_ends(in_series("300 [kV]*sin(100*pi*time)", part, ohms=100))[0]
    run = hb.simulate(way, until="20 ms")
    top = V_T * math.log(10 / 1e-14 + 1)
    slope = (10 + 1e-14) / V_T
    expected = (3e5 - top + 10 / slope) / (100 + 1 / slope)
    assert run["p.current"].at(0.005) == pytest.approx(expected, rel=1e-9)
    assert run["p.current"].at(0.015) == pytest.approx(-1e-14, rel=1e-6)


def test_a_peak_rectifier_with_an_exponential_diode_is_what_scipy_integrates() -> None:
    part = hb.Submodel("electrical.diode_exponential", R_s=10)
    m = in_series("5 [V]*sin(100*pi*time)", part, ohms=1000)
    m.add(c=hb.Submodel("electrical.capacitor", C="10 uF"))
    m.bond("out -> c.plus", "c.minus -> cold")

    def rate(t: float, v: np.ndarray) -> list[float]:
        over = 5 * math.sin(100 * math.pi * t) - v[0]
        return [(shockley(over, 10, 1e-14, V_T) - v[0] / 1000) / 1e-5]

    made = solve_ivp(rate, (0, 0.03), [0.0], method="Radau", rtol=1e-9, atol=1e-11, max_step=1e-3)
    for way in both_ends(m)[::3]:
        run = hb.simulate(way, until="30 ms", solver="radau", rtol=1e-9, atol=1e-14)
        assert run["c.voltage"].at(0.03) == pytest.approx(made.y[0, -1], rel=1e-6), way.name


@pytest.mark.parametrize("bulk", [0.0, 8.0])
def test_an_exponential_zener_diode_holds_its_voltage_at_its_current(bulk: float) -> None:
    part = hb.Submodel("electrical.zener_exponential", breakdown=6, I_z=0.02, R_s=bulk)
    # 20 mA flow backward where the source has 6 V and what the resistances take
    for way in both_ends(in_series(f"-{6 + 0.02 * (50 + bulk)} [V]", part, ohms=50)):
        run = hb.simulate(way, until=1)
        assert run["p.current"].at(0.5) == pytest.approx(-0.02, rel=1e-9), way.name
        assert run["p.voltage"].at(0.5) == pytest.approx(-6 - 0.02 * bulk, rel=1e-9)
    for volts in (3.0, -4.0, -20.0):
        run = hb.simulate(both_ends(in_series(f"{volts} [V]", part, ohms=50))[0], until=1)

        def surplus(e: float, volts: float = volts) -> float:
            i = 1e-14 * math.expm1(e / V_T) - 0.02 * math.exp((-e - 6) / (4 * V_T))
            return volts - e - (50 + bulk) * i

        e = brentq(surplus, -10, 1.5, xtol=1e-13)
        assert run["p.junction"].at(0.5) == pytest.approx(e, rel=1e-9)


def test_a_photodiode_biased_backward_counts_light_and_open_shows_its_logarithm() -> None:
    part = hb.Submodel("electrical.photodiode", R_s=5, inputs={"light": "2e-3 [W/s]*time"})
    for way in both_ends(in_series("-5 V", part, ohms=100)):
        run = hb.simulate(way, until=1)
        assert run["p.current"].at([0.25, 0.75]) == pytest.approx([-2.5e-4, -7.5e-4], rel=1e-5)
    m = hb.Model("open", domain="electrical")
    m.add(p=part, zero=hb.Submodel("electrical.ground"), v=hb.Submodel("electrical.voltage_sensor"))
    m.bond("p.minus -> v.minus", "p.plus -> v.plus", "zero.pin -> v.minus")
    run = hb.simulate(m, until=1)
    expected = 1.2 * V_T * math.log(0.5e-3 / 1e-9 + 1)
    assert run["v.voltage"].at(0.5) == pytest.approx(expected, rel=1e-9)


def test_a_varistor_holds_a_surge_and_hardly_leaks_at_the_voltage_of_the_line() -> None:
    part = hb.Submodel("electrical.varistor", V_1=400, I_1=1, alpha=30)
    for volts in (300.0, 1000.0, -1000.0):
        for way in both_ends(in_series(f"{volts} [V]", part, ohms=2))[:: 1 if volts > 300 else 3]:
            run = hb.simulate(way, until="1 ms")
            size = abs(volts)
            e = brentq(lambda e, size=size: size - e - 2 * (e / 400) ** 30, 0, size, xtol=1e-12)
            assert run["p.voltage"].at(5e-4) == pytest.approx(math.copysign(e, volts)), way.name
            heat = e * (size - e) / 2 * 1e-3
            assert run["p.absorbed"].at(1e-3) == pytest.approx(heat, rel=1e-7)


def test_a_varistor_saves_a_switch_that_opens_a_coil() -> None:
    """The energy of the coil is absorbed, and the voltage is held."""
    m = hb.Model("coil", domain="electrical", parameters={"T": "1 ms"})
    m.add(s=hb.Submodel("electrical.switch", inputs={"gate": "time < T"}), hot=hb.Zero())
    m.add(p=hb.Submodel("electrical.varistor", V_1="50 V", alpha=20, G_off="10 uS"))
    m.add(coil=hb.Submodel("electrical.inductor", L="1 mH", i0=10), g=hb.Zero())
    m.add(zero=hb.Submodel("electrical.ground"))
    m.bond("coil.plus -> g", "hot -> coil.minus", "hot -> s.plus", "s.minus -> g", "zero.pin -> g")
    for way in every_way(m, "hot - p.plus", "p.minus - g"):
        run = hb.simulate(way, until="3 ms", solver="radau", rtol=1e-9, atol=1e-12)
        assert run["p.absorbed"].at(3e-3) == pytest.approx(0.5 * 1e-3 * 100, rel=1e-7), way.name
        assert run["p.voltage"].at(1.0001e-3) == pytest.approx(50 * 10 ** (1 / 20), rel=1e-3)


def test_a_crowbar_trips_at_its_voltage_and_blows_the_fuse() -> None:
    m = in_series("2 [V/ms]*time", hb.Submodel("electrical.fuse", R=0.5, I2t=0.4), ohms=100)
    m.add(q=hb.Submodel("electrical.crowbar", V_trip=15, drop=1, R_on=0.1))
    m.bond("hot -> p.plus", "p.minus -> out")
    for way in every_way(m, "out - q.plus", "q.minus - cold"):
        run = hb.simulate(way, until="12 ms")
        trips = 15 * (100.5 / 100) / 2000
        assert [e.t for e in run.events][1] == pytest.approx(trips, rel=1e-9), way.name
        # beyond it R_on and the fuse take what is above the drop, the load beside is small
        volts = 2000 * (trips + 1e-5)
        e = (volts / 0.5 + 1 / 0.1) / (1 / 0.5 + 1 / 0.1 + 1 / 100)
        assert run["q.voltage"].at(trips + 1e-5) == pytest.approx(e, rel=1e-9)
        assert run["q.tripped"].at([trips / 2, trips + 1e-5, 0.0119]).tolist() == [0, 1, 0]
        assert run["p.blown"].at(0.0119) == 1


def test_a_current_limiter_holds_both_ways_and_is_a_resistance_below() -> None:
    part = hb.Submodel("electrical.current_limiter", I_max=0.05, R_on=20)
    for way in both_ends(in_series("10 [V]*sin(100*pi*time)", part, ohms=100)):
        run = hb.simulate(way, until="20 ms")
        for t in (0.001, 0.005, 0.0101, 0.015):
            volts = 10 * math.sin(100 * math.pi * t)
            amperes = max(-0.05, min(0.05, volts / 120))
            assert run["p.current"].at(t) == pytest.approx(amperes, rel=1e-9), way.name
            assert run["p.voltage"].at(t) == pytest.approx(volts - 100 * amperes, rel=1e-9)
        assert run["p.limiting"].at([0.0005, 0.005, 0.0101, 0.015]).tolist() == [0, 1, 0, 1]
