"""Events without end: a relay whose signal feels it only through two integrators, with damping.

Between two events of ``x'' = -sign(x) - k x'`` the speed falls by ``2/3 k v^2``, and they are
``2 v`` apart: after n events that is ``3 / (k n)``, for ever.
"""

from __future__ import annotations

import math
import re

import pytest

import hybond as hb

MANY = 400


def relay(k: float, *, turned: bool = False, band: float = 0.0) -> hb.Model:
    sign = "-" if turned else ""
    m = hb.Model("relay")
    m.add(x=hb.C(1.0, q=0.1), v=hb.C(1.0, q=1.0), n1=hb.Zero(), n2=hb.Zero())
    m.add(sx=hb.Sf(f"{sign}v.q"), sv=hb.Sf(f"{sign}(u - {k}*v.q)"))
    m.bond("n1 -> sx" if turned else "sx -> n1", "n2 -> sv" if turned else "sv -> n2")
    m.bond("n1 -> x", "n2 -> v")
    m.signal(u='if relay.state == "minus" then -1 else 1')
    rules = [f"minus -> plus when x.q < {-band}", f"plus -> minus when x.q > {band}"]
    m.machine("relay", states={"plus": [], "minus": []}, start="minus", rules=rules)
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("k", [0.5, 2.0])
def test_a_relay_behind_two_lags_switches_ever_faster_and_is_told_to_take_a_band(
    k: float, turned: bool
) -> None:
    run = hb.simulate(relay(k, turned=turned), 100, max_events=MANY, on_error="return")
    assert run.error is not None and run.error.code == "HB-N404"
    told = re.search(r"relay switches ever faster, (\S+) s apart at last", str(run.error))
    assert told, run.error
    assert float(told[1]) == pytest.approx(3.0 / (k * MANY), rel=0.05)
    assert "give it a band" in run.error.hint


def test_a_relay_with_a_band_ends_in_a_cycle_that_does_not_shrink() -> None:
    run = hb.simulate(relay(2.0, band=0.05), 1000, max_events=MANY, on_error="return")
    assert run.error is not None and run.error.code == "HB-N404"
    assert re.search(r"relay switches every \S+ s at last", str(run.error))
    times = [event.t for event in run.events]
    every = (times[-1] - times[-17]) / 16.0
    told = re.search(r"would (\S+) times more until t = 1000 s", str(run.error))
    assert told, run.error
    assert float(told[1]) == pytest.approx((1000.0 - times[-1]) / every, rel=0.02)
    assert times[-1] - times[-2] == pytest.approx(times[-3] - times[-4], rel=1e-3)


def test_a_relay_that_would_switch_too_often_is_refused_long_before() -> None:
    """After n events they are ``3 / (k n)`` apart: their number grows as ``exp(k t / 3)``."""
    k, until = 2.0, 60.0
    run = hb.simulate(relay(k), until, on_error="return")
    assert run.error is not None and run.error.code == "HB-N404"
    told = re.search(r"(\d+) events by t = \S+ s, and (\S+) to come", str(run.error))
    assert told, run.error
    assert int(told[1]) < 10_000
    more = int(told[1]) * math.exp(k / 3.0 * (until - run.t_end))
    assert math.log(float(told[2])) == pytest.approx(math.log(more), rel=0.05)
    # as many as there are up to a little later are no reason
    later = hb.simulate(relay(k), run.t_end + 0.2)
    assert later.status == "ok"
    assert len(later.events) == pytest.approx(int(told[1]) * math.exp(k / 3.0 * 0.2), rel=0.02)


@pytest.mark.parametrize("until", [1e3, 1e7])
def test_a_fast_burst_at_the_begin_of_a_long_run_is_none_of_these(until: float) -> None:
    """It has 20,000 events in its first second, evenly, and would have 1e11 if it went on."""
    pace, stop = 1e4, 1.0
    m = hb.Model("burst")
    m.add(z=hb.Zero(), c=hb.C(1.0), up=hb.One(), down=hb.One(), U=hb.Se(1e3), D=hb.Se(-1e3))
    m.add(Ru=hb.R(1e3), Rd=hb.R(1e3))
    m.bond("U -> up", "up -> Ru", "up -> z", "D -> down", "down -> Rd", "down -> z", "z -> c")
    m.signal(clock=hb.Integral("1", start=0))
    band = 1.0 / (4.0 * pace)
    m.machine(
        "A",
        states={"rises": ["up"], "falls": ["down"], "rests": []},
        start="rises",
        rules=[
            f"rises -> rests when clock >= {stop}",
            f"falls -> rests when clock >= {stop}",
            f"rises -> falls when c.q >= {band}",
            f"falls -> rises when c.q <= -{band}",
        ],
    )
    run = hb.simulate(m, until)
    assert run.status == "ok"
    assert len(run.events) == pytest.approx(2.0 * pace * stop, abs=5)
