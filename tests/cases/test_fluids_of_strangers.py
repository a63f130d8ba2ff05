"""Fluids, nerves and melting bodies as strangers write them, in closed form, also begun late.

What begins at 1000 s is the same model with `time - 1000 s` for the time.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import hybond as hb

G = 9.81
Told = tuple[hb.Model, float, list[float], dict[str, tuple[list[float], list[float]]]]
"""A model, until when, the events, and what signals are at some times."""


def level_tanks(since: str) -> Told:
    """Two tanks joined by a sharp opening are level after a finite time, and stay so."""
    m = hb.Model("level", domain="hydraulic")
    m.add(a=hb.C("0.4 [m^2]/(9810 [Pa/m])", q="400 L"), b=hb.C("0.1 [m^2]/(9810 [Pa/m])"))
    m.add(na=hb.Zero(), nb=hb.Zero(), p=hb.One())
    m.add(o=hb.R({"f": "6 [cm^2]*sign(e)*sqrt(2*abs(e)/(1000 [kg/m^3]))"}))
    m.bond("na -> a", "nb -> b", "na -> p -> nb", "p -> o")
    rate = 6e-4 * math.sqrt(2 * G) * (1 / 0.4 + 1 / 0.1)
    t = [part * 2 / rate for part in (0.1, 0.5, 0.9, 0.99, 1.01, 1.5, 1.9)]
    falls = [max(1 - rate * x / 2, 0.0) ** 2 for x in t]
    return m, 4 / rate, [], {"b.q": (t, [0.08 * (1 - h) for h in falls])}


def neuron(since: str) -> Told:
    """It integrates, fires at 15 mV, and rests for 2 ms."""
    m = hb.Model("neuron", domain="electrical")
    m.add(I=hb.Sf("2 nA"), n=hb.Zero(), C=hb.C("2 nF"), R=hb.R("10 Mohm"))
    m.add(s=hb.One(), rest=hb.Se("0 V"))
    m.bond("I -> n -> C", "n -> R", "n -> s -> rest")
    m.signal(clock=hb.Integral('if spike.state == "resting" then 1 else -clock/(1 [us])'))
    rules = ["charging -> resting when n.e >= 15 [mV]", "resting -> charging when clock >= 2 [ms]"]
    m.machine("spike", states={"charging": [], "resting": ["s"]}, start="charging", rules=rules)
    charges = 20e-3 * math.log(20 / 5)
    times = [k * (charges + 2e-3) + part for k in range(4) for part in (charges, charges + 2e-3)]
    half = 20e-3 * (1 - math.exp(-0.5 * charges / 20e-3))
    return m, times[-1] + 1e-3, times, {"C.e": ([0.5 * charges], [half])}


def receiver(since: str) -> Told:
    """Air fills a vessel through a valve by ISO 6358: a line while it is choked, then a sine."""
    m = hb.Model("receiver", domain="hydraulic", parameters={"ps": "7 bar", "b": 0.3})
    m.add(S=hb.Se("ps"), q=hb.One(), n=hb.Zero(), tank=hb.C("20 [L]/(1 [bar])", e="1 bar"))
    flow = "120 [L/min]/(1 [bar])*ps*(if r < b then 1 else sqrt(max(1 - ((r - b)/(1 - b))^2, 0)))"
    m.add(valve=hb.R({"f": flow}))
    m.bond("S -> q -> n -> tank", "q -> valve")
    m.signal(r="n.e/ps")
    rate = 7 * 2.0 / 20.0  # bar each second
    chokes = (0.3 * 7 - 1) / rate
    w = rate / (7 * 0.7)
    t = [0.3, 1.2, 2.5, 5.0, chokes + 0.45 * math.pi / w, chokes + math.pi / w]
    bar = [
        1 + rate * x
        if x < chokes
        else 7 * (0.3 + 0.7 * math.sin(min(w * (x - chokes), math.pi / 2)))
        for x in t
    ]
    return m, t[-1], [], {"n.e": (t, [p * 1e5 for p in bar])}


def lift(since: str) -> Told:
    """Stiff oil: the relief valve is open while the ram starts, and where it is at its end."""
    m = hb.Model("lift", domain="hydraulic")
    m.add(pump=hb.Sf(f"if {since} < 3 [s] then 6 [L/min] else 0"), n=hb.Zero())
    m.add(relief=hb.One(law="diode"), holds=hb.Se("100 bar"), A=hb.TF("1/(20 [cm^2])"))
    m.add(v=hb.One(domain="translational"), M=hb.I("500 kg", domain="translational"))
    m.add(W=hb.Se(f"-500*{G} [N]", domain="translational"))
    stop = hb.Zero(law="unilateral", gap="100 [mm] - x", domain="translational")
    m.add(stop=stop)
    m.bond("pump -> n -> A -> v -> M", "n -> relief -> holds", "W -> v", "v -> stop")
    m.signal(x=hb.Integral("v.f"))
    speed, push = 1e-4 / 2e-3, (1e7 * 2e-3 - 500 * G) / 500
    starts = speed / push
    ends = starts + (0.1 - 0.5 * push * starts**2) / speed
    x = 0.5 * push * starts**2 + speed * (1 - starts)
    return m, 2.5, [starts, ends], {"x": ([1.0, 2.2], [x, 0.1])}


def two_pipes(since: str) -> Told:
    """One by its flow, one by its drop, and nothing between them that stores."""
    m = hb.Model("pipes", domain="hydraulic")
    m.add(a=hb.C("0.3 [m^2]/(9810 [Pa/m])", q="300 L"), b=hb.C("0.2 [m^2]/(9810 [Pa/m])"))
    m.add(A=hb.Zero(), B=hb.Zero(), P=hb.Zero(), first=hb.One(), second=hb.One())
    m.add(r1=hb.R({"e": "2e9 [Pa*s^2/m^6]*f*abs(f)"}))
    m.add(r2=hb.R({"f": "sign(e)*sqrt(abs(e)/(1e9 [Pa*s^2/m^6]))"}))
    m.bond("A -> a", "B -> b", "A -> first -> P -> second -> B", "first -> r1", "second -> r2")
    flow = 1 / math.sqrt(3e9)  # for a drop of 1 Pa
    stiff = 9810 * (1 / 0.3 + 1 / 0.2)
    lasts = 2 * math.sqrt(9810) / (stiff * flow)
    t = [part * lasts for part in (0.1, 0.5, 0.9, 1.1, 1.5)]
    filled = [(9810 - 9810 * max(1 - x / lasts, 0.0) ** 2) / stiff for x in t]
    return m, 1.6 * lasts, [], {"b.q": (t, filled)}


def pulses(since: str) -> Told:
    """A pump that is shut off by a valve lets the accumulator feed what is drawn in pulses."""
    m = hb.Model("pulses", domain="hydraulic")
    m.add(pump=hb.Se(f"if {since} < 2 [s] then 80 [bar] else 0"), check=hb.One(law="diode"))
    m.add(R=hb.R("2e9 Pa*s/m^3"), n=hb.Zero(), acc=hb.C("2e-9 m^3/Pa", e="40 bar"))
    m.add(draws=hb.Sf(f"if mod({since}, 1 [s]) < 0.25 [s] then -30 [L/min] else 0"))
    m.bond("pump -> check -> n -> acc", "check -> R", "draws -> n")
    p = 40e5
    shown = []
    for draw, feed, lasts in [(5e-4, 80e5, 0.25), (0.0, 80e5, 0.75)] * 2 + [(5e-4, 0.0, 0.25)]:
        rest = feed - 2e9 * draw
        # the source feeds as long as it is above
        p = rest + (p - rest) * math.exp(-lasts / 4) if feed else p - draw * lasts / 2e-9
        shown.append(p)
    return m, 2.5, [2.0], {"n.e": ([0.25, 1.0, 1.25, 2.0, 2.25], shown)}


MODELS: dict[str, Callable[[str], Told]] = {
    made.__name__: made for made in (level_tanks, neuron, receiver, lift, two_pipes, pulses)
}


@pytest.mark.parametrize(("begins", "solver"), [(0.0, "auto"), (1000.0, "auto"), (0.0, "radau")])
@pytest.mark.parametrize("name", MODELS)
def test_a_fluid_in_closed_form(name: str, begins: float, solver: str) -> None:
    m, until, events, shown = MODELS[name](f"(time - {begins} [s])" if begins else "time")
    run = hb.simulate(m, begins + until, solver=solver, start={"time": begins})
    assert run.audit().holds() and not run.warnings
    assert run.events.t[1:] - begins == pytest.approx(events, abs=1e-8 * until)
    for signal, (t, expected) in shown.items():
        size = 1e-6 * max(np.abs(expected).max(), 1e-6)
        found = run[signal].at(np.asarray(t) + begins)
        assert found == pytest.approx(expected, abs=size), signal
