"""Laws without a slope at zero (quadratic damping) and without a bound on it (an orifice)."""

import math

import pytest

import hybond as hb

QUADRATIC = {"e": "1e12*f*abs(f)"}
ROOT = {"f": "1e-6*sign(e)*sqrt(abs(e))"}


def height(t: float) -> float:
    """C e' = -1e-6 sqrt(e), so sqrt(e) falls linearly: 20 kPa, 1e-8 m^3/Pa."""
    return (math.sqrt(20000.0) - 50.0 * t) ** 2


@pytest.mark.parametrize("law", [QUADRATIC, ROOT])
@pytest.mark.parametrize("bond", ["n -> pipe", "pipe -> n"])
def test_tank_drains_through_an_orifice(law, bond) -> None:
    m = hb.Model("tank")
    m.add(tank=hb.C(1e-8, e=20000.0), n=hb.Zero(), pipe=hb.R(law))
    m.bond("n -> tank", bond)
    run = hb.simulate(m, until=1.0, rtol=1e-9)
    assert run.status == "ok"
    for t in (0.0, 0.3, 1.0):
        assert run["tank.e"].at(t) == pytest.approx(height(t), rel=1e-6)


@pytest.mark.parametrize("law", [QUADRATIC, ROOT])
def test_valve_in_front_of_an_orifice(law) -> None:
    m = hb.Model("tank")
    m.add(tank=hb.C(1e-8, e=20000.0), n=hb.Zero(), valve=hb.One(), pipe=hb.R(law))
    m.bond("n -> tank", "n -> valve -> pipe")
    rules = ["shut -> open when time >= 0.1"]
    m.machine("V", states={"shut": [], "open": ["valve"]}, start="shut", rules=rules)
    run = hb.simulate(m, until=1.1, rtol=1e-9)
    assert run.status == "ok"
    assert run["tank.e"].at(0.1) == 20000.0
    assert run["tank.e"].at(1.1) == pytest.approx(height(1.0), rel=1e-6)


def test_quadratic_damper_stops_a_mass_as_by_hand() -> None:
    """m v' = -k v |v|: v = v0/(1 + k v0 t/m)."""
    m = hb.Model("drag")
    m.add(mass=hb.I(2.0, f=3.0), air=hb.R({"e": "5*f*abs(f)"}), v=hb.One())
    m.bond("v -> mass", "v -> air")
    run = hb.simulate(m, until=2.0, rtol=1e-9)
    assert run["mass.f"].at(2.0) == pytest.approx(3.0 / (1.0 + 5.0 * 3.0 * 2.0 / 2.0), rel=1e-7)
