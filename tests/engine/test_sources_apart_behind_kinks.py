"""Sources that agree while diodes hold both, and contradict each other as soon as one jumps.

A step up in a freewheel circuit whose capacitor the free current has emptied: from then on source
and ground both hold it at zero, until the source jumps. Said as a timed event, and as a law.
"""

import math

import pytest

import hybond as hb

SQUARE = {
    "sign": "1 + sign(sin(2*pi*time/(0.6 [s])))",
    "floor": "2 - 2*floor(mod(time, 0.6 [s])/(0.3 [s]))",
    "signal": "1 + sign(u)",
}
TIMED = (
    "if time < 0.3 [s] then 2 else if time < 0.6 [s] then 0 else if time < 0.9 [s] then 2 else 0"
)


def electrical(law, resistor):
    """A source and ground through a diode each onto a capacitor, with a coil behind it."""
    m = hb.Model("freewheel", domain="electrical")
    m.add(V=hb.Se(f"({law})*1 [V]"), g=hb.Se(0), d=hb.One(law="diode"), f=hb.One(law="diode"))
    m.add(n=hb.Zero(), C=hb.C(1e-3), s=hb.One(), L=hb.I(0.1), R=hb.R(resistor))
    m.bond("V -> d -> n", "g -> f -> n", "C -> n", "n -> s", "L -> s", "s -> R")
    m.signal(u=hb.Integral("cos(2*pi*time/(0.6 [s]))", start=0))
    return m


def dual(law, resistor):
    """The same with efforts for flows."""
    m = hb.Model("freewheel")
    m.add(V=hb.Sf(f"({law})*1 [A]"), g=hb.Sf(0), d=hb.Zero(law="diode"), f=hb.Zero(law="diode"))
    m.add(n=hb.One(), C=hb.I(1e-3), s=hb.Zero(), L=hb.C(0.1), R=hb.G(resistor))
    m.bond("V -> d -> n", "g -> f -> n", "n -> C", "n -> s -> L", "s -> R")
    m.signal(u=hb.Integral("cos(2*pi*time/(0.6 [s]))", start=0))
    return m


LINEAR, BENT = 3.0, {"e": "3 [ohm]*f + 1 [V/A^3]*f^3"}


@pytest.mark.parametrize(
    ("made", "resistor", "law", "solver"),
    [
        (electrical, LINEAR, "sign", "rk45"),
        (electrical, LINEAR, "floor", "exact"),
        (electrical, LINEAR, "signal", "exact"),
        (electrical, BENT, "sign", "radau"),
        (electrical, BENT, "signal", "auto"),
        (dual, LINEAR, "sign", "radau"),
        (dual, LINEAR, "signal", "rk45"),
    ],
)
def test_a_source_that_jumps_from_what_ground_holds_too(made, resistor, law, solver):
    run = hb.simulate(made(SQUARE[law], resistor), until=1.15, solver=solver)
    timed = hb.simulate(made(TIMED, resistor), until=1.15)
    of = "L.f" if made is electrical else "L.e"
    for t in (0.2, 0.302, 0.45, 0.75, 0.902, 1.1):
        assert run[of].at(t) == pytest.approx(timed[of].at(t), rel=1e-6)
    if resistor == LINEAR:
        assert run[of].at(0.2) == pytest.approx(2 / 3 * (1 - math.exp(-6)), rel=1e-8)
    events = [e for e in run.events if e.t > 1e-9]
    assert [e.steps[-1].mode for e in events] == [e.steps[-1].mode for e in timed.events][1:]
    assert [e.t for e in events] == pytest.approx([e.t for e in timed.events][1:], abs=2e-8)
    assert run.audit().holds()


def test_a_limit_from_the_left_of_a_jump_by_a_signal():
    run = hb.simulate(electrical(SQUARE["signal"], LINEAR), until=0.8)
    t = next(e.t for e in run.events if e.t > 0.5)
    assert t == pytest.approx(0.6, abs=1e-8)
    assert (run["V.e"].at(t, side="left"), run["V.e"].at(t)) == (0.0, 2.0)


def test_switches_that_hold_both_are_refused_where_the_source_jumps():
    m = hb.Model("tied", domain="electrical")
    m.add(V=hb.Se("(1 + sign(time - 0.5 [s]))*1 [V]"), g=hb.Se(0), a=hb.One(), b=hb.One())
    m.add(n=hb.Zero(), C=hb.C(1e-3), R=hb.R(10.0))
    m.bond("V -> a -> n", "g -> b -> n", "n -> C", "n -> R")
    with pytest.raises(hb.CausalityError, match=r"HB-C101.*differ by -2 at t = 0\.5"):
        hb.simulate(m, until=1)


@pytest.mark.parametrize("solver", ["rk45", "exact", "radau"])
@pytest.mark.parametrize("low", [0.0, 0.5])
def test_a_jump_by_a_signal_through_a_conducting_diode_is_an_event(solver, low):
    """The signal is u = t^2: 0.2 is passed at sqrt(0.2); all charge comes through the source."""
    m = hb.Model("step", domain="electrical")
    high, middle = 2.0, 0.5 * (2.0 + low)
    m.add(V=hb.Se(f"({middle} + {high - middle}*sign(u - 0.2))*1 [V]"), n=hb.Zero())
    m.add(d=hb.One(law="diode"), C=hb.C(1e-3, e=low), R=hb.R(50.0))
    m.bond("V -> d -> n", "n -> C", "n -> R")
    m.signal(u=hb.Integral("2*time/(1 [s])/(1 [s])", start=0))
    run = hb.simulate(m, until=1, solver=solver)
    assert run["C.e"].at(0.44) == low
    assert run["C.e"].at(1.0) == pytest.approx(high, rel=1e-12)
    jumps = [e for e in run.events if e.t > 0]
    assert jumps and max(abs(e.t - 0.2**0.5) for e in jumps) < 1e-9
    given = sum(e.steps[-1].impulses["V.f"] for e in jumps)
    assert given == pytest.approx(1e-3 * (high - low), rel=1e-9)
    assert run.audit().holds()
