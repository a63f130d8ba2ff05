"""Parts of circuits against closed forms, with the bonds at their ports in both directions."""

import math

import pytest
from library.bench import every_way

import hybond as hb


def source(volts: str, **parts: object) -> hb.Model:
    """A source of voltage between the nodes `hot` and `cold`, the latter grounded."""
    m = hb.Model("bench", domain="electrical")
    m.add(V=hb.Se(volts), zero=hb.Se(0), hot=hb.Zero(), cold=hb.Zero(), **parts)
    m.bond("V -> hot", "zero -> cold")
    return m


@pytest.mark.parametrize("ohms", [4.0, 0.5])
def test_a_resistor_has_ohms_law(ohms: float) -> None:
    m = source("12 V", r=hb.Submodel("electrical.resistor", R=ohms))
    for way in every_way(m, "hot - r.plus", "r.minus - cold"):
        run = hb.simulate(way, until=1)
        assert run["r.current"].at(0.5) == pytest.approx(12 / ohms, rel=1e-14), way.name
        assert run["r.voltage"].at(0.5) == 12
        assert (run["r.current"].unit, run["r.voltage"].unit) == ("A", "V")


@pytest.mark.parametrize(("drop", "bulk"), [(0.0, 0.0), (0.7, 0.0), (0.0, 2.0), (0.7, 2.0)])
def test_a_diode_passes_one_half_wave_above_its_drop(drop: float, bulk: float) -> None:
    m = source(
        "10*sin(100*pi*time)",
        d=hb.Submodel("electrical.diode", drop=drop, R_on=bulk),
        load=hb.Submodel("electrical.resistor", R="5 ohm"),
    )
    m.bond("d.minus -> load.plus")
    for way in every_way(m, "hot - d.plus", "load.minus - cold"):
        run = hb.simulate(way, until="20 ms", rtol=1e-10)
        peak = (10 - drop) / (5 + bulk)
        assert run["d.current"].at(0.005) == pytest.approx(peak, rel=1e-10), way.name
        assert run["d.voltage"].at(0.005) == pytest.approx(drop + bulk * peak, abs=1e-9)
        assert run["d.current"].at(0.015) == 0
        assert run["d.voltage"].at(0.015) == pytest.approx(-10, rel=1e-9)
        ends = [e.t for e in run.events if e.t > 0.001]
        off = (math.pi - math.asin(drop / 10)) / (100 * math.pi)
        assert ends[0] == pytest.approx(off, rel=1e-9)


@pytest.mark.parametrize("bulk", [0.0, 1.0])
def test_a_switch_opens_and_closes_with_its_gate(bulk: float) -> None:
    m = source(
        "10 V",
        s=hb.Submodel("electrical.switch", R_on=bulk, inputs={"gate": "time >= 1 [ms]"}),
        load=hb.Submodel("electrical.resistor", R="4 ohm"),
    )
    m.bond("s.minus -> load.plus")
    for way in every_way(m, "hot - s.plus", "load.minus - cold"):
        run = hb.simulate(way, until="2 ms")
        assert run["s.current"].at(0.0005) == 0, way.name
        assert run["s.current"].at(0.0015) == pytest.approx(10 / (4 + bulk), rel=1e-14)
        assert [e.t for e in run.events if e.cause != "start"] == [0.001]


def grounded() -> dict[str, object]:
    return {"zero": hb.Submodel("electrical.ground"), "cold": hb.Zero()}


@pytest.mark.parametrize(("farads", "before"), [(1e-6, 0.0), (4.7e-6, -3.0)])
def test_a_capacitor_charges_by_an_exponential(farads: float, before: float) -> None:
    m = source(
        "5 V",
        r=hb.Submodel("electrical.resistor", R="1 kohm"),
        c=hb.Submodel("electrical.capacitor", C=farads, v0=before),
    )
    m.bond("r.minus -> c.plus")
    for way in every_way(m, "hot - r.plus", "c.minus - cold"):
        run = hb.simulate(way, until="10 ms", rtol=1e-10)
        left = (before - 5) * math.exp(-0.003 / (1000 * farads))
        assert run["c.voltage"].at(0.003) == pytest.approx(5 + left, rel=1e-8), way.name
        assert run["c.current"].at(0.003) == pytest.approx(-left / 1000, rel=1e-6, abs=1e-12)
        assert run["c.charge"].at(0.003) == pytest.approx(farads * (5 + left), rel=1e-8)
        assert run["c.energy"].at(0.003) == pytest.approx(farads * (5 + left) ** 2 / 2, rel=1e-8)
    units = [run[f"c.{name}"].unit for name in ("voltage", "current", "charge", "energy")]
    assert units == ["V", "A", "C", "J"]


@pytest.mark.parametrize(("henry", "before"), [(1e-3, 0.0), (0.02, 2.0)])
def test_an_inductor_follows_by_an_exponential(henry: float, before: float) -> None:
    m = source(
        "5 V",
        r=hb.Submodel("electrical.resistor", R="10 ohm"),
        l=hb.Submodel("electrical.inductor", L=henry, i0=before),
    )
    m.bond("r.minus -> l.plus")
    for way in every_way(m, "hot - r.plus", "l.minus - cold"):
        run = hb.simulate(way, until="1 ms", rtol=1e-10)
        left = (before - 0.5) * math.exp(-10 * 2e-4 / henry)
        assert run["l.current"].at(2e-4) == pytest.approx(0.5 + left, rel=1e-8), way.name
        assert run["l.voltage"].at(2e-4) == pytest.approx(-10 * left, rel=1e-6)
        assert run["l.flux"].at(2e-4) == pytest.approx(henry * (0.5 + left), rel=1e-8)
        assert run["l.energy"].at(2e-4) == pytest.approx(henry * (0.5 + left) ** 2 / 2, rel=1e-8)
    assert [run[f"l.{n}"].unit for n in ("voltage", "flux")] == ["V", "V*s"]


def loaded(part: hb.Model | object, ohms: float = 4.0) -> hb.Model:
    """A part between two nodes with a resistor between them, grounded at one."""
    m = hb.Model("bench", domain="electrical")
    m.add(s=part, hot=hb.Zero(), load=hb.Submodel("electrical.resistor", R=ohms), **grounded())
    m.bond("hot -> load.plus", "load.minus -> cold", "zero.pin -> cold")
    return m


@pytest.mark.parametrize("given", [{"U": 12}, {"inputs": {"u": "12 V"}}])
def test_a_source_of_voltage_keeps_it_and_delivers(given: dict[str, object]) -> None:
    m = loaded(hb.Submodel("electrical.voltage_source", **given))
    for way in every_way(m, "hot - s.plus", "s.minus - cold"):
        run = hb.simulate(way, until=1)
        values = [run[n].at(0.5) for n in ("s.voltage", "s.current", "s.supplied", "load.current")]
        assert values == pytest.approx([12, -3, 36, 3], rel=1e-14), way.name
    assert [run[n].unit for n in ("s.voltage", "s.current", "s.supplied")] == ["V", "A", "W"]


@pytest.mark.parametrize("given", [{"I": 3}, {"inputs": {"u": "3 A"}}])
def test_a_source_of_current_drives_it_from_plus_to_minus_through_itself(
    given: dict[str, object],
) -> None:
    m = loaded(hb.Submodel("electrical.current_source", **given))
    for way in every_way(m, "hot - s.plus", "s.minus - cold"):
        run = hb.simulate(way, until=1)
        values = [run[n].at(0.5) for n in ("s.voltage", "s.current", "s.supplied", "load.current")]
        assert values == pytest.approx([-12, 3, 36, -3], rel=1e-14), way.name


def test_a_sine_has_its_amplitude_frequency_phase_and_offset() -> None:
    m = loaded(hb.Submodel("electrical.sine_voltage", amplitude=10, phase=0.3, offset=1))
    for way in every_way(m, "hot - s.plus", "s.minus - cold"):
        run = hb.simulate(way, until="40 ms")
        for t in (0.0, 0.0021, 0.033):
            expected = 1 + 10 * math.sin(100 * math.pi * t + 0.3)
            assert run["s.voltage"].at(t) == pytest.approx(expected, rel=1e-12), way.name
            assert run["s.current"].at(t) == pytest.approx(-expected / 4, rel=1e-12)
            assert run["s.supplied"].at(t) == pytest.approx(expected**2 / 4, rel=1e-12)


def test_what_arrives_at_the_ground_is_its_current() -> None:
    m = hb.Model("bench", domain="electrical")
    m.add(s=hb.Submodel("electrical.voltage_source", U=6), r=hb.Submodel("electrical.resistor"))
    m.add(g=hb.Submodel("electrical.ground"), h=hb.Submodel("electrical.ground"))
    for way in every_way(m, "s.minus - g.pin", "s.plus - r.plus", "r.minus - h.pin"):
        run = hb.simulate(way, until=1)
        assert (run["g.current"].at(0.5), run["h.current"].at(0.5)) == (-6, 6), way.name


def test_a_three_phase_source_is_balanced_and_delivers_constant_power() -> None:
    m = hb.Model("bench", domain="electrical")
    m.add(s=hb.Submodel("electrical.three_phase_source", amplitude=100), g=hb.Zero())
    m.add(zero=hb.Submodel("electrical.ground"))
    m.bond("zero.pin -> g")
    for phase in "abc":
        m.add(**{f"r_{phase}": hb.Submodel("electrical.resistor", R="5 ohm")})
        m.bond(f"r_{phase}.minus -> g")
    joints = [f"s.{phase} - r_{phase}.plus" for phase in "abc"]
    for way in every_way(m, "g - s.neutral", *joints):
        run = hb.simulate(way, until="20 ms")
        for t in (0.0, 0.0037):
            for phase, lag in (("a", 0), ("b", 1), ("c", 2)):
                angle = 2 * math.pi * (50 * t - lag / 3)
                volts = 100 * math.sin(angle)
                assert run[f"s.voltage_{phase}"].at(t) == pytest.approx(volts, abs=1e-10), way.name
                assert run[f"s.current_{phase}"].at(t) == pytest.approx(volts / 5, abs=1e-10)
            assert run["s.supplied"].at(t) == pytest.approx(1.5 * 100**2 / 5, rel=1e-12)
            assert run["zero.current"].at(t) == pytest.approx(0, abs=1e-12)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "value", "control", "out"),
    [
        # 8 V drive 2 A through the control of 4 ohm; the load is 5 ohm
        ("electrical.vcvs", {"gain": 3}, 8, {"s.voltage": 24, "s.current": -4.8}),
        ("electrical.vccs", {"transconductance": 0.5}, 8, {"s.voltage": -20, "s.current": 4}),
        ("electrical.ccvs", {"transresistance": 7}, 2, {"s.voltage": 14, "s.current": -2.8}),
        ("electrical.cccs", {"gain": 3}, 2, {"s.voltage": -30, "s.current": 6}),
    ],
)
def test_a_controlled_source_follows_its_control(
    name: str, value: dict[str, float], control: float, out: dict[str, float]
) -> None:
    m = source(
        "8 V",
        drop=hb.Submodel("electrical.resistor", R=4),
        load=hb.Submodel("electrical.resistor", R=5),
        s=hb.Submodel(name, **value),
    )
    m.add(top=hb.Zero(), mid=hb.Zero())
    m.bond("top -> load.plus", "load.minus -> cold")
    if name.startswith("electrical.v"):  # across a resistor
        m.bond("hot -> mid", "hot -> drop.plus", "drop.minus -> cold")
    else:  # through a resistor
        m.bond("hot -> drop.plus", "drop.minus -> mid")
    ways = every_way(
        m, "mid - s.control_plus", "s.control_minus - cold", "top - s.plus", "s.minus - cold"
    )
    for way in ways:
        run = hb.simulate(way, until=1)
        assert run["s.control"].at(0.5) == pytest.approx(control, rel=1e-14), way.name
        for signal, expected in out.items():
            assert run[signal].at(0.5) == pytest.approx(expected, rel=1e-13), way.name


def test_a_follower_of_two_controlled_sources_settles_its_loop() -> None:
    # 1000 times what is left between input and output: v = 1000/1001 of the input
    m = source("2 V", s=hb.Submodel("electrical.vcvs", gain=1000))
    m.add(r=hb.Submodel("electrical.resistor"), top=hb.Zero())
    m.bond("top -> r.plus", "r.minus -> cold", "top -> s.plus", "s.minus -> cold")
    for way in every_way(m, "hot - s.control_plus", "s.control_minus - top"):
        run = hb.simulate(way, until=1)
        assert run["s.voltage"].at(0.5) == pytest.approx(2000 / 1001, rel=1e-12), way.name


def test_meters_read_and_do_not_disturb() -> None:
    m = source(
        "10 V",
        r=hb.Submodel("electrical.resistor", R="2 ohm"),
        v=hb.Submodel("electrical.voltage_sensor"),
        i=hb.Submodel("electrical.current_sensor"),
        p=hb.Submodel("electrical.power_sensor"),
    )
    m.bond("i.minus -> p.plus", "p.minus -> r.plus", "r.minus -> cold", "p.reference -> cold")
    for way in every_way(m, "hot - i.plus", "hot - v.plus", "v.minus - cold"):
        run = hb.simulate(way, until=2)
        values = [run[n].at(1.5) for n in ("v.voltage", "i.current", "p.power", "p.energy")]
        assert values == pytest.approx([10, 5, 50, 75], rel=1e-9), way.name
        assert run["p.voltage"].at(1) == 10
    assert (run["p.power"].unit, run["p.energy"].unit) == ("W", "J")
    m.bonds = [b for b in m.bonds if "p." not in b] + ["hot -> i.plus"]
    m.bond("hot -> v.plus", "v.minus -> cold")
    for way in every_way(m, "i.minus - p.plus", "p.minus - r.plus", "p.reference - cold"):
        assert hb.simulate(way, until=1)["p.power"].at(0.5) == pytest.approx(50), way.name
