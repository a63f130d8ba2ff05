"""A jump that moves a volume of oil (1e-4) and a momentum (1e1) together."""

import pytest

import hybond as hb


@pytest.mark.parametrize("eps", [0.0, 0.4])
@pytest.mark.parametrize("bulk", [1e7, 1.4e9, 2e11])
def test_a_piston_at_its_stop_whose_oil_is_held_at_a_pressure_did_not_converge(eps, bulk):
    """The valve opens at the instant of the impact: the oil must take the pressure outside."""
    m = hb.Model("piston", domain="translational")
    oil = f"{bulk}*(q + 1e-3*q^3/1e-9)/1e-3"
    m.add(
        mass=hb.I("50 kg", f="-0.2 m/s"),
        v=hb.One(),
        stop=hb.Zero(law="unilateral", gap="way", restitution=eps),
        oil=hb.C({"e": oil}, q=2e-6, domain="generic"),
        node=hb.Zero(domain="generic"),
        valve=hb.One(domain="generic"),
        outside=hb.Se(1e5, domain="generic"),
    )
    m.bond("v -> mass", "stop -> v", "outside -> valve -> node -> oil")
    m.signal(way=hb.Integral("v.f", start="0.1 m"))
    m.machine(
        "tap",
        states={"shut": [], "open": ["valve"]},
        start="shut",
        rules=["shut -> open when way <= 0 [m]"],
    )
    run = hb.simulate(m, until=0.6)
    assert [round(e.t, 9) for e in run.events if e.t > 0] == [0.5]
    assert run["v.f"].at(0.55) == pytest.approx(0.2 * eps, abs=1e-12)
    assert run["node.e"].at(0.55) == pytest.approx(1e5, rel=1e-9)
    q = run["oil.q"].at(0.55)
    assert bulk * (q + 1e6 * q**3) / 1e-3 == pytest.approx(1e5, rel=1e-9)
