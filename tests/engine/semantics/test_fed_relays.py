"""Relays that a source feeds: nothing holds their common variable at zero but the loop around."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def closed_loop(law: str, drive: str = "0.5 - rel.e", fed: str = "c.q") -> hb.Model:
    m = hb.Model("loop")
    m.add(c=hb.C(1.0, q=1.0), n=hb.Zero(), s=hb.Sf(drive), y=hb.Sf(fed))
    m.add(rel=hb.One(law=law, limit=1.0))
    m.bond("s -> n -> c", "y -> rel")
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau", "exact"])
@pytest.mark.parametrize("law", ["relay", "coulomb"])
def test_a_relay_in_a_feedback_loop_slides(law: str, solver: str) -> None:
    """q' = 0.5 - sign(q): to zero at t = 2, and there the relay gives 0.5 in the mean."""
    run = hb.simulate(closed_loop(law), until=5.0, solver=solver)
    assert run.status == "ok"
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(2.0)
    assert run["c.q"].at(1.0) == pytest.approx(0.5)
    assert run["c.q"].at(5.0) == pytest.approx(0.0, abs=1e-12)
    assert run["s.f"].at(3.0) == pytest.approx(0.0, abs=1e-9)


def test_a_relay_with_more_to_say_than_its_limit_crosses() -> None:
    run = hb.simulate(closed_loop("relay", drive="-1.5 - rel.e"), until=5.0)
    assert run["c.q"].at(5.0) == pytest.approx(-0.5 * (5.0 - 0.4))


def test_a_double_integrator_slides_on_a_line() -> None:
    """u = -sign(x + v): from x + v = 0 on, x' = -x."""
    m = hb.Model("double")
    m.add(m=hb.I(1.0), v=hb.One(), u=hb.Se("-2*rel.f"), y=hb.Se("x + v.f"))
    m.add(rel=hb.Zero(law="relay", limit=0.5))
    m.bond("u -> v -> m", "y -> rel")
    m.signal(x=hb.Integral("v.f", start=1.0))
    run = hb.simulate(m, until=4.0)
    begin = math.sqrt(3.0) - 1.0
    assert run.sliding[0].t0 == pytest.approx(begin)
    x = (1.0 - 0.5 * begin**2) * math.exp(begin - 4.0)
    assert run["x"].at(4.0) == pytest.approx(x, rel=1e-6)


def test_a_relay_behind_a_transformer_slides() -> None:
    m = hb.Model("behind")
    m.add(c=hb.C(1.0, q=1.0), n=hb.Zero(), s=hb.Sf("0.5 - rel.e"), y=hb.Sf("c.q"), k=hb.TF(2.0))
    m.add(rel=hb.One(law="relay", limit=1.0), w=hb.One())
    m.bond("s -> n -> c", "y -> k.1", "k.2 -> w", "w -> rel")
    run = hb.simulate(m, until=5.0)
    assert run.status == "ok"
    assert run.sliding[0].t0 == pytest.approx(2.0)
    assert run["c.q"].at(5.0) == pytest.approx(0.0, abs=1e-12)


def test_a_relay_without_feedback_is_a_sign() -> None:
    m = hb.Model("open loop")
    m.add(y=hb.Sf("sin(time/(1 [s]))"), rel=hb.One(law="relay", limit="2 + time/(1 [s])"))
    m.bond("y -> rel")
    m.signal(area=hb.Integral("rel.e"))
    run = hb.simulate(m, until=3.0 * math.pi)
    for t in (1.0, 4.0, 8.0):
        assert run["rel.e"].at(t) == pytest.approx((2.0 + t) * np.sign(math.sin(t)))
    # 2 + t over three half periods of changing sign
    halves = [2.0 * math.pi + 0.5 * math.pi**2 * (2 * k + 1) for k in range(3)]
    assert run["area"].at(3.0 * math.pi) == pytest.approx(halves[0] - halves[1] + halves[2])


def test_what_a_body_moves_is_no_fed_relay() -> None:
    """Its force acts on the body: it sticks."""
    m = hb.Model("belt")
    m.add(m=hb.I(1.0, p=1.0), v=hb.One(), rub=hb.One(law="coulomb", limit=0.5), belt=hb.Sf(0.0))
    m.add(n=hb.Zero())
    m.bond("v -> m", "v -> n", "belt -> n", "n -> rub")
    run = hb.simulate(m, until=5.0)
    assert run["m.p"].at(1.0) == pytest.approx(0.5)
    assert run["m.p"].at(5.0) == 0.0
    assert run.events[-1].steps[-1].fired[0].target == "sticks"
