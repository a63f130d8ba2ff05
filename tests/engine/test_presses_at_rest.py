"""A press at rest between two chambers of oil: their pressures are rounding of the bulk modulus.

Bulk modulus times what two volumes differ by is some 1e-7 Pa of rounding. What that does to speed
and way of the piston is no motion, and steps do not follow it; what moves it truly, they do.
"""

import math

import numpy as np
import pytest

import hybond as hb

M, G, K = 300.0, 9.81, 1e7
AREA, BULK = 1e-3, 1.4e9


def press(x_0: float, d: float, *, bulk: float, turned: bool) -> hb.Model:
    """Return a mass that lies on an elastic table, pressed in as far as it weighs, ports shut."""
    m = hb.Model("press", domain="hydraulic")
    m.add(
        cylinder=hb.Submodel("hydraulic.cylinder", x_0=x_0, bulk=bulk),
        mass=hb.Submodel("translational.mass", m=M),
        weight=hb.Submodel("translational.weight", m=M, g=G),
        table=hb.Submodel("translational.elastic_contact", distance=-M * G / K, k=K, d=d),
        floor=hb.Submodel("translational.frame"),
    )
    pairs = ("cylinder.rod", "mass.flange"), ("weight.flange", "mass.flange")
    pairs += ("floor.flange", "table.left"), ("table.right", "mass.flange")
    m.bond(*(f"{b} -> {a}" if turned else f"{a} -> {b}" for a, b in pairs))
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("x_0", "d", "bulk"), [(0.0, 1e6, 1.4e9), (0.0, 1e4, 1.4e9), (0.1, 1e6, 1.4e9), (0.0, 1e6, 1e8)]
)
def test_a_press_that_lies_on_its_table_is_at_rest(
    x_0: float, d: float, bulk: float, turned: bool
) -> None:
    run = hb.simulate(press(x_0, d, bulk=bulk, turned=turned), 3.0)
    assert run.stats["steps"] < 400
    t = np.linspace(0.0, 3.0, 31)
    np.testing.assert_allclose(run["cylinder.position"].at(t), x_0, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(run["table.force"].at(t), M * G, rtol=1e-9)


@pytest.mark.parametrize("turned", [False, True])
def test_a_leak_of_a_thousandth_of_a_cubic_millimetre_sinks_the_piston(turned: bool) -> None:
    p = M * G / AREA
    m = hb.Model("sinking", domain="hydraulic")
    m.add(
        cylinder=hb.Submodel("hydraulic.cylinder", x_0=0.15, p_a=p),
        mass=hb.Submodel("translational.mass", m=M),
        weight=hb.Submodel("translational.weight", m=M, g=G),
        gap=hb.Submodel("hydraulic.laminar_resistance", R=p / 1e-12),
        tank=hb.Submodel("hydraulic.atmosphere"),
        rub=hb.Submodel("translational.damper", d=2e4),
        frame=hb.Submodel("translational.frame"),
    )
    pairs = ("cylinder.rod", "mass.flange"), ("weight.flange", "mass.flange")
    pairs += ("cylinder.a", "gap.inlet"), ("gap.outlet", "tank.port"), ("cylinder.b", "tank.port")
    pairs += ("frame.flange", "rub.left"), ("rub.right", "mass.flange")
    m.bond(*(f"{b} -> {a}" if turned else f"{a} -> {b}" for a, b in pairs))
    run = hb.simulate(m, "1000 s", method="radau")
    # the energy of the fluid pushes by p + p^2/(2*bulk); a volume V holds V*(1 + p/bulk)
    e = BULK * (math.sqrt(1.0 + 2.0 * p / BULK) - 1.0)
    speed = (e / p * 1e-12) / (AREA * (1.0 + e / BULK))
    fell = run["cylinder.position"].at(500.0) - run["cylinder.position"].at(1000.0)
    assert fell == pytest.approx(500.0 * speed, rel=1e-6)


@pytest.mark.parametrize("method", [None, "radau"])
def test_a_piston_that_swings_by_a_nanometre_swings(method: str | None) -> None:
    m = hb.Model("swing", domain="hydraulic")
    stiffness = BULK * (AREA**2 / 170e-6 + 6e-4**2 / 110e-6)
    w = math.sqrt(stiffness / M)
    v = 1e-9 * w
    m.add(
        cylinder=hb.Submodel("hydraulic.cylinder", x_0=0.15),
        mass=hb.Submodel("translational.mass", m=M, v=v),
    )
    m.bond("cylinder.rod -> mass.flange")
    run = hb.simulate(m, 0.2, method=method)
    t = np.linspace(0.0, 0.2, 201)
    np.testing.assert_allclose(run["mass.speed"].at(t), v * np.cos(w * t), rtol=0.0, atol=1e-4 * v)
    way = run["mass.position"].at(t)
    np.testing.assert_allclose(way, 1e-9 * np.sin(w * t), rtol=0.0, atol=1e-13)
