"""A flow through ``k*f*abs(f)`` at rest has no slope there, and still is nothing but zero.

In hydraulics a millionth of a cubic metre a second is much: moved by parts of one, the law seemed
to hold beside zero, and the run said that the flow, and what it fills, is left open.
"""

import pytest

import hybond as hb


def filled(k: float, *, turned: bool, valve: str, way: float) -> hb.Model:
    """A volume at the pressure of its source, and a cylinder behind a valve."""
    m = hb.Model("filled", domain="hydraulic")
    m.add(
        source=hb.Submodel("hydraulic.pressure_source", p="100 bar"),
        pipe=hb.Submodel("hydraulic.turbulent_resistance", K=k),
        volume=hb.Submodel("hydraulic.volume", p_0="100 bar"),
        valve=hb.Submodel(f"hydraulic.{valve}"),
        cylinder=hb.Submodel("hydraulic.cylinder", x_0=way, p_a="120 bar"),
        tank=hb.Submodel("hydraulic.atmosphere"),
        body=hb.Submodel("translational.mass", m=200),
        bleed=hb.One(domain="hydraulic"),
        leak=hb.R(1e9, domain="hydraulic"),
    )
    pairs = ("source.port", "pipe.inlet"), ("pipe.outlet", "volume.port")
    pairs += ("volume.port", "valve.inlet"), ("valve.outlet", "cylinder.a")
    pairs += ("cylinder.b", "tank.port"), ("cylinder.rod", "body.flange")
    m.bond(*(f"{b} -> {a}" if turned else f"{a} -> {b}" for a, b in pairs))
    m.bond("cylinder.b -> bleed", "bleed -> leak")
    rules = ["off -> on when time > 0.1 and time < 0.2", "on -> off when time >= 0.2"]
    m.machine("tap", states={"off": [], "on": ["bleed"]}, start="off", rules=rules)
    return m


@pytest.mark.parametrize(
    ("k", "turned", "valve", "way"),
    [
        (1e12, False, "check_valve", 0.3),
        (1e12, True, "check_valve", 0.3),
        (1e10, False, "check_valve", 0.3),
        (1e14, True, "valve", 0.3),
        (1e12, False, "check_valve", 0.2),
    ],
)
def test_a_volume_at_the_pressure_of_its_source_is_not_said_to_be_left_open(
    k: float, turned: bool, valve: str, way: float
) -> None:
    run = hb.simulate(filled(k, turned=turned, valve=valve, way=way), 0.3)
    assert not run.warnings
    assert not any(visit.undetermined for event in run.events for visit in event.steps)
    assert run["pipe.flow"].at(0.0) == 0.0
    if way == 0.3:
        assert run["pipe.flow"].at([0.05, 0.15, 0.25]) == pytest.approx([0.0] * 3, abs=0.0)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("dual", [False, True])
def test_what_wires_side_by_side_share_is_still_said_to_be_left_open(
    dual: bool, turned: bool
) -> None:
    """Behind a law that is at rest, too: of the wires it says nothing."""
    m = hb.Model("shared")
    stored = -1e-3 if turned else 1e-3
    if dual:
        m.add(s=hb.Sf(1.0), z=hb.Zero(), o=hb.One(), a=hb.Zero(), b=hb.Zero(), y=hb.One())
        m.add(r=hb.R({"f": "100*e*abs(e)"}), c=hb.I(1e-3, p=stored))
    else:
        m.add(s=hb.Se(1.0), z=hb.One(), o=hb.Zero(), a=hb.One(), b=hb.One(), y=hb.Zero())
        m.add(r=hb.R({"e": "100*f*abs(f)"}), c=hb.C(1e-3, q=stored))
    m.bond("s -> z", "z -> r", "o -> z" if turned else "z -> o", "y -> c")
    m.bond("o -> a", "o -> b", "a -> y", "b -> y")
    run = hb.simulate(m, 0.1)
    (said,) = run.warnings
    assert "least leakage decides" in said
    assert '"o -> a"' in said and '"o -> b"' in said
    assert '"z -> r"' not in said and '"y -> c"' not in said
