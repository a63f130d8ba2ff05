"""Exponential diodes near rest, beside laws that saturate: they have a solution, and it is found.

What a diode says near rest, ``I*(exp(u/U) - 1)``, is far less than its saturation current, of which
the 1 in it has no digits.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb


def diode(saturation: float, thermal: float, way: int = 1) -> hb.Part:
    return hb.R({"f": f"{way * saturation}*(exp({way}*e/{thermal}) - 1)"})


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("flat", ["tanh(e/0.01)", "max(-1, min(1, e/0.01))"])
def test_large_and_small_diodes_in_a_row_near_rest_agree(flat: str, turned: bool) -> None:
    """1 fA into a node that a diode leaves to ground, and two, one of 1 uA, through a flat law."""
    m = hb.Model("diodes", domain="electrical")
    m.add(i=hb.Sf(1e-15), n=hb.Zero(), k=hb.Zero(), j=hb.One(), q=hb.One(), leak=hb.R(1e9))
    m.add(a=diode(1e-12, 0.02585, -1), b=diode(1e-6, 0.05, -1), c=diode(1e-12, 0.035, -1))
    m.add(flat=hb.R({"f": flat.replace("e/0.01", "e/(0.01 [V])") + "*(1 [A])"}))
    bonds = ["i -> n", "n -> leak", "n -> j", "n -> q", "q -> c", "j -> a", "j -> b", "k -> flat"]
    m.bond(*bonds, "k -> j" if turned else "j -> k")
    run = hb.simulate(m, until=1.0)
    # conductances at rest, to first order in what is 1e-5 of the thermal voltages
    row = 1.0 / (0.02585 / 1e-12 + 0.05 / 1e-6 + 0.01)
    u = 1e-15 / (1e-9 + row + 1e-12 / 0.035)
    assert run["n.e"].at(1.0) == pytest.approx(u, rel=1e-4, abs=0.0)
    assert run["a.f"].at(1.0) == pytest.approx(row * u, rel=1e-4, abs=0.0)
    assert run["b.e"].at(1.0) == pytest.approx(row * u * 0.05 / 1e-6, rel=1e-4, abs=0.0)


@pytest.mark.parametrize("size", [1e-15, 1e-12, 1e-9, 1e-6, 1e-4])
def test_a_diode_and_a_resistor_that_saturates_share_any_current(size: float) -> None:
    m = hb.Model("shares", domain="electrical")
    m.add(
        i=hb.Sf(size), n=hb.Zero(), d=diode(1e-14, 0.02585), r=hb.R({"f": "1e-3*e/sqrt(1 + e^2)"})
    )
    m.bond("r -> n", "i -> n -> d")
    run = hb.simulate(m, until=1.0)
    u = float(run["n.e"].at(1.0))
    assert run["d.f"].at(1.0) - run["r.f"].at(1.0) == pytest.approx(size, rel=1e-12, abs=0.0)
    assert run["d.f"].at(1.0) == pytest.approx(1e-14 * math.expm1(u / 0.02585), rel=1e-12, abs=0.0)
