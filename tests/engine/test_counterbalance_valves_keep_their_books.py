"""A counterbalance valve that holds a load: energy was lost in the first steps of its opening.

The oil of a chamber moves by next to nothing beside what is in it, so that steps are as long as the
valve takes to open. Both formulas of an explicit step saw the same stages, far from the motion, and
said a quarter of the error that there was.
"""

import pytest

import hybond as hb


def circuit(hose: str) -> hb.Model:
    """A pump drives a cylinder out that a load pulls; the valve is opened by both its pressures."""
    m = hb.Model("counterbalance", domain="hydraulic")
    m.parameter(K="0.7*sqrt(2/(870 [kg/m^3]))", p_lam="1 kPa")
    opening = "min(max((cyl.b.e + 4*cyl.a.e - 100 [bar])/(10 [bar]), 0), 1)"
    m.add(
        pump=hb.Sf("0.2e-3 m^3/s"),
        hose=hb.Submodel("hydraulic.volume", volume="0.2 L", p_0=hose),
        way=hb.Submodel("hydraulic.orifice"),
        cyl=hb.Submodel("hydraulic.cylinder", stroke="0.5 m", x_0="0.1 m", p_b="81.75 bar"),
        load=hb.I("500 kg"),
        weight=hb.Se("(500 [kg])*(9.81 [m/s^2])", domain="translational"),
        q=hb.One(),
        valve=hb.R({"f": f"(20 [mm^2])*K*{opening}*e/(e^2 + p_lam^2)^(1/4)"}),
        back=hb.Submodel("hydraulic.orifice"),
        tank=hb.Submodel("hydraulic.atmosphere"),
    )
    m.bond("pump -> hose.port -> way.inlet", "way.outlet -> cyl.a", "weight -> cyl.rod -> load")
    m.bond("cyl.b -> q -> back.inlet", "back.outlet -> tank.port", "q -> valve")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("hose", ["150 bar", "200 bar"])
@pytest.mark.slow
def test_no_step_loses_more_than_its_tolerance(hose: str) -> None:
    """Up to 2.5 times as much was lost, five times in a third of a second."""
    run = hb.simulate(circuit(hose), 0.3, solver="rk45")
    audit = run.audit()
    assert audit.holds()
    assert audit.beyond < 1e-9
    # a step more here and there, and some looks at the way of those that are doubted
    assert run.stats["steps"] < 2700
    assert run.stats["evaluations"] < 7 * run.stats["steps"]
