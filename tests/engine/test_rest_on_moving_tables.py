"""Hand-written impact laws that come to rest on what moves: ``u - eps*(pre(v.f) - u)``.

Oracle: seen from a table of constant speed a ball bounces as on a floor, so that its impacts end
after ``t1 + 2 v1 eps/(g (1 - eps))``.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

G = 9.81


LAW = "u - eps*(pre(v.f) - u)"


def ball(speed: float, eps: float = 0.5, height: float = 1.0, law: str = LAW) -> hb.Model:
    m = hb.Model(
        "ball",
        domain="translational",
        parameters={"eps": str(eps), "u": f"{speed} m/s"},
    )
    m.add(weight=hb.Se(f"{-G} N"), ball=hb.I("1 kg"), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf(law))
    m.bond("weight -> v -> ball", "rebound -> contact -> v")
    m.signal(height=hb.Integral("v.f - u", start=f"{height} m"), floor=hb.Integral("v.f", start=0))
    m.machine(
        "table",
        states={"away": [], "impact": ["contact"]},
        start="away",
        rules=["away -> impact when height <= 0 and v.f < u", "impact -> away when pre(v.f) >= u"],
    )
    return m


def end_of(speed: float, eps: float, height: float = 1.0) -> float:
    fast = math.sqrt(speed**2 + 2.0 * G * height)
    return (fast - speed) / G + 2.0 * fast * eps / (G * (1.0 - eps))


@pytest.mark.parametrize("speed", [0.3, -0.3, 2.0, 0.0])
@pytest.mark.parametrize("eps", [0.5, 0.8])
def test_a_ball_comes_to_rest_on_a_table_that_moves(speed: float, eps: float) -> None:
    run = hb.simulate(ball(speed, eps), "6 s")
    assert run.status == "ok"
    (landed,) = run.accumulations
    assert landed.t == pytest.approx(end_of(speed, eps), rel=1e-6)
    assert float(run["v.f"].at(5.5)) == pytest.approx(speed, abs=1e-12)
    assert float(run["height"].at(5.5)) == pytest.approx(0.0, abs=1e-12)
    # it is carried by its weight, and by nothing else
    assert float(run["rebound.e"].at(5.5)) == pytest.approx(G, rel=1e-9)


def test_a_parameter_that_is_varied_moves_the_table() -> None:
    for speed in (0.25, -0.4):
        run = hb.simulate(ball(0.3), "4 s", parameters={"u": f"{speed} m/s"})
        assert float(run["v.f"].at(3.9)) == pytest.approx(speed, abs=1e-12)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("mu", "rebound"), [(0.2, 0.5), (0.1, 0.7)])
def test_a_ball_that_comes_to_rest_on_a_belt_creates_nothing(
    mu: float, rebound: float, turned: bool
) -> None:
    """All impulses of the floor carry the weight, and friction has its part of them: ``mu g t``.

    What rest takes back of the last rebound is pulled, and so was friction: it drove the belt.
    """
    m = hb.Model("belt")
    m.add(belt=hb.Sf(-5.0 if turned else 5.0), u=hb.One(), n=hb.Zero(), mx=hb.I(1.0), my=hb.I(1.0))
    m.add(vx=hb.One(), vy=hb.One(), weight=hb.Se(-9.81))
    m.add(floor=hb.Zero(law="unilateral", gap="height", restitution=rebound))
    m.add(slip=hb.One(law="coulomb", limit=f"{mu}*floor.e", impulsive=True))
    m.bond("vx -> n -> u" if turned else "u -> n -> vx", "belt -> u", "n -> slip")
    m.bond("vx -> mx", "weight -> vy -> my", "floor -> vy")
    m.signal(height=hb.Integral("vy.f", start=0.3))
    fall = (0.6 / 9.81) ** 0.5
    rest = fall * (1.0 + rebound) / (1.0 - rebound)
    run = hb.simulate(m, rest + 0.2)
    way = -1.0 if turned else 1.0
    assert way * run["vx.f"].at(rest + 0.2) == pytest.approx(mu * 9.81 * (rest + 0.2), rel=1e-8)
    assert not run.warnings and run.audit().created < 1e-12 and run.audit().holds()
    (rested,) = [e for e in run.events if e.cause == "accumulation"]
    assert rested.t == pytest.approx(rest, rel=1e-8)
    assert rested.steps[0].energy.lost > 0.0
