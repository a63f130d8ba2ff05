"""Junction laws where rounding is all there is: from rest, and at exactly natural commutation."""

from __future__ import annotations

import math

import pytest
from engine.by_engine import ENGINE
from library.bench import every_way
from library.test_electrical_bridges import LINES, PEAK, three_phases

import hybond as hb


@pytest.mark.parametrize("method", ["rk45", "radau"])
def test_a_bridge_with_drops_begins_to_charge_from_nothing(method: str) -> None:
    """No energy is there to measure rounding by, when two diodes begin to conduct at once."""
    m = hb.Model("rectifier", domain="electrical")
    m.add(s=hb.Submodel("electrical.sine_voltage", amplitude="17 V"), p=hb.Zero(), n=hb.Zero())
    m.add(b=hb.Submodel("electrical.diode_bridge", drop="0.7 V"))
    m.add(c=hb.Submodel("electrical.capacitor", C="1 mF"), zero=hb.Submodel("electrical.ground"))
    m.bond("p -> c.plus", "c.minus -> n", "zero.pin -> n")
    lines = ("s.plus - b.a", "s.minus - b.b", "b.plus - p", "n - b.minus")
    for way in every_way(m, *lines)[::5]:
        run = hb.simulate(way, until="4 ms", solver=method, engine=ENGINE)
        assert run.events[1].t == pytest.approx(math.asin(1.4 / 17) / (100 * math.pi), rel=1e-9)
        for t in (1e-3, 4e-3):
            expected = 17 * math.sin(100 * math.pi * t) - 1.4
            assert run["c.voltage"].at(t) == pytest.approx(expected, rel=1e-9)


def test_a_thyristor_bridge_commutates_where_voltages_cross() -> None:
    """Fired at angle 0 a current begins whose rate is the rounding of voltages that cancel."""
    m = three_phases(hb.Submodel("electrical.thyristor_bridge"))
    m.add(f=hb.Submodel("control.six_pulse", inputs={"alpha": 0.0}))
    gates = {f"gate_{k}": f"f.gate_{k}" for k in range(1, 7)}
    m.elements["b"] = hb.Submodel("electrical.thyristor_bridge", inputs=gates)
    m.add(load=hb.Submodel("electrical.inductor", L="0.5 H", i0=10), r=hb.Zero())
    m.add(loss=hb.Submodel("electrical.resistor", R=PEAK * 10))
    m.bond("p -> load.plus", "load.minus -> r -> loss.plus", "loss.minus -> n")
    for way in every_way(m, *LINES)[::16]:
        run = hb.simulate(way, until="60 ms", rtol=1e-9, engine=ENGINE)
        mean = (run["area"].at(0.06) - run["area"].at(0.04)) / 0.02
        assert mean == pytest.approx(PEAK * 100, rel=1e-6), way.name


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_what_breaks_loose_at_its_limit_is_not_decided_by_dust(solver: str) -> None:
    """The limit is a force of contact, found from differences to ten digits and watched to twelve.

    Between the two the laws still let it stick; asked whether it stands, sticking does not. What
    was asked next was the rounding of velocities that are zero: the contact opened for 1e-14 s.
    """
    seen = set()
    for rtol in (1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12):
        m = hb.load("examples/woodpecker.toml")
        run = hb.simulate(m, 0.1, solver=solver, rtol=rtol, engine=ENGINE)
        fired = [f for event in run.events for step in event.steps for f in step.fired]
        seen.add(tuple((f.machine, f.source, f.target) for f in fired))
    assert len(seen) == 1


def test_a_flow_that_least_leakage_shares_is_no_violation_where_it_begins_from_rest() -> None:
    """An open transformer takes what an OFF junction is sent: rounding, when slip begins."""
    m = hb.Model("open")
    m.add(s=hb.Se("sin(3*time)"), push=hb.Se(0.3), r=hb.R(1.7), other=hb.R(0.9))
    m.add(rub=hb.One(law="coulomb", limit=0.5), gate=hb.Zero(), t=hb.TF(0.743), end=hb.One())
    m.bond("s -> rub", "push -> rub", "rub -> r", "rub -> other", "gate -> rub")
    m.bond("t.1 -> gate", "t.2 -> end")
    m.machine(
        "m", states={"off": [], "on": ["gate"]}, start="off", rules=["off -> on when time > 9"]
    )
    run = hb.simulate(m, 0.5, engine=ENGINE)
    assert run.events[1].t == pytest.approx(math.asin(0.2) / 3.0, rel=1e-9)
    for t in (0.1, 0.3, 0.45):
        slip = (math.sin(3.0 * t) + 0.3 - 0.5) / 2.6
        assert run['"t.1 -> gate".f'].at(t) == pytest.approx(slip, rel=1e-9)
        assert run['"t.2 -> end".f'].at(t) == pytest.approx(-0.743 * slip, rel=1e-9)


DENORMAL = {
    "friction": hb.One(law="coulomb", limit=0.05),
    "diode": hb.One(law="diode"),
    "relay": hb.One(law="relay", limit=0.05),
    "gyrators": hb.One(law="coulomb", limit=0.05),
}


@pytest.mark.parametrize("kind", DENORMAL)
def test_levers_that_pass_on_the_last_bits_of_what_is_denormal(kind: str) -> None:
    """1e-321 of a speed: how far a law moves it, no finite step shows, and nothing else is moved.

    The mass in front dies away as if alone; the one behind is as slow as numbers can say.
    """
    m = hb.Model("denormal")
    m.add(x=hb.I(1.0, p=0.5), v=hb.One(), r=hb.R(0.5), z=hb.Zero())
    m.add(y=hb.I({"f": "1.3*sinh(p)"}, p=0.1), k=DENORMAL[kind])
    if kind == "gyrators":
        m.add(a=hb.GY(1e-160), b=hb.GY(1e161))
    else:
        m.add(a=hb.TF(1e-160), b=hb.TF(1e-161))
    m.bond("v -> x", "v -> r", "v -> a -> z -> b -> k -> y")
    run = hb.simulate(m, 1.0, engine=ENGINE)
    assert run["x.p"].at(1.0) == pytest.approx(0.5 * math.exp(-0.5), rel=1e-8)
    slow = 1e-321 * 0.5 * math.exp(-0.5) / 1.3
    assert run["y.p"].at(1.0) == pytest.approx(slow, rel=0.0, abs=1e-323)
    assert run.audit().holds()
