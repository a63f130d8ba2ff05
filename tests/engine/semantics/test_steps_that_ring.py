"""Time-stepping where something relaxes within a step: after breaks, and where laws hold it.

Oracles: closed forms of capacitors that charge; located events; that what a passive circuit stores
is the only thing that it can.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def steps(model: hb.Model, until: float, step: float, theta: float = 0.5) -> hb.Result:
    return hb.simulate(model, until, solver="moreau-jean", step=step, theta=theta)


def way(one: str, other: str, *, turned: bool) -> str:
    return f"{other} -> {one}" if turned else f"{one} -> {other}"


def boost(L: float, C: float, *, turned: bool = False) -> hb.Model:
    """A boost converter: its switch is of 10 mohm closed, of 10 kohm open."""
    m = hb.Model("boost", domain="electrical")
    m.add(V=hb.Se("12 V"), L=hb.I(L), line=hb.One(), sw=hb.Zero(), off=hb.R("10 kohm"))
    m.add(on=hb.One(), closed=hb.R("10 mohm"), d=hb.One(law="diode"))
    m.add(out=hb.Zero(), C=hb.C(C), load=hb.R("20 ohm"))
    m.bond("V -> line -> sw -> d -> out", "line -> L", "sw -> on")
    m.bond(way("sw", "off", turned=turned), way("on", "closed", turned=turned))
    m.bond(way("out", "C", turned=turned), way("out", "load", turned=turned))
    m.machine(
        "S",
        states={"open": [], "closed": ["on"]},
        start="closed",
        rules=[
            "open -> closed when mod(time, 20 us) < 10 us",
            "closed -> open when mod(time, 20 us) >= 10 us",
        ],
    )
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("L", "C", "step"),
    [
        # 10 kohm times half a step is the coil: what the diode does is open with theta = 1/2
        (1e-2, 1e-5, 2e-6),
        (1e-2, 1e-5, 1e-6),
        (1e-3, 1e-4, 1e-6),
        (1e-3, 1e-4, 0.5e-6),
        (1e-3, 1e-4, 0.25e-6),
    ],
)
def test_a_coil_goes_on_through_a_diode_beside_an_open_switch(
    L: float, C: float, step: float, turned: bool
) -> None:
    """It was held where it was, by half a step times kiloohms: the less, the shorter the step."""
    located = hb.simulate(boost(L, C), 1.5e-3)
    t = np.linspace(2e-4, 1.5e-3, 77)
    run = steps(boost(L, C, turned=turned), 1.5e-3, step)
    assert not any("answers" in w for w in run.warnings)
    for name in ("C.e", "L.f"):
        right = located[name].at(t)
        off = np.abs(run[name].at(t) - right).max()
        # edges of the switch are seen at the ends of steps
        assert off < 2e4 * step * np.abs(right).max()


def charged(kind: str, *, turned: bool) -> tuple[hb.Model, str]:
    """What goes to 1 V from 0 V in a thousandth of a step, and at 10 ms to 3 V, or from 2 V."""
    m = hb.Model("charged", domain="electrical")
    if kind == "pair":
        # neither of the two relaxes by itself: only what is between them does
        m.add(c=hb.C("1 mF", e="2 V"), b=hb.C("1 mF"), s=hb.One(), r=hb.R("2 mohm"))
        m.add(n=hb.Zero(), k=hb.Zero())
        m.bond("n -> s -> k", "k -> b", way("n", "c", turned=turned), way("s", "r", turned=turned))
        return m, "c.e"
    m.add(r=hb.R("1 ohm"), s=hb.One(), c=hb.C("1 uF"), n=hb.Zero())
    m.bond(way("s", "r", turned=turned), "s -> n", way("n", "c", turned=turned))
    if kind == "source":
        m.add(V=hb.Se("if time < 10 ms then 1 V else 3 V"))
        m.bond("V -> s")
        return m, "c.e"
    m.add(V=hb.Se("1 V"), W=hb.Se("3 V"), a=hb.One(), b=hb.One(), q=hb.Zero())
    m.add(ra=hb.R("1 uohm"), rb=hb.R("1 uohm"))
    m.bond("V -> a -> q", "W -> b -> q", "q -> s", "a -> ra", "b -> rb")
    m.machine(
        "S",
        states={"first": ["a"], "second": ["b"]},
        start="first",
        rules=["first -> second when time >= 10 ms"],
    )
    return m, "c.e"


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("theta", [0.5, 0.6])
@pytest.mark.parametrize("kind", ["source", "switch", "pair"])
def test_what_relaxes_within_a_step_does_not_ring_after_a_break(
    kind: str, theta: float, turned: bool
) -> None:
    """Backward Euler leaves 1/(1 + 1000) of it; it swung from 0 to 2 V for hundreds of steps."""
    model, name = charged(kind, turned=turned)
    run = steps(model, 0.02, 1e-3, theta)
    t = np.arange(2, 21) * 1e-3
    right = np.where(t > 0.0105, 3.0, 1.0) if kind != "pair" else np.ones_like(t)
    found = run[name].at(t)
    away = t[(t > 0.0115) | (t < 0.0095)]
    there = np.isin(t, away)
    assert np.abs(found - right)[there].max() < 3.0 / 1001.0**2


def test_steps_that_do_not_ring_are_of_second_order_over_a_break() -> None:
    """A capacitor over a jump of its source: ``theta = 1/2`` as ever, where a step is short."""
    m = hb.Model("jump", domain="electrical")
    m.add(V=hb.Se("if time < 0.5 s then 1 V else 3 V"), r=hb.R(1.0), s=hb.One(), c=hb.C(0.5))
    m.bond("V -> s", "s -> r", "s -> c")
    t = np.array([0.4, 0.7, 1.0])
    first = 1.0 - np.exp(-2.0 * t)
    half = 1.0 - math.exp(-1.0)
    right = np.where(t < 0.5, first, 3.0 + (half - 3.0) * np.exp(-2.0 * (t - 0.5)))
    off = [np.abs(steps(m, 1.0, h)["c.e"].at(t) - right).max() for h in (0.02, 0.01)]
    assert off[0] < 2e-4 and math.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.1)
