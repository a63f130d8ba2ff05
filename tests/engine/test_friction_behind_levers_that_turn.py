"""Dry friction without inertia of its own, behind a two-port whose modulus changes, holds at rest.

What slides is zero there but for the rounding of what is stored before the lever. A mass of 1 kg at
1 m/s is slowed by 2 N on the arm ``1.1 + 0.7*x`` and pushed on by 0.5 N: ``v^2/2`` is
``1/2 - 1.7*x - 0.7*x^2``, and at the root of that it rests.
"""

import math

import pytest

import hybond as hb

STOPS = (math.sqrt(1.7**2 + 1.4) - 1.7) / 1.4
ARM = "1.1 + 0.7*x"
WAYS = {
    "a lever": ["v -> lever", "lever -> rub"],
    "its bonds turned": ["rub -> lever.2", "lever.1 -> v"],
    "a junction between": ["v -> lever", "lever -> far", "far -> rub"],
    "two levers": ["v -> half", "half -> lever", "lever -> rub"],
    "a gyrator": ["v -> turn", "turn -> grip"],
    "sources for a lever": ["v -> given", "taken -> rub"],
}


def slowed(
    way: str, size: float = 1.0, arm: str = ARM, push: str = "0.5*size", **options: float
) -> hb.Model:
    """Return the mass, its push, and friction behind `way`; forces and masses times `size`."""
    m = hb.Model("arm", parameters={"size": size})
    m.add(mass=hb.I("size", f=1.0), push=hb.Se(push), v=hb.One())
    m.bond("v -> mass", "push -> v", *WAYS[way])
    m.signal(x=hb.Integral("v.f"))
    options = {name: value * size for name, value in options.items()}
    if way == "a gyrator":
        m.add(turn=hb.GY(arm), grip=hb.Zero(law="coulomb", limit=2.0 * size, **options))
        return m
    m.add(rub=hb.One(law="coulomb", limit=2.0 * size, **options))
    if way == "sources for a lever":
        m.add(given=hb.Se(f"({arm})*taken.e"), taken=hb.Sf(f"({arm})*v.f"))
        return m
    m.add(lever=hb.TF(f"({arm})/2" if way == "two levers" else arm))
    if way == "two levers":
        m.add(half=hb.TF("2*cos(x - x)"))
    elif way == "a junction between":
        m.add(far=hb.One())
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("way", WAYS)
def test_friction_behind_an_arm_that_changes_holds_at_rest(way: str, solver: str) -> None:
    run = hb.simulate(slowed(way), 3.0, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert len(run.events) == 2 and run["x"].at([2.0, 3.0]) == pytest.approx(STOPS, rel=1e-8)
    assert run["v.f"].at(3.0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("size", [1e-9, 1e6])
@pytest.mark.parametrize("options", [{}, {"breakaway": 3.0}])
def test_in_any_unit_and_with_any_breakaway(size: float, options: dict[str, float]) -> None:
    run = hb.simulate(slowed("a lever", size, **options), 3.0)
    assert len(run.events) == 2 and run["x"].at(3.0) == pytest.approx(STOPS, rel=1e-8)


def test_it_breaks_loose_again_where_a_growing_push_says() -> None:
    """At rest the arm is ``1.1 + 0.7*x``, times a breakaway of 3 N."""
    push = "0.5 + (if time > 1 then time - 1 else 0)"
    m = slowed("a lever", push=push, breakaway=3.0)
    loose = 0.5 + 3.0 * (1.1 + 0.7 * STOPS)
    run = hb.simulate(m, loose + 0.5)
    assert run.events.t[2] == pytest.approx(loose, rel=1e-8) and len(run.events) == 3


def test_an_arm_that_time_changes() -> None:
    """``v' = 0.5 - 2*(1.1 + 0.1*t)`` from 1 m/s."""
    m = slowed("a lever", arm="1.1 + 0.1*time")
    stops = (math.sqrt(1.7**2 + 0.4) - 1.7) / 0.2
    run = hb.simulate(m, 3.0)
    assert run.events.t[1] == pytest.approx(stops, rel=1e-9) and len(run.events) == 2


def test_a_crank_stops_by_the_friction_of_its_slider() -> None:
    """Flywheel, and a slider without mass that rubs: ``J*w^2/2`` is spent on its way."""
    m = hb.Model("crank", domain="rotational", parameters={"r": "50 mm", "l": "150 mm"})
    m.add(wheel=hb.I("0.02 kg*m^2", f="5 rad/s"), w=hb.One())
    m.add(crank=hb.Submodel("rotational.crank_slider", r="r", l="l", angle0="0.2 rad"))
    m.add(rub=hb.One(law="coulomb", limit="3 N", domain="translational"))
    m.bond("w -> wheel", "w -> crank.crank", "crank.slider -> rub")
    run = hb.simulate(m, 2.0)
    # in from 0.2 rad to 180 degrees, and out again for the rest of 0.25 J
    begin = 0.05 * math.cos(0.2) + math.sqrt(0.15**2 - (0.05 * math.sin(0.2)) ** 2)
    way = 0.25 / 3.0
    assert way < begin - 0.1
    assert run["crank.position"].at(2.0) == pytest.approx(begin - way, rel=1e-8)
    assert len(run.events) == 2 and run["w.f"].at(2.0) == 0.0
