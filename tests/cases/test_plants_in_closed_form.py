"""Plants of hydraulics, heat and vehicles, against closed forms and matrix exponentials."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb


def instants(run: hb.Result) -> list[float]:
    """Return when machines and laws switched, the start left out."""
    return [event.t for event in run.events if event.t > 0]


def test_a_siphon_draws_air_where_its_inlet_is_bare() -> None:
    m = hb.Model("siphon", domain="hydraulic")
    m.add(
        tank=hb.C("0.2 [m^2]/(9810 [Pa/m])", q="0.2 m^3"),
        n=hb.Zero(),
        pipe=hb.One(),
        leg=hb.Se("4905 Pa"),  # half a metre of water below the tank
        out=hb.R({"f": "3e-4 [m^2]*sqrt(2*abs(e)/(1000 [kg/m^3]))*sign(e)"}),
    )
    m.bond("n -> tank", "n -> pipe -> out", "leg -> pipe")
    m.signal(level="tank.q/(0.2 [m^2])")
    m.machine(
        "S",
        states={"runs": ["pipe"], "air": []},
        start="runs",
        rules=["runs -> air when level < 0.1 [m]"],
    )
    run = hb.simulate(m, until="1000 s")
    # Torricelli: sqrt(level + drop) falls evenly
    end = 0.2 / 3e-4 * (2 / 9.81) ** 0.5 * (1.5**0.5 - 0.6**0.5)
    assert instants(run) == [pytest.approx(end, rel=1e-7)]
    assert run["level"].at(1000) == pytest.approx(0.1, rel=1e-9)


def test_oil_that_cavitates_stays_at_its_vapour_pressure_until_the_piston_turns() -> None:
    m = hb.Model("cavity", domain="hydraulic")
    m.add(
        vapour=hb.Se("2 kPa"),
        gap=hb.One(law="diode"),
        n=hb.Zero(),
        oil=hb.C("2e-12 m^3/Pa", e="1 bar"),
    )
    m.add(pull=hb.Sf("-1 [L/s]*sin(10*time/(1 [s]))"))
    m.bond("vapour -> gap -> n -> oil", "pull -> n")
    run = hb.simulate(m, until="0.6 s")
    first = np.arccos(1 - 98e3 * 2e-12 / 1e-4) / 10
    assert instants(run) == pytest.approx([first, np.pi / 10], rel=1e-9)
    assert run["n.e"].at(0.2) == pytest.approx(2e3, rel=1e-9)
    assert run["n.e"].at(0.6) == pytest.approx(2e3 + 1e-4 * (np.cos(6) + 1) / 2e-12, rel=1e-8)


def test_a_hammer_goes_through_eight_pieces_of_a_line() -> None:
    n = 8
    m = hb.Model("hammer", domain="hydraulic")
    m.add(source=hb.Se("5 bar"), valve=hb.One(), load=hb.R("3e8 Pa*s/m^3"))
    before = "source"
    for i in range(n):
        parts = {f"l{i}": hb.One(), f"L{i}": hb.I("1e6 kg/m^4"), f"R{i}": hb.R("2e6 Pa*s/m^3")}
        m.add(**parts, **{f"n{i}": hb.Zero(), f"C{i}": hb.C("1e-11 m^3/Pa", e="5 bar")})
        m.bond(f"{before} -> l{i} -> n{i} -> C{i}", f"l{i} -> L{i}", f"l{i} -> R{i}")
        before = f"n{i}"
    m.bond(f"{before} -> valve -> load")
    m.machine(
        "V",
        states={"open": ["valve"], "shut": []},
        start="open",
        rules=["open -> shut when time >= 50 ms"],
    )
    run = hb.simulate(m, until="0.2 s")
    # flows, pressures, and the one that the source is a multiple of
    a = np.zeros((2 * n + 1, 2 * n + 1))
    for i in range(n):
        a[i, i], a[i, n + i], a[n + i, i] = -2.0, -1e-6, 1e11
        a[i, n + i - 1 if i else 2 * n] = 1e-6 if i else 0.5
        if i < n - 1:
            a[n + i, i + 1] = -1e11
    opened = a.copy()
    opened[2 * n - 1, 2 * n - 1] -= 1e11 / 3e8
    y = expm(a * 0.15) @ expm(opened * 0.05) @ np.r_[np.zeros(n), np.full(n, 5e5), 1.0]
    assert [run[f"C{i}.e"].at(0.2) for i in range(n)] == pytest.approx(list(y[n : 2 * n]), rel=1e-8)


def test_what_melts_takes_its_latent_heat_at_one_temperature() -> None:
    m = hb.Model("ice", domain="thermal_pseudo")
    law = "273.15 [K] + min(q, 0)/(2 [kJ/K]) + max(q - 300 [kJ], 0)/(4 [kJ/K])"
    m.add(heat=hb.Sf("1 kW"), n=hb.Zero(), ice=hb.C({"e": law}, q="-20 kJ"))
    m.add(g=hb.One(), wall=hb.G("2 W/K"), air=hb.Se("300 K"))
    m.bond("heat -> n -> ice", "n -> g -> wall", "g -> air")
    run = hb.simulate(m, until="1000 s")
    rest = 300 + 1000 / 2
    begins = 2000 / 2 * np.log((rest - 263.15) / (rest - 273.15))
    ends = begins + 3e5 / (1000 - 2 * (273.15 - 300))
    assert run["n.e"].at((begins + ends) / 2) == pytest.approx(273.15, rel=1e-12)
    warm = rest + (273.15 - rest) * np.exp(-2 * (1000 - ends) / 4000)
    assert run["n.e"].at(1000) == pytest.approx(warm, rel=1e-8)


def test_a_car_that_brakes_against_the_wind_stops_and_stays() -> None:
    m = hb.Model("car", domain="translational")
    m.add(M=hb.I("1 t", f="30 m/s"), drag=hb.R({"e": "0.4 [N*s^2/m^2]*f*abs(f)"}))
    m.add(v=hb.One(law="coulomb", limit="if time > 2 [s] then 6 [kN] else 150 [N]"))
    m.bond("v -> M", "v -> drag")
    m.signal(way=hb.Integral("v.f"))
    run = hb.simulate(m, until="10 s")
    rolls, brakes = (150 / 0.4) ** 0.5, (6000 / 0.4) ** 0.5  # tan(atan(v/w) - sqrt(F c) t/M) w
    v = rolls * np.tan(np.arctan(30 / rolls) - 2 * (150 * 0.4) ** 0.5 / 1000)
    stops = 2 + np.arctan(v / brakes) * 1000 / (6000 * 0.4) ** 0.5
    assert instants(run) == [pytest.approx(stops, rel=1e-8)]
    way = 1000 / 0.8 * (np.log((900 + rolls**2) / (v**2 + rolls**2)) + np.log(v**2 / brakes**2 + 1))
    assert run["way"].at(10) == pytest.approx(way, rel=1e-6)
    assert run["v.f"].at(10) == 0.0
