"""What is between equal motions is the rounding of their difference: it decides no step."""

from __future__ import annotations

import pytest

import hybond as hb

G = 9.81


def falling(stop: str, **parameters: object) -> hb.Model:
    """Return two bodies of different mass that fall side by side from rest, a stop between them."""
    m = hb.Model("falling", domain="translational")
    m.add(
        heavy=hb.Submodel("translational.mass", m="300 kg"),
        weight=hb.Submodel("translational.weight", m="300 kg"),
        light=hb.Submodel("translational.mass", m="40 kg"),
        lightness=hb.Submodel("translational.weight", m="40 kg"),
        stop=hb.Submodel(stop, **parameters),
    )
    m.bond("heavy.flange -> weight.flange", "light.flange -> lightness.flange")
    m.bond("light.flange -> stop.case", "stop.flange -> heavy.flange")
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("stop", ["bump_stop", "hunt_crossley_stop", "elastic_end_stop"])
def test_bodies_that_fall_side_by_side_fall(stop: str, solver: str) -> None:
    run = hb.simulate(falling(f"translational.{stop}"), until="2 s", solver=solver)
    assert run["light.momentum"].at(2.0) == pytest.approx(-40.0 * G * 2.0, rel=1e-9)
    assert run["heavy.position"].at(2.0) == pytest.approx(-0.5 * G * 4.0, rel=1e-8)
    assert abs(run["stop.position"].at(2.0)) < 1e-12
    assert run.stats["steps"] < 6000


def test_shafts_that_turn_alike_do_not_feel_their_backlash() -> None:
    m = hb.Model("shafts", domain="rotational")
    m.add(
        one=hb.Submodel("rotational.inertia", J="0.3 kg*m^2"),
        other=hb.Submodel("rotational.inertia", J="0.7 kg*m^2"),
        drive=hb.Submodel("rotational.torque", inputs={"torque": "0.9*sin(3*time)"}),
        equal=hb.Submodel("rotational.torque", inputs={"torque": "2.1*sin(3*time)"}),
        play=hb.Submodel("rotational.elastic_backlash"),
    )
    m.bond("drive.shaft -> one.shaft -> play.left", "equal.shaft -> other.shaft")
    m.bond("play.right -> other.shaft")
    run = hb.simulate(m, until=2.0943951023931953)  # a period, after which both stand still
    assert abs(run["one.speed"].at(run.t_end)) < 1e-8
    assert float(run["other.speed"].max()) == pytest.approx(2.0, rel=1e-8)
    assert len(run.events) == 1


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("torque", [1e-6, 1.0, 1e6, 1e12])
def test_heat_begins_from_nothing_in_any_unit(torque: float, solver: str) -> None:
    m = hb.Model("clutch", domain="rotational", parameters={"M": torque})
    m.add(
        turns=hb.Sf(30.0),
        stands=hb.Sf(10.0),
        clutch=hb.Submodel("rotational.clutch", inputs={"capacity": "K"}),
        fast=hb.One(),
        slow=hb.One(),
    )
    m.bond("turns -> fast -> clutch.left", "clutch.right -> slow -> stands")
    m.input(K=hb.Input(table=[[0, 0], [1.0, 0], [1.5, 60.0 * torque]], linear=True))
    run = hb.simulate(m, until="3 s", rtol=1e-9, solver=solver)
    ramp, flat = 0.5 * 20.0 * 60.0 * torque * 0.5, 20.0 * 60.0 * torque * 1.5
    assert run["clutch.heat"].at(1.25) == pytest.approx(0.25 * ramp, rel=1e-8)
    assert run["clutch.heat"].at(3.0) == pytest.approx(ramp + flat, rel=1e-8)
    assert run.stats["steps"] < 300


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("size", [1.0, 1e6])
def test_a_storage_behind_one_that_a_difference_fills(
    size: float, width: float, solver: str, turned: bool
) -> None:
    """Before the pulse ``1 - tanh^2`` is steps of its last place, and what is behind is of them."""
    m = hb.Model("two")
    m.add(F=hb.Sf(f"{size}*(1 - tanh((time - 0.5)/{width})^2)"), a=hb.C("1 uF"), b=hb.C("3 uF"))
    m.add(n=hb.Zero(), k=hb.Zero(), v=hb.One(), R=hb.R("1 kohm"))
    m.bond(
        "F -> n", "a -> n" if turned else "n -> a", "n -> v -> k", "b -> k" if turned else "k -> b"
    )
    m.bond("R -> v" if turned else "v -> R")
    run = hb.simulate(m, until=1.0, solver=solver)
    assert float(run["a.q"].at(1.0)) == pytest.approx(size * width / 2.0, rel=1e-6)
    assert float(run["b.q"].at(1.0)) == pytest.approx(1.5 * size * width, rel=1e-6)
