"""Of the machines beside junction laws only what they switch near a law counts."""

import math

import pytest

import hybond as hb


def rectifier() -> hb.Model:
    m = hb.Model("rectifier", domain="electrical")
    m.add(V=hb.Se("10 [V]*sin(100*pi*time)"), d=hb.One(law="diode"), n=hb.Zero(), r=hb.R("5 ohm"))
    m.add(rest=hb.One(), c=hb.C("1 mF"))
    m.bond("V -> d -> n -> r", "n -> rest -> c")
    return m


@pytest.mark.parametrize("engine", ["library", "python"])
def test_thirteen_machines_of_signals_are_one_setting(engine: str) -> None:
    m = rectifier()
    for k in range(13):
        m.machine(f"m{k}", states={"a": [], "b": []}, start="a", rules=[f"a -> b when time > {k}"])
    m.machine("M", states={"off": [], "on": ["rest"]}, start="off", rules=[])
    run = hb.simulate(m, until="15 ms", engine=engine)
    assert run["r.f"].at([0.004, 0.006]) == pytest.approx([2 * math.sin(0.4 * math.pi)] * 2)
    assert run["r.f"].at(0.014) == pytest.approx(0, abs=1e-12)


def test_thirteen_clocks_apart_from_the_law_are_one_setting() -> None:
    m = rectifier()
    for k in range(13):
        m.add(**{f"t{k}": hb.Submodel("control.timer", T=0.001 * (k + 1), inputs={"u": "1"})})
    m.machine("M", states={"on": ["rest"], "off": []}, start="on", rules=["on -> off when time>1"])
    run = hb.simulate(m, until="15 ms", rtol=1e-9)
    # the capacitor follows the source until the current of the diode ends, then it discharges
    w, tau = 100 * math.pi, 5e-3
    end = (math.pi - math.atan(w * tau)) / w
    expected = 10 * math.sin(w * end) * math.exp(-(0.014 - end) / tau)
    assert run["c.e"].at(0.014) == pytest.approx(expected, rel=1e-7)
    assert [run[f"t{k}.out"].at(0.0135) for k in range(13)] == [1] * 13


@pytest.mark.parametrize("engine", ["library", "python"])
def test_forty_switches_in_a_circuit_with_a_diode_are_found_as_they_are_entered(
    engine: str,
) -> None:
    m = rectifier()
    for k in range(40):
        m.add(**{f"s{k}": hb.One(), f"r{k}": hb.R("40 ohm")})
        m.bond(f"n -> s{k} -> r{k}")
        rule = f"off -> on when time > {k + 1} ms"
        m.machine(f"m{k}", states={"off": [], "on": [f"s{k}"]}, start="off", rules=[rule])
    m.machine("M", states={"off": [], "on": ["rest"]}, start="off", rules=[])
    run = hb.simulate(m, until="26 ms", engine=engine)
    for t in (0.0005, 0.0045, 0.0095, 0.0145, 0.0205, 0.0255):
        closed = math.floor(t / 1e-3)
        voltage = max(10.0 * math.sin(100 * math.pi * t), 0.0)
        assert run["d.f"].at(t) == pytest.approx(voltage * (1 / 5 + closed / 40), abs=1e-9)


@pytest.mark.parametrize("engine", ["library", "python"])
def test_time_stepping_of_machines_without_any_law_reads_no_place_of_settings(engine: str) -> None:
    m = hb.Model("lamp", domain="electrical")
    m.add(V=hb.Se("10 V"), s=hb.One(), r=hb.R("5 ohm"))
    m.bond("V -> s -> r")
    m.machine("S", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time>0.5"])
    run = hb.simulate(m, "1 s", solver="moreau-jean", step="10 ms", engine=engine)
    assert run["r.f"].at([0.2, 0.8]) == pytest.approx([0.0, 2.0])
