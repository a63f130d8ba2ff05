"""Accumulation in the exported runtime: impacts end where they do in the reference."""

import pytest
from portable_runs import assert_the_same

import hybond as hb


def balls(*which):
    """Balls of mass 1, 2, ... over one floor, each with its restitution and height."""
    m = hb.Model("balls", domain="translational")
    for k, (eps, height) in enumerate(which, 1):
        parts = {"w": hb.Se(f"-9.81*{k}"), "b": hb.I(k), "v": hb.One(), "c": hb.Zero()}
        parts["r"] = hb.Sf(f"-{eps}*pre(v{k}.f)")
        m.add(**{f"{name}{k}": part for name, part in parts.items()})
        m.bond(f"w{k} -> v{k} -> b{k}", f"c{k} -> v{k}", f"r{k} -> c{k}")
        m.signal(**{f"h{k}": hb.Integral(f"v{k}.f", start=height)})
        m.machine(
            f"F{k}",
            states={"away": [], "impact": [f"c{k}"]},
            start="away",
            rules=[
                f"away -> impact when h{k} <= 0 and v{k}.f < 0",
                f"impact -> away when pre(b{k}.p) >= 0",
            ],
        )
    return m


@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("which", [[(0.5, 1.0)], [(0.0, 1.0)], [(0.3, 1.0), (0.5, 0.4)]])
def test_balls_land_where_they_do_in_the_reference(which, solver, monkeypatch):
    a, b = assert_the_same(balls(*which), monkeypatch, until=2.5, solver=solver)
    assert sum(e[1] == "accumulation" for e in b.events) == len(which) == len(a.accumulations)


def test_a_landed_ball_leaves_when_its_reaction_turns(monkeypatch):
    """A pull that grows lifts the ball off the floor that it has come to rest on."""
    m = balls((0.4, 0.5))
    m.add(pull=hb.Se("4*time"))
    m.bond("pull -> v1")
    _, b = assert_the_same(m, monkeypatch, until=3)
    assert b.events[-1][2][-1][1] == [("F1", "impact", "away")]
    assert b.events[-1][0] == pytest.approx(9.81 / 4)


@pytest.mark.parametrize("eps", [0.0, 0.3])
def test_a_contact_with_a_law_comes_to_rest_closed(eps, monkeypatch):
    m = hb.Model("drop", domain="translational")
    m.add(w=hb.Se("-9.81 N"), b=hb.I("1 kg"), v=hb.One())
    m.add(c=hb.Zero(law="unilateral", gap="h", restitution=eps))
    m.bond("w -> v -> b", "c -> v")
    m.signal(h=hb.Integral("v.f", start="0.5 m"))
    _, b = assert_the_same(m, monkeypatch, until=1.5)
    assert b.events[-1][2][-1][1][0][2] == "closed"
