"""Thermal parts against closed forms, with the bonds at their ports drawn in both directions."""

import math

import numpy as np
import pytest
from library.bench import every_way

import hybond as hb

SIGMA = 5.670374419e-8


def part(name: str, inputs: dict[str, object] | None = None, **parameters: object) -> hb.Submodel:
    return hb.Submodel(f"thermal.{name}", inputs=inputs, **parameters)


def joined(*joints: str, **parts: object) -> list[hb.Model]:
    """Parts, joined in every way."""
    m = hb.Model("room")
    m.add(**parts)
    return every_way(m, *joints)


@pytest.mark.parametrize(("C", "G", "P"), [(1e3, 2.0, 100.0), (5e4, 10.0, 0.0)])
def test_a_body_is_heated_against_its_surroundings(C, G, P):
    """``"thermal.heat_capacity"``, ``"thermal.conductor"``, ``"thermal.ambient"`` and
    ``"thermal.heater"``.
    """
    t = np.linspace(0, 3 * C / G, 7)
    for m in joined(
        "body.port - wall.hot",
        "wall.cold - air.port",
        "heater.port - body.port",
        body=part("heat_capacity", C=C, T_0=350),
        wall=part("conductor", G=G),
        air=part("ambient", T=280),
        heater=part("heater", P=P),
    ):
        run = hb.simulate(m, until=3 * C / G, rtol=1e-9)
        end = 280 + P / G
        expected = end + (350 - end) * np.exp(-G / C * t)
        assert run["body.temperature"].at(t) == pytest.approx(expected, rel=1e-8)
        assert run["wall.heat"].at(t) == pytest.approx(G * (expected - 280), rel=1e-6)
        assert run["air.heat"].at(t) == pytest.approx(-G * (expected - 280), rel=1e-6)
        assert run["heater.heat"].at(1.0) == P
        units = [run[n].unit for n in ("body.temperature", "wall.heat", "wall.difference")]
        assert units == ["K", "W", "K"]


def test_inputs_replace_what_surroundings_and_heaters_are_by_themselves():
    for m in joined(
        "body.port - wall.hot",
        "wall.cold - air.port",
        "heater.port - body.port",
        body=part("heat_capacity"),
        wall=part("conductor", G="1 kW/K"),
        air=part("ambient", {"temperature": "300 [K] + 1 [K/s]*time"}),
        heater=part("heater", {"power": "wall.difference*(3 [W/K]) + 5 [W]"}),
    )[:2]:
        run = hb.simulate(m, until=20.0)
        # it follows the ramp behind by the heat of its warming, less that of the heater
        assert run["wall.difference"].at(20) == pytest.approx((5 - 1000) / (1000 - 3), rel=1e-6)


def test_two_bodies_share_their_heat():
    for m in joined(
        "one.port - wall.hot",
        "wall.cold - two.port",
        one=part("heat_capacity", C=2e3, T_0=400),
        wall=part("conductor", G=5),
        two=part("heat_capacity", C=3e3, T_0=300),
    ):
        run = hb.simulate(m, until=600.0, rtol=1e-9)
        t = np.linspace(0, 600, 5)
        one, two = run["one.temperature"].at(t), run["two.temperature"].at(t)
        assert one - two == pytest.approx(100 * np.exp(-5 * (1 / 2e3 + 1 / 3e3) * t), rel=1e-6)
        assert 2e3 * one + 3e3 * two == pytest.approx(np.full(5, 2e3 * 400 + 3e3 * 300), rel=1e-12)


def test_a_body_radiates_into_empty_space():
    """``"thermal.radiation"``: the inverse cube of the temperature grows in proportion to time."""
    for m in joined(
        "body.port - rays.hot",
        "rays.cold - space.port",
        body=part("heat_capacity", C=1e3, T_0=900),
        rays=part("radiation", area="0.2 m^2", emissivity=0.8),
        space=part("ambient", T=0),
    ):
        run = hb.simulate(m, until=3000.0, rtol=1e-9)
        t = np.linspace(0, 3000, 6)
        k = SIGMA * 0.8 * 0.2 / 1e3
        expected = (900.0**-3 + 3 * k * t) ** (-1 / 3)
        assert run["body.temperature"].at(t) == pytest.approx(expected, rel=1e-7)
        assert run["rays.heat"].at(t) == pytest.approx(k * 1e3 * expected**4, rel=1e-6)


def test_radiation_between_two_bodies_keeps_their_heat():
    for m in joined(
        "one.port - rays.hot",
        "rays.cold - two.port",
        one=part("heat_capacity", T_0=300),
        rays=part("radiation"),
        two=part("heat_capacity", T_0=800, C="2 kJ/K"),
    ):
        run = hb.simulate(m, until=100.0, rtol=1e-9)
        t = np.linspace(0, 100, 5)
        one, two = run["one.temperature"].at(t), run["two.temperature"].at(t)
        assert one + 2 * two == pytest.approx(np.full(5, 1900.0), rel=1e-12)
        slope = (run["one.heat"].at(50), SIGMA * (two[2] ** 4 - one[2] ** 4))
        assert slope[0] == pytest.approx(slope[1], rel=1e-9)
        assert run["rays.difference"].at(50) == pytest.approx(one[2] - two[2])


def test_a_thermostat_keeps_a_room_between_its_two_points():
    """``"thermal.thermostat"``: the times of a cycle follow from two exponentials."""
    C, G, P, air, low, high = 1e5, 50.0, 2e3, 270.0, 292.15, 294.15
    for m in joined(
        "heater.port - room.port",
        "room.port - wall.hot",
        "wall.cold - air.port",
        heater=part("thermostat", P=P, low=low, high=high),
        room=part("heat_capacity", C=C, T_0=293.15),
        wall=part("conductor", G=G),
        air=part("ambient", T=air),
    ):
        run = hb.simulate(m, until=1800.0, rtol=1e-9)
        tau, top = C / G, air + P / G
        falls = tau * math.log((high - air) / (low - air))
        rises = tau * math.log((top - low) / (top - high))
        first = tau * math.log((293.15 - air) / (low - air))
        expected = np.cumsum([first, *[rises, falls] * 10])
        found = [e.t for e in run.events if e.t > 0]
        assert found == pytest.approx(expected[: len(found)], rel=1e-8)
        assert len(found) == (expected < 1800).sum() > 4
        assert (run["heater.on"].at(first - 1), run["heater.on"].at(first + 1)) == (0, 1)
        assert run["heater.heat"].at(first + 1) == P


def test_ice_melts_and_freezes_again():
    """``"thermal.phase_change"``: three straight lines, there and back."""
    heat = "if time < 1000 [s] then 500 [W] else -500 [W]"
    for m in joined(
        "heater.port - ice.port",
        heater=part("heater", {"power": heat}),
        ice=part("phase_change"),
    ):
        run = hb.simulate(m, until=2100.0, rtol=1e-9)
        melts, liquid = 2.1e3 * 10 / 500, (2.1e3 * 10 + 334e3) / 500
        corners = [melts, liquid, 2000 - liquid, 2000 - melts]
        assert [e.t for e in run.events if e.cause == "guard"] == pytest.approx(corners)
        for t in (20.0, 300.0, 900.0):
            stored = 500 * t - 2.1e3 * 10
            expected = 273.15 + min(stored, 0) / 2.1e3 + max(stored - 334e3, 0) / 4.2e3
            assert run["ice.temperature"].at(t) == pytest.approx(expected)
            assert run["ice.temperature"].at(2000 - t) == pytest.approx(expected)
            assert run["ice.molten"].at(t) == pytest.approx(min(max(stored / 334e3, 0), 1))
        names = run.graph.mode_names(run.events[-1].steps[-1].mode)
        assert names["ice.phase"] == "solid"


def test_water_that_is_cooled_freezes():
    """It starts above its melting point: 20 K of 4.2 kJ/K, and the heat of melting."""
    for m in joined(
        "heater.port - water.port",
        heater=part("heater", P="-500 W"),
        water=part("phase_change", T_0="293.15 K"),
    ):
        run = hb.simulate(m, until=1000.0, rtol=1e-9)
        freezes, frozen = 4.2e3 * 20 / 500, (4.2e3 * 20 + 334e3) / 500
        corners = [e.t for e in run.events if e.cause == "guard"]
        assert corners == pytest.approx([freezes, frozen])
        expected = [293.15, 293.15 - 10, 273.15, 273.15 - (1000 - frozen) * 500 / 2.1e3]
        assert run["water.temperature"].at([0, freezes / 2, 500, 1000]) == pytest.approx(expected)


def test_a_kettle_boils_while_it_is_heated():
    """``"thermal.boiler"``: what heat is left over becomes vapour, and the temperature stays."""
    for m in joined(
        "heater.port - kettle.port",
        "kettle.port - wall.hot",
        "wall.cold - air.port",
        heater=part("heater", {"power": "if time < 400 [s] then 2 [kW] else 0 [kW]"}),
        kettle=part("boiler"),
        wall=part("conductor", G=2),
        air=part("ambient", T=293.15),
    ):
        run = hb.simulate(m, until=500.0, rtol=1e-9)
        tau, rise = 4.2e3 / 2, 2e3 / 2
        boils = -tau * math.log(1 - 80 / rise)
        guards = [e.t for e in run.events if e.cause == "guard"]
        assert guards == pytest.approx([boils], rel=1e-8)
        assert run["kettle.temperature"].at(300) == pytest.approx(373.15, abs=1e-9)
        steam = (2e3 - 2 * 80) / 2.26e6
        assert run["kettle.evaporation"].at(300) == pytest.approx(steam)
        assert run["kettle.vapour"].at(500) == pytest.approx(steam * (400 - boils))
        assert run["kettle.vapour"].unit == "kg"
        after = 293.15 + 80 * math.exp(-100 / tau)
        assert run["kettle.temperature"].at(500) == pytest.approx(after, rel=1e-8)


def test_true_bonds_make_entropy_and_keep_the_heat():
    """``"thermal.entropy_capacity"``, ``"thermal.entropy_conductor"``: temperatures are those of
    pseudo bonds, the entropy that is made is that of textbooks.
    """
    C1, C2, G = 2e3, 3e3, 5.0
    for m in joined(
        "one.port - wall.hot",
        "wall.cold - two.port",
        one=part("entropy_capacity", C=C1, T_0=400),
        wall=part("entropy_conductor", G=G),
        two=part("entropy_capacity", C=C2, T_0=300),
    ):
        run = hb.simulate(m, until=600.0, rtol=1e-10)
        t = np.linspace(0, 600, 5)
        one, two = run["one.temperature"].at(t), run["two.temperature"].at(t)
        assert one - two == pytest.approx(100 * np.exp(-G * (1 / C1 + 1 / C2) * t), rel=1e-6)
        assert C1 * one + C2 * two == pytest.approx(np.full(5, C1 * 400 + C2 * 300), rel=1e-9)
        entropy = run["one.entropy"].at(t) + run["two.entropy"].at(t)
        textbook = C1 * np.log(one / 400) + C2 * np.log(two / 300)
        assert entropy == pytest.approx(textbook, rel=1e-7, abs=1e-9)
        assert run["wall.produced"].at(0) == pytest.approx(G * 100**2 / (400 * 300))
        assert run["wall.heat"].at(0) == pytest.approx(G * 100)
        assert run["two.heat"].at(0) == pytest.approx(G * 100)
        assert run["one.heat"].at(t) == pytest.approx(-run["two.heat"].at(t), rel=1e-12)
        assert run["wall.produced"].unit == "W/K"


@pytest.mark.slow
def test_a_heater_gives_entropy_by_the_temperature_it_meets():
    """``"thermal.entropy_heater"``, ``"thermal.entropy_ambient"``: as a pseudo heater."""
    C, G, P = 1e3, 2.0, 100.0
    t = np.linspace(0, 1500, 6)
    for m in joined(
        "body.port - wall.hot",
        "wall.cold - air.port",
        "heater.port - body.port",
        body=part("entropy_capacity", C=C, T_0=350),
        wall=part("entropy_conductor", G=G),
        air=part("entropy_ambient", T=280),
        heater=part("entropy_heater", P=P),
    ):
        run = hb.simulate(m, until=1500.0, rtol=1e-9)
        expected = 330 + 20 * np.exp(-G / C * t)
        assert run["body.temperature"].at(t) == pytest.approx(expected, rel=1e-7)
        assert run["heater.heat"].at(t) == pytest.approx(np.full(6, P))
        assert run["heater.entropy"].at(t) == pytest.approx(P / expected, rel=1e-7)
        assert run["air.heat"].at(t) == pytest.approx(-G * (expected - 280), rel=1e-6)
        assert run["air.entropy"].at(t) == pytest.approx(-G * (expected - 280) / 280, rel=1e-6)
