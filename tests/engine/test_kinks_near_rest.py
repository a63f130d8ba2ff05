"""What comes to rest close to a kink of a law, and is held there by the slope on its own side."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb

BULK = 1.4e9


def cylinder(start: float, inwards: bool) -> hb.Model:
    """A cushioned cylinder that is driven into one of its ends through an orifice."""
    m = hb.Model("cylinder", domain="hydraulic")
    m.add(ps=hb.Submodel("hydraulic.pressure_source", p="60 bar"))
    m.add(o=hb.Submodel("hydraulic.orifice", area="6 mm^2"))
    m.add(t=hb.Submodel("hydraulic.atmosphere"), M=hb.I("40 kg", domain="translational"))
    m.add(c=hb.Submodel("hydraulic.cushioned_cylinder", x_0=start))
    driven, open_one = ("c.b", "c.a") if inwards else ("c.a", "c.b")
    m.bond("ps.port -> o.inlet", f"o.outlet -> {driven}", f"{open_one} -> t.port", "c.rod -> M")
    return m


@pytest.mark.parametrize(
    ("solver", "start", "inwards", "until"),
    [("auto", 0.15, False, 0.4), ("auto", 0.05, True, 0.3), ("radau", 0.03, True, 0.2)],
)
def test_a_cushioned_cylinder_at_its_end_comes_to_rest(solver, start, inwards, until) -> None:
    """Its last pressure runs out through the throttle, beside which the check valve is steeper."""
    m = cylinder(start, inwards)
    run = hb.simulate(m, until=until, solver=solver, max_steps=2000)
    rests = run["c.pressure_a" if inwards else "c.pressure_b"].at(until)
    holds = run["c.pressure_b" if inwards else "c.pressure_a"].at(until)
    # tolerances are parts of what is stored, and a part of 1e-8 of a chamber is 14 Pa
    assert abs(rests) < 30.0
    assert holds == pytest.approx(60e5, rel=1e-5)
    assert run["c.position"].at(until) == pytest.approx(0.0 if inwards else 0.3, abs=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("rooms", "narrow", "wide", "bars", "until"),
    [
        ((1.2e-4, 2.8e-4, 1.1e-5), 1.4e-8, 5.2e-7, (19, 2, 19), 9.6),
        ((1.2e-4, 8.7e-6, 2.3e-6), 9.3e-8, 6.2e-6, (3, 15, 14), 0.28),
    ],
)
def test_vessels_level_out_through_throttles_that_are_wider_one_way(
    rooms, narrow, wide, bars, until, turned
) -> None:
    """Both throttles come to rest at their kinks; the mean of what the vessels hold stays."""
    m = hb.Model("vessels", domain="hydraulic", parameters={"k1": narrow, "k2": wide})
    law = "0.0336*(k1*max(e, 0) + k2*min(e, 0))/(e^2 + 1e6)^(1/4)"
    for k, (room, bar) in enumerate(zip(rooms, bars, strict=True)):
        m.add({f"n{k}": hb.Zero(), f"c{k}": hb.C(room / BULK, e=1e5 * bar)})
        m.bond(f"c{k} -> n{k}" if turned else f"n{k} -> c{k}")
        if k:
            m.add({f"d{k}": hb.One(), f"r{k}": hb.R({"f": law})})
            m.bond(f"n{k - 1} -> d{k} -> n{k}", f"d{k} -> r{k}")
    run = hb.simulate(m, until=until, max_steps=2000)
    mean = 1e5 * float(np.dot(rooms, bars)) / sum(rooms)
    assert [run[f"c{k}.e"].at(until) for k in range(3)] == pytest.approx([mean] * 3, rel=1e-8)
