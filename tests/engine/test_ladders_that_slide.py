"""A ladder slides down a smooth wall and a smooth floor, held by contacts that have gaps.

Its gaps are zero by the constraints of the contacts: the error of a step that stages see in them is
no motion. A uniform ladder of length 2 has ``w^2 = 3/2 g (sin th0 - sin th)`` by its energy, and
leaves the wall where ``sin th = 2/3 sin th0``.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

G, BEGAN = 9.81, 1.2


def ladder(*, laws: bool, turned: bool) -> hb.Model:
    """Return a ladder held by contacts with gaps, or by rails."""
    m = hb.Model("ladder")
    at_wall = {"law": "unilateral", "gap": "x"} if laws else {}
    at_floor = {"law": "unilateral", "gap": "y"} if laws else {}
    m.add(mx=hb.I(1.0), my=hb.I(1.0), j=hb.I(1.0 / 3.0), weight=hb.Se(-G))
    m.add(vx=hb.One(), vy=hb.One(), w=hb.One(), wall=hb.Zero(**at_wall), floor=hb.Zero(**at_floor))
    m.add(stands=hb.Sf(0.0), lies=hb.Sf(0.0), across=hb.TF("-sin(th)"), along=hb.TF("cos(th)"))
    m.bond("mx -> vx" if turned else "vx -> mx", "vy -> my", "w -> j", "weight -> vy")
    m.bond("wall -> vx", "w -> across -> wall", "stands -> wall")
    m.bond("floor -> vy", "w -> along -> floor", "lies -> floor")
    m.signal(th=hb.Integral("w.f", start=BEGAN))
    m.signal(x=hb.Integral("vx.f + sin(th)*w.f", start=0.0))
    m.signal(y=hb.Integral("vy.f - cos(th)*w.f", start=0.0))
    return m


@pytest.mark.parametrize(("solver", "until"), [("auto", 0.5), ("radau", 0.1)])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("laws", [True, False])
def test_gaps_that_constraints_hold_at_zero_ask_for_no_steps(
    laws: bool, turned: bool, solver: str, until: float
) -> None:
    run = hb.simulate(ladder(laws=laws, turned=turned), until, solver=solver)
    angle, speed = run["th"].at(until), run["w.f"].at(until)
    assert speed**2 == pytest.approx(1.5 * G * (math.sin(BEGAN) - math.sin(angle)), rel=1e-6)
    assert abs(run["x"].at(until)) < 1e-7 and abs(run["y"].at(until)) < 1e-7
    assert run.stats["steps"] < (100 if solver == "auto" else 1000)
    assert run.audit().holds()


def test_a_ladder_leaves_the_wall() -> None:
    run = hb.simulate(ladder(laws=True, turned=False), 0.6)
    assert math.sin(run["th"].at(run.events.t[1])) == pytest.approx(
        2.0 / 3.0 * math.sin(BEGAN), rel=1e-6
    )
    assert run.stats["steps"] < 300 and run.audit().holds()
