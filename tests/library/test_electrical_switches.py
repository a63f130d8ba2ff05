"""Diodes, transistors, switches and fuses against closed forms, bonds at their ports both ways."""

import math

import pytest
from library.bench import every_way

import hybond as hb

MAINS = "10 [V]*sin(100*pi*time)"


def in_series(volts: str, part: object, *, ohms: float = 5.0, **inputs: object) -> hb.Model:
    """A source, the part `p` from the node `hot` to `out`, a resistor from there to ground."""
    m = hb.Model("bench", domain="electrical")
    m.add(V=hb.Se(volts), hot=hb.Zero(), out=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), p=part)
    m.add(load=hb.Submodel("electrical.resistor", R=ohms))
    m.bond("V -> hot", "out -> load.plus", "load.minus -> cold", "zero -> cold")
    m.input(**inputs)
    return m


def both_ends(m: hb.Model) -> list[hb.Model]:
    return every_way(m, "hot - p.plus", "p.minus - out")


def pulses(*edges: tuple[float, float]) -> hb.Input:
    return hb.Input(table=[(0, 0), *edges])


@pytest.mark.parametrize(
    ("values", "low", "high"),
    [({}, -5.1, 0.7), ({"drop": 0, "breakdown": 0}, 0, 0), ({"drop": 1, "breakdown": 2}, -2, 1)],
)
def test_a_zener_diode_clips_on_both_sides(
    values: dict[str, float], low: float, high: float
) -> None:
    m = hb.Model("clipper", domain="electrical")
    m.add(V=hb.Se(MAINS), i=hb.One(), rs=hb.R("100 ohm"), n=hb.Zero(), cold=hb.Zero())
    m.add(zero=hb.Se(0), z=hb.Submodel("electrical.zener", **values))
    m.bond("V -> i -> n", "i -> rs", "zero -> cold")
    for way in every_way(m, "n - z.plus", "z.minus - cold"):
        run = hb.simulate(way, until="20 ms")
        for t in (0.0001, 0.005, 0.0101, 0.015):
            free = 10 * math.sin(100 * math.pi * t)
            clipped = min(max(free, low), high)
            assert run["z.voltage"].at(t) == pytest.approx(clipped, abs=1e-9), way.name
            assert run["z.current"].at(t) == pytest.approx((free - clipped) / 100, abs=1e-11)


def test_the_resistances_of_a_zener_diode_are_those_of_its_two_directions() -> None:
    part = hb.Submodel("electrical.zener", drop=1, breakdown=4, R_on=3, R_zener=7)
    for way in both_ends(in_series(MAINS, part)):
        run = hb.simulate(way, until="20 ms")
        assert run["p.current"].at(0.005) == pytest.approx(9 / 8, rel=1e-9), way.name
        assert run["p.current"].at(0.015) == pytest.approx(-6 / 12, rel=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("degrees", [30, 90, 150])
@pytest.mark.parametrize(("drop", "bulk"), [(0.0, 0.0), (1.0, 2.0)])
def test_a_thyristor_conducts_from_its_firing_to_the_end_of_the_current(
    degrees: float, drop: float, bulk: float
) -> None:
    fires = degrees / 360 * 0.02
    part = hb.Submodel("electrical.thyristor", drop=drop, R_on=bulk, inputs={"gate": "g"})
    m = in_series(MAINS, part, g=pulses((fires, 1), (fires + 1e-4, 0)))
    m.signal(charge=hb.Integral("p.current"))
    for way in both_ends(m):
        run = hb.simulate(way, until="20 ms", rtol=1e-10, atol=1e-13)
        w, end = 100 * math.pi, math.pi - math.asin(drop / 10)
        start = math.radians(degrees)
        area = (10 * (math.cos(start) - math.cos(end)) - drop * (end - start)) / (w * (5 + bulk))
        assert run["charge"].at(0.02) == pytest.approx(area, rel=1e-8), way.name
        assert run["p.conducting"].at([fires - 1e-5, fires + 1e-5, 0.015]).tolist() == [0, 1, 0]
        assert run["p.voltage"].at(0.015) == pytest.approx(-10, rel=1e-9)


def test_a_triac_conducts_both_ways_after_each_firing() -> None:
    part = hb.Submodel("electrical.triac", inputs={"gate": "g"})
    m = in_series(MAINS, part, g=hb.Input(pwm={"period": 0.01, "duty": 0.02, "phase": 0.0025}))
    for way in both_ends(m):
        run = hb.simulate(way, until="20 ms")
        peak = [run["p.current"].at(t) for t in (0.002, 0.005, 0.0099, 0.012, 0.015)]
        on = 2 * math.sin(0.99 * math.pi)
        assert peak == pytest.approx([0, 2, on, 0, -2], abs=1e-9), way.name


def test_a_gto_is_turned_on_and_off_by_its_gate_and_keeps_what_it_was_told() -> None:
    part = hb.Submodel("electrical.gto", drop=1, R_on=4, inputs={"gate": "g"})
    gate = pulses((1, 1), (2, 0), (3, -1), (4, 0), (5, 1), (6, 0))
    for way in both_ends(in_series("10 V", part, g=gate)):
        run = hb.simulate(way, until=7)
        found = [run["p.current"].at(k + 0.5) for k in range(7)]
        assert found == pytest.approx([0, 1, 1, 0, 0, 1, 1], abs=1e-12), way.name
        assert run["p.conducting"].at([2.5, 3.5, 4.5]).tolist() == [1, 0, 0]


def test_a_gto_blocks_when_its_current_ends_and_waits_for_the_gate() -> None:
    part = hb.Submodel("electrical.gto", inputs={"gate": "g"})
    m = in_series(MAINS, part, g=pulses((0.002, 1), (0.003, 0)))
    for way in both_ends(m):
        run = hb.simulate(way, until="30 ms")
        assert run["p.current"].at([0.001, 0.005, 0.015, 0.025]) == pytest.approx([0, 2, 0, 0])


@pytest.mark.parametrize(("drop", "bulk"), [(0.0, 0.0), (0.5, 5.0)])
def test_a_transistor_passes_one_way_while_its_gate_is_on(drop: float, bulk: float) -> None:
    part = hb.Submodel("electrical.transistor", drop=drop, R_on=bulk, inputs={"gate": "g"})
    for way in both_ends(in_series(MAINS, part, g=pulses((0.02, 1)))):
        run = hb.simulate(way, until="40 ms")
        peak = (10 - drop) / (5 + bulk)
        found = [run["p.current"].at(t) for t in (0.005, 0.015, 0.025, 0.035)]
        assert found == pytest.approx([0, 0, peak, 0], abs=1e-9), way.name


def test_an_igbt_passes_backward_through_its_diode_whatever_the_gate() -> None:
    part = hb.Submodel(
        "electrical.igbt", drop=1, R_on=4, diode_drop=2, R_diode=3, inputs={"gate": "g"}
    )
    for way in both_ends(in_series(MAINS, part, g=pulses((0.02, 1)))):
        run = hb.simulate(way, until="40 ms")
        found = [run["p.current"].at(t) for t in (0.005, 0.015, 0.025, 0.035)]
        assert found == pytest.approx([0, -1, 1, -1], abs=1e-9), way.name
        assert run["p.diode_current"].at(0.015) == pytest.approx(1, abs=1e-9)


def test_the_channel_of_a_mosfet_relieves_its_body_diode() -> None:
    part = hb.Submodel("electrical.mosfet", R_on=0.1, diode_drop=0.7, inputs={"gate": "g"})
    for way in both_ends(in_series(MAINS, part, g=pulses((0.02, 1)))):
        run = hb.simulate(way, until="40 ms")
        found = [run["p.current"].at(t) for t in (0.005, 0.015, 0.025, 0.035)]
        assert found == pytest.approx([0, -9.3 / 5, 10 / 5.1, -10 / 5.1], abs=1e-9), way.name
        assert run["p.diode_current"].at(0.035) == 0


def test_the_channel_of_a_mosfet_without_any_drop_takes_all_while_it_conducts() -> None:
    part = hb.Submodel("electrical.mosfet", R_on=0, diode_drop=0, inputs={"gate": "g"})
    for way in both_ends(in_series(MAINS, part, g=pulses((0.02, 1)))):
        run = hb.simulate(way, until="40 ms")
        found = [run["p.current"].at(t) for t in (0.005, 0.015, 0.025, 0.035)]
        assert found == pytest.approx([0, -2, 2, -2], abs=1e-9), way.name
        assert run["p.diode_current"].at([0.015, 0.035]) == pytest.approx([2, 0], abs=1e-9)


@pytest.mark.parametrize("bulk", [0.0, 1.0])
def test_a_changeover_switch_charges_and_discharges_a_capacitor(bulk: float) -> None:
    m = hb.Model("bench", domain="electrical", parameters={"T": 0.002})
    m.add(V=hb.Se("5 V"), hot=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0))
    m.add(p=hb.Submodel("electrical.changeover_switch", R_on=bulk, inputs={"gate": "time < T"}))
    m.add(n=hb.Zero(), r=hb.Submodel("electrical.resistor", R=9))
    m.add(c=hb.Submodel("electrical.capacitor", C="100 uF"))
    m.bond("V -> hot", "zero -> cold", "n -> r.plus", "r.minus -> c.plus", "c.minus -> cold")
    for way in every_way(m, "n - p.common", "p.work - hot", "p.rest - cold"):
        run = hb.simulate(way, until="4 ms", rtol=1e-10)
        tau = (9 + bulk) * 1e-4
        top = 5 * (1 - math.exp(-0.002 / tau))
        assert run["c.voltage"].at(0.002) == pytest.approx(top, rel=1e-8), way.name
        left = top * math.exp(-0.001 / tau)
        assert run["c.voltage"].at(0.003) == pytest.approx(left, rel=1e-8)
        assert run["p.current_rest"].at(0.003) == pytest.approx(left / (9 + bulk), rel=1e-7)
        assert run["p.current_work"].at(0.003) == 0


def test_a_relay_attracts_and_lets_go_at_its_two_currents() -> None:
    m = in_series("10 V", hb.Submodel("electrical.relay"))
    m.add(coil=hb.Se("u"), c=hb.Zero())
    m.bond("coil -> c")
    m.input(u=hb.Input(table=[(0, "12 V"), (0.01, 0)]))
    ways = every_way(m, "hot - p.plus", "p.minus - out", "c - p.coil_plus", "p.coil_minus - cold")
    for way in ways:
        run = hb.simulate(way, until="20 ms", rtol=1e-11, atol=1e-13)
        tau = 0.1 / 100
        top = 0.12 * (1 - math.exp(-0.01 / tau))
        times = [e.t for e in run.events if e.cause == "guard"]
        on, off = -tau * math.log(1 - 0.05 / 0.12), 0.01 + tau * math.log(top / 0.02)
        assert times == pytest.approx([on, off], rel=1e-8), way.name
        assert run["p.current"].at([0.0001, 0.005, 0.019]).tolist() == [0, 2, 0]
        assert run["p.closed"].at([0.0001, 0.005, 0.019]).tolist() == [0, 1, 0]


@pytest.mark.parametrize("ohms", [0.0, 1.0])
def test_a_fuse_melts_after_its_integral_and_stays_open(ohms: float) -> None:
    for way in both_ends(in_series("10 V", hb.Submodel("electrical.fuse", R=ohms, I2t=6), ohms=4)):
        run = hb.simulate(way, until=10)
        melts = 6 / (10 / (4 + ohms)) ** 2
        (blown,) = [e.t for e in run.events if e.cause == "guard"]
        assert blown == pytest.approx(melts, rel=1e-10), way.name
        assert run["p.current"].at([melts / 2, 9]) == pytest.approx([10 / (4 + ohms), 0])
        assert run["p.blown"].at([melts / 2, 9]).tolist() == [0, 1]
        assert run["p.melting"].at(10) == pytest.approx(6, rel=1e-10)


def test_a_battery_discharges_by_an_exponential_and_keeps_energy() -> None:
    m = hb.Model("bench", domain="electrical")
    m.add(b=hb.Submodel("electrical.battery", U_empty=0, U_full=10, capacity=50, soc0=1, R=0.5))
    m.add(hot=hb.Zero(), cold=hb.Zero(), zero=hb.Se(0), load=hb.Submodel("electrical.resistor"))
    m.bond("hot -> load.plus", "load.minus -> cold", "zero -> cold")
    for way in every_way(m, "b.plus - hot", "b.minus - cold"):
        run = hb.simulate(way, until=10, rtol=1e-10)
        assert run["b.soc"].at(10) == pytest.approx(math.exp(-10 / 7.5), rel=1e-8), way.name
        assert run["b.current"].at(0) == pytest.approx(-10 / 1.5)
        assert run["b.heat"].at(0) == pytest.approx(0.5 * (10 / 1.5) ** 2)
        assert run.audit().energy < 1e-8


def test_a_battery_at_its_start_has_the_voltage_of_its_charge() -> None:
    m = hb.Model("bench", domain="electrical")
    m.add(b=hb.Submodel("electrical.battery"), n=hb.Zero(), g=hb.Submodel("electrical.ground"))
    m.add(v=hb.Submodel("electrical.voltage_sensor"))
    m.bond("b.plus -> v.plus", "v.minus -> n", "b.minus -> n", "g.pin -> n")
    run = hb.simulate(m, until=1)
    assert run["v.voltage"].at(1) == pytest.approx(11 + 0.8 * 2, rel=1e-12)
    assert run["b.soc"].at(1) == pytest.approx(0.8)


@pytest.mark.parametrize("position", [0.0, 0.25, 1.0, 1.7])
def test_a_potentiometer_divides_what_its_load_leaves(position: float) -> None:
    m = in_series("10 V", hb.Submodel("electrical.potentiometer", R=8, inputs={"position": "x"}))
    m.input(x=position)
    at = min(position, 1.0)
    for way in every_way(m, "hot - p.plus", "p.minus - cold", "p.tap - out"):
        run = hb.simulate(way, until=1)
        below = 8 * at * 5 / (8 * at + 5)
        volts = 10 * below / (below + 8 * (1 - at))
        assert run["p.tap_voltage"].at(0.5) == pytest.approx(volts, abs=1e-12), way.name
        assert run["p.tap_current"].at(0.5) == pytest.approx(volts / 5, abs=1e-12)


def test_a_variable_resistor_follows_its_input() -> None:
    part = hb.Submodel("electrical.variable_resistor", inputs={"resistance": "1 [ohm/s]*time"})
    for way in both_ends(in_series("10 V", part)):
        run = hb.simulate(way, until=5)
        for t in (0.0, 1.0, 4.0):
            assert run["p.current"].at(t) == pytest.approx(10 / (5 + t), rel=1e-12), way.name
            assert run["p.heat"].at(t) == pytest.approx(t * (10 / (5 + t)) ** 2, abs=1e-12)
