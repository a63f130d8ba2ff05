"""Bridges, legs and amplifiers against closed forms, with the bonds at their ports both ways."""

import math

import numpy as np
import pytest
from library.bench import every_way

import hybond as hb

PEAK = 3 * math.sqrt(3) / math.pi


def phase(k: int, t: float) -> float:
    return 100 * math.sin(100 * math.pi * t - 2 * math.pi * k / 3)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("drop", "bulk"), [(0.0, 0.0), (0.7, 0.5)])
def test_a_bridge_of_four_diodes_rectifies(drop: float, bulk: float) -> None:
    m = hb.Model("rectifier", domain="electrical")
    m.add(s=hb.Submodel("electrical.sine_voltage", amplitude=20), p=hb.Zero(), n=hb.Zero())
    m.add(b=hb.Submodel("electrical.diode_bridge", drop=drop, R_on=bulk))
    m.add(load=hb.Submodel("electrical.resistor", R=4), zero=hb.Submodel("electrical.ground"))
    m.bond("p -> load.plus", "load.minus -> n", "zero.pin -> n")
    ways = every_way(m, "s.plus - b.a", "s.minus - b.b", "b.plus - p", "n - b.minus")
    for way in ways if drop else ways[::5]:
        run = hb.simulate(way, until="20 ms")
        for t in (0.003, 0.005, 0.0101, 0.015):
            volts = 20 * math.sin(100 * math.pi * t)
            amperes = max(abs(volts) - 2 * drop, 0) / (4 + 2 * bulk)
            assert run["load.current"].at(t) == pytest.approx(amperes, abs=1e-9), way.name
            assert run["b.current"].at(t) == pytest.approx(amperes, abs=1e-9)
            assert run["b.current_in"].at(t) == pytest.approx(math.copysign(amperes, volts))
            assert run["b.voltage_in"].at(t) == pytest.approx(volts)
            assert run["b.voltage"].at(t) == pytest.approx(4 * amperes, abs=1e-9)


def three_phases(bridge: object) -> hb.Model:
    m = hb.Model("rectifier", domain="electrical")
    m.add(s=hb.Submodel("electrical.three_phase_source", amplitude=100), star=hb.Zero())
    m.add(zero=hb.Submodel("electrical.ground"), b=bridge, p=hb.Zero(), n=hb.Zero())
    m.bond("star -> s.neutral", "zero.pin -> star")
    m.signal(area=hb.Integral("b.voltage"))
    return m


LINES = ("s.a - b.a", "s.b - b.b", "s.c - b.c", "b.plus - p", "n - b.minus")


@pytest.mark.slow
def test_a_three_phase_bridge_gives_what_is_between_the_highest_and_the_lowest() -> None:
    m = three_phases(hb.Submodel("electrical.three_phase_bridge"))
    m.add(load=hb.Submodel("electrical.resistor", R=10))
    m.bond("p -> load.plus", "load.minus -> n")
    for way in every_way(m, *LINES):
        run = hb.simulate(way, until="20 ms", rtol=1e-10)
        for t in (0.001, 0.0072, 0.0135):
            volts = [phase(k, t) for k in range(3)]
            span = max(volts) - min(volts)
            assert run["b.voltage"].at(t) == pytest.approx(span, rel=1e-9), way.name
            assert run["b.current"].at(t) == pytest.approx(span / 10, rel=1e-9)
            for k, name in enumerate("abc"):
                sign = (volts[k] == max(volts)) - (volts[k] == min(volts))
                expected = sign * span / 10
                assert run[f"b.current_{name}"].at(t) == pytest.approx(expected, abs=1e-9)
        assert run["area"].at(0.02) / 0.02 == pytest.approx(PEAK * 100, rel=1e-8)
        assert len([e for e in run.events if e.cause == "guard"]) == 6


@pytest.mark.sampled(1)
@pytest.mark.parametrize("degrees", [0, 30, 75])
def test_a_thyristor_bridge_has_the_mean_voltage_of_its_angle(degrees: float) -> None:
    # a current that does not pause: a source of it stands for a large inductance
    m = three_phases(hb.Submodel("electrical.thyristor_bridge"))
    m.add(f=hb.Submodel("control.six_pulse", inputs={"alpha": math.radians(degrees)}))
    gates = {f"gate_{k}": f"f.gate_{k}" for k in range(1, 7)}
    m.elements["b"] = hb.Submodel("electrical.thyristor_bridge", inputs=gates)
    m.add(load=hb.Submodel("electrical.inductor", L="0.5 H", i0=10), r=hb.Zero())
    m.add(loss=hb.Submodel("electrical.resistor", R=PEAK * 10 * math.cos(math.radians(degrees))))
    m.bond("p -> load.plus", "load.minus -> r -> loss.plus", "loss.minus -> n")
    for way in every_way(m, *LINES)[: 2 if degrees == 30 else 1]:
        run = hb.simulate(way, until="60 ms", rtol=1e-9)
        mean = (run["area"].at(0.06) - run["area"].at(0.04)) / 0.02
        expected = PEAK * 100 * math.cos(math.radians(degrees))
        assert mean == pytest.approx(expected, rel=1e-6), way.name


@pytest.mark.slow
def test_a_leg_with_an_inductive_load_has_the_mean_of_its_duty() -> None:
    m = hb.Model("leg", domain="electrical")
    m.add(V=hb.Se("100 V"), hot=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), x=hb.Zero())
    m.add(pwm=hb.Submodel("control.pulse", period="1 ms", duty=0.3))
    gates = {"upper": "pwm.out", "lower": "1 - pwm.out"}
    m.add(leg=hb.Submodel("electrical.half_bridge", inputs=gates))
    # on the periodic current: `bottom` at the begin of a pulse, `top` at its end
    rise, fall = math.exp(-0.3e-3 * 500), math.exp(-0.7e-3 * 500)
    top = 20 * (1 - rise) / (1 - rise * fall)
    bottom = top * fall
    m.add(l=hb.Submodel("electrical.inductor", L="10 mH", i0=bottom))
    m.add(r=hb.Submodel("electrical.resistor", R=5))
    m.bond("V -> hot", "zero -> cold", "x -> l.plus", "l.minus -> r.plus", "r.minus -> cold")
    for way in every_way(m, "hot - leg.plus", "leg.out - x", "cold - leg.minus"):
        run = hb.simulate(way, until="3 ms", rtol=1e-10)
        found = run["leg.current"].at([0.3e-3, 1e-3, 2.3e-3, 3e-3])
        assert found == pytest.approx([top, bottom, top, bottom], rel=1e-8), way.name
        assert run["leg.voltage"].at([2.1e-3, 2.5e-3]).tolist() == [100, 0]
        assert run["leg.current_upper"].at(2.1e-3) == run["l.current"].at(2.1e-3)
        assert run["leg.current_lower"].at(2.5e-3) == -run["l.current"].at(2.5e-3)


@pytest.mark.slow
def test_in_the_dead_time_of_a_leg_its_diodes_carry_the_current() -> None:
    m = hb.Model("leg", domain="electrical")
    m.add(V=hb.Se("100 V"), hot=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), x=hb.Zero())
    m.add(dead=hb.Submodel("control.dead_time", T="10 us", inputs={"command": "pwm"}))
    gates = {"upper": "dead.upper", "lower": "dead.lower"}
    m.add(leg=hb.Submodel("electrical.half_bridge", diode_drop=1, inputs=gates))
    m.input(pwm=hb.Input(pwm={"period": "1 ms", "duty": 0.5}))
    m.add(load=hb.Submodel("electrical.current_source"), back=hb.Submodel("electrical.resistor"))
    m.bond("V -> hot", "zero -> cold", "x -> load.plus", "load.minus -> back.plus")
    m.bond("back.minus -> cold")
    # what is on carries the current of its own direction, else the diode at the same rail does
    for amperes, expected in ((3, [-1, 100, -1, -1]), (-3, [101, 101, 101, 0])):
        m.elements["load"] = hb.Submodel("electrical.current_source", I=amperes)
        for way in every_way(m, "hot - leg.plus", "leg.out - x", "cold - leg.minus")[::7]:
            run = hb.simulate(way, until="2 ms")
            found = run["leg.voltage"].at([1.005e-3, 1.3e-3, 1.505e-3, 1.8e-3])
            assert found == pytest.approx(expected), way.name
            assert run["leg.current"].at(1.3e-3) == pytest.approx(amperes)


def inverting(part: object, r1: float, r2: float, volts: str) -> hb.Model:
    """An amplifier with its plus input grounded, `r1` before and `r2` around its minus input."""
    m = hb.Model("amplifier", domain="electrical")
    m.add(V=hb.Se(volts), hot=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), n=hb.Zero(), y=hb.Zero())
    m.add(r1=hb.Submodel("electrical.resistor", R=r1), u=part)
    m.add(r2=hb.Submodel("electrical.resistor", R=r2))
    m.bond("V -> hot -> r1.plus", "r1.minus -> n -> r2.plus", "r2.minus -> y", "zero -> cold")
    return m


PINS = ("cold - u.plus", "n - u.minus", "u.out - y", "u.ground - cold")


@pytest.mark.sampled(1)
@pytest.mark.parametrize("gain", [1e6, 10.0])
def test_an_inverting_amplifier_has_the_gain_of_its_resistors(gain: float) -> None:
    part = hb.Submodel("electrical.op_amp_ideal", gain=gain)
    for way in every_way(inverting(part, 1000, 5000, "2 V"), *PINS)[:: 1 if gain == 10 else 5]:
        run = hb.simulate(way, until=1)
        expected = -2 * 5 / (1 + 6 / gain)
        assert run["u.voltage"].at(0.5) == pytest.approx(expected, rel=1e-9), way.name
        assert run["u.difference"].at(0.5) == pytest.approx(expected / gain, rel=1e-6)
        assert run["u.current"].at(0.5) == pytest.approx(
            (expected + expected / gain) / 5000, rel=1e-6
        )


def test_an_amplifier_settles_with_its_closed_loop_bandwidth() -> None:
    part = hb.Submodel("electrical.op_amp", gain=1e5, unity_gain="1 MHz", R_out=50)
    for way in every_way(inverting(part, 1000, 5000, "1 V"), *PINS)[::3]:
        run = hb.simulate(way, until="5 us", rtol=1e-9, atol=1e-12)
        # the output is loaded by r1 + r2 through R_out; the feedback is a divider
        out = 6000 / 6050
        back = 1000 / 6050
        rate = 2 * math.pi * 1e6 * (back + 1e-5)
        drive = 2 * math.pi * 1e6 * 5050 / 6050  # at minus with the source voltage inside at 0
        t = 1e-6
        inside = -drive / rate * (1 - math.exp(-rate * t))
        assert run["u.inside"].at(t) == pytest.approx(inside, rel=1e-7), way.name
        expected = inside * out + 50 / 6050
        assert run["u.voltage"].at(t) == pytest.approx(expected, rel=1e-6)


def test_an_amplifier_stops_at_its_limits_and_comes_back_at_once() -> None:
    part = hb.Submodel("electrical.op_amp", low="-10 V", high="12 V")
    m = inverting(part, 1000, 5000, "v")
    m.input(v=hb.Input(table=[(0, "-1 V"), ("1 ms", "-8 V"), ("2 ms", "8 V"), ("3 ms", "1 V")]))
    for way in every_way(m, *PINS)[::5]:
        run = hb.simulate(way, until="4 ms")
        found = run["u.voltage"].at([0.9e-3, 1.9e-3, 2.9e-3, 3.9e-3])
        assert found == pytest.approx([5, 12, -10, -5], rel=1e-3), way.name


@pytest.mark.parametrize(("low", "high", "stays"), [(4, 5, 4), (-5, -1, -1), (1, 5, 3)])
def test_an_amplifier_starts_within_its_limits(low: float, high: float, stays: float) -> None:
    """A follower of 3 V on one supply; one of its limits is 0 V or beyond."""
    m = hb.Model("follower", domain="electrical")
    m.add(amp=hb.Submodel("electrical.op_amp", low=low, high=high), zero=hb.Zero())
    m.add(u=hb.Submodel("electrical.voltage_source", U=3), earth=hb.Submodel("electrical.ground"))
    m.bond("u.plus -> amp.plus", "u.minus -> zero", "earth.pin -> zero", "amp.ground -> zero")
    m.bond("amp.out -> amp.minus")
    run = hb.simulate(m, until="0.1 ms")
    assert run["amp.voltage"].at(1e-4) == pytest.approx(stays, rel=1e-4)
    assert low <= run["amp.voltage"].at(0) <= high


def test_an_integrator_of_an_amplifier_and_a_capacitor_integrates() -> None:
    part = hb.Submodel("electrical.op_amp_ideal", gain=1e8)
    m = inverting(part, 1e4, 1, "2 V")
    m.elements["r2"] = hb.Submodel("electrical.capacitor", C="1 uF")
    for way in every_way(m, *PINS)[::5]:
        run = hb.simulate(way, until="10 ms", rtol=1e-9)
        volts = np.array([run["u.voltage"].at(t) for t in (0.002, 0.01)])
        assert volts == pytest.approx(-2 * np.array([0.002, 0.01]) / 0.01, rel=1e-5), way.name
