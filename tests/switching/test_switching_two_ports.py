"""The Boolean transformer: two controlled junctions around a transformer, and a converter cell."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.model.parts import MachinePart

sw = hb.switching
TIGHT = {"rtol": 1e-11}


def two_sides(modulus: float, arrows: tuple[bool, bool], turned: bool, *, sugar: bool) -> hb.Model:
    """Side 1: a coil loop that may be shorted; side 2: a capacitor node that may be opened.

    `arrows`: whether the bond of each port points from the left to the right; `turned`: whether
    port 2 is on the left.
    """
    m = hb.Model("two sides")
    m.add(E=hb.Se(2.0), i=hb.One(), L=hb.I(0.7, f=1.0), R=hb.R(0.8))
    m.add(n=hb.Zero(), C=hb.C(0.4, e=0.5), load=hb.R(3.0))
    m.bond("E -> i -> L", "i -> R", "n -> C", "n -> load")
    m.machine(
        "S",
        states={"on": [], "off": []},
        start="on",
        rules=["on -> off when C.e > 0.9 and time < 1", "off -> on when time >= 1.2"],
    )

    def drawn(a: str, b: str, forward: bool) -> str:
        return f"{a} -> {b}" if forward else f"{b} -> {a}"

    left, right = ("n", "i") if turned else ("i", "n")
    first, second = ("2", "1") if turned else ("1", "2")
    if sugar:
        chain = [drawn(left, f"x.{first}", arrows[0]), drawn(f"x.{second}", right, arrows[1])]
        sw.boolean_mtf(m, "x", bonds=chain, machine="S", on="on", modulus=modulus)
        return m
    m.add(x=hb.TF(modulus), short=hb.Zero(), open=hb.One())
    near, far = ("open", "short") if turned else ("short", "open")
    m.bond(drawn(left, near, arrows[0]), drawn(near, f"x.{first}", arrows[0]))
    m.bond(drawn(f"x.{second}", far, arrows[1]), drawn(far, right, arrows[1]))
    m.machines["S"] = MachinePart({"on": ["short", "open"], "off": []}, "on", m.machines["S"].rules)
    return m


@settings(max_examples=12, deadline=None)
@given(
    st.floats(0.3, 2.0).flatmap(lambda a: st.sampled_from([a, -a])),
    st.tuples(st.booleans(), st.booleans()),
    st.booleans(),
)
def test_it_is_two_controlled_junctions_around_a_transformer(modulus, arrows, turned) -> None:
    run, want = (
        hb.simulate(two_sides(modulus, arrows, turned, sugar=k), until=2, **TIGHT)
        for k in (True, False)
    )
    assert [e.t for e in run.events] == pytest.approx([e.t for e in want.events], rel=1e-9)
    assert run.final["L.p"] == pytest.approx(want.final["L.p"], rel=1e-9, abs=1e-9)
    t = np.linspace(0.01, 1.99, 23)
    for name in ("L.f", "L.e", "C.e", "C.f", "E.f", "load.f"):
        assert run[name].at(t) == pytest.approx(want[name].at(t), rel=1e-8, abs=1e-9), name
    for a, b in zip(run.events, want.events, strict=True):
        assert a.after == pytest.approx(b.after, rel=1e-9, abs=1e-9)


def buck(cell: str) -> hb.Model:
    m = hb.Model("buck", domain="electrical")
    m.add(V=hb.Se("24 V"), supply=hb.Zero(), i=hb.One(), L=hb.I("1 mH"), R=hb.R("2 ohm"))
    m.bond("V -> supply", "i -> L", "i -> R")
    m.input(gate=hb.Input(pwm={"period": "100 us", "duty": 0.6}))
    rules = ["low -> high when gate > 0.5", "high -> low when gate < 0.5"]
    if cell == "mtf":
        m.machine("S", states={"low": [], "high": []}, start="low", rules=rules)
        sw.boolean_mtf(m, "x", bonds=["supply -> x.2", "x.1 -> i"], machine="S", on="high")
    else:
        m.machine("S", states={"low": ["down"], "high": ["up"]}, start="low", rules=rules)
        m.add(up=hb.One(), down=hb.One(), out=hb.Zero(), ground=hb.Se("0 V"))
        m.bond("supply -> up -> out -> i", "ground -> down -> out")
    return m


def test_source_on_side_2_it_is_the_switching_cell_of_two_controlled_junctions() -> None:
    run, want = (hb.simulate(buck(k), until="1 ms", **TIGHT) for k in ("mtf", "pair"))
    assert len(run.events) == len(want.events) == 21
    t = np.linspace(1e-6, 0.999e-3, 40)
    for name in ("L.f", "L.e", "R.e", "V.f"):
        assert run[name].at(t) == pytest.approx(want[name].at(t), rel=1e-9, abs=1e-9)
    # one switching period from rest, in closed form
    tau = 0.5e-3
    top = 12.0 * (1.0 - math.exp(-60e-6 / tau))
    assert run["L.f"].at(100e-6) == pytest.approx(top * math.exp(-40e-6 / tau), rel=1e-9)


def test_source_on_side_1_it_is_a_short_and_refused() -> None:
    m = hb.Model("short", domain="electrical")
    m.add(V=hb.Se("24 V"), i=hb.One(), R=hb.R("2 ohm"))
    m.bond("i -> R")
    m.machine("S", states={"off": [], "on": []}, start="on", rules=["on -> off when time >= 1"])
    sw.boolean_mtf(m, "x", bonds="V -> x -> i", machine="S", on="on")
    with pytest.raises(hb.CausalityError) as refusal:
        hb.simulate(m, until=2)
    assert refusal.value.code == "HB-C101"
    assert refusal.value.partial.t_end == 1.0


def test_two_bonds_are_asked_for() -> None:
    m = buck("pair")
    with pytest.raises(hb.ModelError, match="HB-M190"):
        sw.boolean_mtf(m, "x", bonds="supply -> x", machine="S", on="high")
