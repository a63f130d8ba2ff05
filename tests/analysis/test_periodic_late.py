"""Motions and responses where sources begin to repeat late, against closed forms."""

from __future__ import annotations

from math import exp, pi

import pytest

import hybond as hb

VALUES = {"T": 10e-6, "a": 0.8, "w": 0.6, "tau": 10e-6}


def fed(late: int = 0, **changed: float) -> hb.Model:
    """Return R and C, of one ohm, behind pulses that reach over the end of a period."""
    m = hb.Model("fed", domain="electrical", parameters=VALUES | changed)
    m.add(V=hb.Se("u"), j=hb.One(), R=hb.R("1 ohm"), C=hb.C("tau"))
    m.bond("V -> j -> R", "j -> C")
    # before its first row a table holds that row's value
    rows = [(f"({late} + a)*T", "5 V"), (f"({late} + a + w)*T", "0 V")]
    m.input(u=hb.Input(table=rows, period="T"))
    return m


def charge(T: float, a: float, w: float, tau: float) -> float:
    """Return the charge at a whole period, within a pulse."""
    top = 5.0 * (1.0 - exp(-w * T / tau)) / (1.0 - exp(-T / tau))
    lowest = top * exp(-(1.0 - w) * T / tau)
    return tau * (5.0 + (lowest - 5.0) * exp(-(1.0 - a) * T / tau))


@pytest.mark.parametrize("late", [0, 2])
def test_pulses_that_begin_late_are_met_as_they_repeat(late: int) -> None:
    orbit = hb.periodic(fed(late), wrt=list(VALUES))
    assert orbit["C.e"].mean() == pytest.approx(3.0, rel=1e-9)
    assert orbit.state.stored["C.q"] == pytest.approx(charge(**VALUES), rel=1e-9)
    for name, value in VALUES.items():
        step = 1e-5 * value
        up, down = (charge(**VALUES | {name: value + s}) for s in (step, -step))
        assert orbit.derivative("C.q", name) == pytest.approx((up - down) / (2 * step), rel=1e-6)
    assert orbit.run.t_begin == pytest.approx((late + 1) * VALUES["T"])
    assert any("from where on all repeats" in note for note in orbit.notes)
    again = hb.simulate(fed(late), "200 us", start=orbit.state)
    assert again["C.e"].mean(start="190 us") == pytest.approx(3.0, rel=1e-7)


def test_pulses_that_begin_late_are_followed_along_their_period() -> None:
    (branch,) = hb.continuation(fed(1), "T", (8e-6, 12e-6), points=3, max_points=4).branches
    for point in branch.points:
        q = charge(**VALUES | {"T": point.value})
        assert point.state["C.q"] == pytest.approx(q, rel=1e-8)


def test_what_is_brought_up_first_repeats_where_it_has_settled() -> None:
    m = hb.Model("raised", domain="electrical")
    m.add(V=hb.Se("u*g"), j=hb.One(), R=hb.R("1 ohm"), C=hb.C("10 uF"))
    m.bond("V -> j -> R", "j -> C")
    m.input(u=hb.Input(table=[(0, 0), ("1 ms", "5 V")], linear=True))
    m.input(g=hb.Input(pwm={"period": "10 us", "duty": 0.6}))
    orbit = hb.periodic(m, "10 us", settle="2 ms")
    assert orbit["C.e"].mean() == pytest.approx(3.0, rel=1e-9)
    with pytest.raises(hb.NumericsError, match="the next one does not"):
        hb.periodic(m, "10 us")


@pytest.mark.parametrize("phase", ["3 us", "10 us", "25 us"])
def test_samples_that_begin_late_are_met_as_they_go_on(phase: str) -> None:
    m = hb.Model("held", domain="electrical")
    m.add(V=hb.Se("1 V*u"), j=hb.One(), R=hb.R("1 ohm"), C=hb.C("10 uF"))
    m.bond("V -> j -> R", "j -> C")
    m.signal(u=hb.Sampled("2 - C.e/(10 V)", every="10 us", phase=phase))
    assert hb.periodic(m)["C.e"].mean() == pytest.approx(2.0 / 1.1, rel=1e-9)


def test_a_pulse_of_a_netlist_that_wraps_round_its_period(tmp_path) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "wraps.cir"
    rows = ["Wraps", "V1 a 0 PULSE(0 5 8u 1p 1p 6u 10u)", "R1 a b 1", "C1 b 0 10u", ".tran 1u 1m"]
    path.write_text("\n".join([*rows, ".end"]))
    deck = hb.read_circuit(path)
    orbit = hb.periodic(deck.model)
    assert orbit[deck.signal("v(b)")].mean() == pytest.approx(3.0, rel=1e-6)
    assert orbit.state.stored["C1.q"] == pytest.approx(charge(**VALUES), rel=1e-6)


@pytest.mark.parametrize("late", [0, 3, 20000])
def test_a_response_settles_where_pulses_have_begun(late: int) -> None:
    # the switch feeds the sine through for six tenths of each period, once it is driven
    m = hb.Model("gated", domain="electrical")
    m.add(V=hb.Se("u*g"), j=hb.One(), R=hb.R("1 ohm"), C=hb.C("10 uF"), r=hb.R("4 ohm"))
    m.add(n=hb.Zero())
    m.bond("V -> j -> n -> C", "j -> R", "n -> r")
    rows = [(f"{late} us", 0), (f"{late + 2} us", 1), (f"{late + 8} us", 0)]
    m.input(g=hb.Input(table=rows, period="10 us"))
    m.input(u=1.0)
    found = hb.frequency_response(m, input="u", output="n.e", frequencies=["2 kHz"], amplitude=0.01)
    ideal = 0.6 / (1.25 + 2j * pi * found.frequencies * 10e-6)
    assert found.ok and abs(found.response / ideal - 1.0) < 1e-3
