"""What is led by a source from rest, from behind a kink, with implicit steps.

The Jacobian that is made just before the kink sees its far side. What rests before it is not moved
by such slopes.
"""

import math

import pytest

import hybond as hb

SOLVERS = ["radau", "auto", "rk45"]


def geneva(start: float) -> hb.Model:
    """Return a wheel of four slots behind a crank that turns by 2 rad/s, with inertia."""
    m = hb.Model("geneva", domain="rotational")
    m.add(drive=hb.Sf(2.0), a=hb.One(), slots=hb.TF("ratio"), b=hb.One(), J=hb.I(0.01))
    m.bond("drive -> a -> slots -> b -> J")
    m.signal(
        turned=hb.Integral("a.f", start=start),
        angle="mod(turned + pi, 2*pi) - pi",
        wheel=hb.Integral("b.f"),
        ratio="if abs(angle) < pi/4"
        " then (sqrt(2)*cos(angle) - 1)/(3 - 2*sqrt(2)*cos(angle)) else 0",
    )
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("until", [2.0, 3 * math.pi])
def test_a_geneva_wheel_goes_on_from_its_dwell(solver: str, until: float) -> None:
    """Each turn of the crank moves the wheel by a quarter; its torque follows from the ratio."""
    run = hb.simulate(geneva(-math.pi), until, solver=solver)
    turns = math.floor(until / math.pi + 0.375)
    assert run["wheel"].at(until) == pytest.approx(turns * math.pi / 2, rel=1e-7)
    t = math.pi / 2 + 0.05  # 0.1 rad behind the middle
    root = math.sqrt(2.0)
    below = 3.0 - 2.0 * root * math.cos(0.1)
    slope = -root * math.sin(0.1) * (below + 2.0 * (root * math.cos(0.1) - 1.0)) / below**2
    assert run["J.e"].at(t) == pytest.approx(0.01 * 4.0 * slope, rel=1e-5)


def cam() -> hb.Model:
    m = hb.Model(domain="generic")
    m.add(w=hb.Sf(1), a=hb.One(), cam=hb.TF("max(turned - 1, 0)"), b=hb.One())
    m.add(mass=hb.I(3), load=hb.R(1))
    m.bond("w -> a -> cam -> b -> mass", "b -> load")
    m.signal(turned=hb.Integral("a.f"), way=hb.Integral("b.f"))
    return m


def gyrator() -> hb.Model:
    m = hb.Model(domain="generic")
    m.add(w=hb.Sf(1), a=hb.One(), coil=hb.GY("max(turned - 1, 0)"), b=hb.Zero(), store=hb.C(3))
    m.bond("w -> a -> coil -> b -> store")
    m.signal(turned=hb.Integral("a.f"), way=hb.Integral("b.e"))
    return m


def source_of_flow() -> hb.Model:
    m = hb.Model(domain="generic")
    m.add(w=hb.Sf("if x < 1 then 0 else sin(x - 1)"), a=hb.One(), mass=hb.I(1))
    m.bond("w -> a -> mass")
    m.signal(x=hb.Integral("2"), way=hb.Integral("a.f"))
    return m


def source_of_effort() -> hb.Model:
    m = hb.Model(domain="generic")
    m.add(w=hb.Se("max(x - 1, 0)^2 + max(x - 1, 0)"), a=hb.Zero(), store=hb.C(1))
    m.bond("w -> a -> store")
    m.signal(x=hb.Integral("2"), way=hb.Integral("a.e"))
    return m


LED = {
    cam: 1.3**2 / 2,
    gyrator: 1.3**2 / 2,
    source_of_flow: (1 - math.cos(3.6)) / 2,
    source_of_effort: (3.6**3 / 3 + 3.6**2 / 2) / 2,
}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("made", LED)
def test_what_a_source_leads_begins_behind_a_kink(made, solver: str) -> None:
    """The integral of what leads, from the kink to 2.3 s."""
    run = hb.simulate(made(), 2.3, solver=solver)
    assert run["way"].at(2.3) == pytest.approx(LED[made], rel=1e-8)
    assert run.audit().holds()
