"""Mosterman's ball with an elastic and a plastic contact: which impacts no mode covers.

Two controlled junctions: a modulated flow source for fast impacts, a plastic contact for slow ones.
The first model sends impacts between two speeds back and forth.
"""

import math

import pytest

import hybond as hb

G, EPS, FAST = 9.81, 0.8, 1.0


def ball(slow: float, fast: float = FAST, drop: float = 1.0) -> hb.Model:
    """Elastic above the speed `fast`, plastic below `slow`."""
    m = hb.Model("ball", domain="translational", parameters={"fast": fast, "slow": slow})
    m.add(weight=hb.Se("-9.81 N"), ball=hb.I("1 kg"), v=hb.One())
    m.add(elastic=hb.Zero(), rebound=hb.Sf(f"-{EPS}*pre(v.f)"))
    m.add(plastic=hb.Zero(), floor=hb.Sf(0))
    m.bond("weight -> v -> ball", "elastic -> v", "rebound -> elastic")
    m.bond("floor -> plastic -> v")
    m.signal(height=hb.Integral("v.f", f"{drop} m"))
    m.machine(
        "fast_impact",
        states={"off": [], "on": ["elastic"]},
        start="off",
        rules=[
            "off -> on when height <= 0 and v.f < -fast*1 [m/s]",
            "on -> off when pre(ball.p) >= 0",
        ],
    )
    m.machine(
        "slow_impact",
        states={"off": [], "on": ["plastic"]},
        start="off",
        rules=[
            "off -> on when height <= 0 and v.f < 0 and v.f >= -fast*1 [m/s]",
            "on -> off when plastic.e < 0 or pre(v.f) < -slow*1 [m/s]",
        ],
    )
    return m


def speeds():
    v = math.sqrt(2.0 * G)
    while True:
        yield v
        v *= EPS


def test_impacts_between_the_two_speeds_have_no_mode():
    run = hb.simulate(ball(slow=0.5), until=10.0, on_error="return")
    assert run.status == "error"
    assert isinstance(run.error, hb.DivergenceOfTime)
    assert run.error.code == "HB-N401"
    # the first speed below 1 m/s is the eighth, 0.929 m/s: above 0.5, so nothing covers it
    expected = 0.0
    for k, v in enumerate(speeds()):
        expected += v / G * (1.0 if k == 0 else 2.0)
        if v < FAST:
            break
    assert v == pytest.approx(0.9289, abs=1e-4)
    assert run.t_end == pytest.approx(expected, rel=1e-9)
    # the cycle by its modes, the guards by their values: where nothing holds can be read off
    text = str(run.error)
    assert "(off, off) -> (off, on) by slow_impact: height <= 0 and v.f < 0" in text
    assert "-> (off, off) by slow_impact: plastic.e < 0 or pre(v.f) < -slow" in text
    assert f"v.f = {-v:.6g}" in text


def test_without_the_gap_it_comes_to_rest():
    """Where the plastic contact takes what the elastic one leaves, every impact has a mode."""
    run = hb.simulate(ball(slow=FAST), until=10.0)
    assert run.mode == {"fast_impact": "off", "slow_impact": "on"}
    assert run["plastic.e"].at(10.0) == pytest.approx(G, rel=1e-9)
    assert run["height"].at(10.0) == pytest.approx(0.0, abs=1e-9)
    assert sum(1 for e in run.events if e.cause == "guard") == 8


def test_the_gap_shows_for_every_speed_within_it():
    """Dropped so that the first impact falls into the gap, below it, and above it."""
    for speed, status in ((0.3, "ok"), (0.6, "error"), (0.99, "error")):
        m = ball(slow=0.5, drop=speed**2 / (2 * G))
        run = hb.simulate(m, until=0.5, on_error="return")
        assert run.status == status, speed
