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
