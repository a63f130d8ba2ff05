"""Circuits of amplifiers with limits, slew rate and rails, against closed forms."""

import math
from itertools import pairwise

import numpy as np
import pytest
from library.bench import every_way

import hybond as hb

PINS = ("x - u.plus", "n - u.minus", "u.out - y", "u.ground - cold")
RAILS = ("x - u.plus", "n - u.minus", "u.out - y", "u.high - top", "u.low - bottom")


def around(part: hb.Submodel, volts: str, **resistors: tuple[float, str, str]) -> hb.Model:
    """An amplifier `u` with the source at `hot`, and resistors between nodes."""
    m = hb.Model("amplifier", domain="electrical")
    m.add(V=hb.Se(volts), zero=hb.Se(0), u=part)
    m.add(hot=hb.Zero(), cold=hb.Zero(), x=hb.Zero(), n=hb.Zero(), y=hb.Zero())
    m.bond("V -> hot", "zero -> cold")
    for name, (ohms, one, two) in resistors.items():
        m.add(**{name: hb.Submodel("electrical.resistor", R=ohms)})
        m.bond(f"{one} -> {name}.plus", f"{name}.minus -> {two}")
    return m


def with_rails(m: hb.Model, volts: float = 15.0) -> hb.Model:
    m.add(top=hb.Zero(), bottom=hb.Zero(), up=hb.Se(volts), down=hb.Se(-volts))
    m.bond("up -> top", "down -> bottom")
    return m


def test_a_non_inverting_amplifier_settles_with_its_bandwidth() -> None:
    """`unity_gain` divided by the gain: Sedra and Smith."""
    part = hb.Submodel("electrical.op_amp", gain=1e5, unity_gain="1 MHz")
    m = around(part, "0.5 V", r1=(1e3, "cold", "n"), r2=(9e3, "n", "y"))
    m.bond("hot -> x")
    for way in every_way(m, *PINS)[::5]:
        run = hb.simulate(way, until="20 us", rtol=1e-9, atol=1e-12)
        rate = 2 * math.pi * 1e6 * (0.1 + 1e-5)
        final = 0.5 / (0.1 + 1e-5)
        for t in (1e-6, 5e-6, 2e-5):
            expected = final * (1 - math.exp(-rate * t))
            assert run["u.voltage"].at(t) == pytest.approx(expected, rel=1e-7), way.name


def test_an_integrator_stops_at_the_limit_and_comes_back_without_delay() -> None:
    part = hb.Submodel("electrical.op_amp", gain=1e7, unity_gain="100 MHz", low=-5, high=5)
    m = around(part, "v", r=(1e4, "hot", "n"))
    m.add(c=hb.Submodel("electrical.capacitor", C="0.1 uF"))
    m.bond("n -> c.plus", "c.minus -> y", "cold -> x")
    m.input(v=hb.Input(table=[(0, -2), (4e-3, 2)]))
    for way in every_way(m, *PINS)[::15]:
        run = hb.simulate(way, until="6 ms", solver="radau")
        # 2 V/ms up to 5 V at 2.5 ms; the capacitor charges on through r to the input at rest
        assert run["u.voltage"].at([1e-3, 2e-3, 3e-3]) == pytest.approx([2, 4, 5], rel=1e-4)
        # the minus input is at v*(1 - exp(-t/RC)): until it is above zero the output stays
        away = -2 * (1 - math.exp(-1.5))
        back = 4e-3 + 1e-3 * math.log((2 - away) / 2)
        found = run["u.voltage"].at([back - 1e-4, back + 5e-4])
        assert found == pytest.approx([5, 4], rel=2e-4), way.name


def test_a_comparator_with_hysteresis_switches_at_its_two_thresholds() -> None:
    """A Schmitt trigger: the plus input is between the source and the output."""
    part = hb.Submodel("electrical.op_amp", gain=1e6, unity_gain="100 MHz", low=-12, high=12)
    m = around(
        part, "8 [V]*sin(100*pi*time)", r1=(1e3, "hot", "x"), r2=(3e3, "x", "y"), r=(1, "n", "cold")
    )
    for way in every_way(m, *PINS)[::15]:
        run = hb.simulate(way, until="40 ms")
        t = np.linspace(0.02, 0.04, 40001)
        out = run["u.voltage"].at(t)
        (up,), (down,) = ((np.flatnonzero(np.diff((s * out > 0).astype(int)) > 0)) for s in (1, -1))
        source = 8 * np.sin(100 * np.pi * t)
        # where the divider is at zero: 12 V*r1/r2, and the output takes its time to get across
        assert source[up] == pytest.approx(4, abs=0.01), way.name
        assert source[down] == pytest.approx(-4, abs=0.01)
        assert out.max() == pytest.approx(12) and out.min() == pytest.approx(-12)


def test_an_astable_multivibrator_has_the_period_of_its_charging() -> None:
    part = hb.Submodel("electrical.op_amp", gain=1e6, unity_gain="1 GHz", low=-10, high=10)
    m = around(part, "0 V", r1=(1e3, "x", "cold"), r2=(1e3, "x", "y"), r=(1e4, "y", "n"))
    m.add(c=hb.Submodel("electrical.capacitor", C="0.1 uF", v0="1 V"))
    m.bond("n -> c.plus", "c.minus -> cold")
    (way,) = every_way(m, *PINS)[:1]
    run = hb.simulate(way, until="12 ms")
    # events come in pairs: leaving a limit, arriving at the other one
    times = [e.t for e in run.events if e.cause == "guard"]
    turns = [b for a, b in pairwise(times) if b - a > 1e-5]
    periods = [b - a for a, b in zip(turns[1:], turns[3:], strict=False)]
    assert len(periods) >= 6
    assert periods == pytest.approx([2 * 1e-3 * math.log(3)] * len(periods), rel=1e-4)


def test_a_follower_slews_along_a_straight_line_and_then_settles() -> None:
    """It slews until what is left is `slew` over the rate of its pole."""
    part = hb.Submodel("electrical.op_amp_supplied", unity_gain="1 MHz", slew="0.5 V/us")
    m = with_rails(around(part, "8 V", load=(2e3, "y", "cold")))
    m.bond("hot -> x", "y -> n")
    rate = 2 * math.pi * 1e6
    knee = (8 - 0.5e6 / rate) / 0.5e6
    for way in every_way(m, *RAILS)[::3]:
        run = hb.simulate(way, until="20 us", rtol=1e-9, atol=1e-11)
        assert run["u.voltage"].at([4e-6, 1e-5]) == pytest.approx([2, 5], rel=1e-6), way.name
        t = knee + 2e-7
        left = 0.5e6 / rate * math.exp(-rate * 2e-7)
        assert run["u.voltage"].at(t) == pytest.approx(8 - left, rel=1e-4)


@pytest.mark.parametrize("volts", [6.0, -6.0])
def test_what_flows_out_comes_from_one_rail_and_what_flows_in_goes_to_the_other(
    volts: float,
) -> None:
    part = hb.Submodel("electrical.op_amp_supplied", slew="100 V/us", quiescent="2 mA", R_out=50)
    m = with_rails(around(part, f"{volts} [V]", load=(1e3, "y", "cold")))
    m.bond("hot -> x", "y -> n")
    for way in every_way(m, *RAILS)[::3]:
        run = hb.simulate(way, until="50 us")
        amperes = volts / 1e3
        assert run["u.current"].at(5e-5) == pytest.approx(amperes, rel=1e-4), way.name
        assert run["up.f"].at(5e-5) == pytest.approx(0.002 + max(amperes, 0), rel=1e-4)
        assert run["down.f"].at(5e-5) == pytest.approx(-0.002 + min(amperes, 0), rel=1e-4)
        power = 15 * run["up.f"].at(5e-5) - 15 * run["down.f"].at(5e-5) - volts * amperes
        assert run["u.heat"].at(5e-5) == pytest.approx(power, rel=1e-4)


def test_an_output_stops_short_of_its_rails_and_follows_a_rail_that_falls() -> None:
    part = hb.Submodel("electrical.op_amp_supplied", slew="10 V/us", headroom="1.5 V")
    m = around(part, "1 V", load=(1e3, "y", "cold"), r=(1, "n", "cold"))
    m.add(top=hb.Zero(), bottom=hb.Zero(), up=hb.Se("rail"), down=hb.Se(-10))
    m.input(rail=hb.Input(table=[(0, 10), (1e-3, 10), (2e-3, 6)], linear=True))
    m.bond("up -> top", "down -> bottom", "hot -> x")
    for way in every_way(m, *RAILS)[::3]:
        run = hb.simulate(way, until="3 ms", solver="radau")
        found = run["y.e"].at([0.9e-3, 1.5e-3, 2.9e-3])
        # the pole lets it lag behind a rail by 0.16 us, 2 V/ms of the room
        assert found == pytest.approx([8.5, 6.5, 4.5], abs=2e-3), way.name


@pytest.mark.parametrize("mismatch", [0.0, 0.01])
def test_an_instrumentation_amplifier_takes_the_difference(mismatch: float) -> None:
    m = hb.Model("bench", domain="electrical")
    m.add(q=hb.Submodel("electrical.instrumentation_amplifier", mismatch=mismatch, R_gain="2 kohm"))
    m.add(a=hb.Se("3.02 V"), b=hb.Se("3 V"), r=hb.Se("0.5 V"), ra=hb.Zero(), rb=hb.Zero())
    m.add(rr=hb.Zero(), y=hb.Zero(), load=hb.R("1 kohm"))
    m.bond("a -> ra", "b -> rb", "r -> rr", "y -> load")
    for way in every_way(m, "ra - q.plus", "rb - q.minus", "rr - q.ref", "q.out - y")[::3]:
        run = hb.simulate(way, until=1)
        # the outputs of the followers, and the difference amplifier behind them
        p, n = 3.01 + 0.01 * 11, 3.01 - 0.01 * 11
        k = 1 + mismatch
        plus = (p * k + 0.5) / (1 + k)
        assert run["y.e"].at(0.5) == pytest.approx(2 * plus - n, rel=1e-6), way.name
        if not mismatch:
            assert run["q.voltage"].at(0.5) == pytest.approx(0.02 * 11, rel=1e-5)
        assert run["a.f"].at(0.5) == pytest.approx(0, abs=1e-12)
