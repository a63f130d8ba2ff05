"""At an instant that laws have no part in they stand as they were, unless they just leave it."""

from __future__ import annotations

import pytest

import hybond as hb

END = 2.0


def coil(events: str) -> hb.Model:
    """A coil with 1 A that a source takes off at 1 A/s through a diode: none is left at 1 s.

    A clock beside it switches what does not touch it, every so many seconds.
    """
    m = hb.Model("coil", domain="electrical")
    m.add(V=hb.Se(-1.0), d=hb.One(law="diode"), L=hb.I(1.0, f=1.0))
    m.bond("V -> d -> L")
    m.add(E=hb.Se(2.0), s=hb.One(), r=hb.R(4.0))
    m.bond("E -> s -> r")
    m.input(gate=hb.Input(pwm={"period": events, "duty": 0.5}))
    m.machine(
        "S",
        states={"open": [], "closed": ["s"]},
        start="closed",
        rules=["closed -> open when gate < 0.5", "open -> closed when gate > 0.5"],
    )
    return m


@pytest.mark.parametrize("period", ["0.5 s", "0.25 s", "0.31 s", "1.9999999999 s", "2.00000001 s"])
@pytest.mark.parametrize("solver", ["rk45", "exact"])
def test_a_diode_beside_a_clock_blocks_when_its_current_ends(period: str, solver: str) -> None:
    run = hb.simulate(coil(period), END, solver=solver)
    assert run.status == "ok"
    at = [0.0, 0.4, 0.9, 0.999999, 1.000001, 1.3, 1.75, END]
    current = run.sample(at, ["L.f"])["L.f"]
    assert current == pytest.approx([max(1.0 - t, 0.0) for t in at], abs=1e-9)
    # which blocks then, with all of the source's voltage on it
    assert run.sample([0.5, 1.5], ["d.e"])["d.e"] == pytest.approx([0.0, -1.0], abs=1e-9)


def test_the_clock_switches_all_the_while() -> None:
    run = hb.simulate(coil("0.5 s"), END)
    at = [0.1, 0.3, 0.6, 0.8, 1.1, 1.3]
    assert run.sample(at, ["r.f"])["r.f"] == pytest.approx([0.5, 0.0] * 3, abs=1e-12)


def test_a_switch_that_takes_the_current_off_a_diode_is_seen_at_once() -> None:
    # 12 V on 2 ohm through a coil of 10 mH: all of it while the switch is closed, none behind it
    m = hb.Model("chopper", domain="electrical")
    m.add(V=hb.Se(12.0), switch=hb.One(), d=hb.One(law="diode"), x=hb.Zero(), i=hb.One())
    m.add(L=hb.I(0.01), R=hb.R(2.0))
    m.bond("V -> switch -> x", "d -> x -> i -> L", "i -> R")
    m.input(gate=hb.Input(pwm={"period": "20 ms", "duty": 0.5}))
    m.machine(
        "S",
        states={"open": [], "closed": ["switch"]},
        start="closed",
        rules=["closed -> open when gate < 0.5", "open -> closed when gate > 0.5"],
    )
    run = hb.simulate(m, 0.1)
    on = [0.005, 0.025, 0.045]
    off = [0.015, 0.035, 0.055]
    assert run.sample(on, ["x.e"])["x.e"] == pytest.approx([12.0] * 3)
    assert run.sample(off, ["x.e"])["x.e"] == pytest.approx([0.0] * 3, abs=1e-9)
    # periodic at last, half a period being two time constants
    decay = 2.718281828459045**-2.0
    top = 6.0 * (1.0 - decay) / (1.0 - decay * decay)
    assert run.sample([0.09], ["L.f"])["L.f"] == pytest.approx([top], rel=1e-4)
