"""An impact at the start is of the speed that is stored, whatever laws stand beside the contact.

The branches that laws are declared with are rest, and open: where a friction junction moves from
the beginning, a speed before the impact that counts it as resting is nobody's.
"""

from __future__ import annotations

import pytest

import hybond as hb


@pytest.mark.parametrize("name", ["a", "z"])
@pytest.mark.parametrize("law", ["relay", "coulomb"])
@pytest.mark.parametrize("rebound", [0.0, 0.5, 1.0])
def test_a_body_that_slides_at_the_start_rebounds_by_its_own_speed(
    law: str, name: str, rebound: float
) -> None:
    """A wall that moves at 0.3 m/s meets a body that moves at 0.1 m/s, with friction beside it."""
    m = hb.Model("wall")
    m.add(body=hb.I(2.0, p=0.2), v=hb.One(), wall=hb.Sf(0.3))
    m.add(hits=hb.Zero(law="unilateral", restitution=rebound))
    m.add(**{name: hb.One(law=law, limit=0.4)})
    m.bond("wall -> hits", "hits -> v", "v -> body", f"v -> {name}")
    run = hb.simulate(m, 1e-6)
    assert run["body.f"].at(0.0) == pytest.approx(0.3 + rebound * 0.2, rel=1e-12)
    assert run.audit().holds()


@pytest.mark.parametrize("rebound", [0.25, 0.75])
def test_two_bodies_that_both_slide_keep_their_momentum(rebound: float) -> None:
    """Newton's law for two bodies on a rough floor: m1 v1 + m2 v2 stays, v_rel turns round."""
    m = hb.Model("two")
    m.add(one=hb.I(1.0, p=3.0), two=hb.I(2.0, p=2.0), u=hb.One(), v=hb.One())
    m.add(hits=hb.Zero(law="unilateral", restitution=rebound))
    m.add(a=hb.One(law="coulomb", limit=0.4), b=hb.One(law="coulomb", limit=0.1))
    m.bond("u -> one", "u -> hits", "hits -> v", "v -> two", "u -> a", "v -> b")
    run = hb.simulate(m, 1e-6)
    fast, slow = run["one.f"].at(0.0), run["two.f"].at(0.0)
    assert fast + 2.0 * slow == pytest.approx(5.0, rel=1e-12)
    assert slow - fast == pytest.approx(rebound * 2.0, rel=1e-12)
    assert run.audit().holds()


def test_a_store_behind_a_relay_of_flow_rebounds_by_its_own_effort() -> None:
    """The dual: an effort that a contact of efforts turns round."""
    m = hb.Model("store")
    m.add(store=hb.C(2.0, q=0.2), e=hb.Zero(), drive=hb.Se(0.3))
    m.add(hits=hb.One(law="unilateral", restitution=0.5))
    m.add(r=hb.Zero(law="relay", limit=0.4))
    m.bond("drive -> hits", "hits -> e", "e -> store", "e -> r")
    run = hb.simulate(m, 1e-6)
    assert run["store.e"].at(0.0) == pytest.approx(0.3 + 0.5 * 0.2, rel=1e-12)
    assert run.audit().holds()


def test_a_body_with_a_diode_beside_it_rebounds_by_its_own_speed() -> None:
    """A one-way clutch that runs free from the start."""
    m = hb.Model("clutch")
    m.add(body=hb.I(2.0, p=0.2), v=hb.One(), wall=hb.Sf(0.3), free=hb.One(law="diode"))
    m.add(hits=hb.Zero(law="unilateral", restitution=0.5))
    m.bond("wall -> hits", "hits -> v", "v -> body", "v -> free")
    run = hb.simulate(m, 1e-6)
    assert run["body.f"].at(0.0) == pytest.approx(0.4, rel=1e-12)
    assert run.audit().holds()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_what_shares_a_junction_comes_together_before_it_strikes(order: tuple[int, ...]) -> None:
    """Three capacitors at voltages of their own: the contact meets what they have in common."""
    given = [(0.33, 0.00878), (5.7, 0.0), (2.0, -0.9)]
    for reach in (1.0, -1.0):
        m = hb.Model("shared")
        for k in order:
            m.add(**{f"c{k}": hb.C(given[k][0], q=reach * given[k][1])})
        m.add(node=hb.Zero(), hits=hb.One(law="unilateral", restitution=0.5), far=hb.Zero())
        m.bond(*(f"node -> c{k}" for k in order), "node -> hits", "hits -> far")
        m.add(ground=hb.Se(0.0))
        m.bond("far -> ground")
        run = hb.simulate(m, 1e-6)
        common = reach * sum(q for _, q in given) / sum(c for c, _ in given)
        # ON holds the effort at zero, and what comes towards it from above turns round
        after = -0.5 * common if common > 0.0 else common
        for k in range(3):
            assert run[f"c{k}.e"].at(0.0) == pytest.approx(after, rel=1e-12)
        assert run.status == "ok"
        assert not run.warnings
