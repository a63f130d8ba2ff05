"""Legs, bridges and choppers with their modulation, against means and spectra of textbooks."""

import math
from itertools import pairwise

import numpy as np
import pytest
from library.bench import every_way
from scipy.special import j0

import hybond as hb

SUPPLY = ("hot - q.plus", "cold - q.minus")


def supplied(part: hb.Submodel) -> hb.Model:
    m = hb.Model("converter", domain="electrical")
    m.add(V=hb.Se("100 V"), hot=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), q=part)
    m.bond("V -> hot", "zero -> cold")
    return m


def driven(part: hb.Submodel, amperes: float) -> hb.Model:
    """The current out of `out`, and back to ground."""
    m = supplied(part)
    m.add(load=hb.Submodel("electrical.current_source", I=amperes), x=hb.Zero(), back=hb.R(1))
    m.add(i=hb.One())
    m.bond("x -> load.plus", "load.minus -> i -> cold", "i -> back")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("amperes", [3.0, -3.0])
def test_the_dead_time_of_a_leg_takes_its_part_of_the_mean_voltage(amperes: float) -> None:
    """Each period both channels are off twice, and once of it the diode of the other rail holds."""
    part = hb.Submodel("electrical.leg", T_dead="20 us", inputs={"command": "pwm"})
    m = driven(part, amperes)
    m.input(pwm=hb.Input(pwm={"period": "1 ms", "duty": 0.4}))
    m.signal(area=hb.Integral("q.voltage"))
    for way in every_way(m, "hot - q.plus", "q.out - x", "cold - q.minus"):
        run = hb.simulate(way, until="3 ms")
        mean = (run["area"].at(3e-3) - run["area"].at(1e-3)) / 2e-3
        lost = math.copysign(100 * 20e-6 / 1e-3, amperes)
        assert mean == pytest.approx(40 - lost, rel=1e-9), way.name
        assert run["q.current"].at(2.2e-3) == pytest.approx(amperes)
        assert run["q.current_upper"].at(2.2e-3) == pytest.approx(amperes)
        assert run["q.current_lower"].at(2.7e-3) == pytest.approx(-amperes)


def test_channels_have_their_resistance_and_diodes_their_drop() -> None:
    values = {"R_on": 0.1, "diode_drop": 0.7, "R_diode": 0.2, "T_dead": "20 us"}
    # command up at 1 ms: the channel of `plus` 20 us later; off by `enable` at 2 ms
    inputs = {"command": "time > 1 [ms]", "enable": "time < 2 [ms]"}
    for amperes, low, dead, high, off in (
        (2.0, -0.2, -1.1, 99.8, -1.1),
        (-2.0, 0.2, 101.1, 100.2, 101.1),
    ):
        m = driven(hb.Submodel("electrical.leg", **values, inputs=inputs), amperes)
        for way in every_way(m, "hot - q.plus", "q.out - x", "cold - q.minus")[::7]:
            run = hb.simulate(way, until="3 ms")
            found = run["q.voltage"].at([0.5e-3, 1.01e-3, 1.5e-3, 2.5e-3])
            assert found == pytest.approx([low, dead, high, off], rel=1e-9), way.name


def test_a_command_shorter_than_the_dead_time_comes_to_nothing() -> None:
    command = hb.Input(table=[(0, 0), (1e-3, 1), (1.01e-3, 0), (2e-3, 1), (3e-3, 0), (3.01e-3, 1)])
    m = driven(hb.Submodel("electrical.leg", T_dead="20 us", inputs={"command": "c"}), 2.0)
    m.input(c=command)
    m.bond("hot -> q.plus", "q.out -> x", "cold -> q.minus")
    run = hb.simulate(m, until="4 ms")
    found = run["q.voltage"].at([0.5e-3, 1.005e-3, 1.5e-3, 2.5e-3, 3.005e-3, 3.5e-3])
    assert found == pytest.approx([0, 0, 0, 100, 0, 100])


def spectrum(m: hb.Model, *orders: int) -> None:
    for n in orders:
        m.signal(**{f"s{n}": hb.Integral(f"q.voltage*sin({n}*100*pi*time)")})
        m.signal(**{f"c{n}": hb.Integral(f"q.voltage*cos({n}*100*pi*time)")})


def amplitude(run: hb.Result, order: int) -> float:
    return 100 * math.hypot(run[f"s{order}"].at(0.02), run[f"c{order}"].at(0.02))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("depth", [0.4, 0.9])
@pytest.mark.parametrize("second", ["bipolar", "unipolar"])
def test_an_h_bridge_has_the_spectrum_of_natural_sampling(depth: float, second: str) -> None:
    """Holmes and Lipo: at the carrier 4/pi*U*J0(pi*m/2), which the second modulation takes away."""
    b = "1 - pwm.out" if second == "bipolar" else "other.out"
    m = supplied(hb.Submodel("electrical.h_bridge", inputs={"a_up": "pwm.out", "b_up": b}))
    wave = f"{depth}*sin(100*pi*time)"
    m.add(pwm=hb.Submodel("control.triangle_pwm", period=0.02 / 30, inputs={"u": wave}))
    if second == "unipolar":
        u = {"u": f"-{wave}"}
        m.add(other=hb.Submodel("control.triangle_pwm", period=0.02 / 30, inputs=u))
    m.add(r=hb.Submodel("electrical.resistor", R=10), x=hb.Zero(), y=hb.Zero())
    m.bond("x -> r.plus", "r.minus -> y")
    spectrum(m, 1, 30)
    for way in every_way(m, *SUPPLY, "q.a - x", "q.b - y")[::5]:
        run = hb.simulate(way, until=0.02, rtol=1e-8, atol=1e-10)
        assert amplitude(run, 1) == pytest.approx(100 * depth, rel=1e-6), way.name
        carrier = 400 / math.pi * j0(math.pi / 2 * depth) if second == "bipolar" else 0
        assert amplitude(run, 30) == pytest.approx(carrier, rel=1e-5, abs=1e-4)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("amperes", [3.0, -3.0])
@pytest.mark.parametrize("duty", [0.2, 0.7])
def test_an_h_bridge_works_in_four_quadrants(duty: float, amperes: float) -> None:
    inputs = {"a_up": "pwm", "b_up": "1 - pwm"}
    m = supplied(hb.Submodel("electrical.h_bridge", inputs=inputs))
    m.input(pwm=hb.Input(pwm={"period": "1 ms", "duty": duty}))
    m.add(load=hb.Submodel("electrical.current_source", I=amperes), x=hb.Zero(), y=hb.Zero())
    m.bond("x -> load.plus", "load.minus -> y")
    m.signal(area=hb.Integral("q.voltage"), charge=hb.Integral("q.current_in"))
    for way in every_way(m, *SUPPLY, "q.a - x", "q.b - y")[::5]:
        run = hb.simulate(way, until="2 ms")
        volts = 100 * (2 * duty - 1)
        assert run["area"].at(2e-3) / 2e-3 == pytest.approx(volts, rel=1e-9), way.name
        # what the supply gives is what the load takes
        assert run["charge"].at(2e-3) / 2e-3 == pytest.approx(volts * amperes / 100, rel=1e-9)
        assert run["q.current_a"].at(1.5e-3) == pytest.approx(amperes)
        assert run["q.current_b"].at(1.5e-3) == pytest.approx(-amperes)


def inverter(vector: dict[str, str], **values: float) -> hb.Model:
    commands = {f"{x}_up": f"pwm.{x}" for x in "abc"}
    m = supplied(hb.Submodel("electrical.three_phase_inverter", **values, inputs=commands))
    given = {**vector, "u_dc": "100"}
    m.add(pwm=hb.Submodel("control.space_vector_pwm", period="1 ms", inputs=given))
    m.add(star=hb.Zero())
    for x in "abc":
        m.add(**{f"r{x}": hb.Submodel("electrical.resistor", R=5), f"n{x}": hb.Zero()})
        m.bond(f"n{x} -> r{x}.plus", f"r{x}.minus -> star")
        m.signal(**{f"mean_{x}": hb.Integral(f"r{x}.voltage")})
    return m


PHASES = ("q.a - na", "q.b - nb", "q.c - nc")
LONGEST = 100 / math.sqrt(3)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("length", [20.0, LONGEST * (1 - 1e-9)])
@pytest.mark.parametrize("frame", ["fixed", "turning"])
def test_each_period_of_a_space_vector_modulation_has_the_vector_as_its_mean(
    length: float, frame: str
) -> None:
    turn = "100*pi*time + 0.3"
    if frame == "fixed":
        vector = {"u_alpha": f"{length}*cos({turn})", "u_beta": f"{length}*sin({turn})"}
    else:
        # 0.3 rad behind the voltage, that is d along cos(0.3), q along sin(0.3)
        d, q = length * math.cos(0.3), length * math.sin(0.3)
        vector = {"u_alpha": f"{d}", "u_beta": f"{q}", "angle": "100*pi*time"}
    for way in every_way(inverter(vector), *SUPPLY, *PHASES)[:: 2 if length == 20 else 5]:
        run = hb.simulate(way, until="20 ms")
        for k, x in enumerate("abc"):
            found = np.diff(run[f"mean_{x}"].at(np.linspace(0, 0.02, 21))) / 1e-3
            t = 1e-3 * np.arange(20)
            wanted = length * np.cos(100 * math.pi * t + 0.3 - 2 * math.pi * k / 3)
            assert found == pytest.approx(wanted, abs=1e-6), way.name
        assert not run["pwm.limited"].at(np.linspace(0, 0.019, 50)).any()
        balance = sum(run[f"q.current_{x}"].at(7.3e-3) for x in "abc")
        assert balance == pytest.approx(0, abs=1e-9)


def test_a_vector_that_is_too_long_is_cut_off_and_says_so() -> None:
    """Along phase a a third more than the linear range is reached, 2/3 of the supply."""
    m = inverter({"u_alpha": "70", "u_beta": "0"})
    m.bond("hot -> q.plus", "cold -> q.minus", "q.a -> na", "q.b -> nb", "q.c -> nc")
    run = hb.simulate(m, until="2 ms")
    assert run["mean_a"].at(2e-3) / 2e-3 == pytest.approx(200 / 3, rel=1e-9)
    assert run["pwm.limited"].at(1.5e-3) == 1


def test_a_space_vector_leaves_four_states_in_a_period_and_each_gate_turns_twice() -> None:
    m = inverter({"u_alpha": "30", "u_beta": "10"})
    m.bond("hot -> q.plus", "cold -> q.minus", "q.a -> na", "q.b -> nb", "q.c -> nc")
    run = hb.simulate(m, until="1 ms")
    edges = [0.0, *(e.t for e in run.events if e.t > 0), 1e-3]
    rows = [[run[f"pwm.{x}"].at((s + t) / 2) for x in "abc"] for s, t in pairwise(edges) if t > s]
    rows = [row for k, row in enumerate(rows) if not k or row != rows[k - 1]]
    zero, one, two, full = [0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]
    assert rows == [zero, one, two, full, two, one, zero]


def test_a_chopper_has_the_mean_of_its_duty_and_stops_at_zero_current() -> None:
    values = {"drop": 2, "R_on": 0.5, "diode_drop": 1, "R_diode": 0.25}
    part = hb.Submodel("electrical.chopper", **values, inputs={"gate": "pwm"})
    m = driven(part, 4.0)
    m.input(pwm=hb.Input(pwm={"period": "1 ms", "duty": 0.3}))
    m.signal(area=hb.Integral("q.voltage"))
    for way in every_way(m, "hot - q.plus", "q.out - x", "cold - q.minus")[1::3]:
        run = hb.simulate(way, until="2 ms")
        mean = 0.3 * (100 - 2 - 0.5 * 4) - 0.7 * (1 + 0.25 * 4)
        assert run["area"].at(2e-3) / 2e-3 == pytest.approx(mean, rel=1e-9), way.name
        assert run["q.current_in"].at([1.1e-3, 1.8e-3]) == pytest.approx([4, 0])
        assert run["q.diode_current"].at([1.1e-3, 1.8e-3]) == pytest.approx([0, 4])
    m = supplied(hb.Submodel("electrical.chopper", inputs={"gate": "time < 1 [ms]"}))
    m.add(coil=hb.Submodel("electrical.inductor", L="10 mH"), e=hb.Se("40 V"), x=hb.Zero())
    m.bond("x -> coil.plus", "coil.minus -> e")
    for way in every_way(m, "hot - q.plus", "q.out - x", "cold - q.minus")[::7]:
        run = hb.simulate(way, until="4 ms")
        # up by 60 V for 1 ms, down by 40 V to zero, and there it stays: no current flows backward
        assert run["coil.current"].at([1e-3, 2e-3, 3e-3]) == pytest.approx([6, 2, 0], abs=1e-9)
        assert run["q.voltage"].at(3e-3) == pytest.approx(40)


def test_an_asymmetric_bridge_drives_frees_and_takes_back() -> None:
    values = {"drop": 2, "R_on": 0.5, "diode_drop": 1, "R_diode": 0.25}
    inputs = {"upper_gate": "time < 1 [ms]", "lower_gate": "time < 2 [ms]"}
    m = supplied(hb.Submodel("electrical.asymmetric_bridge", **values, inputs=inputs))
    m.add(load=hb.Submodel("electrical.current_source", I=4), x=hb.Zero(), y=hb.Zero())
    m.bond("x -> load.plus", "load.minus -> y")
    for way in every_way(m, *SUPPLY, "q.a - x", "q.b - y")[::5]:
        run = hb.simulate(way, until="3 ms")
        switch, diode = 2 + 0.5 * 4, 1 + 0.25 * 4
        expected = [100 - 2 * switch, -switch - diode, -100 - 2 * diode]
        assert run["q.voltage"].at([0.5e-3, 1.5e-3, 2.5e-3]) == pytest.approx(expected), way.name
        assert run["q.current_in"].at([0.5e-3, 1.5e-3, 2.5e-3]) == pytest.approx([4, 0, -4])
        assert run["q.current"].at(2.5e-3) == pytest.approx(4)
