"""Which states some mode holds in, for Mosterman's ball and a hysteresis turned inside out."""

import math
from pathlib import Path

import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
FAST, SLOW, EPS, G = 1.0, 0.5, 0.8, 9.81


def ball(name):
    return hb.load(EXAMPLES / f"bouncing_ball_{name}.toml")


def test_the_uncovered_set_and_the_cycle_have_names():
    found = hb.coverage(ball("no_mode"), "ball.p", -3.0, 1.0, at={"height": 0.0})
    assert [r.holds for r in found.ranges] == ["off, off", None, "off, on", "off, off"]
    # mass 1 kg: by hand, -fast <= p < -slow
    (gap,) = found.uncovered
    assert (gap.low, gap.high) == pytest.approx((-FAST, -SLOW), rel=1e-12)
    assert found.ranges[0].passed == ("on, off",)  # rebounds at once
    tried = {t.mode: t for t in gap.tried}
    assert set(tried) == {"off, off", "off, on", "on, off", "on, on"}
    assert tried["off, off"].left_by == ("slow_impact: height <= 0 and v.f < 0 and v.f >= -fast",)
    assert tried["off, on"].left_by == ("slow_impact: plastic.e < 0 or pre(v.f) < -slow",)
    assert tried["on, off"].left_by == () and not tried["on, off"].barred
    assert "rebound" in tried["on, on"].barred
    assert "(off, on) by slow_impact" in gap.why
    assert "ball.p from -1 to -0.5: no mode holds" in str(found)


def test_the_repair_covers_all():
    found = hb.coverage(ball("two_junctions"), "ball.p", -3.0, 1.0, at={"height": 0.0})
    assert found.uncovered == ()
    assert [r.holds for r in found.ranges] == ["off, off", "off, on", "off, off"]
    assert found.ranges[1].low == pytest.approx(-FAST, rel=1e-12)


def test_a_range_that_ends_at_zero_ends_there():
    found = hb.coverage(ball("contact"), "ball.p", -3.0, 1.0, at={"height": 0.0})
    assert [(r.low, r.high, r.holds) for r in found.ranges] == [
        (-3.0, 0.0, "open"),
        (0.0, 1.0, "open"),
    ]


def test_what_cannot_be_solved_is_a_range_with_its_reason():
    m = hb.Model("fight")
    m.add(c=hb.C(1), n=hb.Zero(), s=hb.One(), V=hb.Se(1), node=hb.Zero(), W=hb.Se(2), f=hb.Sf(0))
    m.bond("f -> n -> c", "V -> node", "node -> s", "W -> s")
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when c.e > 1"])
    found = hb.coverage(m, "c.q", 0.0, 2.0)
    assert [r.holds for r in found.ranges] == ["off", None]
    assert found.ranges[1].low == pytest.approx(1.0, abs=1e-12)
    assert "HB-" in found.ranges[1].why


def test_what_is_swept_is_not_held():
    with pytest.raises(hb.UsageError) as caught:
        hb.coverage(ball("no_mode"), "ball.p", -3.0, 1.0, at={"ball.p": 0.0})
    assert caught.value.code == "HB-A209"


def test_what_is_said_is_what_runs_do():
    """The first impact that falls into the uncovered range ends the run; none does after repair."""
    run = hb.simulate(ball("no_mode"), on_error="return")
    assert isinstance(run.error, hb.DivergenceOfTime)
    assert run.error.code == "HB-N401"
    speed, t = math.sqrt(2.0 * G), 0.0
    while speed > FAST:
        t += 2.0 * speed / G if t else speed / G
        speed *= EPS
    assert SLOW < speed < FAST
    # the flight that ends in the gap started with that speed
    assert run.t_end == pytest.approx(t + 2.0 * speed / G, rel=1e-9)
    whole = hb.simulate(ball("two_junctions"))
    assert whole.mode == {"fast_impact": "off", "slow_impact": "on"}
    assert whole["plastic.e"].at(10.0) == pytest.approx(G, rel=1e-9)


def test_in_the_air_nothing_matters():
    found = hb.coverage(ball("no_mode"), "ball.p", -3.0, 1.0, at={"height": 1.0})
    assert [(r.low, r.high, r.holds) for r in found.ranges] == [(-3.0, 1.0, "off, off")]


def test_the_height_may_be_swept():
    found = hb.coverage(ball("no_mode"), "height", -1.0, 1.0, at={"ball.p": -0.7})
    assert [r.holds for r in found.ranges] == [None, "off, off"]
    assert found.ranges[1].low == pytest.approx(0.0, abs=1e-12)


def test_from_another_mode():
    """At rest on the plastic contact: it stays, and a push up is redistributed with its sign."""
    found = hb.coverage(
        ball("two_junctions"), "ball.p", -0.9, 0.9, at={"height": 0.0}, mode={"slow_impact": "on"}
    )
    assert [r.holds for r in found.ranges] == ["off, on", "off, off"]
    assert found.ranges[1].low == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name, low, high", [("ball.f", -1, 1), ("ball.p", 1, -1)])
def test_refusals(name, low, high):
    with pytest.raises(hb.UsageError) as caught:
        hb.coverage(ball("no_mode"), name, low, high)
    assert caught.value.code == "HB-A209"
