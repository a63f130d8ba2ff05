"""Time-stepping of contacts that press a spring: they stay closed until the spring is relaxed."""

import math

import pytest

import hybond as hb

G = 9.81


def foot(up: int = 1, swing: float = 0.0, edge: str = "0") -> hb.Model:
    """A body on a spring whose foot stands on the floor, with its speed counted up or down."""
    sag = 1e-2 * G
    m = hb.Model("foot", domain="translational")
    m.add(
        M=hb.I("100 kg", f=swing), v=hb.One(), weight=hb.Se(-up * 100 * G), spring=hb.C(1e-4, q=sag)
    )
    m.add(press=hb.One(), floor=hb.Zero(law="unilateral", gap=f"{up}*y + spring.q + ({edge})"))
    m.bond("weight -> v -> M", "floor -> v" if up > 0 else "v -> floor")
    m.bond("floor -> press -> spring")
    m.signal(y=hb.Integral("v.f", -up * sag))
    return m


@pytest.mark.parametrize(("up", "step", "theta"), [(1, 1e-2, 0.5), (-1, 1e-2, 1), (1, 3e-3, 0.5)])
def test_a_body_at_rest_does_not_fall_through_its_spring(
    up: int, step: float, theta: float
) -> None:
    """The gap was zero and then rounding of it: the contact opened, and the spring lost all."""
    run = hb.simulate(foot(up), 20.0, method=hb.MoreauJean(step=step, theta=theta))
    assert len(run.events) == 1
    assert run["y"].at(20.0) == pytest.approx(-up * 1e-2 * G, rel=1e-9)
    assert run["floor.e"].at(20.0) == pytest.approx(100 * G, rel=1e-9)


def test_a_body_swings_on_its_foot_and_keeps_its_energy() -> None:
    """As the midpoint rule swings: with tan(w*h/2) = w0*h/2, and no loss."""
    run = hb.simulate(foot(swing=0.5), 20.0, method=hb.MoreauJean(step=1e-2))
    w = 2 / 1e-2 * math.atan(10 * 1e-2 / 2)
    assert len(run.events) == 1
    assert run["v.f"].at(20.0) == pytest.approx(0.5 * math.cos(w * 20.0), abs=1e-8)


def test_a_cage_is_lowered_on_a_rope_that_stretches() -> None:
    """Its speed is that of the drum until it stands on the floor, and the rope is slack then."""
    m = hb.Model("hoist", domain="translational")
    m.add(M=hb.I("100 kg", f=-0.5), v=hb.One(), weight=hb.Se(-100 * G), drum=hb.Sf(-0.5))
    m.add(rope=hb.Zero(law="unilateral", gap="y - x + pull.q"), pull=hb.C(1e-4, q=1e-2 * G))
    m.add(stretch=hb.One(), floor=hb.Zero(law="unilateral", gap="y + 1"))
    m.bond("drum -> rope -> v", "rope -> stretch -> pull", "weight -> v -> M", "floor -> v")
    m.signal(x=hb.Integral("drum.f", 1e-2 * G), y=hb.Integral("v.f"))
    run = hb.simulate(m, 3.0, method=hb.MoreauJean(step=1e-3))
    assert run["v.f"].at(1.9) == pytest.approx(-0.5)
    assert run["rope.e"].at(1.9) == pytest.approx(100 * G)
    told = [event.t for event in run.events[1:]]
    assert told == pytest.approx([2.0, 2.0 + 1e-2 * G / 0.5], abs=2e-3)


def test_a_foot_goes_over_the_edge_of_a_table() -> None:
    """The gap jumps by a metre after half a second: the contact opens, and the body falls."""
    m = foot(edge="if time < 0.5 [s] then 0 else 1")
    run = hb.simulate(m, 0.8, method=hb.MoreauJean(step=1e-3))
    assert run["v.f"].at(0.8) == pytest.approx(-0.3 * G, abs=0.02)
    assert run["spring.q"].at(0.8) == 0.0
