"""Steps that swing are told where a flow is off, and not where a body is stopped hard in a step."""

import numpy as np
import pytest

import hybond as hb


def falls_on_a_cushion(*, turned: bool, mass: float) -> hb.Model:
    """A body that falls with its piston until a cushion brakes it."""
    m = hb.Model("press", domain="hydraulic")
    m.add(
        cylinder=hb.Submodel("hydraulic.cushioned_cylinder"),
        tank=hb.Submodel("hydraulic.atmosphere"),
        body=hb.Submodel("translational.mass", m=mass),
        weight=hb.Submodel("translational.weight", m=mass),
    )
    pairs = ("cylinder.a", "tank.port"), ("cylinder.b", "tank.port")
    pairs += ("cylinder.rod", "body.flange"), ("weight.flange", "body.flange")
    m.bond(*(f"{b} -> {a}" if turned else f"{a} -> {b}" for a, b in pairs))
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(("turned", "mass"), [(False, 50.0), (True, 50.0), (False, 80.0)])
def test_a_body_that_is_braked_hard_within_a_step_is_not_said_to_swing(
    solver: str, turned: bool, mass: float
) -> None:
    """Its weight was said to be off by 61 N (of 4,600 N), by how much it changed in a step."""
    run = hb.simulate(falls_on_a_cushion(turned=turned, mass=mass), 0.5, solver=solver)
    assert not run.warnings
    closer = hb.simulate(
        falls_on_a_cushion(turned=turned, mass=mass), 0.5, solver="radau", rtol=1e-10
    )
    times = np.linspace(0.16, 0.24, 9)
    force = run["cylinder.force"].at(times)
    np.testing.assert_allclose(force, closer["cylinder.force"].at(times), rtol=1e-4, atol=0.05)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
def test_friction_that_breaks_loose_within_a_step_is_not_said_to_swing(rtol: float) -> None:
    m = hb.Model("bristles")
    m.add(hand=hb.Sf(0.1), n=hb.Zero(), v=hb.One(), mass=hb.I(1.0), rub=hb.Se("-F"))
    m.add(spring=hb.C(0.5, q=0.74))
    m.signal(
        rate="v.f - 1e5*abs(v.f)/(1 + 0.5*exp(-(v.f/0.001)^2))*z",
        z=hb.Integral("rate", start=1.48e-5),
        F="1e5*z + sqrt(1e5)*rate + 0.4*v.f",
    )
    m.bond("hand -> n -> v", "n -> spring", "rub -> v", "v -> mass")
    assert not hb.simulate(m, 0.5, rtol=rtol, solver="radau").warnings


def filled(*, dual: bool, turned: bool, k: float, c: float) -> hb.Model:
    """Two tanks that a rough pipe joins; what fills them comes to rest and returns."""
    m = hb.Model("filled")
    course = "1 + sin(1 [rad/s]*time)"
    if dual:
        m.add(s=hb.Se(course), a=hb.I(c), b=hb.I(c), m1=hb.One(), m2=hb.One())
        m.add(pipe=hb.Zero(), rough=hb.R({"f": f"{k}*e*abs(e)"}))
    else:
        m.add(s=hb.Sf(course), a=hb.C(c), b=hb.C(c), m1=hb.Zero(), m2=hb.Zero())
        m.add(pipe=hb.One(), rough=hb.R({"e": f"{k}*f*abs(f)"}))
    m.bond("s -> m1", "m1 -> a", "pipe -> rough", "m2 -> b")
    m.bond(*(("pipe -> m1", "m2 -> pipe") if turned else ("m1 -> pipe", "pipe -> m2")))
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("dual", "turned", "k", "c"),
    [
        (False, False, 1e-5, 1e-5),
        (False, True, 1e-5, 1e-5),
        (True, False, 1e-5, 1e-5),
        (False, False, 1e-3, 1e-6),
        (False, False, 1e-8, 1e-2),
    ],
)
def test_a_flow_that_swings_is_said_to_be_off(dual: bool, turned: bool, k: float, c: float) -> None:
    """What drives it is rounding of what the tanks hold: it is off by a hundredth and more."""
    run = hb.simulate(filled(dual=dual, turned=turned, k=k, c=c), 5.5, solver="radau")
    flow = run["rough.e" if dual else "rough.f"]
    times = np.array(flow.t)
    times = times[times > 4.0]
    half = 0.5 * (1.0 + np.sin(times))
    # to first order in what the pipe delays it by
    meant = half - k * c * half * 0.5 * np.cos(times)
    off = np.abs((-1.0 if turned else 1.0) * np.array(flow.at(times)) - meant)
    assert off.max() > 1e-3, "it is not off, and this is no test"
    said = "effort" if dual else "flow"
    assert any(f"its {said} is off by" in each for each in run.warnings)
