"""What leaks through switches that are off, against Ohm's law, bonds at their ports both ways."""

import math

import pytest
from library.bench import every_way

import hybond as hb

OFF = {
    "switch": {},
    "diode": {"drop": 100},
    "thyristor": {},
    "triac": {},
    "gto": {},
    "transistor": {},
    "igbt": {"diode_drop": 100},
    "mosfet": {"diode_drop": 100},
    "zener": {"drop": 100, "breakdown": 100},
    "fuse": {"I2t": "1e-9 A^2*s"},
}


def in_series(part: hb.Submodel, volts: float) -> hb.Model:
    m = hb.Model("bench", domain="electrical")
    m.add(V=hb.Se(volts), hot=hb.Zero(), out=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), p=part)
    m.add(load=hb.Submodel("electrical.resistor", R=5))
    m.bond("V -> hot", "out -> load.plus", "load.minus -> cold", "zero -> cold")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("volts", [10, -10])
@pytest.mark.parametrize("name", OFF)
def test_a_device_that_is_off_leaks_by_its_conductance(name: str, volts: float) -> None:
    part = hb.Submodel(f"electrical.{name}", G_off="0.05 S", **OFF[name])
    for way in every_way(in_series(part, volts), "hot - p.plus", "p.minus - out"):
        run = hb.simulate(way, until="1 ms")
        assert run["p.current"].at(9e-4) == pytest.approx(volts / 25, rel=1e-12), way.name
        assert run["p.voltage"].at(9e-4) == pytest.approx(volts * 20 / 25, rel=1e-12)


@pytest.mark.parametrize("conductance", [0.0, 0.05])
def test_a_switch_that_opens_a_coil_drives_its_current_through_what_leaks(
    conductance: float,
) -> None:
    """With no leak the flux is lost in an impulse, with one it decays with L*G."""
    m = hb.Model("coil", domain="electrical", parameters={"T": "1 ms"})
    m.add(s=hb.Submodel("electrical.switch", G_off=conductance, inputs={"gate": "time < T"}))
    m.add(V=hb.Se("10 V"), hot=hb.Zero(), out=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0))
    m.add(coil=hb.Submodel("electrical.inductor", L="1 mH"))
    m.bond("V -> hot", "out -> coil.plus", "coil.minus -> cold", "zero -> cold")
    for way in every_way(m, "hot - s.plus", "s.minus - out"):
        run = hb.simulate(way, until="1.1 ms", rtol=1e-10, atol=1e-12)
        if conductance:
            rest = 10 * conductance
            left = rest + (10 - rest) * math.exp(-5e-5 / (1e-3 * conductance))
            assert run["coil.current"].at(1.05e-3) == pytest.approx(left, rel=1e-7), way.name
        else:
            assert run["coil.current"].at(1.05e-3) == 0
            step = run.events[-1].steps[-1]
            assert step.energy.lost == pytest.approx(0.5 * 1e-3 * 10**2, rel=1e-9)


def test_the_contacts_of_a_relay_and_of_a_changeover_switch_leak() -> None:
    part = hb.Submodel("electrical.relay", G_off="0.05 S")
    m = in_series(part, 10)
    m.bond("cold -> p.coil_plus", "p.coil_minus -> cold")
    for way in every_way(m, "hot - p.plus", "p.minus - out"):
        assert hb.simulate(way, until=1)["p.current"].at(0.5) == pytest.approx(10 / 25), way.name
    m = in_series(hb.Submodel("electrical.changeover_switch", R_on=5, G_off="0.1 S"), 10)
    for way in every_way(m, "out - p.common", "p.rest - cold", "hot - p.work"):
        run = hb.simulate(way, until=1)
        # from `work` 0.1 S to the node, from there the contact, its leak and the load to ground
        volts = 10 * 0.1 / (0.1 + 0.2 + 0.1 + 0.2)
        assert run["load.voltage"].at(0.5) == pytest.approx(volts, rel=1e-12), way.name
        assert run["p.current_work"].at(0.5) == pytest.approx(0.1 * (volts - 10), rel=1e-12)
        assert run["p.current_rest"].at(0.5) == pytest.approx(0.3 * volts, rel=1e-12)


BRIDGES = {
    "diode_bridge": ({"drop": 1000}, "ab"),
    "three_phase_bridge": ({"drop": 1000}, "abc"),
    "thyristor_bridge": ({}, "abc"),
    "single_phase_thyristor_bridge": ({}, "ab"),
    "single_phase_half_controlled_bridge": ({"drop": 1000}, "ab"),
    "three_phase_half_controlled_bridge": ({"drop": 1000}, "abc"),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", BRIDGES)
def test_a_bridge_that_is_off_leaks_through_each_of_its_devices(name: str) -> None:
    """Plus has 5 ohm to ground, minus 2 ohm."""
    values, phases = BRIDGES[name]
    volts = dict(zip("abc", (7.0, -2.0, 4.0), strict=True))
    m = hb.Model("bench", domain="electrical")
    m.add(p=hb.Zero(), n=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0))
    m.add(bridge=hb.Submodel(f"electrical.{name}", G_off="0.05 S", **values))
    m.add(upper=hb.Submodel("electrical.resistor", R=5))
    m.add(lower=hb.Submodel("electrical.resistor", R=2))
    m.bond("p -> upper.plus", "upper.minus -> cold", "n -> lower.plus", "lower.minus -> cold")
    m.bond("zero -> cold")
    for x in phases:
        m.add(**{f"V{x}": hb.Se(volts[x]), x: hb.Zero()})
        m.bond(f"V{x} -> {x}")
    k, total = len(phases), sum(volts[x] for x in phases)
    plus, minus = 0.05 * total / (0.05 * k + 1 / 5), 0.05 * total / (0.05 * k + 1 / 2)
    joints = [f"{x} - bridge.{x}" for x in phases]
    for way in every_way(m, *joints, "bridge.plus - p", "n - bridge.minus")[:: len(phases)]:
        run = hb.simulate(way, until=1)
        assert run["bridge.voltage"].at(0.5) == pytest.approx(plus - minus, rel=1e-12), way.name
        assert run["bridge.current"].at(0.5) == pytest.approx(plus / 5, rel=1e-12)
        found = run["bridge.current_in" if k == 2 else "bridge.current_a"].at(0.5)
        assert found == pytest.approx(0.05 * (2 * volts["a"] - plus - minus), rel=1e-12)


LEGS = {
    "half_bridge": ({}, {}),
    "leg": ({"diode_drop": 100}, {"enable": 0}),
    "chopper": ({"diode_drop": 100}, {}),
}


@pytest.mark.parametrize("name", LEGS)
def test_a_leg_that_is_off_divides_its_supply_by_its_leaks(name: str) -> None:
    values, inputs = LEGS[name]
    m = in_series(hb.Submodel(f"electrical.{name}", G_off="0.1 S", **values, inputs=inputs), 10)
    for way in every_way(m, "hot - p.plus", "out - p.out", "cold - p.minus")[::3]:
        run = hb.simulate(way, until=1)
        assert run["p.voltage"].at(0.5) == pytest.approx(10 * 0.1 / 0.4, rel=1e-12), way.name
        assert run["p.current"].at(0.5) == pytest.approx(10 * 0.1 / 0.4 / 5, rel=1e-12)
        lower = run["p.current" + ("_in" if name == "chopper" else "_upper")].at(0.5)
        assert lower == pytest.approx(0.75, rel=1e-12)


def test_bridges_of_legs_and_a_tapped_rectifier_leak() -> None:
    """From 10 V: two leaks of 0.1 S to a and b each, and 5 ohm between those."""
    for name, values in (("h_bridge", {}), ("asymmetric_bridge", {"diode_drop": 100})):
        inputs = {"enable": 0} if name == "h_bridge" else {}
        part = hb.Submodel(f"electrical.{name}", G_off="0.1 S", **values, inputs=inputs)
        m = in_series(part, 10)
        m.bond("hot -> p.plus", "cold -> p.minus", "out -> p.a", "cold -> p.b")
        run = hb.simulate(m, until=1)
        # b is at ground, a has 0.1 S to 10 V, and 0.1 S and 5 ohm to ground
        assert run["p.voltage"].at(0.5) == pytest.approx(10 * 0.1 / 0.4, rel=1e-12), name
    part = hb.Submodel("electrical.centre_tap_thyristor_rectifier", G_off="0.1 S")
    m = in_series(part, 10)
    m.bond("hot -> p.a", "hot -> p.b", "p.plus -> out", "cold -> p.minus", "p.tap -> cold")
    run = hb.simulate(m, until=1)
    assert run["p.voltage"].at(0.5) == pytest.approx(10 * 0.2 / 0.4, rel=1e-12)
    assert run["p.current"].at(0.5) == pytest.approx(1, rel=1e-12)
    assert run["p.current_a"].at(0.5) == pytest.approx(0.5, rel=1e-12)
