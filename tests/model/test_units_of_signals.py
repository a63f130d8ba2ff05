"""The unit of a signal: that reads itself, or is some times what has a word of its own."""

import pytest

import hybond as hb


def test_a_filter_has_the_unit_that_its_rate_says() -> None:
    m = hb.Model("filter", domain="electrical")
    m.add(a=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), n=hb.Zero())
    m.bond("n -> a", "n -> r")
    m.signal(x=hb.Integral("(a.e - x)/(1 [s])", start="0 V"))
    run = hb.simulate(m, until=1.0)
    # x' = 2 exp(-t) - x from 0
    assert run["x"].at(1.0) == pytest.approx(2.0 * 0.36787944117144233, rel=1e-7)
    assert run["x"].unit in ("V", "")


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("d.torque*2", "N*m"),
        ("-d.torque/3 + 1", "N*m"),
        ("0.5*d.torque*k", "N*m"),
        ("d.torque*sin(angle)", "N*m"),
        ("d.torque*(J.speed/w)", "N*m"),
        ("d.torque*angle", "J"),
        ("d.torque*J.speed", "W"),
        ("d.torque*(2 [1/s])", "W"),
        ("d.torque/(2 [s])", "W"),
        ("0.5*J.body.p*J.body.f", "J"),
        ("J.speed*2", "rad/s"),
        ("2*angle", "rad"),
        ("d.torque/r", ""),
    ],
)
def test_some_times_a_torque_is_a_torque_and_its_work_is_none(text: str, unit: str) -> None:
    m = hb.Model("shaft", domain="rotational", parameters={"k": 3, "r": "2 N*m", "w": "1 rad/s"})
    m.add(
        J=hb.Submodel("rotational.inertia", w="1 rad/s"),
        d=hb.Submodel("rotational.damper"),
        f=hb.Submodel("rotational.frame"),
    )
    m.bond("J.shaft -> d.left", "d.right -> f.shaft")
    m.signal(angle=hb.Integral("J.speed"), asked=text)
    assert hb.simulate(m, until=1)["asked"].unit == unit
