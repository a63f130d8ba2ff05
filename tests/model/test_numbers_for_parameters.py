"""A number without a unit, given for a parameter, is in SI and of what it replaces."""

import pytest

import hybond as hb


def tank() -> hb.Model:
    m = hb.Model("tank", domain="hydraulic")
    m.parameter(area="1 m^2", level="2 m", head="9810 Pa/m", ratio=3)
    m.parameter(volume="area*level")
    m.add(n=hb.Zero(), water=hb.C("area/head", q="volume"), out=hb.R("1 Pa*s/m^3"))
    m.bond("n -> water", "n -> out")
    return m


@pytest.mark.parametrize("area", [0.5, "0.5", "0.5 m^2", "50 dm^2"])
@pytest.mark.parametrize("level", [4, "4 m", "400 cm"])
def test_a_product_with_a_bare_number_was_refused_for_its_unit(area, level):
    m = hb.Model("outer", domain="hydraulic")
    m.add(n=hb.Zero(), t=hb.Submodel(inner(), area=area, level=level), r=hb.R("1 Pa*s/m^3"))
    m.bond("n -> t.n", "n -> r")
    assert hb.simulate(m, until=1e-9)["t.water.q"].at(0) == pytest.approx(2.0)
    alone = hb.simulate(tank(), until=1e-9, parameters={"area": area, "level": level})
    assert alone["water.q"].at(0) == pytest.approx(2.0)


def inner() -> hb.Model:
    m = tank()
    m.port(n="n")
    return m


def test_a_bare_number_for_an_expression_has_its_unit_too():
    run = hb.simulate(tank(), until=1e-9, parameters={"volume": 7})
    assert run["water.q"].at(0) == pytest.approx(7)
    m = tank()
    m.signal(level_now="volume/area")
    assert hb.simulate(m, until=1e-9, parameters={"volume": 7})["level_now"].unit == "m"


def test_a_number_breaks_a_circle_of_parameters():
    m = tank()
    m.parameter(a="b", b="a")
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M108"
    assert m.flatten(parameters={"b": 2}).parameters["a"] == 2.0
