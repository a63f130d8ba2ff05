"""Dry friction beside or in a jump: it holds, or slides with an impulse of its own sign.

Each on 1-junctions with capacitors (what is common is a flow), and dually on 0-junctions with
coils. Where nothing else is cited the answers are one line of algebra.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

DUALS = pytest.mark.parametrize("dual", [False, True], ids=["capacitor", "coil"])


def limited(dual: bool, stored: float, push: float | str | None = None, **law: float | str):
    """Return a storage whose co-energy variable a friction law limits, perhaps with a source."""
    m = hb.Model("limited")
    if dual:
        m.add(v=hb.One(), j=hb.Zero(law="coulomb", **law), x=hb.I(2.0, p=stored))
    else:
        m.add(v=hb.Zero(), j=hb.One(law="coulomb", **law), x=hb.C(2.0, q=stored))
    m.bond("v -> x", "v -> j")
    if push is not None:
        m.add(s=hb.Se(push) if dual else hb.Sf(push))
        m.bond("s -> v")
    return m


def beside(m: hb.Model, dual: bool, time: float) -> None:
    """Add a part on its own that jumps at a time: a switch empties a storage of 0.7."""
    if dual:
        m.add(n=hb.One(), y=hb.I(1.0, p=0.7))
    else:
        m.add(n=hb.Zero(), y=hb.C(1.0, q=0.7))
    m.bond("n -> y")
    m.machine(
        "m", states={"on": ["n"], "off": []}, start="on", rules=[f"on -> off when time >= {time}"]
    )


@DUALS
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("engine", ["library", "python"])
def test_what_is_stored_beyond_the_limit_jumps_to_it(dual: bool, way: float, engine: str) -> None:
    run = hb.simulate(limited(dual, way * 1.5, limit=0.4), until=1.0, engine=engine)
    x = "x.p" if dual else "x.q"
    assert run[x].at(0.5) == pytest.approx(way * 0.8, abs=1e-12)
    (event,) = run.trace.events
    (step,) = [s for s in event.steps if s.impulses]
    # the junction takes what the storage loses, with a force of its own sign
    common = step.impulses["j.e" if dual else "j.f"]
    assert common == pytest.approx(way * 0.7, abs=1e-12)
    assert step.energy.lost == pytest.approx((1.5**2 - 0.8**2) / 4.0, abs=1e-12)


@DUALS
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_breaking_loose_jumps_down_to_the_sliding_limit(dual: bool, way: float) -> None:
    m = limited(dual, 0.0, way * 1.0, limit=0.8, breakaway=1.2)
    run = hb.simulate(m, until=5.0)
    # up to 2 * 1.2 at a rate of 1, down to 2 * 0.8, which holds: 2.4, 3.2, 4.0, 4.8
    jumps = [e.t for e in run.trace.events if e.t > 0.0]
    assert jumps == pytest.approx([2.4, 3.2, 4.0, 4.8], abs=1e-9)
    assert run["x.p" if dual else "x.q"].at(5.0) == pytest.approx(way * 1.8, abs=1e-9)


@DUALS
def test_friction_that_holds_is_left_alone_by_another_jump(dual: bool) -> None:
    m = limited(dual, 0.9, limit=0.8)
    beside(m, dual, 0.5)
    run = hb.simulate(m, until=1.0)
    assert run["x.p" if dual else "x.q"].at(1.0) == 0.9
    assert run["y.p" if dual else "y.q"].at(1.0) == 0.0
    assert run.mode["j"] == "sticks"


@DUALS
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_friction_that_slides_goes_on_through_another_jump(dual: bool, way: float) -> None:
    limit = "0.8 + 0.2*sin(time/(1 s))"
    m = limited(dual, way * 1.6, way * 1.0, limit=limit)
    beside(m, dual, 0.5)
    run = hb.simulate(m, until=1.0, rtol=1e-8)
    # x = 2 * limit; the junction has what the source gives and the storage does not take
    x = "x.p" if dual else "x.q"
    for t in (0.4, 0.9):
        assert run[x].at(t) == pytest.approx(way * (1.6 + 0.4 * math.sin(t)), abs=1e-9)
        common = way * (1.0 - 0.4 * math.cos(t))
        assert run["j.e" if dual else "j.f"].at(t) == pytest.approx(common, abs=1e-9)
    assert run["y.p" if dual else "y.q"].at(1.0) == 0.0
    for e in run.trace.events:
        for s in e.steps:
            assert abs(s.impulses.get("x.e" if dual else "x.f", 0.0)) < 1e-9


@DUALS
def test_held_friction_and_a_diode_share_an_impulse_rightly(dual: bool) -> None:
    """A current against a diode ends; friction in the loop holds or takes part, by its limit."""
    for stored, limit in ((0.471, 1.388), (2.0, 1.388)):
        m = hb.Model("stop")
        law = {"law": "coulomb", "limit": limit}
        if dual:
            m.add(d=hb.Zero(law="diode"), j=hb.One(**law), x=hb.C(1.0, q=-stored))
        else:
            m.add(d=hb.One(law="diode"), j=hb.Zero(**law), x=hb.I(1.0, p=stored))
        m.bond("x -> d", "j -> d")
        run = hb.simulate(m, until=1.0)
        assert run["x.q" if dual else "x.p"].at(0.5) == pytest.approx(0.0, abs=1e-12)
        assert run.mode["j"] == "sticks"


@DUALS
def test_a_step_between_the_limits_keeps_the_branch(dual: bool) -> None:
    """Rest holds up to 1.2 and sliding goes on down to 0.8, whatever steps between them."""
    m = hb.Model("steps")
    levels = [0.5, 1.0, 1.3, 1.0, -1.0, -1.3, -1.0, 0.5, 1.0, 1.3]
    m.input(u=hb.Input(table=[[float(t), u] for t, u in enumerate(levels)]))
    law = {"law": "coulomb", "limit": 0.8, "breakaway": 1.2}
    if dual:
        m.add(j=hb.Zero(**law), s=hb.Sf("u"), r=hb.G(2.0))
    else:
        m.add(j=hb.One(**law), s=hb.Se("u"), r=hb.R(2.0))
    m.bond("s -> j", "j -> r")
    run = hb.simulate(m, until=10.0)
    found = [run["r.e" if dual else "r.f"].at(t + 0.5) for t in range(10)]
    # +- (|u| - 0.8) / 2 where it slides
    wanted = [0.0, 0.0, 0.25, 0.1, 0.0, -0.25, -0.1, 0.0, 0.0, 0.25]
    assert found == pytest.approx(wanted, abs=1e-12)


@DUALS
@pytest.mark.parametrize("engine", ["library", "python"])
def test_friction_beside_a_diode_is_judged_by_all_that_acts_on_it(dual: bool, engine: str) -> None:
    """The blocking diode leaves the limiter with the coil's current alone, which it holds."""
    m = hb.Model("loop")
    law = {"law": "coulomb", "limit": 1.094}
    if dual:
        m.add(a=hb.One(), j=hb.One(**law), d=hb.Zero(law="diode"))
        m.add(x=hb.C(1.0, q=-0.104), y=hb.I(1.0, p=0.517))
    else:
        m.add(a=hb.Zero(), j=hb.Zero(**law), d=hb.One(law="diode"))
        m.add(x=hb.I(1.0, p=-0.104), y=hb.C(1.0, q=-0.517))
    m.bond("a -> j", "y -> d", "a -> x", "d -> j")
    run = hb.simulate(m, until=1.0, engine=engine)
    assert run["x.q" if dual else "x.p"].at(1.0) == pytest.approx(-0.104, abs=1e-12)
