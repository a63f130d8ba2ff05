"""Rectifiers that are fired after the line, against the mean voltages of textbooks."""

import math

import numpy as np
import pytest
from library.bench import every_way

import hybond as hb

CONTROLLED = "electrical.single_phase_thyristor_bridge"
HALF = "electrical.single_phase_half_controlled_bridge"
TAPPED = "electrical.centre_tap_thyristor_rectifier"
SIX = "electrical.three_phase_half_controlled_bridge"


def single_phase(name: str, degrees: float, *, hertz: float, **load: float) -> hb.Model:
    """A rectifier at 100 V from its start: R, or R and L, or R, L and a voltage."""
    m = hb.Model("rectifier", domain="electrical", parameters={"alpha": math.radians(degrees)})
    m.add(p=hb.Zero(), n=hb.Zero(), zero=hb.Submodel("electrical.ground"), x=hb.Zero())
    m.add(q=hb.Submodel(name, inputs={"alpha": "alpha"}))
    m.add(s=hb.Submodel("electrical.sine_voltage", amplitude=100, frequency=hertz, phase=1))
    m.add(r=hb.Submodel("electrical.resistor", R=load["R"]), y=hb.Zero())
    if "L" in load:
        m.add(l=hb.Submodel("electrical.inductor", L=load["L"]))
        m.bond("p -> l.plus", "l.minus -> x")
    else:
        m.bond("p -> x")
    m.add(e=hb.Submodel("electrical.voltage_source", U=load.get("U", 0)))
    m.bond("x -> r.plus", "r.minus -> y", "e.plus -> y", "e.minus -> n", "zero.pin -> n")
    m.signal(area=hb.Integral("q.voltage"))
    return m


def joints(m: hb.Model, name: str) -> list[hb.Model]:
    if name != TAPPED:
        return every_way(m, "s.plus - q.a", "s.minus - q.b", "q.plus - p", "n - q.minus")
    m.add(other=hb.Submodel("electrical.sine_voltage", amplitude=100, phase=1))
    m.elements["other"] = m.elements["s"]
    m.add(mid=hb.Zero())
    m.bond("s.minus -> mid", "other.plus -> mid")
    ends = ("s.plus - q.a", "other.minus - q.b", "mid - q.tap", "q.plus - p", "n - q.minus")
    return every_way(m, *ends)


def mean(run: hb.Result, since: float, until: float) -> float:
    return (run["area"].at(until) - run["area"].at(since)) / (until - since)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [CONTROLLED, HALF, TAPPED])
@pytest.mark.parametrize(("degrees", "hertz"), [(0, 50), (60, 50), (90, 400), (135, 50), (60, 17)])
def test_into_a_resistor_the_mean_follows_one_plus_the_cosine(
    name: str, degrees: float, hertz: float
) -> None:
    m = single_phase(name, degrees, hertz=hertz, R=10)
    for way in joints(m, name)[::7]:
        run = hb.simulate(way, until=3 / hertz, rtol=1e-9, atol=1e-11)
        expected = 100 / math.pi * (1 + math.cos(math.radians(degrees)))
        assert mean(run, 2 / hertz, 3 / hertz) == pytest.approx(expected, rel=1e-7), way.name
        assert run["q.frequency"].at(2.9 / hertz) == pytest.approx(hertz, rel=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [CONTROLLED, TAPPED])
@pytest.mark.parametrize("degrees", [0, 45, 75])
def test_with_a_current_that_does_not_pause_the_mean_follows_the_cosine(
    name: str, degrees: float
) -> None:
    m = single_phase(name, degrees, hertz=50, R=1, L=0.5)
    for way in joints(m, name)[::7]:
        run = hb.simulate(way, until=0.06, rtol=1e-9, atol=1e-11)
        expected = 200 / math.pi * math.cos(math.radians(degrees))
        assert mean(run, 0.04, 0.06) == pytest.approx(expected, rel=1e-7), way.name
        assert run["q.current"].at(np.linspace(0.04, 0.06, 50)).min() > 0


@pytest.mark.sampled(1)
@pytest.mark.parametrize("degrees", [30, 120])
def test_a_half_controlled_bridge_lets_a_coil_go_on_without_voltage(degrees: float) -> None:
    m = single_phase(HALF, degrees, hertz=50, R=1, L=0.5)
    for way in joints(m, HALF)[::7]:
        run = hb.simulate(way, until=0.06, rtol=1e-9, atol=1e-11)
        expected = 100 / math.pi * (1 + math.cos(math.radians(degrees)))
        assert mean(run, 0.04, 0.06) == pytest.approx(expected, rel=1e-7), way.name
        t = np.linspace(0.04, 0.06, 60)
        assert run["q.voltage"].at(t).min() >= -1e-9
        assert run["q.current"].at(t).min() > 0


def test_a_controlled_bridge_fired_late_gives_power_back() -> None:
    """A source behind the coil drives the current on against a negative mean voltage."""
    m = single_phase(CONTROLLED, 120, hertz=50, R=1, L=0.5, U=-60)
    for way in joints(m, CONTROLLED)[::15]:
        run = hb.simulate(way, until=0.06, rtol=1e-9, atol=1e-11)
        assert mean(run, 0.04, 0.06) == pytest.approx(-100 / math.pi, rel=1e-7), way.name
        assert run["q.current"].at(0.06) > run["q.current"].at(0.04) > 0


@pytest.mark.parametrize("degrees", [20, 50])
def test_behind_an_inductance_the_mean_falls_by_the_overlap(degrees: float) -> None:
    """While four conduct the load has no voltage; the inductance turns its current round.

    Over a half wave the load misses the flux that the current has at the two firings.
    """
    m = single_phase(CONTROLLED, degrees, hertz=50, R=5, L=0.1)
    m.elements["q"] = hb.Submodel(
        CONTROLLED, inputs={"alpha": "alpha", "line_drop": "choke.voltage"}
    )
    m.add(choke=hb.Submodel("electrical.inductor", L="5 mH"))
    m.bond("s.plus -> choke.plus", "s.minus -> q.b", "q.plus -> p", "n -> q.minus")
    for way in every_way(m, "choke.minus - q.a"):
        run = hb.simulate(way, until=0.08, rtol=1e-9, atol=1e-11)
        start = 0.06 + (math.radians(degrees) - 1) / (100 * math.pi)
        first, last = run["q.current"].at([start, start + 0.01])
        assert first > 1 and last > 1
        expected = 200 / math.pi * math.cos(math.radians(degrees)) - 0.005 * (first + last) / 0.01
        assert mean(run, start, start + 0.01) == pytest.approx(expected, rel=1e-6), way.name


def test_a_line_that_changes_its_frequency_is_followed_a_half_wave_later() -> None:
    m = hb.Model("line", domain="electrical")
    m.input(hz=hb.Input(table=[(0, 50), (0.05, 100)]))
    m.signal(turn=hb.Integral("2*pi*hz"))
    m.add(f=hb.Submodel("control.line_firing", inputs={"u": "sin(turn)", "alpha": "pi/2"}))
    run = hb.simulate(m, until=0.08, rtol=1e-11, atol=1e-12)
    # half waves end each 10 ms until 50 ms, each 5 ms from there
    assert run["f.frequency"].at([0.01, 0.045, 0.0525, 0.0575]) == pytest.approx([0, 50, 50, 100])
    # the first half wave ends what is not known, the next one is timed
    fired = run["f.up + f.down"].at([0.018, 0.024, 0.026, 0.054, 0.0574, 0.0576])
    assert fired.tolist() == [0, 0, 1, 0, 0, 1]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("coil", [0.0, 0.3])
@pytest.mark.parametrize("degrees", [0, 50, 100, 150])
def test_three_phases_half_controlled_have_the_mean_of_the_textbook(
    degrees: float, coil: float
) -> None:
    m = hb.Model("rectifier", domain="electrical", parameters={"alpha": math.radians(degrees)})
    m.add(s=hb.Submodel("electrical.three_phase_source", amplitude=100), star=hb.Zero())
    m.add(q=hb.Submodel(SIX, inputs={"alpha": "alpha"}), p=hb.Zero(), n=hb.Zero(), x=hb.Zero())
    m.add(r=hb.Submodel("electrical.resistor", R=10), zero=hb.Submodel("electrical.ground"))
    if coil:
        m.add(l=hb.Submodel("electrical.inductor", L=coil))
        m.bond("p -> l.plus", "l.minus -> x")
    else:
        m.bond("p -> x")
    m.bond("star -> s.neutral", "zero.pin -> star", "x -> r.plus", "r.minus -> n")
    m.signal(area=hb.Integral("q.voltage"))
    ways = every_way(m, "s.a - q.a", "s.b - q.b", "s.c - q.c", "q.plus - p", "n - q.minus")
    for way in ways[:: 3 if degrees == 50 else 7]:
        run = hb.simulate(way, until=0.06, rtol=1e-9, atol=1e-11)
        expected = 150 * math.sqrt(3) / math.pi * (1 + math.cos(math.radians(degrees)))
        assert mean(run, 0.04, 0.06) == pytest.approx(expected, rel=1e-7), way.name
        currents = sum(run[f"q.current_{x}"].at(0.0533) for x in "abc")
        assert currents == pytest.approx(0, abs=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("degrees", "hertz"), [(0, 50), (45, 60), (80, 400)])
def test_a_six_pulse_bridge_is_fired_after_its_line(degrees: float, hertz: float) -> None:
    m = hb.Model("rectifier", domain="electrical", parameters={"alpha": math.radians(degrees)})
    m.add(s=hb.Submodel("electrical.three_phase_source", amplitude=100, frequency=hertz))
    u = {f"u_{x}{y}": f"s.{x}.e - s.{y}.e" for x, y in ("ab", "bc", "ca")}
    m.add(f=hb.Submodel("control.line_six_pulse", inputs={**u, "alpha": "alpha"}))
    gates = {f"gate_{k}": f"f.gate_{k}" for k in range(1, 7)}
    m.add(q=hb.Submodel("electrical.thyristor_bridge", inputs=gates), star=hb.Zero(), x=hb.Zero())
    m.add(r=hb.Submodel("electrical.resistor", R=1), zero=hb.Submodel("electrical.ground"))
    m.add(l=hb.Submodel("electrical.inductor", L=0.5), n=hb.Zero())
    m.bond("star -> s.neutral", "zero.pin -> star", "s.a -> q.a", "s.b -> q.b", "s.c -> q.c")
    m.bond("q.plus -> l.plus", "l.minus -> x -> r.plus", "r.minus -> n -> q.minus")
    m.signal(area=hb.Integral("q.voltage"))
    run = hb.simulate(m, until=3 / hertz, rtol=1e-9, atol=1e-11)
    expected = 300 * math.sqrt(3) / math.pi * math.cos(math.radians(degrees))
    assert mean(run, 2 / hertz, 3 / hertz) == pytest.approx(expected, rel=1e-7)
    assert run["f.frequency"].at(2.5 / hertz) == pytest.approx(hertz, rel=1e-9)
