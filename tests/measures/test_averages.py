"""Integral, mean, rms and extremes against closed forms, jumps and impulses included."""

from __future__ import annotations

import math
import pickle
from itertools import pairwise

import numpy as np
import pytest

import hybond as hb


def test_a_discharge(discharge: hb.Result) -> None:
    u = discharge["c.e"]
    assert float(u.integral()) == pytest.approx(10 * (1 - math.exp(-3)), rel=1e-11)
    assert float(u.mean()) == pytest.approx(10 * (1 - math.exp(-3)) / 3, rel=1e-11)
    assert float(u.rms()) == pytest.approx(10 * math.sqrt((1 - math.exp(-6)) / 6), rel=1e-11)
    assert float(u.mean(start="0.5 s", end=1.5)) == pytest.approx(
        10 * (math.exp(-0.5) - math.exp(-1.5)), rel=1e-11
    )
    last = u.mean(period="2 Hz", periods=2)
    assert (last.start, last.end, last.unit) == (2.0, 3.0, "V")
    assert float(last) == pytest.approx(10 * (math.exp(-2) - math.exp(-3)), rel=1e-11)
    first = u.mean(start=1, period="0.5 s")
    assert (first.start, first.end) == (1.0, 1.5)
    assert u.integral().unit == "V*s"
    assert discharge["c.e*r.f"].integral().unit == "J"


def test_expressions_with_kinks_and_jumps(discharge: hb.Result) -> None:
    # 10 exp(-t) is 5 at t = ln 2
    half = math.log(2)
    area = (5 - 5 * half) + 5 * (3 - half) - 10 * (0.5 - math.exp(-3))
    assert float(discharge["abs(c.e - 5)"].integral()) == pytest.approx(area, rel=1e-10)
    share = discharge["if c.e > 5 then 1 else 0"].mean()
    assert float(share) == pytest.approx(half / 3, rel=1e-10)
    # sin(20 t) beside a step of a second
    y = discharge["c.e*sin(20*time/(1 s))"]
    wanted = 10 * (20 - math.exp(-3) * (math.sin(60) + 20 * math.cos(60))) / 401
    assert float(y.integral()) == pytest.approx(wanted, abs=1e-9)


def test_waves(waves: hb.Result) -> None:
    half = waves["half"]
    assert float(half.mean(period="20 ms")) == pytest.approx(1 / math.pi, rel=1e-10)
    assert float(half.rms(period="20 ms", periods=5)) == pytest.approx(0.5, rel=1e-10)
    # ripple factor of a half-wave rectifier: sqrt(pi^2/4 - 1) = 1.211
    ripple = half.ripple(period="20 ms", periods=2)
    assert ripple.rms == pytest.approx(math.sqrt(math.pi**2 / 4 - 1), rel=1e-9)
    assert ripple.peak_to_peak == pytest.approx(math.pi, rel=1e-9)
    assert float(waves["pulse"].mean(period="50 Hz", periods=3)) == pytest.approx(1.0, rel=1e-10)
    assert float(waves["pulse"].rms(period="50 Hz", periods=3)) == pytest.approx(2.0, rel=1e-10)
    assert float(waves["ramp"].rms(period="20 ms")) == pytest.approx(math.sqrt(1 / 3), rel=1e-9)


def test_extremes_lie_between_the_points(second_order: hb.Result) -> None:
    u = second_order["c.e"]
    damped = math.sqrt(1 - 0.2**2)
    top = u.max()
    assert float(top) == pytest.approx(1 + math.exp(-0.2 * math.pi / damped), rel=1e-9)
    assert u.max_at() == pytest.approx(math.pi / damped, rel=1e-6)
    assert top.t == u.max_at() and top.side == ""
    assert top.t not in second_order["c.e"].run.segments[-1].t
    low = u.min(start="4 s")
    assert float(low) == pytest.approx(1 - math.exp(-0.4 * math.pi / damped), rel=1e-9)
    assert float(u.peak_to_peak(start="2 s")) == pytest.approx(float(top) - float(low), rel=1e-9)


def test_the_highest_of_many_like_hills(waves: hb.Result) -> None:
    # each hill is a little higher than the one before
    hills = waves["sin(2*pi*50*time/(1 s))*(1 + 1e-6*time/(1 s))"]
    t = np.linspace(0.0849, 0.0851, 20001)
    wanted = np.sin(2 * np.pi * 50 * t) * (1 + 1e-6 * t)
    found = hills.max()
    assert float(found) == pytest.approx(wanted.max(), rel=1e-12)
    assert found.t == pytest.approx(0.085, abs=1e-6)
    assert float(found) > float(hills.max(end="80 ms"))


def test_both_limits_of_a_jump_count(ball: hb.Result) -> None:
    v = ball["v.f"]
    fall = math.sqrt(2 * 9.81 * 3)
    low, high = v.min(), v.max()
    assert float(low) == pytest.approx(-fall, rel=1e-9)
    assert (low.t, low.side) == (pytest.approx(math.sqrt(6 / 9.81)), "left")
    assert float(high) == pytest.approx(fall / 1.1, rel=1e-9)
    assert (high.t, high.side) == (low.t, "right")
    # the window that ends there has its left limit only
    assert float(v.max(end=low.t)) == pytest.approx(0.0, abs=1e-12)


def test_impulses_are_in_the_integral_of_a_force(ball: hb.Result) -> None:
    force = ball["contact.e"]
    # from rest to the top between two bounces: what the floor gave is what the weight took
    top = ball["v.f"].crossings(edge="fall")[6].t
    total = force.integral(end=top)
    assert float(total) == pytest.approx(9.81 * top, rel=1e-11)
    assert total.how == "7 impulses included" and total.impulses == float(total)
    assert float(force.mean(end=top)) == pytest.approx(9.81, rel=1e-11)
    # to the end: at rest from the limit of the impacts on, the last of which are cut short
    cut = ball.accumulations[0].t - ball.events.t[-2]
    assert float(force.integral()) == pytest.approx(9.81 * 20, abs=9.81 * cut)
    # the first impact alone: v (1 + eps), in whichever of two windows it ends
    t = float(ball.events.t[1])
    jump = math.sqrt(2 * 9.81 * 3) * (1 + 1 / 1.1)
    assert force.integral(end=t).impulses == pytest.approx(jump, rel=1e-9)
    assert force.integral(start=t, end=t + 0.1).impulses == 0.0
    assert ball["2*contact.e - weight.e"].integral(end=t).impulses == pytest.approx(
        2 * jump, rel=1e-9
    )


def test_an_impulse_has_no_square_and_no_top(ball: hb.Result) -> None:
    force = ball["contact.e"]
    for measure in (force.rms, force.max, force.min, force.peak_to_peak):
        with pytest.raises(hb.UsageError) as refused:
            measure()
        assert refused.value.code == "HB-R106"
    with pytest.raises(hb.UsageError, match="HB-R106"):
        force.thd(1.0, end="1 s")
    assert float(force.max(impulses="leave out")) == pytest.approx(9.81)
    assert "left out" in force.rms(impulses="leave out").how
    # no impulse in the window: nothing to refuse
    assert float(force.max(end="0.5 s")) == 0.0


@pytest.mark.parametrize("product", ["contact.e*contact.e", "contact.e*v.f", "abs(contact.e)"])
def test_an_impulse_times_what_jumps_has_no_meaning(ball: hb.Result, product: str) -> None:
    with pytest.raises(hb.UsageError) as refused:
        ball[product].integral()
    assert refused.value.code == "HB-R105"
    assert float(ball[product].integral(end="0.5 s")) == 0.0


def test_what_comes_before_the_first_instant_belongs_to_the_run() -> None:
    m = hb.Model("stopped", domain="translational")
    m.add(ball=hb.I("2 kg", f="3 m/s"), v=hb.One(), stop=hb.Sf("0 m/s"))
    m.bond("v -> ball", "stop -> v")
    run = hb.simulate(m, until="1 s")
    assert float(run["ball.e"].integral()) == pytest.approx(-6.0)
    assert float(run["ball.e"].integral(start=0.5)) == 0.0


def test_windows_meet_without_gap(ball: hb.Result) -> None:
    whole = float(ball["contact.e"].integral())
    cuts = [0.0, *ball.events.t[1:4].tolist(), 7.0, 20.0]
    parts = [float(ball["contact.e"].integral(start=a, end=b)) for a, b in pairwise(cuts)]
    assert sum(parts) == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize(
    ("window", "code"),
    [
        ({"end": "4 s"}, "HB-R102"),
        ({"start": -1}, "HB-R102"),
        ({"period": "2 s", "periods": 2}, "HB-R102"),
        ({"start": 2, "end": 1}, "HB-R101"),
        ({"start": "soon"}, "HB-R101"),
        ({"start": "1 V"}, "HB-R101"),
        ({"periods": 2}, "HB-R101"),
        ({"period": "1 s", "periods": 1.5}, "HB-R101"),
        ({"period": 0}, "HB-R101"),
        ({"start": 0, "end": 1, "period": 1}, "HB-R101"),
        ({"tolerance": 1e-20}, "HB-R101"),
    ],
)
def test_windows_that_are_none(discharge: hb.Result, window: dict[str, object], code: str) -> None:
    with pytest.raises(hb.HybondError) as refused:
        discharge["c.e"].mean(**window)  # type: ignore[arg-type]
    assert refused.value.code == code


def test_what_has_no_value_or_is_too_rough(
    discharge: hb.Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hybond.measures.pieces.LIMIT", 20_000)
    with pytest.raises(hb.NumericsError, match="HB-R103"):
        discharge["1/(time - time)"].mean()
    with pytest.raises(hb.NumericsError, match="HB-R104"):
        discharge["mod(1e9*time/(1 s), 1)"].mean()


def test_a_measurement_is_a_number_and_more(discharge: hb.Result) -> None:
    m = discharge["c.e"].max()
    copy = pickle.loads(pickle.dumps(m))
    assert (float(copy), copy.unit, copy.t) == (10.0, "V", 0.0)
    assert str(m) == "10 V" and f"{m:.1f}" == "10.0"
    assert m.to_dict() == {"value": 10.0, "unit": "V", "start": 0.0, "end": 3.0, "t": 0.0}


@pytest.mark.parametrize("beyond", [0.01, 1e-3, -0.004])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_top_beside_the_end_of_a_step(way: float, beyond: float) -> None:
    """A stone is at its top 1 s after it was thrown, and something ends its step beside that."""
    m = hb.Model("stone", domain="translational")
    m.add(weight=hb.Se(-9.81 * way), stone=hb.I(1.0, f=9.81 * way), v=hb.One())
    m.bond("weight -> v -> stone")
    m.signal(h=hb.Integral("v.f"))
    m.machine("clock", states={"a": [], "b": []}, start="a",
              rules=[f"a -> b when time >= {1 + beyond}"])  # fmt: skip
    run = hb.simulate(m, "2 s")
    best = "max" if way > 0 else "min"
    top = getattr(run["h"], best)()
    assert (float(top), top.t) == pytest.approx((way * 9.81 / 2, 1.0), rel=1e-12)
    assert float(run["h"].peak_to_peak()) == pytest.approx(9.81 / 2, rel=1e-12)
    # a level that is reached within a millisecond of the top only
    near = 1e-3
    level = way * (9.81 / 2 - 9.81 / 2 * near**2)
    assert [c.t for c in run["h"].crossings(level)] == pytest.approx([1 - near, 1 + near], rel=1e-9)
    table = hb.sweep(m, hb.Plan({"stone.f": [9.81 * way]}), until="2 s", collect=f"{best}(h)")
    assert table[f"{best}(h)"][0] == pytest.approx(way * 9.81 / 2, rel=1e-12)
