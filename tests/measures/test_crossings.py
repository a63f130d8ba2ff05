"""Crossings, periods, duty and step responses against closed forms."""

from __future__ import annotations

import math

import pytest

import hybond as hb


def test_the_half_life(discharge: hb.Result) -> None:
    (one,) = discharge["c.e"].crossings("5 V")
    assert one.t == pytest.approx(math.log(2), rel=1e-10)
    assert (one.edge, one.jump) == ("fall", False)
    assert discharge["c.e"].crossings(5, edge="rise") == ()
    with pytest.raises(hb.UsageError, match="HB-R101"):
        discharge["c.e"].crossings("5 A")


def test_all_zeros_of_a_sine(waves: hb.Result) -> None:
    sine = waves["sin(2*pi*50*time/(1 s) + 0.5)"]
    found = sine.crossings()
    wanted = [(k * math.pi - 0.5) / (100 * math.pi) for k in range(1, 11)]
    assert [c.t for c in found] == pytest.approx(wanted, rel=1e-12)
    assert [c.edge for c in found] == ["fall", "rise"] * 5
    assert float(sine.frequency()) == pytest.approx(50.0, rel=1e-12)
    assert float(sine.period(edge="fall")) == pytest.approx(0.02, rel=1e-12)
    assert "4 periods" in sine.period().how
    # above sin(pi/6) for a third of the time
    assert float(sine.duty(0.5, period="20 ms", periods=2)) == pytest.approx(1 / 3, rel=1e-10)


def test_jumps_across(waves: hb.Result) -> None:
    assert float(waves["pulse"].duty(period="20 ms", periods=4)) == pytest.approx(0.25, rel=1e-9)
    rises = waves["pulse"].crossings(2.0, edge="rise", end="90 ms")
    assert [c.t for c in rises] == pytest.approx([0.02, 0.04, 0.06, 0.08], rel=1e-12)
    assert float(waves["pulse"].frequency("1", end="0.09 s")) == pytest.approx(50.0, rel=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("early", [0.0, 0.3])
@pytest.mark.parametrize(
    ("bias", "part"),
    [(0.0, 1 / 2), (-5.0, 1 / 3), (5.0, 2 / 3)],
)
def test_the_duty_of_what_rests_at_the_level(
    turned: bool, early: float, bias: float, part: float
) -> None:
    """A diode's current is zero for a part of each period, and above zero for the rest."""
    m = hb.Model("half", domain="electrical")
    m.add(V=hb.Se(f"{bias} [V] + 10 [V]*sin(2*pi*50*time/(1 s) + {early})"))
    m.add(d=hb.One(law="diode"), r=hb.R(10.0))
    m.bond("V -> d", "r -> d" if turned else "d -> r")
    run = hb.simulate(m, "100 ms")
    for window in ({}, {"period": "20 ms", "periods": 2}, {"start": "13 ms", "end": "53 ms"}):
        assert float(run["d.f"].duty(0.0, **window)) == pytest.approx(part, rel=1e-9)
    assert float(run["-d.f"].duty(0.0)) == pytest.approx(0.0, abs=1e-12)
    assert float(run["d.f + 1 [A]"].duty("1 A")) == pytest.approx(part, rel=1e-9)


def test_a_jump_of_the_run_is_a_crossing(ball: hb.Result) -> None:
    bounces = ball["v.f"].crossings(end="5 s")
    ups = [c for c in bounces if c.edge == "rise"]
    assert all(c.jump for c in ups) and len(ups) == 4
    assert [c.t for c in ups] == [t for t in ball.events.t.tolist() if 0 < t <= 5]
    # tops between: half way from one impact to the next
    tops = [c for c in bounces if c.edge == "fall"]
    assert tops[0].t == pytest.approx(0.5 * (ups[0].t + ups[1].t), rel=1e-9)
    assert not any(c.jump for c in tops)


def test_too_few_crossings(discharge: hb.Result) -> None:
    with pytest.raises(hb.UsageError) as refused:
        discharge["c.e"].frequency(5.0)
    assert refused.value.code == "HB-R107"


def test_a_step_of_second_order(second_order: hb.Result) -> None:
    damped = math.sqrt(1 - 0.2**2)
    info = second_order["c.e"].step_info(final=1)
    assert info.overshoot == pytest.approx(math.exp(-0.2 * math.pi / damped), rel=1e-8)
    assert info.peak_time == pytest.approx(math.pi / damped, rel=1e-6)
    assert info.undershoot == pytest.approx(0.0, abs=1e-12)
    # the last time outside of 2 %: y - 1 = -exp(-0.2 t) cos(w t - phi) / w
    t, outside = 0.0, 0.0
    while t < 40:
        y = math.exp(-0.2 * t) * math.cos(damped * t - math.asin(0.2)) / damped
        outside = t if abs(y) > 0.02 else outside
        t += 1e-4
    assert info.settling_time == pytest.approx(outside, abs=2e-4)
    assert "overshoot" in str(info) and "<table>" in info._repr_html_()


def test_a_step_of_first_order(discharge: hb.Result) -> None:
    info = discharge["c.e"].step_info(final=0, band=0.1)
    assert info.rise_time == pytest.approx(math.log(9), rel=1e-9)
    assert info.settling_time == pytest.approx(math.log(10), rel=1e-9)
    assert (info.overshoot, info.initial) == (0.0, 10.0)
    late = discharge["c.e"].step_info(final=0, low=0.0, high=0.99)
    assert late.rise_time is None and late.settling_time is None
    assert "not reached" in str(late)
    with pytest.raises(hb.UsageError, match="HB-R108"):
        discharge["c.e - c.e"].step_info()
