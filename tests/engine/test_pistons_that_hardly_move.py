"""What moves a piston truly is followed, however little it is beside rounding of its pressures.

Bulk modulus times what two volumes differ by is some 1e-7 Pa of rounding.
"""

import math

import numpy as np
import pytest

import hybond as hb

M, G = 300.0, 9.81
AREA, BULK = 1e-3, 1.4e9


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
