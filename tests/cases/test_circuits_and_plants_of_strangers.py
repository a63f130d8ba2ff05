"""Converters, relays, pumps and tanks in sequence, each against what it comes to by hand."""

import math

import numpy as np
import pytest

import hybond as hb

BOTH = pytest.mark.parametrize("solver", ["auto", "radau"])


def guards(run: hb.Result) -> list[float]:
    """Return the times of what happened after the start."""
    return [event.t for event in run.events[1:]]


@BOTH
def test_a_leg_with_dead_time_loses_what_its_diode_takes(solver: str) -> None:
    """Into R and L a current that stays positive is led by the lower diode in both dead times."""
    period, dead, up = 100e-6, 2e-6, 58e-6
    m = hb.Model("leg", domain="electrical")
    m.add(high=hb.Se("100 V"), low=hb.Se("-100 V"), p=hb.Zero(), n=hb.Zero(), a=hb.Zero())
    m.add(up=hb.One(), down=hb.One(), du=hb.One(law="diode"), dd=hb.One(law="diode"))
    m.add(i=hb.One(), L=hb.I("1 mH"), R=hb.R("2 ohm"))
    m.bond(
        "high -> p", "low -> n", "p -> up -> a", "a -> down -> n", "n -> dd -> a", "a -> du -> p"
    )
    m.bond("a -> i -> L", "i -> R")
    m.input(gu=hb.Input(pwm={"period": period, "duty": 0.58, "phase": dead}))
    m.input(gd=hb.Input(pwm={"period": period, "duty": 0.38, "phase": 0.6 * period + dead}))
    for name, gate, junction in (("U", "gu", "up"), ("D", "gd", "down")):
        rules = [f"off -> on when {gate} > 0.5", f"on -> off when {gate} < 0.5"]
        m.machine(name, states={"off": [], "on": [junction]}, start="off", rules=rules)

    def after(i: float, volts: float, t: float) -> float:
        return volts / 2 + (i - volts / 2) * math.exp(-t * 2000)

    i = 0.0
    for k in range(40):
        if k:
            i = max(after(i, -100, dead), 0.0)  # a diode lets no current turn
        i = after(after(after(i, 100, up), -100, dead), -100, 38e-6)
    run = hb.simulate(m, 40 * period, solver=solver)
    assert run["i.f"].at(40 * period, side="left") == pytest.approx(i, rel=1e-8)


@BOTH
def test_a_flyback_converter_empties_its_core_in_each_period(solver: str) -> None:
    volts, core, turns, C, R, duty, period = 24.0, 1e-4, 4.0, 220e-6, 5.0, 0.35, 20e-6
    m = hb.Model("flyback", domain="electrical")
    m.add(V=hb.Se(volts), S=hb.One(), p=hb.Zero(), core=hb.I(core), wound=hb.TF(-turns))
    m.add(d=hb.One(law="diode"), out=hb.Zero(), C=hb.C(C), R=hb.R(R))
    m.bond("V -> S -> p -> core", "p -> wound -> d -> out -> C", "out -> R")
    m.input(g=hb.Input(pwm={"period": period, "duty": duty}))
    rules = ["off -> on when g > 0.5", "on -> off when g < 0.5"]
    m.machine("Q", states={"off": [], "on": ["S"]}, start="on", rules=rules)
    rates, ways = np.linalg.eig(np.array([[0.0, -turns / core], [turns / C, -1 / (R * C)]]))

    def led(y: np.ndarray, t: float) -> np.ndarray:
        return (ways @ (np.exp(rates * t) * np.linalg.solve(ways, y))).real

    i, v, rest = 0.0, 0.0, (1 - duty) * period
    for _ in range(50):
        y = np.array([i + volts / core * duty * period, v * math.exp(-duty * period / (R * C))])
        a, b = 0.0, rest
        if led(y, rest)[0] < 0.0:
            for _ in range(60):  # where the current ends
                middle = 0.5 * (a + b)
                a, b = (middle, b) if led(y, middle)[0] > 0 else (a, middle)
        i, v = led(y, b)
        if b < rest:
            i, v = 0.0, v * math.exp(-(rest - b) / (R * C))
    run = hb.simulate(m, 50 * period, solver=solver)
    assert run["out.e"].at(50 * period, side="left") == pytest.approx(v, rel=1e-7)
    assert run["core.f"].at(50 * period, side="left") == pytest.approx(i, abs=1e-9)


@BOTH
def test_a_thyristor_goes_out_after_the_zero_of_its_line(solver: str) -> None:
    R, L, w, fired = 10.0, 0.05, 2 * math.pi * 50, math.radians(70)
    m = hb.Model("phase", domain="electrical", parameters={"w": w, "fired": fired})
    turned = "mod(w*time, 2*pi)"
    m.add(V=hb.Se("325*sin(w*time)"), R=hb.R(R), L=hb.I(L))
    m.add(th=hb.One(law="thyristor", gate=f"{turned} >= fired and {turned} < fired + 0.1"))
    m.bond("V -> th -> R", "th -> L")
    size, lag = 325 / math.hypot(R, w * L), math.atan2(w * L, R)

    def current(x: float) -> float:
        decay = math.exp(-(x - fired) * R / (w * L))
        return size * (math.sin(x - lag) - math.sin(fired - lag) * decay)

    a, b = math.pi, 2 * math.pi
    for _ in range(60):
        a, b = (0.5 * (a + b), b) if current(0.5 * (a + b)) > 0 else (a, 0.5 * (a + b))
    run = hb.simulate(m, 0.039, solver=solver)
    turn = 2 * math.pi
    found = [t * w for t in guards(run)]
    assert found == pytest.approx([fired, a, fired + turn, a + turn], rel=1e-8)
    assert run["L.f"].at(2.0 / w) == pytest.approx(current(2.0), rel=1e-7)


@BOTH
def test_a_buzzer_opens_its_own_contact(solver: str) -> None:
    volts, R, L, pulls, drops = 12.0, 10.0, 0.1, 0.8, 0.3
    m = hb.Model("buzzer", domain="electrical")
    m.add(V=hb.Se(volts), contact=hb.One(), n=hb.Zero(), i=hb.One(), R=hb.R(R), L=hb.I(L))
    m.add(ground=hb.Se(0), d=hb.One(law="diode"))
    m.bond("V -> contact -> n -> i -> R", "i -> L", "ground -> d -> n")
    rules = [f"rest -> pulled when i.f > {pulls}", f"pulled -> rest when i.f < {drops}"]
    m.machine("armature", states={"rest": ["contact"], "pulled": []}, start="rest", rules=rules)
    tau, end = L / R, volts / R
    times = [tau * math.log(end / (end - pulls))]
    for _ in range(4):
        times.append(times[-1] + tau * math.log(pulls / drops))
        times.append(times[-1] + tau * math.log((end - drops) / (end - pulls)))
    run = hb.simulate(m, times[-1] + 1e-4, solver=solver)
    assert guards(run) == pytest.approx(times, rel=1e-8)


@BOTH
def test_a_hydraulic_ram_lifts_by_closing_its_own_valve(solver: str) -> None:
    L, R, head, height, closes = 2e6, 1e7, 2e4, 2e5, 1e-3
    m = hb.Model("ram", domain="hydraulic", parameters={"closes": "1 L/s"})
    m.add(river=hb.Se(head), pipe=hb.I(L), rubs=hb.R(R), q=hb.One(), box=hb.Zero())
    m.add(waste=hb.One(), out=hb.Se(0), check=hb.One(law="diode"), top=hb.Se(height))
    m.bond("river -> q -> pipe", "q -> rubs", "q -> box -> waste -> out", "box -> check -> top")
    m.signal(lifted=hb.Integral("check.f"))
    rules = ["open -> shut when q.f >= closes", "shut -> open when check.f <= 0"]
    m.machine("valve", states={"open": ["waste"], "shut": []}, start="open", rules=rules)
    tau, back = L / R, (head - height) / R
    fills = -tau * math.log(1 - closes * R / head)
    lifts = tau * math.log((closes - back) / -back)
    stroke = back * lifts + (closes - back) * tau * (1 - math.exp(-lifts / tau))
    times = [k * (fills + lifts) + part for k in range(4) for part in (fills, fills + lifts)]
    run = hb.simulate(m, times[-1] + 0.01, solver=solver)
    assert guards(run) == pytest.approx(times, rel=1e-8)
    assert run["lifted"].at(run.t_end) == pytest.approx(4 * stroke, rel=1e-8)


@BOTH
def test_two_accumulators_fill_one_after_the_other(solver: str) -> None:
    """Isothermal, precharged with 20 and 40 bar: the second begins where the first has come to."""
    m = hb.Model("store", domain="hydraulic")
    m.add(pump=hb.Submodel("hydraulic.flow_source", inputs={"flow": "1e-4"}))
    m.add(tank=hb.Submodel("hydraulic.atmosphere"), n=hb.Zero())
    for name, litres, bar in (("a", 1, 20), ("b", 2, 40)):
        given = {"V_gas": f"{litres} L", "precharge": f"{bar} bar", "n": 1}
        m.add({name: hb.Submodel("hydraulic.accumulator", **given)})
    m.bond("tank.port -> pump.inlet", "pump.outlet -> n", "n -> a.port", "b.port -> n")
    one, two = 20e5 + 101325, 40e5 + 101325
    begins = 1e-3 * (1 - one / two) / 1e-4
    # 1e-3 (1 - one/p) + 2e-3 (1 - two/p) = 12 s of 0.1 L/s
    p = (1e-3 * one + 2e-3 * two) / (3e-3 - 1.2e-3)
    run = hb.simulate(m, 12.0, solver=solver)
    assert [t for t in guards(run) if t > 1e-3] == pytest.approx([begins], rel=1e-8)
    assert run["n.e"].at(12.0) == pytest.approx(p - 101325, rel=1e-8)


@BOTH
def test_a_batch_goes_through_its_sequence(solver: str) -> None:
    """Fill, heat to 350 K, hold for 120 s, drain by a root: all times in closed form."""
    m = hb.Model("batch")
    m.signal(
        h=hb.Integral(
            'if seq.state == "fill" then 0.01 else if seq.state == "drain" '
            "then -0.02*sqrt(max(h, 0)) else 0",
            start=0.05,
        ),
        T=hb.Integral('if seq.state == "heat" then 0.5 else -(T - 293)/500', start=293.0),
        clock=hb.Integral('if seq.state == "hold" then 1 else -clock*100'),
    )
    rules = ["fill -> heat when h >= 1", "heat -> hold when T >= 350"]
    rules += ["hold -> drain when clock >= 120", "drain -> fill when h <= 0.05"]
    states: dict[str, list[str]] = {"fill": [], "heat": [], "hold": [], "drain": []}
    m.machine("seq", states=states, start="fill", rules=rules)
    t, above, times = 0.0, 0.0, []
    for _ in range(3):
        above *= math.exp(-95 / 500)
        for lasts in (95.0, (57.0 - above) / 0.5, 120.0, 2 * (1 - math.sqrt(0.05)) / 0.02):
            t += lasts
            times.append(t)
        above = 57.0 * math.exp(-(120.0 + lasts) / 500)
    run = hb.simulate(m, times[-1] + 10, solver=solver)
    assert guards(run) == pytest.approx(times, rel=1e-7)
